//! Against the naive version in double precision, wherever the points are, on every instruction set, for any number of threads.

use crate::error::Error;
use crate::geometry::Frame;
use crate::geometry::{Order, PointTree};
use crate::machine::random::Random;
use crate::machine::simd::Simd;
use crate::weights::network::mlp::tests::naive;
use crate::weights::network::{fit, train, Network, Schedule, Training};

fn untrained(dim: usize, width: usize, m: usize) -> Network {
    let mut random = Random::new(11);
    let layers = [random.layer(dim, width), random.layer(width, width), random.layer(width, m)];
    Network::new(dim, Frame { centre: [0.5; 3], half: 2.0 }, Vec::new(), layers).unwrap()
}

fn trained(dim: usize, width: usize, m: usize) -> Network {
    let p = uniform(m, dim, 3);
    let frame = Frame { centre: [0.5; 3], half: 2.0 };
    let training = Training { width, schedule: Schedule::Fixed(60), rate: 3e-3, ..Training::default() };
    fit(&p, None, dim, frame, &training, &mut |_| true).unwrap().network
}

/// Uniform in the box of half a side of 2 around 0.5.
fn uniform(n: usize, dim: usize, seed: u64) -> Vec<f64> {
    Random::new(seed).layer(1, n * dim).weight.iter().map(|v| 0.5 + 2.0 * f64::from(*v)).collect()
}

fn tree(network: &Network, x: &[f64]) -> PointTree {
    PointTree::new(x, network.dim(), *network.frame(), &mut |_| true).unwrap()
}

fn logits_on(simd: Simd, network: &Network, x: &[f64]) -> Vec<f32> {
    let tree = tree(network, x);
    let mut logits = vec![f32::NAN; tree.len() * network.outputs()];
    super::write_logits(
        simd,
        &network.parameters,
        &network.prepared,
        &tree,
        Order::Given,
        &mut logits,
        &mut |_| true,
    )
    .unwrap();
    logits
}

fn logits(network: &Network, x: &[f64]) -> Vec<f32> {
    logits_on(Simd::detect(), network, x)
}

/// At most 200 of the points are within 2e-5 of double precision, or what single precision can hold of large logits.
#[track_caller]
fn check(network: &Network, x: &[f64], logits: &[f32]) {
    let (dim, m) = (network.dim(), network.outputs());
    assert_eq!(logits.len() / m, x.len() / dim);
    assert!(logits.iter().all(|l| l.is_finite()));
    let step = (x.len() / dim).div_ceil(200).max(1);
    for (x, logits) in x.chunks(dim).zip(logits.chunks(m)).step_by(step) {
        let expected = naive(network, x);
        let largest = expected.iter().fold(0f64, |a, b| a.max(b.abs()));
        for (a, b) in logits.iter().zip(expected) {
            let error = (f64::from(*a) - b).abs();
            assert!(error < 2e-5_f64.max(4e-6 * largest), "{error} at {x:?}, logits up to {largest}");
        }
    }
}

#[test]
fn agrees_with_the_naive_version_for_any_number_of_points() {
    for dim in 1..4 {
        for network in [untrained(dim, 200, 5), trained(dim, 200, 5)] {
            for n in [0, 1, 15, 16, 17, 63, 64, 65, 129, 1000, 5000] {
                let x = uniform(n, dim, 1);
                check(&network, &x, &logits(&network, &x));
            }
        }
    }
}

#[test]
fn agrees_with_the_naive_version_for_the_papers_width_and_many_points() {
    let network = trained(3, 1024, 10);
    let x = uniform(100_000, 3, 1);
    check(&network, &x, &logits(&network, &x));
}

#[test]
fn agrees_with_the_naive_version_for_any_width_and_any_number_of_outputs() {
    let x = uniform(700, 3, 1);
    for (width, m) in [(1, 1), (7, 2), (16, 16), (17, 17), (64, 33), (100, 1000)] {
        let network = untrained(3, width, m);
        check(&network, &x, &logits(&network, &x));
    }
}

#[test]
fn a_network_that_was_evaluated_and_then_trained_is_evaluated_as_it_is_now() {
    let (network, x, p) = (trained(3, 200, 5), uniform(500, 3, 1), uniform(5, 3, 9));
    check(&network, &x, &logits(&network, &x));
    let network = train(network, &p, Schedule::Fixed(20), 3e-3, &mut |_| true).unwrap().network;
    check(&network, &x, &logits(&network, &x));
}

#[test]
fn leaves_of_a_wide_network_that_are_mostly_open_are_right_too() {
    let network = untrained(3, 3000, 3);
    let x: Vec<f64> = uniform(200, 3, 1).iter().map(|x| 40.0 * x).collect();
    check(&network, &x, &logits(&network, &x));
}

