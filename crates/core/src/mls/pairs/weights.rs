//! The weights of all points at one temperature, by the blocks of an [`Order`].
//!
//! A block is m + 5 rows of 16 lanes. With k its dominant control point, s the second one, a their distance, U its axes:
//!
//! ```text
//! m - 2 rows   w_i / w_s for each i but k and s
//! 1 row        w_s
//! 3 rows       U (p* - p_k) / a
//! 3 rows       U (x - p*) / a
//! ```

// Lanes are counted, as loops have to be that compilers turn into vector instructions.
#![allow(clippy::needless_range_loop)]

use super::order::{Block, Order, Pair};
use crate::frame::Frame;
use crate::memory::filled;
use crate::mls::matrix::{apply, Matrix};
use crate::simd::loops::{multiply_add_f32, multiversion_loops};
use crate::simd::Simd;
use crate::softmax::{pack_rows, Row, LANES, MORE};
use std::ops::Range;
use std::sync::Arc;

const ZERO: Row = Row([0.0; LANES]);

/// Rows of a block beside its weights.
const BESIDE: usize = 7;
/// The anchor counts 1e-9.
const TINY: f32 = 1e-18;
/// Blocks that one thread packs at a time.
const BLOCKS: usize = 64;

/// The points that weights are packed for, at one temperature.
#[derive(Clone, Copy)]
pub(crate) struct Points<'a> {
    /// n x 3, as they were given.
    pub x: &'a [f64],
    /// n x m.
    pub logits: &'a [f32],
    /// The control points, in the frame.
    pub p: &'a [[f64; 3]],
    pub frame: Frame,
    pub temperature: f64,
}

/// The weights of a frame.
pub(crate) enum Weights<'a> {
    Kept(Arc<PairWeights>),
    /// Made where they are needed, and forgotten: a single frame needs no memory for them.
    Passing(Points<'a>),
}

/// `softmax(logits / T)` relative to each point's second-largest weight, and where the point is; packed.
pub(crate) struct PairWeights {
    temperature: f64,
    size: usize,
    rows: Vec<Row>,
}

/// The rows of some blocks.
pub(super) struct Rows<'a> {
    size: usize,
    rows: &'a [Row],
}

/// The rows of a block.
pub(super) struct BlockRows<'a> {
    pub weights: &'a [Row],
    pub second: &'a Row,
    pub mean: &'a [Row],
    pub arm: &'a [Row],
}

impl PairWeights {
    /// Packs them, in the memory of `old` where there is one.
    pub(crate) fn new(order: &Order, points: Points<'_>, old: Option<PairWeights>) -> Self {
        let size = size(points);
        let memory = old.map(|old| old.rows).unwrap_or_default();
        let count = order.blocks.len() * size;
        let rows = filled(memory, count, ZERO, BLOCKS * size, |index, rows| {
            Packer::new(points).pack(order, &order.blocks[BLOCKS * index..], rows);
        });
        PairWeights { temperature: points.temperature, size, rows }
    }

    pub(crate) fn temperature(&self) -> f64 {
        self.temperature
    }

    pub(super) fn rows(&self, blocks: Range<usize>) -> Rows<'_> {
        Rows { size: self.size, rows: &self.rows[blocks.start * self.size..blocks.end * self.size] }
    }
}

impl Rows<'_> {
    /// The blocks from the one with the number `first` on.
    pub(super) fn blocks(&self, first: usize) -> impl Iterator<Item = BlockRows<'_>> {
        self.rows[first * self.size..].chunks_exact(self.size).map(|rows| {
            let (weights, rest) = rows.split_at(self.size - BESIDE);
            BlockRows { weights, second: &rest[0], mean: &rest[1..4], arm: &rest[4..] }
        })
    }
}

/// Rows of a block.
fn size(points: Points<'_>) -> usize {
    points.p.len() - 2 + BESIDE
}

/// Packs blocks, one after another.
pub(super) struct Packer<'a> {
    simd: Simd,
    points: Points<'a>,
    packed: Vec<Row>,
    passing: Vec<Row>,
    /// The pair of the last block.
    last: Option<u32>,
    /// Of its control points but the two, `U (p_i - p_k) / a`.
    alphas: Vec<[f32; 3]>,
}

impl<'a> Packer<'a> {
    pub(super) fn new(points: Points<'a>) -> Self {
        let packed = vec![ZERO; points.p.len() + MORE];
        Packer { simd: Simd::detect(), points, packed, passing: Vec::new(), last: None, alphas: Vec::new() }
    }

