//! Rigid maps in 3D of 16 points at a time, in single precision, as exact as double precision would be from the same weights.
//!
//! At a point with the dominant control point k and the second one s, `C / w_s = a_s b_s^T + what the others add`, with a and b relative
//! to k. The others may be 1e-9 of it, and yet it is they who say how much the shape turns about the line from k to s. In the coordinates
//!
//! ```text
//! alpha = U a / |a_s|      U orthonormal, its first row along a_s
//! beta  = V^T b / |b_s|    V = R1 U^T, R1 the rotation that takes a_s to the direction of b_s: the least one after G
//! ```
//!
//! `alpha_s = beta_s = (1, 0, 0)`: the large number is alone in a corner of the matrix, and what the others add keeps all its digits around
//! it. Then, for points in lanes ([`kernel`]):
//!
//! ```text
//! C = sum r_i alpha_i beta_i^T - w_s sum sum^T + 1e-9 |C| G'^T
//! R' = the turn about the first axis that is best for C, and Newton's steps from there: see [`kernel`]
//! y = q_k + V (|b_s| w_s (sum r_i beta_i) + |a_s| R' U (x - p*) / |a_s|)
//! ```
//!
//! Points are sorted by pairs once ([`order`]), weights packed for a temperature ([`weights`]), and for each frame there is a table for each pair.
//! As everywhere, a lane that is not *sound* (mirrored targets, targets in one place, no convergence) is left to the
//! caller, who takes it through double precision.

mod kernel;
mod order;
mod weights;

pub(crate) use order::{Order, CHUNK};
pub(crate) use weights::{PairWeights, Points, Weights};

use super::matrix::{apply, Matrix};
use super::ANCHOR_WEIGHT;
use crate::frame::Frame;
use crate::parallel::for_each_block;
use crate::simd::Simd;
use order::{cross, direction, Pair};
use weights::Packer;

/// Numbers of one control point in the table of a pair: its part of C, beta, and two sizes that the rounding of C is judged by.
const TERMS: usize = 14;

/// Blocks whose weights are made, used and forgotten together, in the first cache.
const PASSING: usize = 16;

/// Tables that one thread makes at a time.
const TABLES: usize = 32;

/// What a frame needs of one pair.
struct Table {
    /// Those of each control point but the two.
    terms: Vec<[f32; TERMS]>,
    /// `1e-9 G'^T`.
    anchor: [f32; 9],
    /// `|b_s| / |a_s|`.
    stretch: f32,
    /// `V`, times |a_s| and the frame's size.
    landing: [f32; 9],
    /// `q_k` in the world.
    own: [f64; 3],
    /// `V`.
    v: Matrix<3>,
}

/// One frame: the tables of all pairs, `None` where the targets of a pair do not say which way it points.
pub(crate) struct PairFrame<'a> {
    simd: Simd,
    order: &'a Order,
    tables: Vec<Option<Table>>,
}

/// Where a chunk's points go.
pub(crate) struct ChunkOut<'a> {
    /// The number of the chunk.
    pub chunk: usize,
    pub y: &'a mut [f64],
    /// Their maps, or nothing.
    pub maps: &'a mut [f64],
    /// Filled with those of its points that are left to the caller.
    pub rest: &'a mut Vec<u32>,
}

impl<'a> PairFrame<'a> {
    /// `p` and `q` in `frame`, `g` the rotation of the anchor.
    pub(crate) fn new(order: &'a Order, p: &[[f64; 3]], q: &[[f64; 3]], g: &Matrix<3>, frame: Frame) -> Self {
        let mut tables: Vec<Option<Table>> = order.pairs.iter().map(|_| None).collect();
        for_each_block(&mut tables, TABLES, |block, tables| {
            for (table, pair) in tables.iter_mut().zip(&order.pairs[TABLES * block..]) {
                *table = Table::new(pair, p, q, g, frame);
            }
        });
        PairFrame { simd: Simd::detect(), order, tables }
    }

    /// Moves the points of a chunk.
    pub(crate) fn deform(&self, weights: &Weights<'_>, out: &mut ChunkOut<'_>) {
        out.rest.extend_from_slice(&self.order.loose[out.chunk]);
        let range = self.order.range(out.chunk);
        let blocks = &self.order.blocks[range.clone()];
        match weights {
            Weights::Kept(weights) => kernel::deform(self.simd, self, blocks, &weights.rows(range), out),
            Weights::Passing(points) => {
                let mut packer = Packer::new(*points);
                for blocks in blocks.chunks(PASSING) {
                    kernel::deform(self.simd, self, blocks, &packer.rows(self.order, blocks), out);
                }
            }
        }
    }
}

impl Table {
    fn new(pair: &Pair, p: &[[f64; 3]], q: &[[f64; 3]], g: &Matrix<3>, frame: Frame) -> Option<Table> {
        let Pair { dominant, second, axes, length, .. } = pair;
        let from = |points: &[[f64; 3]], i: usize| -> [f64; 3] {
            std::array::from_fn(|c| points[i][c] - points[*dominant][c])
        };
        let (along, target_length) = direction(from(q, *second));
        let stretch = target_length / length;
        let turned = apply(g, &axes[0]);
        let cos: f64 = (0..3).map(|c| turned[c] * along[c]).sum();
        // Of targets in one place there is no direction; against G's, the least rotation is any of many.
        if !(stretch > 1e-3 && stretch < 1e3 && cos > -0.999) {
            return None;
        }
        // Rodrigues' formula.
        let axis = cross(&turned, &along);
        let turn = |x: &[f64; 3]| -> [f64; 3] {
            let (once, dot) = (cross(&axis, x), (0..3).map(|c| axis[c] * x[c]).sum::<f64>());
            std::array::from_fn(|c| cos * x[c] + once[c] + axis[c] * dot / (1.0 + cos))
        };
        // The columns of V are the axes' images.
        let images: Matrix<3> = std::array::from_fn(|c| turn(&apply(g, &axes[c])));
        let v: Matrix<3> = std::array::from_fn(|r| std::array::from_fn(|c| images[c][r]));
        let terms = (pair.others(p.len()))
            .map(|i| {
                let a = apply(axes, &from(p, i)).map(|c| c / length);
                let b = apply(&images, &from(q, i)).map(|c| c / target_length);
                let beside = |v: [f64; 3]| (v[1] * v[1] + v[2] * v[2]).sqrt();
                let size = |v: [f64; 3]| direction(v).1;
                std::array::from_fn(|k| match k {
                    0..9 => a[k / 3] * b[k % 3],
                    9..12 => b[k - 9],
                    12 => beside(a) * beside(b),
                    _ => size(a) * size(b),
                } as f32)
            })
            .collect();
        // G' takes alpha to beta: V^T G U^T; its transpose, row by row, is what each axis becomes.
        let anchored: Matrix<3> = std::array::from_fn(|c| apply(&images, &apply(g, &axes[c])));
        let scale = length * frame.half;
        Some(Table {
            terms,
            anchor: std::array::from_fn(|k| (ANCHOR_WEIGHT * anchored[k / 3][k % 3]) as f32),
            stretch: stretch as f32,
            landing: std::array::from_fn(|k| (scale * v[k / 3][k % 3]) as f32),
            own: std::array::from_fn(|c| frame.centre[c] + frame.half * q[*dominant][c]),
            v,
        })
    }
}

#[cfg(test)]
mod tests;
