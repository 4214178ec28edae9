//! Training: control point i is to be given the class i.
//!
//! Full-batch cross-entropy, Adam (Kingma, Ba 2015, as in `torch.optim.Adam`), rate 6e-4, and a tenth of it for the last fifth of the steps.
//! Where it differs from the paper: by default it does not stop after a fixed 48 steps but when every control point has most
//! of the weight at its own place, because handles that do not own their place do not arrive at their targets.

use super::adam::{Adam, Rates};
use super::hidden::{Activations, Hidden};
use super::initialise::Random;
use super::network::{relu, Layer, Network};
use super::piecewise::Prepared;
use super::{features, gemm};
use crate::error::{check_number, check_points, Error};
use crate::frame::Frame;
use crate::progress::{report, Progress};

/// A control point owns its place when its cross-entropy there is at most this: 0.9 of the weight.
const SMALL_LOSS: f64 = 0.105;
/// Most control points: beyond, every layer of the paper's network is too small for them.
const MOST_CONTROL_POINTS: usize = 1000;

/// How many steps to train.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Schedule {
    /// At the full rate until every control point has 0.9 of the weight at its own place, then a quarter as many steps
    /// at a tenth of it; at most so many in all.
    UntilSmall {
        /// The most steps.
        at_most: usize,
    },
    /// Exactly so many, the last fifth of them at a tenth of the rate: 48 in the paper.
    Fixed(usize),
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

/// A trained network, and how the training went.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The network.
    pub network: Network,
    /// The mean cross-entropy before each step.
    pub losses: Vec<f64>,
    /// The mean cross-entropy after the last.
    pub loss: f64,
}

