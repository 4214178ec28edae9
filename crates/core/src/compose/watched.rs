//! Places where folds are looked for: on a shape, and in space within a tenth of its side around it.

use crate::check::check_points;
use crate::deformer::{Deformer, Pose};
use crate::error::Error;
use crate::geometry::Frame;
use crate::machine::progress::Progress;
use crate::machine::random::Random;
use crate::mls::Transform;
use crate::probe::{determinants, places, with_those_beside};
use crate::weights::Weights;

/// Places on the shape that a search looks at; as many others say what it has found.
const ON: usize = 3000;
/// Every so many of them has one around it.
const AROUND: usize = 3;
/// So far around, in parts of the side.
const AWAY: f64 = 0.1;

/// Places on a shape: every second one is for the search, the others are to check what it found.
#[derive(Clone, Debug, PartialEq)]
pub struct Watched {
    dim: usize,
    side: f64,
    places: Vec<f64>,
}

/// Places, those on the shape first, and where they have come to.
pub(super) struct Travellers {
    dim: usize,
    side: f64,
    /// How many are on the shape.
    pub on: usize,
    pub at: Vec<f64>,
}

impl Watched {
    /// On the points `x` (n x dim) and triangles of a shape.
    ///
    /// # Errors
    /// Where there are no finite points, or a face names none.
    pub fn new(x: &[f64], dim: usize, faces: &[[u32; 3]]) -> Result<Watched, Error> {
        Watched::of(places(x, dim, faces, 2 * ON)?, dim)
    }

    /// The same of places (n x dim) that were chosen already.
    ///
    /// # Errors
    /// Where there are fewer than two, or they are not finite.
    pub fn of(places: Vec<f64>, dim: usize) -> Result<Watched, Error> {
        if check_points("places", &places, dim)? < 2 {
            return Err(Error::argument("places", "expected at least two places of a shape"));
        }
        Ok(Watched { dim, side: 2.0 * Frame::around(&places, dim).half, places })
    }

    /// The places, n x dim.
    pub fn places(&self) -> &[f64] {
        &self.places
    }

    /// Those for the search, or the others.
    pub(super) fn travellers(&self, others: bool) -> Travellers {
        let half = self.places.chunks_exact(self.dim).skip(usize::from(others)).step_by(2);
        let mut at: Vec<f64> = half.flatten().copied().collect();
        let on = at.len() / self.dim;
        let mut random = Random::new(u64::from(others));
        for i in (0..on).step_by(AROUND) {
            for k in 0..self.dim {
                let place = at[self.dim * i + k];
                at.push(place + AWAY * self.side * (2.0 * random.unit() - 1.0));
            }
        }
        Travellers { dim: self.dim, side: self.side, on, at }
    }
}

impl Travellers {
    /// Bound to the weights of a step.
    pub(super) fn bind(&self, weights: &Weights, transform: Transform) -> Result<Deformer, Error> {
        Deformer::new(with_those_beside(&self.at, self.dim, self.side), weights, None, transform, &mut |_| {
            true
        })
    }

    /// Where a step takes them, and `det J` of it there.
    pub(super) fn look(
        &self,
        bound: &Deformer,
        pose: Pose<'_>,
        temperature: f64,
        progress: &mut Progress<'_>,
    ) -> Result<(Vec<f64>, Vec<f64>), Error> {
        let mut y = bound.deform(pose, temperature, false, progress)?.positions;
        let beside = y.split_off(self.at.len());
        let determinants = determinants(&beside, self.dim, self.side);
        Ok((y, determinants))
    }
}
