//! Typed access to JSON: every error tells the path to the value, such as `accessors[3].bufferView`.

use serde_json::{Map, Value};

use crate::error::Error;

/// A JSON value and the path to it.
#[derive(Clone)]
pub(super) struct At<'a> {
    pub value: &'a Value,
    pub path: String,
}

impl<'a> At<'a> {
    pub fn root(value: &'a Value) -> Self {
        At { value, path: String::new() }
    }

    /// An error about this value.
    pub fn error(&self, message: impl AsRef<str>) -> Error {
        let path = if self.path.is_empty() { "the JSON" } else { &self.path };
        Error::malformed(format!("{path}: {}", message.as_ref()))
    }

    fn expected(&self, what: &str) -> Error {
        self.error(format!("expected {what}, found {}", shown(self.value)))
    }

    pub fn object(&self) -> Result<&'a Map<String, Value>, Error> {
        self.value.as_object().ok_or_else(|| self.expected("an object"))
    }

    fn child(&self, key: &str, value: &'a Value) -> At<'a> {
        let path = if self.path.is_empty() { key.to_string() } else { format!("{}.{key}", self.path) };
        At { value, path }
    }

    /// The member `key` of this object, if it is there.
    pub fn get(&self, key: &str) -> Result<Option<At<'a>>, Error> {
        Ok(self.object()?.get(key).map(|value| self.child(key, value)))
    }

    /// The member `key` of this object.
    pub fn need(&self, key: &str) -> Result<At<'a>, Error> {
        self.get(key)?.ok_or_else(|| self.error(format!("\"{key}\" is missing")))
    }

    /// The members of this object with their keys.
    pub fn members(&self) -> Result<impl Iterator<Item = (&'a str, At<'a>)> + use<'a, '_>, Error> {
        Ok(self.object()?.iter().map(|(key, value)| (key.as_str(), self.child(key, value))))
    }

    /// The elements of the array `key`; none where there is no such array.
    pub fn items(&self, key: &str) -> Result<Vec<At<'a>>, Error> {
        let Some(array) = self.get(key)? else { return Ok(Vec::new()) };
        let values = array.value.as_array().ok_or_else(|| array.expected("an array"))?;
        Ok(values
            .iter()
            .enumerate()
            .map(|(i, value)| At { value, path: format!("{}[{i}]", array.path) })
            .collect())
    }

    pub fn string(&self) -> Result<&'a str, Error> {
        self.value.as_str().ok_or_else(|| self.expected("a string"))
    }

    fn bool(&self) -> Result<bool, Error> {
        self.value.as_bool().ok_or_else(|| self.expected("true or false"))
    }

    /// A whole number from 0; also written as `3.0`, which glTF allows.
    pub fn uint(&self) -> Result<usize, Error> {
        let whole = self.value.as_u64().or_else(|| {
            let f = self.value.as_f64()?;
            (f >= 0.0 && f.fract() == 0.0 && f < 9e15).then_some(f as u64)
        });
        whole
            .and_then(|n| usize::try_from(n).ok())
            .ok_or_else(|| self.expected("a whole number from 0 that is not huge"))
    }

    /// A whole number that counts into `total` things called `what`.
    pub fn index(&self, total: usize, what: &str) -> Result<usize, Error> {
        let index = self.uint()?;
        if index < total {
            Ok(index)
        } else {
            Err(self.error(format!("{index} is not among the {total} {what}")))
        }
    }

    /// The member `key` as an index into `total` things called `what`, if it is there.
    pub fn index_of(&self, key: &str, total: usize, what: &str) -> Result<Option<usize>, Error> {
        self.get(key)?.map(|at| at.index(total, what)).transpose()
    }

    /// The whole number `key`, or `default` where it is missing.
    pub fn uint_or(&self, key: &str, default: usize) -> Result<usize, Error> {
        self.get(key)?.map_or(Ok(default), |at| at.uint())
    }

    pub fn bool_or(&self, key: &str, default: bool) -> Result<bool, Error> {
        self.get(key)?.map_or(Ok(default), |at| at.bool())
    }

    /// The `N` numbers of the array `key`, if it is there.
    pub fn numbers<const N: usize>(&self, key: &str) -> Result<Option<[f64; N]>, Error> {
        let Some(at) = self.get(key)? else { return Ok(None) };
        let wrong = || at.expected(&format!("an array of {N} finite numbers"));
        let array = at.value.as_array().filter(|a| a.len() == N).ok_or_else(wrong)?;
        let mut numbers = [0.0; N];
        for (number, value) in numbers.iter_mut().zip(array) {
            *number = value.as_f64().filter(|f| f.is_finite()).ok_or_else(wrong)?;
        }
        Ok(Some(numbers))
    }
}

/// A value for a person, cut short.
fn shown(value: &Value) -> String {
    match value {
        Value::Array(items) => format!("an array of {}", items.len()),
        Value::Object(_) => "an object".to_string(),
        other => {
            let text = other.to_string();
            match text.char_indices().nth(40) {
                Some((end, _)) => format!("{}...", &text[..end]),
                None => text,
            }
        }
    }
}
