//! A linear layer in training. The middle one, width x width, is where nearly all the memory and time of a step goes.
//!
//! With 1024 neurons its weights and their two moments are 12 MB, which no core's own cache holds. A step streams them once:
//!
//! ```text
//! for each group of 32 rows of W:           (16 columns in lanes)
//!     g = sum_i error[r][i] input[i]        gradient, never stored
//!     Adam on W[r] with g
//!     z[r][i] = W[r] . next_input[i]        the next step's forward product, W[r] still in the cache
//! ```
//!
//! and once more, reading W alone, for `W^T error` before it, which the next input depends on. Rows without error that never
//! had any would not change, and are not touched. A bias is the weight of an input that is always 1.

use super::activations::Activations;
use super::adam::Rates;
use super::parameters::Layer;
use crate::machine::memory::filled;
use crate::machine::parallel::{for_each_block, for_each_block_pair};
use crate::machine::simd::{Aligned, Simd, WIDTH};

mod kernels;
use kernels::{product, transposed_product, update};

/// Rows that share the loads of the input.
const ROWS: usize = 8;
/// Rows that are updated before their product is computed: their weights are still in the thread's cache.
const GROUP: usize = 32;
/// Lanes of columns that a thread takes at a time in a product with the transposed weights: their sums stay in its cache.
const COLUMNS: usize = 4;
/// Multiplications a task: fewer are done before another thread has begun.
const WORK: usize = 1 << 18;

/// A layer's weights and biases with Adam's moments, of some of its inputs and of its rows in some order. Inputs that never fire
/// are left out: their weights have no gradient and never change.
pub(super) struct Linear {
    simd: Simd,
    /// For each group of rows its weights, `[lanes of columns][row]`, and then its moments, `[lanes of columns][row / 8][first,
    /// second][row % 8]`, in the order in which they are streamed. Rows are padded to a multiple of 8.
    state: Vec<Aligned>,
    inputs: Vec<usize>,
    rows: Vec<usize>,
    /// Lanes of columns, the bias among them.
    lanes: usize,
    /// Whether any of eight rows ever had an error.
    awake: Vec<bool>,
    /// Whether negative outputs become 0.
    rectified: bool,
}

impl Linear {
    /// Of the layer's weights for some of its inputs, with its rows in the order of `rows`.
    pub(super) fn new(layer: &Layer, inputs: Vec<usize>, rows: Vec<usize>, rectified: bool) -> Linear {
        let (lanes, count) = ((inputs.len() + 1).div_ceil(WIDTH), layer.inputs());
        let blocks = rows.len().div_ceil(ROWS);
        let size = GROUP * 3 * lanes;
        let state = filled(Vec::new(), blocks * ROWS * 3 * lanes, Aligned::ZERO, size, |group, state| {
            let padded = state.len() / (3 * lanes);
            for (r, row) in rows.iter().skip(GROUP * group).take(GROUP).enumerate() {
                let weights = &layer.weight[row * count..(row + 1) * count];
                for (inputs, lanes) in inputs.chunks(WIDTH).zip(state[r..].iter_mut().step_by(padded)) {
                    inputs.iter().zip(&mut lanes.0).for_each(|(input, lane)| *lane = weights[*input]);
                }
                state[inputs.len() / WIDTH * padded + r].0[inputs.len() % WIDTH] = layer.bias[*row];
            }
        });
        Linear { simd: Simd::detect(), state, inputs, rows, lanes, awake: vec![false; blocks], rectified }
    }

    /// Writes the weights back.
    pub(super) fn store(&self, layer: &mut Layer) {
        let (inputs, lanes, count) = (&self.inputs, self.lanes, layer.inputs());
        for (rows, state) in self.rows.chunks(GROUP).zip(self.state.chunks(GROUP * 3 * lanes)) {
            let padded = state.len() / (3 * lanes);
            for (r, row) in rows.iter().enumerate() {
                let weights = &mut layer.weight[row * count..(row + 1) * count];
                for (inputs, lanes) in inputs.chunks(WIDTH).zip(state[r..].iter().step_by(padded)) {
                    inputs.iter().zip(&lanes.0).for_each(|(input, lane)| weights[*input] = *lane);
                }
                layer.bias[*row] = state[inputs.len() / WIDTH * padded + r].0[inputs.len() % WIDTH];
            }
        }
    }

