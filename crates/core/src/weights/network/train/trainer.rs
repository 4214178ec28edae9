//! One step of the training after another: losses, errors back through the layers, Adam, and the activations that follow.

use super::super::activations::Activations;
use super::super::adam::{Rates, BETA_2, BETA_2_IN_BATCHES, DUST};
use super::super::first::First;
use super::super::linear::Linear;
use super::super::parameters::Parameters;
use super::super::prototypes::activations;
use super::super::samples::Lessons;
use crate::machine::parallel::for_each_block_pair;
use crate::machine::simd::{Aligned, WIDTH};

/// Neurons of the second layer among which those that fire at first are put together.
const TOGETHER: usize = 256;
/// Exponentials a task: fewer are done before another thread has begun.
const EXPONENTIALS: usize = 1 << 12;

pub(super) struct Losses {
    pub(super) mean: f64,
    pub(super) worst: f64,
}

/// The network with what one step needs.
pub(super) struct Trainer {
    network: Parameters,
    first: First,
    middle: Linear,
    last: Linear,
    steps: i32,
    beta_2: f64,
    lessons: Lessons,
    /// Of all points, point by point.
    features: Vec<f32>,
    /// The points of the step, and their features.
    batch: Vec<usize>,
    input: Vec<f32>,
    /// After the first ReLU, after the second, and the logits.
    activations: [Activations; 3],
    /// The gradient of the loss with respect to the logits.
    error: Activations,
}

impl Trainer {
    pub(super) fn new(network: Parameters, mut lessons: Lessons) -> Trainer {
        let features = network.features(&lessons.points);
        let [a, b, c] = &network.layers;
        let every: Vec<usize> = (0..features.len() / a.inputs()).collect();
        let everywhere = activations(a, &columns(&features, a.inputs(), &every), every.len());
        // A neuron that fires for no point has no gradient, and so never will.
        let fires = |neuron: &usize| {
            everywhere[neuron * every.len()..(neuron + 1) * every.len()].iter().any(|value| *value > 0.0)
        };
        let neurons: Vec<usize> = (0..a.outputs()).filter(fires).collect();
        let batch = lessons.next();
        let m = batch.len();
        let input = of_points(&features, a.inputs(), &batch);
        let second = activations(b, &activations(a, &columns(&features, a.inputs(), &batch), m), m);
        let mut rows: Vec<usize> = (0..b.outputs()).collect();
        // Neurons that do not fire are not updated, eight at a time.
        rows.chunks_mut(TOGETHER).for_each(|rows| {
            rows.sort_by_key(|row| second[row * m..(row + 1) * m].iter().all(|value| *value <= 0.0));
        });

        let first = First::new(a, neurons.clone());
        let middle = Linear::new(b, neurons, rows.clone(), true);
        let last = Linear::new(c, rows, (0..c.outputs()).collect(), false);
        let values = first.forward(&input, m);
        let second = middle.forward(&values);
        let logits = last.forward(&second);
        let activations = [values, second, logits];
        let error = Activations::zeros(c.outputs(), m);
        Trainer {
            network,
            first,
            middle,
            last,
            steps: 0,
            beta_2: if lessons.in_batches() { BETA_2_IN_BATCHES } else { BETA_2 },
            lessons,
            features,
            batch,
            input,
            activations,
            error,
        }
    }

