//! The laws of the whole way, for classic weights (any other logits take the same path).

use super::*;
use crate::InverseDistance;
use proptest::prelude::*;

const ALL: [Transform; 3] = [Transform::Rigid, Transform::Similarity, Transform::Affine];

fn bound(x: &[f64], p: &[f64], dim: usize, transform: Transform) -> Deformer {
    let weights = InverseDistance::new(p, dim, Frame::IDENTITY, 1.0, 0.0).unwrap();
    Deformer::of_logits(x.to_vec(), dim, p, weights.logits(x, &mut |_| true).unwrap(), transform).unwrap()
}

fn deform(x: &[f64], p: &[f64], q: &[f64], dim: usize, transform: Transform) -> Vec<f64> {
    bound(x, p, dim, transform).deform(q, 1.0, false, &mut |_| true).unwrap().positions
}

fn coordinates(points: usize) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-1.0..1.0f64, 3 * points)
}

proptest! {
    #[test]
    fn unmoved_control_points_return_the_input_bit_for_bit(
        x in coordinates(20), p in coordinates(4), scale in -200i32..200, t in 0.01f64..100.0, dim in 1usize..4,
    ) {
        let scale = 10f64.powi(scale / 2);
        let scaled = |v: &[f64]| -> Vec<f64> { v.iter().map(|c| c * scale).collect() };
        let (x, p) = (scaled(&x), scaled(&p));
        for transform in ALL {
            let y = bound(&x, &p, dim, transform).deform(&p, t, true, &mut |_| true).unwrap().positions;
            prop_assert!(x.iter().zip(&y).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
    }

    #[test]
    fn translation_and_scale_of_the_world_do_not_matter(x in coordinates(10), p in coordinates(5), q in coordinates(5)) {
        let world = |v: &[f64]| -> Vec<f64> { v.iter().map(|c| 40.0 * c + 7.0).collect() };
        for transform in ALL {
            let there = world(&deform(&x, &p, &q, 3, transform));
            let here = deform(&world(&x), &world(&p), &world(&q), 3, transform);
            // Logits are single: an affine map that throws points far out of the box throws their last digits as far.
            for (a, b) in there.iter().zip(&here) {
                prop_assert!((a - b).abs() < 2e-3 * (a.abs() / 40.0).max(1.0), "{} {}", a, b);
            }
        }
    }
}

#[test]
fn half_a_million_metres_from_the_origin_millimetres_survive() {
    let far = |v: &[f64]| -> Vec<f64> {
        v.iter().zip([500_000.0, 6_000_000.0, 0.0].iter().cycle()).map(|(c, f)| c + f).collect()
    };
    let x: Vec<f64> = (0..300).map(|i| (f64::from(i) * 0.7).sin() * 2.0).collect();
    let p = [-2.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0, 0.5];
    let q = [-2.0, 0.0, 0.0, 2.0, 0.5, 0.0, 0.0, 2.5, 0.5];
    let here = far(&deform(&x, &p, &q, 3, Transform::Rigid));
    let there = deform(&far(&x), &far(&p), &far(&q), 3, Transform::Rigid);
    for (a, b) in here.iter().zip(&there) {
        assert!((a - b).abs() < 1e-5, "{a} {b}");
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let x: Vec<f64> = (0..9000).map(|i| (f64::from(i) * 0.7).sin()).collect();
    let (p, q) =
        ([0.5, 0.0, 0.0, -0.5, 0.1, 0.0, 0.0, 0.7, 0.3], [0.5, 0.3, 0.0, -0.5, 0.1, 0.2, 0.0, 0.9, 0.3]);
    let here = deform(&x, &p, &q, 3, Transform::Similarity);
    #[cfg(feature = "threads")]
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(|| deform(&x, &p, &q, 3, Transform::Similarity)), here);
    }
    assert_eq!(here.len(), x.len());
}

#[test]
fn the_maps_are_those_that_moved_the_points() {
    // A rigid motion of all: every map is its rotation.
    let (x, p) = ([0.1, 0.2, 0.4, -0.3], [0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    let q = [0.0, 0.0, 0.0, 1.0, -1.0, 0.0];
    let deformed = bound(&x, &p, 2, Transform::Rigid).deform(&q, 1.0, true, &mut |_| true).unwrap();
    for map in deformed.maps.unwrap().chunks(4) {
        for (a, b) in map.iter().zip([0.0, -1.0, 1.0, 0.0]) {
            assert!((a - b).abs() < 1e-7, "{map:?}");
        }
    }
    assert!((deformed.positions[0] + 0.2).abs() < 1e-7 && (deformed.positions[1] - 0.1).abs() < 1e-7);
}

#[test]
fn all_points_in_one_place_move_together() {
    let y = deform(
        &[3.0; 6],
        &[0.0, 0.0, 0.0, 6.0, 6.0, 6.0],
        &[1.0, 0.0, 0.0, 7.0, 6.0, 6.0],
        3,
        Transform::Rigid,
    );
    for (a, b) in y.iter().zip([4.0, 3.0, 3.0, 4.0, 3.0, 3.0]) {
        assert!((a - b).abs() < 1e-6, "{y:?}");
    }
}

#[test]
fn no_points_are_deformed_to_none() {
    assert!(deform(&[], &[0.0], &[1.0], 1, Transform::Rigid).is_empty());
}

#[test]
fn refuses_what_does_not_fit() {
    let new = |x: &[f64], p: &[f64], logits: &[f32]| {
        Deformer::of_logits(x.to_vec(), 2, p, logits.to_vec(), Transform::Rigid)
            .map(drop)
            .unwrap_err()
            .to_string()
    };
    assert!(new(&[0.0; 4], &[], &[]).contains("at least one"));
    assert!(new(&[0.0; 4], &[0.0; 2], &[0.0]).contains("2 x 1"));
    assert!(new(&[0.0; 4], &[0.0; 2], &[0.0, f32::NAN]).contains("(1, 0)"));
    assert!(new(&[0.0; 3], &[0.0; 2], &[0.0]).contains("whole points"));
    let deformer = bound(&[0.0; 2], &[1.0; 2], 2, Transform::Rigid);
    for (q, t) in
        [(vec![0.0; 4], 1.0), (vec![f64::NAN, 0.0], 1.0), (vec![0.0; 2], 0.0), (vec![0.0; 2], f64::NAN)]
    {
        assert!(deformer.deform(&q, t, false, &mut |_| true).is_err());
    }
    assert_eq!(deformer.deform(&[2.0; 2], 1.0, false, &mut |_| false).err(), Some(Error::Cancelled));
}

/// Random points, control points, targets and logits; mirrored targets in the second half of the cases.
fn random_frames() -> Vec<(Deformer, Vec<f64>)> {
    let mut state = 3u64;
    let mut random = |count: usize, size: f64| -> Vec<f64> {
        let next = |_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            size * ((state >> 11) as f64 / (1u64 << 52) as f64 - 1.0)
        };
        (0..count).map(next).collect()
    };
    let mut frames = Vec::new();
    for dim in [2, 3] {
        for m in [1, 2, 5, 10, 60] {
            for transform in ALL {
                let n = 1500;
                let (x, p, noise) = (random(n * dim, 40.0), random(m * dim, 40.0), random(m * dim, 4.0));
                let logits: Vec<f32> = random(n * m, 15.0).into_iter().map(|l| l as f32).collect();
                let near: Vec<f64> = p.iter().zip(&noise).map(|(p, e)| p + e).collect();
                let mirrored =
                    p.iter().enumerate().map(|(k, p)| if k % dim == 0 { -p } else { *p }).collect();
                let new = || Deformer::of_logits(x.clone(), dim, &p, logits.clone(), transform).unwrap();
                frames.extend([(new(), near), (new(), mirrored)]);
            }
        }
    }
    frames
}

/// Each point by itself, in double precision from its logits.
fn one_by_one<const D: usize>(deformer: &Deformer, pose: Pose<'_>, temperature: f64) -> (Vec<f64>, Vec<f64>) {
    let enter = |points: &[f64]| -> Vec<[f64; D]> {
        points.chunks_exact(D).map(|point| deformer.frame.enter(point)).collect()
    };
    let (p, q) = (enter(&deformer.p), enter(pose.q));
    let oriented = pose.orientations.map_or_else(Vec::new, |given| oriented(given, &p));
    let mls = Mls::with_oriented(&p, &q, oriented, deformer.transform);
    let (x, logits, frame) = (&deformer.x, &deformer.logits, deformer.frame);
    let motion = Motion { x, logits, frame, temperature, mls, batch: None };
    let (mut y, mut maps) = (vec![0.0; x.len()], vec![0.0; x.len() * D]);
    motion.block(0, &mut y, &mut maps);
    (y, maps)
}

#[test]
fn frames_are_those_of_the_points_one_by_one_with_maps_and_without() {
    for (deformer, q) in random_frames() {
        for t in [0.01, 0.1, 0.3, 1.0, 100.0] {
            let fast = deformer.deform(&q, t, true, &mut |_| true).unwrap();
            let (y, maps) = match deformer.dim {
                2 => one_by_one::<2>(&deformer, (&q).into(), t),
                _ => one_by_one::<3>(&deformer, (&q).into(), t),
            };
            let largest = maps.iter().fold(1.0, |l: f64, m| l.max(m.abs()));
            for (a, b) in fast.positions.iter().zip(&y) {
                assert!((a - b).abs() < 1e-5 * deformer.frame.half * largest, "T = {t}: {a} {b}");
            }
            if deformer.transform == Transform::Rigid {
                for (a, b) in fast.maps.unwrap().iter().zip(&maps) {
                    assert!((a - b).abs() < 1e-5, "T = {t}: {a} {b}");
                }
            }
            assert_eq!(deformer.deform(&q, t, false, &mut |_| true).unwrap().positions, fast.positions);
        }
    }
}

#[test]
fn a_frame_does_not_depend_on_the_frames_before() {
    let (deformer, q) = random_frames().pop().unwrap();
    let mut y = vec![f64::NAN; deformer.x.len()];
    for t in [1.0, 0.2, 1.0, 1.0, 5.0, 0.2] {
        deformer.deform_into(&q, t, &mut y, None, &mut |_| true).unwrap();
        let (fresh, _) = random_frames().pop().unwrap();
        assert_eq!(fresh.deform(&q, t, false, &mut |_| true).unwrap().positions, y);
    }
}

#[test]
fn several_threads_may_ask_one_deformer_at_once() {
    let (deformer, q) = random_frames().pop().unwrap();
    let alone: Vec<Vec<f64>> =
        [0.5, 2.0].iter().map(|t| deformer.deform(&q, *t, false, &mut |_| true).unwrap().positions).collect();
    std::thread::scope(|scope| {
        for thread in 0..4 {
            let (deformer, q, alone) = (&deformer, &q, &alone);
            scope.spawn(move || {
                for turn in 0..6 {
                    let which = (thread + turn) % 2;
                    let t = [0.5, 2.0][which];
                    assert_eq!(deformer.deform(q, t, false, &mut |_| true).unwrap().positions, alone[which]);
                }
            });
        }
    });
}

#[test]
fn memory_of_another_size_is_refused() {
    let deformer = bound(&[0.0; 6], &[1.0; 3], 3, Transform::Rigid);
    let into = |y: usize, maps: usize| {
        let (mut y, mut maps) = (vec![0.0; y], vec![0.0; maps]);
        deformer.deform_into(&[2.0; 3], 1.0, &mut y, Some(&mut maps), &mut |_| true)
    };
    assert!(into(6, 18).is_ok());
    assert!(into(5, 18).unwrap_err().to_string().contains("room for 6 numbers, found 5"));
    assert!(into(6, 17).unwrap_err().to_string().contains("room for 18 numbers, found 17"));
}

#[test]
fn another_transform_gives_the_frames_of_a_deformer_of_that_transform() {
    let x: Vec<f64> = (0..3000).map(|i| (f64::from(i) * 0.7).sin()).collect();
    let p: Vec<f64> = (0..15).map(|i| (f64::from(i) * 1.9).cos()).collect();
    let q: Vec<f64> = p.iter().map(|c| 1.3 * c + 0.1 * (5.0 * c).sin()).collect();
    let mut changed = bound(&x, &p, 3, Transform::Rigid);
    for transform in [Transform::Rigid, Transform::Similarity, Transform::Affine, Transform::Rigid] {
        changed.set_transform(transform);
        for _ in 0..3 {
            let found = changed.deform(&q, 0.7, false, &mut |_| true).unwrap().positions;
            assert_eq!(
                found,
                bound(&x, &p, 3, transform).deform(&q, 0.7, false, &mut |_| true).unwrap().positions
            );
        }
    }
}

/// `m` turns about z by `degrees`, in 2 or 3 dimensions; every other control point says nothing.
fn turns(m: usize, dim: usize, degrees: f64) -> Vec<f64> {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let turn =
        if dim == 2 { vec![cos, -sin, sin, cos] } else { vec![cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0] };
    (0..m).flat_map(|i| if i % 2 == 0 { turn.clone() } else { vec![f64::NAN; dim * dim] }).collect()
}

#[test]
fn oriented_frames_are_those_of_the_points_one_by_one() {
    for (deformer, q) in random_frames() {
        let turns = turns(q.len() / deformer.dim, deformer.dim, 50.0);
        for t in [0.1, 1.0, 100.0] {
            let pose = Pose { q: &q, orientations: Some(&turns) };
            let fast = deformer.deform(pose, t, true, &mut |_| true).unwrap();
            let (y, maps) = match deformer.dim {
                2 => one_by_one::<2>(&deformer, pose, t),
                _ => one_by_one::<3>(&deformer, pose, t),
            };
            let largest = maps.iter().fold(1.0, |l: f64, m| l.max(m.abs()));
            for (a, b) in fast.positions.iter().zip(&y) {
                assert!((a - b).abs() < 1e-5 * deformer.frame.half * largest, "T = {t}: {a} {b}");
            }
            assert_ne!(fast.positions, deformer.deform(&q, t, false, &mut |_| true).unwrap().positions);
        }
    }
}

#[test]
fn turns_that_turn_nothing_change_nothing() {
    for (deformer, q) in random_frames() {
        let m = q.len() / deformer.dim;
        let none = vec![f64::NAN; m * deformer.dim * deformer.dim];
        let silent =
            deformer.deform(Pose { q: &q, orientations: Some(&none) }, 1.0, true, &mut |_| true).unwrap();
        let plain = deformer.deform(&q, 1.0, true, &mut |_| true).unwrap();
        assert_eq!((silent.positions, silent.maps), (plain.positions, plain.maps));
        let held = turns(m, deformer.dim, 0.0);
        let pose = Pose { q: &deformer.p, orientations: Some(&held) };
        assert_eq!(deformer.deform(pose, 1.0, true, &mut |_| true).unwrap().positions, deformer.x);
    }
}

#[test]
fn turns_that_do_not_fit_are_refused() {
    let deformer = bound(&[0.0; 6], &[1.0; 3], 3, Transform::Rigid);
    for turns in [vec![1.0; 9], vec![f64::NAN; 8]] {
        let pose = Pose { q: &[2.0; 3], orientations: Some(&turns) };
        let error = deformer.deform(pose, 1.0, false, &mut |_| true).map(drop).unwrap_err();
        assert!(error.to_string().starts_with("orientations: "), "{error}");
    }
}

#[test]
fn a_frame_after_its_weights_were_prepared_finds_them() {
    let x: Vec<f64> = (0..300).map(|i| (f64::from(i) * 0.7).sin() * 2.0).collect();
    let p = [-2.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0, 0.5];
    let q = [-2.0, 0.0, 0.0, 2.0, 0.5, 0.0, 0.0, 2.5, 0.5];
    let deformer = bound(&x, &p, 3, Transform::Rigid);
    deformer.prepare(0.5).unwrap();
    let prepared = deformer.weights(0.5).unwrap();
    let y = deformer.deform(&q, 0.5, false, &mut |_| true).unwrap().positions;
    assert!(Arc::ptr_eq(&prepared, &deformer.weights(0.5).unwrap()));
    assert_eq!(
        y,
        bound(&x, &p, 3, Transform::Rigid).deform(&q, 0.5, false, &mut |_| true).unwrap().positions
    );
    assert!(deformer.prepare(0.0).is_err());
}

/// About an axis that is not one of the coordinates'.
fn turned_about(x: &[f64; 3], angle: f64) -> [f64; 3] {
    let axis = [2.0 / 7.0, -3.0 / 7.0, 6.0 / 7.0];
    let (sin, cos) = angle.sin_cos();
    let along: f64 = (0..3).map(|k| axis[k] * x[k]).sum();
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        cos * x[k] + sin * (axis[i] * x[j] - axis[j] * x[i]) + (1.0 - cos) * along * axis[k]
    })
}

