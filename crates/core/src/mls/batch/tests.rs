//! Against the twin, one point at a time in double precision, on every instruction set of this machine.

use super::super::moments::Moments;
use super::super::rotation::{anchored, best_rotation};
use super::super::{matrix, Local, Mls};
use super::*;
use crate::softmax::{relative_weights, PackedWeights};

const ALL: [Transform; 3] = [Transform::Rigid, Transform::Similarity, Transform::Affine];
const TEMPERATURES: [f64; 9] = [0.01, 0.02, 0.05, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0];

type Points = Vec<[f64; 3]>;

/// The worst differences of the sound lanes, and how many are not.
#[derive(Clone, Copy, Debug, Default)]
struct Worst {
    /// Of positions, over the size of the map where that is above 1.
    position: f64,
    /// Of the entries of rotations whose gap `(s2 + s3) / s1` is above 1e-3.
    turn: f64,
    unsound: usize,
}

/// Compares the lanes with the twin.
fn compare(
    x: &[[f64; 3]],
    p: &[[f64; 3]],
    q: &[[f64; 3]],
    logits: &[f32],
    t: f64,
    transform: Transform,
) -> Worst {
    let (n, m) = (x.len(), p.len());
    let handles = Mls::new(p, q, transform);
    let weights = PackedWeights::new(logits, m, t, None).unwrap();
    let mut relative = vec![0.0; m];
    let twins: Vec<(Local<3>, f64)> = x
        .iter()
        .zip(logits.chunks(m))
        .map(|(x, logits)| {
            let dominant = relative_weights(logits, t, &mut relative);
            (handles.deform(x, &relative, dominant), gap(&Moments::new(p, q, &relative, dominant, None).pq))
        })
        .collect();
    let mut worst = Worst::default();
    for simd in Simd::all() {
        let mut lanes = handles.batch(Frame::IDENTITY).unwrap();
        lanes.simd = simd;
        let (mut y, mut maps) = (vec![0.0; 3 * n], vec![0.0; 9 * n]);
        let mut scratch = Scratch::new();
        for first in (0..n).step_by(BATCH) {
            let range = first..n.min(first + BATCH);
            let points = BatchPoints {
                x: x[range.clone()].as_flattened(),
                y: &mut y[3 * range.start..3 * range.end],
                maps: &mut maps[9 * range.start..9 * range.end],
            };
            lanes.deform(weights.blocks(first), points, &mut scratch);
            let unsound: Vec<usize> = scratch.unsound(range.len()).collect();
            for (lane, i) in range.enumerate() {
                if unsound.contains(&lane) {
                    worst.unsound += 1;
                    continue;
                }
                let (twin, gap) = &twins[i];
                for c in 0..3 {
                    let size = matrix::norm(&twin.map).max(1.0);
                    let difference = (y[3 * i + c] - (x[i][c] + twin.displacement[c])).abs() / size;
                    assert!(difference.is_finite(), "{:?}", &y[3 * i..3 * i + 3]);
                    worst.position = worst.position.max(difference);
                }
                for (a, b) in maps[9 * i..9 * i + 9].iter().zip(twin.map.as_flattened()) {
                    if *gap > 1e-3 && transform == Transform::Rigid {
                        worst.turn = worst.turn.max((a - b).abs());
                    }
                }
            }
        }
    }
    worst
}

/// `(s2 + s3) / s1`, s3 < 0 where the determinant is.
fn gap(c: &Matrix<3>) -> f64 {
    let size = matrix::norm(c);
    if size == 0.0 {
        return 0.0;
    }
    let c = nalgebra::Matrix3::from_fn(|i, j| c[i][j] / size);
    let mut s: Vec<f64> = c.singular_values().iter().copied().collect();
    s.sort_by(f64::total_cmp);
    (s[1] + s[0] * c.determinant().signum()) / s[2]
}

struct Random(u64);

impl Random {
    /// In [-1, 1).
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn points(&mut self, count: usize) -> Points {
        (0..count).map(|_| std::array::from_fn(|_| self.next())).collect()
    }

    fn logits(&mut self, count: usize, spread: f64) -> Vec<f32> {
        (0..count).map(|_| (spread * self.next()) as f32).collect()
    }
}

/// Points, control points, and logits for them.
struct Given {
    x: Points,
    p: Points,
    logits: Vec<f32>,
    random: Random,
}

