//! Maps that fold nothing: many small steps instead of one large one.
//!
//! ```text
//! h_0 = p,   W_k = fit(h_k),   f_k = MLS(W_k, h_k -> next),   h_{k+1} = f_k(h_k)
//! ```
//!
//! Each `f_k` is near a motion, hence turns nothing inside out, and so does their composition. The weights are fitted anew where the control points
//! are now, and aimed at the next places on their way (`path`). How long the steps are is searched for (`search`), at places on a shape and
//! around it (`watched`): there nothing folds, and at others this is checked. Where one step folds nothing, it is that one.

mod back;
mod path;
mod search;
mod watched;

pub use search::{Refit, Rules};
pub use watched::Watched;

use crate::deformer::{Deformed, Deformer, Pose};
use crate::error::Error;
use crate::machine::memory::zeros;
use crate::machine::progress::Progress;
use crate::mls::Transform;
use crate::weights::Weights;
use std::sync::Arc;

/// Steps at the most.
pub const MOST_STEPS: usize = 64;
/// Points that go all the way at a time.
const CHUNK: usize = 1 << 18;

/// One step: an ordinary map.
#[derive(Clone)]
pub struct Step {
    /// Fitted to the control points where the steps before have taken them.
    pub weights: Arc<Weights>,
    /// Where to aim, m x dim.
    pub targets: Vec<f64>,
    /// As [`Pose::orientations`].
    pub orientations: Option<Vec<f64>>,
}

impl Step {
    /// The control points moved.
    pub fn pose(&self) -> Pose<'_> {
        Pose { q: &self.targets, orientations: self.orientations.as_deref() }
    }
}

/// What was found at places of the shape other than those of the search.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The least `det J` of the whole map, on the shape and around it.
    pub least: f64,
    /// Which part of the places on the shape is folded.
    pub folded: f64,
    /// Which part of those around it.
    pub folded_around: f64,
    /// Where the least is, at rest.
    pub place: Vec<f64>,
}

/// A composition of maps.
#[derive(Clone)]
pub struct Composed {
    steps: Vec<Step>,
    transform: Transform,
    temperature: f64,
    misses: Vec<f64>,
    found: Found,
}

impl Composed {
    /// Of steps that were found already; `misses` (m): how far each control point stays from where it was to go.
    ///
    /// # Errors
    /// Where there are none or too many of them, or one does not fit.
    pub fn of(
        steps: Vec<Step>,
        transform: Transform,
        temperature: f64,
        misses: Vec<f64>,
        found: Found,
    ) -> Result<Composed, Error> {
        if !(1..=MOST_STEPS).contains(&steps.len()) {
            let message = format!("expected 1 to {MOST_STEPS}, found {}", steps.len());
            return Err(Error::argument("steps", message));
        }
        let (m, dim) = (steps[0].targets.len(), steps[0].weights.dim());
        if steps.iter().any(|step| step.weights.dim() != dim || step.weights.control_points().len() != m) {
            return Err(Error::argument("steps", "expected the same control points in each"));
        }
        let composed = Composed { steps, transform, temperature, misses, found };
        composed.land()?;
        Ok(composed)
    }

    /// The steps, the first one first.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// How far each control point stays from where it was to go, m.
    pub fn misses(&self) -> &[f64] {
        &self.misses
    }

    /// What was found at other places.
    pub fn found(&self) -> &Found {
        &self.found
    }

    /// Where the control points land, and the products of the local maps there.
    ///
    /// # Errors
    /// Where a step does not fit.
    pub fn land(&self) -> Result<Deformed, Error> {
        let first = &self.steps[0].weights;
        let p = first.control_points().to_vec();
        let bound = Deformer::new(p, first, None, self.transform, &mut |_| true)?;
        self.deform(&bound, true, &mut |_| true)
    }

    /// Where points go that are bound to the weights of the first step, with the products of the local maps if `maps`.
    ///
    /// # Errors
    /// As [`Deformer::deform`].
    pub fn deform(
        &self,
        bound: &Deformer,
        maps: bool,
        progress: &mut Progress<'_>,
    ) -> Result<Deformed, Error> {
        let size = bound.points().len();
        let mut positions = zeros(size)?;
        let mut matrices = if maps { Some(zeros(size * self.steps[0].weights.dim())?) } else { None };
        self.deform_into(bound, &mut positions, matrices.as_deref_mut(), progress)?;
        Ok(Deformed { positions, maps: matrices })
    }

    /// [`Composed::deform`] into memory that the caller has: `y` (n x dim), and `maps` (n x dim x dim) where they are wanted.
    ///
    /// # Errors
    /// As [`Deformer::deform_into`].
    pub fn deform_into(
        &self,
        bound: &Deformer,
        y: &mut [f64],
        mut maps: Option<&mut [f64]>,
        progress: &mut Progress<'_>,
    ) -> Result<(), Error> {
        let (dim, temperature) = (self.steps[0].weights.dim(), self.temperature);
        let part = 1.0 / self.steps.len() as f64;
        bound.deform_into(self.steps[0].pose(), temperature, y, maps.as_deref_mut(), &mut |done| {
            progress(part * done)
        })?;
        let n = y.len().max(1) as f64;
        for (chunk, y) in y.chunks_mut(CHUNK * dim).enumerate() {
            let before = (chunk * CHUNK * dim) as f64 / n;
            let (size, first) = (y.len(), chunk * CHUNK * dim * dim);
            let mut maps = maps.as_deref_mut().map(|maps| &mut maps[first..first + size * dim]);
            for (k, step) in self.steps[1..].iter().enumerate() {
                let mut report = |done: f64| {
                    let steps = (k as f64 + done) * part;
                    progress(part + (1.0 - part) * before + steps * size as f64 / n)
                };
                let mut bind = |done: f64| report(0.5 * done);
                let further = Deformer::new(y.to_vec(), &step.weights, None, self.transform, &mut bind)?;
                let moved = further
                    .deform(step.pose(), temperature, maps.is_some(), &mut |done| report(0.5 + 0.5 * done))?;
                y.copy_from_slice(&moved.positions);
                if let (Some(maps), Some(further)) = (&mut maps, moved.maps) {
                    multiply(&further, maps, dim);
                }
            }
        }
        Ok(())
    }
}

/// `maps <- further maps`, of each point.
fn multiply(further: &[f64], maps: &mut [f64], dim: usize) {
    let size = dim * dim;
    for (a, b) in further.chunks_exact(size).zip(maps.chunks_exact_mut(size)) {
        let product: [f64; 9] = std::array::from_fn(|at| match at < size {
            true => (0..dim).map(|k| a[at / dim * dim + k] * b[k * dim + at % dim]).sum(),
            false => 0.0,
        });
        b.copy_from_slice(&product[..size]);
    }
}

#[cfg(test)]
mod tests;
