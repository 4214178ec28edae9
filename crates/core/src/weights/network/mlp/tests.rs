//! Evaluation against a naive version in double precision, sizes, refusals.

use super::*;
use crate::machine::random::Random;
use proptest::prelude::*;

fn network(dim: usize, width: usize, m: usize, sigma: Option<f64>) -> Network {
    let mut random = Random::new(5);
    let frequencies = sigma.map_or(Vec::new(), |sigma| random.frequencies(dim, sigma));
    let inputs = crate::weights::network::features::width(dim, &frequencies);
    let layers = [random.layer(inputs, width), random.layer(width, width), random.layer(width, m)];
    let frame = Frame { centre: [1.0, 2.0, 3.0], half: 2.0 };
    Network::new(dim, frame, frequencies, layers).unwrap()
}

pub(in crate::weights::network) fn naive(network: &Network, x: &[f64]) -> Vec<f64> {
    let dim = network.parameters.dim;
    let mut values: Vec<f64> = (0..dim)
        .map(|k| (x[k] - network.parameters.frame.centre[k]) / network.parameters.frame.half)
        .collect();
    let angles: Vec<f64> = network
        .parameters
        .frequencies
        .chunks(dim)
        .map(|b| std::f64::consts::TAU * b.iter().zip(&values).map(|(b, x)| f64::from(*b) * x).sum::<f64>())
        .collect();
    values.extend(angles.iter().map(|a| a.sin()));
    values.extend(angles.iter().map(|a| a.cos()));
    for (index, layer) in network.parameters.layers.iter().enumerate() {
        values = layer
            .weight
            .chunks(layer.inputs())
            .zip(&layer.bias)
            .map(|(w, b)| f64::from(*b) + w.iter().zip(&values).map(|(w, x)| f64::from(*w) * x).sum::<f64>())
            .map(|v| if index < 2 { v.max(0.0) } else { v })
            .collect();
    }
    values
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn logits_agree_with_the_naive_version(dim in 1usize..4, width in 1usize..70, m in 1usize..9,
            n in 0usize..300, fourier in any::<bool>(), seed in any::<u64>()) {
        let network = network(dim, width, m, fourier.then_some(0.7));
        let mut random = Random::new(seed);
        let x: Vec<f64> = random.layer(1, n * dim).weight.iter().map(|v| 3.0 * f64::from(*v) + 2.0).collect();
        let logits = network.logits(&x, &mut |_| true).unwrap();
        prop_assert_eq!(logits.len(), n * m);
        for (x, row) in x.chunks(dim).zip(logits.chunks(m)) {
            for (a, b) in row.iter().zip(naive(&network, x)) {
                prop_assert!((f64::from(*a) - b).abs() < 2e-5, "{} {}", a, b);
            }
        }
    }
}

#[test]
fn a_point_gets_the_same_logits_whatever_is_evaluated_with_it() {
    let network = network(3, 64, 5, None);
    let x: Vec<f64> = (0..3 * 40_000).map(|i| (f64::from(i) * 0.37).sin() * 3.0).collect();
    let all = network.logits(&x, &mut |_| true).unwrap();
    for i in [0, 127, 128, 16_383, 16_384, 39_999] {
        let alone = network.logits(&x[3 * i..3 * i + 3], &mut |_| true).unwrap();
        for (a, b) in alone.iter().zip(&all[5 * i..]) {
            assert!((a - b).abs() < 2e-5, "point {i}: {a} {b}");
        }
    }
}

/// Threads fill rows of one matrix.
#[test]
fn a_tree_gets_the_dense_logits_of_its_points_in_their_own_order() {
    let network = network(2, 8, 3, Some(0.7));
    let points = if cfg!(miri) { 140 } else { 5000 };
    let x: Vec<f64> = (0..2 * points).map(|i| (f64::from(i) * 0.37).sin()).collect();
    let tree = PointTree::new(&x, 2, *network.frame(), &mut |_| true).unwrap();
    let one_by_one = network.logits(&x, &mut |_| true).unwrap();
    for (a, b) in network.logits_of_tree(&tree, &mut |_| true).unwrap().iter().zip(&one_by_one) {
        assert!((a - b).abs() < 1e-5, "{a} {b}");
    }
}

#[test]
fn refuses_layers_that_do_not_fit() {
    let layer = |inputs: usize, outputs: usize| Layer {
        weight: vec![0.0; inputs * outputs],
        bias: vec![0.0; outputs],
    };
    let refused = |layers| Network::new(3, Frame::IDENTITY, Vec::new(), layers).unwrap_err().to_string();
    assert!(refused([layer(2, 4), layer(4, 4), layer(4, 2)]).contains("layer 1"));
    assert!(refused([layer(3, 4), layer(5, 4), layer(4, 2)]).contains("layer 2"));
    assert!(refused([layer(3, 4), layer(4, 4), layer(4, 0)]).contains("layer 3"));
    let mut bad = layer(4, 2);
    bad.weight[3] = f32::NAN;
    assert!(refused([layer(3, 4), layer(4, 4), bad]).contains("not finite"));
}

#[test]
fn refuses_points_of_another_dimension_or_not_finite() {
    let network = network(3, 8, 2, None);
    assert!(network.logits(&[1.0, 2.0], &mut |_| true).is_err());
    let error = network.logits(&[0.0, 0.0, 0.0, 1.0, f64::INFINITY, 0.0], &mut |_| true).unwrap_err();
    assert!(error.to_string().contains("point 1"), "{error}");
}

#[test]
fn stops_when_asked() {
    assert_eq!(network(1, 8, 2, None).logits(&[0.0], &mut |_| false), Err(Error::Cancelled));
}
