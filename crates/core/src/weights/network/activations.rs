//! What a training step knows of some neurons at some points: their activations, or the gradients with respect to them.

use crate::machine::simd::{Aligned, WIDTH};

/// Numbers of some neurons for every point of a batch, a structure of arrays `[neuron / 16][point][16]`, neurons padded with zeros.
#[derive(Clone, Debug)]
pub(super) struct Activations {
    pub(super) lanes: Vec<Aligned>,
    /// How many.
    pub(super) points: usize,
}

impl Activations {
    pub(super) fn zeros(neurons: usize, points: usize) -> Activations {
        Activations { lanes: vec![Aligned::ZERO; neurons.div_ceil(WIDTH) * points], points }
    }

    /// Gives neuron `index` the value 1 at every point: what a bias is the weight of. It is the one after the last.
    pub(super) fn push_one(&mut self, index: usize) {
        self.lanes.resize((index / WIDTH + 1) * self.points, Aligned::ZERO);
        self.row_mut(index, |value| *value = 1.0);
    }

    /// The values of the first `count` neurons at a point.
    pub(super) fn of_point(&self, point: usize, count: usize) -> Vec<f32> {
        let lanes = self.lanes.iter().skip(point).step_by(self.points);
        lanes.flat_map(|lanes| lanes.0).take(count).collect()
    }

    /// The values of a neuron at all points.
    #[cfg(test)]
    pub(super) fn row(&self, neuron: usize) -> impl Iterator<Item = f32> + '_ {
        let lanes = &self.lanes[neuron / WIDTH * self.points..][..self.points];
        lanes.iter().map(move |lanes| lanes.0[neuron % WIDTH])
    }

    pub(super) fn row_mut(&mut self, neuron: usize, mut change: impl FnMut(&mut f32)) {
        let lanes = &mut self.lanes[neuron / WIDTH * self.points..][..self.points];
        lanes.iter_mut().for_each(|lanes| change(&mut lanes.0[neuron % WIDTH]));
    }
}
