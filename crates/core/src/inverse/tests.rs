use super::*;
use crate::geometry::Frame;
use crate::machine::random::Random;
use crate::softmax::relative_weights;
use crate::weights::inverse_distance::InverseDistance;
use crate::weights::network::Training;

const KINDS: [Transform; 3] = [Transform::Rigid, Transform::Similarity, Transform::Affine];

fn numbers(random: &mut Random, count: usize) -> Vec<f64> {
    (0..count).map(|_| 2.0 * random.unit() - 1.0).collect()
}

fn distance_weights(p: &[f64], dim: usize, alpha: f64, epsilon: f64) -> Weights {
    Weights::InverseDistance(InverseDistance::new(p, dim, Frame::IDENTITY, alpha, epsilon).unwrap())
}

/// The map in double precision throughout, point by point: the naive twin. What is inverted differs from [`Deformer`] by the rounding of its logits.
fn forward(motion: &Motion<'_>, x: &[f64]) -> Vec<f64> {
    fn in_dimension<const D: usize>(motion: &Motion<'_>, x: &[f64]) -> Vec<f64> {
        let weights = motion.weights;
        let m = weights.control_points().len() / D;
        motion.with::<D, _>(|field| {
            let (mut relative, frame) = (vec![0.0; m], field.frame);
            let moved = |x: &[f64]| -> [f64; D] {
                let logits: Vec<f64> = match weights {
                    Weights::InverseDistance(f) => f
                        .control_points()
                        .chunks_exact(D)
                        .map(|p| {
                            let squared: f64 = (0..D).map(|k| ((x[k] - p[k]) / frame.half).powi(2)).sum();
                            -(squared.powf(f.alpha()) + f.epsilon()).ln()
                        })
                        .collect(),
                    Weights::Neural(t) | Weights::ShapeAware(t) => {
                        let at: [f64; D] = frame.enter(x);
                        let turns = |row: &[f32]| -> f64 {
                            let turns = row.iter().zip(at).map(|(b, x)| f64::from(*b) * x).sum::<f64>();
                            std::f64::consts::TAU * turns
                        };
                        let rows = || t.network.frequencies().chunks_exact(D).map(turns);
                        let mut values: Vec<f64> = at.to_vec();
                        values.extend(rows().map(f64::sin));
                        values.extend(rows().map(f64::cos));
                        for (at, layer) in t.network.layers().iter().enumerate() {
                            let rows = layer.weight.chunks_exact(values.len()).zip(&layer.bias);
                            let next = |(row, bias): (&[f32], &f32)| {
                                let sum: f64 = row.iter().zip(&values).map(|(w, v)| f64::from(*w) * v).sum();
                                let sum = sum + f64::from(*bias);
                                if at < 2 {
                                    sum.max(0.0)
                                } else {
                                    sum
                                }
                            };
                            values = rows.map(next).collect();
                        }
                        values
                    }
                };
                let dominant = relative_weights(&logits, motion.temperature, &mut relative);
                let local = field.mls.deform(&frame.enter(x), &relative, dominant);
                std::array::from_fn(|k| x[k] + frame.half * local.displacement[k])
            };
            x.chunks_exact(D).flat_map(moved).collect()
        })
    }
    match motion.weights.dim() {
        1 => in_dimension::<1>(motion, x),
        2 => in_dimension::<2>(motion, x),
        _ => in_dimension::<3>(motion, x),
    }
}

/// Central differences of it.
fn differences(motion: &Motion<'_>, x: &[f64], step: f64) -> Vec<f64> {
    let dim = motion.weights.dim();
    let mut jacobians = vec![0.0; x.len() * dim];
    for c in 0..dim {
        let beside = |by: f64| {
            let x: Vec<f64> =
                x.iter().enumerate().map(|(at, x)| if at % dim == c { x + by } else { *x }).collect();
            forward(motion, &x)
        };
        for (at, (up, down)) in beside(step).iter().zip(beside(-step)).enumerate() {
            jacobians[dim * at + c] = (up - down) / (2.0 * step);
        }
    }
    jacobians
}

