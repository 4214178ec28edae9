//! Numbers and lists of numbers out of JSON, or the sentence that says what was found.

use serde_json::{Map, Value};

use super::parse::STAND_IN;
use super::style::found;
use crate::error::Error;
use crate::session::Session;

/// The most digits of a number: Python reads no more.
const DIGITS: usize = 4300;

/// The list of numbers under a key; `dim` of them, or 1 to 3.
pub fn vector(
    of: &Map<String, Value>,
    key: &str,
    place: &str,
    dim: Option<usize>,
) -> Result<Vec<f64>, Error> {
    let values = of.get(key).and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let right = dim.map_or((1..=3).contains(&values.len()), |dim| values.len() == dim);
    if !right || !values.iter().all(is_number) {
        let expected = match dim {
            None => "1 to 3 numbers".to_string(),
            Some(1) => "1 number".to_string(),
            Some(dim) => format!("{dim} numbers"),
        };
        let found = found(of.get(key));
        return Err(Error::file(format!("{place}.{key}: expected a list of {expected}, found {found}")));
    }
    values.iter().map(|value| double(value, &format!("{place}.{key}: a number"))).collect()
}

/// The number under a key.
pub fn number(of: &Map<String, Value>, key: &str, place: &str) -> Result<f64, Error> {
    match of.get(key) {
        Some(value) if is_number(value) => double(value, &format!("{place}.{key}: the number")),
        other => Err(Error::file(format!("{place}.{key}: expected a number, found {}", found(other)))),
    }
}

/// Whether it is a number, or what stands for one that is not finite.
fn is_number(value: &Value) -> bool {
    value.is_number() || value.as_str().is_some_and(|text| text.starts_with(STAND_IN))
}

fn double(value: &Value, what: &str) -> Result<f64, Error> {
    let text = match value {
        Value::Number(number) => number.as_str(),
        other => return Ok(stand_in(other)),
    };
    let digits = text.bytes().take_while(|byte| byte.is_ascii_digit() || *byte == b'-').count();
    if digits > DIGITS {
        let message = format!("not JSON that can be read: a number has more than {DIGITS} digits");
        return Err(Error::file(message));
    }
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(Error::file(format!("{what} is too large"))),
    }
}

fn stand_in(value: &Value) -> f64 {
    let text = value.as_str().unwrap_or_default();
    text.trim_start_matches(STAND_IN).parse().unwrap_or(f64::NAN)
}

/// A text that is not empty.
pub fn text(of: &Map<String, Value>, key: &str, place: &str) -> Result<String, Error> {
    match of.get(key) {
        Some(Value::String(text)) if !text.trim().is_empty() => Ok(text.clone()),
        other => {
            let found = found(other);
            Err(Error::file(format!("{place}.{key}: expected a text that is not empty, found {found}")))
        }
    }
}

/// Keeps what is left of an object, if anything is.
pub fn keep(session: &mut Session, key: &str, rest: Map<String, Value>) {
    if !rest.is_empty() {
        session.others.insert(key.into(), rest.into());
    }
}

pub fn passed_over(key: &str) -> String {
    format!("the key \"{key}\" means nothing in a file of version 1: it is passed over")
}
