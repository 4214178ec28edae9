//! Against plain arithmetic, on every instruction set of this machine.

use super::super::{multiversion, Lanes, Simd};
use super::*;

/// Every operation, on the first lanes of `a` and `b`.
#[inline(always)]
fn all_body<L: Lanes>(a: &[f64], b: &[f64]) -> (usize, Vec<[f64; WIDEST]>) {
    type D<L> = <L as Lanes>::Doubles;
    let (x, y) = (D::<L>::load(a), D::<L>::load(b));
    let half = D::<L>::splat(0.5);
    let column: Vec<f64> = (0..48).map(|i| f64::from(i).sqrt()).collect();
    let index: [f32; WIDEST] = std::array::from_fn(|l| f32::from_bits(5 * l as u32));
    let singles: [f32; WIDEST] = std::array::from_fn(|l| a[l] as f32);
    let both = D::<L>::and(x.less(y), half.less(y));
    let results = [
        x.add(y),
        x.sub(y),
        x.mul(y),
        x.mul_add(y, half),
        x.mul_sub_from(y, half),
        y.inverse(),
        y.sqrt(),
        D::<L>::select(both, x, y),
        D::<L>::look_up(&column, &index),
        D::<L>::load_singles(&singles),
    ];
    let store = |lanes: D<L>| {
        let mut to = [0.0; WIDEST];
        lanes.store(&mut to);
        to
    };
    assert!(D::<L>::all(x.less(x.add(y))) && !D::<L>::all(x.less(y)));
    (D::<L>::WIDTH, results.map(store).to_vec())
}
multiversion! { fn all(a: &[f64], b: &[f64]) -> (usize, Vec<[f64; WIDEST]>) = all_body }

#[inline(always)]
fn points_body<L: Lanes>(from: &[f64], to: &mut [f64]) -> (usize, [[f64; WIDEST]; 3]) {
    let points = L::Doubles::load_points(from);
    L::Doubles::store_points(points, to);
    let mut lanes = [[0.0; WIDEST]; 3];
    for (lanes, coordinates) in lanes.iter_mut().zip(points) {
        coordinates.store(lanes);
    }
    (L::Doubles::WIDTH, lanes)
}
multiversion! { fn points(from: &[f64], to: &mut [f64]) -> (usize, [[f64; WIDEST]; 3]) = points_body }

#[test]
fn every_instruction_set_of_this_machine_gives_the_same_answers() {
    let a: [f64; WIDEST] = std::array::from_fn(|i| 1.5 - (i as f64 * 0.7).cos());
    let b: [f64; WIDEST] = std::array::from_fn(|i| (i as f64 * 1.3 + 1.0).cos() + 1.2);
    for simd in Simd::all() {
        let (width, results) = all(simd, &a, &b);
        for i in 0..width {
            let (a, b) = (a[i], b[i]);
            let expected = [
                a + b,
                a - b,
                a * b,
                a * b + 0.5,
                0.5 - a * b,
                1.0 / b,
                b.sqrt(),
                if a < b && 0.5 < b { a } else { b },
                (5.0 * i as f64).sqrt(),
                f64::from(a as f32),
            ];
            for (k, (result, expected)) in results.iter().zip(expected).enumerate() {
                assert!(
                    (result[i] - expected).abs() <= 4e-16 * expected.abs().max(1.0),
                    "{simd:?}, {k}, lane {i}"
                );
            }
        }
    }
}

#[test]
fn points_are_taken_apart_and_put_together() {
    let from: [f64; 24] = std::array::from_fn(|i| i as f64);
    for simd in Simd::all() {
        let mut to = [0.0; 24];
        let (width, lanes) = points(simd, &from, &mut to);
        for lane in 0..width {
            for c in 0..3 {
                assert_eq!(lanes[c][lane], from[3 * lane + c], "{simd:?}");
            }
        }
        assert_eq!(to[..3 * width], from[..3 * width], "{simd:?}");
    }
}
