//! STL, ascii and binary: triangles that share no vertices. The corners are the positions, in file order.

mod ascii;
mod binary;

use crate::document::Parsed;
use crate::error::Error;
use crate::normals::{cross, length};

pub(crate) fn read(source: &[u8]) -> Result<Parsed, Error> {
    if is_ascii(source) {
        ascii::read(source)
    } else {
        binary::read(source)
    }
}

/// Many binary files start with "solid" too. What tells: the length that the count of triangles demands, and the zero bytes
/// that no text has and the start of a binary file hardly lacks.
fn is_ascii(source: &[u8]) -> bool {
    const LOOKED_AT: usize = 512;
    let text = source.trim_ascii_start();
    let solid = text.len() >= 5 && text[..5].eq_ignore_ascii_case(b"solid");
    solid && !binary::has_exact_length(source) && !source[..source.len().min(LOOKED_AT)].contains(&0)
}

/// Triangles of corners in file order.
fn faces(corners: usize) -> Vec<[u32; 3]> {
    (0..corners as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect()
}

/// The nine coordinates of triangle `index`.
fn triangle(positions: &[f64], index: usize) -> &[f64; 9] {
    positions[9 * index..9 * index + 9].try_into().expect("nine numbers a triangle")
}

/// The area normal of a triangle.
fn area_normal(t: &[f64; 9]) -> [f64; 3] {
    cross([t[3] - t[0], t[4] - t[1], t[5] - t[2]], [t[6] - t[0], t[7] - t[1], t[8] - t[2]])
}

/// The facet normal of a moved triangle: of unit length, and on the same side of the winding as `normal` was. `None` where
/// the old one stays: the triangle has not moved, it has no area now, or the file never gave it a normal (0 0 0).
fn moved_normal(before: &[f64; 9], after: &[f64; 9], normal: [f64; 3]) -> Option<[f64; 3]> {
    if before == after || normal == [0.0; 3] {
        return None;
    }
    let now = area_normal(after);
    let was = area_normal(before);
    let side = if (0..3).map(|k| was[k] * normal[k]).sum::<f64>() < 0.0 { -1.0 } else { 1.0 };
    let size = length(now);
    (size > 0.0 && size.is_finite()).then(|| now.map(|c| side * c / size))
}
