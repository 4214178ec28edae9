//! The laws of the finish, and the whole against dense algebra.

use super::solve::{Moved, Posed};
use super::*;
use crate::aim::Handles;
use crate::weights::inverse_distance::InverseDistance;
use crate::{Deformer, Pose, Transform};
use nalgebra::{DMatrix, Matrix3};

/// A bar of square rings along the first axis, from -1 to 1.
fn bar(rings: usize) -> (Vec<f64>, Vec<[u32; 3]>) {
    let (mut x, mut faces) = (Vec::new(), Vec::new());
    for ring in 0..rings {
        let along = 2.0 * ring as f64 / (rings - 1) as f64 - 1.0;
        for (a, b) in [(-0.1, -0.15), (0.1, -0.15), (0.1, 0.15), (-0.1, 0.15)] {
            x.extend([along, a, b]);
        }
    }
    for ring in 0..rings as u32 - 1 {
        for side in 0..4 {
            let [a, b] = [4 * ring + side, 4 * ring + (side + 1) % 4];
            faces.extend([[a, b, b + 4], [a, b + 4, a + 4]]);
        }
    }
    (x, faces)
}

const P: [f64; 15] = [-1.0, 0.1, 0.15, -0.3, -0.1, 0.0, 0.2, 0.1, -0.15, 0.6, 0.0, 0.15, 1.0, -0.1, -0.15];

fn weights(p: &[f64], dim: usize) -> Weights {
    let function = InverseDistance::new(p, dim, Frame::IDENTITY, 2.0, 0.0).unwrap();
    Weights::InverseDistance(function)
}

fn elastic(p: &[f64]) -> Elastic {
    let (x, faces) = bar(40);
    Elastic::new(&weights(p, 3), Shape { x: &x, faces: &faces }).unwrap()
}

/// Bent, stretched and twisted.
fn targets(p: &[f64], by: f64) -> Vec<f64> {
    let bent =
        |p: &[f64; 3]| [p[0] - 0.3 * by * p[0] * p[0], p[1] + by * p[0] * p[2], p[2] + by * p[0] * p[0]];
    p.as_chunks::<3>().0.iter().flat_map(bent).collect()
}

/// Where `x` goes with what relaxes in full.
fn relaxed(elastic: &Elastic, x: &[f64], pose: Pose<'_>, transform: Transform) -> Vec<f64> {
    let weights = weights(&elastic.p, elastic.dim);
    let bound = Deformer::new(x.to_vec(), &weights, None, transform, &mut |_| true).unwrap();
    let bound = bound.lifted(elastic).unwrap();
    let mut y = bound.deform(pose, 1.0, false, &mut |_| true).unwrap().positions;
    if let Some(relaxed) = elastic.relax(pose, 1.0, transform).unwrap() {
        bound.relax(&relaxed, 1.0, &mut y, None).unwrap();
    }
    y
}

fn at(q: &[f64]) -> Pose<'_> {
    Pose { q, orientations: None }
}

fn furthest(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).fold(0.0, |most, (a, b)| (a - b).abs().max(most))
}

fn turned(x: &[f64]) -> Vec<f64> {
    let (sin, cos) = 2.2_f64.sin_cos();
    let turn = |x: &[f64; 3]| [cos * x[0] - sin * x[2] + 0.3, x[1] - 0.2, sin * x[0] + cos * x[2] + 0.1];
    x.as_chunks::<3>().0.iter().flat_map(turn).collect()
}

/// All places of which a point cloud around the bar consists.
fn around() -> Vec<f64> {
    (0..900).map(|at| (f64::from(at) * 0.73).sin() * if at % 3 == 0 { 1.1 } else { 0.3 }).collect()
}

#[test]
fn at_rest_nothing_moves_and_a_rigid_motion_is_that_motion() {
    let elastic = elastic(&P);
    let x = around();
    assert!(elastic.relax(&P, 1.0, Transform::Rigid).unwrap().is_none());
    assert_eq!(relaxed(&elastic, &x, at(&P), Transform::Rigid), x);
    for transform in [Transform::Rigid, Transform::Similarity, Transform::Affine] {
        let found = relaxed(&elastic, &x, at(&turned(&P)), transform);
        let off = furthest(&found, &turned(&x));
        assert!(off < 1e-10, "{transform:?} {off}");
    }
}

