//! Warnings of control points that a person may not have meant.

use neuralmls_core::Transform;

use super::fit::{self, Rest};
use super::{axes, ControlPoints};
use crate::error::Error;
use crate::session::{longest, LARGEST};
use crate::text::{general, names, number};

/// How far outside of the shape's box (in longest sides of it) a control point is no longer taken for intended.
const FAR_SOURCE: f64 = 1.0;
const FAR_TARGET: f64 = 10.0;
/// What a mirroring may leave of the targets, and what the best rotation must leave, to be taken for one.
const SMALL_REST: f64 = 0.1;
const LARGE_REST: f64 = 0.2;
/// Thinner than this part of their extent, control points do not tell a turn about their line from rounding.
const THIN: f64 = 1e-6;

impl ControlPoints {
    /// Warns of control points that a person may not have meant, a sentence for each kind: far outside of the shape's box
    /// (`bounds`: its least and its greatest corner), another's axes or units, mirrored targets, nearly on a line. Beside a box without a
    /// size nothing is far.
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
        let side = longest(low, high);
        let mut warnings = Vec::new();
        for (points, what, limit) in
            [(self.sources(), "position", FAR_SOURCE), (self.targets(), "target", FAR_TARGET)]
        {
            let each = || self.iter().zip(points.chunks_exact(self.dim()));
            let huge = each().filter(|(_, place)| place.iter().any(|c| c.abs() > LARGEST));
            let huge = names(huge.map(|(point, _)| &*point.name));
            if !huge.is_empty() {
                let largest = general(LARGEST, 6);
                let message = format!(
                    "the {what} of {huge} has a coordinate beyond {largest}: no coordinates of a real thing"
                );
                return Err(Error::control_point(message));
            }
            let far: Vec<(&str, f64)> = each()
                .map(|(point, place)| (&*point.name, distance(place, low, high)))
                .filter(|(_, distance)| side > 0.0 && *distance > limit * side)
                .collect();
            if !far.is_empty() {
                let most = general(far.iter().map(|(_, distance)| *distance).fold(0.0, f64::max), 6);
                let (far, side) = (names(far.iter().map(|(name, _)| *name)), general(side, 6));
                warnings.push(format!(
                    "the {what} of {far} lies up to {most} units outside of the shape, whose longest side is {side}: \
                     wrong coordinates are the usual mistake"
                ));
            }
        }
        warnings.extend(axes::other_axes_or_unit(&self.sources(), low, high));
        warnings.extend(self.mirrored());
        warnings.extend(self.on_a_line());
        Ok(warnings)
    }

    /// Targets that are the mirror image of the sources.
    fn mirrored(&self) -> Option<String> {
        let Rest { rotated, mirrored } = fit::rest(&self.sources(), &self.targets(), self.dim())?;
        (mirrored < SMALL_REST && rotated > LARGE_REST).then(|| {
            let off = match (1000.0 * mirrored).round() {
                0.0 => String::new(),
                off => format!(", to {} % of their size", number(off / 10.0)),
            };
            format!(
                "the targets are the mirror image of the sources{off}: rigid and similarity transforms \
                 fold the shape there, affine can mirror it"
            )
        })
    }

    /// Three or more control points in space that only move, on a line or nearly so.
    fn on_a_line(&self) -> Option<String> {
        let only_move = self.len() > 2 && self.posed(Transform::Rigid).orientations.is_none();
        (self.dim() == 3 && only_move && fit::thickness(&self.sources()) < THIN).then(|| {
            "the control points are on a line, or nearly so: how far the shape turns about it is not determined, but by one \
             control point beside it, or one with a rotation"
                .to_string()
        })
    }
}

/// From a place to the box; 0 inside.
fn distance(place: &[f64], low: &[f64], high: &[f64]) -> f64 {
    let outside = |k: usize| (low[k] - place[k]).max(place[k] - high[k]).max(0.0);
    (0..place.len()).map(|k| outside(k).powi(2)).sum::<f64>().sqrt()
}
