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
use crate::parallel::for_each_block;
use crate::simd::{multiversion, Lanes, Simd, WIDTH};

/// Rows that share the loads of the input.
const ROWS: usize = 8;
/// Rows that one thread takes at a time.
const GROUP: usize = 128;

type Columns = [f32; WIDTH];

/// Activations of some neurons for every control point, `[neuron / 16][control point][16]`, neurons padded with zeros.
#[derive(Clone, Default)]
pub(super) struct Activations {
    lanes: Vec<Columns>,
}

impl Activations {
    /// From `values`, neurons x m.
    pub(super) fn of(values: &[f32], m: usize) -> Activations {
        let neurons = values.len() / m;
        let mut lanes = vec![[0.0; WIDTH]; neurons.div_ceil(WIDTH) * m];
        for (neuron, row) in values.chunks_exact(m).enumerate() {
            for (i, value) in row.iter().enumerate() {
                lanes[neuron / WIDTH * m + i][neuron % WIDTH] = *value;
            }
        }
        Activations { lanes }
    }

    /// Back to neurons x m.
    fn values(&self, neurons: usize, m: usize) -> Vec<f32> {
        (0..neurons * m).map(|at| self.lanes[at / m / WIDTH * m + at % m][at / m % WIDTH]).collect()
    }
}

/// The layer's weights with Adam's moments, rows padded to whole lanes.
pub(super) struct Hidden {
    simd: Simd,
    weight: Vec<Columns>,
    first: Vec<Columns>,
    second: Vec<Columns>,
    /// Lanes a row.
    row: usize,
    /// Whether a row ever had an error.
    awake: Vec<bool>,
}

impl Hidden {
    pub(super) fn new(layer: &Layer) -> Hidden {
        let row = layer.inputs().div_ceil(WIDTH);
        let mut weight = vec![[0.0; WIDTH]; layer.outputs() * row];
        for (weights, padded) in layer.weight.chunks_exact(layer.inputs()).zip(weight.chunks_exact_mut(row)) {
            padded.as_flattened_mut()[..weights.len()].copy_from_slice(weights);
        }
        let zeros = vec![[0.0; WIDTH]; weight.len()];
        let awake = vec![false; layer.outputs()];
        Hidden { simd: Simd::detect(), first: zeros.clone(), second: zeros, weight, row, awake }
    }

    /// Writes the weights back.
    pub(super) fn store(&self, layer: &mut Layer) {
        let inputs = layer.inputs();
        for (weights, padded) in layer.weight.chunks_exact_mut(inputs).zip(self.weight.chunks_exact(self.row))
        {
            weights.copy_from_slice(&padded.as_flattened()[..inputs]);
        }
    }

    /// `W input`: outputs x m.
    pub(super) fn forward(&self, input: &Activations, m: usize) -> Vec<f32> {
        let mut z = vec![0.0; self.awake.len() * m];
        let (simd, row) = (self.simd, self.row);
        for_each_block(&mut z, GROUP * m, |group, z| {
            let weight = &self.weight[GROUP * row * group..][..z.len() / m * row];
            product(simd, weight, row, &input.lanes, m, z);
        });
        z
    }

    /// `W^T error`, the gradient with respect to the input: `inputs` x m, for `error` outputs x m.
    pub(super) fn backward(&self, error: &[f32], inputs: usize, m: usize) -> Vec<f32> {
        let (simd, row) = (self.simd, self.row);
        // A sum for each group of rows, added in their order: the same whichever thread did which.
        let mut sums = vec![[0.0; WIDTH]; self.awake.len().div_ceil(GROUP) * row * m];
        for_each_block(&mut sums, row * m, |group, sum| {
            let error = &error[GROUP * m * group..];
            let error = &error[..error.len().min(GROUP * m)];
            transposed_product(simd, &self.weight[GROUP * row * group..], row, error, m, sum);
        });
        let (total, others) = sums.split_at_mut(row * m);
        for other in others.chunks_exact(row * m) {
            for (total, other) in total.as_flattened_mut().iter_mut().zip(other.as_flattened()) {
                *total += other;
            }
        }
        Activations { lanes: total.to_vec() }.values(inputs, m)
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
        struct Group<'a> {
            weight: &'a mut [Columns],
            first: &'a mut [Columns],
            second: &'a mut [Columns],
            rows: Vec<usize>,
            error: &'a [f32],
            z: &'a mut [f32],
        }
        let (simd, row) = (self.simd, self.row);
        for (awake, error) in self.awake.iter_mut().zip(error.chunks_exact(m)) {
            *awake |= error.iter().any(|e| *e != 0.0);
        }
        let mut z = vec![0.0; self.awake.len() * m];
        let mut groups: Vec<Group<'_>> = self
            .weight
            .chunks_mut(GROUP * row)
            .zip(self.first.chunks_mut(GROUP * row))
            .zip(self.second.chunks_mut(GROUP * row))
            .zip(self.awake.chunks(GROUP))
            .zip(error.chunks(GROUP * m))
            .zip(z.chunks_mut(GROUP * m))
            .map(|(((((weight, first), second), awake), error), z)| {
                let rows = (0..awake.len()).filter(|r| awake[*r]).collect();
                Group { weight, first, second, rows, error, z }
            })
            .collect();
        for_each_block(&mut groups, 1, |_, group| {
            let Group { weight, first, second, rows, error, z } = &mut group[0];
            update(simd, weight, first, second, row, rows, error, &input.lanes, m, rates);
            product(simd, weight, row, &next_input.lanes, m, z);
        });
        z
    }
}

