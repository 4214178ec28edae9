use super::*;
use crate::machine::random::Random;
use crate::weights::shape_graph::squared;

type Mesh = (Vec<f64>, Vec<[u32; 3]>);

/// Boxes from corner to corner.
fn boxes(all: &[[Position; 2]]) -> Mesh {
    let (mut x, mut faces) = (Vec::new(), Vec::new());
    for corners in all {
        let first = x.len() as u32 / 3;
        for corner in 0..8 {
            x.extend((0..3).map(|k| corners[corner >> k & 1][k]));
        }
        for [a, b, c, d] in
            [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]]
        {
            faces.extend([[a, b, c], [a, c, d]].map(|face: [u32; 3]| face.map(|corner| first + corner)));
        }
    }
    (x, faces)
}

/// A trunk, a head in front of it, and two pairs of legs: symmetric in x alone.
fn beast() -> Mesh {
    let legs = [[-0.3, -0.8], [0.2, -0.8], [-0.3, 0.6], [0.2, 0.6]];
    let mut all = vec![[[-0.3, 0.5, -0.8], [0.3, 0.9, 0.8]], [[-0.1, 0.8, 0.8], [0.1, 1.2, 1.3]]];
    all.extend(legs.map(|[x, z]| [[x, 0.0, z], [x + 0.1, 0.5, z + 0.2]]));
    boxes(&all)
}

/// About an axis, by Rodrigues' formula.
fn turn(axis: Position, angle: f64) -> [Position; 3] {
    let [x, y, z] = unit(axis);
    let (s, c) = angle.sin_cos();
    let v = 1.0 - c;
    [
        [c + x * x * v, x * y * v - z * s, x * z * v + y * s],
        [y * x * v + z * s, c + y * y * v, y * z * v - x * s],
        [z * x * v - y * s, z * y * v + x * s, c + z * z * v],
    ]
}

fn moved(x: &[f64], turn: &[Position; 3], by: Position) -> Vec<f64> {
    let point =
        |x: &[f64]| -> Position { std::array::from_fn(|k| dot(&turn[k], &[x[0], x[1], x[2]]) + by[k]) };
    x.chunks_exact(3).flat_map(point).collect()
}

/// The angle between lines along two directions.
fn degrees(a: &Position, b: &Position) -> f64 {
    let across: Position = std::array::from_fn(|k| a[k] - b[k] * dot(a, b).signum());
    2.0 * (0.5 * dot(&across, &across).sqrt()).asin().to_degrees()
}

#[test]
fn a_shape_that_is_turned_and_moved_takes_its_plane_along() {
    let (x, faces) = beast();
    for (axis, angle, by) in [
        ([0.0, 0.0, 1.0], 0.0, [0.0; 3]),
        ([1.0, 2.0, -0.5], 1.1, [500.0, -3e4, 7.0]),
        ([-3.0, 0.2, 1.0], 2.6, [0.0, 1.0, 0.0]),
    ] {
        let turn = turn(axis, angle);
        let found = planes(&moved(&x, &turn, by), 3, &faces).unwrap();
        let expected: Position = std::array::from_fn(|k| turn[k][0]);
        let off = degrees(&found[0].normal, &expected);
        assert_eq!(found[0].verdict, Verdict::Symmetric, "{found:?}");
        assert!(off < 0.2, "{off} degrees");
        let on_plane = dot(&found[0].normal, &by) - found[0].offset;
        assert!(on_plane.abs() < 0.002 * 2.1, "{on_plane} off");
        assert!(found[1..].iter().all(|plane| plane.verdict != Verdict::Symmetric), "{found:?}");
    }
}

#[test]
fn a_box_has_three_planes_each_once() {
    let (x, faces) = boxes(&[[[0.0; 3], [1.0, 2.0, 3.0]]]);
    let found = planes(&x, 3, &faces).unwrap();
    let symmetric: Vec<&Plane> = found.iter().filter(|plane| plane.verdict == Verdict::Symmetric).collect();
    for (k, middle) in [0.5, 1.0, 1.5].into_iter().enumerate() {
        let like = |plane: &&&Plane| plane.normal[k] > 0.99999 && (plane.offset - middle).abs() < 0.006;
        assert_eq!(symmetric.iter().filter(like).count(), 1, "{found:?}");
    }
    assert!(symmetric[0].normal[0] > 0.99999, "of equals the one across x: {found:?}");
}

#[test]
fn what_has_no_plane_is_told_so_and_one_part_that_is_missing_asks() {
    let uneven = [0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.4, 1.9, 0.0, 0.9, 0.3, 1.1];
    let found = planes(&uneven, 3, &[[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3]]).unwrap();
    assert!(found.iter().all(|plane| plane.verdict == Verdict::No), "{found:?}");
    let (x, mut faces) = beast();
    faces.truncate(faces.len() - 12); // a leg
    let found = planes(&x, 3, &faces).unwrap();
    assert_eq!(found[0].verdict, Verdict::Asks, "{found:?}");
}

#[test]
fn the_verdict_needs_both_score_and_match() {
    let verdicts = [(1.3, 0.95), (1.31, 0.99), (1.08, 0.94), (1.08, 0.82), (1.95, 0.85), (1.96, 0.99)];
    let expected = ["symmetric", "nearly", "nearly", "no", "nearly", "no"];
    assert_eq!(verdicts.map(|(score, matched)| Verdict::of(score, matched).word()), expected);
}