#[test]
fn one_two_and_control_points_in_a_plane_move_rigidly_with_a_rigid_motion() {
    let plane = [-1.0, 0.0, 0.0, 0.0, 0.1, 0.0, 1.0, 0.0, 0.0, 0.3, -0.1, 0.0, -0.4, 0.05, 0.0];
    for p in [&P[..3], &P[..6], &plane] {
        let elastic = elastic(p);
        let x = around();
        let shifted = |x: &[f64]| -> Vec<f64> { x.iter().map(|c| c + 0.25).collect() };
        let off = furthest(&relaxed(&elastic, &x, at(&shifted(p)), Transform::Rigid), &shifted(&x));
        assert!(off < 1e-10, "{} control points {off}", p.len() / 3);
    }
    let elastic = elastic(&plane);
    let off =
        furthest(&relaxed(&elastic, &around(), at(&turned(&plane)), Transform::Rigid), &turned(&around()));
    assert!(off < 1e-10, "{off}");
}

#[test]
fn control_points_go_where_they_go_without_it() {
    let elastic = elastic(&P);
    let q = targets(&P, 0.5);
    let weights = weights(&P, 3);
    let plain = Deformer::new(P.to_vec(), &weights, None, Transform::Rigid, &mut |_| true).unwrap();
    let landed = plain.deform(&q, 1.0, false, &mut |_| true).unwrap().positions;
    assert!(furthest(&relaxed(&elastic, &P, at(&q), Transform::Rigid), &landed) < 1e-9);
    // With an aim that is where they are to go.
    let handles = Handles::new(&weights, Transform::Rigid).unwrap();
    let aim = handles.aim(&q, 1.0, &[1.0]).unwrap();
    assert!(furthest(&relaxed(&elastic, &P, at(&aim.targets), Transform::Rigid), &q) < 1e-9);
}

#[test]
fn an_oriented_control_point_turns_what_is_near_it() {
    let elastic = elastic(&P);
    let (sin, cos) = 0.8_f64.sin_cos();
    let mut orientations = vec![f64::NAN; 45];
    orientations[36..].copy_from_slice(&[1.0, 0.0, 0.0, 0.0, cos, -sin, 0.0, sin, cos]);
    let pose = Pose { q: &P, orientations: Some(&orientations) };
    let end = &P[12..];
    let found = relaxed(&elastic, &[end[0], end[1] + 0.01, end[2]], pose, Transform::Rigid);
    let expected = [end[0], end[1] + 0.01 * cos, end[2] + 0.01 * sin];
    assert!(furthest(&found, &expected) < 1e-3, "{found:?} {expected:?}");
}

#[test]
fn the_order_of_control_points_is_nothing_to_it() {
    let other: Vec<f64> = [3, 0, 4, 2, 1].iter().flat_map(|&i| P[3 * i..][..3].to_vec()).collect();
    let (one, two) = (elastic(&P), elastic(&other));
    let (x, q, q_two) = (around(), targets(&P, 0.5), targets(&other, 0.5));
    let off = furthest(
        &relaxed(&one, &x, at(&q), Transform::Rigid),
        &relaxed(&two, &x, at(&q_two), Transform::Rigid),
    );
    assert!(off < 1e-7, "{off}");
}

#[test]
fn a_point_moves_the_same_whatever_others_there_are() {
    let (elastic, q, x) = (elastic(&P), targets(&P, 0.5), around());
    let many: Vec<f64> = x.iter().cycle().take(9000).copied().collect();
    let all = relaxed(&elastic, &many, at(&q), Transform::Rigid);
    assert_eq!(all[..x.len()], relaxed(&elastic, &x, at(&q), Transform::Rigid));
}

#[test]
fn a_drag_in_small_steps_has_no_jumps_nor_has_space() {
    let elastic = elastic(&P);
    let x = around();
    let frame = |by: f64| relaxed(&elastic, &x, at(&targets(&P, by)), Transform::Rigid);
    let mut before = x.clone();
    for step in 1..=60 {
        let by = 0.02 * f64::from(step);
        let now = frame(by);
        // Control points go by at most 0.02 a step.
        let most = furthest(&now, &before);
        assert!(most < 0.08, "{most} at {by}");
        before = now;
    }
    let beside: Vec<f64> = x.iter().map(|c| c + 1e-7).collect();
    let there = relaxed(&elastic, &beside, at(&targets(&P, 1.2)), Transform::Rigid);
    assert!(furthest(&there, &before) < 1e-5);
}