fn farthest(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Orientations of some of them: small turns, and scales.
fn orientations(random: &mut Random, m: usize, dim: usize) -> Vec<f64> {
    let mut all = vec![f64::NAN; m * dim * dim];
    for of_one in all.chunks_exact_mut(dim * dim).step_by(2) {
        let (angle, scale) = (random.unit() - 0.5, 0.7 + 0.6 * random.unit());
        of_one
            .iter_mut()
            .enumerate()
            .for_each(|(at, e)| *e = scale * f64::from(u8::from(at % (dim + 1) == 0)));
        if dim > 1 {
            let (sin, cos) = angle.sin_cos();
            (of_one[0], of_one[1]) = (scale * cos, -scale * sin);
            (of_one[dim], of_one[dim + 1]) = (scale * sin, scale * cos);
        }
    }
    all
}

#[test]
fn the_jacobian_is_what_differences_say() {
    let mut random = Random::new(5);
    for case in 0..180 {
        let (dim, transform) = (1 + case % 3, KINDS[case / 3 % 3]);
        let temperature = [0.5, 1.0, 2.0][case / 9 % 3];
        let (alpha, epsilon) = [(1.0, 0.0), (2.0, 0.0), (1.0, 1e-2), (0.5, 0.0)][case % 4];
        let m = 3 + case % 6;
        let p = numbers(&mut random, m * dim);
        let q: Vec<f64> = p.iter().map(|c| c + 0.2 * (random.unit() - 0.5)).collect();
        let turned = orientations(&mut random, m, dim);
        let pose = Pose { q: &q, orientations: (case % 2 == 0).then_some(&turned) };
        let weights = distance_weights(&p, dim, alpha, epsilon);
        let motion = Motion::new(&weights, pose, temperature, transform).unwrap();
        // Not beside a control point, where differences are over less than what changes.
        let mut x = numbers(&mut random, 30 * dim);
        let apart = |x: &[f64]| p.chunks(dim).all(|p| farthest(x, p) > 0.05);
        x = x.chunks(dim).filter(|x| apart(x)).flatten().copied().collect();
        let found = motion.jacobians(&x, &mut |_| true).unwrap();
        let expected = differences(&motion, &x, 1e-5);
        let size = expected.iter().fold(1.0f64, |most, e| most.max(e.abs()));
        let error = farthest(&found, &expected) / size;
        assert!(error < 2e-6, "case {case}: {dim}D, {transform:?}, T {temperature}, alpha {alpha}: {error}");
    }
}

#[test]
fn of_a_network_too() {
    let mut random = Random::new(8);
    for (case, fourier_sigma) in [None, None, None, Some(0.5)].into_iter().enumerate() {
        let dim = 1 + case % 3;
        let p = numbers(&mut random, 6 * dim);
        let q: Vec<f64> = p.iter().map(|c| c + 0.1 * (random.unit() - 0.5)).collect();
        let training = Training { width: 40, fourier_sigma, ..Training::default() };
        let weights = Weights::neural(&p, dim, Frame::IDENTITY, &training, &mut |_| true).unwrap();
        let motion = Motion::new(&weights, &q, 1.0, KINDS[case % 3]).unwrap();
        // Densely, and by the walk down the tree.
        for count in [20, 2000] {
            let x = numbers(&mut random, count * dim);
            let found = motion.jacobians(&x, &mut |_| true).unwrap();
            let expected = differences(&motion, &x, 1e-6);
            let of_point = |at: usize| at * dim * dim..(at + 1) * dim * dim;
            let differ = |at: &usize| farthest(&found[of_point(*at)], &expected[of_point(*at)]) > 1e-4;
            // Differences across a kink are of both sides.
            let kinks = (0..count).filter(differ).count();
            assert!(kinks * 200 <= count, "{kinks} of {count} in {dim}D");
        }
    }
}

/// Round trips through the twin: the most that is left of `f(inverse(y)) - y` and of `inverse(f(x)) - x`; none may be missed.
fn returned(motion: &Motion<'_>, x: &[f64]) -> f64 {
    let y = forward(motion, x);
    let back = motion.inverse(&y, false, &mut |_| true).unwrap();
    assert_eq!(back.missed, [0; 0]);
    farthest(&forward(motion, &back.points), &y).max(farthest(&back.points, x))
}

/// Control points apart from each other, and moves that are too small to fold anything.
fn gentle(random: &mut Random, dim: usize) -> (Vec<f64>, Vec<f64>) {
    let place = |at: usize, random: &mut Random| match at % dim {
        0 => (at / dim) as f64 / 4.0 - 0.9,
        _ => random.unit() - 0.5,
    };
    let p: Vec<f64> = (0..8 * dim).map(|at| place(at, random)).collect();
    let q = p.iter().map(|c| c + 0.04 * (random.unit() - 0.5)).collect();
    (p, q)
}

#[test]
fn what_was_moved_comes_back() {
    let mut random = Random::new(11);
    for case in 0..54 {
        let (dim, transform) = (1 + case % 3, KINDS[case / 3 % 3]);
        let temperature = [0.5, 1.0, 2.0][case / 9 % 3];
        let (p, q) = gentle(&mut random, dim);
        let weights = distance_weights(&p, dim, 1.0, if case < 27 { 0.0 } else { 1e-3 });
        let turned = orientations(&mut random, 8, dim);
        let oriented = case % 4 == 0 && dim == 1;
        let pose = Pose { q: &q, orientations: oriented.then_some(&turned) };
        let motion = Motion::new(&weights, pose, temperature, transform).unwrap();
        // Control points too, where weights are singular, and far away.
        let mut x = numbers(&mut random, 300 * dim);
        x.extend(&p);
        x.extend(numbers(&mut random, 4 * dim).iter().map(|c| 50.0 * c));
        let left = returned(&motion, &x);
        assert!(left < 1e-12, "case {case}: {dim}D, {transform:?}, T {temperature}: {left}");
    }
}

#[test]
fn by_a_network_too_as_far_as_single_precision_goes() {
    let mut random = Random::new(12);
    for case in 0..9 {
        let (dim, transform) = (1 + case % 3, KINDS[case / 3 % 3]);
        let (p, q) = gentle(&mut random, dim);
        let training = Training { width: 64, ..Training::default() };
        let weights = Weights::neural(&p, dim, Frame::IDENTITY, &training, &mut |_| true).unwrap();
        let motion = Motion::new(&weights, &q, 1.0, transform).unwrap();
        let left = returned(&motion, &numbers(&mut random, 500 * dim));
        // In units of half a side.
        assert!(left < 5e-7, "case {case}: {dim}D, {transform:?}: {left}");
    }
}

#[test]
fn an_unmoved_map_leaves_points_bit_for_bit() {
    let mut random = Random::new(13);
    let (p, _) = gentle(&mut random, 3);
    let weights = distance_weights(&p, 3, 1.0, 0.0);
    let motion = Motion::new(&weights, &p, 1.0, Transform::Affine).unwrap();
    let y = numbers(&mut random, 30);
    let back = motion.inverse(&y, true, &mut |_| true).unwrap();
    assert_eq!((back.points, back.missed), (y.clone(), vec![]));
    let unit = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0].repeat(10);
    assert_eq!(back.maps.unwrap(), unit);
    assert_eq!(motion.jacobians(&y, &mut |_| true).unwrap(), unit);
}

