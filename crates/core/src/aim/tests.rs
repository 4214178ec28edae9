//! Handles arrive, and where they cannot, they say so; the laws of MLS still hold.

use super::*;
use proptest::prelude::*;

const ALL: [Transform; 3] = [Transform::Rigid, Transform::Similarity, Transform::Affine];

/// Logits that leave each of the `p` about `own` of the weight at its own place, the rest shared by distance.
fn logits(p: &[f64], dim: usize, own: f64) -> Vec<f32> {
    let m = p.len() / dim;
    let mut logits = Vec::new();
    for i in 0..m {
        let others: Vec<f64> = (0..m)
            .map(|k| (0..dim).map(|c| (p[i * dim + c] - p[k * dim + c]).powi(2)).sum::<f64>())
            .map(|square| if square == 0.0 { 0.0 } else { 1.0 / square })
            .collect();
        let sum: f64 = others.iter().sum();
        logits.extend((0..m).map(|k| (if k == i { own } else { (1.0 - own) * others[k] / sum }).ln() as f32));
    }
    logits
}

fn handles(p: &[f64], dim: usize, own: f64, transform: Transform) -> Handles {
    Handles::of_logits(p, dim, logits(p, dim, own), transform).unwrap()
}

fn arrived(handles: &Handles, targets: &[f64]) -> Vec<f64> {
    handles.handles.deform(targets, 1.0, false, &mut |_| true).unwrap().positions
}

fn furthest(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |worst, (a, b)| worst.max((a - b).abs()))
}

/// Points in general position, the same every time.
fn points(m: usize, dim: usize) -> Vec<f64> {
    (0..m * dim)
        .map(|at| (at as f64 * 12.9898 + 4.1).sin() * 43758.5453)
        .map(|v| 2.0 * (v - v.floor()) - 1.0)
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn handles_arrive(m in 2usize..13, dim in 1usize..4, own in 0.6f64..0.99, seed in 0.0f64..10.0) {
        let p = points(m, dim);
        let q: Vec<f64> = p.iter().enumerate().map(|(at, p)| p + 0.1 * (at as f64 * 1.7 + seed).sin()).collect();
        for transform in ALL {
            let handles = handles(&p, dim, own, transform);
            let aim = handles.aim(&q, 1.0, &[1.0]).unwrap();
            let found = furthest(&arrived(&handles, &aim.targets), &q);
            prop_assert!(found < 1e-8, "{transform:?} {found}");
            prop_assert!(aim.misses.iter().all(|miss| *miss < 1e-8));
        }
    }
}

#[test]
fn unmoved_and_rigidly_moved_control_points_are_their_own_aim() {
    let p = points(6, 3);
    // A quarter turn around z, and a shift.
    let moved: Vec<f64> = p.chunks_exact(3).flat_map(|p| [-p[1] + 2.0, p[0], p[2] - 1.0]).collect();
    for transform in ALL {
        let handles = handles(&p, 3, 0.7, transform);
        assert_eq!(handles.aim(&p, 1.0, &[1.0]).unwrap().targets, p);
        let aim = handles.aim(&moved, 1.0, &[1.0]).unwrap();
        assert!(furthest(&aim.targets, &moved) < 1e-9, "{transform:?}");
    }
}

#[test]
fn adherence_goes_from_where_mls_leaves_the_handles_to_their_targets() {
    let p = points(8, 3);
    let q: Vec<f64> = p.iter().enumerate().map(|(at, p)| p + 0.2 * (at as f64).cos()).collect();
    let handles = handles(&p, 3, 0.7, Transform::Rigid);
    let soft = arrived(&handles, &q);
    assert_eq!(handles.aim(&q, 1.0, &[0.0]).unwrap().targets, q);
    for adherence in [0.25, 0.5, 0.9] {
        let aim = handles.aim(&q, 1.0, &[adherence]).unwrap();
        let expected: Vec<f64> = soft.iter().zip(&q).map(|(s, q)| s + adherence * (q - s)).collect();
        assert!(furthest(&arrived(&handles, &aim.targets), &expected) < 1e-8);
    }
    for adherence in [-0.1, 1.1, f64::NAN] {
        assert!(handles.aim(&q, 1.0, &[adherence]).is_err());
    }
}

#[test]
fn a_drag_has_no_jumps() {
    let p = points(8, 3);
    let handles = handles(&p, 3, 0.6, Transform::Rigid);
    let mut last: Option<Vec<f64>> = None;
    for step in 0..400 {
        let mut q = p.clone();
        q[0] += 0.005 * f64::from(step);
        q[4] -= 0.003 * f64::from(step);
        let aim = handles.aim(&q, 1.0, &[1.0]).unwrap().targets;
        if let Some(last) = last {
            assert!(furthest(&aim, &last) < 0.05, "step {step}: {}", furthest(&aim, &last));
        }
        last = Some(aim);
    }
}

