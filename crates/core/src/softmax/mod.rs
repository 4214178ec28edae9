//! Logits at a temperature become weights.
//!
//! `w = softmax(logits / T)`. Moving least squares does not change when the weights of a point are scaled (Proposition 1 of
//! the paper), so besides the weights themselves this module gives them *relative to the second-largest*: numbers that stay
//! finite, and keep all their digits, when T is so small that every weight but one underflows.

use crate::check::check_number;
use crate::error::Error;

mod packed;

pub(crate) use packed::{PackedWeights, Row, LANES};

/// The weights of one point, in the form that [`crate::mls`] takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dominant<S = f64> {
    /// The control point with the largest logit.
    pub index: usize,
    /// The second-largest weight itself, in `[0, 1/2]`.
    pub second: S,
}

/// Checks a temperature.
///
/// # Errors
/// Where it is not a positive finite number.
pub fn check_temperature(temperature: f64) -> Result<(), Error> {
    check_number("temperature", temperature, temperature > 0.0, "a number above 0")
}

/// Fills `relative` with `w_i / w_second` for all i but the dominant one (there: 0), and returns which one that is, with the
/// second-largest weight. A logit of +infinity (a point on a control point) is a weight of 1.
pub fn relative_weights<L: Copy + Into<f64>>(
    logits: &[L],
    temperature: f64,
    relative: &mut [f64],
) -> Dominant {
    let logit = |i: usize| -> f64 { logits[i].into() };
    let mut index = 0;
    for i in 0..logits.len() {
        if logit(i) > logit(index) {
            index = i;
        }
    }
    let mut second = f64::NEG_INFINITY;
    for i in 0..logits.len() {
        if i != index && logit(i) > second {
            second = logit(i);
        }
    }
    let mut sum = 0.0;
    for (i, r) in relative.iter_mut().take(logits.len()).enumerate() {
        *r = if i == index {
            0.0
        } else if logit(i) == second {
            1.0
        } else {
            ((logit(i) - second) / temperature).exp()
        };
        sum += *r;
    }
    let ratio = if logits.len() < 2 {
        0.0
    } else if second == logit(index) {
        1.0
    } else {
        ((second - logit(index)) / temperature).exp()
    };
    Dominant { index, second: ratio / (1.0 + ratio * sum) }
}

/// `softmax(logits / T)` of one point.
///
/// ```
/// let mut w = [0.0; 2];
/// neuralmls_core::softmax::weights(&[0.0, 1.0], 0.5, &mut w);
/// assert!((w[1] / w[0] - 2f64.exp()).abs() < 1e-12 && (w[0] + w[1] - 1.0).abs() < 1e-15);
/// ```
pub fn weights(logits: &[f32], temperature: f64, w: &mut [f64]) {
    let dominant = relative_weights(logits, temperature, w);
    let mut rest = 0.0;
    for r in w.iter_mut() {
        *r *= dominant.second;
        rest += *r;
    }
    w[dominant.index] = 1.0 - rest;
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn naive(logits: &[f32], temperature: f64) -> Vec<f64> {
        let largest = logits.iter().fold(f64::NEG_INFINITY, |m, &l| m.max(f64::from(l)));
        let e: Vec<f64> = logits.iter().map(|&l| ((f64::from(l) - largest) / temperature).exp()).collect();
        let sum: f64 = e.iter().sum();
        e.iter().map(|e| e / sum).collect()
    }

    proptest! {
        #[test]
        fn agrees_with_the_formula(logits in prop::collection::vec(-30f32..30.0, 1..20), t in 0.01f64..100.0) {
            let mut w = vec![0.0; logits.len()];
            weights(&logits, t, &mut w);
            for (a, b) in w.iter().zip(naive(&logits, t)) {
                prop_assert!((a - b).abs() < 1e-14, "{} {}", a, b);
            }
        }
    }

    #[test]
    fn relative_weights_survive_a_temperature_at_which_the_weights_underflow() {
        let mut r = [0.0; 3];
        let dominant = relative_weights(&[0.0, -30.0, -31.0], 0.01, &mut r);
        assert_eq!(dominant, Dominant { index: 0, second: 0.0 });
        assert_eq!(r[1], 1.0);
        assert!((r[2] / (-100f64).exp() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_point_on_a_control_point_belongs_to_it() {
        let mut w = [0.0; 3];
        weights(&[1.0, f32::INFINITY, 2.0], 1.0, &mut w);
        assert_eq!(w, [0.0, 1.0, 0.0]);
    }

    #[test]
    fn one_control_point_has_all_the_weight() {
        let mut w = [0.0];
        weights(&[3.0], 1.0, &mut w);
        assert_eq!(w, [1.0]);
    }

    #[test]
    fn equal_logits_share_equally() {
        let mut w = [0.0; 4];
        weights(&[2.0; 4], 0.1, &mut w);
        assert_eq!(w, [0.25; 4]);
    }
}
