//! Geomview OFF: `[ST][C][N]OFF`, the counts, one line a vertex, one line a face.
//!
//! A vertex line holds the position, then (after what the header names) normal, colour and texture coordinates, in this
//! order. A face line holds the number of corners, their indices from 0, and perhaps a colour. Both may go on in the lines below.
//! `#` starts a comment.

use std::ops::Range;

use crate::document::{Document, Moved, Parsed, Written};
use crate::error::Error;
use crate::facts;
use crate::memory;
use crate::normals;
use crate::number::{self, Style};
use crate::precision::Precision;
use crate::text::{quote, tokens, Line, Lines, Patcher};

/// What the header's prefixes announce for each vertex.
#[derive(Clone, Copy, Default)]
pub(crate) struct Header {
    texture: bool,
    colours: bool,
    normals: bool,
    four: bool,
    any_dim: bool,
}

/// The header that a line starts with, and the rest of the line: `OFF`, `STCNOFF`, also `OFF8 6 12`.
pub(crate) fn split_header(line: &[u8]) -> Option<(Header, &[u8])> {
    let mut header = Header::default();
    let mut rest = line;
    for (prefix, flag) in [
        (&b"ST"[..], &mut header.texture),
        (b"C", &mut header.colours),
        (b"N", &mut header.normals),
        (b"4", &mut header.four),
        (b"n", &mut header.any_dim),
    ] {
        if let Some(behind) = rest.strip_prefix(prefix) {
            (*flag, rest) = (true, behind);
        }
    }
    let rest = rest.strip_prefix(b"OFF")?;
    let ends = rest.first().is_none_or(|b| b.is_ascii_whitespace() || b.is_ascii_digit() || *b == b'#');
    ends.then_some((header, rest))
}

/// A line without its comment and the white space around it, if anything is left.
fn content(line: Line<'_>) -> Option<Line<'_>> {
    let end = memchr::memchr(b'#', line.bytes).unwrap_or(line.bytes.len());
    let text = &line.bytes[..end];
    let indent = text.len() - text.trim_ascii_start().len();
    let bytes = text.trim_ascii();
    (!bytes.is_empty()).then_some(Line { number: line.number, start: line.start + indent, bytes })
}

/// How many vertices and faces the file holds, and where the lines of the vertices start.
struct Counts {
    vertices: usize,
    faces: usize,
    header: Header,
}

/// Reads header and counts, and leaves `lines` at the first vertex.
fn read_counts<'a>(source: &'a [u8], lines: &mut impl Iterator<Item = Line<'a>>) -> Result<Counts, Error> {
    let missing = || Error::malformed("the file ends before the numbers of vertices and faces");
    let mut line = lines.next().ok_or_else(missing)?;
    let mut header = Header::default();
    if let Some((found, rest)) = split_header(line.bytes) {
        header = found;
        if found.four || found.any_dim {
            return Err(Error::unsupported(
                "this OFF file has positions of four or any dimensions (4OFF, nOFF), which is not read",
            ));
        }
        let rest = rest.trim_ascii();
        if rest.starts_with(b"BINARY") {
            return Err(Error::unsupported("this is a binary OFF file, which is not read: save it as text"));
        }
        line = if rest.is_empty() { lines.next().ok_or_else(missing)? } else { Line { bytes: rest, ..line } };
    }
    let counts: Vec<&[u8]> = tokens(line.bytes, 0).map(|range| &line.bytes[range]).collect();
    if !(2..=3).contains(&counts.len()) {
        return Err(Error::at_line(
            line.number,
            format!("expected the numbers of vertices, faces and edges, found {}", quote(line.bytes)),
        ));
    }
    let count = |token: &[u8]| {
        whole(token).ok_or_else(|| {
            Error::at_line(
                line.number,
                format!("expected a number of vertices or faces, found {}", quote(token)),
            )
        })
    };
    let (vertices, faces) = (count(counts[0])?, count(counts[1])?);
    // "0 0 0" and "0" with a line ending are the shortest lines.
    let room = source.len() as u64 + 1;
    if vertices.saturating_mul(6).saturating_add(faces.saturating_mul(2)) > room
        || vertices > u64::from(u32::MAX)
    {
        return Err(Error::at_line(
            line.number,
            format!(
                "the file promises {vertices} vertices and {faces} faces, which {} bytes cannot hold",
                source.len()
            ),
        ));
    }
    Ok(Counts { vertices: vertices as usize, faces: faces as usize, header })
}