/// Two control points of five with the same weights everywhere, which are to go to different places.
fn of_one_mind() -> ([Vec<f64>; 2], Vec<f32>) {
    let p = points(5, 3);
    let mut logits = logits(&p, 3, 0.8);
    logits[1] = logits[0];
    let first: Vec<f32> = logits[0..5].to_vec();
    logits[5..10].copy_from_slice(&first);
    let mut q = p.clone();
    q[0] += 0.5;
    q[3] -= 0.5;
    ([p, q], logits)
}

#[test]
fn what_cannot_be_reached_is_told_and_stays_finite() {
    let ([p, q], logits) = of_one_mind();
    for transform in ALL {
        let handles = Handles::of_logits(&p, 3, logits.clone(), transform).unwrap();
        let aim = handles.aim(&q, 1.0, &[1.0]).unwrap();
        assert!(
            aim.targets.iter().all(|t| t.is_finite() && t.abs() < 100.0),
            "{transform:?} {:?}",
            aim.targets
        );
        let soft: f64 = arrived(&handles, &q).iter().zip(&q).map(|(a, b)| (a - b).powi(2)).sum();
        let left: f64 = aim.misses.iter().map(|miss| miss * miss).sum();
        assert!(left <= soft, "{transform:?}: {left} {soft}");
        // Only a rigid map cannot stretch the way between the two.
        assert!(transform != Transform::Rigid || aim.misses[0] > 0.1, "{:?}", aim.misses);
    }
}

#[test]
fn the_order_of_the_control_points_does_not_matter() {
    let (p, own) = (points(6, 3), 0.7);
    let q: Vec<f64> = p.iter().map(|v| v + 0.2 * (9.0 * v).sin()).collect();
    let turned = |v: &[f64]| [&v[6..], &v[..6]].concat();
    let here = handles(&p, 3, own, Transform::Rigid).aim(&q, 1.0, &[1.0]).unwrap();
    let there = handles(&turned(&p), 3, own, Transform::Rigid).aim(&turned(&q), 1.0, &[1.0]).unwrap();
    assert!(furthest(&turned(&here.targets), &there.targets) < 1e-8);
}

#[test]
fn one_control_point_goes_where_it_is_to_go() {
    let handles = handles(&[1.0, 2.0, 3.0], 3, 1.0, Transform::Rigid);
    let aim = handles.aim(&[4.0, 2.0, 3.5], 1.0, &[1.0]).unwrap();
    assert_eq!(aim.targets, [4.0, 2.0, 3.5]);
    assert_eq!(aim.misses, [0.0]);
}

#[test]
fn turned_handles_arrive_too() {
    let p = points(9, 3);
    let q: Vec<f64> = p.iter().enumerate().map(|(at, p)| p + 0.1 * (at as f64 * 1.7).sin()).collect();
    let (sin, cos) = 0.6f64.sin_cos();
    let turn = [cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0];
    let turns: Vec<f64> = (0..9).flat_map(|i| if i % 3 == 0 { turn } else { [f64::NAN; 9] }).collect();
    for transform in ALL {
        let handles = handles(&p, 3, 0.7, transform);
        let aim = handles.aim(Pose { q: &q, orientations: Some(&turns) }, 1.0, &[1.0]).unwrap();
        let pose = Pose { q: &aim.targets, orientations: Some(&turns) };
        let landed = handles.handles.deform(pose, 1.0, false, &mut |_| true).unwrap().positions;
        assert!(furthest(&landed, &q) < 1e-8, "{transform:?}");
        assert!(furthest(&arrived(&handles, &aim.targets), &q) > 1e-4, "the turns are heeded");
    }
}

#[test]
fn a_careful_aim_is_the_aim_where_control_points_own_their_places_and_arrive() {
    let p = points(8, 3);
    let q: Vec<f64> = p.iter().enumerate().map(|(at, p)| p + 0.2 * (at as f64).cos()).collect();
    for transform in ALL {
        let handles = handles(&p, 3, 0.6, transform);
        for adherence in [0.0, 0.4, 1.0] {
            let (aim, careful) = (
                handles.aim(&q, 1.0, &[adherence]).unwrap(),
                handles.aim_carefully(&q, 1.0, &[adherence]).unwrap(),
            );
            assert!(furthest(&careful.targets, &aim.targets) < 1e-8, "{transform:?} {adherence}");
            assert_eq!(careful.soft, None);
        }
        assert!(handles.aim_carefully(&q, 1.0, &[1.1]).is_err());
    }
}

#[test]
fn a_careful_aim_leaves_soft_what_owns_little() {
    let p = points(8, 3);
    let q: Vec<f64> = p.iter().enumerate().map(|(at, p)| p + 0.2 * (at as f64).cos()).collect();
    let handles = handles(&p, 3, 0.6, Transform::Rigid);
    let careful = handles.aim_carefully(&q, 5.0, &[1.0]).unwrap();
    assert_eq!(careful.targets, q);
    assert!(
        matches!(careful.soft, Some(Soft::Shared(_, owned)) if owned > 0.1 && owned < OWNED),
        "{:?}",
        careful.soft
    );
    assert_eq!(careful.misses, distances(&handles.land(&q, 5.0).unwrap(), &q, 3));
    assert_eq!(handles.remedy(&q, 5.0, &[1.0]).unwrap(), Some(Remedy::Temperature(2.5)));
    assert_eq!(handles.aim_carefully(&q, 2.5, &[1.0]).unwrap().soft, None);
    // Where plain MLS arrives by itself there is nothing to leave soft.
    assert_eq!(handles.aim_carefully(&p, 5.0, &[1.0]).unwrap().soft, None);
}