#[test]
fn a_rigid_motion_of_control_points_near_a_line_moves_every_point_by_it() {
    let mut random = (0..).map(|at| (f64::from(at) * 12.9898 + 4.1).sin() * 43758.5453);
    let mut random = || random.next().map_or(0.0, |v| 2.0 * (v - v.floor()) - 1.0);
    for exponent in 2..=6 {
        let h = 10f64.powi(-exponent);
        for angle in [0.4, 1.9, 3.1] {
            let shape: Vec<[f64; 3]> = (0..200).map(|_| std::array::from_fn(|_| random())).collect();
            let p: Vec<[f64; 3]> = (0..6)
                .map(|i| [0.4 * f64::from(i) - 1.0, h * if i == 1 { 1.0 } else { random() }, h * random()])
                .map(|p| turned_about(&p, 0.7))
                .collect();
            let moved = |x: &[f64; 3]| -> [f64; 3] {
                let turned = turned_about(x, angle);
                std::array::from_fn(|k| turned[k] + 0.5 * k as f64)
            };
            let q: Vec<f64> = p.iter().flat_map(moved).collect();
            let columns: [[f64; 3]; 3] = std::array::from_fn(|axis| {
                turned_about(&std::array::from_fn(|k| f64::from(u8::from(k == axis))), angle)
            });
            let rotation: Vec<f64> = (0..9).map(|at| columns[at % 3][at / 3]).collect();
            let orientations: Vec<f64> =
                (0..6).flat_map(|i| if i % 2 == 0 { rotation.clone() } else { vec![f64::NAN; 9] }).collect();
            let logits: Vec<f32> = (0..1200).map(|_| 10.0 * random() as f32).collect();
            for transform in [Transform::Rigid, Transform::Similarity, Transform::Affine] {
                let (x, p) = (shape.as_flattened().to_vec(), p.as_flattened());
                let deformer = Deformer::of_logits(x, 3, p, logits.clone(), transform).unwrap();
                for temperature in [0.02, 0.3, 1.0, 10.0] {
                    for orientations in [None, Some(&orientations[..])] {
                        let pose = Pose { q: &q, orientations };
                        let y = deformer.deform(pose, temperature, false, &mut |_| true).unwrap().positions;
                        let expected = shape.iter().flat_map(moved);
                        let worst =
                            y.iter().zip(expected).fold(0.0f64, |worst, (y, e)| worst.max((y - e).abs()));
                        // The shape is 2 across.
                        assert!(worst < 2e-6, "{transform:?}, h = {h}, T = {temperature}: {worst}");
                    }
                }
            }
        }
    }
}
