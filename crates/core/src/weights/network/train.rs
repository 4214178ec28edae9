//! Training: control point i is to be given the class i, and samples of a shape, where there are any, the labels that they have.
//!
//! Full-batch cross-entropy, Adam (Kingma, Ba 2015, as in `torch.optim.Adam`), rate 6e-4, and a tenth of it for the last fifth of the steps.
//! Where it differs from the published code: by default it does not stop after a fixed 48 steps but when every control point has most
//! of the weight at its own place, because handles that do not own their place do not arrive at their targets. Many control points begin
//! at an output layer in closed form ([`prototypes`]), with random hidden layers, which is mostly enough.
//!
//! Training multiplies rounding: what differs by 1e-7 at first is up to 1e-2 of the box after a thousand steps at a large rate. So its kernels do
//! without fused multiply-adds and estimates, which not every processor has, or has alike: a seed gives the same network, bit for bit, on all of
//! them, and in the browser.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use super::features;
use super::mlp::Network;
use super::parameters::{Layer, Parameters};
use super::prototypes;
use super::samples::{lexicographic_order, sorted, Lessons, Samples};
use crate::check::{check_number, check_points};
use crate::error::Error;
use crate::geometry::Frame;
use crate::machine::parallel::on_a_working_thread;
use crate::machine::progress::{report, Progress};
use crate::machine::random::Random;

mod trainer;
use trainer::{Losses, Trainer};

/// A control point owns its place when its cross-entropy there is at most this: 0.9 of the weight.
const SMALL_LOSS: f64 = 0.105;
/// From so many control points on, the default training begins at an output layer in closed form (studies/many_points.py).
const MANY: usize = 64;
/// When a training in batches looks again for what it has not learned, in eighths of it.
const LOOKS: [usize; 3] = [4, 6, 7];
/// How much faster neurons that begin at samples change than others.
const GAIN: f32 = 4.0;
/// Most control points: beyond, every layer of the paper's network is too small for them.
pub const MOST_CONTROL_POINTS: usize = 1000;

/// How many steps to train.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Schedule {
    /// At the full rate until every control point has 0.9 of the weight at its own place, then a quarter as many steps
    /// at a tenth of it; at most so many in all. 64 control points or more mostly have as much before the first step,
    /// by the output layer that they begin with.
    UntilSmall {
        /// The most steps.
        at_most: usize,
    },
    /// Exactly so many, the last fifth of them at a tenth of the rate: 48 in the published code, of which the paper says nothing.
    Fixed(usize),
    /// Exactly so many, the rate falling to 0 as half a cosine does.
    Cosine(usize),
}

/// How to make and train a network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Training {
    /// Neurons in each of the two hidden layers: 1024 in the paper, 128 in its published code.
    pub width: usize,
    /// When to stop.
    pub schedule: Schedule,
    /// Adam's learning rate.
    pub rate: f64,
    /// Where the random numbers start.
    pub seed: u64,
    /// The deviation of random Fourier features, in cycles across half of the shape's longest side; `None` for none.
    pub fourier_sigma: Option<f64>,
}

impl Training {
    /// Neurons that a hidden layer may have.
    pub const WIDTHS: RangeInclusive<usize> = 1..=1 << 14;
    /// Steps that a training may have.
    pub const STEPS: RangeInclusive<usize> = 1..=1_000_000;
}

impl Default for Training {
    fn default() -> Self {
        Training {
            width: 1024,
            schedule: Schedule::UntilSmall { at_most: 2000 },
            rate: 6e-4,
            seed: 0,
            fourier_sigma: None,
        }
    }
}

/// A trained network, whose outputs are of which control points, and how the training went.
#[derive(Clone, Debug, PartialEq)]
pub struct Trained {
    /// The control points, m x dim.
    pub control_points: Vec<f64>,
    /// The network.
    pub network: Network,
    /// The mean cross-entropy before each step.
    pub losses: Vec<f64>,
    /// The mean cross-entropy after the last.
    pub loss: f64,
    /// Of shape-aware weights: the part of the shape that was to follow each control point and does not (`shape_graph`). Empty of others, and of
    /// maps that were saved before it was measured.
    pub missed: Vec<f64>,
}

