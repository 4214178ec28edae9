//! The weighted moments of the control points around one point, relative to its dominant control point.
//!
//! With k the dominant one, `a_i = p_i - p_k`, `b_i = q_i - q_k` and r_i the weights relative to the second-largest, w_2:
//!
//! `C / w_2 = sum_{i != k} r_i a_i b_i^T - w_2 (sum r_i a_i)(sum r_i b_i)^T`,
//!
//! exactly. The plain sum `sum w_i (p_i - p*)(q_i - q*)^T` loses all its digits when one weight is close to 1; this one
//! keeps them however small the temperature.
//!
//! The affine map is found as a correction of a base map G, from the residuals `b_i - G a_i` in place of `b_i`: where G is
//! already right they are zero to the last digit, and no ill-conditioned system can blow them up.

use super::matrix::{apply, Matrix};
use super::number::Number;
use crate::softmax::Dominant;

/// Moments of one point, the second ones divided by its second-largest weight.
pub(super) struct Moments<const D: usize, S = f64> {
    /// `p*`.
    pub p_mean: [S; D],
    /// `q* - p*`.
    pub shift: [S; D],
    /// `C / w_2`, `C = sum w_i (p_i - p*)(q_i - q*)^T`; with a base map, of the residuals in place of q.
    pub pq: [[S; D]; D],
    /// The same of p with itself.
    pub pp: [[S; D]; D],
}

impl<const D: usize, S: Number> Moments<D, S> {
    pub(super) fn new(
        p: &[[f64; D]],
        q: &[[f64; D]],
        relative: &[S],
        dominant: Dominant<S>,
        base: Option<&Matrix<D>>,
    ) -> Self {
        let Dominant { index: k, second } = dominant;
        let (mut sum_a, mut sum_b, mut sum_shift) = ([S::ZERO; D], [S::ZERO; D], [S::ZERO; D]);
        let (mut pq, mut pp) = ([[S::ZERO; D]; D], [[S::ZERO; D]; D]);
        for (i, &r) in relative.iter().enumerate() {
            if i == k || r.value() == 0.0 {
                continue;
            }
            let a: [f64; D] = std::array::from_fn(|c| p[i][c] - p[k][c]);
            let mut b: [f64; D] = std::array::from_fn(|c| q[i][c] - q[k][c]);
            for c in 0..D {
                sum_shift[c] += r * (b[c] - a[c]);
            }
            if let Some(base) = base {
                let mapped = apply(base, &a);
                b = std::array::from_fn(|c| b[c] - mapped[c]);
            }
            for c in 0..D {
                sum_a[c] += r * a[c];
                sum_b[c] += r * b[c];
                for d in 0..D {
                    pq[c][d] += r * a[c] * b[d];
                    pp[c][d] += r * a[c] * a[d];
                }
            }
        }
        for c in 0..D {
            for d in 0..D {
                pq[c][d] -= second * sum_a[c] * sum_b[d];
                pp[c][d] -= second * sum_a[c] * sum_a[d];
            }
        }
        Moments {
            p_mean: std::array::from_fn(|c| second * sum_a[c] + p[k][c]),
            shift: std::array::from_fn(|c| second * sum_shift[c] + (q[k][c] - p[k][c])),
            pq,
            pp,
        }
    }
}
