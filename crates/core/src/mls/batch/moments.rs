//! The weighted moments of [`super::super::moments`], for the 16 points of a block.
//!
//! ```text
//! for each lane: k = its dominant control point
//! for each control point i:
//!     a = p_k - p_i    b = q_k - q_i (affine: less G a)    r = w_i / w_2, 0 where i = k
//!     sum_a += r a     sum_b += r b     C += r a b^T
//! C -= w_2 sum_a sum_b^T
//! ```

use super::super::matrix::Matrix;
use super::{Columns, Lane, Row, Scratch, LANES};
use crate::machine::simd::{multiversion, Doubles, Lanes};

multiversion! {
    /// The moments of a block of rigid maps.
    pub(super) fn rigid(rows: &[Row], points: &[[f64; 6]], columns: &Columns, block: usize, scratch: &mut Scratch) = rigid_body
}
multiversion! {
    /// The same, with the extent of the control points.
    pub(super) fn similarity(
        rows: &[Row], points: &[[f64; 6]], columns: &Columns, block: usize, scratch: &mut Scratch,
    ) = similarity_body
}
multiversion! {
    /// The same, with all moments of the control points, and of the residuals of the map `base` in place of the targets.
    pub(super) fn affine(
        rows: &[Row], points: &[[f64; 6]], columns: &Columns, base: &Matrix<3>, block: usize, scratch: &mut Scratch,
    ) = affine_body
}

#[inline(always)]
fn rigid_body<L: Lanes>(
    rows: &[Row],
    points: &[[f64; 6]],
    columns: &Columns,
    block: usize,
    scratch: &mut Scratch,
) {
    moments::<L::Doubles, 0>(rows, points, columns, &[[0.0; 3]; 3], block * LANES, scratch);
}

#[inline(always)]
fn similarity_body<L: Lanes>(
    rows: &[Row],
    points: &[[f64; 6]],
    columns: &Columns,
    block: usize,
    scratch: &mut Scratch,
) {
    moments::<L::Doubles, 1>(rows, points, columns, &[[0.0; 3]; 3], block * LANES, scratch);
}

#[inline(always)]
fn affine_body<L: Lanes>(
    rows: &[Row],
    points: &[[f64; 6]],
    columns: &Columns,
    base: &Matrix<3>,
    block: usize,
    scratch: &mut Scratch,
) {
    moments::<L::Doubles, 6>(rows, points, columns, base, block * LANES, scratch);
}

/// `EXTENT` moments of p: none, their trace, or all 6.
#[inline(always)]
fn moments<D: Doubles, const EXTENT: usize>(
    rows: &[Row],
    points: &[[f64; 6]],
    columns: &Columns,
    base: &Matrix<3>,
    first: usize,
    scratch: &mut Scratch,
) {
    let (weights, rest) = rows.split_at(points.len());
    let zero = D::splat(0.0);
    for at in (0..LANES).step_by(D::WIDTH) {
        let mut own = [zero; 6];
        for k in 0..6 {
            own[k] = D::look_up(&columns[k], &rest[2].0[at..]);
        }
        let (mut moment, mut extent) = ([zero; 9], [zero; EXTENT]);
        let (mut sum_a, mut sum_b, mut sum_residual) = ([zero; 3], [zero; 3], [zero; 3]);
        for (row, point) in weights.iter().zip(points) {
            let r = D::load_singles(&row.0[at..]);
            let (mut a, mut b, mut ra) = ([zero; 3], [zero; 3], [zero; 3]);
            for c in 0..3 {
                a[c] = own[c].sub(D::splat(point[c]));
                b[c] = own[3 + c].sub(D::splat(point[3 + c]));
                ra[c] = r.mul(a[c]);
                sum_a[c] = sum_a[c].add(ra[c]);
                sum_b[c] = r.mul_add(b[c], sum_b[c]);
            }
            if EXTENT == 6 {
                for c in 0..3 {
                    for d in 0..3 {
                        b[c] = a[d].mul_sub_from(D::splat(base[c][d]), b[c]);
                    }
                    sum_residual[c] = r.mul_add(b[c], sum_residual[c]);
                }
            }
            for k in 0..9 {
                moment[k] = ra[k / 3].mul_add(b[k % 3], moment[k]);
            }
            if EXTENT == 1 {
                for c in 0..3 {
                    extent[0] = ra[c].mul_add(a[c], extent[0]);
                }
            }
            if EXTENT == 6 {
                for (k, (c, d)) in SYMMETRIC.into_iter().enumerate() {
                    extent[k] = ra[c].mul_add(a[d], extent[k]);
                }
            }
        }
        let second = D::load_singles(&rest[0].0[at..]).add(D::load_singles(&rest[1].0[at..]));
        let share = [second.mul(sum_a[0]), second.mul(sum_a[1]), second.mul(sum_a[2])];
        let mean = if EXTENT == 6 { sum_residual } else { sum_b };
        let to = first + at;
        for k in 0..9 {
            share[k / 3].mul_sub_from(mean[k % 3], moment[k]).store(&mut scratch.moment[k][to..]);
        }
        for c in 0..3 {
            own[c].sub(share[c]).store(&mut scratch.p_mean[c][to..]);
            let moved = second.mul_sub_from(sum_b[c].sub(sum_a[c]), own[3 + c].sub(own[c]));
            moved.store(&mut scratch.shift[c][to..]);
        }
        if EXTENT == 1 {
            for c in 0..3 {
                extent[0] = share[c].mul_sub_from(sum_a[c], extent[0]);
            }
        }
        if EXTENT == 6 {
            for (k, (c, d)) in SYMMETRIC.into_iter().enumerate() {
                extent[k] = share[c].mul_sub_from(sum_a[d], extent[k]);
            }
        }
        store(&extent, to, &mut scratch.extent);
    }
}

#[inline(always)]
fn store<D: Doubles>(sums: &[D], to: usize, lanes: &mut [Lane]) {
    for (sum, lanes) in sums.iter().zip(lanes) {
        sum.store(&mut lanes[to..]);
    }
}

/// The upper triangle.
const SYMMETRIC: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
