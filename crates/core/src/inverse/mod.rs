//! From where a point came: the inverse of a map of space, and its Jacobian.
//!
//! ```text
//! x_0: of the samples of the map, the one that goes nearest to y
//! x <- x - t J(x)^-1 (f(x) - y),  t = 1, halved until |f(x) - y| falls               (Newton's method, damped)
//! ```
//!
//! with J the analytic Jacobian, in which weights change from place to place (`mls/slope.rs`): not the local map M. A place counts as found
//! where `f(x) = y` and `det J(x) > 0`; where no sample leads to one, as where the map folds, it is told as missed.

mod field;
mod seek;

use crate::check::check_points;
use crate::deformer::{unmoved, Pose};
use crate::error::Error;
use crate::machine::memory::{room, zeros};
use crate::machine::progress::{report, Progress};
use crate::mls::{oriented, Mls, Transform};
use crate::softmax::check_temperature;
use crate::weights::Weights;
use field::Field;
use seek::{inverted, seek, Starts};

/// Numbers that a network says at a time, so that memory stays within bounds.
const CHUNK: usize = 1 << 24;

/// A map of space by moving least squares: weights, and control points that are moved.
///
/// ```
/// use neuralmls_core::{Frame, InverseDistance, Motion, Transform, Weights};
/// let weights = InverseDistance::new(&[0.0, 0.0, 1.0, 0.0], 2, Frame::IDENTITY, 1.0, 0.0).unwrap();
/// let weights = Weights::InverseDistance(weights);
/// let quarter = Motion::new(&weights, &[0.0, 0.0, 0.0, 1.0], 1.0, Transform::Rigid).unwrap();
/// let back = quarter.inverse(&[0.0, 0.5], false, &mut |_| true).unwrap();
/// assert!((back.points[0] - 0.5).abs() < 1e-9 && back.points[1].abs() < 1e-9 && back.missed.is_empty());
/// let jacobian = quarter.jacobians(&[0.3, 0.4], &mut |_| true).unwrap();
/// assert!(jacobian[0].abs() < 1e-9 && (jacobian[2] - 1.0).abs() < 1e-9);
/// ```
pub struct Motion<'a> {
    weights: &'a Weights,
    pose: Pose<'a>,
    temperature: f64,
    transform: Transform,
    unmoved: bool,
}

/// The result of [`Motion::inverse`].
#[derive(Clone, Debug, PartialEq)]
pub struct Inverse {
    /// From where each point came, n x dim; of a missed one, the place that goes nearest to it of those that were tried.
    pub points: Vec<f64>,
    /// By what their surroundings came back, row-major, where that was asked for: `M^-1` of the local maps there; of one that is flat, the identity.
    pub maps: Option<Vec<f64>>,
    /// The points that none was found for, by their numbers.
    pub missed: Vec<usize>,
}