/// A number of things; saturates rather than overflows, for the sentence about it.
fn whole(token: &[u8]) -> Option<u64> {
    let digits = token.strip_prefix(b"+").unwrap_or(token);
    (!digits.is_empty() && digits.iter().all(u8::is_ascii_digit)).then(|| {
        digits.iter().fold(0u64, |sum, d| sum.saturating_mul(10).saturating_add(u64::from(d - b'0')))
    })
}

/// The words of a vertex or a face. They may go on in the lines below; then the last of them must end a line, or a row that lacks a
/// number would swallow the next.
struct Row<'a, 'l, L> {
    lines: &'l mut L,
    first: Line<'a>,
    line: Line<'a>,
    /// What is read of `line`.
    at: usize,
}

impl<'a, 'l, L: Iterator<Item = Line<'a>>> Row<'a, 'l, L> {
    /// The row that starts with the next line; `None` at the end of the file.
    fn next(lines: &'l mut L) -> Option<Self> {
        let first = lines.next()?;
        Some(Row { lines, first, line: first, at: 0 })
    }

    /// The next word, and its place in the file.
    #[inline]
    fn word(&mut self) -> Option<(&'a [u8], Range<usize>)> {
        loop {
            let (start, from) = (self.line.start, self.at);
            if let Some(range) = tokens(&self.line.bytes[from..], start + from).next() {
                self.at = range.end - start;
                return Some((&self.line.bytes[range.start - start..self.at], range));
            }
            (self.line, self.at) = (self.lines.next()?, 0);
        }
    }

    /// Whether something stands behind the words that were read. Nothing may where the row went on in other lines.
    fn has_more(&self, expected: &str) -> Result<bool, Error> {
        let has_more = tokens(&self.line.bytes[self.at..], 0).next().is_some();
        if has_more && self.goes_on() {
            return Err(self.short(expected));
        }
        Ok(has_more)
    }

    fn goes_on(&self) -> bool {
        self.line.number != self.first.number
    }

    /// The row has fewer words than it should.
    fn short(&self, expected: &str) -> Error {
        Error::at_line(self.first.number, format!("expected {expected} {}", quote(self.first.bytes)))
    }
}

/// Three numbers and their places in the file.
#[inline]
fn three<'a, L: Iterator<Item = Line<'a>>>(
    row: &mut Row<'a, '_, L>,
    (what, short): (&str, &str),
) -> Result<[(Range<usize>, f64); 3], Error> {
    let mut next = || {
        let (word, range) = row.word().ok_or_else(|| row.short(short))?;
        let value = number::parse(word).ok_or_else(|| {
            let otherwise =
                || format!("expected {what}, found {}, which is not a finite number", quote(word));
            Error::at_line(row.line.number, number::wrong(word, otherwise))
        })?;
        Ok((range, value))
    };
    Ok([next()?, next()?, next()?])
}

/// The position of a vertex, and its normal where they have one.
type Vertex = ([(Range<usize>, f64); 3], Option<[(Range<usize>, f64); 3]>);

/// Reads the next vertex; `None` at the end of the file.
#[inline]
fn read_vertex<'a>(
    lines: &mut impl Iterator<Item = Line<'a>>,
    normals: bool,
) -> Result<Option<Vertex>, Error> {
    let Some(mut row) = Row::next(lines) else { return Ok(None) };
    let position = three(&mut row, POSITION)?;
    let normal = normals.then(|| three(&mut row, NORMAL)).transpose()?;
    row.has_more(if normals { NORMAL.1 } else { POSITION.1 })?;
    Ok(Some((position, normal)))
}

/// What a word should be, and what its row should hold.
const POSITION: (&str, &str) = ("a position", "a position of three numbers, found");
const NORMAL: (&str, &str) = ("a normal", "a normal of three numbers, found");

