//! The body of an ascii PLY file: a row a line.

use super::faces::Faces;
use super::header::{Element, Encoding, Header, Kind};
use super::{check_room, Body, Start, Vertices, FIELDS};
use crate::document::Moved;
use crate::error::Error;
use crate::memory;
use crate::number::{self, Style};
use crate::text::{self, Patcher};
use std::ops::Range;

/// The lines of the body that are not blank.
struct Lines<'a> {
    source: &'a [u8],
    line_end: u8,
    next: Start,
}

impl Lines<'_> {
    /// The next line, and its number.
    fn next(&mut self) -> Option<(Range<usize>, u64)> {
        loop {
            let Start { byte, line } = self.next;
            let rest = self.source.get(byte..).filter(|rest| !rest.is_empty())?;
            let end = byte + memchr::memchr(self.line_end, rest).unwrap_or(rest.len());
            self.next = Start { byte: end + 1, line: line + 1 };
            if !self.source[byte..end].trim_ascii_start().is_empty() {
                return Some((byte..end, line));
            }
        }
    }

    /// The line of row `row` of `element`.
    fn row(&mut self, element: &Element, row: usize) -> Result<(Range<usize>, u64), Error> {
        let line = self.next.line;
        self.next().ok_or_else(|| {
            let (name, count) = (element.shown(), element.count);
            Error::at_line(line, format!("the file ends before row {row} of the {count} of {name}"))
        })
    }
}

/// Shows `see` each number of a row, with the index of its property; lists without their counts. Returns whether the line has
/// more than that, as MeshLab wrote at times: the header's properties are right nevertheless.
fn walk_row(
    element: &Element,
    source: &[u8],
    (line, number): (Range<usize>, u64),
    mut see: impl FnMut(usize, Range<usize>) -> Result<(), Error>,
) -> Result<bool, Error> {
    let wrong = |message: String| Error::at_line(number, message);
    let mut words = text::tokens(&source[line.clone()], line.start);
    for (index, property) in element.properties.iter().enumerate() {
        let ended = || {
            let (name, property) = (element.shown(), property.shown());
            wrong(format!("the row of {name} ends before its property {property} is complete"))
        };
        let word = words.next().ok_or_else(ended)?;
        match property.kind {
            Kind::Scalar(_) => see(index, word)?,
            Kind::List { .. } => {
                let word = &source[word];
                let Some(count) = number::parse(word).filter(|&c| c >= 0.0 && c.fract() == 0.0) else {
                    let (name, shown) = (property.shown(), text::quote(word));
                    return Err(wrong(format!("expected the length of the list {name}, found {shown}")));
                };
                for _ in 0..count as u64 {
                    see(index, words.next().ok_or_else(ended)?)?;
                }
            }
        }
    }
    Ok(words.next().is_some())
}

/// Shows `see` where the fields of each vertex are, and the number of the line. Returns how many lines have more than their row.
fn each_vertex(
    vertices: &Vertices,
    lines: &mut Lines<'_>,
    mut see: impl FnMut(usize, &[Range<usize>; 6], u64) -> Result<(), Error>,
) -> Result<usize, Error> {
    let source = lines.source;
    let mut longer = 0;
    let mut fields: [Range<usize>; 6] = Default::default();
    for row in 0..vertices.element.count {
        let line = lines.row(&vertices.element, row)?;
        let number = line.1;
        let is_longer = walk_row(&vertices.element, source, line, |property, word| {
            if let Some(slot) = vertices.slots[property] {
                fields[slot] = word;
            }
            Ok(())
        })?;
        longer += usize::from(is_longer);
        see(row, &fields, number)?;
    }
    Ok(longer)
}

pub(super) fn read(
    source: &[u8],
    header: &Header,
    vertices: &Vertices,
    faces: &mut Faces,
) -> Result<Body, Error> {
    let next = Start { byte: header.body, line: header.body_line };
    let mut lines = Lines { source, line_end: header.line_end, next };
    let mut body = Body { positions: Vec::new(), start: next, decimals: 0, longer: 0, extra: 0 };
    let mut corners = Vec::new();
    for (index, element) in header.elements.iter().enumerate() {
        if index == vertices.index {
            body.start = lines.next;
            check_room(&vertices.element, Encoding::Ascii, body.start.byte, source)?;
            body.positions = memory::with_room(3 * vertices.element.count)?;
            let (positions, decimals) = (&mut body.positions, &mut body.decimals);
            body.longer += each_vertex(vertices, &mut lines, |vertex, fields, line| {
                for (slot, field) in fields[..3].iter().enumerate() {
                    let word = &source[field.clone()];
                    let value = number::parse(word).ok_or_else(|| {
                        let (name, shown) = (FIELDS[slot], text::quote(word));
                        let otherwise = || format!("expected a finite number for {name}, found {shown}");
                        Error::at_line(line, format!("vertex {vertex}: {}", number::wrong(word, otherwise)))
                    })?;
                    positions.push(value);
                    *decimals = number::decimals(word).max(*decimals);
                }
                Ok(())
            })?;
        } else if !element.properties.is_empty() {
            check_room(element, Encoding::Ascii, lines.next.byte, source)?;
            let wanted = faces.wanted(index);
            for row in 0..element.count {
                let line = lines.row(element, row)?;
                let number = line.1;
                corners.clear();
                let is_longer = walk_row(element, source, line, |property, word| {
                    if wanted.is_some_and(|(_, list)| list == property) {
                        let word = &source[word];
                        let corner = number::parse(word).ok_or_else(|| {
                            let shown = text::quote(word);
                            Error::at_line(
                                number,
                                format!("face {row}: expected a vertex index, found {shown}"),
                            )
                        })?;
                        memory::push(&mut corners, corner)?;
                    }
                    Ok(())
                })?;
                body.longer += usize::from(is_longer);
                if let Some((what, _)) = wanted {
                    faces.add(what, row, &corners, |message| Error::at_line(number, message))?;
                }
            }
        }
    }
    let rest = &source[lines.next.byte.min(source.len())..];
    body.extra = rest.trim_ascii().len();
    Ok(body)
}

pub(super) fn write(
    source: &[u8],
    vertices: &Vertices,
    line_end: u8,
    start: Start,
    decimals: usize,
    moved: &Moved<'_>,
) -> Result<Vec<u8>, Error> {
    let mut lines = Lines { source, line_end, next: start };
    let mut patcher = Patcher::new(source)?;
    let style = Style::new(decimals, moved.after, 3);
    each_vertex(vertices, &mut lines, |vertex, fields, _| {
        let at = |slot: usize| number::parse(&source[fields[3 + slot].clone()]).unwrap_or(f64::NAN);
        let turned = vertices.turned(moved, vertex, [0, 1, 2].map(at));
        for slot in vertices.slots.iter().flatten().copied() {
            let (before, after) = match (slot, turned) {
                (0..3, _) => (moved.before[3 * vertex + slot], moved.after[3 * vertex + slot]),
                (_, Some(normal)) => (at(slot - 3), normal[slot - 3]),
                (_, None) => continue,
            };
            let (style, after) = match vertices.scalars[slot] {
                scalar if scalar.is_integer() => (Style::Fixed(0), after.round()),
                _ if slot < 3 => (style, after),
                _ => (Style::for_normal([3, 4, 5].map(|k| &source[fields[k].clone()])), after),
            };
            if style.differs(before, after) {
                style.print(after, patcher.replace(fields[slot].clone())?);
            }
        }
        Ok(())
    })?;
    patcher.finish()
}
