//! A surface as nodes and the strips between them: vertices in one place are one node, long edges are halved, and an edge conducts as
//! the strip of surface along it does.
//!
//! Cotangents: Pinkall, Polthier, "Computing discrete minimal surfaces and their conjugates", 1993.

use std::collections::HashMap;

use super::links::summed;
use super::{squared, Position};

/// Longest edge, in halves of the shape's longest side.
pub(super) const SPACING: f64 = 0.06;
/// Nodes: long edges are no longer halved beyond.
const MOST: usize = 40_000;
/// What every edge conducts, also where triangles are so obtuse that the cotangents say less than nothing.
const LEAST: f64 = 0.01;
/// What is smaller is a needle without a side.
const LEAST_AREA: f64 = 5e-13;
/// Of half of the longest side: vertices in the same of these are in one place.
const PLACES: f64 = 1e7;

/// Vertices in one place made one, in the order of their coordinates, and the faces of them, each once.
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
    // A face of two places is a line, and holds them together.
    let point = |[a, b, c]: &[u32; 3]| a == b && b == c;
    let mut faces: Vec<[u32; 3]> =
        faces.iter().map(|face| face.map(|corner| which[corner as usize])).collect();
    faces.retain(|face| !point(face));
    // A face that is there twice, from either side, is one sheet: it conducts once.
    let corners = |face: &[u32; 3]| {
        let mut corners = *face;
        corners.sort_unstable();
        corners
    };
    let mut order: Vec<usize> = (0..faces.len()).collect();
    order.sort_by_key(|&face| corners(&faces[face]));
    order.dedup_by_key(|face| corners(&faces[*face]));
    order.sort_unstable();
    (nodes, order.into_iter().map(|face| faces[face]).collect())
}

/// Halves triangles across their longest edges until none is longer than [`SPACING`].
///
/// Two triangles may halve the edge between them in different rounds: its middle is one node, or the surface would be torn there.
pub(super) fn divide(x: &mut Vec<Position>, faces: &mut Vec<[u32; 3]>) {
    let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
    while x.len() < MOST {
        let (mut kept, mut halves) = (Vec::with_capacity(2 * faces.len()), Vec::new());
        for face in faces.iter() {
            let length = |k: usize| squared(&x[face[k] as usize], &x[face[(k + 1) % 3] as usize]).sqrt();
            let longest =
                [1, 2].into_iter().fold(0, |most, k| if length(k) > length(most) { k } else { most });
            if length(longest) <= SPACING {
                kept.push(*face);
                continue;
            }
            let [a, b, c] = [0, 1, 2].map(|step| face[(longest + step) % 3]);
            let middle = *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                x.push(std::array::from_fn(|k| (x[a as usize][k] + x[b as usize][k]) / 2.0));
                x.len() as u32 - 1
            });
            halves.extend([[a, middle, c], [middle, b, c]]);
        }
        if halves.is_empty() {
            break;
        }
        kept.extend(halves);
        *faces = kept;
    }
}

/// Each edge once, with what it conducts: half the sum of the cotangents of the angles that face it.
///
/// Triangles of a soup may be needles, in which one cotangent is far below 0 and the others far above. What is below counts as 0, and the rest
/// is scaled so that a triangle conducts as much in all as any other of its area: `sum_k w_k l_k^2 = 2 area`, which holds for cotangents by
/// itself where no angle is obtuse.
pub(super) fn edges(x: &[Position], faces: &[[u32; 3]]) -> (Vec<[u32; 2]>, Vec<f64>) {
    let strips = faces.iter().flat_map(|face| {
        let corners = face.map(|corner| &x[corner as usize]);
        let area = area(corners);
        let halves = [0, 1, 2].map(|k| {
            let [apex, a, b] = [0, 1, 2].map(|step| corners[(k + step) % 3]);
            0.5 * (across(apex, a, b) / (2.0 * area.max(LEAST_AREA))).max(0.0)
        });
        let length = |k: usize| squared(corners[(k + 1) % 3], corners[(k + 2) % 3]);
        let in_all: f64 = (0..3).map(|k| halves[k] * length(k)).sum();
        let part = if in_all > 2.0 * area { 2.0 * area / in_all } else { 1.0 };
        [0, 1, 2].map(|k| ([face[(k + 1) % 3], face[(k + 2) % 3]], part * halves[k]))
    });
    let (ends, mut conductances) = summed(strips);
    conductances.iter_mut().for_each(|conducts| *conducts = conducts.max(LEAST));
    (ends, conductances)
}

/// A third of the area of its triangles for each node.
pub(super) fn areas(x: &[Position], faces: &[[u32; 3]]) -> Vec<f64> {
    let mut areas = vec![0.0; x.len()];
    for face in faces {
        let third = area(face.map(|corner| &x[corner as usize])) / 3.0;
        face.iter().for_each(|&corner| areas[corner as usize] += third);
    }
    areas
}

fn area([a, b, c]: [&Position; 3]) -> f64 {
    let across = across(a, b, c);
    0.5 * (squared(a, b) * squared(a, c) - across * across).max(0.0).sqrt()
}

/// `(a - apex) . (b - apex)`.
fn across(apex: &Position, a: &Position, b: &Position) -> f64 {
    (0..3).map(|k| (a[k] - apex[k]) * (b[k] - apex[k])).sum()
}
