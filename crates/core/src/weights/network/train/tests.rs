//! Training against a naive version in double precision, its stopping rule, determinism, refusals.

use super::*;

const P: [f64; 12] = [-0.8, -0.9, 0.1, 0.7, -0.8, 0.2, -0.6, 0.9, -0.3, 0.5, 0.4, 0.9];

fn small() -> Training {
    Training { width: 48, ..Training::default() }
}

fn fit_with(training: &Training) -> Trained {
    fit(&P, None, 3, Frame::IDENTITY, training, &mut |_| true).unwrap()
}

/// Parameters of one layer in double precision, with Adam's moments: weight rows with the bias as the last column.
struct Naive {
    rows: Vec<Vec<f64>>,
    first: Vec<Vec<f64>>,
    second: Vec<Vec<f64>>,
}

impl Naive {
    fn new(layer: &Layer) -> Naive {
        let rows: Vec<Vec<f64>> = layer
            .weight
            .chunks(layer.inputs())
            .zip(&layer.bias)
            .map(|(w, b)| w.iter().chain([b]).map(|v| f64::from(*v)).collect())
            .collect();
        let zeros: Vec<Vec<f64>> = rows.iter().map(|r| vec![0.0; r.len()]).collect();
        Naive { rows, first: zeros.clone(), second: zeros }
    }

    fn forward(&self, input: &[f64]) -> Vec<f64> {
        self.rows
            .iter()
            .map(|row| row.iter().zip(input.iter().chain([&1.0])).map(|(w, x)| w * x).sum())
            .collect()
    }

    /// Adam on the gradient that each (error, input) pair contributes to.
    fn update(&mut self, pairs: &[(Vec<f64>, Vec<f64>)], rate: f64, t: i32) {
        for (r, row) in self.rows.iter_mut().enumerate() {
            for (c, parameter) in row.iter_mut().enumerate() {
                let g: f64 = pairs.iter().map(|(e, x)| e[r] * x.get(c).copied().unwrap_or(1.0)).sum();
                self.first[r][c] = 0.9 * self.first[r][c] + 0.1 * g;
                self.second[r][c] = 0.999 * self.second[r][c] + 0.001 * g * g;
                let (m, v) =
                    (self.first[r][c] / (1.0 - 0.9f64.powi(t)), self.second[r][c] / (1.0 - 0.999f64.powi(t)));
                *parameter -= rate * m / (v.sqrt() + 1e-8);
            }
        }
    }
}

fn naive_losses(network: &Network, steps: usize) -> Vec<f64> {
    let mut layers: Vec<Naive> = network.layers().iter().map(Naive::new).collect();
    let m = P.len() / 3;
    let mut losses = Vec::new();
    for step in 0..steps {
        let mut pairs: [Vec<(Vec<f64>, Vec<f64>)>; 3] = Default::default();
        let mut loss = 0.0;
        for (i, x) in P.chunks(3).enumerate() {
            let relu = |v: Vec<f64>| -> Vec<f64> { v.into_iter().map(|v| v.max(0.0)).collect() };
            let first = relu(layers[0].forward(x));
            let second = relu(layers[1].forward(&first));
            let logits = layers[2].forward(&second);
            let total: f64 = logits.iter().map(|l| l.exp()).sum();
            loss += (total.ln() - logits[i]) / m as f64;
            let mut error: Vec<f64> = logits.iter().map(|l| l.exp() / total / m as f64).collect();
            error[i] -= 1.0 / m as f64;
            for (index, input) in [(2, second), (1, first), (0, x.to_vec())] {
                let back = |c: usize| -> f64 {
                    error.iter().zip(&layers[index].rows).map(|(e, row)| e * row[c]).sum()
                };
                let passed: Vec<f64> =
                    (0..input.len()).map(|c| if input[c] > 0.0 { back(c) } else { 0.0 }).collect();
                pairs[index].push((std::mem::replace(&mut error, passed), input));
            }
        }
        losses.push(loss);
        let rate = if step < steps * 4 / 5 { 6e-4 } else { 6e-5 };
        for (layer, pairs) in layers.iter_mut().zip(&pairs) {
            layer.update(pairs, rate, step as i32 + 1);
        }
    }
    losses
}