/// The inverse of a motion of all control points is the inverse motion, wherever they are: in space, on a line, two, one.
#[test]
fn a_rigid_motion_is_undone_by_the_inverse_motion() {
    let (sin, cos) = 2.5f64.sin_cos();
    let by = [3.0, -2.0, 0.5];
    let turn = |x: &[f64]| [cos * x[0] - sin * x[1] + by[0], sin * x[0] + cos * x[1] + by[1], x[2] + by[2]];
    let mut random = Random::new(14);
    let x = numbers(&mut random, 300);
    let y: Vec<f64> = x.chunks(3).flat_map(turn).collect();
    let space = numbers(&mut random, 18);
    for (p, collinear) in [(space, false), ([[1.0, 0.0, 0.0], [0.0; 3], [-0.5, 0.0, 0.0]].concat(), true)] {
        let q: Vec<f64> = p.chunks(3).flat_map(turn).collect();
        let weights = distance_weights(&p, 3, 1.0, 0.0);
        for transform in KINDS {
            let motion = Motion::new(&weights, &q, 0.7, transform).unwrap();
            let back = motion.inverse(&y, true, &mut |_| true).unwrap();
            assert_eq!(back.missed, [0; 0]);
            // About the line that all are on nothing says how they turn, and least squares say what is least.
            let expected = if collinear { &forward(&motion, &back.points) } else { &back.points };
            assert!(farthest(expected, if collinear { &y } else { &x }) < 1e-8, "{transform:?}");
            let jacobian = motion.jacobians(&x[..3], &mut |_| true).unwrap();
            assert!((jacobian[0] - cos).abs() < 1e-6 && (jacobian[3] - sin).abs() < 1e-6, "{jacobian:?}");
        }
    }
    let weights = distance_weights(&[0.0; 3], 3, 1.0, 0.0);
    let back = Motion::new(&weights, &by, 1.0, Transform::Rigid).unwrap().inverse(&by, false, &mut |_| true);
    assert!(farthest(&back.unwrap().points, &[0.0; 3]) < 1e-12);
}

