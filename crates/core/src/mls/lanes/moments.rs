//! The weighted moments of [`super::super::moments`], for the 16 points of a block.
//!
//! ```text
//! for each lane: k = its dominant control point
//! for each control point i, for all lanes at once:
//!     a = p_i - p_k    b = q_i - q_k (affine: less G a)    r = w_i / w_2, 0 where i = k
//!     sum_a += r a     sum_b += r b     C += r a b^T
//! C -= w_2 sum_a sum_b^T
//! ```

use super::super::matrix::Matrix;
use super::{multiply_add, multiversion_loops, Lane, Row, Scratch, LANES};

/// Control points in one go over the lanes, as many as there are: the sums are loaded and stored once for all of them.
const MANY: usize = 10;
const SOME: usize = 5;

/// The sums of a block's lanes, `K` of them.
type Sums<const K: usize> = [[f64; LANES]; K];

multiversion_loops! {
    /// The moments of a block of rigid maps.
    pub(super) fn rigid(rows: &[Row], points: &[[f64; 6]], block: usize, scratch: &mut Scratch) = rigid_body
}
multiversion_loops! {
    /// The same, with the extent of the control points.
    pub(super) fn similarity(rows: &[Row], points: &[[f64; 6]], block: usize, scratch: &mut Scratch) = similarity_body
}
multiversion_loops! {
    /// The same, with all moments of the control points, and of the residuals of the map `base` in place of the targets.
    pub(super) fn affine(
        rows: &[Row], points: &[[f64; 6]], base: &Matrix<3>, block: usize, scratch: &mut Scratch,
    ) = affine_body
}

#[inline(always)]
fn rigid_body<const FMA: bool>(rows: &[Row], points: &[[f64; 6]], block: usize, scratch: &mut Scratch) {
    moments::<FMA, 0>(rows, points, &[[0.0; 3]; 3], block * LANES, scratch);
}

#[inline(always)]
fn similarity_body<const FMA: bool>(rows: &[Row], points: &[[f64; 6]], block: usize, scratch: &mut Scratch) {
    moments::<FMA, 1>(rows, points, &[[0.0; 3]; 3], block * LANES, scratch);
}

#[inline(always)]
fn affine_body<const FMA: bool>(
    rows: &[Row],
    points: &[[f64; 6]],
    base: &Matrix<3>,
    block: usize,
    scratch: &mut Scratch,
) {
    moments::<FMA, 6>(rows, points, base, block * LANES, scratch);
}

/// The sums over the control points.
pub(super) struct Accumulator {
    a: Sums<3>,
    b: Sums<3>,
    /// Of the residuals (affine).
    residual: Sums<3>,
    moment: Sums<9>,
    /// As [`Scratch::extent`].
    extent: Sums<6>,
}

impl Accumulator {
    pub(super) const ZERO: Accumulator = Accumulator {
        a: [[0.0; LANES]; 3],
        b: [[0.0; LANES]; 3],
        residual: [[0.0; LANES]; 3],
        moment: [[0.0; LANES]; 9],
        extent: [[0.0; LANES]; 6],
    };
}

/// `EXTENT` moments of p: none, their trace, or all 6.
#[inline(always)]
fn moments<const FMA: bool, const EXTENT: usize>(
    rows: &[Row],
    points: &[[f64; 6]],
    base: &Matrix<3>,
    first: usize,
    scratch: &mut Scratch,
) {
    let (weights, rest) = rows.split_at(points.len());
    let mut own = [[0.0; LANES]; 6];
    for (own, all) in own.iter_mut().zip(&scratch.own) {
        own.copy_from_slice(&all[first..first + LANES]);
    }
    let sums = &mut scratch.sums;
    let mut at = 0;
    while at < points.len() {
        let (rows, points) = (&weights[at..], &points[at..]);
        at += match (points.len(), at) {
            // With more sums, so many at once do not fit in the registers.
            (MANY.., 0) if EXTENT == 0 => add::<FMA, EXTENT, MANY, true>(rows, points, &own, base, sums),
            (MANY.., _) if EXTENT == 0 => add::<FMA, EXTENT, MANY, false>(rows, points, &own, base, sums),
            (SOME.., 0) => add::<FMA, EXTENT, SOME, true>(rows, points, &own, base, sums),
            (SOME.., _) => add::<FMA, EXTENT, SOME, false>(rows, points, &own, base, sums),
            (_, 0) => add::<FMA, EXTENT, 1, true>(rows, points, &own, base, sums),
            _ => add::<FMA, EXTENT, 1, false>(rows, points, &own, base, sums),
        };
    }
    let mean = if EXTENT == 6 { &sums.residual } else { &sums.b };
    let (mut p_mean, mut shift) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
    for lane in 0..LANES {
        let second = f64::from(rest[0].0[lane]) + f64::from(rest[1].0[lane]);
        for c in 0..3 {
            let share = second * sums.a[c][lane];
            for d in 0..3 {
                let moment = &mut sums.moment[3 * c + d][lane];
                *moment = multiply_add::<FMA>(-share, mean[d][lane], *moment);
            }
            p_mean[c][lane] = own[c][lane] + share;
            shift[c][lane] = (own[3 + c][lane] - own[c][lane]) + second * (sums.b[c][lane] - sums.a[c][lane]);
        }
        if EXTENT == 1 {
            let [x, y, z] = [sums.a[0][lane], sums.a[1][lane], sums.a[2][lane]];
            sums.extent[0][lane] -= second * (x * x + y * y + z * z);
        }
        if EXTENT == 6 {
            for (k, (c, d)) in SYMMETRIC.into_iter().enumerate() {
                sums.extent[k][lane] -= second * sums.a[c][lane] * sums.a[d][lane];
            }
        }
    }
    store(&sums.moment, first, &mut scratch.moment);
    store(&sums.extent[..EXTENT], first, &mut scratch.extent);
    store(&p_mean, first, &mut scratch.p_mean);
    store(&shift, first, &mut scratch.shift);
}

