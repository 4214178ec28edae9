//! What an affine map can be over a box, or at the points in it.

use crate::geometry::{Point, Region};
use crate::machine::simd::{Lanes, WIDTH};

/// Where a map is bounded.
#[derive(Clone, Copy)]
pub(super) struct Domain<'a> {
    pub region: &'a Region,
    /// All points in it that there are, if it is worth looking at each; else none.
    pub points: &'a [Point],
}

/// With fewer columns, one more of them or of the rows costs less than looking at each point.
pub(super) const MANY: usize = 64;

/// Bounds are widened by this much of the magnitudes that they were computed from, so that they hold in spite of rounding,
/// however far away the box is. A neuron that is nearer to zero adds but rounding, on whichever side it is taken to be.
const SLACK: f32 = 2e-6;

/// The least and the most that `map (x, 1) +- spread` can be over the box.
#[inline(always)]
pub(super) fn bounds<L: Lanes>(map: [L; 4], spread: L, region: &Region) -> (L, L) {
    let (mut middle, mut half, mut size) = (map[3], spread, map[3].abs());
    for k in 0..3 {
        let term = map[k].mul(L::splat(region.centre[k]));
        middle = middle.add(term);
        size = size.add(term.abs());
        half = map[k].abs().mul_add(L::splat(region.half[k]), half);
    }
    half = size.add(half).mul_add(L::splat(SLACK), half);
    (middle.sub(half), middle.add(half))
}

/// The least and the most that `map (x, 1) +- spread` can be at the points of a domain.
#[inline(always)]
pub(super) fn bounds_at<L: Lanes>(map: [L; 4], spread: L, domain: Domain<'_>) -> (L, L) {
    let Domain { region, points } = domain;
    let mut size = map[3].abs().add(spread);
    for k in 0..3 {
        size = map[k].abs().mul_add(L::splat(region.centre[k].abs() + region.half[k]), size);
    }
    // The sums of two points at a time, so that none waits for the one before.
    let nothing = L::splat(0.0);
    let mut most = [L::splat(f32::NEG_INFINITY); 2];
    let mut least = most;
    for pair in points.chunks(2) {
        for (i, x) in [pair[0], pair[pair.len() - 1]].into_iter().enumerate() {
            let value = L::splat(x[0]).mul_add(map[0], map[3]);
            let value = L::splat(x[1]).mul_add(map[1], value);
            let value = L::splat(x[2]).mul_add(map[2], value);
            most[i] = value.max(most[i]);
            least[i] = nothing.sub(value).max(least[i]);
        }
    }
    let half = size.mul_add(L::splat(SLACK), spread);
    (nothing.sub(least[0].max(least[1]).add(half)), most[0].max(most[1]).add(half))
}

/// Which lanes are surely on, and which may be on or off; the others are surely off. A lane without bounds may be either.
#[inline(always)]
pub(super) fn classify<L: Lanes>(lower: L, upper: L) -> [u32; 2] {
    let off = L::bits(upper.less(L::splat(f32::MIN_POSITIVE)));
    let on = L::bits(L::splat(-f32::MIN_POSITIVE).less(lower)) & !off;
    [on, !(on | off) & ((1 << WIDTH) - 1)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::random::Random;
    use crate::machine::simd::Portable;

    #[test]
    fn points_bound_a_map_more_closely_than_their_box_and_leave_none_of_them_out() {
        let region = Region { centre: [0.5, -1.0, 2.0], half: [0.5, 1.0, 0.1] };
        let mut random = Random::new(1);
        let mut numbers = |count: usize| random.layer(1, count).weight;
        for count in [1, 2, 7, 64] {
            let inside = |k: usize, t: f32| region.centre[k] + region.half[k] * t.clamp(-1.0, 1.0);
            let points: Vec<Point> = numbers(3 * count)
                .chunks(3)
                .map(|t| [inside(0, t[0]), inside(1, t[1]), inside(2, t[2]), f32::NAN])
                .collect();
            let map = [0; 4].map(|_| Portable::load(numbers(WIDTH).first_chunk().unwrap()));
            let spread = 0.25;
            let domain = Domain { region: &region, points: &points };
            let (lower, upper) = bounds_at(map, Portable::splat(spread), domain);
            let (least, most) = bounds(map, Portable::splat(spread), &region);
            for lane in 0..WIDTH {
                let map = map.map(|plane| f64::from(plane.store()[lane]));
                let values: Vec<f64> = points
                    .iter()
                    .map(|x| map[3] + (0..3).map(|k| map[k] * f64::from(x[k])).sum::<f64>())
                    .collect();
                let smallest = values.iter().copied().fold(f64::INFINITY, f64::min) - f64::from(spread);
                let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max) + f64::from(spread);
                let [lower, upper] = [lower, upper].map(|bound| f64::from(bound.store()[lane]));
                assert!(lower <= smallest && smallest < lower + 1e-4, "{lower} {smallest}");
                assert!(upper >= largest && largest > upper - 1e-4, "{upper} {largest}");
                assert!(lower >= f64::from(least.store()[lane]) - 1e-4);
                assert!(upper <= f64::from(most.store()[lane]) + 1e-4);
            }
        }
    }
}
