//! The weights of all points at one temperature, in the layout that the kernels of [`crate::mls`] read.
//!
//! Points go in blocks of 16 lanes (the last one is filled up with lanes whose weights are 0). A block is m + 3 rows of 16:
//!
//! ```text
//! row i < m    w_i / w_second of each lane's point; 0 for its dominant control point
//! row m        w_second, in two parts that together have twice the digits
//! row m + 1    the second part
//! row m + 2    the index of the dominant control point: the bits of the number are it
//! ```
//!
//! These are the numbers of [`super::relative_weights`], rounded so that nothing is lost that matters: each weight is single, which is
//! as if it had been 6e-8 of itself more or less, and w_second makes the sum of the rounded ones 1 exactly, in double
//! precision. (A single w_second would put the error of the sum of a thousand weights on one of them.)

use crate::error::Error;
use crate::machine::memory::try_filled;
use crate::machine::simd::loops::{multiply_add_f32, multiversion_loops};
use crate::machine::simd::{multiversion, Lanes, Simd};

/// Points in a block.
pub(crate) const LANES: usize = 16;
/// Rows of a block after the weights.
const MORE: usize = 3;
/// Blocks that one thread packs at a time.
const BLOCKS: usize = 64;

/// One number for each point of a block; a cache line.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Row(pub [f32; LANES]);

/// `softmax(logits / T)` relative to each point's second-largest weight, packed.
pub(crate) struct PackedWeights {
    m: usize,
    temperature: f64,
    rows: Vec<Row>,
}

impl PackedWeights {
    /// Packs `logits` (n x m), in the memory of `old` where there is one.
    ///
    /// # Errors
    /// [`Error::Memory`].
    pub(crate) fn new(
        logits: &[f32],
        m: usize,
        temperature: f64,
        old: Option<PackedWeights>,
    ) -> Result<Self, Error> {
        debug_assert!(m > 0 && u32::try_from(m).is_ok() && logits.len().is_multiple_of(m));
        let size = m + MORE;
        let count = (logits.len() / m).div_ceil(LANES) * size;
        let memory = old.map(|old| old.rows).unwrap_or_default();
        let simd = Simd::detect();
        let rows = try_filled(memory, count, Row([0.0; LANES]), BLOCKS * size, |index, rows| {
            let logits = &logits[BLOCKS * LANES * m * index..];
            for (rows, logits) in rows.chunks_exact_mut(size).zip(logits.chunks(LANES * m)) {
                if logits.len() == LANES * m {
                    pack(simd, logits, temperature, rows);
                } else {
                    let mut filled = logits.to_vec();
                    filled.resize(LANES * m, 0.0);
                    pack(simd, &filled, temperature, rows);
                    clear(rows, logits.len() / m);
                }
            }
        })?;
        Ok(PackedWeights { m, temperature, rows })
    }

    /// Of which temperature these are.
    pub(crate) fn temperature(&self) -> f64 {
        self.temperature
    }

    /// The blocks from the one of the point `first`, a multiple of 16, on.
    pub(crate) fn blocks(&self, first: usize) -> impl Iterator<Item = &[Row]> + Clone {
        debug_assert!(first.is_multiple_of(LANES));
        self.rows[first / LANES * (self.m + MORE)..].chunks_exact(self.m + MORE)
    }
}

/// Takes all weight from the lanes from `first` on.
fn clear(rows: &mut [Row], first: usize) {
    for row in rows {
        row.0[first..].fill(0.0);
    }
}

/// Packs the logits of 16 points (16 x m).
fn pack(simd: Simd, logits: &[f32], temperature: f64, rows: &mut [Row]) {
    let m = rows.len() - MORE;
    let (weights, rest) = rows.split_at_mut(m);
    for (i, row) in weights.iter_mut().enumerate() {
        // One bound for all of them.
        let logits = &logits[i..=(LANES - 1) * m + i];
        for lane in 0..LANES {
            row.0[lane] = logits[lane * m];
        }
    }
    let largest = largest(simd, weights);
    exponentials(simd, &largest, temperature, weights, rest);
}

