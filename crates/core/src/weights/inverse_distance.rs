//! Inverse-distance weights, those of classic MLS: `1 / (d^(2 alpha) + epsilon)`, as logits: `-log(d^(2 alpha) + epsilon)`.
//!
//! Schaefer, McPhail, Warren, "Image deformation using moving least squares", 2006. With `d` the distance and alpha an exponent on its
//! *square*, alpha = 0.5 is `1/d`.

use crate::check::{check_number, check_points};
use crate::error::Error;
use crate::geometry::Frame;
use crate::machine::memory::zeros;
use crate::machine::parallel::for_each_block;
use crate::machine::progress::{report, Progress};

/// Points between two reports of progress.
const CHUNK: usize = 1 << 16;

/// The inverse-distance weights of a set of control points.
#[derive(Clone, Debug, PartialEq)]
pub struct InverseDistance {
    dim: usize,
    p: Vec<f64>,
    frame: Frame,
    alpha: f64,
    epsilon: f64,
}

impl InverseDistance {
    /// `p` are the control points; distances, and so `epsilon`, are measured in the units of `frame` (half of the longest side of the
    /// shape's box). `alpha` > 0, `epsilon` >= 0.
    ///
    /// # Errors
    /// Where there are no control points, or a number is out of range.
    pub fn new(p: &[f64], dim: usize, frame: Frame, alpha: f64, epsilon: f64) -> Result<Self, Error> {
        if check_points("control points", p, dim)? == 0 {
            return Err(Error::argument("control points", "expected at least one, found none"));
        }
        check_number("alpha", alpha, alpha > 0.0, "a number above 0")?;
        check_number("epsilon", epsilon, epsilon >= 0.0, "a number of at least 0")?;
        Ok(InverseDistance { dim, p: p.to_vec(), frame, alpha, epsilon })
    }

    /// The control points, m x dim.
    pub fn control_points(&self) -> &[f64] {
        &self.p
    }

    /// Coordinates a point.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// What distances are measured by.
    pub fn frame(&self) -> Frame {
        self.frame
    }

    /// The exponent on the square of the distance.
    pub fn alpha(&self) -> f64 {
        self.alpha
    }

    /// What is added, so that no weight is infinite; 0 for nothing.
    pub fn epsilon(&self) -> f64 {
        self.epsilon
    }

    /// The logits of the points `x`, row by row: n x m. A point on a control point has the logit +infinity there if epsilon is 0.
    ///
    /// # Errors
    /// [`Error::Cancelled`], or where `x` does not hold finite points of the same dimension.
    pub fn logits(&self, x: &[f64], progress: &mut Progress<'_>) -> Result<Vec<f32>, Error> {
        check_points("x", x, self.dim)?;
        let (dim, m) = (self.dim, self.p.len() / self.dim);
        let mut logits = zeros(x.len() / dim * m)?;
        let chunks = logits.len().div_ceil(CHUNK * m).max(1);
        for (index, (x, logits)) in x.chunks(CHUNK * dim).zip(logits.chunks_mut(CHUNK * m)).enumerate() {
            report(progress, index as f64 / chunks as f64)?;
            for_each_block(logits, 256 * m, |block, logits| {
                for (x, row) in x[256 * dim * block..].chunks_exact(dim).zip(logits.chunks_exact_mut(m)) {
                    for (p, logit) in self.p.chunks_exact(dim).zip(row) {
                        *logit = self.logit(x, p);
                    }
                }
            });
        }
        report(progress, 1.0)?;
        Ok(logits)
    }

