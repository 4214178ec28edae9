//! Numbers in text files: read as `f64`, printed with as many decimals as the file and the size of the shape ask for.

use std::io::Write;

use crate::bounds::Bounds;
use crate::text::quote;

/// The number that a token stands for. `1e5`, `+.5`, `-3.` are numbers; `nan`, `inf` and anything else are `None`.
pub(crate) fn parse(token: &[u8]) -> Option<f64> {
    let token =
        token.strip_prefix(b"+").filter(|t| !t.starts_with(b"-") && !t.starts_with(b"+")).unwrap_or(token);
    fast_float2::parse(token).ok().filter(|v: &f64| v.is_finite())
}

/// Whether a token is a number but for a comma in the place of its point.
pub(crate) fn has_decimal_comma(token: &[u8]) -> bool {
    let Some(at) = token.iter().position(|&byte| byte == b',') else { return false };
    let digit = |at: usize| token.get(at).is_some_and(u8::is_ascii_digit);
    let mut point = token.to_vec();
    point[at] = b'.';
    at > 0 && digit(at - 1) && digit(at + 1) && parse(&point).is_some()
}

/// What is wrong with a token that is no number: a decimal comma, or else what `otherwise` says.
pub(crate) fn wrong(token: &[u8], otherwise: impl FnOnce() -> String) -> String {
    if has_decimal_comma(token) {
        format!("decimal commas are not read, expected a decimal point, found {}", quote(token))
    } else {
        otherwise()
    }
}

/// How many digits a token has behind its decimal point (an exponent moves the point).
pub(crate) fn decimals(token: &[u8]) -> usize {
    let (mut dot, mut end, mut exponent) = (None, token.len(), 0i64);
    for (at, byte) in token.iter().enumerate() {
        match byte {
            b'.' => dot = Some(at),
            b'e' | b'E' => {
                end = at;
                exponent =
                    std::str::from_utf8(&token[at + 1..]).ok().and_then(|e| e.parse().ok()).unwrap_or(0);
                break;
            }
            _ => {}
        }
    }
    let behind = dot.map_or(0, |dot| end - dot - 1) as i64;
    (behind - exponent.clamp(-400, 400)).clamp(0, 400) as usize
}

/// How positions are printed: with a fixed number of decimals, or, for shapes so large or small that it would take more than 17
/// digits, in the shortest form that reads back as the same number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Style {
    Fixed(usize),
    Shortest,
}

impl Style {
    /// As many decimals as the most precise token of the file had, and enough for a ten-millionth of the longest side of the
    /// positions' box (of the largest coordinate, where they are all in one place).
    pub(crate) fn new(decimals_in_file: usize, positions: &[f64], dim: usize) -> Style {
        let bounds = Bounds::of(positions, dim);
        let longest = bounds.longest();
        let largest = bounds.largest().into_iter().fold(0.0, f64::max);
        let size = [longest, largest].into_iter().find(|&size| size > 0.0).unwrap_or(1.0);
        let for_size = (7.0 - size.log10()).ceil();
        let decimals = (decimals_in_file as f64).max(for_size);
        let digits_before = if largest > 1.0 { largest.log10().floor() + 1.0 } else { 1.0 };
        if decimals + digits_before > 17.0 {
            Style::Shortest
        } else {
            Style::Fixed(decimals.max(0.0) as usize)
        }
    }

    /// For a normal whose numbers were these tokens: as many decimals as they had, at least six.
    pub(crate) fn for_normal(tokens: [&[u8]; 3]) -> Style {
        match tokens.map(decimals).into_iter().fold(6, usize::max) {
            decimals @ ..=15 => Style::Fixed(decimals),
            _ => Style::Shortest,
        }
    }

    /// Whether `after` prints as another number than `before`: a coordinate that moved by less than the last printed digit keeps its token.
    pub(crate) fn differs(self, before: f64, after: f64) -> bool {
        match self {
            Style::Fixed(decimals) => {
                after != before && (after - before).abs() >= 0.5 * 10f64.powi(-(decimals as i32))
            }
            Style::Shortest => after != before,
        }
    }

    /// The number that `value` is when it is printed and read again.
    pub(crate) fn rounded(self, value: f64) -> f64 {
        let Style::Fixed(decimals) = self else { return value };
        if let Some(scaled) = scaled(value, decimals) {
            // Both are exact, so that the quotient is the double that is nearest to the printed decimal.
            return scaled / 10f64.powi(decimals as i32);
        }
        let mut printed = Vec::new();
        self.print(value, &mut printed);
        parse(&printed).unwrap_or(value)
    }

    /// Prints `value`, without trailing zeros and without `-0`.
    pub(crate) fn print(self, value: f64, out: &mut Vec<u8>) {
        let start = out.len();
        if let Style::Fixed(decimals) = self {
            if print_scaled(value, decimals, out) {
                return;
            }
        }
        match self {
            Style::Fixed(decimals) => write!(out, "{value:.decimals$}"),
            Style::Shortest if value != 0.0 && !(1e-5..1e17).contains(&value.abs()) => {
                write!(out, "{value:e}")
            }
            Style::Shortest => write!(out, "{value}"),
        }
        .expect("a Vec takes all that is written");
        if out[start..].contains(&b'.') && !out[start..].contains(&b'e') {
            while out.last() == Some(&b'0') {
                out.pop();
            }
            if out.last() == Some(&b'.') {
                out.pop();
            }
        }
        if &out[start..] == b"-0" {
            out.remove(start);
        }
    }
}

