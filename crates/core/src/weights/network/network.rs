//! The network and its evaluation.

use super::{dense, features, piecewise};
use crate::check::check_points;
use crate::error::Error;
use crate::geometry::Frame;
use crate::geometry::{Order, PointTree, LEAF};
use crate::machine::memory::{in_large_pages, zeros};
use crate::machine::progress::{report, Progress};
use crate::machine::simd::Simd;

/// One linear layer: `y = W x + b`.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// `W`, row by row: outputs x inputs.
    pub weight: Vec<f32>,
    /// `b`, one a row.
    pub bias: Vec<f32>,
}

impl Layer {
    /// Numbers that come out.
    pub fn outputs(&self) -> usize {
        self.bias.len()
    }

    /// Numbers that go in.
    pub fn inputs(&self) -> usize {
        self.weight.len() / self.bias.len()
    }
}

/// An MLP of three linear layers with ReLU between them, and the frame that its inputs are normalised by.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    pub(super) dim: usize,
    pub(super) frame: Frame,
    pub(super) frequencies: Vec<f32>,
    pub(super) layers: [Layer; 3],
    pub(super) prepared: piecewise::Prepared,
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
        check_points("network", &[], dim)?;
        let mut inputs = features::width(dim, &frequencies);
        let whole = frequencies.len().is_multiple_of(dim);
        for (index, layer) in layers.iter().enumerate() {
            if !whole || layer.bias.is_empty() || layer.weight.len() != layer.bias.len() * inputs {
                return Err(Error::argument(
                    "network",
                    format!(
                        "layer {} has {} weights and {} biases, which do not fit its {inputs} inputs",
                        index + 1,
                        layer.weight.len(),
                        layer.bias.len()
                    ),
                ));
            }
            inputs = layer.outputs();
        }
        let numbers = || layers.iter().flat_map(|l| l.weight.iter().chain(&l.bias)).chain(&frequencies);
        if numbers().any(|v| !v.is_finite()) {
            return Err(Error::argument("network", "a parameter is not finite"));
        }
        Ok(Network { dim, frame, frequencies, layers, prepared: piecewise::Prepared::default() })
    }

    /// The same network with logits `by` times as large.
    pub(crate) fn sharpened(mut self, by: f32) -> Network {
        let Layer { weight, bias } = &mut self.layers[2];
        weight.iter_mut().chain(bias).for_each(|parameter| *parameter *= by);
        Network { prepared: piecewise::Prepared::default(), ..self }
    }

    /// Coordinates a point.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// Control points, m.
    pub fn outputs(&self) -> usize {
        self.layers[2].outputs()
    }

    /// The frame that points are normalised by.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// `B` of the Fourier features, row by row; empty without them.
    pub fn frequencies(&self) -> &[f32] {
        &self.frequencies
    }

    /// The three linear layers.
    pub fn layers(&self) -> &[Layer; 3] {
        &self.layers
    }

    /// The logits of the points `x`, row by row: n x m.
    ///
    /// # Errors
    /// [`Error::Cancelled`], or where `x` does not hold finite points of the network's dimension.
    pub fn logits(&self, x: &[f64], progress: &mut Progress<'_>) -> Result<Vec<f32>, Error> {
        if !self.frequencies.is_empty() || x.len() <= LEAF * self.dim {
            check_points("x", x, self.dim)?;
            return dense::logits(self, x, progress);
        }
        let tree = PointTree::new(x, self.dim, self.frame, &mut |done| progress(0.5 * done))?;
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
        if tree.dim() != self.dim || *tree.frame() != self.frame {
            let message = "expected one in the dimension and the frame of the network, found another";
            return Err(Error::argument("tree", message));
        }
        let (n, m) = (tree.len(), self.outputs());
        if logits.len() != n * m {
            let message = format!("expected room for {n} x {m} numbers, found {}", logits.len());
            return Err(Error::argument("logits", message));
        }
        report(progress, 0.0)?;
        if self.frequencies.is_empty() {
            piecewise::write_logits(Simd::detect(), self, tree, order, logits, progress)?;
        } else {
            dense::write_logits(self, tree, order, logits, progress)?;
        }
        report(progress, 1.0)
    }

    /// What the first layer sees of `x`.
    pub(super) fn features(&self, x: &[f64]) -> Vec<f32> {
        let mut out = Vec::with_capacity(x.len() / self.dim * features::width(self.dim, &self.frequencies));
        for point in x.chunks_exact(self.dim) {
            let normalised = self.frame.enter_single(point);
            features::append(&normalised[..self.dim], &self.frequencies, &mut out);
        }
        out
    }
}

pub(super) fn relu(values: &mut [f32]) {
    for v in values {
        *v = v.max(0.0);
    }
}

#[cfg(test)]
pub(super) mod tests;
