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
/// The same of points and their derivatives, which are four rows a point.
const BLOCK_OF_SLOPES: usize = 32;
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

/// Writes the logits of the points `x`, and after those of each point their derivatives by its normalised coordinates: n x (1 + d) x m.
pub(super) fn write_slopes(
    network: &Parameters,
    x: &[f64],
    out: &mut [f32],
    progress: &mut Progress<'_>,
) -> Result<(), Error> {
    let (dim, width) = (network.dim, network.outputs() * (1 + network.dim));
    let chunks = out.len().div_ceil(CHUNK * width).max(1);
    for (index, (x, out)) in x.chunks(CHUNK * dim).zip(out.chunks_mut(CHUNK * width)).enumerate() {
        report(progress, index as f64 / chunks as f64)?;
        for_each_block(out, BLOCK_OF_SLOPES * width, |block, out| {
            let x = x[BLOCK_OF_SLOPES * dim * block..].chunks_exact(dim);
            let points: Vec<[f32; 3]> =
                x.take(out.len() / width).map(|x| network.frame.enter_single(x)).collect();
            differentiate(network, &points, out);
        });
    }
    report(progress, 1.0)
}

/// The same of the points at some places of the tree.
///
/// # Safety
/// Nobody else may use these points' rows meanwhile.
pub(super) unsafe fn differentiate_places(
    network: &Parameters,
    tree: &PointTree,
    places: Range<usize>,
    rows: &SharedRows<'_>,
) {
    let width = network.outputs() * (1 + network.dim);
    let points: Vec<[f32; 3]> = places.clone().map(|place| tree.point(place)).collect();
    let mut out = vec![0.0; points.len() * width];
    differentiate(network, &points, &mut out);
    for (out, row) in out.chunks_exact(width).zip(Order::Given.rows(tree, places)) {
        // SAFETY: as the caller promises.
        unsafe { rows.row(row) }.copy_from_slice(out);
    }
}

/// Forward mode: beside the points' neurons those of each coordinate's change, which ReLU lets through where the neuron is on.
fn differentiate(network: &Parameters, points: &[[f32; 3]], out: &mut [f32]) {
    let (n, dim, m) = (points.len(), network.dim, network.outputs());
    let (mut input, mut change) = (Vec::new(), Vec::new());
    points.iter().for_each(|x| features::append(&x[..dim], &network.frequencies, &mut input));
    for axis in 0..dim {
        points
            .iter()
            .for_each(|x| features::append_slopes(&x[..dim], &network.frequencies, axis, &mut change));
    }
    let [hidden @ .., last] = &network.layers;
    let apply = |layer: &Layer, input: &[f32], rows: usize, bias: bool| {
        let mut output = vec![0.0; rows * layer.outputs()];
        match bias {
            true => linear(layer, input, &mut output),
            false => matrix(layer, input, &mut output),
        }
        output
    };
    for layer in hidden {
        input = apply(layer, &input, n, true);
        change = apply(layer, &change, n * dim, false);
        for change in change.chunks_exact_mut(input.len()) {
            change.iter_mut().zip(&input).filter(|(_, z)| **z <= 0.0).for_each(|(change, _)| *change = 0.0);
        }
        relu(&mut input);
    }
    let (logits, slopes) = (apply(last, &input, n, true), apply(last, &change, n * dim, false));
    for (i, out) in out.chunks_exact_mut(m * (1 + dim)).enumerate() {
        let of_axis = (0..dim).map(|axis| &slopes[m * (n * axis + i)..][..m]);
        let parts = [&logits[m * i..][..m]].into_iter().chain(of_axis);
        out.chunks_exact_mut(m).zip(parts).for_each(|(out, part)| out.copy_from_slice(part));
    }
}

/// `output = input W^T + b`, one row a point.
fn linear(layer: &Layer, input: &[f32], output: &mut [f32]) {
    output.chunks_exact_mut(layer.outputs()).for_each(|row| row.copy_from_slice(&layer.bias));
    matrix(layer, input, output);
}

/// `output += input W^T`.
fn matrix(layer: &Layer, input: &[f32], output: &mut [f32]) {
    let (k, m) = (layer.inputs(), layer.outputs());
    let transposed = View { data: &layer.weight, row: 1, column: k };
    multiply(output.len() / m, k, m, View { data: input, row: k, column: 1 }, transposed, 1.0, output);
}
