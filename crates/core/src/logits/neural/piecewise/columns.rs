//! Layer 1 over a box: which of its neurons are surely on, surely off, or open. In layer 2 each of them is a column.

use super::SLACK;
use crate::simd::{multiply_add, multiversion, Lanes, LANES};
use crate::tree::Region;

/// Neurons of layer 1, 16 at a time: `w` (3 coordinates) and `b`.
#[derive(Default)]
pub(super) struct Columns {
    pub len: usize,
    pub planes: Vec<[Lanes; 4]>,
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
fn sort_body<const FMA: bool>(parent: &Columns, region: &Region, child: &mut Columns, sorted: &mut Sorted) {
    // One more than can be needed, because a column is written before it is known whether it counts.
    for terms in [&mut sorted.on, &mut sorted.open] {
        if terms.len() <= parent.len {
            terms.resize(parent.len + 1, NO_TERM);
        }
    }
    child.planes.clear();
    let [mut on, mut open] = [0, 0];
    for (chunk, planes) in parent.planes.iter().enumerate() {
        let [x, y, z, b] = planes;
        let (mut lower, mut upper) = (Lanes::ZERO, Lanes::ZERO);
        let (mut slope, mut spread) = (Lanes::ZERO, Lanes::ZERO);
        for t in 0..LANES {
            let terms: [f32; 3] = std::array::from_fn(|k| planes[k].0[t] * region.centre[k]);
            let middle = terms[0] + terms[1] + terms[2] + b.0[t];
            let mut half = x.0[t].abs() * region.half[0];
            half = multiply_add::<FMA>(y.0[t].abs(), region.half[1], half);
            half = multiply_add::<FMA>(z.0[t].abs(), region.half[2], half);
            let size = terms[0].abs() + terms[1].abs() + terms[2].abs() + b.0[t].abs() + half;
            half = multiply_add::<FMA>(SLACK, size, half);
            lower.0[t] = middle - half;
            upper.0[t] = middle + half;
            // Between lower and upper relu(a) lies between slope * a and slope * a - slope * lower.
            slope.0[t] = upper.0[t] / (upper.0[t] - lower.0[t]);
            spread.0[t] = -0.5 * slope.0[t] * lower.0[t];
        }
        for t in 0..LANES.min(parent.len - LANES * chunk) {
            let (is_off, is_on) = (upper.0[t] <= 0.0, lower.0[t] >= 0.0);
            let row = [x.0[t], y.0[t], z.0[t], b.0[t]];
            let column = (LANES * chunk + t) as u32;
            sorted.on[on] = Term { map: row, spread: 0.0, column };
            on += usize::from(is_on & !is_off);
            let mut map = row.map(|v| v * slope.0[t]);
            map[3] += spread.0[t];
            sorted.open[open] = Term { map, spread: spread.0[t], column };
            if open == LANES * child.planes.len() {
                child.planes.push([Lanes::ZERO; 4]);
            }
            let last = child.planes.last_mut().expect("pushed above");
            for k in 0..4 {
                last[k].0[open % LANES] = row[k];
            }
            open += usize::from(!is_on & !is_off);
        }
    }
    sorted.counts = [on, open];
    child.len = open;
}
