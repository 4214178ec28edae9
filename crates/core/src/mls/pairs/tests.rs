//! Against the twin, one point at a time in double precision, on every instruction set of this machine.

use super::super::matrix::{identity, norm};
use super::super::moments::Moments;
use super::super::{Handles, Local, Transform};
use super::*;
use crate::simd::loops;
use crate::softmax::relative_weights;
use std::sync::Arc;

const TEMPERATURES: [f64; 9] = [0.01, 0.02, 0.05, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0];
const POINTS: usize = CHUNK + 1000;

struct Given {
    x: Vec<[f64; 3]>,
    p: Vec<[f64; 3]>,
    logits: Vec<f32>,
    state: u64,
}

impl Given {
    /// Points whose logits are random, but so that there are a few pairs with many points.
    fn new(m: usize) -> Given {
        let mut given = Given { x: Vec::new(), p: Vec::new(), logits: Vec::new(), state: m as u64 };
        given.x = (0..POINTS).map(|_| given.anywhere()).collect();
        given.p = (0..m).map(|_| given.anywhere()).collect();
        for i in 0..POINTS {
            let logits: Vec<f32> =
                (0..m).map(|j| 15.0 * given.next() as f32 + ((i % 3 + j) % m) as f32).collect();
            given.logits.extend(logits);
        }
        given
    }

