use super::*;
use crate::mls::Transform::{Affine, Rigid, Similarity};
use crate::{Frame, InverseDistance, Training};
use std::f64::consts::PI;

/// The surface of a bar along x, 6 x 1 x 1, as a cloud.
fn bar() -> Vec<f64> {
    let mut x = Vec::new();
    for i in 0..=60 {
        for k in 0..40 {
            let (along, at) = (0.1 * f64::from(i) - 3.0, f64::from(k % 10) / 10.0 - 0.5);
            let (y, z) = [(at, -0.5), (0.5, at), (-at, 0.5), (-0.5, -at)][k as usize / 10];
            x.extend([along, y, z]);
        }
    }
    x
}

/// The corners of `count` sections of it.
fn rings(count: usize) -> Vec<f64> {
    let along = |i: usize| 6.0 * i as f64 / (count - 1) as f64 - 3.0;
    let corners = [(-0.5, -0.5), (-0.5, 0.5), (0.5, 0.5), (0.5, -0.5)];
    (0..count).flat_map(|i| corners.into_iter().flat_map(move |(y, z)| [along(i), y, z])).collect()
}

fn twisted(p: &[f64], degrees: f64) -> Vec<f64> {
    let one = |x: &[f64]| {
        let (sin, cos) = (degrees.to_radians() * (x[0] + 3.0) / 6.0).sin_cos();
        [x[0], cos * x[1] - sin * x[2], sin * x[1] + cos * x[2]]
    };
    p.chunks_exact(3).flat_map(one).collect()
}

fn fitted(p: &[f64], dim: usize, frame: Frame) -> Weights {
    Weights::InverseDistance(InverseDistance::new(p, dim, frame, 1.0, 0.0).unwrap())
}

fn rules(transform: Transform, turns: Option<&[f64]>) -> Rules<'_> {
    Rules { transform, temperature: 1.0, careful: true, adherence: &[1.0], turns }
}

fn search(p: &[f64], x: &[f64], dim: usize, pose: Pose<'_>, rules: Rules<'_>) -> Composed {
    let refit: &Refit<'_> = &|p, frame, _| Ok(fitted(p, dim, frame));
    let watched = Watched::new(x, dim, &[]).unwrap();
    let weights = Arc::new(fitted(p, dim, Frame::around(x, dim)));
    Composed::search(weights, pose, rules, &watched, refit, &mut |_| true).unwrap()
}

fn at(composed: &Composed, x: &[f64]) -> Vec<f64> {
    let bound =
        Deformer::new(x.to_vec(), &composed.steps()[0].weights, None, composed.transform, &mut |_| true);
    composed.deform(&bound.unwrap(), false, &mut |_| true).unwrap().positions
}

/// The greatest distance.
fn off(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// A point of the plane through its neighbour's place, and past it.
fn past_each_other() -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let grid: Vec<f64> =
        (0..2500).flat_map(|i| [f64::from(i % 50) / 49.0, f64::from(i / 50) / 49.0]).collect();
    let p = vec![0.2, 0.5, 0.45, 0.5, 0.8, 0.2, 0.8, 0.8, 0.2, 0.1, 0.2, 0.9];
    let mut q = p.clone();
    (q[0], q[1]) = (0.55, 0.7);
    (grid, p, q)
}

#[test]
fn what_folds_in_one_step_folds_nothing_in_several_and_arrives() {
    let (x, p, q) = past_each_other();
    let one =
        Deformer::new(x.clone(), &fitted(&p, 2, Frame::around(&x, 2)), None, Rigid, &mut |_| true).unwrap();
    let flat = one.deform(&q, 1.0, false, &mut |_| true).unwrap().positions;
    for transform in [Rigid, Similarity, Affine] {
        let composed = search(&p, &x, 2, Pose::from(&q), rules(transform, None));
        assert!(composed.steps().len() > 1 && composed.found().folded == 0.0, "{transform:?}");
        assert!(composed.found().least > 0.0, "{transform:?} {}", composed.found().least);
        assert!(off(&composed.land().unwrap().positions, &q) < 1e-9, "{transform:?}");
        assert_eq!(folded(&at(&composed, &x)), 0, "{transform:?}");
    }
    assert!(folded(&flat) > 0, "{}", folded(&flat));
}

