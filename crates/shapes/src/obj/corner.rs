//! A corner of a face: `v`, `v/vt`, `v//vn` or `v/vt/vn`, counted from 1, or backwards from -1.

use std::ops::Range;

pub(super) struct Corner {
    pub vertex: i64,
    /// The normal, and its place in the word.
    pub normal: Option<(i64, Range<usize>)>,
}

impl Corner {
    #[inline]
    pub(super) fn parse(word: &[u8]) -> Option<Corner> {
        let Some(first) = word.iter().position(|&b| b == b'/') else {
            return Some(Corner { vertex: whole(word)?, normal: None });
        };
        let vertex = whole(&word[..first])?;
        let rest = &word[first + 1..];
        let second = rest.iter().position(|&b| b == b'/');
        let texture = &rest[..second.unwrap_or(rest.len())];
        if !texture.is_empty() {
            whole(texture)?;
        }
        // Some exporters leave the slashes where nothing follows.
        let normal = match second.map(|second| first + second + 2).filter(|&from| from < word.len()) {
            Some(from) => Some((whole(&word[from..])?, from..word.len())),
            None => None,
        };
        Some(Corner { vertex, normal })
    }
}

/// A whole number with or without a sign, up to 12 digits. (`str::parse` would check the text as UTF-8 first.)
#[inline]
fn whole(word: &[u8]) -> Option<i64> {
    let (negative, digits) = match word {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] => (false, digits),
        digits => (false, digits),
    };
    if digits.is_empty() || digits.len() > 12 {
        return None;
    }
    let mut value = 0;
    for &digit in digits {
        if !digit.is_ascii_digit() {
            return None;
        }
        value = 10 * value + i64::from(digit - b'0');
    }
    Some(if negative { -value } else { value })
}

/// The index from 0 that a number of a file stands for where `count` are defined so far. Absolute ones may point ahead.
#[inline]
pub(super) fn resolve(number: i64, count: usize) -> Option<u32> {
    let index = if number > 0 { number - 1 } else { number + count as i64 };
    let valid = number != 0 && index >= 0 && index < i64::from(u32::MAX);
    valid.then_some(index as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_of_every_form() {
        let parsed = |word: &[u8]| Corner::parse(word).map(|c| (c.vertex, c.normal));
        assert_eq!(parsed(b"7"), Some((7, None)));
        assert_eq!(parsed(b"-7/2"), Some((-7, None)));
        assert_eq!(parsed(b"7//-3"), Some((7, Some((-3, 3..5)))));
        assert_eq!(parsed(b"7/12/3"), Some((7, Some((3, 5..6)))));
        assert_eq!(parsed(b"7//"), Some((7, None)));
        for word in [&b""[..], b"/1", b"1.0", b"1/x", b"1/2/3/4", b"--1", b"1e3", b"9999999999999", b"nan"] {
            assert_eq!(parsed(word), None, "{}", String::from_utf8_lossy(word));
        }
    }

    #[test]
    fn negative_numbers_count_back() {
        assert_eq!(resolve(-1, 3), Some(2));
        assert_eq!(resolve(-4, 3), None);
        assert_eq!(resolve(0, 3), None);
        assert_eq!(resolve(9, 3), Some(8));
    }
}
