//! How far few places of a shape are from each other along it: all pairs.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::machine::parallel::for_each_block;
use crate::weights::shape_graph::{coarse, Ordered, Position};

/// Places of the shape: choices a control point can be put on. More of them move no point by much, and take the square of it.
const NODES: usize = 600;
/// Of them for each control point, so that many control points have a choice too.
const EACH: usize = 4;

/// Places of a shape, and the ways between them.
pub(super) struct Along {
    pub(super) nodes: Vec<Position>,
    /// How much of the surface each stands for.
    pub(super) areas: Vec<f64>,
    /// Which are next to each, and how far.
    pub(super) links: Vec<Vec<(u32, f64)>>,
    /// From each (row) to each.
    pub(super) far: Vec<f64>,
}

impl Along {
    /// Of the points `x` and the triangles of them, in halves of the longest side.
    pub(super) fn new(x: &[Position], faces: &[[u32; 3]], count: usize) -> Along {
        let shape = coarse(x, faces, &[], NODES.max(EACH * count));
        let n = shape.nodes.len();
        let mut links = vec![Vec::new(); n];
        for (&[a, b], &length) in shape.ends.iter().zip(&shape.lengths) {
            links[a as usize].push((b, length));
            links[b as usize].push((a, length));
        }
        let mut far = vec![f64::INFINITY; n * n];
        for_each_block(&mut far, n.max(1), |from, row| shortest(&links, from, row));
        Along { nodes: shape.nodes, areas: shape.areas, links, far }
    }

    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// From a node to all.
    pub(super) fn from(&self, node: usize) -> &[f64] {
        &self.far[node * self.len()..][..self.len()]
    }
}

/// Dijkstra, "A note on two problems in connexion with graphs", 1959.
fn shortest(links: &[Vec<(u32, f64)>], from: usize, far: &mut [f64]) {
    far[from] = 0.0;
    let mut queue = BinaryHeap::from([Reverse((Ordered(0.0), from as u32))]);
    while let Some(Reverse((Ordered(away), node))) = queue.pop() {
        if away > far[node as usize] {
            continue;
        }
        for &(other, length) in &links[node as usize] {
            let way = away + length;
            if way < far[other as usize] {
                far[other as usize] = way;
                queue.push(Reverse((Ordered(way), other)));
            }
        }
    }
}
