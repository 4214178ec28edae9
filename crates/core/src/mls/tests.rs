//! Against a naive version (nalgebra's SVD in double precision), laws, and the cases where moments lack rank.

use super::*;
use crate::softmax::relative_weights;
use nalgebra::SMatrix;
use proptest::prelude::*;

const ALL: [Transform; 3] = [Transform::Rigid, Transform::Similarity, Transform::Affine];

/// The formulas as they stand, for well-determined moments: SVD, sign fixed, pseudo-inverse.
fn naive<const D: usize>(
    x: [f64; D],
    p: &[[f64; D]],
    q: &[[f64; D]],
    w: &[f64],
    transform: Transform,
) -> [f64; D] {
    let vector = |v: &[f64; D]| SMatrix::<f64, D, 1>::from_column_slice(v);
    let mean = |points: &[[f64; D]]| -> SMatrix<f64, D, 1> {
        points.iter().zip(w).map(|(p, w)| vector(p) * *w).sum()
    };
    let (p_mean, q_mean) = (mean(p), mean(q));
    let (mut c, mut pp) = (SMatrix::<f64, D, D>::zeros(), SMatrix::<f64, D, D>::zeros());
    for ((p, q), w) in p.iter().zip(q).zip(w) {
        let (a, b) = (vector(p) - p_mean, vector(q) - q_mean);
        c += a * b.transpose() * *w;
        pp += a * a.transpose() * *w;
    }
    let rotation = match D {
        1 => SMatrix::identity(),
        _ => {
            let dynamic = nalgebra::DMatrix::from_iterator(D, D, c.iter().copied());
            let svd = dynamic.svd(true, true);
            let (u, v) = (svd.u.unwrap(), svd.v_t.unwrap().transpose());
            let mut sign = nalgebra::DMatrix::identity(D, D);
            let smallest = svd.singular_values.imin();
            sign[(smallest, smallest)] = (&v * u.transpose()).determinant().signum();
            let r = v * sign * u.transpose();
            SMatrix::<f64, D, D>::from_iterator(r.iter().copied())
        }
    };
    let m = match transform {
        Transform::Rigid => rotation,
        Transform::Similarity => rotation * ((rotation * c).trace().max(0.0) / pp.trace()),
        Transform::Affine => {
            let dynamic = nalgebra::DMatrix::from_iterator(D, D, pp.iter().copied());
            let inverse = dynamic.try_inverse().unwrap();
            c.transpose() * SMatrix::<f64, D, D>::from_iterator(inverse.iter().copied())
        }
    };
    let y = m * (vector(&x) - p_mean) + q_mean;
    std::array::from_fn(|k| y[k])
}

fn deform<const D: usize>(
    x: [f64; D],
    p: &[[f64; D]],
    q: &[[f64; D]],
    logits: &[f32],
    temperature: f64,
    transform: Transform,
) -> Local<D> {
    let mut relative = vec![0.0; p.len()];
    let dominant = relative_weights(logits, temperature, &mut relative);
    Mls::new(p, q, transform).deform(&x, &relative, dominant)
}

fn close<const D: usize>(a: [f64; D], b: [f64; D], tolerance: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance)
}

fn landing<const D: usize>(x: [f64; D], local: &Local<D>) -> [f64; D] {
    std::array::from_fn(|k| x[k] + local.displacement[k])
}

fn determinant<const D: usize>(m: &Matrix<D>) -> f64 {
    nalgebra::DMatrix::from_row_slice(D, D, m.as_flattened()).determinant()
}

fn points<const D: usize>(count: usize) -> impl Strategy<Value = Vec<[f64; D]>> {
    prop::collection::vec(prop::array::uniform(-1.0..1.0f64), count)
}

fn rotation() -> impl Strategy<Value = Matrix<3>> {
    prop::array::uniform4(-1.0..1.0f64).prop_filter_map("a quaternion with a length", |u| {
        let length = u.iter().map(|c| c * c).sum::<f64>().sqrt();
        (length > 0.1).then(|| {
            let u = nalgebra::Quaternion::new(u[0], u[1], u[2], u[3]);
            let r = nalgebra::UnitQuaternion::from_quaternion(u).to_rotation_matrix();
            std::array::from_fn(|i| std::array::from_fn(|j| r[(i, j)]))
        })
    })
}

