//! What walks and paths over small shapes must say, and the whole against dense algebra.

use super::cholesky::solve;
use super::graph::links_of;
use super::links::Links;
use super::mesh::{divide, merged, SPACING};
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
fn the_two_shortest_paths_are_those_that_looking_at_all_finds() {
    let (x, faces) = boxes(&[[[0.0; 3], [0.2, 0.1, 0.1]], [[0.1, 0.1, 0.0], [0.15, 0.3, 0.1]]]);
    let p = [[0.0, 0.0, 0.0], [0.2, 0.1, 0.1], [0.12, 0.3, 0.05]];
    let walked = walked(&(x, faces), &p);
    let (links, count) = (&walked.links, walked.links.nodes.len());
    let length = |a: usize, b: usize| squared(&links.nodes[a], &links.nodes[b]).sqrt();
    let mut next = vec![vec![false; count]; count];
    links
        .ends
        .iter()
        .for_each(|&[a, b]| (next[a as usize][b as usize], next[b as usize][a as usize]) = (true, true));
    let two = |a: usize, b: usize| next[a][b] || (0..count).any(|c| next[a][c] && next[c][b]);
    let mut far = vec![vec![f64::INFINITY; count]; p.len()];
    attached(&walked.near, &p, 2.0, 512)
        .iter()
        .for_each(|&(point, node, away)| far[point as usize][node as usize] = away);
    for far in &mut far {
        for _ in 0..count {
            let before = far.clone();
            for (a, b) in (0..count * count).map(|at| (at / count, at % count)).filter(|&(a, b)| a != b) {
                if before[a] + length(a, b) < far[b] && two(a, b) {
                    far[b] = before[a] + length(a, b);
                }
            }
            if before == *far {
                break;
            }
        }
    }
    for node in 0..count {
        let mut all: Vec<(f64, usize)> =
            far.iter().enumerate().map(|(point, far)| (far[node], point)).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let along = &walked.along;
        assert!((along.far[node] - all[0].0).abs() < 1e-9 && (along.second[node] - all[1].0).abs() < 1e-9);
        assert!(along.nearest[node] as usize == all[0].1 || all[1].0 - all[0].0 < 1e-9);
    }
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
    // By distances alone it would be near the middle. It was over 0.75 while edges that two triangles share were torn, which kept walks from the
    // leg; whole, the surface gives 0.724.
    assert!(met[2 * walked.nearest([0.05, 0.03, 0.0])] > 0.7);
}

#[test]
fn the_sparse_system_is_solved_as_a_dense_one() {
    let (x, faces) = boxes(&[[[0.0; 3], [0.2, 0.1, 0.1]], [[0.1, 0.1, 0.0], [0.15, 0.3, 0.1]]]);
    let links = links_of(&x, &faces);
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

#[test]
fn an_edge_that_is_halved_from_both_sides_at_different_times_has_one_middle() {
    // The long edges are halved first where they are the longest of their triangle, and later where a longer one is.
    let (x, faces) = boxes(&[[[-1.0, -0.5, 0.9], [1.0, 0.5, 1.0]]]);
    let (mut nodes, mut faces) = (x, faces);
    divide(&mut nodes, &mut faces);
    let count = nodes.len();
    let (places, _) = merged(&nodes, &[]);
    assert_eq!(places.len(), count);
}

/// A chair whose every part is a box, whose every triangle stands alone, and some of which are there twice: long needles everywhere.
fn soup_of_a_chair() -> Soup {
    let legs = [(-0.5, -0.5), (0.44, -0.5), (-0.5, 0.44), (0.44, 0.44)];
    let mut parts: Vec<[Position; 2]> =
        legs.iter().map(|&(x, z)| [[x, -1.0, z], [x + 0.06, 0.0, z + 0.06]]).collect();
    parts.extend([[[-0.5, 0.0, -0.5], [0.5, 0.08, 0.5]], [[-0.5, 0.0, -0.5], [0.5, 1.0, -0.45]]]);
    parts.extend([[[-0.48, -0.6, -0.48], [-0.46, -0.57, 0.48]], [[0.46, -0.6, -0.48], [0.48, -0.57, 0.48]]]);
    parts.extend_from_within(..4);
    let (x, faces) = boxes(&parts);
    let torn = faces.iter().flatten().map(|&corner| x[corner as usize]).collect();
    (torn, (0..faces.len() as u32).map(|face| [0, 1, 2].map(|k| 3 * face + k)).collect())
}

#[test]
fn what_is_nearer_to_a_control_point_than_half_of_the_way_to_any_other_follows_it() {
    // On, inside and outside of the shape; one foot has none.
    let chair = vec![
        [-0.47, -1.0, -0.47],
        [0.47, -0.9, -0.47],
        [-0.47, -1.05, 0.47],
        [0.4, 0.04, 0.4],
        [-0.4, 0.1, 0.4],
        [0.0, 0.95, -0.48],
        [0.0, 0.04, 0.0],
    ];
    let legs = vec![[-1.0, 0.0, 0.95], [1.0, 0.0, 0.95], [-0.11, 0.0, -0.95], [0.11, 0.0, -0.4]];
    for (shape, p) in [(soup_of_a_chair(), chair), (stool(), legs)] {
        let flat = shape.0.concat();
        let given = Shape { x: &flat, faces: &shape.1 };
        let found = labels(&p.concat(), 3, Frame::IDENTITY, given, &mut |_| true).unwrap();
        let walked = walked(&shape, &p);
        let mut seen = 0;
        for (x, logits) in found.x.as_chunks::<3>().0.iter().zip(found.logits.chunks_exact(p.len())) {
            let node = walked.nearest(*x);
            let along = &walked.along;
            if walked.links.nodes[node] == *x && along.far[node] < 0.5 * along.second[node] {
                let sum: f64 = logits.iter().map(|logit| logit.exp()).sum();
                let own = logits[along.nearest[node] as usize].exp() / sum;
                assert!(own > 0.5, "{x:?} has {own} of {}", along.nearest[node]);
                seen += 1;
            }
        }
        assert!(seen > 300, "{seen}");
        let m = p.len();
        let trained = fit(&p.concat(), 3, Frame::IDENTITY, given, 0, &mut |_| true).unwrap();
        let learned = trained.network.logits(&walked.links.nodes.concat(), &mut |_| true).unwrap();
        for (node, logits) in learned.chunks_exact(m).enumerate() {
            let mut weights = vec![0.0; m];
            crate::softmax::weights(logits, 1.0, &mut weights);
            let own = walked.along.nearest[node] as usize;
            assert!(
                walked.along.part_of_way(node) >= 0.5 || weights[own] > 0.5,
                "{node} has {}",
                weights[own]
            );
        }
        assert!(
            trained.missed.len() == m && trained.missed.iter().sum::<f64>() < 0.01,
            "{:?}",
            trained.missed
        );
    }
}

#[test]
fn triangles_conduct_as_much_as_their_area_says_needles_too() {
    let (x, faces) = soup_of_a_chair();
    let links = links_of(&x, &faces);
    let conducts: f64 =
        (0..links.ends.len()).map(|link| 0.5 * links.conductances[link] * links.length(link).powi(2)).sum();
    let area: f64 = links.areas.iter().sum();
    // What is there twice counts once. Joints add a little.
    assert!((area - 5.7032).abs() < 1e-9, "{area}");
    assert!(conducts < 1.3 * area, "{conducts} of {area}");
}
