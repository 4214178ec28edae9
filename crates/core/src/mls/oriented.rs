//! Control points that carry a rotation, and perhaps a scale.
//!
//! MLS asks a control point only where it goes. One that is *oriented* also says how: it is a small frame, whose points `p_i` and
//! `p_i +- rho_i e_k` go to `q_i` and `q_i +- rho_i s_i R_i e_k`. Summed, with `u_i / 2` for each point of the frame, they add
//!
//! ```text
//! u_i rho_i^2 R_i^T        to C = sum w_i (p_i - p*)(q_i - q*)^T, which rotations are found from
//! u_i rho_i^2 s_i R_i^T    to the same, of which affine maps and scales are found
//! u_i rho_i^2 I            to P = sum w_i (p_i - p*)(p_i - p*)^T
//! ```
//!
//! and nothing to `p*` and `q*`. A control point that is not oriented adds nothing, so that it does not resist.
//!
//! `u_i = w_i^2`, and `rho_i` is the distance from `p_i` to the nearest other control point. Squared, because a rotation, unlike a
//! place, is nothing to a control point far away: with `u_i = w_i` the little weight that an oriented armrest has at the seat orientations the
//! seat, whose other weights are as small. The distance, because the places of the others, which hold on, count by theirs.
//!
//! For the scale of a similarity each frame counts as if it were turned as the place is (`s_i R^T`): otherwise what is
//! twisted shrinks between its ends.

use super::matrix::Matrix;
use super::moments::Moments;
use super::number::Number;
use crate::error::Error;
use crate::softmax::Dominant;

/// A control point that is oriented.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Oriented<const D: usize> {
    /// Which one, i.
    pub index: usize,
    /// `R_i`.
    pub rotation: Matrix<D>,
    /// `s_i`.
    pub scale: f64,
    /// `rho_i^2`.
    pub square: f64,
}

/// Rounding, and a file's last digits, may leave this much of `R^T R - I`.
const ROUNDING: f64 = 1e-6;

/// Checks that `orientations` (m x dim x dim) holds a rotation times a scale above 0, or nothing but NaN, for each of `m` control points;
/// gives whether all of them leave their control points as they are.
///
/// # Errors
/// Where they do not.
pub(crate) fn check(orientations: &[f64], m: usize, dim: usize) -> Result<bool, Error> {
    if orientations.len() != m * dim * dim {
        let message = format!("expected {m} x {dim} x {dim} numbers, found {}", orientations.len());
        return Err(Error::argument("orientations", message));
    }
    let mut still = true;
    for (i, turn) in orientations.chunks_exact(dim * dim).enumerate() {
        if turn.iter().all(|e| e.is_nan()) {
            continue;
        }
        let right = match dim {
            1 => turn[0] > 0.0 && turn[0].is_finite(),
            2 => is_orientation(&read::<2>(turn)),
            _ => is_orientation(&read::<3>(turn)),
        };
        if !right {
            let message = format!("that of control point {i} is not a rotation times a scale above 0");
            return Err(Error::argument("orientations", message));
        }
        still &= turn.iter().enumerate().all(|(k, &e)| e == f64::from(u8::from(k % (dim + 1) == 0)));
    }
    Ok(still)
}

/// The oriented ones of the control points `p`, by their `orientations` (m x D x D), which are checked.
pub(crate) fn oriented<const D: usize>(orientations: &[f64], p: &[[f64; D]]) -> Vec<Oriented<D>> {
    let orientations = orientations.chunks_exact(D * D).map(read::<D>).enumerate();
    orientations
        .filter(|(_, turn)| !turn[0][0].is_nan())
        .map(|(index, turn)| {
            let scale = size(&turn);
            let rotation = turn.map(|row| row.map(|e| e / scale));
            Oriented { index, rotation, scale, square: nearest(p, index) }
        })
        .collect()
}

fn read<const D: usize>(turn: &[f64]) -> Matrix<D> {
    std::array::from_fn(|r| std::array::from_fn(|c| turn[D * r + c]))
}

/// `s` of `s R`.
fn size<const D: usize>(turn: &Matrix<D>) -> f64 {
    (turn.as_flattened().iter().map(|e| e * e).sum::<f64>() / D as f64).sqrt()
}

