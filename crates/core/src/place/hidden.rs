//! Which places of a surface are seen from outside.
//!
//! Soups have parts inside of others: the end of a wing in a fuselage, the seats of a car. A control point there would be no use, and it
//! is no end of the shape. A grid is flooded from outside, between walls that are as thick as a gap is wide that nobody looks through.

use std::collections::VecDeque;

use crate::weights::shape_graph::Position;

/// Cells along the longest side.
const SIDE: i32 = 48;
/// Cells around the shape.
const MARGIN: i32 = 4;
/// Cells by which walls are thicker: gaps up to twice as wide are closed.
const CLOSED: i32 = 1;
const ALL: i32 = SIDE + 2 * MARGIN;

/// For each of the `nodes` whether the water comes to it; all without faces, and in the plane.
pub(super) fn seen(x: &[Position], faces: &[[u32; 3]], nodes: &[Position], dim: usize) -> Vec<bool> {
    if faces.is_empty() || dim < 3 {
        return vec![true; nodes.len()];
    }
    let outside = flooded(&widened(&walls(x, faces), CLOSED));
    // By one more, for a place on the border of two cells may be in either.
    let wet = widened(&outside, CLOSED + 2);
    let seen: Vec<bool> = nodes.iter().map(|x| wet[cell(x)]).collect();
    if seen.contains(&true) {
        seen
    } else {
        vec![true; nodes.len()]
    }
}

fn axis(c: f64) -> i32 {
    MARGIN + ((c + 1.0) * f64::from(SIDE) / 2.0).floor().clamp(0.0, f64::from(SIDE - 1)) as i32
}

fn number([i, j, k]: [i32; 3]) -> usize {
    ((i * ALL + j) * ALL + k) as usize
}

fn cell(x: &Position) -> usize {
    number(x.map(axis))
}

/// The cells that a face passes through.
fn walls(x: &[Position], faces: &[[u32; 3]]) -> Vec<bool> {
    let mut walls = vec![false; (ALL * ALL * ALL) as usize];
    for face in faces {
        let [a, b, c] = face.map(|corner| x[corner as usize]);
        let longest =
            [(a, b), (b, c), (c, a)].into_iter().flat_map(|(a, b)| (0..3).map(move |k| (a[k] - b[k]).abs()));
        // Two samples a cell.
        let steps = (longest.fold(0.0, f64::max) * f64::from(SIDE)).ceil().max(1.0) as i32;
        for s in 0..=steps {
            for t in 0..=steps - s {
                let (s, t) = (f64::from(s) / f64::from(steps), f64::from(t) / f64::from(steps));
                let at: Position = std::array::from_fn(|k| a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]));
                walls[cell(&at)] = true;
            }
        }
    }
    walls
}

/// With all cells that are at most so many away, along each axis.
fn widened(cells: &[bool], by: i32) -> Vec<bool> {
    let mut wide = cells.to_vec();
    for step in [[1, 0, 0], [0, 1, 0], [0, 0, 1]] {
        let step = number(step);
        for _ in 0..by {
            let before = wide.clone();
            for at in step..before.len() {
                wide[at] |= before[at - step];
                wide[at - step] |= before[at];
            }
        }
    }
    wide
}

/// The cells that water from the corner reaches.
fn flooded(walls: &[bool]) -> Vec<bool> {
    let mut wet = vec![false; walls.len()];
    wet[0] = true;
    let mut queue = VecDeque::from([[0; 3]]);
    while let Some(at) = queue.pop_front() {
        for (k, by) in [(0, 1), (1, 1), (2, 1), (0, -1), (1, -1), (2, -1)] {
            let mut next: [i32; 3] = at;
            next[k] += by;
            if (0..ALL).contains(&next[k])
                && !walls[number(next)]
                && !std::mem::replace(&mut wet[number(next)], true)
            {
                queue.push_back(next);
            }
        }
    }
    wet
}
