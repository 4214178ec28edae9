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

use super::order::{Block, Order};
use crate::frame::Frame;
use crate::mls::matrix::apply;
use crate::parallel::for_each_block;
use crate::simd::Simd;
use crate::softmax::{pack, Row, LANES, MORE};

/// Rows of a block beside its weights.
const BESIDE: usize = 7;
/// The anchor counts 1e-9.
const TINY: f32 = 1e-18;
/// Blocks that one thread packs at a time.
const BLOCKS: usize = 64;

/// `softmax(logits / T)` relative to each point's second-largest weight, and where the point is; packed.
pub(crate) struct PairWeights {
    temperature: f64,
    size: usize,
    rows: Vec<Row>,
}

/// The rows of a block.
pub(super) struct Rows<'a> {
    pub weights: &'a [Row],
    pub second: &'a Row,
    pub mean: &'a [Row],
    pub arm: &'a [Row],
}

/// The points that weights are packed for.
#[derive(Clone, Copy)]
pub(crate) struct Points<'a> {
    /// n x 3, as they were given.
    pub x: &'a [f64],
    /// n x m.
    pub logits: &'a [f32],
    /// The control points, in the frame.
    pub p: &'a [[f64; 3]],
    pub frame: Frame,
}

impl PairWeights {
    /// Packs them, in the memory of `old` where there is one.
    pub(crate) fn new(order: &Order, points: Points<'_>, temperature: f64, old: Option<PairWeights>) -> Self {
        let size = points.p.len() - 2 + BESIDE;
        let mut rows = old.map(|old| old.rows).unwrap_or_default();
        rows.resize(order.blocks.len() * size, Row([0.0; LANES]));
        let simd = Simd::detect();
        for_each_block(&mut rows, BLOCKS * size, |index, rows| {
            let mut packer = Packer::new(simd, points, temperature);
            for (rows, block) in rows.chunks_exact_mut(size).zip(&order.blocks[BLOCKS * index..]) {
                packer.pack(order, block, rows);
            }
        });
        PairWeights { temperature, size, rows }
    }

    pub(crate) fn temperature(&self) -> f64 {
        self.temperature
    }

    /// Tells the processor that the blocks `range` will be read soon, where it can be told.
    #[inline(always)]
    pub(super) fn prefetch(&self, range: std::ops::Range<usize>) {
        let end = self.rows.len().min(range.end * self.size);
        #[cfg(target_arch = "x86_64")]
        for row in &self.rows[end.min(range.start * self.size)..end] {
            use std::arch::x86_64::{_mm_prefetch, _MM_HINT_T0};
            // SAFETY: a prefetch reads and writes nothing.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(row).cast()) }
        }
        #[cfg(not(target_arch = "x86_64"))]
        let _ = end;
    }

    /// The blocks from the one with the number `first` on.
    pub(super) fn blocks(&self, first: usize) -> impl Iterator<Item = Rows<'_>> {
        self.rows[first * self.size..].chunks_exact(self.size).map(|rows| {
            let (weights, rest) = rows.split_at(self.size - BESIDE);
            Rows { weights, second: &rest[0], mean: &rest[1..4], arm: &rest[4..] }
        })
    }
}

struct Packer<'a> {
    simd: Simd,
    points: Points<'a>,
    temperature: f64,
    logits: Vec<f32>,
    packed: Vec<Row>,
}

impl<'a> Packer<'a> {
    fn new(simd: Simd, points: Points<'a>, temperature: f64) -> Self {
        let m = points.p.len();
        let packed = vec![Row([0.0; LANES]); m + MORE];
        Packer { simd, points, temperature, logits: vec![0.0; LANES * m], packed }
    }

    fn pack(&mut self, order: &Order, block: &Block, rows: &mut [Row]) {
        let Points { x, logits, p, frame } = self.points;
        let (m, pair) = (p.len(), &order.pairs[block.pair]);
        for (to, point) in self.logits.chunks_exact_mut(m).zip(block.points) {
            let point = point as usize;
            to.copy_from_slice(&logits[m * point..m * (point + 1)]);
        }
        pack(self.simd, &self.logits, self.temperature, &mut self.packed);
        let (weights, rest) = rows.split_at_mut(m - 2);
        rest[0] = without_tiny(&self.packed[m]);
        let mut mean = [[0.0; LANES]; 3];
        let others = (0..m).filter(|i| *i != pair.dominant && *i != pair.second);
        for (row, i) in weights.iter_mut().zip(others) {
            *row = without_tiny(&self.packed[i]);
            let a = apply(&pair.axes, &std::array::from_fn(|c| p[i][c] - p[pair.dominant][c]));
            for c in 0..3 {
                let a = (a[c] / pair.length) as f32;
                for lane in 0..LANES {
                    mean[c][lane] += row.0[lane] * a;
                }
            }
        }
        for c in 0..3 {
            for lane in 0..LANES {
                mean[c][lane] = rest[0].0[lane] * (mean[c][lane] + f32::from(u8::from(c == 0)));
            }
            rest[1 + c] = without_tiny(&Row(mean[c]));
        }
        for lane in 0..LANES {
            let point = 3 * block.points[lane] as usize;
            let place: [f64; 3] = frame.enter(&x[point..point + 3]);
            let arm = apply(&pair.axes, &std::array::from_fn(|c| place[c] - p[pair.dominant][c]));
            for c in 0..3 {
                rest[4 + c].0[lane] = (arm[c] / pair.length - f64::from(rest[1 + c].0[lane])) as f32;
            }
        }
    }
}

/// Weights that could not be seen beside the anchor are 0: denormal numbers are slow.
fn without_tiny(row: &Row) -> Row {
    Row(row.0.map(|r| if r.abs() < TINY { 0.0 } else { r }))
}
