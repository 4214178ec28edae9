//! The network and its evaluation.

use super::dense;
use super::parameters::{Layer, Parameters};
use super::piecewise::{self, Prepared};
use crate::check::check_points;
use crate::error::Error;
use crate::geometry::Frame;
use crate::geometry::{Order, PointTree, LEAF};
use crate::machine::memory::{in_large_pages, zeros};
use crate::machine::progress::{report, Progress};
use crate::machine::simd::Simd;

/// An MLP of three linear layers with ReLU between them, and the frame that its inputs are normalised by.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    pub(super) parameters: Parameters,
    pub(super) prepared: Prepared,
}

impl From<Parameters> for Network {
    fn from(parameters: Parameters) -> Network {
        Network { parameters, prepared: Prepared::default() }
    }
}

impl Network {
    /// A network of given parameters. `frequencies` is the `B` of its Fourier features (row by row, any number x d), or empty.
    ///
    /// # Errors
    /// Where the layers do not fit each other, or hold a number that is not finite.
    pub fn new(
        dim: usize,
        frame: Frame,
        frequencies: Vec<f32>,
        layers: [Layer; 3],
    ) -> Result<Network, Error> {
        Parameters::new(dim, frame, frequencies, layers).map(Network::from)
    }

    /// The same network with logits `by` times as large.
    pub(crate) fn sharpened(self, by: f32) -> Network {
        let mut parameters = self.parameters;
        let Layer { weight, bias } = &mut parameters.layers[2];
        weight.iter_mut().chain(bias).for_each(|parameter| *parameter *= by);
        Network::from(parameters)
    }

    /// Coordinates a point.
    pub fn dim(&self) -> usize {
        self.parameters.dim
    }

    /// Control points, m.
    pub fn outputs(&self) -> usize {
        self.parameters.outputs()
    }

    /// The frame that points are normalised by.
    pub fn frame(&self) -> &Frame {
        &self.parameters.frame
    }

    /// `B` of the Fourier features, row by row; empty without them.
    pub fn frequencies(&self) -> &[f32] {
        &self.parameters.frequencies
    }

    /// The three linear layers.
    pub fn layers(&self) -> &[Layer; 3] {
        &self.parameters.layers
    }

    /// The logits of the points `x`, row by row: n x m.
    ///
    /// # Errors
    /// [`Error::Cancelled`], or where `x` does not hold finite points of the network's dimension.
    pub fn logits(&self, x: &[f64], progress: &mut Progress<'_>) -> Result<Vec<f32>, Error> {
        if !self.parameters.frequencies.is_empty() || x.len() <= LEAF * self.parameters.dim {
            check_points("x", x, self.parameters.dim)?;
            return dense::logits(&self.parameters, x, progress);
        }
        let tree =
            PointTree::new(x, self.parameters.dim, self.parameters.frame, &mut |done| progress(0.5 * done))?;
        self.logits_of_tree(&tree, &mut |done| progress(0.5 + 0.5 * done))
    }

    /// The logits of a tree's points in the order in which they were given, row by row: n x m. For a shape that several networks
    /// are evaluated at.
    ///
    /// # Errors
    /// [`Error::Cancelled`], or where the tree's points are of another dimension or normalised by another frame than the
    /// network's.
    pub fn logits_of_tree(&self, tree: &PointTree, progress: &mut Progress<'_>) -> Result<Vec<f32>, Error> {
        let mut logits = zeros(tree.len() * self.outputs())?;
        in_large_pages(&mut logits);
        self.write_logits_of_tree(tree, Order::Given, &mut logits, progress)?;
        Ok(logits)
    }

    /// The same into memory that is there already, which for a million points takes less time than new memory; in the order in which
    /// the points were given, or that of the tree.
    ///
    /// # Errors
    /// As [`Network::logits_of_tree`], and where `logits` is not n x m.
    pub fn write_logits_of_tree(
        &self,
        tree: &PointTree,
        order: Order,
        logits: &mut [f32],
        progress: &mut Progress<'_>,
    ) -> Result<(), Error> {
        if tree.dim() != self.parameters.dim || *tree.frame() != self.parameters.frame {
            let message = "expected one in the dimension and the frame of the network, found another";
            return Err(Error::argument("tree", message));
        }
        let (n, m) = (tree.len(), self.outputs());
        if logits.len() != n * m {
            let message = format!("expected room for {n} x {m} numbers, found {}", logits.len());
            return Err(Error::argument("logits", message));
        }
        report(progress, 0.0)?;
        if self.parameters.frequencies.is_empty() {
            piecewise::write_logits(
                Simd::detect(),
                &self.parameters,
                &self.prepared,
                tree,
                order,
                logits,
                progress,
            )?;
        } else {
            dense::write_logits(&self.parameters, tree, order, logits, progress)?;
        }
        report(progress, 1.0)
    }

    /// The logits of the points `x`, and after those of each point their derivatives by its normalised coordinates: n x (1 + d) x m. At a kink
    /// those of a neuron that is off.
    ///
    /// # Errors
    /// As [`Network::logits`]; [`Error::Memory`].
    pub(crate) fn slopes(&self, x: &[f64], progress: &mut Progress<'_>) -> Result<Vec<f32>, Error> {
        let (dim, m) = (self.parameters.dim, self.outputs());
        let mut slopes = zeros(x.len() / dim * (1 + dim) * m)?;
        if !self.parameters.frequencies.is_empty() || x.len() <= LEAF * dim {
            check_points("x", x, dim)?;
            dense::write_slopes(&self.parameters, x, &mut slopes, progress)?;
        } else {
            let tree = PointTree::new(x, dim, self.parameters.frame, &mut |done| progress(0.3 * done))?;
            let progress = &mut |done| progress(0.3 + 0.7 * done);
            piecewise::write_slopes(&self.parameters, &self.prepared, &tree, &mut slopes, progress)?;
        }
        Ok(slopes)
    }
}

#[cfg(test)]
pub(super) mod tests;
