//! Ascii STL: `solid`, and `facet normal`, `outer loop`, three `vertex` a triangle.

use super::{faces, moved_normal, triangle};
use crate::document::{Document, Moved, Parsed, Written};
use crate::error::Error;
use crate::facts::Names;
use crate::memory;
use crate::number::{self, Style};
use crate::precision::Precision;
use crate::text::{self, Patcher};
use std::ops::Range;

/// The words of the file, one after the other.
struct Words<'a> {
    source: &'a [u8],
    at: usize,
}

impl<'a> Words<'a> {
    fn new(source: &'a [u8]) -> Self {
        Words { source, at: text::bom_length(source) }
    }

    fn next(&mut self) -> Option<Range<usize>> {
        let word = text::tokens(&self.source[self.at..], self.at).next()?;
        self.at = word.end;
        Some(word)
    }

    fn is(&self, word: &Range<usize>, keyword: &str) -> bool {
        self.source[word.clone()].eq_ignore_ascii_case(keyword.as_bytes())
    }

    /// The next word, which must be `keyword` in any case.
    fn expect(&mut self, keyword: &str) -> Result<(), Error> {
        match self.next() {
            Some(word) if self.is(&word, keyword) => Ok(()),
            word => Err(self.wrong(word, &format!("'{keyword}'"))),
        }
    }

    fn three(&mut self) -> Result<[Range<usize>; 3], Error> {
        let mut word = || self.next().ok_or(());
        match (word(), word(), word()) {
            (Ok(x), Ok(y), Ok(z)) => Ok([x, y, z]),
            _ => Err(self.wrong(None, "three coordinates")),
        }
    }

    /// What is left of the line.
    fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = &self.source[self.at..];
        let length = rest.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(rest.len());
        self.at += length;
        rest[..length].trim_ascii()
    }

    fn wrong(&self, word: Option<Range<usize>>, expected: &str) -> Error {
        let (at, found) = match word {
            Some(word) => (word.start, format!("found {}", text::quote(&self.source[word]))),
            None => (self.source.len(), "the file ends".into()),
        };
        Error::at_line(self.line_of(at), format!("expected {expected}, {found}"))
    }

    fn no_number(&self, word: Range<usize>) -> Error {
        let found = &self.source[word.clone()];
        let otherwise = || format!("expected a finite number, found {}", text::quote(found));
        Error::at_line(self.line_of(word.start), number::wrong(found, otherwise))
    }

    fn line_of(&self, at: usize) -> u64 {
        let line_ends = |ends: u8| self.source[..at].iter().filter(|&&b| b == ends).count();
        1 + line_ends(b'\n').max(line_ends(b'\r')) as u64
    }
}

/// The places of a triangle's numbers.
struct Facet {
    normal: [Range<usize>; 3],
    corners: [Range<usize>; 9],
    positions: [f64; 9],
}

/// Shows `see` each facet; returns the names of the solids.
fn each_facet(source: &[u8], mut see: impl FnMut(Facet) -> Result<(), Error>) -> Result<Vec<&[u8]>, Error> {
    let words = &mut Words::new(source);
    let mut names = Vec::new();
    let mut open = false;
    while let Some(word) = words.next() {
        if words.is(&word, "facet") && open {
            words.expect("normal")?;
            let normal = words.three()?;
            words.expect("outer")?;
            words.expect("loop")?;
            let mut corners: [Range<usize>; 9] = Default::default();
            let mut positions = [0.0; 9];
            for corner in 0..3 {
                words.expect("vertex")?;
                for (k, word) in (3 * corner..).zip(words.three()?) {
                    let value = number::parse(&words.source[word.clone()]);
                    positions[k] = value.ok_or_else(|| words.no_number(word.clone()))?;
                    corners[k] = word;
                }
            }
            words.expect("endloop")?;
            words.expect("endfacet")?;
            see(Facet { normal, corners, positions })?;
        } else if words.is(&word, "endsolid") && open {
            words.rest_of_line();
            open = false;
        } else if words.is(&word, "solid") && !open {
            memory::push(&mut names, words.rest_of_line())?;
            open = true;
        } else {
            return Err(words.wrong(Some(word), if open { "'facet' or 'endsolid'" } else { "'solid'" }));
        }
    }
    if open {
        return Err(words.wrong(None, "'facet' or 'endsolid'"));
    }
    Ok(names)
}

pub(super) fn read(source: &[u8]) -> Result<Parsed, Error> {
    let mut positions = Vec::new();
    let mut decimals = 0;
    let solids = each_facet(source, |facet| {
        memory::reserve(&mut positions, 9)?;
        positions.extend(facet.positions);
        let most = facet.corners.iter().map(|word| number::decimals(&source[word.clone()])).max();
        decimals = decimals.max(most.unwrap_or(0));
        Ok(())
    })?;
    let mut facts = vec![("encoding".into(), "ascii".into())];
    let mut names = Names::default();
    solids.into_iter().try_for_each(|name| names.add(name))?;
    names.tell("solids", &mut facts);
    facts.push(("normals".into(), "turned with their triangles".into()));
    Ok(Parsed {
        dim: 3,
        faces: Some(faces(positions.len() / 3)?),
        positions,
        facts,
        document: Box::new(Ascii { decimals }),
    })
}

struct Ascii {
    /// Most decimals of a position.
    decimals: usize,
}

impl Document for Ascii {
    fn has_normals(&self) -> bool {
        false
    }

    fn precision(&self, _axis: usize) -> Precision {
        Precision::Digits(self.decimals)
    }

    fn write(&self, source: &[u8], moved: &Moved<'_>) -> Result<Written, Error> {
        let style = Style::new(self.decimals, moved.after, 3);
        let mut patcher = Patcher::new(source)?;
        let mut index = 0;
        each_facet(source, |facet| {
            let (before, after) = (triangle(moved.before, index), triangle(moved.after, index));
            index += 1;
            let read = |word: &Range<usize>| number::parse(&source[word.clone()]).unwrap_or(f64::NAN);
            let [x, y, z] = &facet.normal;
            let old = [read(x), read(y), read(z)];
            if let Some(normal) = moved_normal(before, after, old) {
                let normal_style = Style::for_normal([x, y, z].map(|word| &source[word.clone()]));
                for ((word, was), value) in facet.normal.into_iter().zip(old).zip(normal) {
                    if was.is_nan() || normal_style.differs(was, value) {
                        normal_style.print(value, patcher.replace(word)?);
                    }
                }
            }
            for ((word, &was), &value) in facet.corners.into_iter().zip(before).zip(after) {
                if style.differs(was, value) {
                    style.print(value, patcher.replace(word)?);
                }
            }
            Ok(())
        })?;
        Ok(Written { bytes: patcher.finish()?, side_files: Vec::new() })
    }
}