fn is_orientation<const D: usize>(turn: &Matrix<D>) -> bool {
    let scale = size(turn);
    if !(scale > 0.0 && scale.is_finite()) {
        return false;
    }
    let r = turn.map(|row| row.map(|e| e / scale));
    let orthogonal = (0..D).all(|i| {
        (0..D).all(|j| {
            let dot: f64 = (0..D).map(|k| r[i][k] * r[j][k]).sum();
            (dot - f64::from(u8::from(i == j))).abs() < ROUNDING
        })
    });
    // Of an orthogonal matrix the last entry is its cofactor times the determinant, 1 or -1.
    let determinant = match D {
        2 => r[0][0] * r[1][1] - r[0][1] * r[1][0],
        _ => {
            let minor = |i: usize, j: usize| r[1][i] * r[2][j] - r[1][j] * r[2][i];
            r[0][0] * minor(1, 2) - r[0][1] * minor(0, 2) + r[0][2] * minor(0, 1)
        }
    };
    orthogonal && determinant > 0.0
}

/// The square of the distance from one of the control points to the nearest other one; 1 where all are there, and nothing is to be
/// compared with.
fn nearest<const D: usize>(p: &[[f64; D]], index: usize) -> f64 {
    let square = |a: &[f64; D]| (0..D).map(|k| (a[k] - p[index][k]).powi(2)).sum::<f64>();
    let least = p.iter().map(square).filter(|&s| s > 0.0).fold(f64::INFINITY, f64::min);
    if least.is_finite() {
        least
    } else {
        1.0
    }
}

/// That of each control point.
pub(crate) fn squares<const D: usize>(p: &[[f64; D]]) -> Vec<f64> {
    (0..p.len()).map(|index| nearest(p, index)).collect()
}

/// What the oriented control points add to C, kept for the scale.
pub(super) struct Added<const D: usize, S = f64> {
    /// `sum u_i rho_i^2 R_i^T`, at the scale of the moments.
    rotation: [[S; D]; D],
    /// `sum u_i rho_i^2 s_i`.
    scale: S,
}

/// Adds the oriented control points to the moments, which thereafter are divided by 1, not by `w_2`, if the dominant control point is one of
/// them. With a `base` map the moments are those of residuals, and scales count.
pub(super) fn add<const D: usize, S: Number>(
    moments: &mut Moments<D, S>,
    oriented: &[Oriented<D>],
    relative: &[S],
    dominant: Dominant<S>,
    base: Option<&Matrix<D>>,
) -> Added<D, S> {
    let Dominant { index: k, second } = dominant;
    let mut added = Added { rotation: [[S::ZERO; D]; D], scale: S::ZERO };
    if oriented.is_empty() {
        return added;
    }
    let owned = oriented.iter().any(|t| t.index == k);
    if owned {
        moments.pq = moments.pq.map(|row| row.map(|e| second * e));
        moments.pp = moments.pp.map(|row| row.map(|e| second * e));
    }
    let others = relative.iter().enumerate().filter(|(i, _)| *i != k);
    let rest = others.fold(S::ZERO, |sum, (_, r)| sum + *r);
    for t in oriented {
        let relative = if t.index == k { S::ZERO } else { relative[t.index] };
        let w = if t.index == k { second * rest * -1.0 + 1.0 } else { second * relative };
        // u / w_2, or u.
        let share = w * t.square * if owned { w } else { relative };
        for r in 0..D {
            for c in 0..D {
                let turn = t.rotation[c][r];
                added.rotation[r][c] += share * turn;
                moments.pq[r][c] += share * base.map_or(turn, |base| t.scale * turn - base[c][r]);
            }
            moments.pp[r][r] += share;
        }
        added.scale += share * t.scale;
    }
    added
}

impl<const D: usize, S: Number> Added<D, S> {
    /// Makes of moments that a rotation was found from those that its scale is found from.
    pub(super) fn align(&self, moments: &mut Moments<D, S>, rotation: &[[S; D]; D]) {
        for (r, row) in moments.pq.iter_mut().enumerate() {
            for (c, moment) in row.iter_mut().enumerate() {
                *moment += self.scale * rotation[c][r] - self.rotation[r][c];
            }
        }
    }
}

#[cfg(test)]
mod tests;
