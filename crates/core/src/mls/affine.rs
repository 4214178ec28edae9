//! The linear part of an affine map.
//!
//! Least squares asks for `M = C^T P^-1`, `P = sum w_i (p_i - p*)(p_i - p*)^T`, which does not exist where the weighted control
//! points do not span the space. `M = G + (C^T - G P)(P + 1e-12 |P| I)^-1` agrees with it to 1e-12 where it exists, gives
//! the best map in the span and G on the rest where it does not, and goes from one to the other continuously.

use super::matrix::{cholesky, norm, solve, Matrix};
use super::moments::Moments;

/// What stands for the missing extent of the control points, relative to the one they have. Smaller than the rotation's
/// anchor: the residuals, unlike C, are exact where the anchor is right.
pub const RIDGE: f64 = 1e-12;

/// `moments` are those of the residuals of `g`.
pub(super) fn linear<const D: usize>(moments: &Moments<D>, g: &Matrix<D>) -> Matrix<D> {
    let (pp, residual) = (&moments.pp, &moments.pq);
    let size = norm(pp);
    if !(size > 0.0 && size.is_finite()) {
        return *g;
    }
    let ridged: Matrix<D> =
        std::array::from_fn(|r| std::array::from_fn(|c| pp[r][c] / size + if r == c { RIDGE } else { 0.0 }));
    let Some(lower) = cholesky(&ridged) else { return *g };
    std::array::from_fn(|r| {
        // The matrix is symmetric: a row of X S = E^T is the solution for a column of E.
        let row = solve(&lower, std::array::from_fn(|c| residual[c][r] / size));
        std::array::from_fn(|c| g[r][c] + row[c])
    })
}
