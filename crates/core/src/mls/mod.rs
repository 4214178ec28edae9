//! Moving least squares: weights and moved control points give each place its own rigid, similarity or affine map.
//!
//! `y = M (x - p*) + q*`, with the weighted centroids `p* = sum w_i p_i`, `q* = sum w_i q_i`, and `M` the map of its kind
//! that minimises `sum w_i |M (p_i - p*) - (q_i - q*)|^2`. Schaefer, McPhail, Warren 2006 (2D); Zhu, Gortler 2007 (3D).
//! What differs from them: `M` is always a rotation (never a reflection), and where the weighted control points do not
//! determine it, it follows the one map of its kind that fits all control points with equal weights ([`Global`]).

mod affine;
pub(crate) mod batch;

mod global;
pub(crate) mod matrix;
mod moments;
mod number;
mod oriented;
mod piece;
mod rotation;
mod similarity;
mod slope;
mod transform;

pub use affine::RIDGE;
pub use piece::{piece, Piece};
pub(crate) use rotation::{best_quaternion, eigen};
pub use rotation::{best_rotation, ANCHOR_WEIGHT};
pub use transform::Transform;

use crate::geometry::Frame;
use crate::softmax::Dominant;
pub(crate) use global::Global;
use matrix::Matrix;
use moments::Moments;
pub(crate) use number::Dual;
use oriented::Oriented;
pub(crate) use oriented::{check as check_orientations, oriented, squares};

/// The moved control points, with what is the same for every point of a shape: the map that fits all of them with equal
/// weights.
pub struct Mls<'a, const D: usize> {
    p: &'a [[f64; D]],
    q: &'a [[f64; D]],
    oriented: Vec<Oriented<D>>,
    transform: Transform,
    anchor: Global<D>,
    undecided: f64,
}

/// Where a point goes, and by which map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Local<const D: usize> {
    /// `y - x`.
    pub displacement: [f64; D],
    /// `M`.
    pub map: Matrix<D>,
}

impl<'a, const D: usize> Mls<'a, D> {
    #[cfg(test)]
    pub(crate) fn new(p: &'a [[f64; D]], q: &'a [[f64; D]], transform: Transform) -> Self {
        Self::with_oriented(p, q, Vec::new(), transform)
    }

    /// Fits the anchor. `p` and `q` hold the same number of control points, at least one; of some `oriented` says how they turn.
    pub(crate) fn with_oriented(
        p: &'a [[f64; D]],
        q: &'a [[f64; D]],
        oriented: Vec<Oriented<D>>,
        transform: Transform,
    ) -> Self {
        debug_assert!(!p.is_empty() && p.len() == q.len());
        let anchor = Global::new(p, q, &oriented);
        Mls { p, q, oriented, transform, anchor, undecided: 0.0 }
    }

    /// Moves by the mean of the rotations that fit nearly as well as the best one, where that is better than others by less than this
    /// part of what it is at rest: so the maps have no jumps. 0: by the best one.
    pub(crate) fn undecided(self, part: f64) -> Self {
        Mls { undecided: part, ..self }
    }

    /// The map that fits all control points with equal weights.
    pub fn global(&self) -> &Global<D> {
        &self.anchor
    }

    /// The same map for many points at a time, in the coordinates of `frame`'s world; where there is a kernel for it (3D).
    pub(crate) fn batch(&self, frame: Frame) -> Option<batch::BatchMls> {
        if D != 3 || (self.undecided > 0.0 && self.transform != Transform::Affine) {
            return None;
        }
        let three =
            |m: &Matrix<D>| -> Matrix<3> { std::array::from_fn(|r| std::array::from_fn(|c| m[r][c])) };
        let Global { rotation, scale, linear } = &self.anchor;
        let anchor = Global { rotation: three(rotation), scale: *scale, linear: three(linear) };
        let pairs = self.p.iter().zip(self.q);
        let points =
            pairs.map(|(p, q)| std::array::from_fn(|k| if k < 3 { p[k] } else { q[k - 3] })).collect();
        let oriented = self.oriented.iter().map(|t| Oriented {
            index: t.index,
            rotation: three(&t.rotation),
            scale: t.scale,
            square: t.square,
        });
        Some(batch::BatchMls::new(points, oriented.collect(), self.transform, anchor, frame))
    }

    /// Where the point `x` goes, whose weights `relative` and `dominant` are as [`crate::softmax::relative_weights`] gives them.
    pub fn deform(&self, x: &[f64; D], relative: &[f64], dominant: Dominant) -> Local<D> {
        let base = (self.transform == Transform::Affine).then_some(&self.anchor.linear);
        let mut moments = Moments::new(self.p, self.q, relative, dominant, base);
        let added = oriented::add(&mut moments, &self.oriented, relative, dominant, base);
        let map = match self.transform {
            Transform::Rigid => self.rotation(&moments),
            Transform::Similarity => {
                let rotation = self.rotation(&moments);
                added.align(&mut moments, &rotation);
                let scale = similarity::scale(&moments, &rotation, self.anchor.scale);
                matrix::scaled(&rotation, scale)
            }
            Transform::Affine => affine::linear(&moments.pq, &moments.pp, &self.anchor.linear),
        };
        let arm: [f64; D] = std::array::from_fn(|k| x[k] - moments.p_mean[k]);
        let moved = matrix::apply(&map, &arm);
        Local { displacement: std::array::from_fn(|k| moved[k] - arm[k] + moments.shift[k]), map }
    }

    /// The rotation that `moments` ask for.
    fn rotation(&self, moments: &Moments<D>) -> Matrix<D> {
        let anchor = &self.anchor.rotation;
        if self.undecided == 0.0 {
            return rotation::anchored(&moments.pq, anchor);
        }
        // A similarity may shrink everything, and still knows how it turns.
        let shrunk = match self.transform {
            Transform::Similarity => (matrix::norm(&moments.pq) / matrix::norm(&moments.pp)).min(1.0),
            _ => 1.0,
        };
        rotation::mean(&moments.pq, anchor, &moments.pp, self.undecided * shrunk)
    }
}

#[cfg(test)]
mod tests;
