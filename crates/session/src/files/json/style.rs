//! JSON within one line, with a space after commas and colons.

use std::io::{self, Write};

use serde::Serialize;
use serde_json::ser::Formatter;
use serde_json::{Serializer, Value};

use super::parse::STAND_IN;
use crate::text::shown;

struct Spaced {
    quotation_mark: &'static [u8],
}

impl Formatter for Spaced {
    fn begin_array_value<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        writer.write_all(if first { b"" } else { b", " })
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        writer.write_all(if first { b"" } else { b", " })
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        writer.write_all(b": ")
    }

    fn begin_string<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        writer.write_all(self.quotation_mark)
    }

    fn end_string<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        writer.write_all(self.quotation_mark)
    }
}

/// The text of a value.
pub fn line(value: &Value) -> String {
    written(value, b"\"")
}

/// A value that a sentence says was found; `None`: it was not there.
pub fn found(value: Option<&Value>) -> String {
    value.map_or("nothing".into(), |value| shown(&line(value).replace(STAND_IN, "")))
}

/// The same with single quotation marks, as settings are quoted, and none around what is no finite number.
pub fn found_setting(value: &Value) -> String {
    let not_finite = value.as_str().and_then(|text| text.strip_prefix(STAND_IN));
    match not_finite {
        Some(word @ ("NaN" | "Infinity" | "-Infinity")) => word.into(),
        _ => shown(&written(value, b"'").replace(STAND_IN, "")),
    }
}

/// What a value is.
pub fn kind(value: &Value) -> &'static str {
    match value {
        Value::Object(_) => "an object",
        Value::Array(_) => "a list",
        Value::String(_) => "a text",
        Value::Bool(_) => "true or false",
        Value::Null => "null",
        Value::Number(_) => "a number",
    }
}

fn written(value: &Value, quotation_mark: &'static [u8]) -> String {
    let mut bytes = Vec::new();
    let mut serializer = Serializer::with_formatter(&mut bytes, Spaced { quotation_mark });
    value.serialize(&mut serializer).expect("values can be written, and a Vec takes everything");
    String::from_utf8(bytes).expect("JSON is UTF-8")
}