#[test]
fn its_arrays_make_the_same_shape_again_and_what_does_not_fit_is_refused() {
    let (elastic, q) = (elastic(&P), targets(&P, 0.5));
    let again = Elastic::of(&weights(&P, 3), elastic.body().clone()).unwrap();
    let places = |elastic: &Elastic| relaxed(elastic, &around(), at(&q), Transform::Rigid);
    assert_eq!(places(&elastic), places(&again));
    let says = |change: &dyn Fn(&mut Body)| {
        let mut body = elastic.body().clone();
        change(&mut body);
        Elastic::of(&weights(&P, 3), body).err().unwrap().to_string()
    };
    assert_eq!(
        says(&|body| body.nodes[0] += 1.0),
        "relax: expected nodes of which the control points are the first"
    );
    assert_eq!(
        says(&|body| body.links[0] = [7, 7]),
        "relax: expected links of two different nodes, the smaller first"
    );
    assert_eq!(says(&|body| body.areas[3] = 0.0), "relax: expected finite areas and stiffnesses above 0");
    let unlinked = says(&|body| {
        body.links.truncate(3);
        body.stiffness.truncate(3);
    });
    assert_eq!(unlinked, "relax: expected every node to be linked to a control point");
}

#[test]
fn a_line_is_refused_and_a_plane_stays_in_its_plane() {
    let line = weights(&[0.0, 1.0], 1);
    let error = Elastic::new(&line, Shape { x: &[0.0, 1.0], faces: &[] }).err().unwrap();
    assert_eq!(error.to_string(), "relax: a line has no stiffness: expected points of 2 or 3 coordinates");
    let p = [-1.0, 0.0, 0.0, 0.1, 1.0, 0.0, 0.3, -0.1];
    let cloud: Vec<f64> = (0..800)
        .map(|at| if at % 2 == 0 { f64::from(at) / 400.0 - 1.0 } else { 0.1 * f64::from(at).sin() })
        .collect();
    let elastic = Elastic::new(&weights(&p, 2), Shape { x: &cloud, faces: &[] }).unwrap();
    let (sin, cos) = 2.5_f64.sin_cos();
    let turn = |x: &[f64]| -> Vec<f64> {
        x.as_chunks::<2>()
            .0
            .iter()
            .flat_map(|x| [cos * x[0] - sin * x[1] + 1.0, sin * x[0] + cos * x[1]])
            .collect()
    };
    let off = furthest(&relaxed(&elastic, &cloud, at(&turn(&p)), Transform::Rigid), &turn(&cloud));
    assert!(off < 1e-10, "{off}");
    // Mirrored, which no rotation does.
    let mirrored: Vec<f64> = p.as_chunks::<2>().0.iter().flat_map(|p| [p[0], -p[1]]).collect();
    let found = relaxed(&elastic, &cloud, at(&mirrored), Transform::Rigid);
    assert!(found.iter().all(|c| c.is_finite()));
}

#[test]
fn a_shape_of_few_points_and_one_of_as_many_as_control_points_will_do() {
    for x in [&P[..], &around()[..30]] {
        let elastic = Elastic::new(&weights(&P, 3), Shape { x, faces: &[] }).unwrap();
        let q = targets(&P, 0.5);
        let found = relaxed(&elastic, &around(), at(&q), Transform::Rigid);
        assert!(found.iter().all(|c| c.is_finite() && c.abs() < 10.0));
    }
}

/// The rotation nearest to a matrix, by its singular values.
fn polar(m: &Matrix3<f64>) -> Matrix3<f64> {
    let svd = m.svd(true, true);
    let (u, v) = (svd.u.unwrap(), svd.v_t.unwrap());
    let mut sign = Matrix3::identity();
    // The least of them gives way where there would be a reflection.
    sign[(2, 2)] = (u * v).determinant().signum();
    u * sign * v
}

