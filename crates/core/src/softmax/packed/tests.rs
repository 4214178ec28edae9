//! Against the double-precision weights, on every instruction set of this machine.

use super::*;
use crate::softmax::{relative_weights, Dominant};
use proptest::prelude::*;

fn unpacked(rows: &[Row], lane: usize) -> (Vec<f64>, f64, usize) {
    let m = rows.len() - MORE;
    let relative = rows[..m].iter().map(|row| f64::from(row.0[lane])).collect();
    let second = f64::from(rows[m].0[lane]) + f64::from(rows[m + 1].0[lane]);
    (relative, second, rows[m + 2].0[lane].to_bits() as usize)
}

/// Every lane of `rows` against [`relative_weights`], to `tolerance` of each weight.
fn check(logits: &[f32], m: usize, temperature: f64, tolerance: f64, rows: &[Row]) {
    let mut expected = vec![0.0; m];
    for (lane, logits) in logits.chunks_exact(m).enumerate() {
        let Dominant { index, second } = relative_weights(logits, temperature, &mut expected);
        let (relative, packed_second, packed_index) = unpacked(rows, lane);
        assert_eq!(packed_index, index);
        let pairs = relative.iter().zip(&expected).chain([(&packed_second, &second)]);
        for (a, b) in pairs {
            // Below 2^-126 single precision has nothing to give.
            assert!((a - b).abs() <= tolerance * b + 2e-38, "{a} {b} at T = {temperature}");
        }
    }
}

fn check_all(logits: &[f32], m: usize, temperature: f64) {
    for simd in Simd::all() {
        let mut rows = vec![Row([f32::NAN; LANES]); m + MORE];
        pack(simd, logits, temperature, &mut rows);
        check(logits, m, temperature, 4e-7, &rows);
    }
}

proptest! {
    #[test]
    fn packed_weights_are_the_weights_in_single_precision(
        m in 1usize..40, seed in prop::collection::vec(-15f32..15.0, 16 * 40), t in 0.01f64..100.0,
    ) {
        check_all(&seed[..LANES * m], m, t);
    }

    #[test]
    fn the_exponential_is_right_to_its_last_digits(d in -80f32..0.0) {
        let scale = std::f64::consts::LOG2_E;
        for power in [exponential::<true>(d, 0.0, scale), exponential::<false>(d, 0.0, scale)] {
            prop_assert!((f64::from(power) / f64::from(d).exp() - 1.0).abs() < 1.5e-7);
        }
    }
}

#[test]
fn infinite_and_equal_logits_are_packed_as_weights() {
    let inf = f32::INFINITY;
    let rows = [
        [0.0, inf, 1.0],
        [inf, inf, 3.0],
        [-inf, -inf, -inf],
        [2.0, 2.0, 2.0],
        [-inf, 0.0, -inf],
        [0.0, 1e30, -1e30],
    ];
    let mut logits = [0.0; 3 * LANES];
    for (lane, row) in logits.chunks_exact_mut(3).enumerate() {
        row.copy_from_slice(&rows[lane % rows.len()]);
    }
    for t in [1e-300, 1e-30, 0.01, 1.0, 100.0, 1e300] {
        check_all(&logits, 3, t);
    }
}

#[test]
fn a_block_that_is_not_full_is_filled_with_nothing() {
    let logits: Vec<f32> = (0..3 * 21).map(|i| (i as f32).sin()).collect();
    let packed = PackedWeights::new(&logits, 3, 0.7, None).unwrap();
    let blocks: Vec<&[Row]> = packed.blocks(0).collect();
    assert_eq!(blocks.len(), 2);
    check(&logits[..3 * LANES], 3, 0.7, 3e-7, blocks[0]);
    check(&logits[3 * LANES..], 3, 0.7, 3e-7, blocks[1]);
    assert!(blocks[1].iter().all(|row| row.0[5..].iter().all(|v| *v == 0.0)));
    // The memory is used again, whatever was in it.
    let again =
        PackedWeights::new(&logits[..3], 3, 0.7, PackedWeights::new(&logits, 3, 9.0, None).ok()).unwrap();
    assert_eq!(again.blocks(0).count(), 1);
    assert!(again.rows.iter().all(|row| row.0[1..].iter().all(|v| *v == 0.0)));
}
