//! A surface as nodes and the strips between them: vertices in one place are one node, long edges are halved, and an edge conducts as
//! the strip of surface along it does.
//!
//! Cotangents: Pinkall, Polthier, "Computing discrete minimal surfaces and their conjugates", 1993.

use super::links::summed;
use super::{squared, Position};

/// Longest edge, in halves of the shape's longest side.
pub(super) const SPACING: f64 = 0.06;
/// Nodes: long edges are no longer halved beyond.
const MOST: usize = 40_000;
/// What every edge conducts, also where triangles are so obtuse that the cotangents say less than nothing.
const LEAST: f64 = 0.01;
const MOST_COTANGENT: f64 = 10.0;
/// Of half of the longest side: vertices in the same of these are in one place.
const PLACES: f64 = 1e7;

/// Vertices in one place made one, in the order of their coordinates, and the faces of them.
pub(super) fn merged(x: &[Position], faces: &[[u32; 3]]) -> (Vec<Position>, Vec<[u32; 3]>) {
    let places: Vec<Position> =
        x.iter().map(|x| x.map(|c| (c * PLACES).round_ties_even() / PLACES + 0.0)).collect();
    let mut order: Vec<u32> = (0..x.len() as u32).collect();
    let place = |index: u32| &places[index as usize];
    order.sort_unstable_by(|&a, &b| place(a).partial_cmp(place(b)).expect("finite"));
    let (mut nodes, mut which) = (Vec::new(), vec![0_u32; x.len()]);
    for of_one in order.chunk_by(|&a, &b| place(a) == place(b)) {
        of_one.iter().for_each(|&vertex| which[vertex as usize] = nodes.len() as u32);
        nodes.push(*place(of_one[0]));
    }
    (nodes, faces.iter().map(|face| face.map(|corner| which[corner as usize])).collect())
}

/// Halves triangles across their longest edges until none is longer than [`SPACING`].
pub(super) fn divide(x: &mut Vec<Position>, faces: &mut Vec<[u32; 3]>) {
    while x.len() < MOST {
        let (mut kept, mut long, mut edges) = (Vec::with_capacity(faces.len()), Vec::new(), Vec::new());
        for face in faces.iter() {
            let length = |k: usize| squared(&x[face[k] as usize], &x[face[(k + 1) % 3] as usize]).sqrt();
            let longest =
                [1, 2].into_iter().fold(0, |most, k| if length(k) > length(most) { k } else { most });
            if length(longest) > SPACING {
                let [a, b, c] = [0, 1, 2].map(|step| face[(longest + step) % 3]);
                long.push([a, b, c]);
                edges.push([a.min(b), a.max(b)]);
            } else {
                kept.push(*face);
            }
        }
        if long.is_empty() {
            break;
        }
        let mut unique = edges.clone();
        unique.sort_unstable();
        unique.dedup();
        let first = x.len() as u32;
        for edge in &unique {
            let [a, b] = edge.map(|end| x[end as usize]);
            x.push(std::array::from_fn(|k| (a[k] + b[k]) / 2.0));
        }
        let middle: Vec<u32> = edges
            .iter()
            .map(|edge| first + unique.binary_search(edge).expect("one of them") as u32)
            .collect();
        kept.extend(long.iter().zip(&middle).map(|([a, _, c], middle)| [*a, *middle, *c]));
        kept.extend(long.iter().zip(&middle).map(|([_, b, c], middle)| [*middle, *b, *c]));
        *faces = kept;
    }
}

/// Each edge once, and half the sum of the cotangents of the angles that face it.
pub(super) fn edges(x: &[Position], faces: &[[u32; 3]]) -> (Vec<[u32; 2]>, Vec<f64>) {
    let (ends, mut conductances) = summed((0..3).flat_map(|corner| {
        faces.iter().map(move |face| {
            let [apex, a, b] = [0, 1, 2].map(|step| face[(corner + step) % 3]);
            ([a, b], 0.5 * cotangent(&x[apex as usize], &x[a as usize], &x[b as usize]))
        })
    }));
    conductances.iter_mut().for_each(|conducts| *conducts = conducts.max(LEAST));
    (ends, conductances)
}

/// Of the angle at `apex`.
fn cotangent(apex: &Position, a: &Position, b: &Position) -> f64 {
    let edge = |p: &Position| -> Position { std::array::from_fn(|k| p[k] - apex[k]) };
    let dot = |u: &Position, v: &Position| u.iter().zip(v).map(|(u, v)| u * v).sum::<f64>();
    let (u, v) = (edge(a), edge(b));
    let across = dot(&u, &v);
    let area = (dot(&u, &u) * dot(&v, &v) - across * across).max(1e-24).sqrt();
    (across / area).clamp(-MOST_COTANGENT, MOST_COTANGENT)
}