pub(crate) fn read(source: &[u8]) -> Result<Parsed, Error> {
    let mut lines = Lines::new(source).filter_map(content);
    let counts = read_counts(source, &mut lines)?;
    let mut positions = memory::with_room(3 * counts.vertices)?;
    let mut decimals = 0;
    for index in 0..counts.vertices {
        let (position, _) = read_vertex(&mut lines, counts.header.normals)?.ok_or_else(|| {
            Error::malformed(format!("the file ends after {index} of {} vertices", counts.vertices))
        })?;
        for (range, value) in position {
            decimals = decimals.max(number::decimals(&source[range]));
            positions.push(value);
        }
    }
    let mut triangles = Vec::new();
    let (mut sizes, mut coloured) = (facts::FaceSizes::default(), 0);
    for index in 0..counts.faces {
        let row = Row::next(&mut lines).ok_or_else(|| {
            Error::malformed(format!("the file ends after {index} of {} faces", counts.faces))
        })?;
        let (corners, is_coloured) = read_face(row, counts.vertices, &mut triangles)?;
        sizes.add(corners);
        coloured += usize::from(is_coloured);
    }
    let mut facts = Vec::new();
    sizes.tell(&mut facts);
    for (announced, name, fate) in [
        (counts.header.normals, "normals", "turned with the surface"),
        (counts.header.colours, "vertex colours", "carried over"),
        (counts.header.texture, "texture coordinates", "carried over"),
    ] {
        if announced {
            facts.push((name.into(), format!("{} ({fate})", counts.vertices)));
        }
    }
    if coloured > 0 {
        facts.push(("face colours".into(), format!("{coloured} (carried over)")));
    }
    Ok(Parsed {
        dim: 3,
        positions,
        faces: (counts.faces > 0).then_some(triangles),
        facts,
        document: Box::new(Off { decimals, has_normals: counts.header.normals }),
    })
}

/// Adds a face's triangles and returns its number of corners, and whether it has a colour.
#[inline]
fn read_face<'a>(
    mut row: Row<'a, '_, impl Iterator<Item = Line<'a>>>,
    vertices: usize,
    triangles: &mut Vec<[u32; 3]>,
) -> Result<(usize, bool), Error> {
    const EXPECTED: &str = "a face as its number of corners and their indices, found";
    const SHORT: &str = "a face as its number of corners and their indices, found the end of the line after";
    let next = |row: &mut Row<'a, '_, _>| {
        let (word, _) = row.word().ok_or_else(|| row.short(SHORT))?;
        let wrong = || Error::at_line(row.line.number, format!("expected {EXPECTED} {}", quote(word)));
        whole(word).ok_or_else(wrong)
    };
    let corners = next(&mut row)?;
    let (mut first, mut previous) = (0, 0);
    for corner in 0..corners {
        let index = next(&mut row)?;
        if index >= vertices as u64 && row.goes_on() {
            return Err(row.short(SHORT));
        }
        if index >= vertices as u64 {
            return Err(Error::at_line(
                row.line.number,
                format!("a face's corner is vertex {index}, but the file has {vertices} vertices (counted from 0)"),
            ));
        }
        let index = index as u32;
        match corner {
            0 => first = index,
            1 => {}
            _ => memory::push(triangles, [first, previous, index])?,
        }
        previous = index;
    }
    Ok((corners as usize, row.has_more(SHORT)?))
}

/// How to write it: the vertex lines are found again.
struct Off {
    decimals: usize,
    has_normals: bool,
}

impl Document for Off {
    fn has_normals(&self) -> bool {
        self.has_normals
    }

    fn precision(&self, _axis: usize) -> Precision {
        Precision::Digits(self.decimals)
    }

    fn write(&self, source: &[u8], moved: &Moved<'_>) -> Result<Written, Error> {
        let style = Style::new(self.decimals, moved.after, 3);
        let maps = moved.maps.filter(|_| self.has_normals);
        let mut lines = Lines::new(source).filter_map(content);
        let counts = read_counts(source, &mut lines)?;
        let mut patcher = Patcher::new(source)?;
        for index in 0..counts.vertices {
            let Some((position, normal)) = read_vertex(&mut lines, counts.header.normals)? else { break };
            let mut put = |range: Range<usize>, was: f64, is: f64, style: Style| {
                if style.differs(was, is) {
                    style.print(is, patcher.replace(range)?);
                }
                Ok(())
            };
            let at = 3 * index;
            for (k, (range, _)) in position.into_iter().enumerate() {
                put(range, moved.before[at + k], moved.after[at + k], style)?;
            }
            if let (Some(maps), Some(normal)) = (maps, normal) {
                let was = [normal[0].1, normal[1].1, normal[2].1];
                let is = normals::turn(normals::map_at(maps, index), was);
                let style = Style::for_normal(normal.each_ref().map(|(range, _)| &source[range.clone()]));
                for ((range, was), is) in normal.into_iter().zip(is) {
                    put(range, was, is, style)?;
                }
            }
        }
        Ok(Written { bytes: patcher.finish()?, side_files: Vec::new() })
    }
}
