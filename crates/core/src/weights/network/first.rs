//! The first layer in training: of few inputs, so that its neurons are in lanes.

use super::activations::Activations;
use super::adam::Rates;
use super::parameters::Layer;
use crate::machine::parallel::for_each_block;
use crate::machine::simd::{multiversion, Aligned, Lanes, Simd, WIDTH};

/// Multiplications a task: fewer are done before another thread has begun.
const WORK: usize = 1 << 18;
/// Parameters of a neuron that share the loads of its errors.
const TILE: usize = 4;

/// Those of the layer's neurons that fire, with Adam's moments, and ReLU.
pub(super) struct First {
    simd: Simd,
    /// For each 16 neurons, `[input, and at last the bias][parameter, first moment, second moment]`.
    state: Vec<[Aligned; 3]>,
    neurons: Vec<usize>,
    inputs: usize,
}

impl First {
    pub(super) fn new(layer: &Layer, neurons: Vec<usize>) -> First {
        let inputs = layer.inputs();
        let mut state = vec![[Aligned::ZERO; 3]; neurons.len().div_ceil(WIDTH) * (inputs + 1)];
        for (at, neuron) in neurons.iter().enumerate() {
            let weights = &layer.weight[neuron * inputs..(neuron + 1) * inputs];
            let state = &mut state[at / WIDTH * (inputs + 1)..];
            for (state, value) in state.iter_mut().zip(weights.iter().chain([&layer.bias[*neuron]])) {
                state[0].0[at % WIDTH] = *value;
            }
        }
        First { simd: Simd::detect(), state, neurons, inputs }
    }

    /// Writes the weights and biases back.
    pub(super) fn store(&self, layer: &mut Layer) {
        let inputs = self.inputs;
        for (at, neuron) in self.neurons.iter().enumerate() {
            let state = &self.state[at / WIDTH * (inputs + 1)..][..inputs + 1];
            let values = layer.weight[neuron * inputs..].iter_mut().take(inputs);
            let values = values.chain([&mut layer.bias[*neuron]]);
            values.zip(state).for_each(|(value, state)| *value = state[0].0[at % WIDTH]);
        }
    }

    /// `relu(W input + b)` for m points, whose features `input` has point by point; and a neuron that is always 1.
    pub(super) fn forward(&self, input: &[f32], m: usize) -> Activations {
        let mut out = Activations::zeros(self.neurons.len(), m);
        let (count, neurons) = (self.inputs + 1, self.lanes_a_task(m));
        for_each_block(&mut out.lanes, neurons * m, |task, out| {
            forward(self.simd, &self.state[neurons * task * count..], input, m, out);
        });
        out.push_one(self.neurons.len());
        out
    }

    /// Adam with the gradient `error input^T`.
    pub(super) fn update(&mut self, error: &Activations, input: &[f32], rates: Rates) {
        let (count, m) = (self.inputs + 1, error.points);
        let (simd, neurons) = (self.simd, self.lanes_a_task(m));
        for_each_block(&mut self.state, neurons * count, |task, state| {
            update(simd, state, count, &error.lanes[neurons * task * m..], input, m, rates);
        });
    }

    fn lanes_a_task(&self, m: usize) -> usize {
        (WORK / ((self.inputs + 1) * m * WIDTH)).max(1)
    }
}

multiversion! {
    fn forward(state: &[[Aligned; 3]], input: &[f32], m: usize, out: &mut [Aligned]) = forward_body
}

#[inline(always)]
fn forward_body<L: Lanes>(state: &[[Aligned; 3]], input: &[f32], m: usize, out: &mut [Aligned]) {
    let inputs = input.len() / m;
    for (state, out) in state.chunks_exact(inputs + 1).zip(out.chunks_exact_mut(m)) {
        let (bias, weights) = state.split_last().expect("a bias");
        for (out, x) in out.iter_mut().zip(input.chunks_exact(inputs)) {
            let mut z = L::load(&bias[0].0);
            for (weight, x) in weights.iter().zip(x) {
                z = L::load(&weight[0].0).mul(L::splat(*x)).add(z);
            }
            *out = Aligned(z.max(L::splat(0.0)).store());
        }
    }
}

multiversion! {
    fn update(
        state: &mut [[Aligned; 3]], count: usize, error: &[Aligned], input: &[f32], m: usize, rates: Rates,
    ) = update_body
}

#[inline(always)]
fn update_body<L: Lanes>(
    state: &mut [[Aligned; 3]],
    count: usize,
    error: &[Aligned],
    input: &[f32],
    m: usize,
    rates: Rates,
) {
    for (state, error) in state.chunks_exact_mut(count).zip(error.chunks_exact(m)) {
        for (tile, state) in state.chunks_mut(TILE).enumerate() {
            let mut gradient = [L::splat(0.0); TILE];
            for (i, error) in error.iter().enumerate() {
                let error = L::load(&error.0);
                let x = &input[i * (count - 1)..(i + 1) * (count - 1)];
                for (k, gradient) in gradient.iter_mut().enumerate() {
                    // The bias is the weight of an input that is always 1.
                    let x = x.get(TILE * tile + k).copied().unwrap_or(1.0);
                    *gradient = L::splat(x).mul(error).add(*gradient);
                }
            }
            for ([weights, first, second], gradient) in state.iter_mut().zip(gradient) {
                rates.descend(&mut weights.0, &mut first.0, &mut second.0, gradient);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::adam::BETA_2;
    use super::*;

    #[test]
    fn every_instruction_set_gives_the_same_bits() {
        let numbers = |count: usize, seed: f32| -> Vec<f32> {
            (0..count).map(|i| (i as f32 * 0.7 + seed).sin()).collect()
        };
        let (inputs, outputs, m) = (3, 45, 11);
        let layer = Layer { weight: numbers(inputs * outputs, 0.3), bias: numbers(outputs, 5.0) };
        let input = numbers(inputs * m, 1.0);
        let trained = |simd: Simd| {
            let mut first = First { simd, ..First::new(&layer, (0..outputs).collect()) };
            let error = first.forward(&input, m);
            first.update(&error, &input, Rates::new(1e-2, 3, BETA_2));
            let lanes = |values: &Activations| -> Vec<u32> {
                values.lanes.iter().flat_map(|lanes| lanes.0.map(f32::to_bits)).collect()
            };
            (lanes(&error), lanes(&first.forward(&input, m)))
        };
        let all: Vec<_> = Simd::all().map(trained).collect();
        all.iter().for_each(|of_one| assert_eq!(*of_one, all[0]));
    }
}
