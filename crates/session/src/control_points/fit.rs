//! How well one rotation and scale, or one mirroring, takes all sources to their targets.
//!
//! With `C = sum_i p_i q_i^T` of the centred points and its singular values `s1 >= s2 >= s3`, the largest `tr(R C)` over rotations
//! is `s1 + s2 + sign(det C) s3`, over reflections `s1 + s2 - sign(det C) s3` (Umeyama 1991).

use std::f64::consts::PI;

/// What is left of the targets, as a part of their size (root mean square about the centre): 0 where nothing is, 1 at most.
pub struct Rest {
    /// After the best rotation and scale.
    pub rotated: f64,
    /// After the best mirroring, rotation and scale.
    pub mirrored: f64,
}

/// What is left; `None` where either has no size.
pub fn rest(p: &[f64], q: &[f64], dim: usize) -> Option<Rest> {
    let (p, q) = (centred(p, dim), centred(q, dim));
    let mut c = [0.0; 9];
    for (p, q) in p.chunks_exact(dim).zip(q.chunks_exact(dim)) {
        for i in 0..dim {
            for j in 0..dim {
                c[3 * i + j] += p[i] * q[j];
            }
        }
    }
    let squares = |points: &[f64]| points.iter().map(|c| c * c).sum::<f64>();
    let sizes = (squares(&p) * squares(&q)).sqrt();
    if !(sizes > 0.0 && sizes.is_finite()) {
        return None;
    }
    let c = c.map(|c| c / sizes);
    let (rotated, mirrored) = match dim {
        1 => (c[0], -c[0]),
        2 => {
            let (square, det) = (c.iter().map(|c| c * c).sum::<f64>(), c[0] * c[4] - c[1] * c[3]);
            ((square + 2.0 * det).max(0.0).sqrt(), (square - 2.0 * det).max(0.0).sqrt())
        }
        _ => {
            let [s1, s2, s3] = singular_values(&c);
            let s3 = s3.copysign(determinant(&c));
            (s1 + s2 + s3, s1 + s2 - s3)
        }
    };
    let left = |trace: f64| (1.0 - trace.clamp(0.0, 1.0).powi(2)).sqrt();
    Some(Rest { rotated: left(rotated), mirrored: left(mirrored) })
}

fn centred(points: &[f64], dim: usize) -> Vec<f64> {
    let count = (points.len() / dim) as f64;
    let centre: Vec<f64> =
        (0..dim).map(|k| points.iter().skip(k).step_by(dim).map(|c| c / count).sum()).collect();
    points.iter().enumerate().map(|(i, c)| c - centre[i % dim]).collect()
}

/// The largest first, to about 1e-8 of it: roots of the eigenvalues of `C^T C` (Smith 1961).
fn singular_values(c: &[f64; 9]) -> [f64; 3] {
    let entry = |i: usize, j: usize| (0..3).map(|k| c[3 * k + i] * c[3 * k + j]).sum::<f64>();
    let mean = (entry(0, 0) + entry(1, 1) + entry(2, 2)) / 3.0;
    let deviation = |i: usize, j: usize| entry(i, j) - if i == j { mean } else { 0.0 };
    let a: [f64; 9] = std::array::from_fn(|at| deviation(at / 3, at % 3));
    let spread = (a.iter().map(|a| a * a).sum::<f64>() / 6.0).sqrt();
    if spread <= 1e-300 {
        return [mean.max(0.0).sqrt(); 3];
    }
    let half = (determinant(&a.map(|a| a / spread)) / 2.0).clamp(-1.0, 1.0);
    let angle = half.acos() / 3.0;
    let root = |turn: f64| (mean + 2.0 * spread * (angle + turn).cos()).max(0.0).sqrt();
    [root(0.0), root(-2.0 * PI / 3.0), root(2.0 * PI / 3.0)]
}

fn determinant(m: &[f64; 9]) -> f64 {
    m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6])
        + m[2] * (m[3] * m[7] - m[4] * m[6])
}

/// How far points in space are from a line through two of them that lie far apart, as a part of the distance of those two.
pub fn thickness(points: &[f64]) -> f64 {
    let all = || points.chunks_exact(3);
    let difference = |a: &[f64], b: &[f64]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let length = |[x, y, z]: [f64; 3]| x.hypot(y).hypot(z);
    let farthest = |from: &[f64]| {
        let distance = |point: &[f64]| length(difference(point, from));
        all().fold(
            points[..3].to_vec(),
            |far, point| if distance(point) > distance(&far) { point.to_vec() } else { far },
        )
    };
    let a = farthest(&points[..3]);
    let b = farthest(&a);
    let line = difference(&b, &a);
    let extent = length(line);
    let [x, y, z] = line.map(|c| c / extent);
    let away = |point: &[f64]| {
        let [u, v, w] = difference(point, &a);
        length([y * w - z * v, z * u - x * w, x * v - y * u])
    };
    all().map(away).fold(0.0, f64::max) / extent
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn points(dim: usize) -> impl Strategy<Value = Vec<f64>> {
        prop::collection::vec(-1.0..1.0f64, dim * 8)
    }

    proptest! {
        #[test]
        fn a_mirrored_set_is_one_in_every_dimension(dim in 1..4usize, all in points(3), scale in 0.1..10.0f64) {
            let p = &all[..8 * dim];
            let q: Vec<f64> = p.iter().enumerate().map(|(i, c)| scale * if i % dim == 0 { 3.0 - c } else { c + 1.0 }).collect();
            let mirrored = rest(p, &q, dim).unwrap();
            prop_assert!(mirrored.mirrored < 1e-6);
            prop_assert!(mirrored.rotated > 1e-3);
            let same = rest(p, p, dim).unwrap();
            prop_assert!(same.rotated < 1e-6 && same.mirrored > 1e-3);
        }

        #[test]
        fn singular_values_have_the_sums_of_their_powers(c in prop::array::uniform9(-1.0..1.0f64)) {
            let [a, b, d] = singular_values(&c);
            prop_assert!(a >= b && b >= d);
            let square = c.iter().map(|c| c * c).sum::<f64>();
            prop_assert!((a * a + b * b + d * d - square).abs() < 1e-12);
            prop_assert!((a * b * d - determinant(&c).abs()).abs() < 1e-7);
        }
    }

    #[test]
    fn thickness_is_relative_to_the_extent() {
        let line = [0.0, 0.0, 0.0, 5.0, 0.0, 0.5, 10.0, 0.0, 0.0];
        assert!((thickness(&line) - 0.05).abs() < 1e-15);
        assert_eq!(thickness(&[0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0]), 0.0);
    }
}
