//! Against a naive version (nalgebra's SVD in double precision), laws, and lanes against the twin.

use super::super::{batch, matrix, rotation, Local, Mls, Transform};
use super::*;
use crate::softmax::{relative_weights, weights, PackedWeights};
use nalgebra::{DMatrix, SMatrix};
use proptest::prelude::*;

const ALL: [Transform; 3] = [Transform::Rigid, Transform::Similarity, Transform::Affine];
const TEMPERATURES: [f64; 7] = [0.01, 0.02, 0.1, 0.3, 1.0, 10.0, 100.0];

/// A control point's turn, for those that have one.
type Turns<const D: usize> = Vec<Option<Matrix<D>>>;

fn flat<const D: usize>(turns: &Turns<D>) -> Vec<f64> {
    turns.iter().flat_map(|turn| turn.unwrap_or([[f64::NAN; D]; D])).flatten().collect()
}

fn deform<const D: usize>(
    x: [f64; D],
    p: &[[f64; D]],
    q: &[[f64; D]],
    turns: &Turns<D>,
    logits: &[f32],
    temperature: f64,
    transform: Transform,
) -> ([f64; D], Matrix<D>) {
    let mut relative = vec![0.0; p.len()];
    let dominant = relative_weights(logits, temperature, &mut relative);
    let turns = flat(turns);
    assert!(check(&turns, p.len(), D).is_ok());
    let handles = Mls::with_oriented(p, q, oriented(&turns, p), transform);
    let Local { displacement, map } = handles.deform(&x, &relative, dominant);
    (std::array::from_fn(|k| x[k] + displacement[k]), map)
}

/// Before and after, its weight, and the scale of one that belongs to a frame.
type Arm<const D: usize> = (SMatrix<f64, D, 1>, SMatrix<f64, D, 1>, f64, Option<f64>);

/// The sums as they stand, with each oriented control point's frame as so many points of their own; then SVD and pseudo-inverse.
fn naive<const D: usize>(
    x: [f64; D],
    p: &[[f64; D]],
    q: &[[f64; D]],
    turns: &Turns<D>,
    w: &[f64],
    transform: Transform,
) -> [f64; D] {
    let vector = |v: &[f64; D]| SMatrix::<f64, D, 1>::from_column_slice(v);
    let mean = |points: &[[f64; D]]| -> SMatrix<f64, D, 1> {
        points.iter().zip(w).map(|(p, w)| vector(p) * *w).sum()
    };
    let (p_mean, q_mean) = (mean(p), mean(q));
    let mut arms: Vec<Arm<D>> = Vec::new();
    for i in 0..p.len() {
        arms.push((vector(&p[i]) - p_mean, vector(&q[i]) - q_mean, w[i], None));
        let Some(turn) = &turns[i] else { continue };
        let others = (0..p.len()).filter(|&j| j != i).map(|j| (vector(&p[j]) - vector(&p[i])).norm());
        let rho = others.fold(f64::INFINITY, f64::min);
        let rho = if rho.is_finite() { rho } else { 1.0 };
        let turn = SMatrix::<f64, D, D>::from_fn(|r, c| turn[r][c]);
        for k in 0..D {
            let mut arm = SMatrix::<f64, D, 1>::zeros();
            arm[k] = rho;
            for side in [arm, -arm] {
                arms.push((side, turn * side, w[i] * w[i] / 2.0, Some(turn.norm() / (D as f64).sqrt())));
            }
        }
    }
    let (mut c, mut rigid, mut pp) =
        (SMatrix::<f64, D, D>::zeros(), SMatrix::<f64, D, D>::zeros(), SMatrix::<f64, D, D>::zeros());
    for (a, b, w, scale) in &arms {
        c += a * b.transpose() * *w;
        rigid += a * b.transpose() * (*w / scale.unwrap_or(1.0));
        pp += a * a.transpose() * *w;
    }
    let svd = DMatrix::from_iterator(D, D, rigid.iter().copied()).svd(true, true);
    let (u, v) = (svd.u.unwrap(), svd.v_t.unwrap().transpose());
    let mut sign = DMatrix::identity(D, D);
    let smallest = svd.singular_values.imin();
    sign[(smallest, smallest)] = (&v * u.transpose()).determinant().signum();
    let r = v * sign * u.transpose();
    let r = SMatrix::<f64, D, D>::from_iterator(r.iter().copied());
    let m = match transform {
        Transform::Rigid => r,
        Transform::Similarity => {
            let along: f64 = arms
                .iter()
                .map(|(a, b, w, scale)| w * scale.map_or_else(|| b.dot(&(r * a)), |s| s * a.dot(a)))
                .sum();
            r * (along.max(0.0) / pp.trace())
        }
        Transform::Affine => {
            let inverse = DMatrix::from_iterator(D, D, pp.iter().copied()).try_inverse().unwrap();
            c.transpose() * SMatrix::<f64, D, D>::from_iterator(inverse.iter().copied())
        }
    };
    let y = m * (vector(&x) - p_mean) + q_mean;
    std::array::from_fn(|k| y[k])
}

