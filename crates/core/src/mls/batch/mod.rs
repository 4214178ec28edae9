//! [`super::Mls::deform`] in 3D for 64 points at a time, a point a lane, in double precision from packed weights.
//!
//! ```text
//! moments      C, p*, q* of each lane: one product of its weights with the control points relative to its dominant one
//! oriented     what those of them add that carry a rotation
//! start        near the rotation that C and the anchor ask for: Horn's quaternion, in single precision
//! rotation     that rotation: Newton's method
//! linear       scale, or affine map
//! landing      y = x + (M - I)(x - p*) + (q* - p*)
//! ```
//!
//! Double precision costs twice the arithmetic of single; but with the weights of a trained network half of the points of a chair have a C
//! so close to rank 1 that single precision turns them by 1e-6 and more (by 0.1 at T = 0.3). What is stored, and read from
//! memory in each frame, is single.
//!
//! A lane is *sound* if its result is as good as the twin's, which does one point at a time with fewer assumptions. The caller
//! does the others by the twin: mirrored targets that leave more than one turn open, moments beyond single
//! precision's range, control points in one place.

// Lanes are counted: a loop over one array's elements would hide that it is over all of them.
#![allow(clippy::needless_range_loop)]

mod landing;
mod linear;
mod moments;
mod oriented;
mod rotation;
mod start;

use super::global::Global;
use super::matrix::{identity, transposed, Matrix};
use super::oriented::Oriented;
use super::rotation::{best_quaternion, ANCHOR_WEIGHT};
use super::transform::Transform;
use crate::geometry::Frame;
use crate::machine::simd::loops::{multiply_add, multiversion_loops};
use crate::machine::simd::{prefetch, Simd, WIDTH};
use crate::softmax::{Row, LANES};

/// Points in a batch: enough of them to hide the latency of divisions, few enough to stay in the first cache.
pub(crate) const BATCH: usize = 64;

/// One number of each point of a batch: what a batch knows is a structure of arrays.
type Lane = [f64; BATCH];

/// The same in single precision.
type Singles = [[f32; WIDTH]; BATCH / WIDTH];

/// `p_i`, `q_i` by coordinates, each filled up to whole sixteens.
type Columns = [Vec<f64>; 6];

/// What one frame's kernel needs of the control points.
pub(crate) struct BatchMls {
    simd: Simd,
    transform: Transform,
    anchor: Global<3>,
    frame: Frame,
    /// `p_i`, `q_i`, in the frame.
    points: Vec<[f64; 6]>,
    columns: Columns,
    turning: Turning,
    oriented: Vec<Oriented<3>>,
}

/// The anchor's rotation.
struct Turning {
    matrix: Matrix<3>,
    quaternion: [f64; 4],
}

impl Turning {
    fn new(matrix: Matrix<3>) -> Self {
        Turning { matrix, quaternion: best_quaternion(&transposed(&matrix)) }
    }
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
    /// `C / w_2`, row-major; for affine maps of the residuals.
    moment: [Lane; 9],
    /// The moments of p with itself: xx, xy, xz, yy, yz, zz (affine), or their trace alone (similarity).
    extent: [Lane; 6],
    added: oriented::Added,
    p_mean: [Lane; 3],
    shift: [Lane; 3],
    start: Start,
    /// Quaternions.
    turn: [Lane; 4],
    /// `M - I`.
    change: [Lane; 9],
    /// Whether the lane's result is right: 1 or 0, of the size of the numbers that it is computed from.
    sound: Lane,
}

/// Where rotations are looked for, in single precision.
struct Start {
    /// C, and what becomes of it: A.
    moment: [Singles; 9],
    /// `1 / |C|`.
    inverse: Singles,
    d: Singles,
    k: Singles,
    v: Singles,
    quaternion: [Singles; 4],
}

impl Scratch {
    pub(crate) fn new() -> Self {
        const ZERO: Lane = [0.0; BATCH];
        const SINGLE: Singles = [[0.0; WIDTH]; BATCH / WIDTH];
        Scratch {
            moment: [ZERO; 9],
            extent: [ZERO; 6],
            added: oriented::Added::ZERO,
            p_mean: [ZERO; 3],
            shift: [ZERO; 3],
            start: Start {
                moment: [SINGLE; 9],
                inverse: SINGLE,
                d: SINGLE,
                k: SINGLE,
                v: SINGLE,
                quaternion: [SINGLE; 4],
            },
            turn: [ZERO; 4],
            change: [ZERO; 9],
            sound: ZERO,
        }
    }

