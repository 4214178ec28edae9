//! Numbers, places and names as sentences have them.

/// As many names as a sentence lists.
const LISTED: usize = 5;

/// A number with so many significant digits and no needless zeros, as C's `%g` has it.
pub(crate) fn general(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value.is_finite() { "0".into() } else { value.to_string() };
    }
    let scientific = format!("{:.*e}", digits - 1, value);
    let (mantissa, exponent) = scientific.split_once('e').expect("a number with an exponent");
    let exponent: i32 = exponent.parse().expect("a whole number");
    let trimmed = |text: &str| match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_string(),
        false => text.to_string(),
    };
    if exponent < -4 || exponent >= digits as i32 {
        let sign = if exponent < 0 { '-' } else { '+' };
        return format!("{}e{sign}{:02}", trimmed(mantissa), exponent.abs());
    }
    trimmed(&format!("{:.*}", (digits as i32 - 1 - exponent) as usize, value))
}

/// A part of the shape.
pub(crate) fn percent(part: f64) -> String {
    format!("{} %", general(100.0 * part, 2))
}

/// A place.
pub(crate) fn place(at: &[f64]) -> String {
    format!("({})", at.iter().map(|c| general(*c, 4)).collect::<Vec<_>>().join(", "))
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
    fn numbers_are_written_as_c_writes_them() {
        for (value, digits, expected) in [
            (0.0, 3, "0"),
            (1.0, 6, "1"),
            (0.05, 3, "0.05"),
            (123_456.0, 3, "1.23e+05"),
            (0.000_012_34, 3, "1.23e-05"),
            (99.96, 3, "100"),
            (999.6, 3, "1e+03"),
            (-2.5, 4, "-2.5"),
            (0.7, 6, "0.7"),
        ] {
            assert_eq!(general(value, digits), expected);
        }
    }

    #[test]
    fn long_lists_are_cut() {
        let names: Vec<String> = (1..=7).map(|i| format!("p{i}")).collect();
        assert_eq!(listed(&names), "p1, p2, p3, p4, p5 and 2 more");
        assert_eq!(listed(&names[..2]), "p1, p2");
    }
}
