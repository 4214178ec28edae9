//! The linear part of an affine map.
//!
//! Least squares asks for `M = C^T P^-1`, `P = sum w_i (p_i - p*)(p_i - p*)^T`, which does not exist where the weighted control
//! points do not span the space. `M = G + (C^T - G P)(P + 1e-12 |P| I)^-1` agrees with it to 1e-12 where it exists, gives
//! the best map in the span and G on the rest where it does not, and goes from one to the other continuously.

use super::matrix::{cholesky, norm, solve, Matrix};

/// What stands for the missing extent of the control points, relative to the one they have. Smaller than the rotation's
/// anchor: the residuals, unlike C, are exact where the anchor is right.
pub const RIDGE: f64 = 1e-12;

/// `pp` is P, `residual` the moments C of what `g` leaves.
pub(super) fn linear<const D: usize>(residual: &Matrix<D>, pp: &Matrix<D>, g: &Matrix<D>) -> Matrix<D> {
    let Some(lower) = ridged(pp).as_ref().and_then(cholesky) else { return *g };
    let size = norm(pp);
    std::array::from_fn(|r| {
        // The matrix is symmetric: a row of X S = E^T is the solution for a column of E.
        let row = solve(&lower, std::array::from_fn(|c| residual[c][r] / size));
        std::array::from_fn(|c| g[r][c] + row[c])
    })
}

/// `P / |P| + 1e-12 I`; `None` where the weighted control points are in one place.
pub(super) fn ridged<const D: usize>(pp: &Matrix<D>) -> Option<Matrix<D>> {
    let size = norm(pp);
    (size > 0.0 && size.is_finite()).then(|| {
        std::array::from_fn(|r| std::array::from_fn(|c| pp[r][c] / size + if r == c { RIDGE } else { 0.0 }))
    })
}