/// Looks up the dominant control points of a block's lanes. For all blocks of a batch before the sums of any: what is written number by
/// number cannot be read as a vector at once.
pub(super) fn look_up(rows: &[Row], points: &[[f64; 6]], block: usize, scratch: &mut Scratch) {
    let dominant = rows[points.len() + 2].0;
    for (lane, index) in dominant.into_iter().enumerate() {
        let point = &points[index.to_bits() as usize];
        for (own, coordinate) in scratch.own.iter_mut().zip(point) {
            own[block * LANES + lane] = *coordinate;
        }
    }
}

#[inline(always)]
fn store(block: &[[f64; LANES]], first: usize, batch: &mut [Lane]) {
    for (batch, block) in batch.iter_mut().zip(block) {
        batch[first..first + LANES].copy_from_slice(block);
    }
}

/// Adds the first `J` control points to the sums of all lanes, or to nothing if `FRESH`; gives `J`.
#[inline(always)]
fn add<const FMA: bool, const EXTENT: usize, const J: usize, const FRESH: bool>(
    rows: &[Row],
    points: &[[f64; 6]],
    own: &Sums<6>,
    base: &Matrix<3>,
    sums: &mut Accumulator,
) -> usize {
    let (rows, points) = (&rows[..J], &points[..J]);
    let fma = multiply_add::<FMA>;
    for lane in 0..LANES {
        let (mut moment, mut extent) = ([0.0; 9], [0.0; EXTENT]);
        let (mut sum_a, mut sum_b, mut sum_residual) = ([0.0; 3], [0.0; 3], [0.0; 3]);
        if !FRESH {
            for k in 0..9 {
                moment[k] = sums.moment[k][lane];
            }
            for k in 0..EXTENT {
                extent[k] = sums.extent[k][lane];
            }
            for c in 0..3 {
                sum_a[c] = sums.a[c][lane];
                sum_b[c] = sums.b[c][lane];
                sum_residual[c] = sums.residual[c][lane];
            }
        }
        for j in 0..J {
            let (point, r) = (&points[j], f64::from(rows[j].0[lane]));
            let (mut a, mut b, mut ra) = ([0.0; 3], [0.0; 3], [0.0; 3]);
            for c in 0..3 {
                a[c] = point[c] - own[c][lane];
                b[c] = point[3 + c] - own[3 + c][lane];
                ra[c] = r * a[c];
                sum_a[c] += ra[c];
                sum_b[c] = fma(r, b[c], sum_b[c]);
            }
            if EXTENT == 6 {
                for c in 0..3 {
                    b[c] = fma(-base[c][0], a[0], fma(-base[c][1], a[1], fma(-base[c][2], a[2], b[c])));
                    sum_residual[c] = fma(r, b[c], sum_residual[c]);
                }
            }
            for c in 0..3 {
                for d in 0..3 {
                    moment[3 * c + d] = fma(ra[c], b[d], moment[3 * c + d]);
                }
            }
            if EXTENT == 1 {
                extent[0] = fma(ra[0], a[0], fma(ra[1], a[1], fma(ra[2], a[2], extent[0])));
            }
            if EXTENT == 6 {
                for (k, (c, d)) in SYMMETRIC.into_iter().enumerate() {
                    extent[k] = fma(ra[c], a[d], extent[k]);
                }
            }
        }
        for k in 0..9 {
            sums.moment[k][lane] = moment[k];
        }
        for k in 0..EXTENT {
            sums.extent[k][lane] = extent[k];
        }
        for c in 0..3 {
            sums.a[c][lane] = sum_a[c];
            sums.b[c][lane] = sum_b[c];
            if EXTENT == 6 {
                sums.residual[c][lane] = sum_residual[c];
            }
        }
    }
    J
}

/// The upper triangle.
const SYMMETRIC: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
