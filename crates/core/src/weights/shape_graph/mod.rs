//! What a shape says of its control points: random walks over it, and the shortest ones. From this a network is taught, so that its logits
//! are a function of space that follows the shape.
//!
//! ```text
//! mesh   vertices in one place are one node; long edges are halved; an edge conducts as its strip of surface does
//! graph  what is no edge: neighbours in a cloud, parts that touch; then all nodes of a patch in a cell are one
//! paths  D: how far each node is from its nearest control point, along the shape
//! walks  h_i: how likely a random walk meets control point i first; one sparse system (cholesky), m right-hand sides
//! labels w_i ~ h_i^(2.5 s) / E_i^(6 (1 - s)), s = 1 where D is below 3/4 of the control points' spacing, else (3/4 spacing / D)^4
//! ```
//!
//! Positions are in halves of the shape's longest side. Harmonic weights: Joshi et al., "Harmonic coordinates for character
//! articulation", 2007, there in a cage. The settings were chosen by studies/shape_aware.py; docs/notes/shape-aware.md has the figures.

mod cholesky;
mod coarse;
mod graph;
mod labels;
mod links;
mod mesh;
mod near;
mod paths;
mod walks;

pub(crate) use coarse::coarse;
pub(crate) use graph::largest_piece;
pub(crate) use labels::{check_shape, fit};
pub use labels::{labels, Labels, Shape};

pub(crate) use near::{Found, Near};
pub(crate) use paths::Ordered;

pub(crate) type Position = [f64; 3];

/// Side of a cell, in halves of the shape's longest side.
const CELL: f64 = 0.02;

pub(crate) fn squared(a: &Position, b: &Position) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// Links of the points `p` to nodes at most so many times as far as the nearest: which point, which node, how far.
fn attached(near: &Near, p: &[Position], times: f64, most: usize) -> Vec<(u32, u32, f64)> {
    let (mut links, mut found) = (Vec::new(), Vec::new());
    for (point, x) in p.iter().enumerate() {
        near.nearest(x, most, f64::INFINITY, |_| true, &mut found);
        let bound = found.first().map_or(0.0, |(square, _)| times * square.sqrt() + 1e-9);
        let all = found.iter().map(|(square, node)| (point as u32, *node, square.sqrt()));
        links.extend(all.take_while(|(.., far)| *far <= bound));
    }
    links
}

#[cfg(test)]
mod tests;