fn close<const D: usize>(a: [f64; D], b: [f64; D], tolerance: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance)
}

fn points<const D: usize>(count: usize) -> impl Strategy<Value = Vec<[f64; D]>> {
    prop::collection::vec(prop::array::uniform(-1.0..1.0f64), count)
}

/// Any rotation in 1, 2 or 3 dimensions: that nearest to any matrix.
fn any_rotation<const D: usize>() -> impl Strategy<Value = Matrix<D>> {
    prop::array::uniform(prop::array::uniform(-1.0..1.0f64)).prop_map(|m| rotation::best_rotation(&m))
}

fn any_turns<const D: usize>(count: usize) -> impl Strategy<Value = Turns<D>> {
    let one = (any_rotation::<D>(), 0.5..2.0f64).prop_map(|(r, s)| matrix::scaled(&r, s));
    prop::collection::vec(prop::option::of(one), count)
}

fn any_logits(count: usize, spread: f32) -> impl Strategy<Value = Vec<f32>> {
    prop::collection::vec(-spread..spread, count)
}

fn mapped<const D: usize>(m: &Matrix<D>, shift: [f64; D], points: &[[f64; D]]) -> Vec<[f64; D]> {
    points.iter().map(|p| matrix::apply(m, p)).map(|p| std::array::from_fn(|k| p[k] + shift[k])).collect()
}

/// An angle in degrees about z.
fn about_z(degrees: f64) -> Matrix<3> {
    let (sin, cos) = degrees.to_radians().sin_cos();
    [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]
}

macro_rules! agrees_with_the_naive_version {
    ($name:ident, $d:literal) => {
        proptest! {
            #[test]
            fn $name(p in points::<$d>(6), q in points::<$d>(6), turns in any_turns::<$d>(6),
                     x in prop::array::uniform(-1.0..1.0f64), logits in any_logits(6, 2.0)) {
                let mut w = vec![0.0; 6];
                weights(&logits, 1.0, &mut w);
                for transform in ALL {
                    let (y, _) = deform(x, &p, &q, &turns, &logits, 1.0, transform);
                    let expected = naive(x, &p, &q, &turns, &w, transform);
                    prop_assert!(close(y, expected, 1e-5), "{:?} {:?} {:?}", transform, y, expected);
                }
            }
        }
    };
}
agrees_with_the_naive_version!(one_dimension_agrees_with_the_naive_version, 1);
agrees_with_the_naive_version!(two_dimensions_agree_with_the_naive_version, 2);
agrees_with_the_naive_version!(three_dimensions_agree_with_the_naive_version, 3);

/// A motion of all control points, which those that are oriented share, moves every point by it.
fn assert_followed<const D: usize>(
    x: [f64; D],
    p: &[[f64; D]],
    m: &Matrix<D>,
    which: &[bool],
    logits: &[f32],
    t: f64,
    transforms: &[Transform],
) {
    let shift = std::array::from_fn(|k| 0.3 - 0.2 * k as f64);
    let (q, expected) = (mapped(m, shift, p), mapped(m, shift, &[x])[0]);
    let turns: Turns<D> = which.iter().map(|turned| turned.then_some(*m)).collect();
    for &transform in transforms {
        let (y, _) = deform(x, p, &q, &turns, logits, t, transform);
        assert!(close(y, expected, 1e-5), "{transform:?} T = {t}: {y:?}, not {expected:?}");
    }
}

