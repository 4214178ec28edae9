//! Binary STL: 80 bytes of header, a count, and 50 bytes a triangle (normal, three corners, two attribute bytes).

use super::{faces, moved_normal, triangle};
use crate::document::{Document, Moved, Parsed, Written};
use crate::error::Error;
use crate::memory;
use crate::precision::Precision;

/// The bytes before the triangles, and of each.
const HEAD: usize = 84;
const TRIANGLE: usize = 50;

/// The number of triangles that the file claims.
fn count(source: &[u8]) -> Option<usize> {
    Some(u32::from_le_bytes(source.get(80..HEAD)?.try_into().ok()?) as usize)
}

/// Whether the file is as long as the triangles that it claims.
pub(super) fn has_exact_length(source: &[u8]) -> bool {
    count(source).is_some_and(|count| source.len() as u64 == HEAD as u64 + count as u64 * TRIANGLE as u64)
}

fn float(bytes: &[u8]) -> f32 {
    f32::from_le_bytes(bytes[..4].try_into().expect("four bytes"))
}

pub(super) fn read(source: &[u8]) -> Result<Parsed, Error> {
    let Some(count) = count(source) else {
        return Err(Error::malformed(format!(
            "an STL file starts with 'solid' or has a header of {HEAD} bytes, and this one of {} bytes has neither",
            source.len()
        )));
    };
    let (room, rest) = ((source.len() - HEAD) / TRIANGLE, (source.len() - HEAD) % TRIANGLE);
    // Writers that did not know the number when they began may leave it 0: then it follows from the length.
    let open = count == 0 && rest == 0;
    let count = if open { room } else { count };
    if count > room {
        return Err(Error::at_byte(
            80,
            format!("the header promises {count} triangles, but the file ends after {room} of them"),
        ));
    }
    let (body, extra) = source[HEAD..].split_at(count * TRIANGLE);
    let mut positions = memory::with_room(9 * count)?;
    let (mut coloured, mut without_normal) = (0, 0);
    for (index, facet) in body.chunks_exact(TRIANGLE).enumerate() {
        for (k, bytes) in facet[12..48].chunks_exact(4).enumerate() {
            let value = float(bytes);
            if !value.is_finite() {
                let at = HEAD + index * TRIANGLE + 12 + 4 * k;
                return Err(Error::at_byte(
                    at as u64,
                    format!(
                        "triangle {index}, corner {}: expected a finite number for {}, found {value}",
                        k / 3,
                        ["x", "y", "z"][k % 3]
                    ),
                ));
            }
            positions.push(value.into());
        }
        coloured += usize::from(facet[48..] != [0, 0]);
        without_normal += usize::from(facet[..12].chunks_exact(4).all(|c| float(c) == 0.0));
    }

    let mut facts = vec![("encoding".to_string(), "binary".to_string())];
    let mut say = |what: &str, value: String| facts.push((what.to_string(), value));
    let printable = |c: &u8| if matches!(c, b' '..=b'~') { *c as char } else { ' ' };
    let header: String = source[..80].iter().take_while(|c| **c != 0).map(printable).collect();
    if !header.trim().is_empty() {
        say("header", header.trim().to_string());
    }
    if open && count > 0 {
        say("number of triangles", format!("0 in the header, {count} behind it (read; the header stays)"));
    }
    if without_normal < count {
        say("normals", "turned with their triangles".into());
    }
    if without_normal > 0 {
        say("triangles without a normal", format!("{without_normal} (they keep 0 0 0)"));
    }
    if coloured > 0 {
        say("colours", format!("attribute bytes of {coloured} triangles (carried over)"));
    }
    if !extra.is_empty() {
        say("behind the last triangle", format!("{} bytes (carried over)", extra.len()));
    }
    Ok(Parsed { dim: 3, positions, faces: Some(faces(3 * count)?), facts, document: Box::new(Binary) })
}

struct Binary;

impl Document for Binary {
    fn has_normals(&self) -> bool {
        false
    }

    fn precision(&self, _axis: usize) -> Precision {
        Precision::Single
    }

    fn write(&self, source: &[u8], moved: &Moved<'_>) -> Result<Written, Error> {
        let mut bytes = memory::copy(source)?;
        for index in 0..moved.before.len() / 9 {
            let (before, after) = (triangle(moved.before, index), triangle(moved.after, index));
            let facet = &mut bytes[HEAD + index * TRIANGLE..][..TRIANGLE];
            let normal = [0, 4, 8].map(|at| f64::from(float(&facet[at..])));
            for (k, &value) in after.iter().enumerate().filter(|(k, value)| before[*k] != **value) {
                let written = value as f32;
                if !written.is_finite() {
                    return Err(Error::argument(format!(
                        "position {} cannot be written: {value} is beyond the range of the file's float32",
                        3 * index + k / 3
                    )));
                }
                facet[12 + 4 * k..16 + 4 * k].copy_from_slice(&written.to_le_bytes());
            }
            if let Some(normal) = moved_normal(before, after, normal) {
                for (bytes, value) in facet[..12].chunks_exact_mut(4).zip(normal) {
                    bytes.copy_from_slice(&(value as f32).to_le_bytes());
                }
            }
        }
        Ok(Written { bytes, side_files: Vec::new() })
    }
}