/// The largest and the second-largest logit of each lane, and the index of the former, whose bits are it.
struct Largest {
    first: Row,
    second: Row,
    index: Row,
}

multiversion! {
    /// As [`super::relative_weights`] has it: of equal logits, the first is the dominant one.
    fn largest(logits: &[Row]) -> Largest = largest_body
}

#[inline(always)]
fn largest_body<L: Lanes>(logits: &[Row]) -> Largest {
    let (mut first, mut second) = (L::splat(f32::NEG_INFINITY), L::splat(f32::NEG_INFINITY));
    let mut index = L::splat(0.0);
    for (i, row) in logits.iter().enumerate() {
        let l = L::load(&row.0);
        let above = first.less(l);
        second = L::select(above, first, second.max(l));
        first = L::select(above, l, first);
        index = L::select(above, L::splat(f32::from_bits(i as u32)), index);
    }
    Largest { first: Row(first.store()), second: Row(second.store()), index: Row(index.store()) }
}

multiversion_loops! {
    /// Makes weights of logits, and fills the rows after them.
    fn exponentials(largest: &Largest, temperature: f64, weights: &mut [Row], rest: &mut [Row]) = exponentials_body
}

#[inline(always)]
fn exponentials_body<const FMA: bool>(
    largest: &Largest,
    temperature: f64,
    weights: &mut [Row],
    rest: &mut [Row],
) {
    let m = weights.len();
    let scale = std::f64::consts::LOG2_E / temperature;
    let Largest { first: Row(first), second: Row(second), index } = largest;
    let index = index.0.map(f32::to_bits);
    let mut sum = [0.0; LANES];
    for (i, row) in weights.iter_mut().enumerate() {
        let at = i as u32;
        for lane in 0..LANES {
            let l = row.0[lane];
            let r = exponential::<FMA>(l, second[lane], scale);
            let r = if l == second[lane] { 1.0 } else { r };
            let r = if at == index[lane] { 0.0 } else { r };
            row.0[lane] = r;
            sum[lane] += f64::from(r);
        }
    }
    for lane in 0..LANES {
        let ratio = exponential::<FMA>(second[lane], first[lane], scale);
        let ratio = if second[lane] == first[lane] { 1.0 } else { ratio };
        let ratio = f64::from(if m == 1 { 0.0 } else { ratio });
        let share = ratio / (1.0 + ratio * sum[lane]);
        rest[0].0[lane] = share as f32;
        rest[1].0[lane] = (share - f64::from(share as f32)) as f32;
        rest[2].0[lane] = f32::from_bits(index[lane]);
    }
}

/// `exp((a - b) / T)` for `a <= b` and `scale = 1 / (T ln 2)`, to 1e-7 of itself; 0 below 2^-126, and where it is not a number.
///
/// `2^z = 2^n 2^f`, |f| <= 1/2, and a polynomial for the latter. The exponent is a double: a single one of -30 would leave 5e-7 of
/// doubt in the result.
#[inline(always)]
fn exponential<const FMA: bool>(a: f32, b: f32, scale: f64) -> f32 {
    /// Adding and taking it away again rounds to a whole number.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    /// The same in single precision; the low bits of the sum then are that number.
    const ROUND_SINGLE: f32 = 12_582_912.0;
    let z = (f64::from(a) - f64::from(b)) * scale;
    let normal = z >= -126.0;
    let z = if normal { z } else { 0.0 };
    let n = (z + ROUND) - ROUND;
    let f = (z - n) as f32;
    // The Taylor series of 2^f: what is left out is below 6e-9.
    let mut power = 1.525_273_4e-5;
    for c in [1.540_353e-4, 1.333_355_8e-3, 9.618_129e-3, 5.550_411e-2, 2.402_265e-1, 6.931_472e-1, 1.0] {
        power = multiply_add_f32::<FMA>(power, f, c);
    }
    let two_to_n = f32::from_bits(((n as f32 + ROUND_SINGLE).to_bits() << 23).wrapping_add(1.0f32.to_bits()));
    if normal {
        power * two_to_n
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests;
