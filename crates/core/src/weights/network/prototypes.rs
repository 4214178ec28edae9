//! The output layer of many control points in closed form, from random hidden layers: prototypes, lifted until each owns its place.
//!
//! With `h(x)` what the hidden layers make of a place less its mean over the control points, and `h_j` that of control point j,
//!
//! ```text
//! logit_j(x) = a h . h_j - a |h_j|^2 / 2  =  -a |h - h_j|^2 / 2 + what does not depend on j
//! ```
//!
//! gives each place to the control points whose prototypes are nearest, as a mixture of Gaussians does. Random hidden layers keep distances up
//! to a factor (2.1 to 3.3, measured on 300 points of a figure), so that these are weights of space before any training. Where control points
//! are closer together than others, they share their places; each is lifted there by the smallest change of the output layer that changes
//! its logit at its own place by `t_j` and nothing at those of the others:
//!
//! ```text
//! logit_j(x) += t_j sum_i (K + ridge)^-1_ij (h_i . h(x) + 1),    K_ij = h_i . h_j + 1
//! ```
//!
//! Adam takes a thousand steps until the nearest two of hundreds are told apart.

use super::gemm;
use super::inverse::inverse;
use super::parameters::{relu, Layer, Parameters};
use crate::machine::parallel::for_each_block;

/// `a` times the square of the median distance of a prototype to its nearest (studies/many_points.py).
const SHARPNESS: f64 = 4.0;
/// The weight at their own places to which control points are lifted: a little more than is asked for, which rounding may take.
const LIFTED: f64 = 0.935;
/// Of the mean of K's diagonal.
const RIDGE: f64 = 1e-8;
/// What control points are lifted by changes the share of others: so many times at most.
const ROUNDS: usize = 12;

/// The output layer for `points`, two or more.
pub(super) fn output_layer(network: &Parameters, points: &[f64]) -> Layer {
    let [first, second, _] = &network.layers;
    let features = network.features(points);
    let (inputs, width) = (first.inputs(), second.outputs());
    let m = features.len() / inputs;
    let columns: Vec<f32> =
        (0..inputs).flat_map(|k| features.iter().skip(k).step_by(inputs).copied()).collect();
    let hidden = activations(second, &activations(first, &columns, m), m);
    let mean = |values: &[f32]| values.iter().map(|value| f64::from(*value)).sum::<f64>() / m as f64;
    let means: Vec<f64> = hidden.chunks_exact(m).map(mean).collect();
    // Control points x neurons.
    let mut prototypes = vec![0.0; m * width];
    for (neuron, values) in hidden.chunks_exact(m).enumerate() {
        for (prototype, value) in prototypes.iter_mut().skip(neuron).step_by(width).zip(values) {
            *prototype = f64::from(*value) - means[neuron];
        }
    }

    let mut kernel = vec![0.0; m * m];
    for_each_block(&mut kernel, m, |i, row| {
        for (values, mean) in hidden.chunks_exact(m).zip(&means) {
            let own = f64::from(values[i]) - mean;
            row.iter_mut().zip(values).for_each(|(k, value)| *k += own * (f64::from(*value) - mean));
        }
    });
    let squares: Vec<f64> = (0..m).map(|i| kernel[i * m + i]).collect();
    let distance = |i: usize, j: usize| squares[i] + squares[j] - 2.0 * kernel[i * m + j];
    let mut nearest: Vec<f64> = (0..m)
        .map(|i| (0..m).filter(|j| *j != i).map(|j| distance(i, j)).fold(f64::INFINITY, f64::min))
        .collect();
    nearest.sort_by(f64::total_cmp);
    let size = squares.iter().sum::<f64>() / m as f64;
    let sharpness = SHARPNESS / nearest[m / 2].max(1e-9 * size).max(f64::MIN_POSITIVE);
    let logits: Vec<f64> = (0..m * m).map(|at| -0.5 * sharpness * distance(at / m, at % m)).collect();

    let ridge = RIDGE * (size + 1.0);
    kernel.iter_mut().for_each(|k| *k += 1.0);
    (0..m).for_each(|i| kernel[i * m + i] += ridge);
    let inverse = inverse(kernel, m);
    let lifts = lifts(logits, &inverse, ridge);

    let mut layer = vec![0.0; m * (width + 1)];
    for_each_block(&mut layer, width + 1, |j, parameters| {
        let (bias, weights) = parameters.split_last_mut().expect("a bias");
        let own = &prototypes[j * width..][..width];
        weights.iter_mut().zip(own).for_each(|(weight, h)| *weight = sharpness * h);
        *bias = -0.5 * sharpness * squares[j];
        if lifts[j] > 0.0 {
            for (h, inverse) in prototypes.chunks_exact(width).zip(&inverse[j * m..]) {
                let share = lifts[j] * inverse;
                weights.iter_mut().zip(h).for_each(|(weight, h)| *weight += share * h);
                *bias += share;
            }
        }
        *bias -= weights.iter().zip(&means).map(|(weight, mean)| weight * mean).sum::<f64>();
    });
    let rows = || layer.chunks_exact(width + 1);
    Layer {
        weight: rows().flat_map(|row| row[..width].iter().map(|weight| *weight as f32)).collect(),
        bias: rows().map(|row| row[width] as f32).collect(),
    }
}

/// How much each control point's logit at its own place must rise, `logits` being those at the control points, row by row.
fn lifts(mut logits: Vec<f64>, inverse: &[f64], ridge: f64) -> Vec<f64> {
    let m = logits.len().isqrt();
    let mut lifts = vec![0.0; m];
    for _ in 0..ROUNDS {
        let missing: Vec<f64> = logits.chunks_exact(m).enumerate().map(missing).collect();
        if missing.iter().all(|missing| *missing == 0.0) {
            break;
        }
        for (i, row) in logits.chunks_exact_mut(m).enumerate() {
            row[i] += missing[i];
            let kept_back =
                missing.iter().zip(&inverse[i * m..]).map(|(missing, inverse)| ridge * missing * inverse);
            row.iter_mut().zip(kept_back).for_each(|(logit, back)| *logit -= back);
        }
        lifts.iter_mut().zip(&missing).for_each(|(lift, missing)| *lift += missing);
    }
    lifts
}

/// What control point i's logit at its own place is short of [`LIFTED`].
fn missing((i, logits): (usize, &[f64])) -> f64 {
    let others =
        logits.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, logit)| (logit - logits[i]).exp());
    ((LIFTED / (1.0 - LIFTED)).ln() + others.sum::<f64>().ln()).clamp(0.0, f64::MAX)
}

/// `relu(W input + b)`, outputs x m.
pub(super) fn activations(layer: &Layer, input: &[f32], m: usize) -> Vec<f32> {
    let mut values = vec![0.0; layer.outputs() * m];
    gemm::forward(layer, input, m, &mut values);
    relu(&mut values);
    values
}