fn mapped<const D: usize>(m: &Matrix<D>, shift: [f64; D], points: &[[f64; D]]) -> Vec<[f64; D]> {
    points.iter().map(|p| matrix::apply(m, p)).map(|p| std::array::from_fn(|k| p[k] + shift[k])).collect()
}

macro_rules! agrees_with_the_naive_version {
    ($name:ident, $d:literal) => {
        proptest! {
            #[test]
            fn $name(p in points::<$d>(7), q in points::<$d>(7), x in prop::array::uniform(-1.0..1.0f64),
                     logits in prop::collection::vec(-2f32..2.0, 7)) {
                let mut w = vec![0.0; 7];
                crate::softmax::weights(&logits, 1.0, &mut w);
                for transform in ALL {
                    let y = landing(x, &deform(x, &p, &q, &logits, 1.0, transform));
                    let expected = naive(x, &p, &q, &w, transform);
                    prop_assert!(close(y, expected, 1e-5), "{:?} {:?} {:?}", transform, y, expected);
                }
            }
        }
    };
}
agrees_with_the_naive_version!(one_dimension_agrees_with_the_naive_version, 1);
agrees_with_the_naive_version!(two_dimensions_agree_with_the_naive_version, 2);
agrees_with_the_naive_version!(three_dimensions_agree_with_the_naive_version, 3);

