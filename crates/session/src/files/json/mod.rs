//! The JSON form: session files of version 2 and 1, those of the editor among them.

mod editor;
mod entry;
mod parse;
mod session;
mod settings;
mod style;
mod values;
mod write;

pub(crate) use parse::{parse, Document};
pub(crate) use session::session_of;
pub(crate) use settings::read_settings;
pub(crate) use style::found;
pub(crate) use values::{text, vector};
pub(crate) use write::{json_text, settings_value};

pub(crate) const FORMAT: &str = "neuralmls-control-points";
