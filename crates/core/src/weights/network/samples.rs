//! Points of a shape that a network is taught with besides the control points: how likely each control point is there.

use super::activations::Activations;
use crate::check::check_points;
use crate::error::Error;
use crate::machine::random::Random;

/// Its cross-entropy less the label's own: a place at which it is more was not learned. A place that is to have 0.8 of the weight of one
/// of two control points, and has half of it, is at 0.06 after the labels are softened.
const UNLEARNED: f64 = 0.02;
/// The most places that were not learned, a step: they shall not outweigh the rest.
const AGAIN: usize = 16;

/// Points with soft labels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Samples<'a> {
    /// The points, as the control points: `dim` coordinates each.
    pub x: &'a [f64],
    /// For each of them the probabilities of the m control points, which sum to 1.
    pub labels: &'a [f32],
    /// The first so many are looked at in turn; the others only where the network turns out not to have learned them.
    pub spread: usize,
    /// How many of them a step of the training looks at, beside all of the control points.
    pub batch: usize,
}

/// The points that a training looks at, with the labels of all: the control points first, in lexicographic order.
pub(super) struct Lessons {
    pub(super) points: Vec<f64>,
    /// Points x m.
    pub(super) labels: Vec<f32>,
    /// Control points and samples that are looked at in turn; the rest is looked at again only.
    spread: usize,
    dim: usize,
    batches: Batches,
}

impl Lessons {
    /// Of control points alone: control point i is to be given the class i.
    pub(super) fn of_control_points(p: &[f64], dim: usize) -> Lessons {
        let m = p.len() / dim;
        let labels = (0..m * m).map(|at| f32::from(u8::from(at / m == at % m))).collect();
        Lessons { points: p.to_vec(), labels, batches: Batches::new(m, 0, 0, 0), spread: m, dim }
    }

    /// Of control points and samples; `order` says which control point each label will be of.
    ///
    /// # Errors
    /// Where the labels are not as many as the samples times the control points, or are no probabilities.
    pub(super) fn with(
        self,
        samples: Samples<'_>,
        dim: usize,
        order: &[usize],
        seed: u64,
    ) -> Result<Lessons, Error> {
        let (n, m) = (check_points("samples", samples.x, dim)?, order.len());
        if samples.labels.len() != n * m {
            let found = samples.labels.len();
            return Err(Error::argument("labels", format!("expected {n} x {m} of them, found {found}")));
        }
        for (at, row) in samples.labels.chunks_exact(m).enumerate() {
            let sum: f32 = row.iter().sum();
            // Written so that NaN is refused.
            if !((sum - 1.0).abs() < 1e-3 && row.iter().all(|label| *label >= 0.0)) {
                let message = format!("those of sample {at} are no probabilities that sum to 1");
                return Err(Error::argument("labels", message));
            }
        }
        let mut lessons = self;
        lessons.points.extend_from_slice(samples.x);
        lessons.labels.extend(samples.labels.chunks_exact(m).flat_map(|row| order.iter().map(|&i| row[i])));
        lessons.batches = Batches::new(m, samples.spread.min(n), samples.batch, seed);
        lessons.spread = m + samples.spread.min(n);
        Ok(lessons)
    }

    /// Whether a step looks at a part of the points.
    pub(super) fn in_batches(&self) -> bool {
        self.batches.size > 0
    }

    /// The numbers of the places that are not looked at in turn.
    pub(super) fn further(&self) -> Vec<usize> {
        (self.spread..self.points.len() / self.dim).collect()
    }

    /// Has the steps that follow look at those [`further`](Lessons::further) places, too, that the network has not learned: `logits` are what it
    /// says there.
    pub(super) fn look_again(&mut self, logits: &Activations) {
        let m = self.labels.len() / (self.points.len() / self.dim);
        let labels = self.labels[m * self.spread..].chunks_exact(m).enumerate();
        let unlearned = labels.filter(|(i, labels)| divergence(&logits.of_point(*i, m), labels) > UNLEARNED);
        self.batches.again = unlearned.map(|(i, _)| self.spread + i).collect();
    }

    /// The numbers of the points that the next step looks at.
    pub(super) fn next(&mut self) -> Vec<usize> {
        self.batches.next()
    }
}

/// The Kullback-Leibler divergence of the weights of some logits from the labels.
fn divergence(logits: &[f32], labels: &[f32]) -> f64 {
    let most = logits.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let sum: f64 = logits.iter().map(|logit| f64::from(logit - most).exp()).sum();
    let of_one = |(logit, label): (&f32, &f32)| match f64::from(*label) {
        0.0 => 0.0,
        label => label * (label.ln() - f64::from(logit - most) + sum.ln()),
    };
    logits.iter().zip(labels).map(of_one).sum()
}