proptest! {
    #[test]
    fn a_rigid_motion_of_all_is_followed_at_every_temperature(
        p in points::<3>(6), x in prop::array::uniform(-1.0..1.0f64), r in rotation(), shift in prop::array::uniform(-2.0..2.0f64),
        logits in prop::collection::vec(-15f32..15.0, 6), t in prop::sample::select(vec![0.01, 0.02, 0.1, 0.3, 1.0, 10.0, 100.0]),
    ) {
        let q = mapped(&r, shift, &p);
        let expected = mapped(&r, shift, &[x])[0];
        for transform in ALL {
            let y = landing(x, &deform(x, &p, &q, &logits, t, transform));
            prop_assert!(close(y, expected, 1e-5), "{:?} {:?} {:?}", transform, y, expected);
        }
    }

    #[test]
    fn a_motion_of_control_points_near_a_line_is_followed_at_every_temperature(
        p in points::<3>(6), x in prop::array::uniform(-1.0..1.0f64), along in rotation(), r in rotation(), s in 0.3f64..3.0,
        thickness in -6.0..-2.0f64, shift in prop::array::uniform(-2.0..2.0f64), logits in prop::collection::vec(-15f32..15.0, 6),
        t in prop::sample::select(vec![0.02, 0.1, 0.3, 1.0, 10.0, 100.0]),
    ) {
        let h = 10f64.powf(thickness);
        // As long as a shape, and as thick as is said.
        let stretched = |(i, p): (usize, &[f64; 3])| match i {
            0 => [-1.0, 0.0, 0.0],
            1 => [1.0, h, 0.0],
            2 => [p[0], -h, h * p[2]],
            _ => [p[0], h * p[1], h * p[2]],
        };
        let p = mapped(&along, [0.0; 3], &p.iter().enumerate().map(stretched).collect::<Vec<_>>());
        for (transform, scale) in [(Transform::Rigid, 1.0), (Transform::Similarity, s), (Transform::Affine, 1.0)] {
            let m = matrix::scaled(&r, scale);
            let (q, expected) = (mapped(&m, shift, &p), mapped(&m, shift, &[x])[0]);
            let y = landing(x, &deform(x, &p, &q, &logits, t, transform));
            prop_assert!(close(y, expected, 1e-6), "{:?}: {:?} {:?}", transform, y, expected);
        }
    }

    #[test]
    fn a_similarity_of_all_is_followed_by_similarity_and_affine(
        p in points::<3>(6), x in prop::array::uniform(-1.0..1.0f64), r in rotation(), s in 0.2f64..3.0,
        logits in prop::collection::vec(-15f32..15.0, 6), t in prop::sample::select(vec![0.02, 0.3, 1.0, 10.0]),
    ) {
        let m = matrix::scaled(&r, s);
        let q = mapped(&m, [0.3, -0.2, 0.1], &p);
        let expected = mapped(&m, [0.3, -0.2, 0.1], &[x])[0];
        for transform in [Transform::Similarity, Transform::Affine] {
            let y = landing(x, &deform(x, &p, &q, &logits, t, transform));
            prop_assert!(close(y, expected, 1e-5), "{:?} {:?} {:?}", transform, y, expected);
        }
    }

    #[test]
    fn an_affine_map_of_all_is_followed_by_affine(
        p in points::<3>(6), x in prop::array::uniform(-1.0..1.0f64), m in prop::array::uniform3(prop::array::uniform(-1.5..1.5f64)),
        logits in prop::collection::vec(-15f32..15.0, 6), t in prop::sample::select(vec![0.02, 0.3, 1.0, 10.0]),
    ) {
        let q = mapped(&m, [0.3, -0.2, 0.1], &p);
        let expected = mapped(&m, [0.3, -0.2, 0.1], &[x])[0];
        let y = landing(x, &deform(x, &p, &q, &logits, t, Transform::Affine));
        prop_assert!(close(y, expected, 1e-5), "{:?} {:?}", y, expected);
    }

    #[test]
    fn rotations_are_rotations_whatever_the_targets(
        p in points::<3>(5), q in points::<3>(5), logits in prop::collection::vec(-30f32..30.0, 5), t in 0.01f64..10.0,
        mirror in any::<bool>(), flat in any::<bool>(),
    ) {
        let flatten = |points: &[[f64; 3]]| -> Vec<[f64; 3]> {
            points.iter().map(|p| [p[0], p[1], if flat { 0.0 } else { p[2] }]).collect()
        };
        let p = flatten(&p);
        let q = if mirror { p.iter().map(|p| [-p[0], p[1], p[2]]).collect() } else { flatten(&q) };
        let map = deform([0.1, 0.2, 0.3], &p, &q, &logits, t, Transform::Rigid).map;
        prop_assert!((determinant(&map) - 1.0).abs() < 1e-9, "{:?}", map);
        for (i, a) in map.iter().enumerate() {
            for (j, b) in map.iter().enumerate() {
                let dot: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                prop_assert!((dot - f64::from(u8::from(i == j))).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn the_order_of_the_control_points_does_not_matter(
        p in points::<3>(6), q in points::<3>(6), logits in prop::collection::vec(-3f32..3.0, 6),
    ) {
        let reversed = |points: &[[f64; 3]]| -> Vec<[f64; 3]> { points.iter().rev().copied().collect() };
        let backwards: Vec<f32> = logits.iter().rev().copied().collect();
        for transform in ALL {
            let a = deform([0.0; 3], &p, &q, &logits, 1.0, transform).displacement;
            let b = deform([0.0; 3], &reversed(&p), &reversed(&q), &backwards, 1.0, transform).displacement;
            prop_assert!(close(a, b, 1e-6), "{:?} {:?}", a, b);
        }
    }

    #[test]
    fn the_best_rotation_is_at_least_as_good_as_any_other(c in prop::array::uniform3(prop::array::uniform(-1.0..1.0f64)), other in rotation()) {
        let best = rotation::best_rotation(&c);
        prop_assert!(matrix::trace_of_product(&best, &c) >= matrix::trace_of_product(&other, &c) - 1e-12);
    }
}

const SQUARE: [[f64; 3]; 4] = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];

#[test]
fn one_control_point_translates() {
    for transform in ALL {
        let local = deform([5.0, 0.0, 1.0], &[[1.0, 2.0, 3.0]], &[[1.5, 2.0, 2.0]], &[0.3], 1.0, transform);
        assert_eq!(local.displacement, [0.5, 0.0, -1.0]);
        assert_eq!(local.map, matrix::identity());
    }
}

#[test]
fn two_control_points_turn_by_the_smallest_rotation() {
    let (p, q) = ([[0.0; 3], [1.0, 0.0, 0.0]], [[0.0; 3], [0.0, 1.0, 0.0]]);
    let map = deform([0.3, 0.0, 0.0], &p, &q, &[0.0, 0.0], 1.0, Transform::Rigid).map;
    let quarter_turn_about_z = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    for (row, expected) in map.iter().zip(quarter_turn_about_z) {
        assert!(close(*row, expected, 1e-7), "{map:?}");
    }
}

#[test]
fn mirrored_targets_give_a_rotation_that_changes_continuously_with_the_point() {
    let q: Vec<_> = SQUARE.iter().map(|p| [-p[0], p[1], p[2]]).collect();
    let mut before: Option<[f64; 3]> = None;
    for step in 0..200 {
        let s = step as f32 / 200.0;
        let x = [f64::from(s) * 0.2 - 0.1, 0.3, 0.1];
        let logits = [1.0 - s, 1.5 * s, 0.4, 0.7 * s];
        let y = landing(x, &deform(x, &SQUARE, &q, &logits, 1.0, Transform::Rigid));
        if let Some(before) = before {
            assert!(close(y, before, 0.05), "step {step}: {before:?} -> {y:?}");
        }
        before = Some(y);
    }
}

#[test]
fn coplanar_and_collinear_control_points_stay_finite_and_flat() {
    let line = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
    let stretched = [[0.0; 3], [2.0, 0.0, 0.0], [4.0, 0.0, 0.0]];
    for t in [0.01, 1.0, 100.0] {
        let local = deform([1.0, 0.5, 0.0], &line, &stretched, &[0.5, 1.0, 0.2], t, Transform::Affine);
        let y = landing([1.0, 0.5, 0.0], &local);
        assert!(close(y, [2.0, 0.5, 0.0], 1e-6), "stretched along the line, rigid across it: {y:?}");
        let local = deform([0.0, 0.0, 0.7], &SQUARE, &SQUARE, &[0.1, 0.2, 0.3, 0.4], t, Transform::Rigid);
        assert!(close(local.displacement, [0.0; 3], 1e-9));
    }
}

/// Control points on a line but for rounding: what a motion leaves open about it must not be made of that.
#[test]
fn rounding_beside_a_line_turns_nothing_about_it() {
    let to = |degrees: f64| -> [f64; 3] {
        [0.3 + degrees.to_radians().cos(), 0.2, 0.1 + degrees.to_radians().sin()]
    };
    for digits in [f64::from(f32::EPSILON), f64::EPSILON] {
        let rounded = |v: f64, i: usize| v * (1.0 + digits * (7.0 * i as f64 + 3.0 * v).sin());
        let line = |from: [f64; 3], to: [f64; 3]| -> Vec<[f64; 3]> {
            let at = |i: usize| -> [f64; 3] {
                std::array::from_fn(|k| from[k] + 0.2 * i as f64 * (to[k] - from[k]))
            };
            (0..6).map(|i| at(i).map(|v| rounded(v, i))).collect()
        };
        let p = line([0.3, 0.2, 0.1], to(20.0));
        for step in 0..40 {
            // Turned in the plane of y, so that the smallest rotation is about y; and not quite rigidly.
            let q: Vec<[f64; 3]> = line([0.3, 0.2, 0.1], to(20.0 + f64::from(step)));
            let q: Vec<_> =
                q.iter().enumerate().map(|(i, q)| [q[0] + 1e-6 * (i as f64).sin(), q[1], q[2]]).collect();
            let map = deform([0.0; 3], &p, &q, &[0.0; 6], 1.0, Transform::Rigid).map;
            assert!((map[1][1] - 1.0).abs() < 1e-6, "{digits}, {step} degrees: {map:?}");
        }
    }
}

#[test]
fn coincident_control_points_translate() {
    let p = [[0.5; 3], [0.5; 3]];
    let q = [[1.0; 3], [1.0; 3]];
    for transform in ALL {
        let local = deform([0.0; 3], &p, &q, &[0.0, 0.1], 1.0, transform);
        assert!(close(local.displacement, [0.5; 3], 1e-12), "{transform:?} {local:?}");
    }
}

#[test]
fn a_mirrored_line_collapses_under_similarity_instead_of_reflecting() {
    let local = deform([0.5], &[[-1.0], [1.0]], &[[1.0], [-1.0]], &[0.0, 0.0], 1.0, Transform::Similarity);
    assert_eq!(local.map, [[0.0]]);
}

#[test]
fn a_point_on_a_control_point_goes_where_that_goes() {
    let q = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.5], [1.0, 1.0, 0.0], [-1.0, 1.2, 0.0]];
    for transform in ALL {
        let x = SQUARE[1];
        let local = deform(x, &SQUARE, &q, &[0.3, f32::INFINITY, 0.1, 0.4], 1.0, transform);
        assert!(close(landing(x, &local), q[1], 1e-15), "{transform:?}");
    }
}
