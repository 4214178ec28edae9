//! A composition the other way, and its Jacobian: those of its steps.

use super::{multiply, Composed, Step};
use crate::deformer::Deformer;
use crate::error::Error;
use crate::inverse::{Inverse, Motion};
use crate::machine::progress::Progress;

impl Composed {
    /// The Jacobian at each of the points `x` (n x dim), row-major: n x dim x dim, the product of those of the steps.
    ///
    /// # Errors
    /// As [`Motion::jacobians`].
    pub fn jacobians(&self, x: &[f64], progress: &mut Progress<'_>) -> Result<Vec<f64>, Error> {
        let (dim, count) = (self.steps[0].weights.dim(), self.steps.len());
        let mut x = x.to_vec();
        let mut whole = Vec::new();
        for (k, step) in self.steps.iter().enumerate() {
            let mut report = |done: f64| progress((k as f64 + done) / count as f64);
            let jacobians = self.motion(step)?.jacobians(&x, &mut |done| report(0.7 * done))?;
            match k {
                0 => whole = jacobians,
                _ => multiply(&jacobians, &mut whole, dim),
            }
            if k + 1 < count {
                let bound = Deformer::new(x, &step.weights, None, self.transform, &mut |_| true)?;
                x = bound
                    .deform(step.pose(), self.temperature, false, &mut |done| report(0.7 + 0.3 * done))?
                    .positions;
            }
        }
        Ok(whole)
    }

    /// From where the points `y` (n x dim) came, with the products of the maps back if `maps`: the steps undone, the last one first.
    ///
    /// # Errors
    /// As [`Motion::inverse`].
    pub fn inverse(&self, y: &[f64], maps: bool, progress: &mut Progress<'_>) -> Result<Inverse, Error> {
        let (dim, count) = (self.steps[0].weights.dim(), self.steps.len());
        let mut whole = Inverse { points: y.to_vec(), maps: None, missed: Vec::new() };
        for (k, step) in self.steps.iter().rev().enumerate() {
            let mut report = |done: f64| progress((k as f64 + done) / count as f64);
            let back = self.motion(step)?.inverse(&whole.points, maps, &mut report)?;
            whole.points = back.points;
            whole.missed.extend(back.missed);
            whole.maps = match (whole.maps, back.maps) {
                (Some(mut product), Some(further)) => {
                    multiply(&further, &mut product, dim);
                    Some(product)
                }
                (_, first) => first,
            };
        }
        whole.missed.sort_unstable();
        whole.missed.dedup();
        Ok(whole)
    }

    fn motion<'a>(&self, step: &'a Step) -> Result<Motion<'a>, Error> {
        Motion::new(&step.weights, step.pose(), self.temperature, self.transform)
    }
}
