//! Each product of the middle layer against its formula in double precision, on every instruction set.

use super::*;
use proptest::prelude::*;

fn numbers(count: usize, seed: f32) -> Vec<f32> {
    (0..count).map(|i| (i as f32 * 0.7 + seed).sin()).collect()
}

fn hidden(inputs: usize, outputs: usize) -> (Hidden, Layer) {
    let layer = Layer { weight: numbers(inputs * outputs, 0.3), bias: vec![0.0; outputs] };
    (Hidden::new(&layer, (0..inputs).collect()), layer)
}

fn lanes(values: &[f32], m: usize) -> Activations {
    Activations::of(values, m, &(0..values.len() / m).collect::<Vec<_>>())
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
    fn products_agree_with_their_formulas(inputs in 1usize..70, outputs in 1usize..300, m in 1usize..14) {
        let (hidden, layer) = hidden(inputs, outputs);
        let x = numbers(inputs * m, 1.0);
        let z = hidden.forward(&lanes(&x, m), m);
        close(&z, &naive_product(&layer.weight, &x, inputs, m), 1e-4);

        let error = numbers(outputs * m, 2.0);
        let transposed: Vec<f32> = (0..inputs * outputs).map(|at| layer.weight[at % outputs * inputs + at / outputs]).collect();
        let back = hidden.backward(&error, m);
        close(&back, &naive_product(&transposed, &error, outputs, m), 3e-4);
    }

    #[test]
    fn an_update_is_adam_on_the_gradient_and_the_product_that_of_the_new_weights(
        inputs in 1usize..70, outputs in 1usize..300, m in 1usize..14, asleep in 1usize..9,
    ) {
        let (mut hidden, mut layer) = hidden(inputs, outputs);
        let (x, next) = (numbers(inputs * m, 1.0), numbers(inputs * m, 4.0));
        let mut error = numbers(outputs * m, 2.0);
        error.chunks_exact_mut(m).step_by(asleep).for_each(|row| row.fill(0.0));
        let mut expected: Vec<f64> = layer.weight.iter().map(|w| f64::from(*w)).collect();
        let (mut first, mut second) = (vec![0.0; expected.len()], vec![0.0; expected.len()]);
        for step in 1..=3 {
            let z = hidden.update_and_forward(
                &error, &lanes(&x, m), &lanes(&next, m), m, Rates::new(1e-2, step),
            );
            for (at, w) in expected.iter_mut().enumerate() {
                let (r, c) = (at / inputs, at % inputs);
                let g: f64 = (0..m).map(|i| f64::from(error[r * m + i]) * f64::from(x[c * m + i])).sum();
                first[at] = 0.9 * first[at] + 0.1 * g;
                second[at] = 0.999 * second[at] + 0.001 * g * g;
                let (mean, square): (f64, f64) = (first[at] / (1.0 - 0.9f64.powi(step)), second[at] / (1.0 - 0.999f64.powi(step)));
                *w -= 1e-2 * mean / (square.sqrt() + 1e-8);
            }
            hidden.store(&mut layer);
            // A gradient that cancels to nothing makes Adam's quotient arbitrary; the errors here do not reach that far.
            close(&layer.weight, &expected, 2e-4);
            close(&z, &naive_product(&layer.weight, &next, inputs, m), 1e-4);
        }
    }
}

#[test]
fn a_row_that_never_had_an_error_does_not_change_by_a_bit() {
    let (mut hidden, before) = hidden(40, 5);
    let mut after = before.clone();
    let mut error = numbers(15, 1.0);
    error[6..9].fill(0.0);
    let x = lanes(&numbers(120, 2.0), 3);
    hidden.update_and_forward(&error, &x, &x, 3, Rates::new(1e-3, 1));
    hidden.store(&mut after);
    assert_eq!(before.weight[80..120], after.weight[80..120]);
    assert!(before.weight[..80].iter().zip(&after.weight).all(|(a, b)| a != b));
}

#[test]
fn inputs_that_never_fire_are_left_out_and_their_weights_kept() {
    let (m, inputs) = (3, 40);
    let layer = Layer { weight: numbers(inputs * 20, 0.3), bias: vec![0.0; 20] };
    let mut x = numbers(inputs * m, 1.0);
    x.chunks_exact_mut(m).step_by(2).for_each(|neuron| neuron.fill(0.0));
    let firing: Vec<usize> = (1..inputs).step_by(2).collect();
    let mut hidden = Hidden::new(&layer, firing.clone());
    let input = Activations::of(&x, m, &firing);
    close(&hidden.forward(&input, m), &naive_product(&layer.weight, &x, inputs, m), 1e-4);

    let error = numbers(20 * m, 2.0);
    let z = hidden.update_and_forward(&error, &input, &input, m, Rates::new(1e-2, 1));
    let mut after = layer.clone();
    hidden.store(&mut after);
    close(&z, &naive_product(&after.weight, &x, inputs, m), 1e-4);
    for (at, (before, after)) in layer.weight.iter().zip(&after.weight).enumerate() {
        assert_eq!(before == after, at % inputs % 2 == 0, "{at}");
    }
}

#[test]
fn a_layer_of_which_no_input_fires_gives_zeros() {
    let layer = Layer { weight: numbers(40, 0.3), bias: vec![0.0; 5] };
    let mut hidden = Hidden::new(&layer, Vec::new());
    let none = Activations::of(&numbers(16, 0.0), 2, &[]);
    assert_eq!(hidden.forward(&none, 2), [0.0; 10]);
    assert!(hidden.backward(&numbers(10, 1.0), 2).is_empty());
    assert_eq!(hidden.update_and_forward(&numbers(10, 1.0), &none, &none, 2, Rates::new(1e-2, 1)), [0.0; 10]);
}
