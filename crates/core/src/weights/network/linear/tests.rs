//! Each product of a linear layer against its formula in double precision, on the instruction set that was detected.

use super::super::adam::{BETA_2, BETA_2_IN_BATCHES};
use super::*;
use proptest::prelude::*;

fn numbers(count: usize, seed: f32) -> Vec<f32> {
    (0..count).map(|i| (i as f32 * 0.7 + seed).sin()).collect()
}

/// A layer with all of its inputs, and its rows from the last to the first.
fn linear(inputs: usize, outputs: usize, rectified: bool) -> (Linear, Layer) {
    let layer = Layer { weight: numbers(inputs * outputs, 0.3), bias: numbers(outputs, 5.0) };
    (Linear::new(&layer, (0..inputs).collect(), (0..outputs).rev().collect(), rectified), layer)
}

/// Some neurons of `values`, which is neurons x m, in lanes.
fn some(values: &[f32], m: usize, neurons: impl IntoIterator<Item = usize>) -> Activations {
    let neurons: Vec<usize> = neurons.into_iter().collect();
    let mut result = Activations::zeros(neurons.len(), m);
    for (at, neuron) in neurons.iter().enumerate() {
        let mut values = values[neuron * m..].iter();
        result.row_mut(at, |value| *value = *values.next().expect("m of them"));
    }
    result.push_one(neurons.len());
    result
}

fn all(values: &[f32], m: usize) -> Activations {
    some(values, m, 0..values.len() / m)
}

/// Errors of all outputs in the order of the rows; there is none of a bias's input.
fn reversed(values: &[f32], m: usize) -> Activations {
    let count = values.len() / m;
    let mut errors = some(values, m, (0..count).rev());
    errors.row_mut(count, |value| *value = 0.0);
    errors
}

/// The first `count` neurons, neurons x m.
fn flat(values: &Activations, count: usize) -> Vec<f32> {
    (0..count).flat_map(|neuron| values.row(neuron)).collect()
}

/// `W x + b`.
fn naive_forward(layer: &Layer, x: &[f32], m: usize) -> Vec<f64> {
    let z = naive_product(&layer.weight, x, layer.inputs(), m);
    z.iter().enumerate().map(|(at, z)| z + f64::from(layer.bias[at / m])).collect()
}

/// Rows of m numbers from the last to the first.
fn from_last(values: &[f64], m: usize) -> Vec<f64> {
    values.chunks(m).rev().flatten().copied().collect()
}

/// `out[r][i] = sum_c w[r][c] x[c][i]`.
fn naive_product(w: &[f32], x: &[f32], inputs: usize, m: usize) -> Vec<f64> {
    let outputs = w.len() / inputs;
    let sum = |r: usize, i: usize| {
        (0..inputs).map(|c| f64::from(w[r * inputs + c]) * f64::from(x[c * m + i])).sum()
    };
    (0..outputs * m).map(|at| sum(at / m, at % m)).collect()
}