    /// In [-1, 1).
    fn next(&mut self) -> f64 {
        self.state =
            self.state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn anywhere(&mut self) -> [f64; 3] {
        std::array::from_fn(|_| self.next())
    }

    /// Where the control points go, each by `f` of its place and of noise in [-1, 1).
    fn moved(&mut self, f: impl Fn([f64; 3], [f64; 3]) -> [f64; 3]) -> Vec<[f64; 3]> {
        self.p.clone().into_iter().map(|p| f(p, self.anywhere())).collect()
    }

    /// Asserts that the sound points are where the twin has them, and that their maps are rotations, the twin's where C says enough;
    /// gives the share of the others.
    fn assert_close(&self, q: &[[f64; 3]], t: f64, position: f64, turn: f64) -> f64 {
        let m = self.p.len();
        let case = format!("{m} control points, T = {t}");
        let order = Order::new(&self.logits, &self.p).unwrap();
        let handles = Handles::new(&self.p, q, Transform::Rigid);
        let x = self.x.as_flattened();
        let points = Points { x, logits: &self.logits, p: &self.p, frame: Frame::IDENTITY, temperature: t };
        let kept = Weights::Kept(Arc::new(PairWeights::new(&order, points, None)));
        let twins: Vec<(Local<3>, f64)> = (self.x.iter().zip(self.logits.chunks(m)))
            .map(|(x, logits)| {
                let mut relative = vec![0.0; m];
                let dominant = relative_weights(logits, t, &mut relative);
                let moments = Moments::new(&self.p, q, &relative, dominant, None);
                (handles.deform(x, &relative, dominant), gap(&moments.pq))
            })
            .collect();
        let (mut left, mut all) = (0, 0);
        for simd in loops::all() {
            let mut frame = handles.pairs(&order, Frame::IDENTITY);
            frame.simd = simd;
            let (mut y, mut maps) = (vec![0.0; x.len()], vec![0.0; 3 * x.len()]);
            let mut unsound = Vec::new();
            let chunks = y.chunks_mut(3 * CHUNK).zip(maps.chunks_mut(9 * CHUNK)).enumerate();
            for (chunk, (y, maps)) in chunks {
                frame.deform(&kept, &mut ChunkOut { chunk, y, maps, rest: &mut unsound });
                let (mut again, mut rest) = (vec![0.0; y.len()], Vec::new());
                let out = &mut ChunkOut { chunk, y: &mut again, maps: &mut [], rest: &mut rest };
                frame.deform(&Weights::Passing(points), out);
                let same = again.iter().zip(&*y).all(|(a, b)| a == b || a.is_nan() && b.is_nan());
                assert!(same && unsound.ends_with(&rest), "{case}, {simd:?}: weights that are not kept");
            }
            let mut left_out = vec![false; POINTS];
            unsound.iter().for_each(|i| left_out[*i as usize] = true);
            left += left_out.iter().filter(|left_out| **left_out).count();
            all += POINTS;
            for (i, (twin, gap)) in twins.iter().enumerate().filter(|(i, _)| !left_out[*i]) {
                for c in 0..3 {
                    let difference = (y[3 * i + c] - self.x[i][c] - twin.displacement[c]).abs();
                    assert!(difference <= position, "{case}, {simd:?}: {difference}");
                }
                let map: Matrix<3> =
                    std::array::from_fn(|r| std::array::from_fn(|c| maps[9 * i + 3 * r + c]));
                let square: Matrix<3> = std::array::from_fn(|r| apply(&map, &map[r]));
                let one: Matrix<3> = identity();
                for k in 0..9 {
                    assert!(
                        (square[k / 3][k % 3] - one[k / 3][k % 3]).abs() < 1e-14,
                        "{case}, {simd:?}: {map:?}"
                    );
                    let difference = (map[k / 3][k % 3] - twin.map[k / 3][k % 3]).abs();
                    assert!(*gap < 1e-3 || difference <= turn, "{case}, {simd:?}: {difference}, gap {gap}");
                }
            }
        }
        left as f64 / all as f64
    }
}

/// `(s2 + s3) / s1`, s3 < 0 where the determinant is.
fn gap(c: &Matrix<3>) -> f64 {
    let size = norm(c);
    let c = nalgebra::Matrix3::from_fn(|i, j| c[i][j] / size);
    let mut s: Vec<f64> = c.singular_values().iter().copied().collect();
    s.sort_by(f64::total_cmp);
    (s[1] + s[0] * c.determinant().signum()) / s[2]
}

#[test]
fn points_go_where_the_twin_has_them_for_any_targets_and_temperature() {
    for m in [2, 3, 4, 7, 10] {
        let mut given = Given::new(m);
        let anywhere = given.moved(|_, noise| noise);
        let near = given.moved(|p, noise| std::array::from_fn(|k| p[k] + 0.1 * noise[k]));
        for t in TEMPERATURES {
            given.assert_close(&anywhere, t, 3e-6, 5e-6);
            let left = given.assert_close(&near, t, 3e-6, 5e-6);
            assert!(left < 0.02, "{m} control points, T = {t}: {left} are left");
        }
    }
}

#[test]
fn mirrored_targets_agree_at_every_gap() {
    for noise in [0.0, 1e-6, 1e-4, 1e-2] {
        let mut given = Given::new(5);
        let q = given.moved(|p, e| [noise * e[0] - p[0], p[1] + noise * e[1], p[2] + noise * e[2]]);
        for t in TEMPERATURES {
            given.assert_close(&q, t, 2e-6, 1e-6);
        }
    }
}

#[test]
fn control_points_on_a_plane_or_a_line_and_targets_in_one_place_agree() {
    let shapes: [fn([f64; 3]) -> [f64; 3]; 3] = [
        |p| [p[0], p[1], 0.0],
        |p| [p[0], 2.0 * p[0], 0.3 * p[0]],
        |p| if p[0] > 0.0 { [0.5; 3] } else { p },
    ];
    for shape in shapes {
        let mut given = Given::new(6);
        given.p = given.moved(|p, _| shape(p));
        let spread = given.moved(|_, noise| noise);
        let along = given.moved(|p, noise| std::array::from_fn(|k| 1.2 * p[k] + 0.1 * shape(noise)[k]));
        let one_place = given.moved(|_, _| [0.25; 3]);
        for t in TEMPERATURES {
            if Order::new(&given.logits, &given.p).is_some() {
                given.assert_close(&spread, t, 5e-5, 5e-6);
                given.assert_close(&along, t, 5e-5, 5e-6);
                assert_eq!(given.assert_close(&one_place, t, 0.0, 0.0), 1.0);
            }
        }
    }
}

#[test]
fn points_that_hardly_share_pairs_are_not_sorted() {
    let mut given = Given::new(100);
    given.logits = (0..100 * POINTS).map(|_| given.next() as f32).collect();
    assert!(Order::new(&given.logits, &given.p).is_none());
    assert!(Order::new(&[0.0; 40], &[[0.0; 3]]).is_none());
}
