//! The parameters of a network.

use super::features;
use crate::check::check_points;
use crate::error::Error;
use crate::geometry::Frame;

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

/// What a network is.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Parameters {
    pub(super) dim: usize,
    pub(super) frame: Frame,
    /// `B` of the Fourier features, row by row, or nothing.
    pub(super) frequencies: Vec<f32>,
    pub(super) layers: [Layer; 3],
}

impl Parameters {
    /// # Errors
    /// Where the layers do not fit each other, or hold a number that is not finite.
    pub(super) fn new(
        dim: usize,
        frame: Frame,
        frequencies: Vec<f32>,
        layers: [Layer; 3],
    ) -> Result<Parameters, Error> {
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
        Ok(Parameters { dim, frame, frequencies, layers })
    }

    /// Control points, m.
    pub(super) fn outputs(&self) -> usize {
        self.layers[2].outputs()
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
