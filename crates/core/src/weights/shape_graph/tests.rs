//! What walks and paths over small shapes must say, and the whole against dense algebra.

use super::cholesky::solve;
use super::graph::links_of;
use super::links::Links;
use super::mesh::SPACING;
use super::near::Near;
use super::paths::{reach, Reach};
use super::walks::first_met;
use super::*;
use crate::error::Error;
use crate::geometry::Frame;
use nalgebra::{DMatrix, DVector};

const BOX: [[u32; 3]; 12] = [
    [0, 1, 3],
    [0, 3, 2],
    [4, 6, 7],
    [4, 7, 5],
    [0, 4, 5],
    [0, 5, 1],
    [2, 3, 7],
    [2, 7, 6],
    [0, 2, 6],
    [0, 6, 4],
    [1, 5, 7],
    [1, 7, 3],
];

type Soup = (Vec<Position>, Vec<[u32; 3]>);

/// Boxes as one shape, each a component of its own.
fn boxes(corners: &[[Position; 2]]) -> Soup {
    let (mut x, mut faces) = (Vec::new(), Vec::new());
    for ends in corners {
        let first = x.len() as u32;
        x.extend(
            (0..8).map(|corner| -> Position { std::array::from_fn(|k| ends[corner >> (2 - k) & 1][k]) }),
        );
        faces.extend(BOX.map(|face| face.map(|corner| first + corner)));
    }
    (x, faces)
}

/// A seat of one box, and two legs that are boxes, side by side, and end inside the seat.
fn stool() -> Soup {
    boxes(&[
        [[-1.0, -0.5, 0.9], [1.0, 0.5, 1.0]],
        [[-0.16, -0.05, -1.0], [-0.06, 0.05, 0.95]],
        [[0.06, -0.05, -1.0], [0.16, 0.05, 0.95]],
    ])
}

struct Walked {
    links: Links,
    near: Near,
    along: Reach,
}

fn walked((x, faces): &Soup, p: &[Position]) -> Walked {
    let links = links_of(x, faces);
    let near = Near::new(&links.nodes);
    let along = reach(&links, &near, p);
    Walked { links, near, along }
}

impl Walked {
    fn nearest(&self, x: Position) -> usize {
        let mut found = Vec::new();
        self.near.nearest(&x, 1, f64::INFINITY, |_| true, &mut found);
        found[0].1 as usize
    }
}

/// The distance along the shape.
fn along(shape: &Soup, start: Position, end: Position) -> f64 {
    let walked = walked(shape, &[start]);
    walked.along.far[walked.nearest(end)]
}

#[test]
fn edges_conduct_as_half_the_cotangents_that_face_them() {
    let square = [[0.0, 0.0, 0.0], [0.028, 0.0, 0.0], [0.028, 0.028, 0.0], [0.0, 0.028, 0.0]];
    let links = links_of(&square, &[[0, 1, 2], [0, 2, 3]]);
    // The nodes are in the order of their coordinates. Right angles face the diagonal: their cotangents are 0.
    assert_eq!(links.ends, [[0, 1], [0, 2], [0, 3], [1, 3], [2, 3]]);
    let expected = [0.5, 0.5, 0.01, 0.5, 0.5];
    assert!(links.conductances.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-9));
}

#[test]
fn a_path_over_coarse_triangles_is_about_straight() {
    let square = vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let shape = (square, vec![[0, 1, 2], [0, 2, 3]]);
    for (start, end) in [
        ([-1.0, -1.0, 0.0], [1.0, 1.0, 0.0]),
        ([1.0, -1.0, 0.0], [-1.0, 1.0, 0.0]),
        ([-1.0, -1.0, 0.0], [1.0, 0.0, 0.0]),
    ] {
        let (straight, found) = (squared(&start, &end).sqrt(), along(&shape, start, end));
        assert!(straight - 2.0 * SPACING < found && found < 1.05 * straight, "{found} for {straight}");
    }
}

#[test]
fn legs_side_by_side_are_far_apart_and_each_belongs_to_its_seat() {
    assert!(along(&stool(), [-0.06, 0.0, -1.0], [0.06, 0.0, -1.0]) > 3.5);
    let to_the_seat = along(&stool(), [-0.16, 0.0, 0.0], [-1.0, 0.0, 0.9]);
    assert!((to_the_seat - 1.74).abs() < 0.15, "{to_the_seat}");
}

