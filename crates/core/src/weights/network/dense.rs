//! The dense pass: all neurons at every point, as products of matrices. For Fourier features, of which layer 1 is not affine in x; and
//! for a few points.

use std::ops::Range;

use super::features;
use super::gemm::{multiply, View};
use super::parameters::{relu, Layer, Parameters};
use crate::error::Error;
use crate::geometry::{Order, PointTree};
use crate::machine::memory::zeros;
use crate::machine::parallel::{for_each_block, for_each_task, SharedRows};
use crate::machine::progress::{report, Progress};

/// Points evaluated at once by one thread: the activations of both hidden layers stay in its cache.
const BLOCK: usize = 128;
/// Points between two reports of progress.
const CHUNK: usize = 1 << 14;

/// The logits of the points `x`, row by row: n x m.
pub(super) fn logits(
    network: &Parameters,
    x: &[f64],
    progress: &mut Progress<'_>,
) -> Result<Vec<f32>, Error> {
    let (dim, m) = (network.dim, network.outputs());
    let mut logits = zeros(x.len() / dim * m)?;
    let chunks = logits.len().div_ceil(CHUNK * m).max(1);
    for (index, (x, logits)) in x.chunks(CHUNK * dim).zip(logits.chunks_mut(CHUNK * m)).enumerate() {
        report(progress, index as f64 / chunks as f64)?;
        for_each_block(logits, BLOCK * m, |block, logits| {
            let from = BLOCK * dim * block;
            let x = &x[from..from + logits.len() / m * dim];
            evaluate(network, network.features(x), logits);
        });
    }
    report(progress, 1.0)?;
    Ok(logits)
}

/// Writes the logits of the tree's points row by row, n x m, in their own order or in the tree's.
pub(super) fn write_logits(
    network: &Parameters,
    tree: &PointTree,
    order: Order,
    logits: &mut [f32],
    progress: &mut Progress<'_>,
) -> Result<(), Error> {
    let rows = SharedRows::new(logits, network.outputs());
    for_each_task(tree.len().div_ceil(BLOCK), 0.0..1.0, progress, |task, _| {
        let places = BLOCK * task..(BLOCK * (task + 1)).min(tree.len());
        // SAFETY: each task has its own places of the tree, no two of which have the same row.
        unsafe { evaluate_places(network, tree, order, places, &rows) }
    })
}

/// Evaluates the points at some places of the tree.
///
/// # Safety
/// Nobody else may use these points' rows meanwhile.
pub(super) unsafe fn evaluate_places(
    network: &Parameters,
    tree: &PointTree,
    order: Order,
    places: Range<usize>,
    rows: &SharedRows<'_>,
) {
    let (dim, m) = (network.dim, network.outputs());
    let mut input = Vec::new();
    for place in places.clone() {
        features::append(&tree.point(place)[..dim], &network.frequencies, &mut input);
    }
    let mut logits = vec![0.0; places.len() * m];
    evaluate(network, input, &mut logits);
    for (logits, row) in logits.chunks_exact(m).zip(order.rows(tree, places)) {
        // SAFETY: as the caller promises.
        unsafe { rows.row(row) }.copy_from_slice(logits);
    }
}

/// `input` is what the first layer sees.
fn evaluate(network: &Parameters, mut input: Vec<f32>, logits: &mut [f32]) {
    let points = logits.len() / network.outputs();
    let [hidden @ .., last] = &network.layers;
    for layer in hidden {
        let mut output = vec![0.0; points * layer.outputs()];
        linear(layer, &input, &mut output);
        relu(&mut output);
        input = output;
    }
    linear(last, &input, logits);
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
