//! The ends of a shape: feet, wing tips, the corners of a back.
//!
//! Where the mean distance along the shape to all of it is greater than around: Hilaga et al., "Topology matching for fully automatic
//! similarity estimation of 3D shapes", 2001. What counts is how far one has to come down before it goes up to a greater one:
//! Edelsbrunner et al., "Topological persistence and simplification", 2002.

use super::along::Along;

/// Least prominence, of the range of the mean distance.
const PROMINENT: f64 = 0.15;
/// The same of what is made of parts: corners of boards and ends of boxes are what a person takes hold of.
const PROMINENT_OF_PARTS: f64 = 0.02;
/// Most ends of one piece: more of them leave too few control points for the middles.
const MOST: usize = 8;
/// Least distance from another, of the median distance.
const APART: f64 = 0.25;

/// The ends among the places that are `seen`, the most prominent first, at most two thirds of `count`. What is not seen can be passed, and
/// is no end.
pub(super) fn extremities(along: &Along, seen: &[bool], of_parts: bool, count: usize) -> Vec<usize> {
    let (prominent, most) = if of_parts { (PROMINENT_OF_PARTS, usize::MAX) } else { (PROMINENT, MOST) };
    let most = most.min(2 * count / 3);
    let mean = mean_distances(along, seen);
    let ends = |(low, high): (f64, f64), mean: &f64| (low.min(*mean), high.max(*mean));
    let (low, high) = mean.iter().fold((f64::INFINITY, 0.0), ends);
    let mut ends = prominences(along, seen, &mean);
    ends.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let apart = APART * median(along);
    let mut chosen: Vec<usize> = Vec::new();
    for (prominence, node) in ends {
        let far = chosen.iter().all(|&other| along.from(other)[node] > apart);
        if chosen.len() < most && prominence >= prominent * (high - low) && far {
            chosen.push(node);
        }
    }
    chosen
}

/// Of each place, how far the seen surface is from it in the mean.
pub(super) fn mean_distances(along: &Along, seen: &[bool]) -> Vec<f64> {
    let area = |node: usize| if seen[node] { along.areas[node] } else { 0.0 };
    let all: f64 = (0..along.len()).map(area).sum();
    let of =
        |node| along.from(node).iter().enumerate().map(|(other, far)| area(other) * far).sum::<f64>() / all;
    (0..along.len()).map(of).collect()
}

fn median(along: &Along) -> f64 {
    let mut all = along.far.clone();
    let middle = all.len() / 2;
    *all.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The local maxima that are seen, each with how far one comes down on the way to a greater one.
pub(super) fn prominences(along: &Along, seen: &[bool], height: &[f64]) -> Vec<(f64, usize)> {
    let n = along.len();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| height[b].total_cmp(&height[a]).then(a.cmp(&b)));
    // As the water falls: whose island each place is of, and the highest seen place of that.
    let mut above: Vec<Option<usize>> = vec![None; n];
    let mut top: Vec<Option<usize>> = vec![None; n];
    let mut found = Vec::new();
    let rises = |top: Option<usize>| top.map_or(f64::NEG_INFINITY, |top| height[top]);
    for &node in &order {
        (above[node], top[node]) = (Some(node), seen[node].then_some(node));
        for &(other, _) in &along.links[node] {
            if above[other as usize].is_none() {
                continue;
            }
            let (a, b) = (root(&mut above, node), root(&mut above, other as usize));
            if a == b {
                continue;
            }
            let (lower, higher) = if rises(top[a]) < rises(top[b]) { (a, b) } else { (b, a) };
            if let Some(end) = top[lower].filter(|end| height[*end] > height[node]) {
                found.push((height[end] - height[node], end));
            }
            above[lower] = Some(higher);
        }
    }
    let lowest = order.last().map_or(0.0, |&node| height[node]);
    let roots: Vec<usize> = (0..n).filter(|&node| above[node] == Some(node)).collect();
    found.extend(roots.into_iter().filter_map(|node| top[node]).map(|end| (height[end] - lowest, end)));
    found
}

fn root(above: &mut [Option<usize>], mut node: usize) -> usize {
    while let Some(next) = above[node].filter(|next| *next != node) {
        above[node] = above[next];
        node = next;
    }
    node
}