/// All control points, and of the samples so many at a time, in an order that is drawn anew after each pass through all.
struct Batches {
    control_points: usize,
    order: Vec<usize>,
    at: usize,
    size: usize,
    /// Places to look at again, and how many steps did.
    again: Vec<usize>,
    looked: usize,
    random: Random,
}

impl Batches {
    fn new(control_points: usize, samples: usize, size: usize, seed: u64) -> Batches {
        let order: Vec<usize> = (control_points..control_points + samples).collect();
        let size = size.min(samples);
        let (again, looked, random) = (Vec::new(), 0, Random::new(seed));
        Batches { control_points, at: order.len(), order, size, again, looked, random }
    }

    fn next(&mut self) -> Vec<usize> {
        if self.at + self.size > self.order.len() {
            self.random.shuffle(&mut self.order);
            self.at = 0;
        }
        let chosen = &self.order[self.at..self.at + self.size];
        self.at += self.size;
        let count = self.again.len().min(AGAIN);
        let again = self.again.iter().cycle().skip(self.looked % self.again.len().max(1)).take(count);
        self.looked += count;
        (0..self.control_points).chain(chosen.iter().copied()).chain(again.copied()).collect()
    }
}

/// Control points in lexicographic order, on which the result of a training depends but for the order of its outputs.
pub(super) fn sorted(p: &[f64], dim: usize) -> (Vec<f64>, Vec<usize>) {
    let order = lexicographic_order(p, dim);
    (order.iter().flat_map(|&i| &p[dim * i..dim * i + dim]).copied().collect(), order)
}

pub(super) fn lexicographic_order(p: &[f64], dim: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..p.len() / dim).collect();
    let point = |i: usize| &p[dim * i..dim * i + dim];
    order.sort_by(|&a, &b| point(a).partial_cmp(point(b)).expect("finite"));
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_step_sees_the_control_points_and_every_pass_each_sample_once() {
        let mut batches = Batches::new(2, 6, 3, 0);
        let mut seen: Vec<usize> = Vec::new();
        for _ in 0..2 {
            let batch = batches.next();
            assert_eq!((batch.len(), &batch[..2]), (5, &[0, 1][..]));
            seen.extend(&batch[2..]);
        }
        seen.sort_unstable();
        assert_eq!(seen, [2, 3, 4, 5, 6, 7]);
    }

    #[test]
    fn control_points_alone_are_one_batch() {
        let mut lessons = Lessons::of_control_points(&[0.0, 1.0], 1);
        assert_eq!((lessons.next(), lessons.next()), (vec![0, 1], vec![0, 1]));
        assert_eq!(lessons.labels, [1.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn what_a_network_has_not_learned_is_looked_at_again() {
        let labels = [0.5, 0.5, 0.9, 0.1, 0.45, 0.55, 0.0, 1.0];
        let samples = Samples { x: &[0.1, 0.2, 0.3, 0.4], labels: &labels, spread: 1, batch: 1 };
        let lessons = Lessons::of_control_points(&[0.0, 1.0], 1).with(samples, 1, &[0, 1], 0);
        let mut lessons = lessons.unwrap();
        assert_eq!((lessons.next(), lessons.next()), (vec![0, 1, 2], vec![0, 1, 2]));
        assert_eq!(lessons.further(), [3, 4, 5]);
        // A network that says nothing of any place.
        lessons.look_again(&Activations::zeros(2, 3));
        assert_eq!(lessons.next(), [0, 1, 2, 3, 5]);
    }

    #[test]
    fn labels_follow_the_order_of_the_control_points() {
        let samples = Samples { x: &[0.5], labels: &[0.25, 0.75], spread: 1, batch: 1 };
        let lessons = Lessons::of_control_points(&[0.0, 1.0], 1).with(samples, 1, &[1, 0], 0).unwrap();
        assert_eq!(lessons.labels[4..], [0.75, 0.25]);
    }

    #[test]
    fn refuses_labels_that_are_no_probabilities() {
        let says = |labels: &[f32]| {
            let samples = Samples { x: &[0.5], labels, spread: 1, batch: 1 };
            let lessons = Lessons::of_control_points(&[0.0, 1.0], 1).with(samples, 1, &[0, 1], 0);
            lessons.err().expect("refused").to_string()
        };
        assert!(says(&[1.0]).contains("1 x 2"));
        assert!(says(&[0.5, 0.4]).contains("sample 0"));
        assert!(says(&[1.5, -0.5]).contains("sample 0"));
        assert!(says(&[f32::NAN, 0.5]).contains("sample 0"));
    }
}