#[test]
fn losses_agree_with_the_naive_version() {
    let training = Training { schedule: Schedule::Fixed(30), ..small() };
    let mut random = Random::new(3);
    let layers = [random.layer(3, 48), random.layer(48, 48), random.layer(48, 4)];
    let network = Network::new(3, Frame::IDENTITY, Vec::new(), layers).unwrap();
    let expected = naive_losses(&network, 30);
    let fit = train(network, &P, training.schedule, training.rate, &mut |_| true).unwrap();
    assert_eq!(fit.losses.len(), 30);
    for (a, b) in fit.losses.iter().zip(expected) {
        assert!((a - b).abs() < 2e-6, "{a} {b}");
    }
}

#[test]
fn trains_until_every_control_point_owns_its_place() {
    let fit = fit_with(&small());
    let logits = fit.network.logits(&P, &mut |_| true).unwrap();
    for (i, row) in logits.chunks(4).enumerate() {
        let mut w = [0.0; 4];
        crate::softmax::weights(row, 1.0, &mut w);
        assert!(w[i] >= 0.9, "{w:?}");
    }
    assert!(fit.losses.len() < 2000 && fit.loss < 0.105, "{} steps, loss {}", fit.losses.len(), fit.loss);
}

#[test]
fn a_fixed_schedule_trains_exactly_so_many_steps() {
    let fit = fit_with(&Training { schedule: Schedule::Fixed(7), ..small() });
    assert_eq!(fit.losses.len(), 7);
    assert!(fit.loss < fit.losses[0]);
}

#[test]
fn the_order_of_the_control_points_changes_the_order_of_the_outputs_alone() {
    let training = Training { schedule: Schedule::Fixed(20), ..small() };
    let reversed: Vec<f64> = P.chunks(3).rev().flatten().copied().collect();
    let there = fit_with(&training).network.logits(&P, &mut |_| true).unwrap();
    let back = fit(&reversed, None, 3, Frame::IDENTITY, &training, &mut |_| true).unwrap();
    let back = back.network.logits(&P, &mut |_| true).unwrap();
    for (a, b) in there.chunks(4).zip(back.chunks(4)) {
        assert!(a.iter().eq(b.iter().rev()), "{a:?} {b:?}");
    }
}

#[test]
fn one_seed_gives_one_network_whatever_the_number_of_threads() {
    let here = fit_with(&Training { width: 300, ..small() });
    #[cfg(feature = "threads")]
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(|| fit_with(&Training { width: 300, ..small() })), here, "{threads} threads");
    }
    assert_ne!(fit_with(&Training { width: 300, seed: 1, ..small() }), here);
}

#[test]
fn one_control_point_needs_no_training() {
    let fit = fit(&[1.0, 2.0], None, 2, Frame::IDENTITY, &small(), &mut |_| true).unwrap();
    assert_eq!((fit.losses.len(), fit.loss), (0, 0.0));
}

#[test]
fn fourier_features_train_too() {
    let fit = fit_with(&Training { fourier_sigma: Some(0.5), ..small() });
    assert_eq!(fit.network.frequencies().len(), 96);
    assert!(fit.loss < 0.105);
}

#[test]
fn refuses_what_cannot_be_trained() {
    let says = |p: &[f64], training: &Training| {
        fit(p, None, 3, Frame::IDENTITY, training, &mut |_| true).unwrap_err().to_string()
    };
    assert!(says(&[], &small()).contains("found 0"));
    assert!(says(&vec![0.5; 3003], &small()).contains("found 1001"));
    assert!(says(&[1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0], &small()).contains("0 and 2"));
    assert!(says(&P, &Training { width: 0, ..small() }).starts_with("width"));
    assert!(says(&P, &Training { rate: -1.0, ..small() }).starts_with("rate"));
    assert!(says(&P, &Training { schedule: Schedule::Fixed(0), ..small() }).starts_with("steps"));
    assert!(says(&P, &Training { fourier_sigma: Some(0.0), ..small() }).starts_with("fourier_sigma"));
}

#[test]
fn stops_when_asked() {
    let mut calls = 0;
    let result = fit(&P, None, 3, Frame::IDENTITY, &small(), &mut |_| {
        calls += 1;
        calls < 5
    });
    assert_eq!((result, calls), (Err(Error::Cancelled), 5));
}