#[test]
fn a_control_point_in_a_body_is_near_every_side_of_it() {
    let slab = boxes(&[[[-1.0, -0.5, -0.12], [1.0, 0.5, 0.12]]]);
    let below = [0.0, 0.0, -0.03];
    assert!((along(&slab, below, [0.0, 0.0, -0.12]) - 0.09).abs() < SPACING / 2.0);
    assert!((along(&slab, below, [0.0, 0.0, 0.12]) - 0.15).abs() < SPACING / 2.0);
    // One on the surface is as far from the other side as the way around.
    assert!(along(&slab, [0.0, 0.0, -0.12], [0.0, 0.0, 0.12]) > 1.0);
}

#[test]
fn parts_that_touch_nowhere_are_reached_from_their_nearest() {
    let apart = boxes(&[[[-1.0, -0.1, -0.1], [-0.5, 0.1, 0.1]], [[0.3, -0.1, -0.1], [1.0, 0.1, 0.1]]]);
    let found = along(&apart, [-1.0, 0.1, 0.1], [1.0, 0.1, 0.1]);
    // The one link is between any two of the nearest nodes: at most from corner to corner.
    assert!((2.0 - 2.0 * SPACING..2.6).contains(&found), "{found}");
}

#[test]
fn a_triangle_soup_and_what_is_repeated_or_flat_change_no_path() {
    let (x, faces) = stool();
    let ends = ([-0.16, -0.05, -1.0], [1.0, 0.5, 0.9]);
    let expected = along(&(x.clone(), faces.clone()), ends.0, ends.1);
    let torn: Vec<Position> = faces.iter().flatten().map(|&corner| x[corner as usize]).collect();
    let each = (0..faces.len() as u32).map(|face| [0, 1, 2].map(|k| 3 * face + k)).collect();
    let repeated: Vec<Position> = x.iter().chain(&x[..3]).copied().collect();
    let more: Vec<[u32; 3]> = faces.iter().copied().chain([[0, 0, 0], [0, 1, 1], [24, 1, 0]]).collect();
    for shape in [(torn, each), (repeated, more)] {
        assert!((along(&shape, ends.0, ends.1) / expected - 1.0).abs() < 1e-9);
    }
}

#[test]
fn a_cloud_is_followed_point_by_point() {
    let angles = (0..400).map(|at| std::f64::consts::PI * f64::from(at) / 399.0);
    let horseshoe: Vec<Position> = angles.map(|angle| [0.1 * angle.cos(), 0.0, angle.sin()]).collect();
    let (start, end) = (horseshoe[0], horseshoe[399]);
    assert!(along(&(horseshoe, Vec::new()), start, end) > 1.8);
}

#[test]
fn between_two_control_points_a_walk_meets_either_as_often_and_always_one() {
    let p = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
    let walked = walked(&boxes(&[[[-1.0, -0.1, -0.1], [1.0, 0.1, 0.1]]]), &p);
    let met = first_met(&walked.links, &walked.near, &p, &walked.along).unwrap();
    let middle = walked.nearest([0.0, 0.1, 0.0]);
    assert!((met[2 * middle] - 0.5).abs() < 0.03);
    assert!(met.chunks_exact(2).all(|met| (met[0] + met[1] - 1.0).abs() < 1e-9 && met[0].min(met[1]) >= 0.0));
}

#[test]
fn a_walk_from_where_a_thin_leg_begins_ends_in_the_trunk() {
    let shape = boxes(&[[[-1.0, -0.3, -0.3], [0.0, 0.3, 0.3]], [[-0.05, -0.03, -0.03], [1.0, 0.03, 0.03]]]);
    let p = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
    let walked = walked(&shape, &p);
    let met = first_met(&walked.links, &walked.near, &p, &walked.along).unwrap();
    // By distances alone it would be near the middle.
    assert!(met[2 * walked.nearest([0.05, 0.03, 0.0])] > 0.75);
}

