//! The CSV form, as a landmark file.

use std::fmt::Write;

use crate::error::Error;
use crate::session::Session;
use crate::text::float;

pub(crate) const AXES: [&str; 3] = ["x", "y", "z"];

/// Names, positions and targets, every number with as many digits as it takes to read back the same double.
pub(crate) fn csv_text(session: &Session) -> Result<String, Error> {
    let points = &session.points;
    for (what, any) in [
        ("rotations", points.iter().any(|point| point.orientation.is_some())),
        ("groups", points.iter().any(|point| point.group.is_some())),
        ("locks", points.iter().any(|point| point.locked)),
    ] {
        if any {
            let message = format!("a CSV file holds no {what}: write a file that ends in .json");
            return Err(Error::file(message));
        }
    }
    let axes = &AXES[..points.dim()];
    let mut out = format!("name,{},target_{}\n", axes.join(","), axes.join(",target_"));
    for point in points.iter() {
        out.push_str(&cell(&point.name));
        for &value in point.position.iter().chain(&point.target) {
            write!(out, ",{}", float(value)).expect("a String takes everything");
        }
        out.push('\n');
    }
    Ok(out)
}

/// With quotation marks where it would not be one cell otherwise.
fn cell(text: &str) -> String {
    if text.contains([',', ';', '\t', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_string()
    }
}
