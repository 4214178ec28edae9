//! Advice is silent where all is well, and tells of what was made bad on purpose. The same is tested from Python (tests/test_advice.py).

use super::*;
use crate::geometry::Frame;
use crate::mls::Transform;
use crate::weights::inverse_distance::InverseDistance;
use crate::weights::Weights;

/// A line of places from 0 to 1 and inverse-distance weights of control points on it.
fn line(p: &[f64]) -> Probe {
    let places: Vec<f64> = (0..=200).map(|i| f64::from(i) / 200.0).collect();
    let weights = InverseDistance::new(p, 1, Frame::around(&places, 1), 1.0, 0.0).unwrap();
    Probe::new(&Weights::InverseDistance(weights), &places, 1.0, Transform::Rigid, false).unwrap()
}

#[test]
fn what_moves_as_one_needs_no_advice() {
    let probe = line(&[0.0, 0.4, 0.6, 1.0]);
    for q in [[0.0, 0.4, 0.6, 1.0], [2.0, 2.4, 2.6, 3.0]] {
        assert_eq!(probe.advise(&q, 1.0, &[0.0]).unwrap(), []);
    }
}

#[test]
fn a_fold_is_found_between_the_control_points_that_change_places() {
    let probe = line(&[0.0, 0.4, 0.6, 1.0]);
    let found = probe.advise(&[0.0, 0.7, 0.3, 1.0], 1.0, &[0.0]).unwrap();
    let [Advice { kind: Kind::Folds(part), place, mut near, .. }, ..] = found[..] else {
        panic!("{found:?}")
    };
    near.sort_unstable();
    assert!(part > 0.1 && part < 0.4, "{part}");
    assert!((80..=120).contains(&place), "{place}");
    assert_eq!(near, [1, 2]);
}

#[test]
fn a_tear_is_found_and_what_is_said_to_help_does() {
    let probe = line(&[0.0, 0.3, 0.7, 1.0]);
    let torn = |q: &[f64], t: f64| probe.parts(q, t, &[0.0]).unwrap().1;
    let mut helped = 0;
    for (shift, t) in [(2.0, 0.1), (1.0, 0.1), (1.0, 0.3), (1.0, 0.5)] {
        let q = [0.0, 0.3, 0.7 + shift, 1.0 + shift];
        let found = probe.advise(&q, t, &[0.0]).unwrap();
        let [Advice { kind: Kind::Torn(stretch), place, near, better }] = found[..] else {
            panic!("{found:?}")
        };
        assert!(stretch > STRETCH && (90..=110).contains(&place) && near.iter().all(|i| [1, 2].contains(i)));
        let tried = [1.0, t / 2.0, 2.0 * t].map(|other| torn(&q, other));
        let least = tried.into_iter().fold(f64::INFINITY, f64::min);
        match better {
            Some((Better::Temperature(other), part)) => {
                helped += 1;
                assert!(part == torn(&q, other) && part == least && part <= torn(&q, t) / 2.0);
            }
            _ => assert!(better.is_none() && least > torn(&q, t) / 2.0),
        }
    }
    assert!(helped > 0 && helped < 4, "{helped}");
}

#[test]
fn what_moves_far_from_all_control_points_is_found() {
    let probe = line(&[0.0, 0.1, 0.2]);
    let found = probe.advise(&[0.0, 0.1, 0.25], 1.0, &[0.0]).unwrap();
    let ungoverned = found.iter().find(|advice| matches!(advice.kind, Kind::Ungoverned(_))).unwrap();
    assert_eq!((ungoverned.place, ungoverned.near), (200, [2, 2]));
    assert!(matches!(ungoverned.kind, Kind::Ungoverned(far) if (far - 8.0).abs() < 1e-9));
}
