//! [`super::Handles::deform`] in 3D for 64 points at a time, a point a lane, in double precision from packed weights.
//!
//! ```text
//! moments      C, p*, q* of each lane: one product of its weights with the control points relative to its dominant one
//! rotation     the rotation that C and the anchor ask for: Horn's quaternion
//! turned       what those of them add that carry a rotation
//! linear       scale, or affine map
//! landing      y = x + (M - I)(x - p*) + (q* - p*)
//! ```
//!
//! Each step is a loop over lanes of plain arithmetic, which the compiler turns into the instructions of the machine. Double precision
//! costs twice the arithmetic of single; but with the weights of a trained network half of the points of a chair have a C
//! so close to rank 1 that single precision turns them by 1e-6 and more (by 0.1 at T = 0.3). What is stored, and read from
//! memory in each frame, is single.
//!
//! A lane is *sound* if its result is as good as the twin's, which does one point at a time with fewer assumptions. The caller
//! does the others by the twin: mirrored targets that leave more than one turn open, moments beyond single
//! precision's range, control points in one place.

// Lanes are counted: a loop over one array's elements would hide that it is over all of them.
#![allow(clippy::needless_range_loop)]

mod linear;
mod moments;
mod rotation;
mod turned;

use super::matrix::{identity, Matrix};
use super::turned::Turned;
use super::{Anchor, Transform, ANCHOR_WEIGHT};
use crate::frame::Frame;
use crate::simd::loops::{multiply_add, multiply_add_f32, multiversion_loops};
use crate::simd::Simd;
use crate::softmax::{Row, LANES};

/// Points in a batch: enough of them to hide the latency of divisions, few enough to stay in the first cache.
pub(crate) const BATCH: usize = 64;

/// One number of each point of a batch.
type Lane = [f64; BATCH];

/// What one frame's kernel needs of the control points.
pub(crate) struct LaneHandles {
    simd: Simd,
    transform: Transform,
    anchor: Anchor<3>,
    frame: Frame,
    /// `p_i`, `q_i`, in the frame.
    points: Vec<[f64; 6]>,
    turned: Vec<Turned<3>>,
}

/// Points of a batch in the order of memory, with room for what becomes of them.
pub(crate) struct BatchPoints<'a> {
    /// At most 64 points of 3 coordinates, as they were given.
    pub x: &'a [f64],
    /// Where they go.
    pub y: &'a mut [f64],
    /// Their maps, or nothing.
    pub maps: &'a mut [f64],
}

/// The intermediate results of a batch, to be used for one after another.
pub(crate) struct Scratch {
    /// `p_k`, `q_k` of the dominant control point.
    own: [Lane; 6],
    sums: moments::Accumulator,
    /// `C / w_2`, row-major; for affine maps of the residuals.
    moment: [Lane; 9],
    /// The moments of p with itself: xx, xy, xz, yy, yz, zz (affine), or their trace alone (similarity).
    extent: [Lane; 6],
    added: turned::Added,
    p_mean: [Lane; 3],
    shift: [Lane; 3],
    /// A, its determinant, the length of its cofactors, the root, the slope there: see [`rotation`].
    turn: rotation::Turn,
    /// `M - I`.
    change: [Lane; 9],
    /// Whether the lane's result is right: 1 or 0, of the size of the numbers that it is computed from.
    sound: Lane,
}

impl Scratch {
    pub(crate) fn new() -> Self {
        const ZERO: Lane = [0.0; BATCH];
        let turn = rotation::Turn { a: [ZERO; 9], d: ZERO, k: ZERO, v: ZERO, slope: ZERO };
        let (moment, extent, change) = ([ZERO; 9], [ZERO; 6], [ZERO; 9]);
        Scratch {
            own: [ZERO; 6],
            sums: moments::Accumulator::ZERO,
            moment,
            extent,
            added: turned::Added::ZERO,
            p_mean: [ZERO; 3],
            shift: [ZERO; 3],
            turn,
            change,
            sound: ZERO,
        }
    }

    /// Of the first `n` lanes those whose result is not sound.
    pub(crate) fn unsound(&self, n: usize) -> impl Iterator<Item = usize> + '_ {
        self.sound[..n].iter().enumerate().filter(|(_, sound)| **sound == 0.0).map(|(lane, _)| lane)
    }
}

