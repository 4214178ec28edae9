//! Points that are taken along by nodes near them.
//!
//! ```text
//! D_j(x) = |x - x_j| / A_j(x),  A_j = sum_k sqrt(w_k(x) w_k(x_j))
//! b_j ~ (1 - D_j / D_9)^2 for the eight nearest, so that it is 0 where a node stops being one of them
//! E(x) = sum_j b_j (M_j (x - x_j) + y_j)
//! ```
//!
//! `A` is the affinity of Bhattacharyya, "On a measure of divergence between two multinomial populations", 1946, of weights at the temperature 1: a
//! node beside a point that belongs to other control points is far from it. Where weights follow the shape no part takes anything of one
//! that it only lies beside; and it is known everywhere, on clothes and clouds too. Near a control point its node outweighs the others, so
//! that E takes it exactly where it goes.

use super::{apply, position, Elastic, Position, Relaxed};
use crate::error::Error;
use crate::geometry::Frame;
use crate::machine::memory::room;
use crate::machine::parallel::{for_each_at_once, for_each_block_pair};
use crate::softmax;

/// Nodes that take a point along.
const TAKEN: usize = 8;
/// The least affinity.
const LEAST: f64 = 1e-3;
/// Of the spacing of the nodes: nearer to a control point than this its node outweighs the others.
const HELD: f64 = 2.0;
/// Nodes that are looked at first.
const FIRST: usize = 24;
/// Points that one thread takes at a time.
const BLOCK: usize = 1024;

/// Points bound to nodes.
pub struct Lift {
    dim: usize,
    frame: Frame,
    /// How many nodes there are.
    count: usize,
    nodes: Vec<[u16; TAKEN]>,
    shares: Vec<[f32; TAKEN]>,
}

/// The square roots of the weights at the temperature 1.
pub(super) fn roots(logits: &[f32], m: usize) -> Vec<f32> {
    let (mut roots, mut w) = (Vec::with_capacity(logits.len()), vec![0.0; m]);
    for logits in logits.chunks_exact(m) {
        softmax::weights(logits, 1.0, &mut w);
        roots.extend(w.iter().map(|w| w.max(0.0).sqrt() as f32));
    }
    roots
}

impl Lift {
    /// Binds the points `x` (n x dim), of which the weights say `logits` (n x m).
    ///
    /// # Errors
    /// [`Error::Memory`].
    pub fn new(elastic: &Elastic, x: &[f64], logits: &[f32]) -> Result<Lift, Error> {
        let (dim, m) = (elastic.dim, elastic.p.len() / elastic.dim);
        let n = x.len() / dim;
        let (mut nodes, mut shares) = (room(n)?, room(n)?);
        nodes.resize(n, [0; TAKEN]);
        shares.resize(n, [0.0; TAKEN]);
        for_each_block_pair(&mut nodes, BLOCK, &mut shares, BLOCK, |block, nodes, shares| {
            let mut found = Vec::new();
            for (i, (nodes, shares)) in nodes.iter_mut().zip(shares).enumerate() {
                let i = BLOCK * block + i;
                let roots = roots(&logits[m * i..][..m], m);
                let x = position(&elastic.frame.enter_all(&x[dim * i..][..dim], dim));
                (*nodes, *shares) = bound(elastic, &x, &roots, &mut found);
            }
        });
        Ok(Lift { dim, frame: elastic.frame, count: elastic.nodes.len(), nodes, shares })
    }

    /// Whether it is bound to as many nodes.
    pub(crate) fn fits(&self, relaxed: &Relaxed) -> bool {
        self.count == relaxed.x.len()
    }