impl Given {
    fn new(m: usize, n: usize, spread: f64) -> Given {
        let mut random = Random(m as u64);
        Given { x: random.points(n), p: random.points(m), logits: random.logits(n * m, spread), random }
    }

    /// Where the control points go, each by `f` of its place and of noise in [-1, 1).
    fn moved(&mut self, f: impl Fn([f64; 3], [f64; 3]) -> [f64; 3]) -> Points {
        self.p.iter().map(|p| f(*p, std::array::from_fn(|_| self.random.next()))).collect()
    }
}

/// Asserts that positions differ by at most `position` and rotations by at most `turn`; gives the share of unsound lanes.
fn assert_close(given: &Given, q: &Points, t: f64, transform: Transform, position: f64, turn: f64) -> f64 {
    let worst = compare(&given.x, &given.p, q, &given.logits, t, transform);
    let case = format!("{} control points, {transform:?}, T = {t}: {worst:?}", given.p.len());
    assert!(worst.position <= position && worst.turn <= turn, "{case}");
    worst.unsound as f64 / (given.x.len() * Simd::all().count()) as f64
}

#[test]
fn lanes_agree_with_the_twin_for_any_targets_and_temperature() {
    for m in [2, 3, 4, 7, 10, 40, 300, 1000] {
        let mut given = Given::new(m, 130, 15.0);
        let anywhere = given.moved(|_, noise| noise);
        let near = given.moved(|p, noise| std::array::from_fn(|k| p[k] + 0.1 * noise[k]));
        for t in TEMPERATURES {
            for q in [&anywhere, &near] {
                for transform in [Transform::Rigid, Transform::Similarity] {
                    let unsound = assert_close(&given, q, t, transform, 3e-6, 5e-6);
                    assert!(unsound < 0.2, "{m} control points, T = {t}: {unsound}");
                }
            }
            assert_close(&given, &near, t, Transform::Affine, 3e-5, 0.0);
        }
    }
}

#[test]
fn mirrored_targets_agree_at_every_gap() {
    for noise in [0.0, 1e-6, 1e-4, 1e-3, 1e-2] {
        for m in [4, 5, 10, 30] {
            let mut given = Given::new(m, 200, 15.0);
            let q = given.moved(|p, e| [noise * e[0] - p[0], p[1] + noise * e[1], p[2] + noise * e[2]]);
            for t in TEMPERATURES {
                assert_close(&given, &q, t, Transform::Rigid, 2e-6, 1e-6);
                assert_close(&given, &q, t, Transform::Similarity, 2e-6, 1e-6);
            }
        }
    }
}

#[test]
fn low_temperatures_where_one_weight_dominates_stay_in_lanes() {
    let mut given = Given::new(10, 500, 15.0);
    let q = given.moved(|p, noise| std::array::from_fn(|k| p[k] + 0.3 * noise[k]));
    for t in [0.3, 0.1, 0.02, 0.01] {
        let unsound = assert_close(&given, &q, t, Transform::Rigid, 1e-6, 1e-6);
        assert!(unsound < 0.01, "T = {t}: {unsound}");
    }
}

#[test]
fn control_points_on_a_plane_a_line_or_in_one_place_agree() {
    let shapes: [fn([f64; 3]) -> [f64; 3]; 4] = [
        |p| [p[0], p[1], 0.0],
        |p| [p[0], 2.0 * p[0], 0.3 * p[0]],
        |_| [0.25; 3],
        |p| if p[0] > 0.0 { [0.5; 3] } else { p },
    ];
    for shape in shapes {
        for m in [2, 3, 6, 20] {
            let mut given = Given::new(m, 130, 5.0);
            let spread = given.moved(|_, noise| noise);
            given.p = given.moved(|p, _| shape(p));
            let along = given.moved(|p, noise| std::array::from_fn(|k| 1.2 * p[k] + 0.1 * shape(noise)[k]));
            for t in TEMPERATURES {
                for transform in [Transform::Rigid, Transform::Similarity] {
                    assert_close(&given, &spread, t, transform, 5e-5, 1e-6);
                    assert_close(&given, &along, t, transform, 5e-5, 1e-6);
                }
                assert_close(&given, &along, t, Transform::Affine, 5e-5, 0.0);
            }
        }
    }
}

