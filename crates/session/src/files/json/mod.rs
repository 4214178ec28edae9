//! The JSON form: session files of version 2 and 1, those of the editor among them.

mod style;
mod write;

pub(crate) use write::json_text;

pub(crate) const FORMAT: &str = "neuralmls-control-points";
