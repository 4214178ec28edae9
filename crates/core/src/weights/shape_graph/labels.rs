//! What a network is taught: samples of the shape, and the weights there.

use super::graph::links_of;
use super::near::Near;
use super::paths::reach;
use super::walks::first_met;
use super::{squared, Position};
use crate::check::check_points;
use crate::error::Error;
use crate::geometry::{placement, Frame};
use crate::machine::progress::{report, Progress};
use crate::softmax;
use crate::weights::network::{self, Samples, Schedule, Trained, Training};

/// Of what walks say.
const POWER: f64 = 2.5;
/// Logits below the largest by at most this are kept.
const KEPT: f64 = 8.0;
/// Lower ones fall as this times a logarithm: weights as a power, which a network can learn.
const TAIL: f64 = 4.0;
/// Of the straight-line distance, where no control point governs.
const EXPONENT: f64 = 6.0;
/// Of the spacing of the control points: how far along the shape one governs it.
const REACH: f64 = 0.75;
/// The network learns the weights to the power 1/2: what it gives is then sharpened as much.
const SOFTNESS: f32 = 2.0;
const SAMPLES: usize = 2048;
/// Nodes from which samples are chosen: every so many-th of more.
const CANDIDATES: usize = 8192;
/// Samples a step. With the width, and what Adam keeps, chosen on poses, chairs and airplanes (docs/notes/shape-aware.md).
const BATCH: usize = 64;
const WIDTH: usize = 192;
const STEPS: usize = 1000;
const RATE: f64 = 8e-3;
/// What is nearer to a control point along the shape than this part of the way to any other follows it.
const LAW: f64 = 0.5;
/// It is taught to have at least [`OWN`] of the weight a little farther, as the network does not learn it exactly.
const NEAR: f64 = 0.55;
/// Up to this part of the way, less and less.
const NEAR_END: f64 = 0.75;
const OWN: f64 = 0.8;
/// A distance: what is nearer is on the control point.
const LEAST: f64 = 1e-6;
/// Of walks: fewer are rounding.
const LEAST_SHARE: f64 = 1e-12;
/// Of the time of a fit: what goes before the training.
const BEFORE: f64 = 0.25;

/// A shape to learn from.
#[derive(Clone, Copy, Debug)]
pub struct Shape<'a> {
    /// Its points, n x dim.
    pub x: &'a [f64],
    /// Its triangles: any, of any quality, connected or not. Points without a triangle are linked to their nearest.
    pub faces: &'a [[u32; 3]],
}

/// What a shape says of its control points.
#[derive(Clone, Debug, PartialEq)]
pub struct Labels {
    /// Places spread over the shape, k x dim.
    pub x: Vec<f64>,
    /// The logits there, k x m; the largest of a place is 0.
    pub logits: Vec<f64>,
}

/// Trains a network on the control points `p` and the labels of `shape`.
///
/// # Errors
/// As [`labels`] and [`network::fit`].
pub(crate) fn fit(
    p: &[f64],
    dim: usize,
    frame: Frame,
    shape: Shape<'_>,
    seed: u64,
    progress: &mut Progress<'_>,
) -> Result<Trained, Error> {
    let (m, taught) = (p.len() / dim, taught(p, dim, frame, shape, &mut |done| progress(BEFORE * done))?);
    let Labels { x, logits } = taught.labels;
    let labels = softened(&logits, m);
    let samples = Samples { x: &x, labels: &labels, spread: taught.spread, batch: BATCH };
    let schedule = Schedule::Cosine(STEPS);
    let training = Training { width: WIDTH, schedule, rate: RATE, seed, fourier_sigma: None };
    let mut rest = |done: f64| progress(BEFORE + (1.0 - BEFORE) * done);
    let trained = network::fit(p, Some(samples), dim, frame, &training, &mut rest)?;
    let network = trained.network.sharpened(SOFTNESS);
    let missed = missed(&network, &x[..dim * taught.spread], &logits, m)?;
    Ok(Trained { network, missed, ..trained })
}

/// For each control point the part of the places at which it has by `logits` most of the weight, and by the network less than half as much.
fn missed(network: &network::Network, x: &[f64], logits: &[f64], m: usize) -> Result<Vec<f64>, Error> {
    let learned = network.logits(x, &mut |_| true)?;
    let count = learned.len() / m;
    let (mut taught, mut found, mut missed) = (vec![0.0; m], vec![0.0; m], vec![0.0; m]);
    for (logits, learned) in logits.chunks_exact(m).zip(learned.chunks_exact(m)) {
        let label = logits.iter().map(|logit| *logit as f32).collect::<Vec<_>>();
        softmax::weights(&label, 1.0, &mut taught);
        softmax::weights(learned, 1.0, &mut found);
        for i in (0..m).filter(|&i| taught[i] > 0.5 && found[i] < 0.5 * taught[i]) {
            missed[i] += 1.0 / count as f64;
        }
    }
    Ok(missed)
}

/// Places of a shape, and the logits of the control points `p` (m x dim) there.
///
/// # Errors
/// [`Error::Cancelled`], [`Error::Memory`]; where there are no finite points or control points, or a face names no point.
pub fn labels(
    p: &[f64],
    dim: usize,
    frame: Frame,
    shape: Shape<'_>,
    progress: &mut Progress<'_>,
) -> Result<Labels, Error> {
    let m = p.len() / dim.max(1);
    let Taught { labels: Labels { mut x, mut logits }, spread } = taught(p, dim, frame, shape, progress)?;
    x.truncate(dim * spread);
    logits.truncate(m * spread);
    Ok(Labels { x, logits })
}

