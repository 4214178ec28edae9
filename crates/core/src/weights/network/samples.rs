//! Points of a shape that a network is taught with besides the control points: how likely each control point is there.

use crate::check::check_points;
use crate::error::Error;
use crate::machine::random::Random;

/// Points with soft labels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Samples<'a> {
    /// The points, as the control points: `dim` coordinates each.
    pub x: &'a [f64],
    /// For each of them the probabilities of the m control points, which sum to 1.
    pub labels: &'a [f32],
    /// How many of them a step of the training looks at, beside all of the control points.
    pub batch: usize,
}

/// The points that a training looks at, with the labels of all: the control points first, in lexicographic order.
pub(super) struct Lessons {
    pub(super) points: Vec<f64>,
    /// Points x m.
    pub(super) labels: Vec<f32>,
    batches: Batches,
}

impl Lessons {
    /// Of control points alone: control point i is to be given the class i.
    pub(super) fn of_control_points(p: &[f64], dim: usize) -> Lessons {
        let m = p.len() / dim;
        let labels = (0..m * m).map(|at| f32::from(u8::from(at / m == at % m))).collect();
        Lessons { points: p.to_vec(), labels, batches: Batches::new(m, 0, 0, 0) }
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
        lessons.batches = Batches::new(m, n, samples.batch, seed);
        Ok(lessons)
    }

    /// The numbers of the points that the next step looks at.
    pub(super) fn next(&mut self) -> Vec<usize> {
        self.batches.next()
    }
}

/// All control points, and of the samples so many at a time, in an order that is drawn anew after each pass through all.
struct Batches {
    control_points: usize,
    order: Vec<usize>,
    at: usize,
    size: usize,
    random: Random,
}

impl Batches {
    fn new(control_points: usize, samples: usize, size: usize, seed: u64) -> Batches {
        let order: Vec<usize> = (control_points..control_points + samples).collect();
        let size = size.min(samples);
        Batches { control_points, at: order.len(), order, size, random: Random::new(seed) }
    }

    fn next(&mut self) -> Vec<usize> {
        if self.at + self.size > self.order.len() {
            self.random.shuffle(&mut self.order);
            self.at = 0;
        }
        let chosen = &self.order[self.at..self.at + self.size];
        self.at += self.size;
        (0..self.control_points).chain(chosen.iter().copied()).collect()
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
    fn labels_follow_the_order_of_the_control_points() {
        let samples = Samples { x: &[0.5], labels: &[0.25, 0.75], batch: 1 };
        let lessons = Lessons::of_control_points(&[0.0, 1.0], 1).with(samples, 1, &[1, 0], 0).unwrap();
        assert_eq!(lessons.labels[4..], [0.75, 0.25]);
    }

    #[test]
    fn refuses_labels_that_are_no_probabilities() {
        let says = |labels: &[f32]| {
            let samples = Samples { x: &[0.5], labels, batch: 1 };
            let lessons = Lessons::of_control_points(&[0.0, 1.0], 1).with(samples, 1, &[0, 1], 0);
            lessons.err().expect("refused").to_string()
        };
        assert!(says(&[1.0]).contains("1 x 2"));
        assert!(says(&[0.5, 0.4]).contains("sample 0"));
        assert!(says(&[1.5, -0.5]).contains("sample 0"));
        assert!(says(&[f32::NAN, 0.5]).contains("sample 0"));
    }
}
