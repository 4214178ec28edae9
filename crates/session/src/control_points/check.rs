//! Warnings of control points that a person may not have meant.

use super::ControlPoints;
use crate::error::Error;
use crate::text::{general, listed};

/// How far outside of the shape's box (in longest sides of it) a control point is no longer taken for intended.
const FAR_SOURCE: f64 = 1.0;
const FAR_TARGET: f64 = 10.0;
/// Units; beyond it, squares of lengths overflow.
const LARGEST: f64 = 1e150;

impl ControlPoints {
    /// Warns of control points that a person may not have meant, a sentence for each kind: far outside of the shape's box
    /// (`bounds`: its least and its greatest corner), another's axes or units, mirrored targets, nearly on a line.
    ///
    /// # Errors
    /// Control points, where they have another dimension than the shape, or a coordinate so large that no length could be
    /// measured.
    pub fn check(&self, bounds: (&[f64], &[f64])) -> Result<Vec<String>, Error> {
        let (low, high) = bounds;
        if low.len() != self.dim() || high.len() != self.dim() {
            let (found, d) = (low.len(), self.dim());
            let message = format!("the control points have {d} coordinates each, but the shape has {found}");
            return Err(Error::control_point(message));
        }
        let side = low.iter().zip(high).map(|(low, high)| high - low).fold(0.0, f64::max);
        let mut warnings = Vec::new();
        for (points, what, limit) in
            [(self.sources(), "position", FAR_SOURCE), (self.targets(), "target", FAR_TARGET)]
        {
            let each = || self.iter().zip(points.chunks_exact(self.dim()));
            let huge = each().filter(|(_, place)| place.iter().any(|c| c.abs() > LARGEST));
            let huge = listed(huge.map(|(point, _)| &*point.name));
            if !huge.is_empty() {
                let message = format!(
                    "the {what} of {huge} has a coordinate beyond 1e+150: no coordinates of a real thing"
                );
                return Err(Error::control_point(message));
            }
            let far: Vec<(&str, f64)> = each()
                .map(|(point, place)| (&*point.name, distance(place, low, high)))
                .filter(|(_, distance)| *distance > limit * side)
                .collect();
            if !far.is_empty() {
                let most = general(far.iter().map(|(_, distance)| *distance).fold(0.0, f64::max), 6);
                let (names, side) = (listed(far.iter().map(|(name, _)| *name)), general(side, 6));
                warnings.push(format!(
                    "the {what} of {names} lies up to {most} units outside of the shape, whose longest side is {side}: \
                     wrong coordinates are the usual mistake"
                ));
            }
        }
        Ok(warnings)
    }
}

/// From a place to the box; 0 inside.
fn distance(place: &[f64], low: &[f64], high: &[f64]) -> f64 {
    let outside = |k: usize| (low[k] - place[k]).max(place[k] - high[k]).max(0.0);
    (0..place.len()).map(|k| outside(k).powi(2)).sum::<f64>().sqrt()
}