multiversion! {
    fn update(
        weight: &mut [Columns], first: &mut [Columns], second: &mut [Columns], row: usize, rows: &[usize],
        error: &[f32], input: &[Columns], m: usize, rates: Rates,
    ) = update_body
}

#[inline(always)]
#[allow(clippy::too_many_arguments)]
fn update_body<L: Lanes>(
    weight: &mut [Columns],
    first: &mut [Columns],
    second: &mut [Columns],
    row: usize,
    rows: &[usize],
    error: &[f32],
    input: &[Columns],
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
                let x = L::load(x);
                for r in 0..ROWS {
                    gradient[r] = L::splat(e[r]).mul_add(x, gradient[r]);
                }
            }
            for (at, gradient) in rows.iter().zip(gradient) {
                let at = at * row + c;
                rates.descend_lanes(&mut weight[at], &mut first[at], &mut second[at], gradient);
            }
        }
    }
}

multiversion! {
    fn product(weight: &[Columns], row: usize, input: &[Columns], m: usize, z: &mut [f32]) = product_body
}

/// `z = W input`, 4 rows and 4 control points at a time.
#[inline(always)]
fn product_body<L: Lanes>(weight: &[Columns], row: usize, input: &[Columns], m: usize, z: &mut [f32]) {
    const TILE: usize = 4;
    let rows = z.len() / m;
    for r in (0..rows).step_by(TILE) {
        // A last, smaller tile repeats its last row and point: the same sum is written again.
        let tile_rows: [usize; TILE] = std::array::from_fn(|k| (r + k).min(rows - 1));
        let weight = tile_rows.map(|r| &weight[r * row..(r + 1) * row]);
        for i in (0..m).step_by(TILE) {
            let points: [usize; TILE] = std::array::from_fn(|k| (i + k).min(m - 1));
            let mut sums = [[L::splat(0.0); TILE]; TILE];
            for (c, input) in input.chunks_exact(m).take(row).enumerate() {
                let x = points.map(|i| L::load(&input[i]));
                for k in 0..TILE {
                    let w = L::load(&weight[k][c]);
                    for i in 0..TILE {
                        sums[k][i] = w.mul_add(x[i], sums[k][i]);
                    }
                }
            }
            for (r, sums) in tile_rows.iter().zip(sums) {
                for (i, sum) in points.iter().zip(sums) {
                    z[r * m + i] = sum.total();
                }
            }
        }
    }
}

multiversion! {
    fn transposed_product(weight: &[Columns], row: usize, error: &[f32], m: usize, sum: &mut [Columns]) =
        transposed_product_body
}

/// `sum = W^T error` over the rows of one group.
#[inline(always)]
fn transposed_product_body<L: Lanes>(
    weight: &[Columns],
    row: usize,
    error: &[f32],
    m: usize,
    sum: &mut [Columns],
) {
    let has_error = |r: &usize| error[r * m..(r + 1) * m].iter().any(|e| *e != 0.0);
    let rows: Vec<usize> = (0..error.len() / m).filter(has_error).collect();
    let mut errors = vec![[0.0; ROWS]; m];
    for rows in rows.chunks(ROWS) {
        for (i, errors) in errors.iter_mut().enumerate() {
            *errors = std::array::from_fn(|r| rows.get(r).map_or(0.0, |at| error[at * m + i]));
        }
        let weight: [&[Columns]; ROWS] = std::array::from_fn(|r| {
            let at = rows.get(r).unwrap_or(&rows[0]);
            &weight[at * row..(at + 1) * row]
        });
        for (c, sum) in sum.chunks_exact_mut(m).take(row).enumerate() {
            let w: [L; ROWS] = std::array::from_fn(|r| L::load(&weight[r][c]));
            for (sum, e) in sum.iter_mut().zip(&errors) {
                let mut total = L::load(sum);
                for r in 0..ROWS {
                    total = L::splat(e[r]).mul_add(w[r], total);
                }
                *sum = total.store();
            }
        }
    }
}

#[cfg(test)]
mod tests;
