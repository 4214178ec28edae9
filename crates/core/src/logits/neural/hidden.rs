//! The middle layer, width x width: where nearly all the memory and time of a training step goes.
//!
//! With 1024 neurons its weights and their two moments are 12 MB, which no core's own cache holds. A step streams them once:
//!
//! ```text
//! for each row r of W:                      (8 rows at a time, 16 columns in lanes)
//!     g = sum_i error[r][i] input[i]        gradient, never stored
//!     Adam on W[r] with g
//!     z[r][i] = W[r] . next_input[i]        the next step's forward product, W[r] still in the cache
//! ```
//!
//! and once more, reading W alone, for `W^T error` before it, which the next input depends on. Rows without error that never
//! had any would not change, and are not touched.

use super::adam::Rates;
use super::network::Layer;
use crate::memory::filled;
use crate::parallel::{for_each_block, for_each_block_pair};
use crate::simd::{multiversion, Aligned, Lanes, Simd, WIDTH};

/// Rows that share the loads of the input.
const ROWS: usize = 8;
/// Rows that one thread takes at a time in a pass back: each group has a sum of its own.
const BACK: usize = 128;
/// Rows that one thread takes at a time in an update: their weights are still in its cache for the product.
const GROUP: usize = 32;

/// Activations of some neurons for every control point, `[neuron / 16][control point][16]`, neurons padded with zeros.
#[derive(Clone, Default)]
pub(super) struct Activations {
    lanes: Vec<Aligned>,
}

impl Activations {
    /// Of the `neurons` of `values`, which is neurons x m.
    pub(super) fn of(values: &[f32], m: usize, neurons: &[usize]) -> Activations {
        let mut lanes = vec![Aligned::ZERO; neurons.len().div_ceil(WIDTH) * m];
        for (at, neuron) in neurons.iter().enumerate() {
            for (i, value) in values[neuron * m..(neuron + 1) * m].iter().enumerate() {
                lanes[at / WIDTH * m + i].0[at % WIDTH] = *value;
            }
        }
        Activations { lanes }
    }
}

/// The layer's weights with Adam's moments. Of the inputs it has those only that fire for a control point: the others' weights
/// have no gradient and never change.
pub(super) struct Hidden {
    simd: Simd,
    /// `[row][weights, first moments, second moments][lanes]`: what an update streams lies in one stretch.
    state: Vec<Aligned>,
    inputs: Vec<usize>,
    /// Lanes of a row's weights: an odd number, so that rows do not lie a multiple of a memory page apart, where a processor
    /// takes a load of one for a load of what was just stored to another.
    row: usize,
    /// Whether a row ever had an error.
    awake: Vec<bool>,
}

impl Hidden {
    /// Of the layer's weights for some of its inputs.
    pub(super) fn new(layer: &Layer, inputs: Vec<usize>) -> Hidden {
        let (row, count) = (inputs.len().div_ceil(WIDTH) | 1, layer.inputs());
        let size = GROUP * 3 * row;
        let state = filled(Vec::new(), layer.outputs() * 3 * row, Aligned::ZERO, size, |group, state| {
            let weight = &layer.weight[GROUP * count * group..];
            for (weights, state) in weight.chunks_exact(count).zip(state.chunks_exact_mut(3 * row)) {
                for (lanes, inputs) in state.iter_mut().zip(inputs.chunks(WIDTH)) {
                    for (lane, input) in lanes.0.iter_mut().zip(inputs) {
                        *lane = weights[*input];
                    }
                }
            }
        });
        Hidden { simd: Simd::detect(), state, row, inputs, awake: vec![false; layer.outputs()] }
    }

    /// The inputs that it has weights for.
    pub(super) fn inputs(&self) -> &[usize] {
        &self.inputs
    }

    /// Writes the weights back.
    pub(super) fn store(&self, layer: &mut Layer) {
        let count = layer.inputs();
        for (weights, state) in
            layer.weight.chunks_exact_mut(count).zip(self.state.chunks_exact(3 * self.row))
        {
            for (lanes, inputs) in state.iter().zip(self.inputs.chunks(WIDTH)) {
                for (lane, input) in lanes.0.iter().zip(inputs) {
                    weights[*input] = *lane;
                }
            }
        }
    }