    /// Of the first `n` lanes those whose result is not sound.
    pub(crate) fn unsound(&self, n: usize) -> impl Iterator<Item = usize> + '_ {
        self.sound[..n].iter().enumerate().filter(|(_, sound)| **sound == 0.0).map(|(lane, _)| lane)
    }
}

impl BatchMls {
    pub(crate) fn new(
        points: Vec<[f64; 6]>,
        oriented: Vec<Oriented<3>>,
        transform: Transform,
        anchor: Global<3>,
        frame: Frame,
    ) -> Self {
        let columns = std::array::from_fn(|k| {
            let mut column: Vec<f64> = points.iter().map(|point| point[k]).collect();
            column.resize(points.len().next_multiple_of(16), 0.0);
            column
        });
        let turning = Turning::new(anchor.rotation);
        BatchMls { simd: Simd::detect(), transform, anchor, frame, points, columns, turning, oriented }
    }

    /// Deforms at most 64 points, whose weights are the first of `blocks`; [`Scratch::unsound`] then has the lanes to do again.
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
        let (simd, columns, linear) = (self.simd, &self.columns, &self.anchor.linear);
        let mut next_batch = blocks.clone().skip(BATCH / LANES);
        for (block, rows) in blocks.take(n.div_ceil(LANES)).enumerate() {
            next_batch.next().into_iter().for_each(prefetch);
            match self.transform {
                Transform::Rigid => moments::rigid(simd, rows, &self.points, columns, block, scratch),
                Transform::Similarity => {
                    moments::similarity(simd, rows, &self.points, columns, block, scratch)
                }
                Transform::Affine => {
                    moments::affine(simd, rows, &self.points, columns, linear, block, scratch)
                }
            }
            if !self.oriented.is_empty() {
                oriented::add(simd, rows, &self.oriented, self.transform, linear, block, scratch);
            }
        }
        if self.transform != Transform::Affine {
            rotate(simd, &self.turning, scratch);
        }
        if self.transform != Transform::Rigid {
            finish(simd, self.transform, linear, !self.oriented.is_empty(), scratch);
        }
        landing::land(simd, &self.frame, scratch, x, y);
        for (lane, map) in maps.chunks_exact_mut(9).enumerate() {
            let identity: Matrix<3> = identity();
            for (k, one) in identity.as_flattened().iter().enumerate() {
                map[k] = scratch.change[k][lane] + one;
            }
        }
    }
}

/// From moments to `R - I`.
fn rotate(simd: Simd, anchor: &Turning, scratch: &mut Scratch) {
    let Scratch { moment, start, turn, change, sound, .. } = scratch;
    round(simd, moment, &mut start.moment);
    start::start(simd, &anchor.matrix, start);
    rotation::rotations(simd, moment, start, anchor, turn, change, sound);
}

multiversion_loops! {
    /// Rounds to single precision, nothing to less than [`LEAST`].
    fn round(numbers: &[Lane; 9], singles: &mut [Singles; 9]) = round_body
}

/// Denormal numbers (below 1e-38) cost a hundred times as much as others.
const LEAST: f64 = 1e-17;

#[inline(always)]
fn round_body<const FMA: bool>(numbers: &[Lane; 9], singles: &mut [Singles; 9]) {
    for (single, number) in
        singles.as_flattened_mut().as_flattened_mut().iter_mut().zip(numbers.as_flattened())
    {
        *single = (*number + LEAST) as f32;
    }
}

multiversion_loops! {
    /// From rotations to similarities, or from moments to affine maps.
    fn finish(transform: Transform, linear: &Matrix<3>, oriented: bool, scratch: &mut Scratch) = finish_body
}

#[inline(always)]
fn finish_body<const FMA: bool>(
    transform: Transform,
    linear: &Matrix<3>,
    oriented: bool,
    scratch: &mut Scratch,
) {
    let Scratch { moment, extent, added, change, sound, .. } = scratch;
    if transform == Transform::Affine {
        return linear::affine::<FMA>(moment, extent, linear, change, sound);
    }
    if oriented {
        oriented::align::<FMA>(added, change, moment);
    }
    linear::scale::<FMA>(moment, &extent[0], change, sound);
}

#[cfg(test)]
mod tests;
