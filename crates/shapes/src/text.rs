//! Lines and tokens of a text file, with their places, so that a token can be replaced and the rest copied.

use std::ops::Range;

use crate::error::Error;
use crate::memory;

/// No number takes more bytes when it is printed.
pub(crate) const LONGEST_NUMBER: usize = 400;

/// A line of a text file.
#[derive(Clone, Copy)]
pub(crate) struct Line<'a> {
    /// Counted from 1.
    pub number: u64,
    /// Where it starts in the file.
    pub start: usize,
    /// Its bytes, without the line ending.
    pub bytes: &'a [u8],
}

/// The lines of a file; they end in LF, CRLF or CR. A UTF-8 byte order mark at the start belongs to no line.
pub(crate) struct Lines<'a> {
    source: &'a [u8],
    at: usize,
    number: u64,
}

impl<'a> Lines<'a> {
    pub(crate) fn new(source: &'a [u8]) -> Self {
        Lines { source, at: bom_length(source), number: 0 }
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    #[inline]
    fn next(&mut self) -> Option<Line<'a>> {
        let rest = self.source.get(self.at..).filter(|rest| !rest.is_empty())?;
        self.number += 1;
        let start = self.at;
        let length = memchr::memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
        self.at += length + if rest[length..].starts_with(b"\r\n") { 2 } else { 1 };
        self.at = self.at.min(self.source.len());
        Some(Line { number: self.number, start, bytes: &rest[..length] })
    }
}

/// The length of the UTF-8 byte order mark at the start of a file: 3, or 0 where there is none.
pub(crate) fn bom_length(source: &[u8]) -> usize {
    if source.starts_with(b"\xef\xbb\xbf") {
        3
    } else {
        0
    }
}

/// The tokens of `line` (runs of anything but ASCII white space), as ranges of the file when `start` is the line's offset in it.
pub(crate) fn tokens(line: &[u8], start: usize) -> impl Iterator<Item = Range<usize>> + '_ {
    let mut at = 0;
    std::iter::from_fn(move || {
        at += line[at..].iter().position(|b| !b.is_ascii_whitespace())?;
        let from = at;
        at = line[from..].iter().position(u8::is_ascii_whitespace).map_or(line.len(), |n| from + n);
        Some(start + from..start + at)
    })
}

/// The token as text for an error message: printable, and not longer than a person wants to read.
pub(crate) fn quote(token: &[u8]) -> String {
    const LONGEST: usize = 32;
    let shown: String = String::from_utf8_lossy(&token[..token.len().min(LONGEST)])
        .chars()
        .flat_map(char::escape_debug)
        .collect();
    if token.len() > LONGEST {
        format!("'{shown}...'")
    } else {
        format!("'{shown}'")
    }
}

/// A name or sentence of a file as text that does no harm on a terminal or a page: what is not printable (line ends, marks that turn
/// the direction of writing) is spelled out.
pub(crate) fn printable(text: &[u8]) -> String {
    String::from_utf8_lossy(text).chars().map(printable_char).collect()
}

fn printable_char(c: char) -> String {
    match c {
        '\'' | '"' | '\\' => c.into(),
        c => c.escape_debug().collect(),
    }
}

/// Copies a file with some of its ranges replaced.
pub(crate) struct Patcher<'a> {
    source: &'a [u8],
    copied: usize,
    out: Vec<u8>,
}

impl<'a> Patcher<'a> {
    pub(crate) fn new(source: &'a [u8]) -> Result<Self, Error> {
        let out = memory::with_room(source.len() + source.len() / 8)?;
        Ok(Patcher { source, copied: 0, out })
    }

    /// Copies up to `range` and skips it: what the caller now writes to the result stands in its place. Ranges must come in
    /// file order; an empty one is an insertion. There is room for a number.
    pub(crate) fn replace(&mut self, range: Range<usize>) -> Result<&mut Vec<u8>, Error> {
        let between = &self.source[self.copied..range.start];
        memory::reserve(&mut self.out, between.len() + LONGEST_NUMBER)?;
        self.out.extend_from_slice(between);
        self.copied = range.end;
        Ok(&mut self.out)
    }

    /// The whole result.
    pub(crate) fn finish(mut self) -> Result<Vec<u8>, Error> {
        memory::append(&mut self.out, &self.source[self.copied..])?;
        Ok(self.out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_lf_crlf_or_cr() {
        let source = b"\xef\xbb\xbfa\nb\r\n\rc";
        let lines: Vec<_> = Lines::new(source).map(|l| (l.number, l.start, l.bytes)).collect();
        assert_eq!(lines, [(1, 3, &b"a"[..]), (2, 5, b"b"), (3, 8, b""), (4, 9, b"c")]);
    }

    #[test]
    fn a_patched_file_differs_in_the_patched_ranges_only() {
        let mut patcher = Patcher::new(b"v 1 2 3").unwrap();
        patcher.replace(4..5).unwrap().extend_from_slice(b"20");
        patcher.replace(7..7).unwrap().push(b'!');
        assert_eq!(patcher.finish().unwrap(), b"v 1 20 3!");
    }

    #[test]
    fn what_turns_or_breaks_a_line_is_spelled_out() {
        assert_eq!(printable("O'Neil \"\u{e9}\u{202e}\n".as_bytes()), "O'Neil \"\u{e9}\\u{202e}\\n");
    }

    #[test]
    fn a_quoted_token_is_short_and_printable() {
        assert_eq!(quote(b"a\x1b\xff"), "'a\\u{1b}\u{fffd}'");
        assert_eq!(quote(&[b'x'; 99]).len(), 32 + 5);
    }
}