impl<'a> Motion<'a> {
    /// The map that takes the control points of `weights` to the targets of `pose`, which are aimed already.
    ///
    /// # Errors
    /// Where the pose does not fit, is not finite, an orientation is none, or the temperature is not above 0.
    pub fn new(
        weights: &'a Weights,
        pose: impl Into<Pose<'a>>,
        temperature: f64,
        transform: Transform,
    ) -> Result<Motion<'a>, Error> {
        let pose = pose.into();
        check_temperature(temperature)?;
        let unmoved = unmoved(weights.control_points(), weights.dim(), pose)?;
        Ok(Motion { weights, pose, temperature, transform, unmoved })
    }

    /// The Jacobian `dy/dx` at each of the points `x` (n x dim), row-major: n x dim x dim. Where there is none, it is a mean over directions: on a
    /// control point of inverse-distance weights with `2 alpha <= T`, and at a kink of a network that of one of its sides.
    ///
    /// # Errors
    /// [`Error::Cancelled`], [`Error::Memory`]; where `x` does not hold finite points of the map's dimension.
    pub fn jacobians(&self, x: &[f64], progress: &mut Progress<'_>) -> Result<Vec<f64>, Error> {
        check_points("x", x, self.weights.dim())?;
        match self.weights.dim() {
            1 => self.jacobians_in::<1>(x, progress),
            2 => self.jacobians_in::<2>(x, progress),
            _ => self.jacobians_in::<3>(x, progress),
        }
    }

    /// From where the points `y` (n x dim) came: `x` with `f(x) = y` and `det J(x) > 0`; with the maps back if `maps`. Of an unmoved map these are the points
    /// bit for bit. Where several places go to y, it is the one that a sample of the map leads to.
    ///
    /// # Errors
    /// As [`Motion::jacobians`].
    pub fn inverse(&self, y: &[f64], maps: bool, progress: &mut Progress<'_>) -> Result<Inverse, Error> {
        check_points("y", y, self.weights.dim())?;
        match self.weights.dim() {
            1 => self.inverse_in::<1>(y, maps, progress),
            2 => self.inverse_in::<2>(y, maps, progress),
            _ => self.inverse_in::<3>(y, maps, progress),
        }
    }

    /// Calls `work` with the map in D dimensions.
    fn with<const D: usize, R>(&self, work: impl FnOnce(&Field<'_, D>) -> R) -> R {
        let frame = self.weights.frame();
        let entered =
            |points: &[f64]| -> Vec<[f64; D]> { points.chunks_exact(D).map(|p| frame.enter(p)).collect() };
        let (p, q) = (entered(self.weights.control_points()), entered(self.pose.q));
        let oriented = self.pose.orientations.map_or_else(Vec::new, |given| oriented(given, &p));
        let mls = Mls::with_oriented(&p, &q, oriented, self.transform);
        work(&Field { weights: self.weights, frame, temperature: self.temperature, mls })
    }

    /// Coordinates of the points that are taken at a time.
    fn chunk<const D: usize>(&self) -> usize {
        let m = self.weights.control_points().len() / D;
        D * (CHUNK / (m * (1 + D))).max(1)
    }

    fn jacobians_in<const D: usize>(
        &self,
        x: &[f64],
        progress: &mut Progress<'_>,
    ) -> Result<Vec<f64>, Error> {
        let (mut jacobians, chunk) = (zeros(x.len() * D)?, self.chunk::<D>());
        if self.unmoved {
            jacobians.iter_mut().enumerate().for_each(|(at, e)| *e = unit::<D>(at));
            return report(progress, 1.0).map(|()| jacobians);
        }
        self.with::<D, _>(|field| {
            for (index, (x_now, out)) in x.chunks(chunk).zip(jacobians.chunks_mut(chunk * D)).enumerate() {
                let (from, size) =
                    ((index * chunk) as f64 / x.len() as f64, x_now.len() as f64 / x.len() as f64);
                let progress = &mut |done: f64| progress(from + size * done);
                field.visit(x_now, out, D * D, progress, |place, out| {
                    out.copy_from_slice(place.jacobian.as_flattened());
                })?;
            }
            Ok(())
        })?;
        report(progress, 1.0).map(|()| jacobians)
    }

    fn inverse_in<const D: usize>(
        &self,
        y: &[f64],
        maps: bool,
        progress: &mut Progress<'_>,
    ) -> Result<Inverse, Error> {
        let mut points = zeros(y.len())?;
        let mut matrices = if maps { zeros(y.len() * D)? } else { Vec::new() };
        let mut missed = Vec::new();
        if self.unmoved {
            points.copy_from_slice(y);
            matrices.iter_mut().enumerate().for_each(|(at, e)| *e = unit::<D>(at));
        } else if !y.is_empty() {
            self.with::<D, _>(|field| {
                let (starts, chunk) = (Starts::new(field)?, self.chunk::<D>());
                for (index, targets) in y.chunks(chunk).enumerate() {
                    let first = index * chunk / D;
                    let span = targets.len() as f64 / y.len() as f64;
                    let before = (index * chunk) as f64 / y.len() as f64;
                    let mut found = room(targets.len() / D)?;
                    seek(field, &starts, targets, &mut found, &mut |done| progress(before + span * done))?;
                    for (at, seek) in found.iter().enumerate() {
                        let at = first + at;
                        points[D * at..D * (at + 1)].copy_from_slice(&seek.x);
                        if maps {
                            matrices[D * D * at..D * D * (at + 1)]
                                .copy_from_slice(inverted(&seek.map).as_flattened());
                        }
                        if !seek.found {
                            missed.push(at);
                        }
                    }
                }
                Ok(())
            })?;
        }
        report(progress, 1.0)?;
        Ok(Inverse { points, maps: maps.then_some(matrices), missed })
    }
}

/// The entry of matrices that change nothing.
fn unit<const D: usize>(at: usize) -> f64 {
    f64::from(u8::from((at % (D * D)).is_multiple_of(D + 1)))
}

#[cfg(test)]
mod tests;
