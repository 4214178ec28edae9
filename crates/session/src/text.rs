//! Numbers and quotations in sentences: alike in every language, and always within one line.

use std::fmt::Write;

/// As many things as a sentence lists.
const LISTED: usize = 5;
/// The most letters of a quotation.
const LONGEST: usize = 60;

/// A text as a sentence may quote it: what is not printable is escaped, what is long is cut.
pub fn shown(text: &str) -> String {
    let mut out = String::new();
    // What is cut anyway need not be escaped, however long it is.
    for letter in text.chars().take(LONGEST + 1) {
        match letter {
            '\n' => out.push_str("\\n"),
            '\r' => out.push_str("\\r"),
            '\t' => out.push_str("\\t"),
            _ if is_printable(letter) => out.push(letter),
            _ => write!(out, "{}", letter.escape_unicode()).expect("a String takes everything"),
        }
    }
    if out.chars().nth(LONGEST).is_some() {
        out = out.chars().take(LONGEST - 3).collect::<String>() + "...";
    }
    out
}

/// Whether a letter stands for itself. Letters of the Unicode category Cf do not show, or turn the writing's direction round.
fn is_printable(letter: char) -> bool {
    !(letter.is_control()
        || matches!(letter, '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}')
        || matches!(letter, '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}'))
}

/// A name in quotation marks.
pub fn quoted(name: &str) -> String {
    format!("'{}'", shown(name))
}

/// Names in a sentence, the first few of many.
pub fn names<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    listed(names.into_iter().map(quoted))
}

/// Things in a sentence, the first few of many.
pub fn listed(things: impl IntoIterator<Item = String>) -> String {
    let mut all: Vec<String> = things.into_iter().collect();
    if all.len() > LISTED {
        return format!("{} and {} more", all[..LISTED].join(", "), all.len() - LISTED);
    }
    match all.pop() {
        Some(last) if !all.is_empty() => format!("{} and {last}", all.join(", ")),
        Some(only) => only,
        None => String::new(),
    }
}

/// The shortest text that reads back as the same double, as Python's `repr` writes it: `1.0`, `1e+16`, `inf`.
pub fn float(value: f64) -> String {
    if !value.is_finite() {
        return value.to_string().to_lowercase();
    }
    let scientific = format!("{value:e}");
    let (mantissa, exponent) = scientific.split_once('e').expect("{:e} writes an e");
    let exponent: i32 = exponent.parse().expect("{:e} writes a whole exponent");
    if value == 0.0 || (-4..16).contains(&exponent) {
        format!("{value:?}")
    } else {
        with_exponent(mantissa, exponent)
    }
}

/// As [`float`], but whole numbers without `.0`. The sign of -0 needs it: `-0` is a whole number to some readers.
pub fn number(value: f64) -> String {
    let text = float(value);
    match text.strip_suffix(".0") {
        Some(whole) if whole != "-0" => whole.to_string(),
        _ => text,
    }
}

/// C's `%.{digits}g`.
pub fn general(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return value.to_string().to_lowercase();
    }
    let scientific = format!("{value:.*e}", digits - 1);
    let (mantissa, exponent) = scientific.split_once('e').expect("{:e} writes an e");
    let exponent: i32 = exponent.parse().expect("{:e} writes a whole exponent");
    if (-4..digits as i32).contains(&exponent) {
        let places = (digits as i32 - 1 - exponent) as usize;
        trimmed(&format!("{value:.places$}")).to_string()
    } else {
        with_exponent(trimmed(mantissa), exponent)
    }
}

fn with_exponent(mantissa: &str, exponent: i32) -> String {
    let sign = if exponent < 0 { '-' } else { '+' };
    format!("{mantissa}e{sign}{:02}", exponent.abs())
}

fn trimmed(text: &str) -> &str {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        text
    }
}

/// Numbers in round brackets.
pub fn tuple(values: &[f64], each: impl Fn(f64) -> String) -> String {
    let all: Vec<String> = values.iter().map(|&value| each(value)).collect();
    format!("({})", all.join(", "))
}

/// Numbers as JSON has them, for a sentence.
pub fn shown_numbers(values: &[f64]) -> String {
    let all: Vec<String> = values.iter().map(|&value| number(value)).collect();
    shown(&format!("[{}]", all.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_python_writes_them() {
        for (value, text) in [
            (0.0, "0.0"),
            (-0.0, "-0.0"),
            (1.0, "1.0"),
            (0.1, "0.1"),
            (1e-4, "0.0001"),
            (1e-5, "1e-05"),
            (123456789.0, "123456789.0"),
            (1e15, "1000000000000000.0"),
            (1e16, "1e+16"),
            (-1.5e300, "-1.5e+300"),
            (5e-324, "5e-324"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "nan"),
        ] {
            assert_eq!(float(value), text);
        }
        assert_eq!([number(2.0), number(-0.0), number(0.5)], ["2", "-0.0", "0.5"]);
    }

    #[test]
    fn general_is_as_in_c() {
        for (value, digits, text) in [
            (0.0, 9, "0"),
            (0.95, 9, "0.95"),
            (3998.0, 6, "3998"),
            (999_999.9, 6, "1e+06"),
            (1e150, 6, "1e+150"),
            (0.000_012_345_678, 6, "1.23457e-05"),
            (100.0, 3, "100"),
            (-2.5, 6, "-2.5"),
            (0.0001, 6, "0.0001"),
        ] {
            assert_eq!(general(value, digits), text);
        }
    }

    #[test]
    fn quotations_are_one_line_and_short() {
        assert_eq!(quoted("a\nb\u{202e}c\t"), "'a\\nb\\u{202e}c\\t'");
        assert_eq!(quoted("é 中 'x'"), "'é 中 'x''");
        assert_eq!(shown(&"a".repeat(60)), "a".repeat(60));
        assert_eq!(shown(&"\u{1}".repeat(61)).chars().count(), 60);
        assert_eq!(shown(&"a".repeat(61)), "a".repeat(57) + "...");
    }

    #[test]
    fn lists_name_the_first_five() {
        assert_eq!(names(["a"]), "'a'");
        assert_eq!(names(["a", "b", "c"]), "'a', 'b' and 'c'");
        assert_eq!(names(["a"; 7]), "'a', 'a', 'a', 'a', 'a' and 2 more");
    }
}
