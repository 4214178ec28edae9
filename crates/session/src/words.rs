//! Parts, places, distances and remedies as reports and advice have them.

use neuralmls_core::Remedy;

use crate::text::general;

/// A part of the shape.
pub(crate) fn percent(part: f64) -> String {
    format!("{} %", general(100.0 * part, 2))
}

/// A place.
pub(crate) fn place(at: &[f64]) -> String {
    format!("({})", at.iter().map(|c| general(*c, 4)).collect::<Vec<_>>().join(", "))
}

/// With what control points would arrive.
pub fn remedy_in_words(remedy: Remedy) -> String {
    match remedy {
        Remedy::Temperature(other) => at_temperature(other),
        Remedy::Affine => "with the affine transform".into(),
    }
}

/// Another temperature.
pub(crate) fn at_temperature(other: f64) -> String {
    format!("at temperature {}", general(other, 6))
}

/// Between two places.
pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}