fn close(a: &[f32], b: &[f64], tolerance: f64) {
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(b) {
        assert!((f64::from(*a) - b).abs() <= tolerance, "{a} {b}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn products_agree_with_their_formulas(
        inputs in 1usize..70, outputs in 1usize..300, m in 1usize..14, rectified: bool,
    ) {
        let (linear, layer) = linear(inputs, outputs, rectified);
        let x = numbers(inputs * m, 1.0);
        let z = linear.forward(&all(&x, m));
        let mut expected = from_last(&naive_forward(&layer, &x, m), m);
        if rectified {
            expected.iter_mut().for_each(|z| *z = z.max(0.0));
        }
        close(&flat(&z, outputs), &expected, 1e-4);
        assert!(z.row(outputs).all(|one| one == 1.0));

        let error = numbers(outputs * m, 2.0);
        let transposed: Vec<f32> = (0..inputs * outputs).map(|at| layer.weight[at % outputs * inputs + at / outputs]).collect();
        let back = linear.backward(&reversed(&error, m), &all(&x, m));
        let mut expected = naive_product(&transposed, &error, outputs, m);
        expected.iter_mut().zip(&x).for_each(|(sum, x)| *sum = if *x > 0.0 { *sum } else { 0.0 });
        close(&flat(&back, inputs), &expected, 3e-4);
        assert!(back.row(inputs).all(|bias| bias == 0.0));
    }

    #[test]
    fn an_update_is_adam_on_the_gradient_and_the_product_that_of_the_new_weights(
        inputs in 1usize..70, outputs in 1usize..300, m in 1usize..14, n in 1usize..14, asleep in 1usize..20, batches: bool,
    ) {
        let (mut linear, mut layer) = linear(inputs, outputs, false);
        let (x, next) = (numbers(inputs * m, 1.0), numbers(inputs * n, 4.0));
        let kept = if batches { BETA_2_IN_BATCHES } else { BETA_2 };
        let mut error = numbers(outputs * m, 2.0);
        error.chunks_mut(m * asleep).step_by(2).for_each(|rows| rows.fill(0.0));
        let parameter = |layer: &Layer, r: usize, c: usize| if c < inputs { layer.weight[r * inputs + c] } else { layer.bias[r] };
        let places: Vec<(usize, usize)> = (0..outputs * (inputs + 1)).map(|at| (at / (inputs + 1), at % (inputs + 1))).collect();
        let mut expected: Vec<f64> = places.iter().map(|(r, c)| f64::from(parameter(&layer, *r, *c))).collect();
        let (mut first, mut second) = (vec![0.0; expected.len()], vec![0.0; expected.len()]);
        for step in 1..=3 {
            let z = linear.update_and_forward(&reversed(&error, m), &all(&x, m), &all(&next, n), Rates::new(1e-2, step, kept));
            for (at, (r, c)) in places.iter().enumerate() {
                let x = |i: usize| if *c < inputs { f64::from(x[c * m + i]) } else { 1.0 };
                let g: f64 = (0..m).map(|i| f64::from(error[r * m + i]) * x(i)).sum();
                first[at] = 0.9 * first[at] + 0.1 * g;
                second[at] = kept * second[at] + (1.0 - kept) * g * g;
                let (mean, square): (f64, f64) = (first[at] / (1.0 - 0.9f64.powi(step)), second[at] / (1.0 - kept.powi(step)));
                expected[at] -= 1e-2 * mean / (square.sqrt() + 1e-8);
            }
            linear.store(&mut layer);
            // A gradient that cancels to nothing makes Adam's quotient arbitrary; the errors here do not reach that far.
            let found: Vec<f32> = places.iter().map(|(r, c)| parameter(&layer, *r, *c)).collect();
            close(&found, &expected, 2e-4);
            close(&flat(&z, outputs), &from_last(&naive_forward(&layer, &next, n), n), 1e-4);
        }
    }
}

#[test]
fn rows_that_never_had_an_error_do_not_change_by_a_bit() {
    let (mut linear, before) = linear(40, 30, true);
    let mut after = before.clone();
    let mut error = numbers(90, 1.0);
    // Of one row among seven others, and of eight that are skipped.
    error[6..9].fill(0.0);
    error[14 * 3..22 * 3].fill(0.0);
    let x = all(&numbers(120, 2.0), 3);
    for step in 1..=3 {
        linear.update_and_forward(&reversed(&error, 3), &x, &x, Rates::new(1e-3, step, BETA_2));
    }
    linear.store(&mut after);
    for (r, (before, after)) in before.weight.chunks(40).zip(after.weight.chunks(40)).enumerate() {
        let asleep = r == 2 || (14..22).contains(&r);
        assert!(before.iter().zip(after).all(|(before, after)| (before == after) == asleep), "row {r}");
    }
}

#[test]
fn moments_without_gradients_decay_to_nothing_and_no_further() {
    let (mut linear, _) = linear(20, 8, false);
    let (error, none) = (reversed(&numbers(24, 1.0), 3), Activations::zeros(9, 3));
    let x = all(&numbers(60, 2.0), 3);
    for step in 1..=1000 {
        linear.update_and_forward(
            if step == 1 { &error } else { &none },
            &x,
            &x,
            Rates::new(1e-3, step, BETA_2),
        );
    }
    let slow = |value: &f32| *value != 0.0 && value.abs() < f32::MIN_POSITIVE;
    assert!(!linear.state.iter().any(|lanes| lanes.0.iter().any(slow)));
}

#[test]
fn inputs_that_never_fire_are_left_out_and_their_weights_kept() {
    let (m, inputs) = (3, 40);
    let layer = Layer { weight: numbers(inputs * 20, 0.3), bias: numbers(20, 5.0) };
    let mut x = numbers(inputs * m, 1.0);
    x.chunks_exact_mut(m).step_by(2).for_each(|neuron| neuron.fill(0.0));
    let firing: Vec<usize> = (1..inputs).step_by(2).collect();
    let mut linear = Linear::new(&layer, firing.clone(), (0..20).collect(), false);
    let input = some(&x, m, firing);
    close(&flat(&linear.forward(&input), 20), &naive_forward(&layer, &x, m), 1e-4);

    let error = some(&numbers(20 * m, 2.0), m, 0..20);
    let z = linear.update_and_forward(&error, &input, &input, Rates::new(1e-2, 1, BETA_2));
    let mut after = layer.clone();
    linear.store(&mut after);
    close(&flat(&z, 20), &naive_forward(&after, &x, m), 1e-4);
    for (at, (before, after)) in layer.weight.iter().zip(&after.weight).enumerate() {
        assert_eq!(before == after, at % inputs % 2 == 0, "{at}");
    }
}

#[test]
fn a_layer_of_which_no_input_fires_has_biases_alone() {
    let layer = Layer { weight: numbers(40, 0.3), bias: numbers(5, 1.0) };
    let mut linear = Linear::new(&layer, Vec::new(), (0..5).collect(), false);
    let none = some(&[], 2, []);
    let biases: Vec<f32> = layer.bias.iter().flat_map(|b| [*b, *b]).collect();
    assert_eq!(flat(&linear.forward(&none), 5), biases);
    let error = all(&numbers(10, 1.0), 2);
    assert!(linear.backward(&error, &none).lanes.iter().all(|lanes| lanes.0 == [0.0; 16]));
    let z = linear.update_and_forward(&error, &none, &none, Rates::new(1e-2, 1, BETA_2));
    assert!(flat(&z, 5).iter().zip(&biases).all(|(after, before)| (after - before).abs() > 9e-3));
}

#[test]
fn every_instruction_set_gives_the_same_bits() {
    let (inputs, outputs, m) = (37, 61, 11);
    let (x, next, error) = (numbers(inputs * m, 1.0), numbers(inputs * m, 4.0), numbers(outputs * m, 2.0));
    let trained = |simd: Simd| {
        let mut linear = Linear { simd, ..linear(inputs, outputs, true).0 };
        let (error, x) = (reversed(&error, m), all(&x, m));
        let back = linear.backward(&error, &x);
        let rates = Rates::new(1e-2, 3, BETA_2);
        let z = linear.update_and_forward(&error, &x, &all(&next, m), rates);
        let bits = |values: Vec<f32>| values.into_iter().map(f32::to_bits).collect::<Vec<_>>();
        (bits(flat(&back, inputs)), bits(flat(&z, outputs)))
    };
    let all: Vec<_> = Simd::all().map(trained).collect();
    all.iter().for_each(|of_one| assert_eq!(*of_one, all[0]));
}