    /// The logits of one point in double precision, and their derivatives by its coordinates in the frame. On a control point (where without
    /// epsilon the logit is +infinity) the derivatives of its own are 0, the mean over all directions.
    pub(crate) fn slopes<const D: usize>(&self, x: &[f64; D], logits: &mut [f64], slopes: &mut [[f64; D]]) {
        for ((p, logit), slope) in self.p.chunks_exact(D).zip(logits).zip(slopes) {
            let arm: [f64; D] = std::array::from_fn(|k| (x[k] - p[k]) / self.frame.half);
            let squared: f64 = arm.iter().map(|a| a * a).sum();
            let (value, rate) = if self.epsilon == 0.0 {
                (-self.alpha * squared.ln(), self.alpha / squared)
            } else {
                let power = squared.powf(self.alpha);
                let sum = power + self.epsilon;
                (-sum.ln(), self.alpha * power / squared / sum)
            };
            *logit = value;
            *slope = if squared > 0.0 { arm.map(|a| -2.0 * rate * a) } else { [0.0; D] };
        }
    }

    fn logit(&self, x: &[f64], p: &[f64]) -> f32 {
        let squared: f64 = x.iter().zip(p).map(|(x, p)| ((x - p) / self.frame.half).powi(2)).sum();
        let logit = if self.epsilon == 0.0 {
            -self.alpha * squared.ln()
        } else {
            -(squared.powf(self.alpha) + self.epsilon).ln()
        };
        logit as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn logits(alpha: f64, epsilon: f64, x: &[f64]) -> Vec<f32> {
        let p = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
        InverseDistance::new(&p, 3, Frame::IDENTITY, alpha, epsilon)
            .unwrap()
            .logits(x, &mut |_| true)
            .unwrap()
    }

    #[test]
    fn the_softmax_of_the_logits_is_the_inverse_distance_weight() {
        let x = [0.25, 0.3, -0.2];
        for (alpha, epsilon) in [(0.5, 0.0), (1.0, 0.0), (2.0, 0.0), (1.0, 1e-2), (1.7, 0.3)] {
            let mut w = [0.0; 2];
            crate::softmax::weights(&logits(alpha, epsilon, &x), 1.0, &mut w);
            let squared = [0.25f64.powi(2) + 0.13, 0.75f64.powi(2) + 0.13];
            let naive = squared.map(|s| 1.0 / (s.powf(alpha) + epsilon));
            assert!((w[0] - naive[0] / (naive[0] + naive[1])).abs() < 1e-6, "{alpha} {epsilon}");
        }
    }

    #[test]
    fn a_point_on_a_control_point_has_an_infinite_logit_unless_epsilon_caps_it() {
        assert_eq!(logits(1.0, 0.0, &[1.0, 0.0, 0.0])[1], f32::INFINITY);
        assert!((logits(1.0, 1e-3, &[1.0, 0.0, 0.0])[1] - 1e3f32.ln()).abs() < 1e-5);
    }

    #[test]
    fn no_points_give_no_logits() {
        assert!(logits(1.0, 0.0, &[]).is_empty());
    }

    #[test]
    fn refuses_numbers_out_of_range() {
        for (alpha, epsilon) in [(0.0, 0.0), (-1.0, 0.0), (f64::NAN, 0.0), (1.0, -1.0), (1.0, f64::INFINITY)]
        {
            assert!(InverseDistance::new(&[0.0], 1, Frame::IDENTITY, alpha, epsilon).is_err());
        }
        assert!(InverseDistance::new(&[], 3, Frame::IDENTITY, 1.0, 0.0).is_err());
        let error = logits_error(&[f64::NAN, 0.0, 0.0]);
        assert!(error.to_string().contains("point 0"), "{error}");
    }

    fn logits_error(x: &[f64]) -> Error {
        let function = InverseDistance::new(&[0.0; 3], 3, Frame::IDENTITY, 1.0, 0.0).unwrap();
        function.logits(x, &mut |_| true).unwrap_err()
    }

    #[test]
    fn stops_when_asked() {
        let function = InverseDistance::new(&[0.0], 1, Frame::IDENTITY, 1.0, 0.0).unwrap();
        assert_eq!(function.logits(&[1.0], &mut |_| false), Err(Error::Cancelled));
    }
}