    /// `W input`: outputs x m.
    pub(super) fn forward(&self, input: &Activations, m: usize) -> Vec<f32> {
        let mut z = vec![0.0; self.awake.len() * m];
        let (simd, row) = (self.simd, self.row);
        for_each_block(&mut z, GROUP * m, |group, z| {
            product(simd, &self.state[GROUP * 3 * row * group..], row, &input.lanes, m, z);
        });
        z
    }

    /// `W^T error`, the gradient with respect to the inputs: inputs x m, for `error` outputs x m.
    pub(super) fn backward(&self, error: &[f32], m: usize) -> Vec<f32> {
        let (simd, row) = (self.simd, self.row);
        // A sum for each group of rows, added in their order: the same whichever thread did which.
        let size = self.inputs.len().div_ceil(WIDTH).max(1) * m;
        let mut sums = vec![Aligned::ZERO; self.awake.len().div_ceil(BACK) * size];
        for_each_block(&mut sums, size, |group, sum| {
            let error = &error[BACK * m * group..];
            let error = &error[..error.len().min(BACK * m)];
            transposed_product(simd, &self.state[BACK * 3 * row * group..], row, error, m, sum);
        });
        let (total, others) = sums.split_at_mut(size);
        for other in others.chunks_exact(size) {
            for (total, other) in total.iter_mut().zip(other) {
                total.0.iter_mut().zip(&other.0).for_each(|(total, other)| *total += other);
            }
        }
        let mut gradient = vec![0.0; self.inputs.len() * m];
        for (rows, total) in gradient.chunks_mut(WIDTH * m).zip(total.chunks_exact(m)) {
            for (lane, row) in rows.chunks_exact_mut(m).enumerate() {
                row.iter_mut().zip(total).for_each(|(to, total)| *to = total.0[lane]);
            }
        }
        gradient
    }

    /// Adam with the gradient `error input^T`, and `W next_input` with the new weights: outputs x m.
    pub(super) fn update_and_forward(
        &mut self,
        error: &[f32],
        input: &Activations,
        next_input: &Activations,
        m: usize,
        rates: Rates,
    ) -> Vec<f32> {
        let (simd, row) = (self.simd, self.row);
        for (awake, error) in self.awake.iter_mut().zip(error.chunks_exact(m)) {
            *awake |= error.iter().any(|e| *e != 0.0);
        }
        let mut z = vec![0.0; self.awake.len() * m];
        let awake = &self.awake;
        for_each_block_pair(&mut self.state, GROUP * 3 * row, &mut z, GROUP * m, |group, state, z| {
            let (first, count) = (GROUP * group, z.len() / m);
            let rows: Vec<usize> = (0..count).filter(|r| awake[first + r]).collect();
            update(simd, state, row, &rows, &error[first * m..(first + count) * m], &input.lanes, m, rates);
            product(simd, state, row, &next_input.lanes, m, z);
        });
        z
    }
}

multiversion! {
    fn update(
        state: &mut [Aligned], row: usize, rows: &[usize], error: &[f32], input: &[Aligned], m: usize, rates: Rates,
    ) = update_body
}

#[inline(always)]
fn update_body<L: Lanes>(
    state: &mut [Aligned],
    row: usize,
    rows: &[usize],
    error: &[f32],
    input: &[Aligned],
    m: usize,
    rates: Rates,
) {
    let mut errors = vec![[0.0; ROWS]; m];
    for rows in rows.chunks(ROWS) {
        // What a shorter last chunk leaves in the further errors gives gradients that nobody takes.
        for (r, at) in rows.iter().enumerate() {
            for (i, errors) in errors.iter_mut().enumerate() {
                errors[r] = error[at * m + i];
            }
        }
        for (c, input) in input.chunks_exact(m).enumerate() {
            let mut gradient = [L::splat(0.0); ROWS];
            for (x, e) in input.iter().zip(&errors) {
                let x = L::load(&x.0);
                for r in 0..ROWS {
                    gradient[r] = L::splat(e[r]).mul_add(x, gradient[r]);
                }
            }
            for (at, gradient) in rows.iter().zip(gradient) {
                let (weights, moments) = state[at * 3 * row..(at + 1) * 3 * row].split_at_mut(row);
                let (first, second) = moments.split_at_mut(row);
                rates.descend_lanes(&mut weights[c].0, &mut first[c].0, &mut second[c].0, gradient);
            }
        }
    }
}

