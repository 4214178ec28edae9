//! STL, ascii and binary: triangles that share no vertices. The corners are the positions, in file order.

mod ascii;
mod binary;

use crate::document::Parsed;
use crate::error::Error;
use crate::memory;
use crate::normals::{cross, length};
use crate::text::bom_length;

pub(crate) fn read(source: &[u8]) -> Result<Parsed, Error> {
    if is_ascii(source) {
        ascii::read(source)
    } else {
        binary::read(source)
    }
}

/// Many binary files start with "solid" too. What tells: the length that the count of triangles demands, and the zero bytes
/// that a binary file hardly lacks, and a text has behind its end at most.
fn is_ascii(source: &[u8]) -> bool {
    let text = source[bom_length(source)..].trim_ascii_start();
    let padding = text.iter().rev().take_while(|byte| **byte == 0 || byte.is_ascii_whitespace()).count();
    let solid = text.len() >= 5 && text[..5].eq_ignore_ascii_case(b"solid");
    solid && !binary::has_exact_length(source) && !text[..text.len() - padding].contains(&0)
}

/// Triangles of corners in file order.
fn faces(corners: usize) -> Result<Vec<[u32; 3]>, Error> {
    let mut faces = memory::with_room(corners / 3)?;
    faces.extend((0..corners as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]));
    Ok(faces)
}

/// The nine coordinates of triangle `index`.
fn triangle(positions: &[f64], index: usize) -> &[f64; 9] {
    positions[9 * index..9 * index + 9].try_into().expect("nine numbers a triangle")
}

/// Two edges of a triangle, and its normal of length 1: `None` where it has no area.
fn frame(t: &[f64; 9]) -> Option<([[f64; 3]; 3], f64)> {
    let (a, b) = ([t[3] - t[0], t[4] - t[1], t[5] - t[2]], [t[6] - t[0], t[7] - t[1], t[8] - t[2]]);
    let normal = cross(a, b);
    let area = length(normal);
    (area > 0.0 && area.is_finite()).then(|| ([a, b, normal.map(|c| c / area)], area))
}

/// The facet normal of a moved triangle, as long as it was: turned by the inverse transpose of the map that takes the
/// triangle's edges and normal to what they are now. So a normal across the triangle stays across it, on the side where it was, and one
/// that leans (CAD writes the true surface's) goes on leaning. `None` where the old one stays: the triangle has not moved, it has no area
/// now, or the file never gave it a normal (0 0 0).
fn moved_normal(before: &[f64; 9], after: &[f64; 9], normal: [f64; 3]) -> Option<[f64; 3]> {
    /// A normal that leans by less is across the triangle but for its rounding.
    const ACROSS: f64 = 1.0 - 1e-6;
    if before == after || normal == [0.0; 3] {
        return None;
    }
    let ([a, b, up], area) = frame(after)?;
    let size = length(normal);
    if !size.is_finite() {
        return Some(up);
    }
    let Some((was, _)) = frame(before) else { return Some(up.map(|c| c * size)) };
    let [along_a, along_b, along_up] = was.map(|axis| (0..3).map(|k| axis[k] * normal[k]).sum::<f64>());
    if along_up.abs() > ACROSS * size {
        return Some(up.map(|c| c * size.copysign(along_up)));
    }
    // The axes dual to those of the moved triangle.
    let (to_a, to_b) = (cross(b, up), cross(up, a));
    let turned: [f64; 3] =
        std::array::from_fn(|k| (along_a * to_a[k] + along_b * to_b[k]) / area + along_up * up[k]);
    let is = length(turned);
    (is > 0.0 && is.is_finite()).then(|| turned.map(|c| c * (size / is)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const BEFORE: [f64; 9] = [0., 0., 0., 2., 0., 0., 1., 1., 0.];

    fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
        (0..3).map(|k| (a[k] - b[k]).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn a_normal_across_the_triangle_stays_across_it() {
        let after = [0., 0., 0., 2., 0., 0., 1., 1., 1.];
        let (s, up) = (0.5f64.sqrt(), [0.0, 0.0, 1.0]);
        assert!(apart(moved_normal(&BEFORE, &after, up).unwrap(), [0.0, -s, s]) < 1e-12);
        assert!(apart(moved_normal(&BEFORE, &after, [0.0, 0.0, -1.0]).unwrap(), [0.0, s, -s]) < 1e-12);
        assert!(apart(moved_normal(&BEFORE, &after, [f64::NAN; 3]).unwrap(), [0.0, -s, s]) < 1e-12);
    }

    #[test]
    fn a_leaning_normal_turns_by_the_inverse_transpose() {
        let leaning = [0.6, 0.0, 0.8];
        // A quarter turn about z, and a shift.
        let turn = |p: &[f64]| [5.0 - p[1], p[0], p[2]];
        let turned: Vec<f64> = BEFORE.chunks(3).flat_map(turn).collect();
        let turned = turned.try_into().unwrap();
        assert!(apart(moved_normal(&BEFORE, &turned, leaning).unwrap(), [0.0, 0.6, 0.8]) < 1e-12);
        // Twice as long along x.
        let stretched: Vec<f64> = BEFORE.chunks(3).flat_map(|p| [2.0 * p[0], p[1], p[2]]).collect();
        let normal = moved_normal(&BEFORE, &stretched.try_into().unwrap(), leaning).unwrap();
        assert!((normal[0] / normal[2] - 0.3 / 0.8).abs() < 1e-12 && (length(normal) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_normal_stays_where_there_is_nothing_to_turn_it_by() {
        let moved = BEFORE.map(|c| 2.0 * c);
        assert_eq!(moved_normal(&BEFORE, &BEFORE, [0.0, 0.0, 1.0]), None);
        assert_eq!(moved_normal(&BEFORE, &moved, [0.0; 3]), None);
        assert_eq!(moved_normal(&BEFORE, &[1.0; 9], [0.0, 0.0, 1.0]), None);
    }
}