#[test]
fn targets_in_one_place_or_on_a_line_agree() {
    for m in [3, 10] {
        let mut given = Given::new(m, 130, 10.0);
        let (place, line) = (given.moved(|_, _| [0.5; 3]), given.moved(|_, e| [e[0], -e[0], 0.5]));
        for t in TEMPERATURES {
            for transform in ALL {
                assert_close(&given, &place, t, transform, 1e-6, 1e-6);
                assert_close(&given, &line, t, transform, 5e-5, 1e-6);
            }
        }
    }
}

#[test]
fn points_on_control_points_go_where_those_go() {
    let mut given = Given::new(8, 64, 5.0);
    let q = given.moved(|p, noise| std::array::from_fn(|k| p[k] + 0.3 * noise[k]));
    for i in 0..64 {
        given.x[i] = given.p[i % 8];
        given.logits[8 * i + i % 8] = f32::INFINITY;
    }
    for t in TEMPERATURES {
        for transform in ALL {
            assert_close(&given, &q, t, transform, 1e-6, 1e-6);
        }
        let lanes = Mls::new(&given.p, &q, Transform::Rigid).batch(Frame::IDENTITY).unwrap();
        let mut y = vec![0.0; 3 * 64];
        let points = BatchPoints { x: given.x.as_flattened(), y: &mut y, maps: &mut [] };
        let weights = PackedWeights::new(&given.logits, 8, t, None).unwrap();
        lanes.deform(weights.blocks(0), points, &mut Scratch::new());
        for (i, y) in y.chunks(3).enumerate() {
            assert!(y.iter().zip(q[i % 8]).all(|(a, b)| (a - b).abs() < 1e-12), "T = {t}: {y:?}");
        }
    }
}

/// A rotation, as random as its nine numbers.
fn any_rotation(random: &mut Random) -> Matrix<3> {
    let rows = random.points(3);
    best_rotation(&[rows[0], rows[1], rows[2]])
}

#[test]
fn rotations_are_those_of_double_precision_at_every_gap() {
    let mut random = Random(5);
    for gap in [1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5] {
        for mirrored in [false, true] {
            let g = any_rotation(&mut random);
            let moments: Vec<Matrix<3>> = (0..BATCH)
                .map(|_| {
                    let (u, v, size) = (
                        any_rotation(&mut random),
                        any_rotation(&mut random),
                        10f64.powf(4.0 * random.next()),
                    );
                    let s2 = if mirrored { 0.4 } else { gap * (0.75 + 0.25 * random.next()) };
                    let s = [size, size * s2, size * (gap - s2)];
                    std::array::from_fn(|r| {
                        std::array::from_fn(|c| (0..3).map(|k| s[k] * u[r][k] * v[c][k]).sum())
                    })
                })
                .collect();
            for simd in Simd::all() {
                let mut scratch = Scratch::new();
                for (lane, moment) in moments.iter().enumerate() {
                    for k in 0..9 {
                        scratch.moment[k][lane] = moment[k / 3][k % 3];
                    }
                }
                rotate(simd, &Turning::new(g), &mut scratch);
                for (lane, moment) in moments.iter().enumerate() {
                    let case = format!("{simd:?}, gap {gap}, mirrored {mirrored}, lane {lane}");
                    assert!(mirrored || scratch.sound[lane] == 1.0, "{case}");
                    let right = anchored(moment, &g);
                    for k in 0..9 {
                        let one = if k % 4 == 0 { 1.0 } else { 0.0 };
                        let error = (scratch.change[k][lane] + one - right[k / 3][k % 3]).abs();
                        assert!(scratch.sound[lane] == 0.0 || error < 1e-9, "{case}: {error}");
                    }
                }
            }
        }
    }
}

#[test]
fn lanes_that_nothing_determines_are_left_to_the_twin() {
    let one = Given::new(1, 20, 1.0);
    assert_eq!(assert_close(&one, &vec![[0.5; 3]], 1.0, Transform::Rigid, 0.0, 0.0), 1.0);
    // A mirror of points all around leaves two turns open.
    let mut given = Given::new(6, 20, 0.0);
    given.p = vec![
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    let q = given.moved(|p, _| [-p[0], p[1], p[2]]);
    assert_eq!(assert_close(&given, &q, 1.0, Transform::Rigid, 0.0, 0.0), 1.0);
}