#[test]
fn clustered_collinear_and_duplicate_points_are_right() {
    let network = trained(3, 300, 6);
    let mut x = uniform(3000, 3, 1);
    for (i, x) in x.chunks_mut(3).enumerate() {
        match i % 4 {
            0 => x.copy_from_slice(&[0.25, 0.5, 0.75]),
            1 => x.iter_mut().for_each(|x| *x *= 1e-6),
            2 => (x[1], x[2]) = (x[0], 1.0 - x[0]),
            _ => {}
        }
    }
    check(&network, &x, &logits(&network, &x));
    let on_a_line: Vec<f64> = (0..3000).map(|i| f64::from(i / 3) * 1e-3).collect();
    check(&network, &on_a_line, &logits(&network, &on_a_line));
    let one_place = [0.1, 0.2, 0.3].repeat(1000);
    check(&network, &one_place, &logits(&network, &one_place));
}

#[test]
fn points_outside_of_the_box_and_far_away_are_right() {
    let network = trained(3, 300, 6);
    for far in [3.0, 1e3, 1e6, 1e12, 1e25] {
        // A few stray points, all points, and two clusters.
        for stray in [97, 1, 2] {
            let mut x = uniform(2000, 3, 1);
            for (i, x) in x.chunks_mut(3).enumerate() {
                if i % stray == 0 {
                    x.iter_mut().for_each(|x| *x = if stray == 2 { *x + far } else { *x * far });
                }
            }
            check(&network, &x, &logits(&network, &x));
        }
    }
}

#[test]
fn points_beyond_single_precision_have_finite_logits() {
    let network = trained(2, 100, 4);
    let mut x = uniform(500, 2, 1);
    (x[0], x[101]) = (1e300, -1e200);
    assert!(logits(&network, &x).iter().all(|l| l.is_finite()));
}

#[test]
fn every_instruction_set_of_this_machine_is_right() {
    for dim in [1, 3] {
        let network = trained(dim, 300, 11);
        let x = uniform(3000, dim, 1);
        for simd in Simd::all() {
            check(&network, &x, &logits_on(simd, &network, &x));
        }
    }
}

#[cfg(feature = "threads")]
#[test]
fn gives_the_same_bits_for_any_number_of_threads() {
    let network = trained(3, 300, 6);
    let x = uniform(20_000, 3, 1);
    let [one, three] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| logits(&network, &x))
    });
    assert_eq!(one, three);
    assert_eq!(one, logits(&network, &x));
}

#[test]
fn logits_in_the_order_of_the_tree_are_the_same_ones() {
    let network = trained(3, 300, 6);
    let tree = tree(&network, &uniform(3000, 3, 1));
    let given = network.logits_of_tree(&tree, &mut |_| true).unwrap();
    let mut ordered = vec![f32::NAN; 3000 * 6];
    network.write_logits_of_tree(&tree, Order::Tree, &mut ordered, &mut |_| true).unwrap();
    for (row, index) in ordered.chunks(6).zip(tree.order()) {
        assert_eq!(row, &given[6 * index..][..6]);
    }
}

#[test]
fn permuted_points_have_permuted_logits() {
    let network = trained(3, 300, 6);
    let x = uniform(3000, 3, 1);
    let reversed: Vec<f64> = x.rchunks(3).flatten().copied().collect();
    let (a, b) = (logits(&network, &x), logits(&network, &reversed));
    for (a, b) in a.chunks(6).zip(b.rchunks(6)).flat_map(|(a, b)| a.iter().zip(b)) {
        assert!((a - b).abs() < 2e-5, "{a} {b}");
    }
}

#[test]
fn reports_progress_and_stops_when_asked() {
    let network = untrained(3, 300, 6);
    let tree = tree(&network, &uniform(20_000, 3, 1));
    let mut told = Vec::new();
    network
        .logits_of_tree(&tree, &mut |done| {
            told.push(done);
            true
        })
        .unwrap();
    assert!(told.windows(2).all(|pair| pair[0] <= pair[1]), "{told:?}");
    assert_eq!((told[0], told[told.len() - 1]), (0.0, 1.0));
    for stop_at in 1..=told.len().min(3) {
        let mut calls = 0;
        let stopped = network.logits_of_tree(&tree, &mut |_| {
            calls += 1;
            calls < stop_at
        });
        assert_eq!(stopped, Err(Error::Cancelled), "at report {stop_at}");
    }
}

#[test]
fn fourier_features_and_a_tree_go_together() {
    let mut random = Random::new(5);
    let frequencies = random.frequencies(2, 0.7);
    let layers = [random.layer(66, 40), random.layer(40, 40), random.layer(40, 3)];
    let network = Network::new(2, Frame::IDENTITY, frequencies, layers).unwrap();
    let x = uniform(500, 2, 1);
    check(&network, &x, &network.logits_of_tree(&tree(&network, &x), &mut |_| true).unwrap());
}

#[test]
fn refuses_a_tree_in_another_frame_and_memory_of_another_size() {
    let network = untrained(3, 10, 2);
    let x = uniform(10, 3, 1);
    let other = PointTree::new(&x, 3, Frame::IDENTITY, &mut |_| true).unwrap();
    let error = network.logits_of_tree(&other, &mut |_| true).unwrap_err();
    assert!(error.to_string().contains("frame"), "{error}");
    let error = network
        .write_logits_of_tree(&tree(&network, &x), Order::Given, &mut [0.0; 19], &mut |_| true)
        .unwrap_err();
    assert!(error.to_string().contains("10 x 2"), "{error}");
}