impl Trained {
    /// The same network, trained further on the control points.
    ///
    /// # Errors
    /// As [`train`].
    pub fn further(
        &self,
        schedule: Schedule,
        rate: f64,
        progress: &mut Progress<'_>,
    ) -> Result<Trained, Error> {
        train(self.network.clone(), &self.control_points, schedule, rate, progress)
    }
}

/// Makes a network from a seed and trains it on the control points `p`, and on `samples` of a shape where there are any.
///
/// With samples, each step sees all of the control points and a batch of the samples, and in the second half some of those further ones that
/// the network has not learned; the losses are those of a batch, and the first layer's neurons begin where the samples are ([`bend_at`]).
///
/// The result does not depend on the order of the control points (but that its outputs are in their order), nor on the number of
/// threads.
///
/// # Errors
/// [`Error::Cancelled`]; where there are no control points, more than 1,000, two in one place, or a parameter is out of range;
/// where labels are no probabilities.
pub fn fit(
    p: &[f64],
    samples: Option<Samples<'_>>,
    dim: usize,
    frame: Frame,
    training: &Training,
    progress: &mut Progress<'_>,
) -> Result<Trained, Error> {
    check_control_points(p, dim)?;
    if !Training::WIDTHS.contains(&training.width) {
        let (most, found) = (Training::WIDTHS.end(), training.width);
        return Err(Error::argument("width", format!("expected 1 to {most} neurons, found {found}")));
    }
    let (in_line, order) = sorted(p, dim);
    let mut lessons = Lessons::of_control_points(&in_line, dim);
    if let Some(samples) = samples {
        lessons = lessons.with(samples, dim, &order, training.seed)?;
    }
    let mut random = Random::new(training.seed);
    let frequencies = match training.fourier_sigma {
        Some(sigma) => {
            check_number("fourier_sigma", sigma, sigma > 0.0, "a number above 0")?;
            random.frequencies(dim, sigma)
        }
        None => Vec::new(),
    };
    let (inputs, width, m) = (features::width(dim, &frequencies), training.width, order.len());
    let mut layers = [random.layer(inputs, width), random.layer(width, width), random.layer(width, m)];
    if let Some(samples) = samples {
        bend_at(&mut layers[0], &samples.x[..dim * samples.spread], dim, &frame);
    }
    let mut network = Parameters::new(dim, frame, frequencies, layers)?;
    if m >= MANY && samples.is_none() && matches!(training.schedule, Schedule::UntilSmall { .. }) {
        network.layers[2] = prototypes::output_layer(&network, &in_line);
    }

    let mut trained = teach(network, p, lessons, training.schedule, training.rate, progress)?;
    let last = &mut trained.network.parameters.layers[2];
    *last = in_order(last, &order);
    Ok(trained)
}

/// Makes neurons of the first layer bend where the points `x` are, and more than `torch.nn.Linear`'s: `W_j (x - x_k)`, W
/// times [`GAIN`]. Random biases bend many of them where there is no shape, and a shape's labels change faster than the whole.
///
/// Where Fourier features are the inputs, it does nothing.
fn bend_at(layer: &mut Layer, x: &[f64], dim: usize, frame: &Frame) {
    let count = x.len() / dim;
    if layer.inputs() != dim || count == 0 {
        return;
    }
    layer.weight.iter_mut().for_each(|weight| *weight *= GAIN);
    for (j, (weights, bias)) in layer.weight.chunks_exact(dim).zip(&mut layer.bias).enumerate() {
        let point = &x[j % count * dim..][..dim];
        let value = |k: usize| f64::from(weights[k]) * (point[k] - frame.centre[k]) / frame.half;
        *bias = -(0..dim).map(value).sum::<f64>() as f32;
    }
}

