//! The scale of a similarity.

use super::matrix::{trace_of_product, Matrix};
use super::moments::Moments;

/// `tr(R C) / sum w_i |p_i - p*|^2`, at least 0; `otherwise` where the weighted control points have no extent.
pub(super) fn scale<const D: usize>(moments: &Moments<D>, rotation: &Matrix<D>, otherwise: f64) -> f64 {
    let extent: f64 = (0..D).map(|k| moments.pp[k][k]).sum();
    let scale = trace_of_product(rotation, &moments.pq) / extent;
    if extent > 0.0 && scale.is_finite() {
        scale.max(0.0)
    } else {
        otherwise
    }
}