#[test]
fn the_sparse_system_is_solved_as_a_dense_one() {
    let links = links_of(&stool().0, &stool().1);
    let n = links.nodes.len();
    let ground: Vec<f64> = (0..n).map(|node| if node % 7 == 0 { 0.1 + node as f64 } else { 0.0 }).collect();
    let given: Vec<f64> = (0..2 * n).map(|at| (at as f64).sin()).collect();
    let mut dense = DMatrix::from_diagonal(&DVector::from_column_slice(&ground));
    for (ends, conducts) in links.ends.iter().zip(&links.conductances) {
        let [a, b] = ends.map(|end| end as usize);
        dense[(a, a)] += conducts;
        dense[(b, b)] += conducts;
        dense[(a, b)] -= conducts;
        dense[(b, a)] -= conducts;
    }
    let expected = dense.cholesky().unwrap().solve(&DMatrix::from_row_slice(n, 2, &given));
    let mut found = given;
    solve(&links.ends, &links.conductances, &ground, &mut found);
    let off = (0..2 * n).map(|at| (found[at] - expected[(at / 2, at % 2)]).abs()).fold(0.0, f64::max);
    assert!(off < 1e-9 * expected.amax(), "{off}");
}

#[test]
fn progress_rises_to_one_and_a_wish_to_stop_is_heard_at_any_time() {
    let (x, faces) = stool();
    let (x, p) = (x.concat(), [-1.0, 0.0, 0.95, 1.0, 0.0, 0.95, -0.11, 0.0, -1.0]);
    let shape = Shape { x: &x, faces: &faces };
    let mut told = Vec::new();
    labels(&p, 3, Frame::IDENTITY, shape, &mut |done| {
        told.push(done);
        true
    })
    .unwrap();
    assert!(told.is_sorted() && told[0] == 0.0 && told.last() == Some(&1.0));
    for stop in 0..told.len() {
        let mut calls = 0;
        let stopped = labels(&p, 3, Frame::IDENTITY, shape, &mut |_| {
            calls += 1;
            calls <= stop
        });
        assert_eq!(stopped, Err(Error::Cancelled));
    }
}

#[test]
fn refuses_what_is_no_shape() {
    let says = |x: &[f64], faces: &[[u32; 3]]| {
        let shape = Shape { x, faces };
        labels(&[0.0; 3], 3, Frame::IDENTITY, shape, &mut |_| true).unwrap_err().to_string()
    };
    assert_eq!(says(&[], &[]), "x: expected at least one point, found none");
    assert_eq!(says(&[0.0; 6], &[[0, 1, 2]]), "faces: expected vertices 0 to 1, found (0, 1, 2)");
    assert_eq!(says(&[f64::NAN; 3], &[]), "x: point 0 has a coordinate that is not finite");
}

/// What the first version of this, in NumPy and SciPy, said of the stool.
#[test]
fn labels_are_those_of_an_independent_implementation() {
    let (x, faces) = stool();
    let x = x.concat();
    let p = [[-1.0, 0.0, 0.95], [1.0, 0.0, 0.95], [-0.11, 0.0, -1.0], [0.11, 0.0, -0.4]].concat();
    let shape = Shape { x: &x, faces: &faces };
    let found = labels(&p, 3, Frame::IDENTITY, shape, &mut |_| true).unwrap();
    let rows: [(usize, Position, [f64; 4]); 4] = [
        (0, [0.16, 0.05, -1.0], [-11.9844857958126, -11.868428604356659, -13.044425865425925, 0.0]),
        (1, [-1.0, -0.46875, 1.0], [0.0, -1.3877854481114054, -5.8746409304251905, -4.215236537026863]),
        (
            500,
            [0.0709375, -0.05, 0.37109375],
            [-2.5708313569711727, -2.289044072008914, -5.840383416938472, 0.0],
        ),
        (
            1500,
            [-0.1459375, -0.05, 0.31015625],
            [-0.7313400012328914, -0.887748416790672, 0.0, -2.456467039313936],
        ),
    ];
    for (row, place, logits) in rows {
        let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9);
        assert!(near(&found.x[3 * row..][..3], &place), "{row}: {:?}", &found.x[3 * row..][..3]);
        assert!(near(&found.logits[4 * row..][..4], &logits), "{row}: {:?}", &found.logits[4 * row..][..4]);
    }
    assert_eq!(found.logits.len(), 4 * 2048);
    assert!((found.logits.iter().sum::<f64>() + 23434.25219182206).abs() < 1e-6);
}