/// Triangles of the grid that are turned over.
fn folded(y: &[f64]) -> usize {
    let at = |i: usize| [y[2 * i], y[2 * i + 1]];
    let area = |a: usize, b: usize, c: usize| {
        let [a, b, c] = [a, b, c].map(at);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    let cells = (0..49).flat_map(|r| (0..49).map(move |c| 50 * r + c));
    cells.filter(|&i| area(i, i + 1, i + 51) <= 0.0 || area(i, i + 51, i + 50) <= 0.0).count()
}

#[test]
fn where_one_step_folds_nothing_it_is_that_one_to_the_bit() {
    let (x, p) = (bar(), rings(4));
    let still = search(&p, &x, 3, Pose::from(&p), rules(Rigid, None));
    assert_eq!((still.steps().len(), at(&still, &x)), (1, x.clone()));
    let q: Vec<f64> = p.iter().enumerate().map(|(k, c)| c + 0.1 * (k as f64).sin()).collect();
    let one = search(&p, &x, 3, Pose::from(&q), rules(Rigid, None));
    assert_eq!(one.steps().len(), 1);
    let weights = fitted(&p, 3, Frame::around(&x, 3));
    let aim = crate::Handles::new(&weights, Rigid).unwrap().aim_carefully(&q, 1.0, &[1.0]).unwrap();
    let bound = Deformer::new(x.clone(), &weights, None, Rigid, &mut |_| true).unwrap();
    let plain = bound.deform(&aim.targets, 1.0, false, &mut |_| true).unwrap().positions;
    assert_eq!(at(&one, &x), plain);
    // A motion of all of them, however far.
    let turned: Vec<f64> = p.chunks_exact(3).flat_map(|x| [7.0 - x[1], x[0], x[2]]).collect();
    let motion = search(&p, &x, 3, Pose::from(&turned), rules(Rigid, None));
    assert_eq!(motion.steps().len(), 1);
}

#[test]
fn the_way_begins_at_rest_ends_at_the_targets_and_stays_away_from_the_axis() {
    let (p, q) = (rings(7), twisted(&rings(7), 360.0));
    let motion = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let path = path::Path::<3>::new(&p, Pose::from(&q), None, &motion);
    assert!(off(&path.leg(&p, 0.0, 1e-12).targets, &p) < 1e-9);
    assert_eq!(path.leg(&p, 0.5, 1.0).targets, q);
    assert!(off(&path.leg(&p, 0.5, 1.0 - 1e-12).targets, &q) < 1e-9);
    for t in [0.25, 0.5, 0.75] {
        let half = path.leg(&p, 0.0, t).targets;
        for place in half.chunks_exact(3) {
            let radius = place[1].hypot(place[2]);
            // On a straight line the middle would meet on the axis.
            let part = radius / 0.5f64.sqrt();
            assert!((0.6..1.1).contains(&part), "{part} at {t}");
        }
    }
}

/// Where the middle of the bar ends, as an angle about its axis.
fn middle_of(degrees: f64) -> (usize, f64) {
    let (x, p) = (bar(), [-3.0, 0.0, 0.0, 3.0, 0.0, 0.0]);
    let (sin, cos) = degrees.to_radians().sin_cos();
    let mut orientations = vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    orientations.extend([1.0, 0.0, 0.0, 0.0, cos, -sin, 0.0, sin, cos]);
    let turns = [0.0, 0.0, 0.0, degrees.to_radians(), 0.0, 0.0];
    let pose = Pose { q: &p, orientations: Some(&orientations) };
    let composed = search(&p, &x, 3, pose, rules(Rigid, Some(&turns)));
    let y = at(&composed, &[0.0, 0.5, 0.0]);
    (composed.steps().len(), y[2].atan2(y[1]).to_degrees().rem_euclid(360.0))
}

#[test]
fn degrees_stay_numbers() {
    // Half a turn of the middle, whichever way round; and 540 degrees of an end are 270 of the middle, not -90.
    let (steps, angle) = middle_of(170.0);
    assert!(steps == 1 && (angle - 85.0).abs() < 1.0, "{steps} {angle}");
    for degrees in [360.0, 540.0, -540.0] {
        let (steps, angle) = middle_of(degrees);
        let expected = (degrees / 2.0f64).rem_euclid(360.0);
        assert!(steps > 1 && (angle - expected).abs() < 2.0, "{degrees}: {steps} {angle}");
    }
}

#[test]
fn of_all_that_turn_by_350_degrees_the_motion_is_one_step() {
    let (x, p) = (bar(), [-3.0, 0.0, 0.0, 3.0, 0.0, 0.0]);
    let (sin, cos) = 350f64.to_radians().sin_cos();
    let orientations = [1.0, 0.0, 0.0, 0.0, cos, -sin, 0.0, sin, cos].repeat(2);
    let turns = [350f64.to_radians(), 0.0, 0.0].repeat(2);
    let pose = Pose { q: &p, orientations: Some(&orientations) };
    assert_eq!(search(&p, &x, 3, pose, rules(Rigid, Some(&turns))).steps().len(), 1);
}

#[test]
fn maps_are_multiplied_along_the_way() {
    let (x, p, q) = past_each_other();
    let composed = search(&p, &x, 2, Pose::from(&q), rules(Rigid, None));
    let weights = &composed.steps()[0].weights;
    let bound = Deformer::new(x[..20].to_vec(), weights, None, Rigid, &mut |_| true).unwrap();
    let deformed = composed.deform(&bound, true, &mut |_| true).unwrap();
    let mut expected = vec![[1.0, 0.0, 0.0, 1.0]; 10];
    let mut y = x[..20].to_vec();
    for step in composed.steps() {
        let bound = Deformer::new(y, &step.weights, None, Rigid, &mut |_| true).unwrap();
        let moved = bound.deform(step.pose(), 1.0, true, &mut |_| true).unwrap();
        for (b, a) in expected.iter_mut().zip(moved.maps.unwrap().chunks_exact(4)) {
            *b = [
                a[0] * b[0] + a[1] * b[2],
                a[0] * b[1] + a[1] * b[3],
                a[2] * b[0] + a[3] * b[2],
                a[2] * b[1] + a[3] * b[3],
            ];
        }
        y = moved.positions;
    }
    assert!(off(&deformed.positions, &y) < 1e-14);
    assert!(off(&deformed.maps.unwrap(), expected.as_flattened()) < 1e-14);
}

#[test]
fn the_same_twice_and_networks_too() {
    let (x, p, q) = past_each_other();
    let training = Training { width: 32, ..Training::default() };
    let refit: &Refit<'_> = &|p, frame, progress| Weights::neural(p, 2, frame, &training, progress);
    let watched = Watched::new(&x, 2, &[]).unwrap();
    let weights = Arc::new(refit(&p, Frame::around(&x, 2), &mut |_| true).unwrap());
    let mut told = Vec::new();
    let found: Vec<Vec<f64>> = (0..2)
        .map(|_| {
            told.clear();
            let mut progress = |done: f64| {
                told.push(done);
                true
            };
            let rules = rules(Rigid, None);
            let composed =
                Composed::search(weights.clone(), &q, rules, &watched, refit, &mut progress).unwrap();
            assert!(composed.steps().len() > 1 && off(&composed.land().unwrap().positions, &q) < 1e-6);
            at(&composed, &x)
        })
        .collect();
    assert_eq!(found[0], found[1]);
    assert!(told.is_sorted() && told[0] == 0.0 && told[told.len() - 1] == 1.0, "{told:?}");
    let mut left = 8;
    let mut stop = |_: f64| {
        left -= 1;
        left > 0
    };
    let stopped = Composed::search(weights, &q, rules(Rigid, None), &watched, refit, &mut stop);
    assert!(matches!(stopped, Err(Error::Cancelled)));
}

#[test]
fn steps_are_undone_and_their_jacobians_multiplied() {
    let (x, p, q) = past_each_other();
    let composed = search(&p, &x, 2, Pose::from(&q), rules(Rigid, None));
    let some: Vec<f64> = x.chunks_exact(2).step_by(37).flatten().copied().collect();
    let y = at(&composed, &some);
    let back = composed.inverse(&y, true, &mut |_| true).unwrap();
    // Points are bound by logits of single precision.
    assert!(back.missed.is_empty() && off(&back.points, &some) < 1e-7, "{}", off(&back.points, &some));
    let bound =
        Deformer::new(some.clone(), &composed.steps()[0].weights, None, Rigid, &mut |_| true).unwrap();
    let mut product = composed.deform(&bound, true, &mut |_| true).unwrap().maps.unwrap();
    multiply(&back.maps.unwrap(), &mut product, 2);
    assert!(off(&product, &[1.0, 0.0, 0.0, 1.0].repeat(some.len() / 2)) < 1e-6);
    let jacobians = composed.jacobians(&some, &mut |_| true).unwrap();
    for axis in 0..2 {
        let beside = |way: f64| {
            let mut beside = some.clone();
            beside.iter_mut().skip(axis).step_by(2).for_each(|c| *c += way * 1e-5);
            at(&composed, &beside)
        };
        let (up, down) = (beside(1.0), beside(-1.0));
        for (k, (up, down)) in up.iter().zip(&down).enumerate() {
            let expected = (up - down) / 2e-5;
            let found = jacobians[4 * (k / 2) + 2 * (k % 2) + axis];
            assert!((found - expected).abs() < 1e-3 * expected.abs().max(1.0), "{found} {expected}");
        }
    }
}

#[test]
fn one_dimension_has_no_turns() {
    let x: Vec<f64> = (0..200).map(|i| f64::from(i) / 100.0).collect();
    let composed =
        search(&[0.0, 0.9, 1.1, 2.0], &x, 1, Pose::from(&[0.0, 1.4, 1.5, 2.0]), rules(Rigid, None));
    assert!(off(&composed.land().unwrap().positions, &[0.0, 1.4, 1.5, 2.0]) < 1e-9);
    assert!(composed.found().least > 0.0 && at(&composed, &x).is_sorted());
}

#[test]
fn places_and_steps_are_checked() {
    assert!(Watched::of(vec![1.0], 1).is_err() && Watched::of(vec![1.0, f64::NAN], 1).is_err());
    let found = Found { least: 1.0, folded: 0.0, folded_around: 0.0, place: vec![0.0] };
    let none = Composed::of(Vec::new(), Rigid, 1.0, Vec::new(), found.clone());
    assert!(none.is_err());
    let weights = Arc::new(fitted(&[0.0, 1.0], 1, Frame::IDENTITY));
    let step = Step { weights, targets: vec![0.0], orientations: None };
    assert!(Composed::of(vec![step], Rigid, 1.0, vec![0.0; 2], found).is_err());
    assert!(middle_of(PI).0 == 1);
}
