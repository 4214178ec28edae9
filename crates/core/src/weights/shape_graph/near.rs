//! Nearest neighbours in double precision: a kd-tree over positions, whose answers are ordered by distance and then by number, so that
//! they depend on nothing but the positions. Bentley, "Multidimensional binary search trees used for associative searching", 1975.

use super::{squared, Position};

/// Positions a leaf.
const LEAF: usize = 8;

/// The tree: the median of a range of `order` is its node, in the middle of it.
pub(crate) struct Near {
    order: Vec<u32>,
    positions: Vec<Position>,
    /// The side across which the range around each place is split.
    axes: Vec<u8>,
}

/// A square of a distance, and whose it is.
pub(crate) type Found = (f64, u32);

impl Near {
    pub(crate) fn new(positions: &[Position]) -> Near {
        let mut order: Vec<u32> = (0..positions.len() as u32).collect();
        let mut axes = vec![0; positions.len()];
        split(positions, &mut order, &mut axes);
        let positions = order.iter().map(|&index| positions[index as usize]).collect();
        Near { order, positions, axes }
    }

    /// The at most `count` nearest to `x` whose square of the distance is below `bound` and that are `wanted`, into `found`.
    pub(crate) fn nearest(
        &self,
        x: &Position,
        count: usize,
        bound: f64,
        wanted: impl Fn(u32) -> bool,
        found: &mut Vec<Found>,
    ) {
        found.clear();
        if count > 0 {
            self.within(0..self.order.len(), x, count, bound, &wanted, found);
        }
    }

    fn within(
        &self,
        range: std::ops::Range<usize>,
        x: &Position,
        count: usize,
        bound: f64,
        wanted: &impl Fn(u32) -> bool,
        found: &mut Vec<Found>,
    ) {
        if range.len() <= LEAF {
            return range.for_each(|place| self.look(place, x, count, bound, wanted, found));
        }
        let middle = range.start + range.len() / 2;
        let axis = usize::from(self.axes[middle]);
        let beside = x[axis] - self.positions[middle][axis];
        let (left, right) = (range.start..middle, middle + 1..range.end);
        let (first, second) = if beside < 0.0 { (left, right) } else { (right, left) };
        self.within(first, x, count, bound, wanted, found);
        // Of equals the smaller number counts, so that a side that is as far is looked at.
        let farthest = if found.len() < count { bound } else { found[count - 1].0 };
        if beside * beside <= farthest {
            self.look(middle, x, count, bound, wanted, found);
            self.within(second, x, count, bound, wanted, found);
        }
    }

    fn look(
        &self,
        place: usize,
        x: &Position,
        count: usize,
        bound: f64,
        wanted: &impl Fn(u32) -> bool,
        found: &mut Vec<Found>,
    ) {
        let this = (squared(x, &self.positions[place]), self.order[place]);
        if this.0 >= bound || found.len() == count && this >= found[count - 1] || !wanted(this.1) {
            return;
        }
        let at = found.partition_point(|other| *other < this);
        found.truncate(count - 1);
        found.insert(at, this);
    }
}

fn split(positions: &[Position], order: &mut [u32], axes: &mut [u8]) {
    if order.len() <= LEAF {
        return;
    }
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for &index in order.iter() {
        for (k, c) in positions[index as usize].iter().enumerate() {
            (low[k], high[k]) = (low[k].min(*c), high[k].max(*c));
        }
    }
    let longer = |a: usize, b: usize| if high[b] - low[b] > high[a] - low[a] { b } else { a };
    let axis = longer(longer(0, 1), 2);
    let middle = order.len() / 2;
    let at = |index: u32| positions[index as usize][axis];
    order.select_nth_unstable_by(middle, |&a, &b| at(a).total_cmp(&at(b)));
    axes[middle] = axis as u8;
    let (left, right) = order.split_at_mut(middle);
    let (left_axes, right_axes) = axes.split_at_mut(middle);
    split(positions, left, left_axes);
    split(positions, &mut right[1..], &mut right_axes[1..]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::random::Random;

    #[test]
    fn finds_what_looking_at_all_finds_and_of_equals_the_smaller_number() {
        let mut random = Random::new(3);
        // On a grid, where many are as far as each other.
        let positions: Vec<Position> =
            (0..500).map(|_| std::array::from_fn(|_| (8.0 * random.unit()).floor())).collect();
        let tree = Near::new(&positions);
        let mut found = Vec::new();
        for x in &positions[..50] {
            for (count, bound) in [(1, f64::INFINITY), (16, 9.0), (64, 4.0), (600, f64::INFINITY)] {
                let wanted = |index: u32| index % 3 != 1;
                let all = positions.iter().enumerate().map(|(i, y)| (squared(x, y), i as u32));
                let mut naive: Vec<Found> =
                    all.filter(|&(far, index)| far < bound && wanted(index)).collect();
                naive.sort_by(|a, b| a.partial_cmp(b).unwrap());
                naive.truncate(count);
                tree.nearest(x, count, bound, wanted, &mut found);
                assert_eq!(found, naive, "{count} below {bound}");
            }
        }
    }
}
