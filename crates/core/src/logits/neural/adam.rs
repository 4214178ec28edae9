//! Adam, as `torch.optim.Adam` has it: Kingma, Ba, "Adam: a method for stochastic optimization", 2015.

use super::gemm::{multiply, View};
use crate::simd::{Lanes, WIDTH};

const BETA_1: f64 = 0.9;
const BETA_2: f64 = 0.999;
const EPSILON: f32 = 1e-8;

// Rounded once: 1 - 0.999 computed in single precision is wrong by 1e-5.
const B1: f32 = BETA_1 as f32;
const B2: f32 = BETA_2 as f32;
const REST_1: f32 = (1.0 - BETA_1) as f32;
const REST_2: f32 = (1.0 - BETA_2) as f32;

/// What one step does to every parameter.
#[derive(Clone, Copy)]
pub(super) struct Rates {
    /// `rate / (1 - beta_1^t)`.
    rate: f32,
    /// `1 / sqrt(1 - beta_2^t)`.
    correction: f32,
}

impl Rates {
    /// Of the `step`-th step, counted from 1.
    pub(super) fn new(rate: f64, step: i32) -> Rates {
        Rates {
            rate: (rate / (1.0 - BETA_1.powi(step))) as f32,
            correction: (1.0 / (1.0 - BETA_2.powi(step)).sqrt()) as f32,
        }
    }

    /// Moves sixteen parameters against their gradients. `first` and `second` are the gradients' running moments.
    #[inline(always)]
    pub(super) fn descend_lanes<L: Lanes>(
        self,
        parameters: &mut [f32; WIDTH],
        first: &mut [f32; WIDTH],
        second: &mut [f32; WIDTH],
        gradients: L,
    ) {
        let m = L::splat(B1).mul(L::load(first)).add(L::splat(REST_1).mul(gradients));
        let v = L::splat(B2).mul(L::load(second)).add(L::splat(REST_2).mul(gradients).mul(gradients));
        // A root and a quotient by Newton's method from estimates: exact ones take longer than all the rest.
        let positive = v.max(L::splat(f32::MIN_POSITIVE));
        let root = positive.mul(positive.inverse_sqrt());
        let divisor = root.mul_add(L::splat(self.correction), L::splat(EPSILON));
        let step = L::splat(self.rate).mul(m).mul(divisor.inverse());
        (*first, *second) = (m.store(), v.store());
        *parameters = L::load(parameters).sub(step).store();
    }

    /// The same for any number of them.
    fn descend(self, parameters: &mut [f32], first: &mut [f32], second: &mut [f32], gradients: &[f32]) {
        for (((p, m), v), g) in parameters.iter_mut().zip(first).zip(second).zip(gradients) {
            *m = B1 * *m + REST_1 * g;
            *v = B2 * *v + REST_2 * g * g;
            *p -= self.rate * *m / (v.sqrt() * self.correction + EPSILON);
        }
    }
}

/// The optimiser's state for some parameters.
pub(super) struct Adam {
    first: Vec<f32>,
    second: Vec<f32>,
}

impl Adam {
    pub(super) fn new(parameters: &[f32]) -> Adam {
        Adam { first: vec![0.0; parameters.len()], second: vec![0.0; parameters.len()] }
    }

    /// Updates weights by the gradient `error input^T`; `error` is outputs x m, `input` inputs x m.
    pub(super) fn update_weights(
        &mut self,
        weights: &mut [f32],
        error: &[f32],
        input: &[f32],
        m: usize,
        rates: Rates,
    ) {
        let (outputs, inputs) = (error.len() / m, input.len() / m);
        let mut gradient = vec![0.0; weights.len()];
        let error = View { data: error, row: m, column: 1 };
        multiply(outputs, m, inputs, error, View { data: input, row: 1, column: m }, 0.0, &mut gradient);
        rates.descend(weights, &mut self.first, &mut self.second, &gradient);
    }

    /// Updates biases by the gradient that `error`, outputs x m, is.
    pub(super) fn update_biases(&mut self, biases: &mut [f32], error: &[f32], m: usize, rates: Rates) {
        let gradient: Vec<f32> = error.chunks_exact(m).map(|row| row.iter().sum()).collect();
        rates.descend(biases, &mut self.first, &mut self.second, &gradient);
    }
}
