//! Few places spread evenly along a shape, and how far they are from their neighbours along it.
//!
//! The control points come first; then always the node that is farthest from all that are chosen (Eldar et al., "The farthest point strategy
//! for progressive image sampling", 1997, along the shape). Each stands for the nodes that it is nearest to, its cell; two are linked where
//! their cells meet.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use super::graph::links_of;
use super::links::Links;
use super::near::Near;
use super::paths::{Neighbours, Ordered, AROUND, LEAST, MOST_AROUND};
use super::{attached, squared, Position};

/// A place that is no farther from a chosen one is in the same place.
const SAME: f64 = 1e-9;

/// The places, the control points first.
pub(crate) struct Coarse {
    pub(crate) nodes: Vec<Position>,
    /// Each pair of neighbours once, the smaller first and in order.
    pub(crate) ends: Vec<[u32; 2]>,
    /// How far they are from each other along the shape.
    pub(crate) lengths: Vec<f64>,
    /// How much of the surface each stands for.
    pub(crate) areas: Vec<f64>,
}

/// At most `count` places of the shape, and all of the control points `p`.
pub(crate) fn coarse(x: &[Position], faces: &[[u32; 3]], p: &[Position], count: usize) -> Coarse {
    let links = links_of(x, faces);
    let near = Near::new(&links.nodes);
    let around = attached(&near, p, AROUND, MOST_AROUND);
    let mut cells = Cells::new(&links);
    let of_points = around.iter().map(|&(point, node, away)| (away.max(LEAST), node, point));
    cells.grow(&links, of_points.collect());
    let mut nodes = p.to_vec();
    while nodes.len() < count {
        let farther =
            |best: (usize, f64), (at, far): (usize, f64)| if far > best.1 { (at, far) } else { best };
        let (node, far) = cells.far.iter().copied().enumerate().fold((0, SAME), farther);
        if far <= SAME {
            break;
        }
        cells.grow(&links, vec![(0.0, node as u32, nodes.len() as u32)]);
        nodes.push(links.nodes[node]);
    }
    let pairs = cells.pairs(&links, &around, nodes.len());
    let mut areas = vec![0.0; nodes.len()];
    cells.owner.iter().zip(&links.areas).for_each(|(&owner, area)| areas[owner as usize] += area);
    let (ends, lengths) = pairs.into_iter().unzip();
    Coarse { nodes, ends, lengths, areas }
}

/// Which of the chosen each node is nearest to.
struct Cells {
    neighbours: Neighbours,
    far: Vec<f64>,
    owner: Vec<u32>,
}

impl Cells {
    fn new(links: &Links) -> Cells {
        let count = links.nodes.len();
        Cells { neighbours: Neighbours::new(links), far: vec![f64::INFINITY; count], owner: vec![0; count] }
    }

    /// Gives what is nearer to one of the `starts`, each a distance, a node and whose it is, to that.
    fn grow(&mut self, links: &Links, starts: Vec<(f64, u32, u32)>) {
        let Cells { neighbours, far, owner } = self;
        let mut queue = BinaryHeap::new();
        let mut found = |queue: &mut BinaryHeap<_>, away: f64, node: u32, whose: u32| {
            let (far, owner) = (&mut far[node as usize], &mut owner[node as usize]);
            if (away, whose) < (*far, *owner) {
                (*far, *owner) = (away, whose);
                queue.push(Reverse((Ordered(away), node, whose)));
            }
            (*far, *owner) == (away, whose)
        };
        for (away, node, whose) in starts {
            found(&mut queue, away, node, whose);
        }
        while let Some(Reverse((Ordered(away), node, whose))) = queue.pop() {
            // One that is nearer came in between.
            if !found(&mut queue, away, node, whose) {
                continue;
            }
            let x = &links.nodes[node as usize];
            neighbours.two_steps(node, |other| {
                let length = squared(x, &links.nodes[other as usize]).sqrt().max(LEAST);
                found(&mut queue, away + length, other, whose);
            });
        }
    }

    /// How far those are from each other whose cells meet. One whose cell is empty, for another is nearer to all around it, is linked to that.
    fn pairs(&self, links: &Links, around: &[(u32, u32, f64)], count: usize) -> BTreeMap<[u32; 2], f64> {
        let mut pairs = BTreeMap::new();
        let mut meet = |a: u32, b: u32, far: f64| {
            if a != b {
                let shortest = pairs.entry([a.min(b), a.max(b)]).or_insert(f64::INFINITY);
                *shortest = far.min(*shortest);
            }
        };
        for (link, ends) in links.ends.iter().enumerate() {
            let [a, b] = ends.map(|end| end as usize);
            meet(self.owner[a], self.owner[b], self.far[a] + links.length(link) + self.far[b]);
        }
        let mut empty = vec![true; count];
        self.owner.iter().for_each(|&owner| empty[owner as usize] = false);
        for &(point, node, away) in around.iter().filter(|(point, ..)| empty[*point as usize]) {
            meet(point, self.owner[node as usize], away + self.far[node as usize]);
        }
        pairs
    }
}
