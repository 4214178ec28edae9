//! Text -> JSON values, with the line and column of what is no JSON.
//!
//! Python and others write `NaN`, `Infinity` and halves of surrogate pairs, which are no JSON. They are refused, but if they are
//! in a control point then by its name: such a text is read once more with stand-ins for them ([`STAND_IN`]).

use std::collections::HashSet;
use std::fmt;

use serde::de::{Deserialize, Deserializer, Error as _, MapAccess, SeqAccess, Visitor};
use serde_json::Value;

use crate::error::Error;
use crate::text::shown;

/// Begins the text that stands for what JSON cannot say; a code point that no text uses.
pub const STAND_IN: char = '\u{fdd0}';

/// A JSON text.
pub struct Document {
    /// What it says.
    pub value: Value,
    /// What is wrong with it, if there are stand-ins in it: the reader may find a better sentence.
    pub mended: Option<Error>,
}

/// Reads a JSON text in which no object has a key twice.
pub fn parse(text: &str) -> Result<Document, Error> {
    let error = match strict(text) {
        Ok(value) => return Ok(Document { value, mended: None }),
        Err(error) => error,
    };
    match mend(text).map(|mended| strict(&mended)) {
        Some(Ok(value)) => Ok(Document { value, mended: Some(error) }),
        _ => Err(error),
    }
}

fn strict(text: &str) -> Result<Value, Error> {
    serde_json::from_str::<Unique>(text)
        .and_then(|_| serde_json::from_str(text))
        .map_err(|error| sentence(text, &error))
}

fn sentence(text: &str, error: &serde_json::Error) -> Error {
    let (line, column) = (error.line(), error.column());
    let words = error.to_string();
    let words = words.strip_suffix(&format!(" at line {line} column {column}")).unwrap_or(&words);
    // Columns count letters, as editors do; the library counts bytes.
    let bytes = text.split('\n').nth(line.max(1) - 1).unwrap_or_default().as_bytes();
    let before = &bytes[..column.saturating_sub(1).min(bytes.len())];
    let column = before.iter().filter(|byte| **byte & 0xc0 != 0x80).count() + 1;
    let words = match words {
        "recursion limit exceeded" => {
            "not JSON that can be read: it is nested more than 127 deep".to_string()
        }
        // Whether this is not JSON, one may argue; what it says is not known.
        twice if twice.starts_with("the key ") => twice.to_string(),
        // The library's word for true, false and null.
        "expected ident" => "not JSON: expected value".to_string(),
        words => format!("not JSON: {words}"),
    };
    Error::file(format!("line {line}, column {column}: {words}"))
}

/// A JSON value of which only the keys are looked at.
struct Unique;

impl<'de> Deserialize<'de> for Unique {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Unique)
    }
}

impl<'de> Visitor<'de> for Unique {
    type Value = Unique;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Unique, E> {
        Ok(Unique)
    }

    fn visit_bool<E>(self, _: bool) -> Result<Unique, E> {
        Ok(Unique)
    }

    fn visit_i64<E>(self, _: i64) -> Result<Unique, E> {
        Ok(Unique)
    }

    fn visit_u64<E>(self, _: u64) -> Result<Unique, E> {
        Ok(Unique)
    }

    fn visit_f64<E>(self, _: f64) -> Result<Unique, E> {
        Ok(Unique)
    }

    fn visit_str<E>(self, _: &str) -> Result<Unique, E> {
        Ok(Unique)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Unique, A::Error> {
        while list.next_element::<Unique>()?.is_some() {}
        Ok(Unique)
    }

    /// Numbers of many digits too are maps here, of one key.
    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Unique, A::Error> {
        let mut keys = HashSet::new();
        while let Some(key) = map.next_key::<String>()? {
            if keys.contains(&key) {
                return Err(A::Error::custom(format!("the key \"{}\" is there twice", shown(&key))));
            }
            keys.insert(key);
            map.next_value::<Unique>()?;
        }
        Ok(Unique)
    }
}

/// The text with stand-ins for what JSON cannot say; `None` where there is nothing of that kind.
fn mend(text: &str) -> Option<String> {
    let mut out = String::with_capacity(text.len());
    let (mut rest, mut in_text, mut mended) = (text, false, false);
    while let Some(letter) = rest.chars().next() {
        let mut taken = letter.len_utf8();
        if in_text && letter == '\\' {
            taken = escape_len(rest);
            if taken == 6 && half(rest) == Some(true) && half(&rest[6..]) == Some(false) {
                taken = 12;
            } else if half(rest).is_some() {
                out.push(STAND_IN);
                mended = true;
                rest = &rest[taken..];
                continue;
            }
        } else if letter == '"' {
            in_text = !in_text;
        } else if let (false, Some(word)) =
            (in_text, ["NaN", "Infinity", "-Infinity"].iter().find(|word| rest.starts_with(**word)))
        {
            out.push_str(&format!("\"{STAND_IN}{word}\""));
            mended = true;
            rest = &rest[word.len()..];
            continue;
        }
        out.push_str(&rest[..taken]);
        rest = &rest[taken..];
    }
    mended.then_some(out)
}

/// The bytes of the escape that a text begins with.
fn escape_len(text: &str) -> usize {
    let whole = text.starts_with("\\u") && text.get(2..6).is_some();
    if whole {
        return 6;
    }
    1 + text[1..].chars().next().map_or(0, char::len_utf8)
}

/// Whether a text begins with the escape of the first half of a surrogate pair, or of the second.
fn half(text: &str) -> Option<bool> {
    let digits = text.strip_prefix("\\u")?.get(..4)?;
    match u16::from_str_radix(digits, 16).ok()? {
        0xd800..=0xdbff => Some(true),
        0xdc00..=0xdfff => Some(false),
        _ => None,
    }
}
