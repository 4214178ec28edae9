//! Against the twin, one point at a time in double precision, on every instruction set of this machine.

use super::super::moments::Moments;
use super::super::{matrix, Handles, Local};
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
    let handles = Handles::new(p, q, transform);
    let weights = PackedWeights::new(logits, m, t, None);
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
    for simd in crate::simd::loops::all() {
        let mut lanes = handles.lanes(Frame::IDENTITY).unwrap();
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
    if !(size > 0.0) {
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

#[test]
fn explore() {
    let mut random = Random(1);
    for m in [2, 3, 4, 7, 10, 30, 200, 1000] {
        for transform in ALL {
            for t in TEMPERATURES {
                let n = 130;
                let (x, p, q) = (random.points(n), random.points(m), random.points(m));
                let logits = random.logits(n * m, 15.0);
                let mirror: Points = p.iter().map(|p| [-p[0], p[1], p[2]]).collect();
                let noisy: Points = mirror.iter().map(|p| p.map(|c| c + 1e-2 * random.next())).collect();
                let close: Points = p.iter().map(|p| p.map(|c| c + 1e-2 * random.next())).collect();
                let flat: Points = p.iter().map(|p| [p[0], p[1], 0.0]).collect();
                let line: Points = p.iter().map(|p| [p[0], 2.0 * p[0], 0.3 * p[0]]).collect();
                let tiny: Points = p.iter().map(|p| p.map(|c| 1e-3 * c)).collect();
                for (name, p, q) in [
                    ("random", &p, &q),
                    ("mirror", &p, &mirror),
                    ("noisy mirror", &p, &noisy),
                    ("close", &p, &close),
                    ("flat", &flat, &q),
                    ("both flat", &flat, &flat),
                    ("line", &line, &q),
                    ("from flat", &q, &flat),
                    ("to line", &q, &line),
                    ("tiny", &tiny, &q),
                    ("both tiny", &tiny, &tiny),
                ] {
                    let w = compare(&x, p, q, &logits, t, transform);
                    if w.position > 1e-6 || w.turn > 2e-6 || w.unsound > 20 {
                        println!("{m} {transform:?} T {t} {name}: {w:?}");
                    }
                }
            }
        }
    }
}