#[test]
fn a_careful_aim_leaves_soft_what_has_the_same_weights_and_knows_what_would_help() {
    let ([p, q], logits) = of_one_mind();
    let handles = Handles::of_logits(&p, 3, logits, Transform::Rigid).unwrap();
    let careful = handles.aim_carefully(&q, 1.0, &[1.0]).unwrap();
    assert_eq!(careful.targets, q);
    assert!(matches!(careful.soft, Some(Soft::Shared(1, owned)) if owned > OWNED), "{:?}", careful.soft);
    assert_eq!(handles.remedy(&q, 1.0, &[1.0]).unwrap(), Some(Remedy::Affine));
    let mut affine = handles;
    affine.set_transform(Transform::Affine);
    assert_eq!(affine.aim_carefully(&q, 1.0, &[1.0]).unwrap().soft, None);
}

/// The control point `k` at `t` of its way through the middle of the others, and as far again; no other moves.
fn through(p: &[f64], k: usize, t: f64) -> Vec<f64> {
    let others = (p.len() / 3 - 1) as f64;
    let mut q = p.to_vec();
    for c in 0..3 {
        let sum: f64 = p.iter().skip(c).step_by(3).sum();
        q[3 * k + c] += 2.0 * t * ((sum - p[3 * k + c]) / others - p[3 * k + c]);
    }
    q
}

/// Every control point at `t` of its way to its mirror image.
fn mirrored(p: &[f64], axis: usize, t: f64) -> Vec<f64> {
    p.iter().enumerate().map(|(at, v)| if at % 3 == axis { v * (1.0 - 2.0 * t) } else { *v }).collect()
}

#[test]
fn a_careful_drag_has_no_jumps_even_where_targets_cannot_be_reached() {
    let p = points(8, 3);
    let mut unreached = 0;
    for (transform, own) in [(Transform::Rigid, 0.5), (Transform::Rigid, 0.8), (Transform::Similarity, 0.6)] {
        let handles = handles(&p, 3, own, transform);
        let mut careful = |q: &[f64]| {
            let aim = handles.aim_carefully(q, 1.0, &[1.0]).unwrap();
            unreached += usize::from(matches!(aim.soft, Some(Soft::Unreached(..))));
            assert!(!matches!(aim.soft, Some(Soft::Shared(..))));
            arrived(&handles, &aim.targets)
        };
        for drag in 0..11 {
            let at = |t: f64| if drag < 8 { through(&p, drag, t) } else { mirrored(&p, drag - 8, t) };
            let y: Vec<_> = (0..=100).map(|step| careful(&at(f64::from(step) / 100.0))).collect();
            // Where it goes fastest one looks closer and closer, by halves: what is left then is a jump.
            let worst = greatest(y.windows(2).map(|pair| furthest(&pair[0], &pair[1]))).0;
            let (mut from, mut to) = (worst as f64 / 100.0, (worst + 1) as f64 / 100.0);
            let (mut before, mut after) = (y[worst].clone(), y[worst + 1].clone());
            for _ in 0..20 {
                let middle = (from + to) / 2.0;
                let between = careful(&at(middle));
                if furthest(&before, &between) > furthest(&between, &after) {
                    (to, after) = (middle, between);
                } else {
                    (from, before) = (middle, between);
                }
            }
            let jump = furthest(&before, &after);
            assert!(jump < 1e-3, "{transform:?} {own}, drag {drag}: a jump of {jump} at {from}");
        }
    }
    assert!(unreached > 100, "only {unreached} targets were out of reach");
}

#[test]
fn a_careful_aim_of_what_cannot_be_reached_goes_as_far_as_it_does() {
    let p = points(8, 3);
    let handles = handles(&p, 3, 0.5, Transform::Rigid);
    let unreached = (0..=40).map(|step| through(&p, 2, f64::from(step) / 40.0)).find_map(|q| {
        let aim = handles.aim_carefully(&q, 1.0, &[1.0]).unwrap();
        matches!(aim.soft, Some(Soft::Unreached(..))).then_some((q, aim))
    });
    let (q, aim) = unreached.expect("a target out of reach");
    let soft = distances(&handles.land(&q, 1.0).unwrap(), &q, 3);
    let (worst, miss) = greatest(aim.misses.iter().copied());
    assert_eq!(aim.soft, Some(Soft::Unreached(worst, miss)));
    assert!(miss < 0.7 * greatest(soft.iter().copied()).1, "{miss} {soft:?}");
    assert_eq!(aim.misses, distances(&handles.land(&aim.targets, 1.0).unwrap(), &q, 3));
}