proptest! {
    #[test]
    fn a_rigid_motion_of_all_is_followed_at_every_temperature(
        p in points::<3>(6), x in prop::array::uniform(-1.0..1.0f64), r in any_rotation::<3>(), which in prop::collection::vec(any::<bool>(), 6),
        logits in any_logits(6, 15.0), t in prop::sample::select(TEMPERATURES.to_vec()),
    ) {
        assert_followed(x, &p, &r, &which, &logits, t, &ALL);
    }

    #[test]
    fn in_the_plane_too(
        p in points::<2>(4), x in prop::array::uniform(-1.0..1.0f64), r in any_rotation::<2>(), which in prop::collection::vec(any::<bool>(), 4),
        logits in any_logits(4, 15.0), t in prop::sample::select(TEMPERATURES.to_vec()),
    ) {
        assert_followed(x, &p, &r, &which, &logits, t, &ALL);
    }

    #[test]
    fn one_oriented_of_two_control_points_decides_what_they_leave_open(
        p in points::<3>(2), x in prop::array::uniform(-1.0..1.0f64), r in any_rotation::<3>(), t in prop::sample::select(TEMPERATURES.to_vec()),
        logits in any_logits(2, 15.0),
    ) {
        prop_assume!((0..3).map(|k| (p[0][k] - p[1][k]).powi(2)).sum::<f64>() > 0.01);
        for which in [[true, false], [false, true], [true, true]] {
            assert_followed(x, &p, &r, &which, &logits, t, &[Transform::Rigid]);
        }
    }

    #[test]
    fn a_similarity_of_all_is_followed(
        p in points::<3>(6), x in prop::array::uniform(-1.0..1.0f64), r in any_rotation::<3>(), s in 0.2f64..3.0, which in prop::collection::vec(any::<bool>(), 6),
        logits in any_logits(6, 15.0), t in prop::sample::select(TEMPERATURES.to_vec()),
    ) {
        let m = matrix::scaled(&r, s);
        assert_followed(x, &p, &m, &which, &logits, t, &[Transform::Similarity, Transform::Affine]);
    }

    #[test]
    fn the_order_of_the_control_points_does_not_matter(
        p in points::<3>(6), q in points::<3>(6), turns in any_turns::<3>(6), logits in any_logits(6, 3.0),
    ) {
        fn reversed<T: Clone>(all: &[T]) -> Vec<T> {
            all.iter().rev().cloned().collect()
        }
        for transform in ALL {
            let (a, _) = deform([0.0; 3], &p, &q, &turns, &logits, 1.0, transform);
            let (b, _) =
                deform([0.0; 3], &reversed(&p), &reversed(&q), &reversed(&turns), &reversed(&logits), 1.0, transform);
            prop_assert!(close(a, b, 1e-6), "{:?} {:?}", a, b);
        }
    }

    #[test]
    fn the_units_do_not_matter(p in points::<3>(5), q in points::<3>(5), turns in any_turns::<3>(5), logits in any_logits(5, 5.0)) {
        let larger = |points: &[[f64; 3]]| -> Vec<[f64; 3]> { points.iter().map(|p| p.map(|c| 1000.0 * c)).collect() };
        for transform in ALL {
            let (a, _) = deform([0.1; 3], &p, &q, &turns, &logits, 1.0, transform);
            let (b, _) = deform([100.0; 3], &larger(&p), &larger(&q), &turns, &logits, 1.0, transform);
            prop_assert!(close(a.map(|c| 1000.0 * c), b, 1e-3), "{:?} {:?}", a, b);
        }
    }

    #[test]
    fn one_control_point_alone_turns_everything_about_it(
        p in points::<3>(1), q in points::<3>(1), r in any_rotation::<3>(), s in 0.3f64..3.0, x in prop::array::uniform(-1.0..1.0f64),
        t in prop::sample::select(TEMPERATURES.to_vec()),
    ) {
        for transform in ALL {
            let map = if transform == Transform::Rigid { r } else { matrix::scaled(&r, s) };
            let turned = matrix::apply(&map, &std::array::from_fn(|k| x[k] - p[0][k]));
            let (y, m) = deform(x, &p, &q, &vec![Some(matrix::scaled(&r, s))], &[0.7], t, transform);
            prop_assert!(close(y, std::array::from_fn(|k| q[0][k] + turned[k]), 1e-8));
            prop_assert!(m.iter().zip(map).all(|(a, b)| close(*a, b, 1e-8)));
        }
    }
}