/// Trains a given network on the control points `p`.
///
/// # Errors
/// As [`fit`]; and where the network has another number of outputs than there are control points.
pub fn train(
    network: Network,
    p: &[f64],
    schedule: Schedule,
    rate: f64,
    progress: &mut Progress<'_>,
) -> Result<Trained, Error> {
    let m = check_control_points(p, network.dim())?;
    if network.outputs() != m {
        return Err(Error::argument(
            "network",
            format!("it has {} outputs, but there are {m} control points", network.outputs()),
        ));
    }
    let lessons = Lessons::of_control_points(p, network.dim());
    teach(network.parameters, p, lessons, schedule, rate, progress)
}

fn teach(
    network: Parameters,
    p: &[f64],
    lessons: Lessons,
    schedule: Schedule,
    rate: f64,
    progress: &mut Progress<'_>,
) -> Result<Trained, Error> {
    check_number("rate", rate, rate > 0.0, "a number above 0")?;
    let one = network.outputs() == 1;

    let most = match schedule {
        Schedule::UntilSmall { at_most } => at_most,
        Schedule::Fixed(steps) | Schedule::Cosine(steps) => steps,
    };
    if !Training::STEPS.contains(&most) {
        return Err(Error::argument(
            "steps",
            format!("expected 1 to {}, found {most}", Training::STEPS.end()),
        ));
    }
    let batches = lessons.in_batches();
    on_a_working_thread(progress, |progress| {
        let mut trainer = Trainer::new(network, lessons);
        let mut losses = Vec::new();
        let mut slow_from = most * 4 / 5;
        let mut end = most;
        let loss = loop {
            let step = losses.len();
            report(progress, step as f64 / end as f64)?;
            let Losses { mean, worst } = trainer.losses();
            let small = matches!(schedule, Schedule::UntilSmall { .. }) && worst <= SMALL_LOSS;
            if small && step < slow_from {
                slow_from = step;
                end = step + step.div_ceil(4);
            }
            if step == end || one {
                break mean;
            }
            if batches && LOOKS.iter().any(|eighths| step == end * eighths / 8) {
                trainer.look_again();
            }
            losses.push(mean);
            trainer.step(match schedule {
                Schedule::Cosine(_) => 0.5 * rate * (1.0 + (PI * step as f64 / end as f64).cos()),
                _ if step < slow_from => rate,
                _ => 0.1 * rate,
            });
        };
        report(progress, 1.0)?;
        let (control_points, network) = (p.to_vec(), Network::from(trainer.finish()));
        Ok(Trained { control_points, network, losses, loss, missed: Vec::new() })
    })
}

/// Checks that there are 1 to 1,000 control points, finite and apart; gives their number.
fn check_control_points(p: &[f64], dim: usize) -> Result<usize, Error> {
    const NAME: &str = "control points";
    let m = check_points(NAME, p, dim)?;
    if !(1..=MOST_CONTROL_POINTS).contains(&m) {
        return Err(Error::argument(NAME, format!("expected 1 to {MOST_CONTROL_POINTS}, found {m}")));
    }
    let order = lexicographic_order(p, dim);
    for pair in order.windows(2) {
        if p[dim * pair[0]..][..dim] == p[dim * pair[1]..][..dim] {
            let (a, b) = (pair[0].min(pair[1]), pair[0].max(pair[1]));
            return Err(Error::argument(NAME, format!("numbers {a} and {b} are in the same place")));
        }
    }
    Ok(m)
}

/// The last layer with row k moved to where `order[k]` says.
fn in_order(layer: &Layer, order: &[usize]) -> Layer {
    let mut result = layer.clone();
    let k = layer.inputs();
    for (from, &to) in order.iter().enumerate() {
        result.weight[k * to..k * (to + 1)].copy_from_slice(&layer.weight[k * from..k * (from + 1)]);
        result.bias[to] = layer.bias[from];
    }
    result
}

#[cfg(test)]
mod tests;