multiversion! {
    fn product(state: &[Aligned], row: usize, input: &[Aligned], m: usize, z: &mut [f32]) = product_body
}

/// `z = W input`, 4 rows and some control points at a time: as many as there are registers for.
#[inline(always)]
fn product_body<L: Lanes>(state: &[Aligned], row: usize, input: &[Aligned], m: usize, z: &mut [f32]) {
    if L::REGISTERS >= 32 {
        product_of::<L, 5>(state, row, input, m, z);
    } else {
        product_of::<L, 4>(state, row, input, m, z);
    }
}

#[inline(always)]
fn product_of<L: Lanes, const POINTS: usize>(
    state: &[Aligned],
    row: usize,
    input: &[Aligned],
    m: usize,
    z: &mut [f32],
) {
    const TILE: usize = 4;
    let rows = z.len() / m;
    for r in (0..rows).step_by(TILE) {
        // A last, smaller tile repeats its last row and point: the same sum is written again.
        let tile_rows: [usize; TILE] = std::array::from_fn(|k| (r + k).min(rows - 1));
        let weight = tile_rows.map(|r| &state[r * 3 * row..][..row]);
        for i in (0..m).step_by(POINTS) {
            let points: [usize; POINTS] = std::array::from_fn(|k| (i + k).min(m - 1));
            let mut sums = [[L::splat(0.0); POINTS]; TILE];
            for (c, input) in input.chunks_exact(m).enumerate() {
                let mut x = [L::splat(0.0); POINTS];
                for i in 0..POINTS {
                    x[i] = L::load(&input[points[i]].0);
                }
                for k in 0..TILE {
                    let w = L::load(&weight[k][c].0);
                    for i in 0..POINTS {
                        sums[k][i] = w.mul_add(x[i], sums[k][i]);
                    }
                }
            }
            for k in 0..TILE {
                for i in 0..POINTS {
                    z[tile_rows[k] * m + points[i]] = sums[k][i].total();
                }
            }
        }
    }
}

multiversion! {
    fn transposed_product(state: &[Aligned], row: usize, error: &[f32], m: usize, sum: &mut [Aligned]) =
        transposed_product_body
}

/// `sum = W^T error` over the rows of one group.
#[inline(always)]
fn transposed_product_body<L: Lanes>(
    state: &[Aligned],
    row: usize,
    error: &[f32],
    m: usize,
    sum: &mut [Aligned],
) {
    let has_error = |r: &usize| error[r * m..(r + 1) * m].iter().any(|e| *e != 0.0);
    let rows: Vec<usize> = (0..error.len() / m).filter(has_error).collect();
    let mut errors = vec![[0.0; ROWS]; m];
    for rows in rows.chunks(ROWS) {
        for (i, errors) in errors.iter_mut().enumerate() {
            *errors = std::array::from_fn(|r| rows.get(r).map_or(0.0, |at| error[at * m + i]));
        }
        let weight: [&[Aligned]; ROWS] = std::array::from_fn(|r| {
            let at = rows.get(r).unwrap_or(&rows[0]);
            &state[at * 3 * row..][..row]
        });
        for (c, sum) in sum.chunks_exact_mut(m).enumerate() {
            let w: [L; ROWS] = std::array::from_fn(|r| L::load(&weight[r][c].0));
            for (sum, e) in sum.iter_mut().zip(&errors) {
                let mut total = L::load(&sum.0);
                for r in 0..ROWS {
                    total = L::splat(e[r]).mul_add(w[r], total);
                }
                *sum = Aligned(total.store());
            }
        }
    }
}

#[cfg(test)]
mod tests;