    /// `W input + b` for every point, where it is rectified at least 0; and a neuron that is always 1.
    pub(super) fn forward(&self, input: &Activations) -> Activations {
        let m = input.points;
        let mut z = Activations::zeros(self.rows.len(), m);
        let (size, groups) = (GROUP * 3 * self.lanes, self.groups(m));
        for_each_block(&mut z.lanes, groups * GROUP / WIDTH * m, |task, z| {
            let state = self.state[size * groups * task..].chunks(size);
            for (state, z) in state.zip(z.chunks_mut(GROUP / WIDTH * m)) {
                group_product(self.simd, state, self.lanes, input, self.rectified, z);
            }
        });
        z.push_one(self.rows.len());
        z
    }

    /// Groups of rows that are one task.
    fn groups(&self, m: usize) -> usize {
        (WORK / (GROUP * self.lanes * WIDTH * (m + ROWS))).max(1)
    }

    /// `W^T error`, the gradient with respect to the inputs, where `input` is above 0.
    pub(super) fn backward(&self, error: &Activations, input: &Activations) -> Activations {
        let m = error.points;
        let mut sums = Activations::zeros(WIDTH * self.lanes, m);
        let columns = (WORK / (self.rows.len() * WIDTH * m)).max(COLUMNS);
        let with_error: Vec<bool> = (0..self.awake.len()).map(|block| has_error(error, block)).collect();
        for_each_block(&mut sums.lanes, columns * m, |task, sums| {
            let (first, input) = (columns * task, &input.lanes[columns * task * m..]);
            transposed_product(self.simd, &self.state, self.lanes, first, &with_error, error, input, sums);
        });
        // The bias's input is no neuron.
        sums.row_mut(self.inputs.len(), |sum| *sum = 0.0);
        sums
    }

    /// Adam with the gradient `error input^T`, and [`Linear::forward`] of the next input with the new weights.
    pub(super) fn update_and_forward(
        &mut self,
        error: &Activations,
        input: &Activations,
        next_input: &Activations,
        rates: Rates,
    ) -> Activations {
        let m = error.points;
        for (block, awake) in self.awake.iter_mut().enumerate() {
            *awake |= has_error(error, block);
        }
        let mut z = Activations::zeros(self.rows.len(), next_input.points);
        let (size, groups) = (GROUP * 3 * self.lanes, self.groups(m));
        let (simd, lanes, rectified, awake) = (self.simd, self.lanes, self.rectified, &self.awake);
        let (in_group, in_next) = (GROUP / WIDTH * m, GROUP / WIDTH * next_input.points);
        for_each_block_pair(
            &mut self.state,
            groups * size,
            &mut z.lanes,
            groups * in_next,
            |task, state, z| {
                for (k, (state, z)) in state.chunks_mut(size).zip(z.chunks_mut(in_next)).enumerate() {
                    let group = groups * task + k;
                    let error = &error.lanes[in_group * group..];
                    let awake = awake[GROUP / ROWS * group..].iter().take(GROUP / ROWS);
                    let blocks: Vec<usize> =
                        awake.enumerate().filter_map(|(b, awake)| awake.then_some(b)).collect();
                    update(simd, state, lanes, &blocks, error, &input.lanes, m, rates);
                    group_product(simd, state, lanes, next_input, rectified, z);
                }
            },
        );
        z.push_one(self.rows.len());
        z
    }
}

/// Whether any of eight rows has an error.
fn has_error(error: &Activations, block: usize) -> bool {
    let (m, half) = (error.points, block % (WIDTH / ROWS) * ROWS);
    let lanes = &error.lanes[block / (WIDTH / ROWS) * m..][..m];
    lanes.iter().any(|lanes| lanes.0[half..half + ROWS].iter().any(|e| *e != 0.0))
}

/// The outputs of a group of rows.
fn group_product(
    simd: Simd,
    state: &[Aligned],
    lanes: usize,
    input: &Activations,
    rectified: bool,
    z: &mut [Aligned],
) {
    product(simd, &state[..state.len() / 3], lanes, &input.lanes, input.points, z);
    if rectified {
        z.iter_mut().for_each(|z| z.0.iter_mut().for_each(|z| *z = z.max(0.0)));
    }
}

#[cfg(test)]
mod tests;
