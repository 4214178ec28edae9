//! Places in exact pairs: a shape folded on its plane of symmetry.
//!
//! One control point stands for itself and its mirror image; what it costs a place is the shorter of the two ways. Those on the plane are
//! their own image.

use super::board::Board;
use super::extremities::extremities;
use super::medoids::{medoids, Choice, Kind};
use crate::machine::random::Random;
use crate::symmetry::Mirror;
use crate::weights::shape_graph::{squared, Near, Position};

/// Of the control points, at most so many on the plane: one in so many.
const ON_PLANE: usize = 3;
/// Of the spacing of the places: nearer to the plane than this, one is on it.
const BAND: f64 = 0.75;
/// Of the spacing of the control points: each of a pair is at least so far from the plane, or they would be one point.
const OFF: f64 = 0.25;

/// Places on the plane, then those on its positive side whose mirror images belong to them.
pub(super) struct Folded {
    pub(super) single: Vec<usize>,
    pub(super) pairs: Vec<usize>,
    pub(super) cost: f64,
}

/// `count` places by `mirror`, those of the pairs counted twice; none where the shape has not so many.
pub(super) fn folded(
    board: &Board<'_>,
    mirror: &Mirror,
    count: usize,
    random: &mut Random,
) -> Option<Folded> {
    let half = Half::new(board, mirror, count);
    let (ends_on, ends_off) = half.ends(board, count);
    let fixed: Vec<usize> = ends_on.iter().chain(&ends_off).copied().collect();
    let choice = Choice { cost: &half.cost, areas: &half.areas, fixed: &fixed };
    let most = (count / ON_PLANE).max(count % 2);
    let mut best: Option<Folded> = None;
    for single in (ends_on.len()..=most).filter(|single| (count - single).is_multiple_of(2)) {
        let pairs = (count - single) / 2;
        let kinds = [
            Kind { candidates: half.on.clone(), count: single - ends_on.len() },
            Kind { candidates: half.off.clone(), count: pairs.saturating_sub(ends_off.len()) },
        ];
        let (chosen, cost) = medoids(&choice, &kinds, random);
        let (single, pairs): (Vec<usize>, Vec<usize>) =
            chosen.into_iter().partition(|node| half.on.contains(node));
        if single.len() + 2 * pairs.len() == count && best.as_ref().is_none_or(|best| cost < best.cost) {
            best = Some(Folded { single, pairs, cost });
        }
    }
    best
}

/// The half of the shape on the positive side of the plane, with what is on it.
struct Half {
    /// Of each place, how far above the plane it is, and which is nearest to its image.
    height: Vec<f64>,
    image: Vec<usize>,
    /// What is lower is in the plane, or so near to it that it could not be one of a pair.
    low: f64,
    /// Places to choose from: on the plane, and off it.
    on: Vec<usize>,
    off: Vec<usize>,
    cost: Vec<f64>,
    areas: Vec<f64>,
}

impl Half {
    fn new(board: &Board<'_>, mirror: &Mirror, count: usize) -> Half {
        let (along, seen, n) = (board.along, board.seen, board.along.len());
        let height: Vec<f64> = along.nodes.iter().map(|x| mirror.height(x)).collect();
        let near = Near::new(&along.nodes);
        let mut found = Vec::new();
        let mut nearest = |x: &Position| {
            near.nearest(x, 1, f64::INFINITY, |_| true, &mut found);
            found[0].1 as usize
        };
        let image: Vec<usize> = along.nodes.iter().map(|x| nearest(&mirror.image(x))).collect();
        let spacing = |parts: usize| (along.areas.iter().sum::<f64>() / parts as f64).sqrt();
        let band = BAND * spacing(n);
        let low = band.max(OFF * spacing(count));
        let on = (0..n).filter(|&node| seen[node] && height[node].abs() <= band).collect();
        let off = (0..n).filter(|&node| seen[node] && height[node] > low).collect();
        let area = |node: usize| if seen[node] && height[node] > -band { along.areas[node] } else { 0.0 };
        let mut cost = along.far.clone();
        for node in (0..n).filter(|&node| height[node].abs() > band) {
            let other = along.from(image[node]);
            cost[node * n..][..n].iter_mut().zip(other).for_each(|(own, other)| *own = own.min(*other));
        }
        Half { image, low, on, off, cost, areas: (0..n).map(area).collect(), height }
    }

    /// The ends of the shape, on the plane and off it, of a pair one, as many as there is room for.
    fn ends(&self, board: &Board<'_>, count: usize) -> (Vec<usize>, Vec<usize>) {
        let along = board.along;
        let (mut on, mut off): (Vec<usize>, Vec<usize>) = (Vec::new(), Vec::new());
        for end in extremities(along, board.seen, board.of_parts, count) {
            let end = if self.height[end] < 0.0 { self.image[end] } else { end };
            let same = |other: &usize| squared(&along.nodes[*other], &along.nodes[end]) < self.low * self.low;
            let room = (2 * count / 3).saturating_sub(2 * off.len() + on.len());
            if on.iter().chain(&off).any(same) {
                continue;
            }
            if self.height[end] > self.low && self.off.contains(&end) && room >= 2 {
                off.push(end);
            } else if self.height[end] <= self.low && room >= 1 && on.len() < count / ON_PLANE {
                let nearer = |a: &&usize, b: &&usize| along.from(end)[**a].total_cmp(&along.from(end)[**b]);
                on.extend(self.on.iter().min_by(nearer).filter(|one| !on.contains(one)));
            }
        }
        (on, off)
    }
}
