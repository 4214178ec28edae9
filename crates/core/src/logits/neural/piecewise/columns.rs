//! Layer 1 over a box: which of its neurons are surely on, surely off, or open. In layer 2 each of them is a column.

use super::bounds::{bounds, classify, lanes_of};
use super::rows::loads;
use crate::simd::{multiversion, Aligned, Lanes, WIDTH};
use crate::tree::Region;

/// Neurons of layer 1, 16 at a time: `w` (3 coordinates) and `b`.
#[derive(Default)]
pub(super) struct Columns {
    pub len: usize,
    pub planes: Vec<[Aligned; 4]>,
}

/// A neuron of layer 1 that is on or open in a box, as a term of layer 2's rows.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct Term {
    /// An affine map that the neuron equals where it is on, and differs from by at most `spread` where it is open.
    pub map: [f32; 4],
    pub spread: f32,
    /// The column among those of the parent.
    pub column: u32,
}

const NO_TERM: Term = Term { map: [0.0; 4], spread: 0.0, column: 0 };

/// What a parent's columns are in a child's box.
#[derive(Default)]
pub(super) struct Sorted {
    on: Vec<Term>,
    open: Vec<Term>,
    counts: [usize; 2],
}

impl Sorted {
    pub(super) fn on(&self) -> &[Term] {
        &self.on[..self.counts[0]]
    }

    pub(super) fn open(&self) -> &[Term] {
        &self.open[..self.counts[1]]
    }
}

multiversion! {
    /// Sorts the parent's columns over a box, and keeps the open ones in `child`.
    pub(super) fn sort(parent: &Columns, region: &Region, child: &mut Columns, sorted: &mut Sorted) = sort_body
}

#[inline(always)]
fn sort_body<L: Lanes>(parent: &Columns, region: &Region, child: &mut Columns, sorted: &mut Sorted) {
    for terms in [&mut sorted.on, &mut sorted.open] {
        terms.resize(terms.len().max(parent.len), NO_TERM);
    }
    child.planes.clear();
    let [mut on, mut open] = [0, 0];
    for (chunk, planes) in parent.planes.iter().enumerate() {
        let map = loads::<L>(planes);
        let (lower, upper) = bounds(map, L::splat(0.0), region);
        // Between lower and upper relu(a) lies between slope * a and slope * a - slope * lower.
        let slope = upper.div(upper.sub(lower));
        let spread = slope.mul(lower).mul(L::splat(-0.5));
        let [on_lanes, open_lanes] = classify(lower, upper);
        // The last planes may have lanes without neurons.
        let neurons = u32::MAX >> (32 - WIDTH.min(parent.len - WIDTH * chunk));
        let row = |t: usize| [planes[0].0[t], planes[1].0[t], planes[2].0[t], planes[3].0[t]];
        for t in lanes_of(on_lanes & neurons) {
            sorted.on[on] = Term { map: row(t), spread: 0.0, column: (WIDTH * chunk + t) as u32 };
            on += 1;
        }
        let (slope, spread) = (slope.store(), spread.store());
        for t in lanes_of(open_lanes & neurons) {
            let (row, s) = (row(t), slope[t]);
            let map = [row[0] * s, row[1] * s, row[2] * s, row[3] * s + spread[t]];
            sorted.open[open] = Term { map, spread: spread[t], column: (WIDTH * chunk + t) as u32 };
            if open % WIDTH == 0 {
                child.planes.push([Aligned::ZERO; 4]);
            }
            let last = child.planes.last_mut().expect("pushed above");
            for k in 0..4 {
                last[k].0[open % WIDTH] = row[k];
            }
            open += 1;
        }
    }
    sorted.counts = [on, open];
    child.len = open;
}