#[test]
fn on_a_control_point_the_jacobian_is_its_local_map() {
    let mut random = Random::new(15);
    let (p, q) = gentle(&mut random, 3);
    let weights = distance_weights(&p, 3, 1.0, 0.0);
    for transform in KINDS {
        let motion = Motion::new(&weights, &q, 1.0, transform).unwrap();
        let at = motion.jacobians(&p, &mut |_| true).unwrap();
        let beside: Vec<f64> = p.iter().map(|c| c + 1e-7).collect();
        assert!(farthest(&at, &motion.jacobians(&beside, &mut |_| true).unwrap()) < 1e-4);
        let back = motion.inverse(&q, true, &mut |_| true).unwrap();
        assert!(farthest(&back.points, &p) < 1e-14);
        let maps = back.maps.unwrap();
        for (there, back) in at.chunks(9).zip(maps.chunks(9)) {
            let unit = |r: usize, c: usize| (0..3).map(|k| there[3 * r + k] * back[3 * k + c]).sum::<f64>();
            assert!((0..9).all(|i| (unit(i / 3, i % 3) - f64::from(u8::from(i % 4 == 0))).abs() < 1e-9));
        }
    }
}

#[test]
fn the_order_of_control_points_does_not_matter() {
    let mut random = Random::new(16);
    let (p, q) = gentle(&mut random, 3);
    let reversed = |points: &[f64]| points.chunks(3).rev().flatten().copied().collect::<Vec<f64>>();
    let (weights, other) = (distance_weights(&p, 3, 1.0, 0.0), distance_weights(&reversed(&p), 3, 1.0, 0.0));
    let y = numbers(&mut random, 150);
    let back = |weights: &Weights, q: &[f64]| {
        let motion = Motion::new(weights, q, 1.0, Transform::Similarity).unwrap();
        motion.inverse(&y, false, &mut |_| true).unwrap().points
    };
    assert!(farthest(&back(&weights, &q), &back(&other, &reversed(&q))) < 1e-12);
}

/// Control points that change places fold what is between them.
#[test]
fn where_a_map_folds_places_are_missed_and_the_others_come_back() {
    let p = [-1.0, -0.2, 0.2, 1.0];
    let weights = distance_weights(&p, 1, 1.0, 0.0);
    let motion = Motion::new(&weights, &[-1.0, 0.2, -0.2, 1.0], 1.0, Transform::Rigid).unwrap();
    let x: Vec<f64> = (0..2001).map(|i| i as f64 / 1000.0 - 1.0).collect();
    assert!(motion.jacobians(&x, &mut |_| true).unwrap().iter().any(|det| *det < 0.0));
    let y: Vec<f64> = (0..401).map(|i| i as f64 / 100.0 - 2.0).collect();
    let back = motion.inverse(&y, false, &mut |_| true).unwrap();
    assert!(back.points.iter().all(|x| x.is_finite()));
    let there = forward(&motion, &back.points);
    let upright = motion.jacobians(&back.points, &mut |_| true).unwrap();
    for at in (0..y.len()).filter(|at| back.missed.binary_search(at).is_err()) {
        assert!(
            (there[at] - y[at]).abs() < 1e-10 && upright[at] > 0.0,
            "{}: {} {}",
            y[at],
            there[at],
            upright[at]
        );
    }
    // A target that turns space inside out where it lies alone has no place left that goes there upright.
    let flat = distance_weights(&[-1.0, 1.0], 1, 1.0, 0.0);
    let motion = Motion::new(&flat, &[0.0, 0.0], 1.0, Transform::Affine).unwrap();
    assert_eq!(motion.inverse(&[0.5], false, &mut |_| true).unwrap().missed, [0]);
}

#[test]
fn what_does_not_fit_is_refused() {
    let weights = distance_weights(&[0.0, 1.0], 1, 1.0, 0.0);
    assert!(Motion::new(&weights, &[0.0], 1.0, Transform::Rigid).is_err());
    assert!(Motion::new(&weights, &[0.0, 1.0], 0.0, Transform::Rigid).is_err());
    let motion = Motion::new(&weights, &[0.0, 2.0], 1.0, Transform::Affine).unwrap();
    assert!(motion.inverse(&[f64::NAN], false, &mut |_| true).is_err());
    assert!(motion.jacobians(&[f64::INFINITY], &mut |_| true).is_err());
    assert_eq!(motion.inverse(&[0.5], false, &mut |_| false), Err(Error::Cancelled));
    assert_eq!(motion.inverse(&[], false, &mut |_| true).unwrap().points, [0.0; 0]);
}