/// Makes a network from a seed and trains it on the control points `p`.
///
/// The result does not depend on the order of the control points (but that its outputs are in their order), nor on the number of
/// threads.
///
/// # Errors
/// [`Error::Cancelled`]; where there are no control points, more than 1,000, two in one place, or a parameter is out of range.
pub fn fit(
    p: &[f64],
    dim: usize,
    frame: Frame,
    training: &Training,
    progress: &mut Progress<'_>,
) -> Result<Fit, Error> {
    check_control_points(p, dim)?;
    if !(1..=1 << 14).contains(&training.width) {
        let found = training.width;
        return Err(Error::argument("width", format!("expected 1 to 16384 neurons, found {found}")));
    }
    let mut random = Random::new(training.seed);
    let frequencies = match training.fourier_sigma {
        Some(sigma) => {
            check_number("fourier_sigma", sigma, sigma > 0.0, "a number above 0")?;
            random.frequencies(dim, sigma)
        }
        None => Vec::new(),
    };
    let (inputs, width, m) = (features::width(dim, &frequencies), training.width, p.len() / dim);
    let layers = [random.layer(inputs, width), random.layer(width, width), random.layer(width, m)];
    let network = Network::new(dim, frame, frequencies, layers)?;

    let order = lexicographic_order(p, dim);
    let sorted: Vec<f64> = order.iter().flat_map(|&i| &p[dim * i..dim * i + dim]).copied().collect();
    let mut fit = train(network, &sorted, training.schedule, training.rate, progress)?;
    fit.network.layers[2] = in_order(&fit.network.layers[2], &order);
    Ok(fit)
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
) -> Result<Fit, Error> {
    let m = check_control_points(p, network.dim())?;
    check_number("rate", rate, rate > 0.0, "a number above 0")?;
    if network.outputs() != m {
        return Err(Error::argument(
            "network",
            format!("it has {} outputs, but there are {m} control points", network.outputs()),
        ));
    }
    let most = match schedule {
        Schedule::UntilSmall { at_most } => at_most,
        Schedule::Fixed(steps) => steps,
    };
    if !(1..=1_000_000).contains(&most) {
        return Err(Error::argument("steps", format!("expected 1 to 1000000, found {most}")));
    }
    let mut trainer = Trainer::new(network, p);
    let mut losses = Vec::new();
    let mut slow_from = most * 4 / 5;
    let mut end = most;
    let loss = loop {
        let step = losses.len();
        report(progress, step as f64 / end as f64)?;
        let Losses { mean, worst } = trainer.forward();
        let small = matches!(schedule, Schedule::UntilSmall { .. }) && worst <= SMALL_LOSS;
        if small && step < slow_from {
            slow_from = step;
            end = step + step.div_ceil(4);
        }
        if step == end || m == 1 {
            break mean;
        }
        losses.push(mean);
        trainer.step(if step < slow_from { rate } else { 0.1 * rate });
    };
    report(progress, 1.0)?;
    Ok(Fit { network: trainer.finish(), losses, loss })
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

fn lexicographic_order(p: &[f64], dim: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..p.len() / dim).collect();
    let point = |i: usize| &p[dim * i..dim * i + dim];
    order.sort_by(|&a, &b| point(a).partial_cmp(point(b)).expect("finite"));
    order
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

struct Losses {
    mean: f64,
    worst: f64,
}

/// The network with what one step needs. Activations and errors are stored neuron by neuron, neurons x control points.
struct Trainer {
    network: Network,
    hidden: Hidden,
    /// Of the outer layers' weights and of all biases.
    weights: [Adam; 2],
    biases: [Adam; 3],
    steps: i32,
    m: usize,
    input: Vec<f32>,
    /// After the first ReLU; also in the layout that the middle layer takes.
    first: Vec<f32>,
    first_lanes: Activations,
    /// After the second ReLU.
    second: Vec<f32>,
    /// The gradient of the loss with respect to the logits.
    error: Vec<f32>,
}

impl Trainer {
    fn new(network: Network, p: &[f64]) -> Trainer {
        let m = p.len() / network.dim();
        let features = network.features(p);
        let width = features.len() / m;
        let input: Vec<f32> = (0..features.len()).map(|at| features[at % m * width + at / m]).collect();
        let [a, b, c] = network.layers();
        let first = activations(a, &input, m);
        // A neuron that fires for no control point has no gradient, and so never will.
        let fires = |neuron: &usize| first[neuron * m..(neuron + 1) * m].iter().any(|value| *value > 0.0);
        let hidden = Hidden::new(b, (0..a.outputs()).filter(fires).collect());
        let first_lanes = Activations::of(&first, m, hidden.inputs());
        let product = hidden.forward(&first_lanes, m);
        let mut trainer = Trainer {
            hidden,
            weights: [a, c].map(|layer| Adam::new(&layer.weight)),
            biases: [a, b, c].map(|layer| Adam::new(&layer.bias)),
            steps: 0,
            m,
            input,
            first,
            first_lanes,
            second: Vec::new(),
            error: vec![0.0; c.outputs() * m],
            network,
        };
        trainer.activate_second(product);
        trainer
    }

    /// Takes the middle layer's product with the first activations, without its biases.
    fn activate_second(&mut self, mut product: Vec<f32>) {
        for (row, bias) in product.chunks_exact_mut(self.m).zip(&self.network.layers[1].bias) {
            row.iter_mut().for_each(|z| *z = (*z + bias).max(0.0));
        }
        self.second = product;
    }

    /// The losses of the network as it is; leaves the gradient with respect to the logits in `error`.
    fn forward(&mut self) -> Losses {
        let m = self.m;
        gemm::forward(&self.network.layers[2], &self.second, m, &mut self.error);
        let (mut sum, mut worst) = (0.0, 0.0f64);
        let mut column = vec![0.0; m];
        for i in 0..m {
            for (c, logit) in column.iter_mut().enumerate() {
                *logit = f64::from(self.error[c * m + i]);
            }
            let largest = column.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let total: f64 = column.iter().map(|l| (l - largest).exp()).sum();
            let loss = total.ln() + largest - column[i];
            sum += loss;
            worst = worst.max(loss);
            for (c, logit) in column.iter().enumerate() {
                let probability = (logit - largest).exp() / total;
                self.error[c * m + i] = ((probability - f64::from(u8::from(c == i))) / m as f64) as f32;
            }
        }
        Losses { mean: sum / m as f64, worst }
    }

    /// One step of Adam after [`Trainer::forward`], and the activations of the network that it gives.
    fn step(&mut self, rate: f64) {
        let m = self.m;
        self.steps += 1;
        let rates = Rates::new(rate, self.steps);
        let [a, b, c] = &mut self.network.layers;
        // Errors go back through the layers as they were; then each is updated.
        let second_error = gemm::backward(c, &self.error, &self.second, m);
        let mut first_error = vec![0.0; self.first.len()];
        let found = self.hidden.backward(&second_error, m);
        for (neuron, errors) in self.hidden.inputs().iter().zip(found.chunks_exact(m)) {
            for (i, error) in (neuron * m..(neuron + 1) * m).zip(errors) {
                first_error[i] = if self.first[i] > 0.0 { *error } else { 0.0 };
            }
        }
        self.weights[1].update_weights(&mut c.weight, &self.error, &self.second, m, rates);
        self.biases[2].update_biases(&mut c.bias, &self.error, m, rates);
        self.biases[1].update_biases(&mut b.bias, &second_error, m, rates);
        self.weights[0].update_weights(&mut a.weight, &first_error, &self.input, m, rates);
        self.biases[0].update_biases(&mut a.bias, &first_error, m, rates);

        self.first = activations(a, &self.input, m);
        let next = Activations::of(&self.first, m, self.hidden.inputs());
        let product = self.hidden.update_and_forward(&second_error, &self.first_lanes, &next, m, rates);
        self.first_lanes = next;
        self.activate_second(product);
    }

    fn finish(mut self) -> Network {
        // Laid out, if at all, from the parameters that it had.
        self.network.prepared = Prepared::default();
        self.hidden.store(&mut self.network.layers[1]);
        self.network
    }
}

/// `relu(W input + b)`, outputs x m.
fn activations(layer: &Layer, input: &[f32], m: usize) -> Vec<f32> {
    let mut values = vec![0.0; layer.outputs() * m];
    gemm::forward(layer, input, m, &mut values);
    relu(&mut values);
    values
}

#[cfg(test)]
mod tests;
