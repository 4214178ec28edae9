//! PLY (Greg Turk's Stanford polygon format), ascii and binary.
//!
//! Any elements with any properties: what is read are the positions (and normals) of `vertex` and the polygons of `face` (or the
//! strips of `tristrips`); everything else is only walked over. Writing changes the fields `x y z nx ny nz` in a copy of the
//! file, and nothing else.

mod ascii;
mod binary;
mod faces;
mod facts;
mod header;
mod scalar;

use crate::document::{Document, Moved, Parsed, Written};
use crate::error::Error;
use crate::normals;
use crate::precision::Precision;
use faces::Faces;
use header::{Element, Encoding, Header, Kind};
use scalar::Scalar;

/// What the six fields that move are called, the slots of [`Vertices`].
const FIELDS: [&str; 6] = ["x", "y", "z", "nx", "ny", "nz"];

/// The element `vertex`, and where its fields are.
struct Vertices {
    /// Which of the header's elements it is.
    index: usize,
    element: Element,
    /// For each property of the element the slot of [`FIELDS`] that it fills.
    slots: Vec<Option<usize>>,
    /// The number type of each slot (of no meaning where there are no normals).
    scalars: [Scalar; 6],
    normals: bool,
}

impl Vertices {
    fn new(header: &Header) -> Result<Vertices, Error> {
        let Some(index) = header.elements.iter().position(|e| e.name == "vertex") else {
            return Err(Error::malformed(
                "the header has no element 'vertex', so that there is nothing to move",
            ));
        };
        let element = header.elements[index].clone();
        if element.find("packed_position").is_some() {
            return Err(Error::unsupported(
                "this is a SuperSplat compressed PLY (vertex property 'packed_position'), which is not read: \
                 save it as an uncompressed PLY first",
            ));
        }
        let mut slots = vec![None; element.properties.len()];
        let mut scalars = [Scalar::F32; 6];
        let mut found = [false; 6];
        for (property, slot_of) in element.properties.iter().zip(&mut slots) {
            // PCL's name for the same.
            let name = property.name.strip_prefix("normal_").map(|axis| format!("n{axis}"));
            let name = name.as_deref().unwrap_or(&property.name);
            let Some(slot) = FIELDS.iter().position(|&field| field == name) else { continue };
            let Kind::Scalar(scalar) = property.kind else {
                return Err(Error::malformed(format!(
                    "the vertex property '{name}' is a list, not a number"
                )));
            };
            if std::mem::replace(&mut found[slot], true) {
                return Err(Error::malformed(format!("the element 'vertex' has two properties '{name}'")));
            }
            *slot_of = Some(slot);
            scalars[slot] = scalar;
        }
        if let Some(slot) = found[..3].iter().position(|&found| !found) {
            let name = FIELDS[slot];
            return Err(Error::malformed(format!(
                "the element 'vertex' has no property '{name}': expected x, y and z"
            )));
        }
        let normals = found[3..].iter().all(|&found| found);
        Ok(Vertices { index, element, slots, scalars, normals })
    }

    /// The vertex's normal turned; `None` where it stays as it is.
    fn turned(&self, moved: &Moved<'_>, vertex: usize, normal: [f64; 3]) -> Option<[f64; 3]> {
        let map = normals::map_at(moved.maps.filter(|_| self.normals)?, vertex);
        if !normal.iter().all(|c| c.is_finite()) {
            return None;
        }
        let turned = normals::turn(map, normal);
        // An estimated map of a place that did not move is the identity but for rounding: that is no reason to write.
        let change = (0..3).map(|k| (turned[k] - normal[k]).abs()).fold(0.0, f64::max);
        (change > 1e-12 * normals::length(normal)).then_some(turned)
    }

    /// Refuses positions that their properties cannot hold.
    fn check_range(&self, moved: &Moved<'_>) -> Result<(), Error> {
        for (index, (&before, &after)) in moved.before.iter().zip(moved.after).enumerate() {
            let (vertex, slot) = (index / 3, index % 3);
            if before != after && !self.scalars[slot].holds(after) {
                return Err(Error::argument(format!(
                    "vertex {vertex} cannot be written: its {} = {after} is beyond the range of the file's {}",
                    FIELDS[slot],
                    self.scalars[slot].name()
                )));
            }
        }
        Ok(())
    }
}

/// Where the rows of `vertex` start.
#[derive(Clone, Copy, Default)]
struct Start {
    byte: usize,
    line: u64,
}

/// What the body gave.
struct Body {
    positions: Vec<f64>,
    start: Start,
    /// Most decimals of a position, for ascii.
    decimals: usize,
    /// Lines of an ascii file that have more than the header says.
    longer: usize,
    /// Bytes behind the last element.
    extra: usize,
}

pub(crate) fn read(source: &[u8]) -> Result<Parsed, Error> {
    let header = header::read(source)?;
    let vertices = Vertices::new(&header)?;
    let mut faces = Faces::new(&header, vertices.element.count);
    let body = match header.encoding {
        Encoding::Ascii => ascii::read(source, &header, &vertices, &mut faces)?,
        Encoding::Binary(order) => binary::read(source, &header, &vertices, &mut faces, order)?,
    };
    Ok(Parsed {
        dim: 3,
        facts: facts::of(&header, &vertices, &faces, &body),
        positions: body.positions,
        faces: (!faces.triangles.is_empty()).then_some(faces.triangles),
        document: Box::new(Ply {
            encoding: header.encoding,
            line_end: header.line_end,
            vertices,
            start: body.start,
            decimals: body.decimals,
            texture: header.texture,
        }),
    })
}

/// Refuses counts that the rest of the file cannot hold, before anything is allocated for them.
fn check_room(element: &Element, encoding: Encoding, at: usize, source: &[u8]) -> Result<(), Error> {
    let row = element.smallest_row(encoding);
    let left = source.len() - at.min(source.len());
    // The last digit of an ascii file needs no white space after it.
    if (element.count as u128) * (row as u128) > left as u128 + u128::from(encoding == Encoding::Ascii) {
        return Err(Error::at_byte(
            at as u64,
            format!(
                "the header promises {} rows of '{}' of {row} bytes or more, but the file has only {left} bytes left",
                element.count, element.name
            ),
        ));
    }
    Ok(())
}

/// A PLY file ready to be written again.
struct Ply {
    encoding: Encoding,
    line_end: u8,
    vertices: Vertices,
    start: Start,
    decimals: usize,
    /// What `comment TextureFile` names.
    texture: Option<String>,
}

impl Document for Ply {
    fn has_normals(&self) -> bool {
        self.vertices.normals
    }

    fn precision(&self, axis: usize) -> Precision {
        match (self.vertices.scalars[axis], self.encoding) {
            (scalar, _) if scalar.is_integer() => Precision::Whole,
            (_, Encoding::Ascii) => Precision::Digits(self.decimals),
            (Scalar::F32, _) => Precision::Single,
            _ => Precision::Double,
        }
    }

    fn named_files(&self) -> Vec<String> {
        self.texture.iter().cloned().collect()
    }

    fn write(&self, source: &[u8], moved: &Moved<'_>) -> Result<Written, Error> {
        self.vertices.check_range(moved)?;
        let bytes = match self.encoding {
            Encoding::Ascii => {
                ascii::write(source, &self.vertices, self.line_end, self.start, self.decimals, moved)?
            }
            Encoding::Binary(order) => binary::write(source, &self.vertices, self.start, order, moved)?,
        };
        Ok(Written { bytes, side_files: Vec::new() })
    }
}
