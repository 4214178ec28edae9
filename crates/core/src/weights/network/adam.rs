//! Adam, as `torch.optim.Adam` has it: Kingma, Ba, "Adam: a method for stochastic optimization", 2015.
//!
//! Moments are kept without their factors `1 - beta`, which belong to the rates of a step: three multiplications fewer a parameter.

use crate::machine::simd::{Lanes, WIDTH};

const BETA_1: f64 = 0.9;
pub(super) const BETA_2: f64 = 0.999;
/// Of a training in batches, whose gradients change. With less, networks come nearer to their labels, and bend more (docs/notes/shape-aware.md).
pub(super) const BETA_2_IN_BATCHES: f64 = 0.99;
const EPSILON: f32 = 1e-8;

/// Denormal numbers, near the smallest that there are, make a processor a hundred times slower, and a moment without further gradients
/// decays to them. Second moments are at least this: beside [`EPSILON`] its root is nothing.
const LEAST_SQUARE: f32 = 1e-30;
/// What is smaller is taken for 0: errors always, first moments now and then. It would not move a weight by its last digit.
pub(super) const DUST: f32 = 1e-20;
/// Steps between two times that first moments are dusted. Meanwhile they decay to no less than a thousandth.
const DUSTING: i32 = 64;

/// What one step does to every parameter.
#[derive(Clone, Copy)]
pub(super) struct Rates {
    /// `rate (1 - beta_1) / (1 - beta_1^t)`.
    rate: f32,
    /// `sqrt((1 - beta_2) / (1 - beta_2^t))`.
    correction: f32,
    /// How much of the second moments is kept.
    beta_2: f32,
    /// Whether first moments are dusted.
    dusting: bool,
}

impl Rates {
    /// Of the `step`-th step, counted from 1.
    pub(super) fn new(rate: f64, step: i32, beta_2: f64) -> Rates {
        Rates {
            rate: (rate * (1.0 - BETA_1) / (1.0 - BETA_1.powi(step))) as f32,
            correction: ((1.0 - beta_2) / (1.0 - beta_2.powi(step))).sqrt() as f32,
            beta_2: beta_2 as f32,
            dusting: step % DUSTING == 0,
        }
    }

    /// Moves sixteen parameters against their gradients. `first` and `second` are the gradients' running moments, over `1 - beta`.
    #[inline(always)]
    pub(super) fn descend<L: Lanes>(
        self,
        parameters: &mut [f32; WIDTH],
        first: &mut [f32; WIDTH],
        second: &mut [f32; WIDTH],
        gradients: L,
    ) {
        let mut m = L::splat(BETA_1 as f32).mul(L::load(first)).add(gradients);
        if self.dusting {
            m = L::select(m.abs().less(L::splat(DUST)), L::splat(0.0), m);
        }
        let v = gradients.mul(gradients).add(L::splat(self.beta_2).mul(L::load(second)));
        let v = v.max(L::splat(LEAST_SQUARE));
        let divisor = v.sqrt().mul(L::splat(self.correction)).add(L::splat(EPSILON));
        let parameter = L::load(parameters).sub(L::splat(self.rate).mul(m).div(divisor));
        (*first, *second, *parameters) = (m.store(), v.store(), parameter.store());
    }
}