#[test]
fn scores_are_what_looking_at_all_targets_gives() {
    let (x, faces) = beast();
    let x: Vec<Position> = x.chunks_exact(3).map(|x| [x[0], x[1], x[2]]).collect();
    let samples = Samples::new(&x, &faces, 3).unwrap();
    let mirror = Mirror { normal: unit([1.0, 0.02, 0.1]), offset: 0.01 };
    let nearest =
        |x: &Position| samples.targets.iter().map(|y| squared(x, y)).fold(f64::INFINITY, f64::min).sqrt();
    let mut floors: Vec<f64> = samples.mirrored.iter().map(nearest).collect();
    floors.sort_by(f64::total_cmp);
    assert_eq!(samples.floor, [floors[1000], floors[1799]]);
    let off: Vec<f64> = samples.mirrored.iter().map(|x| nearest(&mirror.image(x))).collect();
    let score = off.iter().map(|off| off.min(4.0 * floors[1799])).sum::<f64>() / 2000.0 / floors[1000];
    let matched = off.iter().filter(|off| **off <= 1.5 * floors[1799]).count() as f64 / 2000.0;
    let found = judged(&samples, &mirror);
    assert!((found.0 - score).abs() < 1e-9 && found.1 == matched, "{found:?}, {score}, {matched}");
}

#[test]
fn the_plane_between_points_and_their_images_is_found_exactly() {
    let mut random = Random::new(2);
    let mirror = Mirror { normal: unit([0.3, -0.7, 0.5]), offset: 0.4 };
    let x: Vec<Position> = (0..40).map(|_| std::array::from_fn(|_| random.unit())).collect();
    let pairs: Vec<_> = x.iter().map(|x| (*x, mirror.image(x))).collect();
    let found = Mirror::between(&pairs);
    let side = dot(&found.normal, &mirror.normal);
    assert!(
        (side.abs() - 1.0).abs() < 1e-12 && (found.offset * side - mirror.offset).abs() < 1e-12,
        "{found:?}"
    );
}

#[test]
fn a_plane_that_is_off_is_brought_back() {
    let (x, faces) = beast();
    let x: Vec<Position> = x.chunks_exact(3).map(|x| [x[0], x[1], x[2]]).collect();
    let samples = Samples::new(&x, &faces, 3).unwrap();
    let found = refined(&samples, Mirror { normal: unit([1.0, 0.12, -0.1]), offset: 0.05 });
    assert!(degrees(&found.normal, &[1.0, 0.0, 0.0]) < 0.2 && found.offset.abs() < 0.004, "{found:?}");
}

#[test]
fn clouds_flat_shapes_and_lines_have_planes_too() {
    let (x, faces) = beast();
    let cloud = crate::placement::sample_surface(&x, 3, &faces, 20_000, 5).unwrap();
    let found = planes(&cloud, 3, &[]).unwrap();
    assert!(
        found[0].verdict == Verdict::Symmetric && degrees(&found[0].normal, &[1.0, 0.0, 0.0]) < 0.2,
        "{found:?}"
    );
    // A kite, in the plane and in space: the plane in which it lies says nothing.
    let kite = [0.0, 0.0, 1.0, 2.0, 0.0, 3.0, -1.0, 2.0];
    let two = [[0, 1, 2], [0, 2, 3]];
    let found = planes(&kite, 2, &two).unwrap();
    assert!(
        found[0].verdict == Verdict::Symmetric && degrees(&found[0].normal, &[1.0, 0.0, 0.0]) < 1.0,
        "{found:?}"
    );
    let flat: Vec<f64> = kite.chunks_exact(2).flat_map(|x| [x[0], x[1], 0.0]).collect();
    let found = planes(&flat, 3, &two).unwrap();
    assert!(found.iter().all(|plane| plane.normal[2].abs() < 0.1), "{found:?}");
    let line: Vec<f64> = (0..50).map(f64::from).collect();
    let found = planes(&line, 1, &[]).unwrap();
    assert!(found[0].normal == [1.0, 0.0, 0.0] && (found[0].offset - 24.5).abs() < 0.6, "{found:?}");
}

#[test]
fn too_little_has_no_planes_and_what_is_wrong_is_refused() {
    assert!(planes(&[1.0, 2.0, 3.0], 3, &[]).unwrap().is_empty());
    assert!(planes(&[1.0; 60], 3, &[]).unwrap().is_empty());
    assert!(planes(&[], 3, &[]).unwrap().is_empty());
    assert!(planes(&[0.0; 60], 3, &[[0, 1, 20]]).is_err());
    assert!(planes(&[f64::NAN; 60], 3, &[]).is_err());
    // One face: whatever it is told, it is told.
    let mut one = vec![0.0; 24];
    (one[3], one[7]) = (1.0, 1.0);
    assert!(planes(&one, 3, &[[0, 1, 2]]).unwrap().iter().all(|plane| plane.score.is_finite()));
}

#[test]
fn images_of_images_are_where_they_were() {
    let plane =
        Plane { normal: [0.6, 0.8, 0.0], offset: 2.0, score: 1.0, matched: 1.0, verdict: Verdict::Symmetric };
    let back = plane.image(&plane.image(&[3.0, -1.0]));
    assert!((back[0] - 3.0).abs() < 1e-14 && (back[1] + 1.0).abs() < 1e-14);
    assert_eq!(plane.image(&[0.0, 0.0]), [2.0 * 2.0 * 0.6, 2.0 * 2.0 * 0.8]);
}
