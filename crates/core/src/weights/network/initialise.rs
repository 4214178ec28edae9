//! The parameters before training: as `torch.nn.Linear` has them, from a seed.

use super::parameters::Layer;
use crate::machine::random::Random;

/// Frequencies of the random Fourier features, as in the published code.
const FREQUENCIES: usize = 32;

impl Random {
    /// Weights and biases uniform in `+-1/sqrt(inputs)`.
    pub(crate) fn layer(&mut self, inputs: usize, outputs: usize) -> Layer {
        let bound = 1.0 / (inputs as f32).sqrt();
        Layer { weight: self.uniform(inputs * outputs, bound), bias: self.uniform(outputs, bound) }
    }

    /// `B` of the Fourier features: 32 x d, normal with deviation `sigma` (Box and Muller 1958).
    pub(crate) fn frequencies(&mut self, dim: usize, sigma: f64) -> Vec<f32> {
        let mut normal = || {
            let radius = (-2.0 * (1.0 - f64::from(self.unit_single())).ln()).sqrt();
            radius * (std::f64::consts::TAU * f64::from(self.unit_single())).cos()
        };
        (0..FREQUENCIES * dim).map(|_| (sigma * normal()) as f32).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_layer_is_uniform_within_the_bound_of_its_inputs() {
        let layer = Random::new(7).layer(100, 300);
        let (mut least, mut most, mut sum) = (0f32, 0f32, 0f64);
        for &v in &layer.weight {
            (least, most, sum) = (least.min(v), most.max(v), sum + f64::from(v));
        }
        assert!((-0.1..-0.0999).contains(&least) && (0.0999..=0.1).contains(&most), "{least} {most}");
        assert!((sum / 30_000.0).abs() < 1e-3);
        assert_eq!((layer.inputs(), layer.outputs()), (100, 300));
    }

    #[test]
    fn many_numbers_are_those_of_one_sequence() {
        let (mut at_once, mut one_by_one) = (Random::new(3), Random::new(3));
        let layer = at_once.layer(40, 1000);
        for value in layer.weight.iter().chain(&layer.bias) {
            assert_eq!(*value, (2.0 * one_by_one.unit_single() - 1.0) * (1.0 / 40f32.sqrt()));
        }
        assert_eq!(at_once.unit_single(), one_by_one.unit_single());
    }

    #[test]
    fn frequencies_are_normal() {
        let b = Random::new(1).frequencies(3, 2.0);
        assert_eq!(b.len(), 96);
        let variance: f32 = b.iter().map(|v| v * v).sum::<f32>() / 96.0;
        assert!((2.5..6.0).contains(&variance), "{variance}");
    }

    #[test]
    fn a_seed_means_the_same_numbers_everywhere() {
        assert_eq!(Random::new(0).layer(4, 2), Random::new(0).layer(4, 2));
        assert_ne!(Random::new(0).layer(4, 2), Random::new(1).layer(4, 2));
        assert_eq!(Random::new(0).layer(4, 1).weight, [0.15469712, 0.20907539, 0.22986984, -0.0340783]);
    }
}
