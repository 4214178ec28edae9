//! Links between places of a shape: which are next to each other, and how well a link conducts.

use super::{squared, Position};

/// Nodes, each link once by its two nodes, and what it conducts.
#[derive(Clone, Debug, Default)]
pub(super) struct Links {
    pub(super) nodes: Vec<Position>,
    pub(super) ends: Vec<[u32; 2]>,
    pub(super) conductances: Vec<f64>,
    /// How much of the surface each node stands for.
    pub(super) areas: Vec<f64>,
}

impl Links {
    /// How long a link is.
    pub(super) fn length(&self, link: usize) -> f64 {
        let [a, b] = self.ends[link];
        squared(&self.nodes[a as usize], &self.nodes[b as usize]).sqrt()
    }

    /// With a link that is no edge.
    pub(super) fn add(&mut self, ends: [u32; 2], conducts: f64) {
        self.ends.push(ends);
        self.conductances.push(conducts);
    }

    /// The number of the connected component of each node, the largest being 0.
    pub(super) fn components(&self) -> Vec<u32> {
        let (components, count) = connected(self.ends.iter().copied(), self.nodes.len());
        let mut sizes = vec![0_usize; count];
        components.iter().for_each(|&component| sizes[component as usize] += 1);
        let mut order: Vec<u32> = (0..count as u32).collect();
        order.sort_by_key(|&component| std::cmp::Reverse(sizes[component as usize]));
        let mut place = vec![0; count];
        order.iter().enumerate().for_each(|(at, &component)| place[component as usize] = at as u32);
        components.iter().map(|&component| place[component as usize]).collect()
    }
}

/// The number of the connected component of each node, in the order of their first nodes, and how many there are.
pub(super) fn connected(ends: impl Iterator<Item = [u32; 2]>, count: usize) -> (Vec<u32>, usize) {
    let mut above: Vec<u32> = (0..count as u32).collect();
    fn top(above: &mut [u32], mut node: u32) -> u32 {
        while above[node as usize] != node {
            above[node as usize] = above[above[node as usize] as usize];
            node = above[node as usize];
        }
        node
    }
    for [a, b] in ends {
        let (a, b) = (top(&mut above, a), top(&mut above, b));
        // The smaller is the top, and comes first below.
        above[a.max(b) as usize] = a.min(b);
    }
    let (mut numbers, mut next) = (vec![0; count], 0);
    for node in 0..count as u32 {
        let top = top(&mut above, node);
        if top == node {
            (numbers[node as usize], next) = (next, next + 1);
        } else {
            numbers[node as usize] = numbers[top as usize];
        }
    }
    (numbers, next as usize)
}

/// Each pair of nodes once, the smaller first and in order, with the sum of what is given for it; none of a node with itself.
pub(super) fn summed(given: impl Iterator<Item = ([u32; 2], f64)>) -> (Vec<[u32; 2]>, Vec<f64>) {
    let key = |[a, b]: [u32; 2]| u64::from(a.min(b)) << 32 | u64::from(a.max(b));
    let mut all: Vec<(u64, f64)> = given.map(|(ends, value)| (key(ends), value)).collect();
    all.sort_by_key(|(key, _)| *key);
    let (mut ends, mut sums) = (Vec::new(), Vec::new());
    for of_one in all.chunk_by(|a, b| a.0 == b.0) {
        let [a, b] = [(of_one[0].0 >> 32) as u32, of_one[0].0 as u32];
        if a != b {
            ends.push([a, b]);
            sums.push(of_one.iter().map(|(_, value)| value).sum());
        }
    }
    (ends, sums)
}