#[test]
fn samples_are_given_their_labels_whatever_the_number_of_threads() {
    let x: Vec<f64> = (0..60).flat_map(|i| [f64::from(i) / 30.0 - 1.0, 0.0]).collect();
    let labels: Vec<f32> =
        x.chunks(2).flat_map(|x| [(0.5 - 0.4 * x[0]) as f32, (0.5 + 0.4 * x[0]) as f32]).collect();
    let p = [-1.0, 1.0, 1.0, 1.0];
    let training = Training { width: 64, schedule: Schedule::Cosine(400), rate: 5e-3, ..Training::default() };
    let teach = || {
        let samples = Samples { x: &x, labels: &labels, spread: labels.len() / 2, batch: 16 };
        fit(&p, Some(samples), 2, Frame::IDENTITY, &training, &mut |_| true).unwrap()
    };
    let here = teach();
    let logits = here.network.logits(&x, &mut |_| true).unwrap();
    for (row, labels) in logits.chunks(2).zip(labels.chunks(2)) {
        let mut w = [0.0; 2];
        crate::softmax::weights(row, 1.0, &mut w);
        assert!((w[0] - f64::from(labels[0])).abs() < 0.05, "{w:?} {labels:?}");
    }
    #[cfg(feature = "threads")]
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(teach), here, "{threads} threads");
    }
}

#[test]
fn what_is_not_looked_at_in_turn_is_learned_where_the_rest_does_not_say_it() {
    let x: Vec<f64> = (0..60).flat_map(|i| [f64::from(i) / 30.0 - 1.0, 0.0]).collect();
    let labels: Vec<f32> =
        x.chunks(2).flat_map(|x| if x[0] < 0.3 { [0.05, 0.95] } else { [0.95, 0.05] }).collect();
    let training = Training { width: 64, schedule: Schedule::Cosine(400), rate: 5e-3, ..Training::default() };
    let teach = |count: usize| {
        let samples = Samples { x: &x[..2 * count], labels: &labels[..2 * count], spread: 39, batch: 16 };
        fit(&[-1.0, 1.0, 1.0, 1.0], Some(samples), 2, Frame::IDENTITY, &training, &mut |_| true).unwrap()
    };
    let follows = |trained: &Trained| {
        let logits = trained.network.logits(&x, &mut |_| true).unwrap();
        logits.chunks(2).skip(42).filter(|row| row[0] > row[1]).count()
    };
    assert_eq!((follows(&teach(39)), follows(&teach(60))), (0, 18));
    #[cfg(feature = "threads")]
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(|| teach(60)), teach(60), "{threads} threads");
    }
}

/// Points on a spiral, of which two are a hundred times closer together than the others.
fn many() -> Vec<f64> {
    let place = |t: f64| [0.1 * t.sqrt() * t.sin(), 0.1 * t.sqrt() * t.cos(), 0.2 * (0.7 * t).sin()];
    (0..69).map(f64::from).chain([30.01]).flat_map(place).collect()
}

#[test]
fn many_control_points_own_their_places_without_a_step() {
    let training = Training { width: 256, ..Training::default() };
    let teach = || fit(&many(), None, 3, Frame::IDENTITY, &training, &mut |_| true).unwrap();
    let here = teach();
    assert!(here.losses.is_empty() && here.loss < SMALL_LOSS, "{} steps", here.losses.len());
    let logits = here.network.logits(&many(), &mut |_| true).unwrap();
    for (i, row) in logits.chunks(70).enumerate() {
        let mut w = [0.0; 70];
        crate::softmax::weights(row, 1.0, &mut w);
        assert!(w[i] >= 0.9, "{i}: {}", w[i]);
    }
    #[cfg(feature = "threads")]
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(teach), here, "{threads} threads");
    }
}

#[test]
fn a_layer_too_narrow_for_its_control_points_is_trained_from_there() {
    let schedule = Schedule::UntilSmall { at_most: 20 };
    let training = Training { width: 24, schedule, ..Training::default() };
    let fit = fit(&many(), None, 3, Frame::IDENTITY, &training, &mut |_| true).unwrap();
    assert!(!fit.losses.is_empty() && fit.loss < fit.losses[0], "{:?} {}", fit.losses, fit.loss);
}

#[test]
fn a_number_of_steps_begins_at_random_whatever_the_number_of_control_points() {
    let training = Training { schedule: Schedule::Fixed(1), ..small() };
    let fit = fit(&many(), None, 3, Frame::IDENTITY, &training, &mut |_| true).unwrap();
    assert!((fit.losses[0] - 70f64.ln()).abs() < 0.1, "{}", fit.losses[0]);
}