impl LaneHandles {
    pub(crate) fn new(
        points: Vec<[f64; 6]>,
        turned: Vec<Turned<3>>,
        transform: Transform,
        anchor: Anchor<3>,
        frame: Frame,
    ) -> Self {
        LaneHandles { simd: Simd::detect(), transform, anchor, frame, points, turned }
    }

    /// Deforms at most 64 points, whose weights are in `blocks`; [`Scratch::unsound`] then has the lanes to do again.
    pub(crate) fn deform<'a>(
        &self,
        blocks: impl Iterator<Item = &'a [Row]> + Clone,
        points: BatchPoints<'_>,
        scratch: &mut Scratch,
    ) {
        let BatchPoints { x, y, maps } = points;
        let n = x.len() / 3;
        assert!(
            n <= BATCH && x.len() == 3 * n && y.len() == 3 * n && (maps.is_empty() || maps.len() == 9 * n)
        );
        let blocks = blocks.take(n.div_ceil(LANES)).enumerate();
        for (block, rows) in blocks.clone() {
            moments::look_up(rows, &self.points, block, scratch);
        }
        for (block, rows) in blocks {
            let linear = &self.anchor.linear;
            match self.transform {
                Transform::Rigid => moments::rigid(self.simd, rows, &self.points, block, scratch),
                Transform::Similarity => moments::similarity(self.simd, rows, &self.points, block, scratch),
                Transform::Affine => moments::affine(self.simd, rows, &self.points, linear, block, scratch),
            }
            if !self.turned.is_empty() {
                turned::add(self.simd, rows, &self.turned, self.transform, linear, block, scratch);
            }
        }
        finish(self.simd, self.transform, &self.anchor, !self.turned.is_empty(), scratch);
        land(self.simd, &self.frame, scratch, x, y);
        for (lane, map) in maps.chunks_exact_mut(9).enumerate() {
            let identity: Matrix<3> = identity();
            for (k, one) in identity.as_flattened().iter().enumerate() {
                map[k] = scratch.change[k][lane] + one;
            }
        }
    }
}

multiversion_loops! {
    /// From moments to `M - I`.
    fn finish(transform: Transform, anchor: &Anchor<3>, turned: bool, scratch: &mut Scratch) = finish_body
}

#[inline(always)]
fn finish_body<const FMA: bool>(
    transform: Transform,
    anchor: &Anchor<3>,
    turned: bool,
    scratch: &mut Scratch,
) {
    let Scratch { moment, extent, added, turn, change, sound, .. } = scratch;
    match transform {
        Transform::Rigid => rotation::rotations::<FMA>(moment, &anchor.rotation, turn, change, sound),
        Transform::Similarity => {
            rotation::rotations::<FMA>(moment, &anchor.rotation, turn, change, sound);
            if turned {
                turned::align::<FMA>(added, change, moment);
            }
            linear::scale::<FMA>(moment, &extent[0], change, sound);
        }
        Transform::Affine => linear::affine::<FMA>(moment, extent, &anchor.linear, change, sound),
    }
}

multiversion_loops! {
    /// Moves the points.
    fn land(frame: &Frame, scratch: &Scratch, x: &[f64], y: &mut [f64]) = land_body
}

#[inline(always)]
fn land_body<const FMA: bool>(frame: &Frame, scratch: &Scratch, x: &[f64], y: &mut [f64]) {
    let inverse = 1.0 / frame.half;
    let Scratch { p_mean, shift, change, .. } = scratch;
    for (lane, (x, y)) in x.chunks_exact(3).zip(y.chunks_exact_mut(3)).enumerate().take(BATCH) {
        let arm: [f64; 3] = [
            (x[0] - frame.centre[0]) * inverse - p_mean[0][lane],
            (x[1] - frame.centre[1]) * inverse - p_mean[1][lane],
            (x[2] - frame.centre[2]) * inverse - p_mean[2][lane],
        ];
        for r in 0..3 {
            let mut moved = shift[r][lane];
            for c in 0..3 {
                moved = multiply_add::<FMA>(change[3 * r + c][lane], arm[c], moved);
            }
            y[r] = multiply_add::<FMA>(frame.half, moved, x[r]);
        }
    }
}

#[cfg(test)]
mod tests;
