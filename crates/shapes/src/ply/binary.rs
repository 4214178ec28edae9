//! The body of a binary PLY file, in either byte order.

use super::faces::Faces;
use super::header::{Element, Encoding, Header, Kind};
use super::scalar::ByteOrder;
use super::{check_room, Body, Start, Vertices, FIELDS};
use crate::document::Moved;
use crate::error::Error;
use crate::memory;

/// Shows `see` each property of the row at `at`: its index, and where it starts and how many numbers it has there. Returns
/// where the next row starts.
fn walk_row(
    element: &Element,
    source: &[u8],
    mut at: usize,
    order: ByteOrder,
    mut see: impl FnMut(usize, usize, usize) -> Result<(), Error>,
) -> Result<usize, Error> {
    for (index, property) in element.properties.iter().enumerate() {
        let left = source.len() - at;
        let ended = |needed: String| {
            let (name, property) = (element.shown(), property.shown());
            let message =
                format!("expected {needed} of the property {property} of {name}, found {left} bytes");
            Error::at_byte(at as u64, message)
        };
        match property.kind {
            Kind::Scalar(scalar) => {
                if scalar.size() > left {
                    return Err(ended(format!("{} bytes", scalar.size())));
                }
                see(index, at, 1)?;
                at += scalar.size();
            }
            Kind::List { count, item } => {
                if count.size() > left {
                    return Err(ended(format!("{} bytes", count.size())));
                }
                let length = count.get(&source[at..], order);
                if !(length >= 0.0 && length.fract() == 0.0) {
                    let (name, property) = (element.shown(), property.shown());
                    let message = format!("the list {property} of {name} has the length {length}");
                    return Err(Error::at_byte(at as u64, message));
                }
                if length * item.size() as f64 > (left - count.size()) as f64 {
                    return Err(ended(format!("a list of {length} items")));
                }
                at += count.size();
                see(index, at, length as usize)?;
                at += length as usize * item.size();
            }
        }
    }
    Ok(at)
}

/// Shows `see` where the fields of each vertex are; returns where the element ends. There must be room for rows without lists.
fn each_vertex(
    vertices: &Vertices,
    source: &[u8],
    mut at: usize,
    order: ByteOrder,
    mut see: impl FnMut(usize, &[usize; 6]) -> Result<(), Error>,
) -> Result<usize, Error> {
    let element = &vertices.element;
    let stride = (!element.has_lists()).then(|| element.smallest_row(Encoding::Binary(order)));
    let mut fields = [0; 6];
    for row in 0..element.count {
        match stride {
            Some(stride) if row > 0 => {
                fields.iter_mut().for_each(|field| *field += stride);
                at += stride;
            }
            _ => {
                at = walk_row(element, source, at, order, |property, at, _| {
                    if let Some(slot) = vertices.slots[property] {
                        fields[slot] = at;
                    }
                    Ok(())
                })?;
            }
        }
        see(row, &fields)?;
    }
    Ok(at)
}

pub(super) fn read(
    source: &[u8],
    header: &Header,
    vertices: &Vertices,
    faces: &mut Faces,
    order: ByteOrder,
) -> Result<Body, Error> {
    let encoding = Encoding::Binary(order);
    let start = Start { byte: header.body, line: 0 };
    let mut body = Body { positions: Vec::new(), start, decimals: 0, longer: 0, extra: 0 };
    let mut at = header.body;
    let mut corners = Vec::new();
    for (index, element) in header.elements.iter().enumerate() {
        if index == vertices.index {
            check_room(&vertices.element, encoding, at, source)?;
            body.start.byte = at;
            body.positions = memory::with_room(3 * vertices.element.count)?;
            at = each_vertex(vertices, source, at, order, |vertex, fields| {
                for slot in 0..3 {
                    let value = vertices.scalars[slot].get(&source[fields[slot]..], order);
                    if !value.is_finite() {
                        let name = FIELDS[slot];
                        let message =
                            format!("vertex {vertex}: expected a finite number for {name}, found {value}");
                        return Err(Error::at_byte(fields[slot] as u64, message));
                    }
                    body.positions.push(value);
                }
                Ok(())
            })?;
            continue;
        }
        check_room(element, encoding, at, source)?;
        if !element.has_lists() {
            at += element.count * element.smallest_row(encoding);
            continue;
        }
        let wanted = faces.wanted(index);
        for row in 0..element.count {
            let row_at = at;
            corners.clear();
            at = walk_row(element, source, at, order, |property, at, length| {
                if let (Some((_, list)), Kind::List { item, .. }) =
                    (wanted, element.properties[property].kind)
                {
                    if list == property {
                        let items = source[at..at + length * item.size()].chunks_exact(item.size());
                        memory::reserve(&mut corners, length)?;
                        corners.extend(items.map(|bytes| item.get(bytes, order)));
                    }
                }
                Ok(())
            })?;
            if let Some((what, _)) = wanted {
                faces.add(what, row, &corners, |message| Error::at_byte(row_at as u64, message))?;
            }
        }
    }
    body.extra = source.len() - at;
    Ok(body)
}

pub(super) fn write(
    source: &[u8],
    vertices: &Vertices,
    start: Start,
    order: ByteOrder,
    moved: &Moved<'_>,
) -> Result<Vec<u8>, Error> {
    let mut out = memory::copy(source)?;
    each_vertex(vertices, source, start.byte, order, |vertex, fields| {
        for slot in 0..3 {
            let (before, after) = (moved.before[3 * vertex + slot], moved.after[3 * vertex + slot]);
            if before != after {
                vertices.scalars[slot].put(after, &mut out[fields[slot]..], order);
            }
        }
        if vertices.normals {
            let normal = [3, 4, 5].map(|slot| vertices.scalars[slot].get(&source[fields[slot]..], order));
            if let Some(turned) = vertices.turned(moved, vertex, normal) {
                for (slot, value) in (3..).zip(turned) {
                    vertices.scalars[slot].put(value, &mut out[fields[slot]..], order);
                }
            }
        }
        Ok(())
    })?;
    Ok(out)
}
