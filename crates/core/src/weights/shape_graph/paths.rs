//! Shortest paths along a shape. Dijkstra, "A note on two problems in connexion with graphs", 1959.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::links::Links;
use super::near::Near;
use super::{attached, squared, Position};

/// So many times as far from a control point as the nearest: the nodes to which paths lead from it, for one in a body is not on one
/// side of it only.
pub(super) const AROUND: f64 = 2.0;
/// Such nodes.
pub(super) const MOST_AROUND: usize = 512;
/// Two nodes in one place are so far from each other.
pub(super) const LEAST: f64 = 1e-12;

/// Shortest paths along a shape.
pub(super) struct Reach {
    /// From each node to its nearest control point.
    pub(super) far: Vec<f64>,
    /// Which that is.
    pub(super) nearest: Vec<u32>,
    /// From each node to the nearest of the others; infinite where there are none.
    pub(super) second: Vec<f64>,
    /// From each control point to the nearest other; infinite where there is none.
    pub(super) apart: Vec<f64>,
}

/// The shortest paths from each node to the two nearest of `p`, and between these. Those of a control point in the midst of a body lead
/// straight to the surface around it.
///
/// Paths take two links at a time, straight from end to end: they need not zigzag.
pub(super) fn reach(links: &Links, near: &Near, p: &[Position]) -> Reach {
    let neighbours = Neighbours::new(links);
    let count = links.nodes.len();
    let mut of_nodes = vec![[(f64::INFINITY, u32::MAX); 2]; count];
    let mut queue = BinaryHeap::new();
    let around = attached(near, p, AROUND, MOST_AROUND);
    for &(point, node, away) in &around {
        queue.push(Reverse((Ordered(away.max(LEAST)), node, point)));
    }
    let mut steps = Vec::new();
    while let Some(Reverse((Ordered(away), node, point))) = queue.pop() {
        // The first to come is the nearest; the second is of another control point.
        let [first, second] = &mut of_nodes[node as usize];
        if first.1 == u32::MAX {
            *first = (away, point);
        } else if first.1 != point && second.1 == u32::MAX {
            *second = (away, point);
        } else {
            continue;
        }
        neighbours.two_steps(links, node, &mut steps);
        for &(other, length) in &steps {
            let [first, second] = of_nodes[other as usize];
            if first.1 == u32::MAX || first.1 != point && second.1 == u32::MAX {
                queue.push(Reverse((Ordered(away + length), other, point)));
            }
        }
    }
    // The shortest path to another of them passes a node to which both are nearer than any other.
    let mut apart = vec![f64::INFINITY; p.len()];
    for [(near, one), (far, other)] in &of_nodes {
        if *other != u32::MAX {
            for point in [one, other] {
                apart[*point as usize] = apart[*point as usize].min(near + far);
            }
        }
    }
    Reach {
        far: of_nodes.iter().map(|[(far, _), _]| *far).collect(),
        nearest: of_nodes.iter().map(|[(_, point), _]| *point).collect(),
        second: of_nodes.iter().map(|[_, (far, _)]| *far).collect(),
        apart,
    }
}

/// The neighbours of each node.
pub(super) struct Neighbours {
    starts: Vec<u32>,
    others: Vec<u32>,
}

impl Neighbours {
    pub(super) fn new(links: &Links) -> Neighbours {
        let mut starts = vec![0_u32; links.nodes.len() + 1];
        links.ends.iter().flatten().for_each(|&end| starts[end as usize + 1] += 1);
        (1..starts.len()).for_each(|node| starts[node] += starts[node - 1]);
        let (mut next, mut others) = (starts.clone(), vec![0; 2 * links.ends.len()]);
        for &[a, b] in &links.ends {
            for (from, to) in [(a, b), (b, a)] {
                others[next[from as usize] as usize] = to;
                next[from as usize] += 1;
            }
        }
        Neighbours { starts, others }
    }

    fn of(&self, node: u32) -> &[u32] {
        &self.others[self.starts[node as usize] as usize..self.starts[node as usize + 1] as usize]
    }

    /// Each node within two links, once, and how far it is.
    pub(super) fn two_steps(&self, links: &Links, node: u32, steps: &mut Vec<(u32, f64)>) {
        steps.clear();
        let x = &links.nodes[node as usize];
        for &one in self.of(node) {
            steps.push((one, 0.0));
            steps.extend(self.of(one).iter().map(|&two| (two, 0.0)));
        }
        steps.sort_unstable_by_key(|(other, _)| *other);
        steps.dedup_by_key(|(other, _)| *other);
        steps.retain(|(other, _)| *other != node);
        for (other, length) in steps.iter_mut() {
            *length = squared(x, &links.nodes[*other as usize]).sqrt().max(LEAST);
        }
    }
}

/// A finite distance, as a queue orders it.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Ordered(pub(super) f64);

impl Eq for Ordered {}

impl PartialOrd for Ordered {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Ordered {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}
