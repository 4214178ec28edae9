//! Weight functions, each as a logit function: `w = softmax(logits(x) / T)`.
//!
//! MLS does not change when the weights of a point are normalised (Proposition 1 of the paper), so the inverse-distance weights are
//! a softmax too, and neural, inverse-distance and any later weights share one path.

pub(crate) mod inverse_distance;
pub(crate) mod network;
pub(crate) mod shape_graph;

use crate::error::Error;
use crate::geometry::{Frame, PointTree};
use crate::machine::progress::Progress;
use inverse_distance::InverseDistance;
use network::{fit, Trained, Training};
use shape_graph::Shape;

/// A weight function of control points.
///
/// ```
/// use neuralmls_core::{Frame, Training, Weights};
/// let p = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
/// let weights = Weights::neural(&p, 2, Frame::IDENTITY, &Training::default(), &mut |_| true).unwrap();
/// let logits = weights.logits(&[0.1, 0.0], &mut |_| true).unwrap();
/// assert!(logits[0] > logits[1] && logits[0] > logits[2]);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // There is one of them a shape.
pub enum Weights {
    /// The paper's: a network that was trained on the control points alone.
    Neural(Trained),
    /// A network that samples of the shape were taught too.
    ShapeAware(Trained),
    /// Classic MLS: `1 / (d^(2 alpha) + epsilon)`.
    InverseDistance(InverseDistance),
}

impl Weights {
    /// Trains neural weights of the control points `p` (m x dim), in `frame`.
    ///
    /// # Errors
    /// [`Error::Cancelled`]; where there are no control points, more than 1,000, two in one place, or a parameter is out of range.
    pub fn neural(
        p: &[f64],
        dim: usize,
        frame: Frame,
        training: &Training,
        progress: &mut Progress<'_>,
    ) -> Result<Weights, Error> {
        fit(p, None, dim, frame, training, progress).map(Weights::Neural)
    }

    /// Trains weights of the control points `p` (m x dim), in `frame`, that know `shape`: besides the control points the network is taught
    /// places all over it, where it is to give `w_i ~ h_i^(2.5 s) / E_i^(6 (1 - s))` (`shape_graph`).
    ///
    /// # Errors
    /// As [`Weights::neural`]; where the shape has no finite points, or a face names none; [`Error::Memory`].
    pub fn shape_aware(
        p: &[f64],
        dim: usize,
        frame: Frame,
        shape: Shape<'_>,
        seed: u64,
        progress: &mut Progress<'_>,
    ) -> Result<Weights, Error> {
        shape_graph::fit(p, dim, frame, shape, seed, progress).map(Weights::ShapeAware)
    }

    /// Its name in every face and file.
    pub fn kind(&self) -> &'static str {
        match self {
            Weights::Neural(_) => "neural",
            Weights::ShapeAware(_) => "shape-aware",
            Weights::InverseDistance(_) => "inverse-distance",
        }
    }

    /// The control points at rest, m x dim.
    pub fn control_points(&self) -> &[f64] {
        match self {
            Weights::Neural(trained) | Weights::ShapeAware(trained) => &trained.control_points,
            Weights::InverseDistance(function) => function.control_points(),
        }
    }

    /// Coordinates a point.
    pub fn dim(&self) -> usize {
        match self {
            Weights::Neural(trained) | Weights::ShapeAware(trained) => trained.network.dim(),
            Weights::InverseDistance(function) => function.dim(),
        }
    }

    /// What points are normalised by.
    pub fn frame(&self) -> Frame {
        match self {
            Weights::Neural(trained) | Weights::ShapeAware(trained) => *trained.network.frame(),
            Weights::InverseDistance(function) => function.frame(),
        }
    }

    /// The logits of the points `x`, row by row: n x m.
    ///
    /// # Errors
    /// [`Error::Cancelled`], or where `x` does not hold finite points of the same dimension.
    pub fn logits(&self, x: &[f64], progress: &mut Progress<'_>) -> Result<Vec<f32>, Error> {
        match self {
            Weights::Neural(trained) | Weights::ShapeAware(trained) => trained.network.logits(x, progress),
            Weights::InverseDistance(function) => function.logits(x, progress),
        }
    }

    /// The logits of a tree's points in the order in which they were given, row by row: n x m. Those of inverse-distance weights are as exact
    /// as the tree's points, which are in single precision.
    ///
    /// # Errors
    /// [`Error::Cancelled`], or where the tree's points are of another dimension, or normalised by another frame than the network's.
    pub fn logits_of_tree(&self, tree: &PointTree, progress: &mut Progress<'_>) -> Result<Vec<f32>, Error> {
        match self {
            Weights::Neural(trained) | Weights::ShapeAware(trained) => {
                trained.network.logits_of_tree(tree, progress)
            }
            Weights::InverseDistance(function) => function.logits(&tree.given()?, progress),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_gives_the_logits_of_its_function() {
        let (p, x) = ([0.0, 0.0, 1.0, 0.0, 0.0, 1.0], [0.25, 0.5, 1.0, 1.0]);
        let training = Training { width: 16, ..Training::default() };
        let neural = Weights::neural(&p, 2, Frame::IDENTITY, &training, &mut |_| true).unwrap();
        let shape = Shape { x: &x, faces: &[] };
        let aware = Weights::shape_aware(&p, 2, Frame::IDENTITY, shape, 0, &mut |_| true).unwrap();
        let function = InverseDistance::new(&p, 2, Frame::IDENTITY, 1.0, 0.0).unwrap();
        let direct = function.logits(&x, &mut |_| true).unwrap();
        let distance = Weights::InverseDistance(function);
        assert_eq!(distance.logits(&x, &mut |_| true).unwrap(), direct);
        let tree = PointTree::new(&x, 2, Frame::IDENTITY, &mut |_| true).unwrap();
        assert_eq!(distance.logits_of_tree(&tree, &mut |_| true).unwrap(), direct);
        for (weights, kind) in [(&neural, "neural"), (&aware, "shape-aware"), (&distance, "inverse-distance")]
        {
            assert_eq!((weights.kind(), weights.control_points(), weights.dim()), (kind, &p[..], 2));
            assert_eq!(weights.frame(), Frame::IDENTITY);
            assert_eq!(weights.logits(&x, &mut |_| true).unwrap().len(), 6);
        }
        assert_ne!(neural.logits(&x, &mut |_| true), aware.logits(&x, &mut |_| true));
    }
}
