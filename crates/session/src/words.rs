//! Parts, places, lists and remedies as reports and advice have them.

use neuralmls_core::Remedy;

use crate::text::general;

/// As many names as a sentence lists.
const LISTED: usize = 5;

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

/// Things of a list, the first few of them, and how many more there are.
pub(crate) fn listed(things: &[String]) -> String {
    let mut text = things[..things.len().min(LISTED)].join(", ");
    if things.len() > LISTED {
        text += &format!(" and {} more", things.len() - LISTED);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lists_are_cut() {
        let names: Vec<String> = (1..=7).map(|i| format!("p{i}")).collect();
        assert_eq!(listed(&names), "p1, p2, p3, p4, p5 and 2 more");
        assert_eq!(listed(&names[..2]), "p1, p2");
    }
}
