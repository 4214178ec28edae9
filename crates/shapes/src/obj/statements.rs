//! The statements of an OBJ file and their words, with their places.

use std::ops::Range;

use crate::text::Lines;

/// A statement: a line, or several that `\` at their ends joins.
pub(super) struct Statement<'a> {
    /// Its first line, from 1.
    pub line: u64,
    /// Where it starts in the file.
    pub start: usize,
    /// Its bytes without the last line's ending.
    pub bytes: &'a [u8],
}

impl<'a> Statement<'a> {
    /// The places of its words in `bytes`, up to a comment.
    #[inline]
    pub(super) fn words(&self) -> Words<'a> {
        Words { bytes: self.bytes, at: 0 }
    }

    /// Where it ends in the file.
    pub(super) fn end(&self) -> usize {
        self.start + self.bytes.len()
    }
}

pub(super) struct Statements<'a> {
    source: &'a [u8],
    lines: Lines<'a>,
}

impl<'a> Statements<'a> {
    pub(super) fn new(source: &'a [u8]) -> Self {
        Statements { source, lines: Lines::new(source) }
    }
}

impl<'a> Iterator for Statements<'a> {
    type Item = Statement<'a>;

    #[inline]
    fn next(&mut self) -> Option<Statement<'a>> {
        let first = self.lines.next()?;
        let mut end = first.start + first.bytes.len();
        // A comment does not go on: one that ends in a Windows path must not swallow the next vertex.
        if first.bytes.ends_with(b"\\") && !first.bytes.trim_ascii_start().starts_with(b"#") {
            for line in self.lines.by_ref() {
                end = line.start + line.bytes.len();
                if !line.bytes.ends_with(b"\\") {
                    break;
                }
            }
        }
        Some(Statement { line: first.number, start: first.start, bytes: &self.source[first.start..end] })
    }
}

#[derive(Clone)]
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
}

/// What a byte is between or within words.
#[derive(Clone, Copy, PartialEq)]
enum Class {
    Word,
    Gap,
    Comment,
    /// A gap before a line's end, which it joins with the next; else part of a word.
    Backslash,
}

/// A table, since this is what reading a large file spends its time on.
const CLASSES: [Class; 256] = {
    let mut classes = [Class::Word; 256];
    let mut byte = 0;
    while byte < 256 {
        classes[byte] = match byte as u8 {
            b'#' => Class::Comment,
            b'\\' => Class::Backslash,
            white if white.is_ascii_whitespace() => Class::Gap,
            _ => Class::Word,
        };
        byte += 1;
    }
    classes
};

impl Words<'_> {
    /// The class of the byte that is next; a comment at the end.
    #[inline]
    fn class(&self) -> Class {
        match self.bytes.get(self.at).map_or(Class::Comment, |&byte| CLASSES[byte as usize]) {
            Class::Backslash => match self.bytes.get(self.at + 1) {
                None | Some(b'\n' | b'\r') => Class::Gap,
                Some(_) => Class::Word,
            },
            class => class,
        }
    }
}

impl Iterator for Words<'_> {
    type Item = Range<usize>;

    #[inline]
    fn next(&mut self) -> Option<Range<usize>> {
        while self.class() == Class::Gap {
            self.at += 1;
        }
        let from = self.at;
        while self.class() == Class::Word {
            self.at += 1;
        }
        (self.at > from).then_some(from..self.at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words_of(source: &[u8]) -> Vec<(u64, Vec<&[u8]>)> {
        Statements::new(source).map(|s| (s.line, s.words().map(|range| &s.bytes[range]).collect())).collect()
    }

    #[test]
    fn a_backslash_joins_lines() {
        assert_eq!(
            words_of(b"f 1 2\\\r\n 3 \\\n4\nv 1#\n"),
            [(1, vec![&b"f"[..], b"1", b"2", b"3", b"4"]), (4, vec![b"v", b"1"])]
        );
    }

    #[test]
    fn a_comment_does_not_go_on() {
        assert_eq!(words_of(b"# C:\\\nv 1"), [(1, vec![]), (2, vec![&b"v"[..], b"1"])]);
    }
}