/// A bar along z from 0 to 1, its ends turned; the angle in degrees at `s`, where the far end's logit is above the near one's by
/// `sharpness (2 s - 1)`.
fn twist(s: f64, near: f64, far: f64, sharpness: f64, t: f64) -> f64 {
    let ends = [[0.0; 3], [0.0, 0.0, 1.0]];
    let turns = vec![Some(about_z(near)), Some(about_z(far))];
    let logits = [0.0, (sharpness * (2.0 * s - 1.0)) as f32];
    let (_, m) = deform([0.1, 0.0, s], &ends, &ends, &turns, &logits, t, Transform::Rigid);
    m[1][0].atan2(m[0][0]).to_degrees()
}

#[test]
fn two_control_points_twist_a_bar_from_end_to_end() {
    for (near, far) in [(-45.0, 45.0), (-60.0, 60.0), (0.0, 120.0), (30.0, -30.0)] {
        let angles: Vec<f64> = (0..=100).map(|k| twist(f64::from(k) / 100.0, near, far, 6.0, 1.0)).collect();
        assert!((angles[0] - near).abs() < 0.1 && (angles[100] - far).abs() < 0.1, "{angles:?}");
        assert!((angles[50] - (near + far) / 2.0).abs() < 1e-4, "{}", angles[50]);
        let steps = angles.windows(2).map(|pair| (pair[1] - pair[0]) * (far - near).signum());
        for step in steps {
            assert!((0.0..12.0).contains(&step), "{near} to {far}: {step}");
        }
    }
}

#[test]
fn what_is_twisted_keeps_its_thickness() {
    let ends = [[0.0; 3], [0.0, 0.0, 1.0]];
    let turns = vec![Some(about_z(-60.0)), Some(about_z(60.0))];
    for s in [0.1, 0.4, 0.5, 0.9] {
        let logits = [0.0, (6.0 * (2.0 * s - 1.0)) as f32];
        let (y, _) = deform([0.1, 0.0, s], &ends, &ends, &turns, &logits, 1.0, Transform::Similarity);
        assert!((y[0].hypot(y[1]) - 0.1).abs() < 1e-9, "{y:?}");
    }
}

#[test]
fn low_temperatures_part_the_oriented_from_the_others() {
    let p = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let turns = vec![None, Some(about_z(90.0)), None, None];
    for t in [0.01, 0.02, 0.1] {
        let (_, turned) = deform([0.9, 0.0, 0.0], &p, &p, &turns, &[1.0, 4.0, 0.0, 2.0], t, Transform::Rigid);
        let expected = about_z(90.0);
        assert!((0..3).all(|k| close(turned[k], expected[k], 1e-6)), "{turned:?}");
        let (_, still) = deform(
            [0.1, 0.0, 0.0],
            &p,
            &p,
            &turns,
            &[4.0, 1.0, 2.0 - 10.0 * t as f32, 2.0],
            t,
            Transform::Rigid,
        );
        assert!((0..3).all(|k| (still[k][k] - 1.0).abs() < 1e-6), "{still:?}");
    }
}