#[test]
fn turns_lead_to_the_nearest_rotation() {
    let mut r = crate::mls::matrix::identity();
    let m = [[0.3, -1.0, 0.2], [0.9, 0.4, -0.3], [0.1, 0.2, 0.8]];
    for _ in 0..60 {
        r = turn::turned(&r, &m, 1);
    }
    let expected = polar(&Matrix3::from_fn(|i, k| m[i][k]));
    assert!((0..9).all(|at| (r[at / 3][at % 3] - expected[(at / 3, at % 3)]).abs() < 1e-12));
}

/// A global step as the formula has it, all nodes with all.
#[test]
fn a_global_step_is_that_of_dense_algebra() {
    let elastic = elastic(&P);
    let (m, n) = (5, elastic.nodes.len());
    let q: Vec<Position> = targets(&P, 0.5).as_chunks::<3>().0.to_vec();
    let w: Vec<f64> = (0..n * m).map(|at| (1.0 + (at as f64).sin()) / 5.0).collect();
    let held = vec![None; m];
    let posed = Posed { w: &w, q: &q, held: &held };
    let start: Vec<Matrix<3>> = (0..n)
        .map(|i| {
            turn::turned(
                &crate::mls::matrix::identity(),
                &[[1.0, 0.1 * (i as f64).sin(), 0.0], [0.0, 1.0, 0.2], [0.0, 0.0, 1.0]],
                3,
            )
        })
        .collect();
    let mut moved = Moved { y: elastic.nodes.clone(), maps: start };
    moved.y[..m].copy_from_slice(&q);
    let maps = moved.maps.clone();
    let before = moved.y.clone();
    let (stiffness, attached) =
        solve::one_step(&elastic.rest, &elastic.body, &elastic.system, &posed, &mut moved);

    // Weights of links and attachments, from where nodes were.
    let vector = |x: &Position| nalgebra::Vector3::new(x[0], x[1], x[2]);
    let matrix = |r: &Matrix<3>| Matrix3::from_fn(|i, k| r[i][k]);
    let mut factors = Vec::new();
    for [a, b] in elastic.body.links.iter().map(|ends| ends.map(|end| end as usize)) {
        let dx = vector(&elastic.nodes[a]) - vector(&elastic.nodes[b]);
        let dy = vector(&before[a]) - vector(&before[b]);
        let off = |i: usize| (dy - matrix(&maps[i]) * dx).norm_squared();
        factors.push(1.0 / ((off(a) + off(b)) / (2.0 * dx.norm_squared()) + 0.03 * 0.03).sqrt());
    }
    let all: f64 = elastic.body.stiffness.iter().sum();
    let mean = factors.iter().zip(&elastic.body.stiffness).map(|(f, s)| f * s).sum::<f64>() / all;
    for ((found, factor), stiff) in stiffness.iter().zip(&factors).zip(&elastic.body.stiffness) {
        assert!((found - stiff * factor / mean).abs() < 1e-9 * found);
    }

    // The system in full.
    let free = n - m;
    let (mut a, mut b) = (DMatrix::zeros(free, free), DMatrix::zeros(free, 3));
    for (link, ends) in elastic.body.links.iter().enumerate() {
        let ends = ends.map(|end| end as usize);
        for (i, j) in [(ends[0], ends[1]), (ends[1], ends[0])] {
            if i < m {
                continue;
            }
            a[(i - m, i - m)] += stiffness[link];
            let dx = vector(&elastic.nodes[i]) - vector(&elastic.nodes[j]);
            let mut right = 0.5 * stiffness[link] * (matrix(&moved.maps[i]) + matrix(&moved.maps[j])) * dx;
            if j < m {
                right += stiffness[link] * vector(&q[j]);
            } else {
                a[(i - m, j - m)] -= stiffness[link];
            }
            (0..3).for_each(|k| b[(i - m, k)] += right[k]);
        }
    }
    for (i, (p, q, firm)) in attached.iter().enumerate() {
        a[(i, i)] += firm;
        let arm = vector(&elastic.nodes[m + i]) - vector(p);
        let right = *firm * (matrix(&moved.maps[m + i]) * arm + vector(q));
        (0..3).for_each(|k| b[(i, k)] += right[k]);
    }
    let expected = a.cholesky().unwrap().solve(&b);
    let off =
        (0..free).map(|i| (vector(&moved.y[m + i]) - expected.row(i).transpose()).amax()).fold(0.0, f64::max);
    assert!(off < 1e-10, "{off}");
}