/// A number scaled to a whole one and rounded. `None` where that would not be exact enough: the product is off by half a unit in its
/// last place, which decides where the number lies halfway between two decimals.
fn scaled(value: f64, decimals: usize) -> Option<f64> {
    const EXACT: f64 = (1u64 << 53) as f64;
    if decimals > 15 {
        return None;
    }
    let product = value * 10f64.powi(decimals as i32);
    let scaled = product.round();
    let to_halfway = ((product - product.trunc()).abs() - 0.5).abs();
    (!scaled.is_nan() && to_halfway > 2.0 * product.abs() / EXACT).then_some(scaled)
}

/// [`Style::print`] for what is left of most numbers when they are scaled to whole ones: several times as fast as `{:.n}`,
/// which is what takes the time in writing a large file. False, and nothing printed, where that is not exact enough.
fn print_scaled(value: f64, decimals: usize, out: &mut Vec<u8>) -> bool {
    let Some(scaled) = scaled(value, decimals) else { return false };
    let (mut rest, mut decimals) = (scaled.abs() as u64, decimals);
    while decimals > 0 && rest % 10 == 0 {
        rest /= 10;
        decimals -= 1;
    }
    let mut digits = [0u8; 20];
    let mut at = digits.len();
    let mut printed = 0;
    while rest > 0 || printed <= decimals {
        if decimals > 0 && printed == decimals {
            at -= 1;
            digits[at] = b'.';
        }
        at -= 1;
        digits[at] = b'0' + (rest % 10) as u8;
        rest /= 10;
        printed += 1;
    }
    if scaled < 0.0 {
        at -= 1;
        digits[at] = b'-';
    }
    out.extend_from_slice(&digits[at..]);
    true
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn printed(style: Style, value: f64) -> String {
        let mut out = Vec::new();
        style.print(value, &mut out);
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn reads_what_files_hold() {
        for (token, value) in
            [("1", 1.0), ("+.5", 0.5), ("-3.", -3.0), ("1e-3", 1e-3), ("-0", 0.0), ("1E+2", 100.0)]
        {
            assert_eq!(parse(token.as_bytes()), Some(value), "{token}");
        }
        for token in ["nan", "inf", "-inf", "1e999", "", "+", "+-1", "++1", "1,5", "0x10", "1.2.3"] {
            assert_eq!(parse(token.as_bytes()), None, "{token}");
        }
    }

    #[test]
    fn counts_decimals() {
        for (token, count) in [("1", 0), ("1.", 0), ("-0.250", 3), ("1.5e-3", 4), ("1.5e3", 0), ("1e-2", 2)] {
            assert_eq!(decimals(token.as_bytes()), count, "{token}");
        }
    }

    #[test]
    fn prints_as_precisely_as_the_file_and_the_shape_ask() {
        assert_eq!(Style::new(6, &[0.0, 1.0], 1), Style::Fixed(7));
        assert_eq!(Style::new(9, &[0.0, 1.0], 1), Style::Fixed(9));
        assert_eq!(Style::new(3, &[500_000.0, 500_100.0], 1), Style::Fixed(5));
        assert_eq!(Style::new(0, &[0.0, 1e-30], 1), Style::Shortest);
        assert_eq!(Style::new(0, &[0.5, 0.5], 1), Style::Fixed(8));
        assert_eq!(Style::new(2, &[0.0, 0.0], 2), Style::Fixed(7));
    }

    #[test]
    fn prints_no_needless_digits() {
        assert_eq!(printed(Style::Fixed(6), 0.5), "0.5");
        assert_eq!(printed(Style::Fixed(6), -1e-9), "0");
        assert_eq!(printed(Style::Fixed(0), 10.0), "10");
        assert_eq!(printed(Style::Shortest, 1e-30), "1e-30");
        assert_eq!(printed(Style::Shortest, 100.0), "100");
    }

    #[test]
    fn what_lies_halfway_is_printed_the_plain_way() {
        for (value, decimals) in
            [(-996387.948554865, 8), (0.5, 0), (2.5, 0), (0.125, 2), (4503599627370497.5, 0)]
        {
            let mut out = Vec::new();
            assert!(!print_scaled(value, decimals, &mut out), "{value}");
            assert!(out.is_empty());
        }
        assert!(print_scaled(0.1, 8, &mut Vec::new()));
    }

    proptest! {
        #[test]
        fn rounding_is_printing_and_reading(value in -1e7f64..1e7, decimals in 0usize..17) {
            for style in [Style::Fixed(decimals), Style::Shortest] {
                prop_assert_eq!(style.rounded(value), parse(printed(style, value).as_bytes()).unwrap());
            }
        }

        #[test]
        fn the_fast_print_is_the_plain_one(value in -1e6f64..1e6, decimals in 0usize..9) {
            let mut fast = Vec::new();
            prop_assume!(print_scaled(value, decimals, &mut fast));
            let fast = String::from_utf8(fast).unwrap();
            let plain = format!("{value:.decimals$}");
            prop_assert_eq!(parse(fast.as_bytes()), parse(plain.as_bytes()), "{} {}", fast, plain);
            prop_assert!(!fast.contains('.') || !fast.ends_with(['0', '.']));
            prop_assert_ne!(fast, "-0");
        }
    }
}