#[test]
fn a_drag_of_the_turn_has_no_jumps() {
    let p = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 1.0]];
    for transform in ALL {
        for t in [0.1, 1.0] {
            let mut before: Option<[f64; 3]> = None;
            for degree in 0..=150 {
                let turns = vec![None, Some(about_z(f64::from(degree))), None, Some(about_z(-10.0)), None];
                let (y, _) =
                    deform([0.7, 0.2, 0.1], &p, &p, &turns, &[0.4, 0.9, 0.1, 0.3, 0.2], t, transform);
                assert!(
                    before.is_none_or(|before| close(y, before, 0.02)),
                    "{transform:?} at {degree}: {before:?} {y:?}"
                );
                before = Some(y);
            }
        }
    }
}

#[test]
fn lanes_agree_with_the_twin() {
    let mut state = 7u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    for m in [1, 2, 3, 7, 40] {
        let n = batch::BATCH;
        let mut place = || -> [f64; 3] { std::array::from_fn(|_| next()) };
        let (x, p): (Vec<_>, Vec<_>) = ((0..n).map(|_| place()).collect(), (0..m).map(|_| place()).collect());
        let q: Vec<[f64; 3]> = p
            .iter()
            .map(|_| place().map(|e| 0.3 * e))
            .zip(&p)
            .map(|(e, p)| std::array::from_fn(|k| p[k] + e[k]))
            .collect();
        let turns: Turns<3> = (0..m)
            .map(|i| {
                let r = rotation::best_rotation(&[place(), place(), place()]);
                (m < 3 || i % 3 != 1).then(|| matrix::scaled(&r, 1.0 + 0.3 * place()[0]))
            })
            .collect();
        let logits: Vec<f32> = (0..n * m).map(|_| 8.0 * place()[0] as f32).collect();
        for t in TEMPERATURES {
            let weights = PackedWeights::new(&logits, m, t, None).unwrap();
            for transform in ALL {
                let flat = flat(&turns);
                let handles = Mls::with_oriented(&p, &q, oriented(&flat, &p), transform);
                let kernel = handles.batch(crate::Frame::IDENTITY).unwrap();
                let (mut y, mut scratch) = (vec![0.0; 3 * n], batch::Scratch::new());
                let points = batch::BatchPoints { x: x.as_flattened(), y: &mut y, maps: &mut [] };
                kernel.deform(weights.blocks(0), points, &mut scratch);
                let unsound: Vec<usize> = scratch.unsound(n).collect();
                // Affine maps are not, where neither the control points nor their turns span the space.
                let most = if transform == Transform::Affine { n } else { n / 4 };
                assert!(unsound.len() < most, "{m}, T = {t}, {transform:?}: {}", unsound.len());
                for lane in (0..n).filter(|lane| !unsound.contains(lane)) {
                    let (twin, _) =
                        deform(x[lane], &p, &q, &turns, &logits[m * lane..m * (lane + 1)], t, transform);
                    let found = std::array::from_fn(|k| y[3 * lane + k]);
                    assert!(close(found, twin, 1e-5), "{m}, T = {t}, {transform:?}: {found:?} {twin:?}");
                }
            }
        }
    }
}

#[test]
fn what_is_no_turn_is_refused() {
    let refused = |turns: &[f64], m: usize, dim: usize| check(turns, m, dim).unwrap_err().to_string();
    assert!(refused(&[1.0; 5], 2, 2).contains("2 x 2 x 2"));
    let (good, none) = ([0.0, -2.0, 2.0, 0.0], [f64::NAN; 4]);
    assert_eq!(check(&[good, none].concat(), 2, 2), Ok(false));
    assert_eq!(check(&[none, none].concat(), 2, 2), Ok(true));
    assert_eq!(check(&[none, [1.0, 0.0, 0.0, 1.0]].concat(), 2, 2), Ok(true));
    let bad: [[f64; 4]; 5] = [
        [0.0; 4],
        [1.0, 0.0, 0.0, -1.0],
        [1.0, 0.1, 0.0, 1.0],
        [1.0, 0.0, f64::NAN, 1.0],
        [f64::INFINITY; 4],
    ];
    for bad in bad {
        assert!(refused(&[good, bad].concat(), 2, 2).contains("control point 1 is not a rotation"));
    }
    assert!(refused(&[-1.0], 1, 1).contains("control point 0"));
    assert!(refused(&[-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], 1, 3).contains("control point 0"));
}