    /// The rows of `blocks`, until the next ones are wanted.
    pub(super) fn rows(&mut self, order: &Order, blocks: &[Block]) -> Rows<'_> {
        let size = size(self.points);
        let mut rows = std::mem::take(&mut self.passing);
        rows.resize(blocks.len() * size, ZERO);
        self.pack(order, blocks, &mut rows);
        self.passing = rows;
        Rows { size, rows: &self.passing }
    }

    /// Fills `rows` with the first of `blocks`.
    fn pack(&mut self, order: &Order, blocks: &[Block], rows: &mut [Row]) {
        for (rows, block) in rows.chunks_exact_mut(size(self.points)).zip(blocks) {
            let pair = &order.pairs[block.pair as usize];
            if self.last != Some(block.pair) {
                self.last = Some(block.pair);
                self.turn_to(pair);
            }
            self.pack_block(pair, block, rows);
        }
    }

    fn turn_to(&mut self, pair: &Pair) {
        let p = self.points.p;
        self.alphas.clear();
        self.alphas.extend(pair.others(p.len()).map(|i| {
            let a = apply(&pair.axes, &std::array::from_fn(|c| p[i][c] - p[pair.dominant][c]));
            a.map(|a| (a / pair.length) as f32)
        }));
    }

    fn pack_block(&mut self, pair: &Pair, block: &Block, rows: &mut [Row]) {
        let Points { x, logits, p, frame, temperature } = self.points;
        let m = p.len();
        let mut places = [[0.0; LANES]; 3];
        for (lane, point) in block.points.iter().enumerate() {
            let point = *point as usize;
            for (row, logit) in self.packed.iter_mut().zip(&logits[m * point..m * (point + 1)]) {
                row.0[lane] = *logit;
            }
            for (place, x) in places.iter_mut().zip(&x[3 * point..3 * (point + 1)]) {
                place[lane] = *x;
            }
        }
        pack_rows(self.simd, temperature, &mut self.packed);
        for (row, i) in rows.iter_mut().zip(pair.others(m).chain([m])) {
            *row = self.packed[i];
        }
        let axes = pair.axes.map(|axis| axis.map(|c| c / pair.length));
        let own = p[pair.dominant];
        put_places(self.simd, &self.alphas, &places, &frame, &own, &axes, rows);
    }
}

multiversion_loops! {
    /// After the weights: what follows from them and from where the points are.
    fn put_places(
        alphas: &[[f32; 3]], places: &[[f64; LANES]; 3], frame: &Frame, own: &[f64; 3], axes: &Matrix<3>, rows: &mut [Row],
    ) = put_places_body
}

#[inline(always)]
fn put_places_body<const FMA: bool>(
    alphas: &[[f32; 3]],
    places: &[[f64; LANES]; 3],
    frame: &Frame,
    own: &[f64; 3],
    axes: &Matrix<3>,
    rows: &mut [Row],
) {
    let (weights, rest) = rows.split_at_mut(alphas.len());
    without_tiny(&mut rest[0]);
    let mut mean = [ZERO; 3];
    for (row, alpha) in weights.iter_mut().zip(alphas) {
        without_tiny(row);
        for c in 0..3 {
            for lane in 0..LANES {
                mean[c].0[lane] = multiply_add_f32::<FMA>(row.0[lane], alpha[c], mean[c].0[lane]);
            }
        }
    }
    let mut from_own = [[0.0; LANES]; 3];
    for c in 0..3 {
        for lane in 0..LANES {
            from_own[c][lane] = (places[c][lane] - frame.centre[c]) / frame.half - own[c];
        }
    }
    for c in 0..3 {
        // The second control point's.
        let second = if c == 0 { 1.0 } else { 0.0 };
        for lane in 0..LANES {
            mean[c].0[lane] = (mean[c].0[lane] + second) * rest[0].0[lane];
        }
        without_tiny(&mut mean[c]);
        rest[1 + c] = mean[c];
        for lane in 0..LANES {
            let arm = axes[c][0] * from_own[0][lane]
                + axes[c][1] * from_own[1][lane]
                + axes[c][2] * from_own[2][lane];
            rest[4 + c].0[lane] = (arm - f64::from(mean[c].0[lane])) as f32;
        }
    }
}

/// Weights that could not be seen beside the anchor are 0: denormal numbers are slow.
#[inline(always)]
fn without_tiny(row: &mut Row) {
    for lane in 0..LANES {
        let r = row.0[lane];
        row.0[lane] = if r.abs() < TINY { 0.0 } else { r };
    }
}
