//! From the places of a graph back to the shape.

use crate::weights::shape_graph::{squared, Position};

/// A vertex that is so near is taken as it stands in the file, in halves of the longest side.
const VERTEX: f64 = 0.02;

/// Where a place is on the shape.
pub(super) enum Snapped {
    /// At a vertex.
    Vertex(usize),
    /// In a face.
    Place(Position),
}

/// The nearest vertex that is used, if it is near, or else the nearest place of the faces.
pub(super) fn snap(x: &[Position], faces: &[[u32; 3]], at: &Position) -> Snapped {
    let nearer = |best: (f64, usize), vertex: usize| {
        let square = squared(&x[vertex], at);
        if square < best.0 {
            (square, vertex)
        } else {
            best
        }
    };
    let none = (f64::INFINITY, 0);
    let mut vertex = faces.iter().flatten().fold(none, |best, &corner| nearer(best, corner as usize));
    if faces.is_empty() {
        vertex = (0..x.len()).fold(none, nearer);
    }
    if faces.is_empty() || vertex.0 <= VERTEX * VERTEX {
        return Snapped::Vertex(vertex.1);
    }
    let mut best = (vertex.0, x[vertex.1]);
    for face in faces {
        let place = closest(face.map(|corner| x[corner as usize]), at);
        let square = squared(&place, at);
        if square < best.0 {
            best = (square, place);
        }
    }
    Snapped::Place(best.1)
}

/// The place of a triangle that is nearest. Ericson, "Real-time collision detection", 2005, 5.1.5.
pub(super) fn closest([a, b, c]: [Position; 3], p: &Position) -> Position {
    let minus = |a: &Position, b: &Position| -> Position { std::array::from_fn(|k| a[k] - b[k]) };
    let dot = |a: &Position, b: &Position| -> f64 { (0..3).map(|k| a[k] * b[k]).sum() };
    let along =
        |from: &Position, by: &Position, t: f64| -> Position { std::array::from_fn(|k| from[k] + t * by[k]) };
    let (ab, ac) = (minus(&b, &a), minus(&c, &a));
    let [(d1, d2), (d3, d4), (d5, d6)] = [a, b, c].map(|corner| {
        let to = minus(p, &corner);
        (dot(&ab, &to), dot(&ac, &to))
    });
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    if d1 <= 0.0 && d2 <= 0.0 {
        a
    } else if d3 >= 0.0 && d4 <= d3 {
        b
    } else if d6 >= 0.0 && d5 <= d6 {
        c
    } else if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        along(&a, &ab, d1 / (d1 - d3))
    } else if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        along(&a, &ac, d2 / (d2 - d6))
    } else if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        along(&b, &minus(&c, &b), (d4 - d3) / ((d4 - d3) + (d5 - d6)))
    } else {
        let sum = va + vb + vc;
        if sum == 0.0 {
            return a;
        }
        along(&along(&a, &ab, vb / sum), &ac, vc / sum)
    }
}