/// What a network is taught: at the first places, which are spread over the shape, and then at all that follow a control point by the law.
struct Taught {
    labels: Labels,
    spread: usize,
}

fn taught(
    p: &[f64],
    dim: usize,
    frame: Frame,
    shape: Shape<'_>,
    progress: &mut Progress<'_>,
) -> Result<Taught, Error> {
    if check_points("control points", p, dim)? == 0 {
        return Err(Error::argument("control points", "expected at least one, found none"));
    }
    check_shape(shape, dim)?;
    report(progress, 0.0)?;
    let entered = |x: &[f64]| -> Vec<Position> { x.chunks_exact(dim).map(|x| inside(&frame, x)).collect() };
    let (p, x) = (entered(p), entered(shape.x));
    let links = links_of(&x, shape.faces);
    report(progress, 0.6)?;
    let near = Near::new(&links.nodes);
    let along = reach(&links, &near, &p);
    report(progress, 0.7)?;
    let met = first_met(&links, &near, &p, &along)?;
    report(progress, 0.9)?;
    let mut chosen = spread(&links.nodes, progress)?;
    let spread = chosen.len();
    chosen.extend((0..links.nodes.len()).filter(|&node| along.part_of_way(node) < LAW));

    let spacing = median(&along.apart);
    let (mut places, mut logits) = (Vec::new(), Vec::new());
    for node in chosen {
        let share = (REACH * spacing / along.far[node].max(LEAST)).min(1.0).powi(4);
        let of_node = &met[node * p.len()..][..p.len()];
        let mut of_node = logits_of(&links.nodes[node], &p, of_node, share);
        let own = OWN * ((NEAR_END - along.part_of_way(node)) / (NEAR_END - NEAR)).clamp(0.0, 1.0);
        follow(&mut of_node, along.nearest[node] as usize, own);
        logits.extend(tailed(&of_node));
        let x = &links.nodes[node];
        places.extend((0..dim).map(|k| x[k] * frame.half + frame.centre[k]));
    }
    report(progress, 1.0)?;
    Ok(Taught { labels: Labels { x: places, logits }, spread })
}

/// Refuses what is no shape.
pub(crate) fn check_shape(shape: Shape<'_>, dim: usize) -> Result<(), Error> {
    let n = check_points("x", shape.x, dim)?;
    if n == 0 {
        return Err(Error::argument("x", "expected at least one point, found none"));
    }
    if let Some(face) = shape.faces.iter().find(|face| face.iter().any(|&corner| corner as usize >= n)) {
        let found = face.map(|corner| corner.to_string()).join(", ");
        return Err(Error::argument("faces", format!("expected vertices 0 to {}, found ({found})", n - 1)));
    }
    Ok(())
}

fn inside(frame: &Frame, x: &[f64]) -> Position {
    let mut position = [0.0; 3];
    for (k, c) in x.iter().enumerate() {
        position[k] = (c - frame.centre[k]) / frame.half;
    }
    position
}

/// The logits of the control points `p` at the place `x`: of what walks say, a `share`; the rest is of the distance in space.
fn logits_of(x: &Position, p: &[Position], met: &[f64], share: f64) -> Vec<f64> {
    p.iter()
        .zip(met)
        .map(|(p, met)| {
            let straight = squared(x, p).sqrt().max(LEAST).ln();
            share * POWER * met.max(LEAST_SHARE).ln() - (1.0 - share) * EXPONENT * straight
        })
        .collect()
}

/// Raises the logit of `point` so that it has at least the weight `own`. Walks say nearly always more; where a soup misleads them, distances
/// have the last word.
fn follow(logits: &mut [f64], point: usize, own: f64) {
    let others = logits.iter().enumerate().filter(|(other, _)| *other != point).map(|(_, logit)| *logit);
    let most = others.clone().fold(f64::NEG_INFINITY, f64::max);
    if own > 0.0 && most > f64::NEG_INFINITY {
        let sum: f64 = others.map(|logit| (logit - most).exp()).sum();
        logits[point] = logits[point].max(most + (sum * own / (1.0 - own)).ln());
    }
}

/// Logits below the largest, which becomes 0; those far below it higher than they were.
fn tailed(logits: &[f64]) -> impl Iterator<Item = f64> + '_ {
    let most = logits.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    logits.iter().map(move |logit| {
        let below = most - logit;
        -below.min(KEPT) - TAIL * ((below - KEPT).max(0.0) / TAIL).ln_1p()
    })
}

/// Nodes spread evenly over the shape.
fn spread(nodes: &[Position], progress: &mut Progress<'_>) -> Result<Vec<usize>, Error> {
    let step = nodes.len().div_ceil(CANDIDATES);
    let few: Vec<f64> = nodes.iter().step_by(step).flatten().copied().collect();
    let mut told = |done: f64| progress(0.9 + 0.1 * done);
    Ok(placement::farthest_of(&few, 3, SAMPLES, &mut told)?.into_iter().map(|at| at * step).collect())
}

fn median(of: &[f64]) -> f64 {
    let mut sorted = of.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (low, high) = (sorted[(sorted.len() - 1) / 2], sorted[sorted.len() / 2]);
    if low == high {
        low
    } else {
        (low + high) / 2.0
    }
}

/// The weights at the temperature [`SOFTNESS`].
fn softened(logits: &[f64], m: usize) -> Vec<f32> {
    let mut labels = Vec::with_capacity(logits.len());
    for logits in logits.chunks_exact(m) {
        let most = logits.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let weights = logits.iter().map(|logit| ((logit - most) / f64::from(SOFTNESS)).exp());
        let sum: f64 = weights.clone().sum();
        labels.extend(weights.map(|weight| (weight / sum) as f32));
    }
    labels
}