    /// The losses of the network as it is; leaves the gradient with respect to the logits in `error`.
    pub(super) fn losses(&mut self) -> Losses {
        let (n, m) = (self.batch.len(), self.network.outputs());
        let (logits, labels, batch) = (&self.activations[2], &self.lessons.labels, &self.batch);
        let lanes = m.div_ceil(WIDTH);
        if self.error.points != n {
            self.error = Activations::zeros(m, n);
        }
        // Point by point.
        let (mut errors, mut losses) = (vec![Aligned::ZERO; n * lanes], vec![0.0; n]);
        let points = (EXPONENTIALS / m).max(1);
        for_each_block_pair(&mut errors, points * lanes, &mut losses, points, |block, errors, losses| {
            let mut column = vec![0.0; m];
            for (k, (errors, loss)) in errors.chunks_exact_mut(lanes).zip(losses).enumerate() {
                let i = points * block + k;
                for (values, lanes) in column.chunks_mut(WIDTH).zip(logits.lanes.chunks_exact(n)) {
                    values.iter_mut().zip(&lanes[i].0).for_each(|(value, logit)| *value = f64::from(*logit));
                }
                *loss = cross_entropy(&mut column, &labels[m * batch[i]..m * (batch[i] + 1)]);
                for (errors, gradient) in errors.iter_mut().zip(column.chunks(WIDTH)) {
                    for (error, gradient) in errors.0.iter_mut().zip(gradient) {
                        let gradient = (gradient / n as f64) as f32;
                        *error = if gradient.abs() < DUST { 0.0 } else { gradient };
                    }
                }
            }
        });
        for (i, errors) in errors.chunks_exact(lanes).enumerate() {
            errors
                .iter()
                .zip(self.error.lanes.chunks_exact_mut(n))
                .for_each(|(error, lanes)| lanes[i] = *error);
        }
        Losses {
            mean: losses.iter().sum::<f64>() / n as f64,
            worst: losses.iter().copied().fold(0.0, f64::max),
        }
    }

    /// One step of Adam after [`Trainer::losses`], and the activations of the network that it gives.
    pub(super) fn step(&mut self, rate: f64) {
        self.steps += 1;
        let rates = Rates::new(rate, self.steps, self.beta_2);
        // Errors go back through the layers as they were; then each is updated.
        let [first, second, _] = &self.activations;
        let second_error = self.last.backward(&self.error, second);
        let first_error = self.middle.backward(&second_error, first);
        self.first.update(&first_error, &self.input, rates);

        self.batch = self.lessons.next();
        self.input = of_points(&self.features, self.network.layers[0].inputs(), &self.batch);
        let next_first = self.first.forward(&self.input, self.batch.len());
        let next_second = self.middle.update_and_forward(&second_error, first, &next_first, rates);
        let logits = self.last.update_and_forward(&self.error, second, &next_second, rates);
        self.activations = [next_first, next_second, logits];
    }

    /// Has the steps after the next look at what the network has not learned yet.
    pub(super) fn look_again(&mut self) {
        let further = self.lessons.further();
        if further.is_empty() {
            return;
        }
        let input = of_points(&self.features, self.network.layers[0].inputs(), &further);
        let second = self.middle.forward(&self.first.forward(&input, further.len()));
        self.lessons.look_again(&self.last.forward(&second));
    }

    pub(super) fn finish(mut self) -> Parameters {
        let [a, b, c] = &mut self.network.layers;
        self.first.store(a);
        self.middle.store(b);
        self.last.store(c);
        self.network
    }
}

/// The cross-entropy of logits, which become its gradient with respect to them.
fn cross_entropy(logits: &mut [f64], labels: &[f32]) -> f64 {
    let largest = logits.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let likely: f64 = logits.iter().zip(labels).map(|(logit, label)| logit * f64::from(*label)).sum();
    logits.iter_mut().for_each(|logit| *logit = (*logit - largest).exp());
    let total: f64 = logits.iter().sum();
    for (exponential, label) in logits.iter_mut().zip(labels) {
        *exponential = *exponential / total - f64::from(*label);
    }
    total.ln() + largest - likely
}

/// The features of some points, `count` each, point by point.
fn of_points(features: &[f32], count: usize, points: &[usize]) -> Vec<f32> {
    points.iter().flat_map(|point| &features[point * count..(point + 1) * count]).copied().collect()
}

/// The features of some points, `count` each, as columns: `count` x the points.
fn columns(features: &[f32], count: usize, points: &[usize]) -> Vec<f32> {
    (0..count).flat_map(|k| points.iter().map(move |point| features[point * count + k])).collect()
}