    /// Takes the points `x` (n x dim), which are at `y`, the part `amount` of the way to where nodes take them; their `maps` (n x dim x dim) likewise,
    /// unless there are none.
    pub(crate) fn apply(&self, relaxed: &Relaxed, amount: f64, x: &[f64], y: &mut [f64], maps: &mut [f64]) {
        let dim = self.dim;
        let one = |i: usize, y: &mut [f64], map: &mut [f64]| {
            let x = &x[dim * i..][..dim];
            let at = position(&self.frame.enter_all(x, dim));
            let (moved, local) = self.at(relaxed, i, &at);
            for k in 0..dim {
                let elastic = x[k] + self.frame.half * (moved[k] - at[k]);
                y[k] += amount * (elastic - y[k]);
            }
            for (at, e) in map.iter_mut().enumerate() {
                *e += amount * (local[at / dim][at % dim] - *e);
            }
        };
        if maps.is_empty() {
            for_each_at_once(y.chunks_mut(BLOCK * dim), |block, y| {
                y.chunks_exact_mut(dim).enumerate().for_each(|(i, y)| one(BLOCK * block + i, y, &mut []));
            });
        } else {
            let both = y.chunks_mut(BLOCK * dim).zip(maps.chunks_mut(BLOCK * dim * dim));
            for_each_at_once(both, |block, (y, maps)| {
                let each = y.chunks_exact_mut(dim).zip(maps.chunks_exact_mut(dim * dim)).enumerate();
                each.for_each(|(i, (y, map))| one(BLOCK * block + i, y, map));
            });
        }
    }

    /// Where point i, which is at `x`, goes, and the map there.
    fn at(&self, relaxed: &Relaxed, i: usize, x: &Position) -> (Position, [[f64; 3]; 3]) {
        let (mut y, mut map, mut all) = ([0.0; 3], [[0.0; 3]; 3], 0.0);
        for (node, share) in self.nodes[i].iter().zip(&self.shares[i]) {
            let (node, share) = (usize::from(*node), f64::from(*share));
            let of_node = &relaxed.maps[node];
            let from = &relaxed.x[node];
            let turned = apply(of_node, &std::array::from_fn(|k| x[k] - from[k]));
            for k in 0..3 {
                y[k] += share * (turned[k] + relaxed.y[node][k]);
                (0..3).for_each(|c| map[k][c] += share * of_node[k][c]);
            }
            all += share;
        }
        y.iter_mut().for_each(|c| *c /= all);
        map.iter_mut().flatten().for_each(|e| *e /= all);
        (y, map)
    }
}

/// The nodes that take the place `x` along, and their shares.
fn bound(
    elastic: &Elastic,
    x: &Position,
    roots: &[f32],
    found: &mut Vec<(f64, u32)>,
) -> ([u16; TAKEN], [f32; TAKEN]) {
    let m = roots.len();
    let away = |node: usize, far: f64| {
        let alike: f32 = elastic.roots[m * node..][..m].iter().zip(roots).map(|(a, b)| a * b).sum();
        far / f64::from(alike).clamp(LEAST, 1.0)
    };
    let (count, mut looked) = (elastic.nodes.len(), FIRST);
    let mut nearest: Vec<(f64, usize)> = Vec::new();
    // No distance is shorter than that in space: once the next node is farther than the ninth, no other can be one of them.
    loop {
        elastic.near.nearest(x, looked, f64::INFINITY, |_| true, found);
        nearest.clear();
        nearest
            .extend(found.iter().map(|&(square, node)| (away(node as usize, square.sqrt()), node as usize)));
        nearest.sort_by(|a, b| a.partial_cmp(b).expect("distances"));
        let farthest = found.last().map_or(0.0, |(square, _)| square.sqrt());
        if looked >= count || nearest.get(TAKEN).is_some_and(|(ninth, _)| *ninth <= farthest) {
            break;
        }
        looked *= 4;
    }
    let edge = nearest.get(TAKEN).map_or_else(|| 1.5 * nearest[nearest.len() - 1].0, |(ninth, _)| *ninth);
    let (mut nodes, mut shares) = ([0; TAKEN], [0.0; TAKEN]);
    let held = HELD * elastic.rest.spacing;
    for (at, &(far, node)) in nearest.iter().take(TAKEN).enumerate() {
        nodes[at] = node as u16;
        shares[at] = if edge > 0.0 { (1.0 - far / edge).powi(2) } else { 1.0 };
        if node < m {
            if far == 0.0 {
                shares = [0.0; TAKEN];
                shares[at] = 1.0;
                break;
            }
            shares[at] *= 1.0 + (held / far).powi(2);
        }
    }
    let all: f64 = shares.iter().sum();
    if all > 0.0 {
        (nodes, shares.map(|share: f64| (share / all) as f32))
    } else {
        // As far from one as from another.
        (nodes, [1.0; TAKEN])
    }
}
