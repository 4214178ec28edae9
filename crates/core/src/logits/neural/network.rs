//! The network and its evaluation.

use super::features;
use super::gemm::{multiply, View};
use crate::error::{check_points, Error};
use crate::frame::Frame;
use crate::parallel::for_each_block;
use crate::progress::{report, Progress};

/// Points evaluated at once by one thread: the activations of both hidden layers stay in its cache.
const BLOCK: usize = 128;
/// Points between two reports of progress.
const CHUNK: usize = 1 << 14;

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
        Ok(Network { dim, frame, frequencies, layers })
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
        check_points("x", x, self.dim)?;
        let (dim, m) = (self.dim, self.outputs());
        let mut logits = vec![0.0; x.len() / dim * m];
        let chunks = logits.len().div_ceil(CHUNK * m).max(1);
        for (index, (x, logits)) in x.chunks(CHUNK * dim).zip(logits.chunks_mut(CHUNK * m)).enumerate() {
            report(progress, index as f64 / chunks as f64)?;
            for_each_block(logits, BLOCK * m, |block, logits| {
                let from = BLOCK * dim * block;
                self.evaluate(&x[from..from + logits.len() / m * dim], logits);
            });
        }
        report(progress, 1.0)?;
        Ok(logits)
    }

    /// What the first layer sees of `x`.
    pub(super) fn features(&self, x: &[f64]) -> Vec<f32> {
        let mut out = Vec::with_capacity(x.len() / self.dim * features::width(self.dim, &self.frequencies));
        for point in x.chunks_exact(self.dim) {
            let normalised: [f32; 3] =
                std::array::from_fn(|k| if k < self.dim { self.normalised(point[k], k) } else { 0.0 });
            features::append(&normalised[..self.dim], &self.frequencies, &mut out);
        }
        out
    }

    fn normalised(&self, coordinate: f64, axis: usize) -> f32 {
        ((coordinate - self.frame.centre[axis]) / self.frame.half) as f32
    }

    fn evaluate(&self, x: &[f64], logits: &mut [f32]) {
        let mut input = self.features(x);
        let points = x.len() / self.dim;
        for layer in &self.layers[..2] {
            let mut output = vec![0.0; points * layer.outputs()];
            linear(layer, &input, &mut output);
            relu(&mut output);
            input = output;
        }
        linear(&self.layers[2], &input, logits);
    }
}

/// `output = input W^T + b`, one row a point.
fn linear(layer: &Layer, input: &[f32], output: &mut [f32]) {
    let (k, m) = (layer.inputs(), layer.outputs());
    for row in output.chunks_exact_mut(m) {
        row.copy_from_slice(&layer.bias);
    }
    let transposed = View { data: &layer.weight, row: 1, column: k };
    multiply(output.len() / m, k, m, View { data: input, row: k, column: 1 }, transposed, 1.0, output);
}

pub(super) fn relu(values: &mut [f32]) {
    for v in values {
        *v = v.max(0.0);
    }
}

#[cfg(test)]
mod tests;
