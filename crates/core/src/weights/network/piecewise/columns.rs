//! Layer 1 over a box: which of its neurons are surely on, surely off, or open. In layer 2 each of them is a column.

use super::bounds::{bounds, bounds_at, classify, Domain, MANY};
use super::lane_list::LaneList;
use crate::machine::simd::{multiversion, Lanes, WIDTH};

/// Neurons of layer 1: `w` (3 coordinates), `b`, and the bits of the number of the column.
pub(super) type Columns = LaneList<5>;

/// Open neurons of layer 1 as terms of layer 2's rows: an affine map, how far the neuron may be from it, and the bits of the number
/// of the column.
pub(super) type Relaxed = LaneList<6>;

/// What a parent's columns are in a child's box.
#[derive(Default)]
pub(super) struct Sorted {
    pub on: Columns,
    pub open: Relaxed,
}

multiversion! {
    /// Sorts the parent's columns over a box, and keeps the open ones in `child`, with the numbers that they have in the parent.
    pub(super) fn sort(
        parent: &Columns,
        domain: Domain<'_>,
        child: &mut Columns,
        sorted: &mut Sorted,
    ) = sort_body
}

#[inline(always)]
fn sort_body<L: Lanes>(parent: &Columns, domain: Domain<'_>, child: &mut Columns, sorted: &mut Sorted) {
    let Sorted { on, open } = sorted;
    on.clear(parent.len);
    open.clear(parent.len);
    child.clear(parent.len);
    let nothing = L::splat(0.0);
    let look = !domain.points.is_empty() && parent.len >= MANY;
    for first in (0..parent.len).step_by(WIDTH) {
        let column = parent.load::<L>(first);
        let [a, b, c, d, _] = column;
        let (lower, upper) = bounds([a, b, c, d], nothing, domain.region);
        let [on_bits, open_bits] = classify(lower, upper);
        let neurons = u32::MAX >> (32 - WIDTH.min(parent.len - first));
        on.append(on_bits & neurons, column);
        child.append(open_bits & neurons, column);
        if !look {
            open.append(open_bits & neurons, relaxed(column, lower, upper));
        }
    }
    if !look {
        return;
    }
    let left = std::mem::take(&mut child.len);
    for first in (0..left).step_by(WIDTH) {
        let column = child.load::<L>(first);
        let [a, b, c, d, _] = column;
        let (lower, upper) = bounds_at([a, b, c, d], nothing, domain);
        let [on_bits, open_bits] = classify(lower, upper);
        let neurons = u32::MAX >> (32 - WIDTH.min(left - first));
        on.append(on_bits & neurons, column);
        // What is written is not beyond what was loaded.
        child.append(open_bits & neurons, column);
        open.append(open_bits & neurons, relaxed(column, lower, upper));
    }
}

/// Open neurons as terms: between `lower` and `upper` relu(a) lies between slope * a and slope * a - slope * lower.
#[inline(always)]
fn relaxed<L: Lanes>([a, b, c, d, number]: [L; 5], lower: L, upper: L) -> [L; 6] {
    let slope = upper.div(upper.sub(lower));
    let spread = slope.mul(lower).mul(L::splat(-0.5));
    [a.mul(slope), b.mul(slope), c.mul(slope), d.mul_add(slope, spread), spread, number]
}
