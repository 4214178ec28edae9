//! Lines and tokens of a text file, with their places, so that a token can be replaced and the rest copied.

use std::ops::Range;

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

/// Copies a file with some of its ranges replaced.
pub(crate) struct Patcher<'a> {
    source: &'a [u8],
    copied: usize,
    out: Vec<u8>,
}

impl<'a> Patcher<'a> {
    pub(crate) fn new(source: &'a [u8]) -> Self {
        Patcher { source, copied: 0, out: Vec::with_capacity(source.len() + source.len() / 8) }
    }

    /// Copies up to `range` and skips it: what the caller now writes to the result stands in its place. Ranges must come in
    /// file order; an empty one is an insertion.
    pub(crate) fn replace(&mut self, range: Range<usize>) -> &mut Vec<u8> {
        self.out.extend_from_slice(&self.source[self.copied..range.start]);
        self.copied = range.end;
        &mut self.out
    }

    /// The whole result.
    pub(crate) fn finish(mut self) -> Vec<u8> {
        self.out.extend_from_slice(&self.source[self.copied..]);
        self.out
    }
}
