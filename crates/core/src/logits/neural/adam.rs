//! Adam, as `torch.optim.Adam` has it: Kingma, Ba, "Adam: a method for stochastic optimization", 2015.

use super::gemm::{multiply, View, ROWS};
use super::network::Layer;
use crate::parallel::for_each_block_pair;

const BETA_1: f64 = 0.9;
const BETA_2: f64 = 0.999;
const EPSILON: f32 = 1e-8;

/// First and second moment of one parameter's gradient.
type Moments = [f32; 2];

/// The optimiser's state for three layers.
pub(super) struct Adam {
    weights: [Vec<Moments>; 3],
    biases: [Vec<Moments>; 3],
    steps: i32,
    /// `rate / (1 - beta_1^t)`.
    rate: f32,
    /// `1 / sqrt(1 - beta_2^t)`.
    correction: f32,
}

impl Adam {
    pub(super) fn new(layers: &[Layer; 3]) -> Adam {
        let zeros = |count: fn(&Layer) -> usize| [0, 1, 2].map(|i: usize| vec![[0.0; 2]; count(&layers[i])]);
        Adam {
            weights: zeros(|l| l.weight.len()),
            biases: zeros(|l| l.bias.len()),
            steps: 0,
            rate: 0.0,
            correction: 0.0,
        }
    }

    pub(super) fn begin_step(&mut self, rate: f64) {
        self.steps += 1;
        self.rate = (rate / (1.0 - BETA_1.powi(self.steps))) as f32;
        self.correction = (1.0 / (1.0 - BETA_2.powi(self.steps)).sqrt()) as f32;
    }

    /// Updates one layer by the gradient `error input^T`; `error` is outputs x m, `input` inputs x m.
    pub(super) fn update(&mut self, index: usize, layer: &mut Layer, error: &[f32], input: &[f32], m: usize) {
        let k = layer.inputs();
        let (rate, correction) = (self.rate, self.correction);
        let moments = &mut self.weights[index];
        for_each_block_pair(&mut layer.weight, ROWS * k, moments, ROWS * k, |block, weights, moments| {
            let mut gradient = vec![0.0; weights.len()];
            let error = View { data: &error[ROWS * m * block..], row: m, column: 1 };
            let transposed = View { data: input, row: 1, column: m };
            multiply(weights.len() / k, m, k, error, transposed, 0.0, &mut gradient);
            descend(weights, moments, &gradient, rate, correction);
        });
        let gradient: Vec<f32> = error.chunks_exact(m).map(|row| row.iter().sum()).collect();
        descend(&mut layer.bias, &mut self.biases[index], &gradient, rate, correction);
    }
}

fn descend(parameters: &mut [f32], moments: &mut [Moments], gradient: &[f32], rate: f32, correction: f32) {
    // Rounded once: 1 - 0.999 computed in single precision is wrong by 1e-5.
    const B1: f32 = BETA_1 as f32;
    const B2: f32 = BETA_2 as f32;
    const REST_1: f32 = (1.0 - BETA_1) as f32;
    const REST_2: f32 = (1.0 - BETA_2) as f32;
    for ((parameter, [first, second]), g) in parameters.iter_mut().zip(moments).zip(gradient) {
        *first = B1 * *first + REST_1 * g;
        *second = B2 * *second + REST_2 * g * g;
        *parameter -= rate * *first / (second.sqrt() * correction + EPSILON);
    }
}
