//! What is left of the network over a box.

use std::ops::Range;

use super::columns::{sort, Columns, Sorted, Term};
use super::rows::{bound, Rows};
use crate::simd::{multiply_add, multiversion, Lanes, Simd, LANES};
use crate::tree::Region;

/// `o = A x + c + sum_{j open} V_j relu(w_j x + b_j) + sum_{i open} U_i relu(z_i)`.
#[derive(Default)]
pub(super) struct Part {
    /// `w_j, b_j`.
    pub columns: Columns,
    /// `z_i`.
    pub rows: Rows,
    /// `A, c`: outputs in lanes.
    pub output: Vec<[Lanes; 4]>,
    /// `V_j`: for each column all outputs, in lanes. Empty while it is all zeros.
    pub through: Vec<Lanes>,
}

/// `U`: for each row of layer 2 what it adds to all outputs, in lanes.
pub(super) struct Heads {
    pub outputs: usize,
    /// Registers that hold all outputs.
    pub groups: usize,
    pub weights: Vec<Lanes>,
}

impl Part {
    /// Starts from what the parent left open of layer 1; its rows are then to be [absorbed](Part::absorb).
    pub(super) fn begin(&mut self, simd: Simd, parent: &Part, region: &Region, sorted: &mut Sorted) {
        sort(simd, &parent.columns, region, &mut self.columns, sorted);
        self.rows.clear();
        self.output.clear();
        self.output.extend_from_slice(&parent.output);
        self.through.clear();
        let groups = self.output.len();
        self.through.resize(self.columns.len * groups, Lanes::ZERO);
        if !parent.through.is_empty() {
            inherit(simd, &parent.through, sorted, &mut self.output, &mut self.through);
        }
    }

    /// Takes over those panels of the parent's rows: those that are on become part of the output, open ones stay.
    pub(super) fn absorb(
        &mut self,
        simd: Simd,
        heads: &Heads,
        parent: &Rows,
        panels: Range<usize>,
        region: &Region,
        sorted: &Sorted,
    ) {
        absorb(simd, heads, parent, panels, region, sorted, self);
    }
}

multiversion! {
    /// `V` of the open columns is kept, of those that are on it becomes part of the affine map.
    fn inherit(
        parent: &[Lanes],
        sorted: &Sorted,
        output: &mut [[Lanes; 4]],
        through: &mut [Lanes],
    ) = inherit_body
}

#[inline(always)]
fn inherit_body<const FMA: bool>(
    parent: &[Lanes],
    sorted: &Sorted,
    output: &mut [[Lanes; 4]],
    through: &mut [Lanes],
) {
    let groups = output.len();
    for (through, term) in through.chunks_exact_mut(groups).zip(sorted.open()) {
        through.copy_from_slice(&parent[term.column as usize * groups..][..groups]);
    }
    for (group, output) in output.iter_mut().enumerate() {
        let mut sum = [Lanes::ZERO; 4];
        for term in sorted.on() {
            let weights = &parent[term.column as usize * groups + group];
            for k in 0..4 {
                for t in 0..LANES {
                    sum[k].0[t] = multiply_add::<FMA>(weights.0[t], term.map[k], sum[k].0[t]);
                }
            }
        }
        add(output, &sum);
    }
}

#[inline(always)]
fn add(output: &mut [Lanes; 4], sum: &[Lanes; 4]) {
    for k in 0..4 {
        for t in 0..LANES {
            output[k].0[t] += sum[k].0[t];
        }
    }
}

multiversion! {
    fn absorb(
        heads: &Heads,
        parent: &Rows,
        panels: Range<usize>,
        region: &Region,
        sorted: &Sorted,
        child: &mut Part,
    ) = absorb_body
}

#[inline(always)]
fn absorb_body<const FMA: bool>(
    heads: &Heads,
    parent: &Rows,
    panels: Range<usize>,
    region: &Region,
    sorted: &Sorted,
    child: &mut Part,
) {
    let columns = parent.matrix.len() / parent.affine.len().max(1);
    let panel = |p: usize| &parent.matrix[p * columns..(p + 1) * columns];
    let (on, open) = (sorted.on(), sorted.open());
    let mut p = panels.start;
    while p + 1 < panels.end {
        let matrix = [panel(p), panel(p + 1)];
        let bounded = bound::<FMA, 2>(matrix, [parent.affine[p], parent.affine[p + 1]], on, open, region);
        for q in 0..2 {
            let ids = &parent.ids[LANES * (p + q)..];
            let bounds = [&bounded.lower[q], &bounded.upper[q]];
            keep::<FMA>(heads, matrix[q], &bounded.affine[q], bounds, ids, open, child);
        }
        p += 2;
    }
    if p < panels.end {
        let matrix = panel(p);
        let bounded = bound::<FMA, 1>([matrix], [parent.affine[p]], on, open, region);
        let ids = &parent.ids[LANES * p..];
        let bounds = [&bounded.lower[0], &bounded.upper[0]];
        keep::<FMA>(heads, matrix, &bounded.affine[0], bounds, ids, open, child);
    }
}

/// Sorts the rows of one panel by their bounds.
#[inline(always)]
fn keep<const FMA: bool>(
    heads: &Heads,
    matrix: &[Lanes],
    affine: &[Lanes; 4],
    bounds: [&Lanes; 2],
    ids: &[u32],
    open: &[Term],
    child: &mut Part,
) {
    let (mut on_lanes, mut open_lanes) = ([0u8; LANES], [0u8; LANES]);
    let (mut on_count, mut open_count) = (0, 0);
    // Rows that only fill up the last panel have both bounds 0, which is off.
    for t in 0..LANES {
        let (is_off, is_on) = (bounds[1].0[t] <= 0.0, bounds[0].0[t] >= 0.0);
        on_lanes[on_count & 15] = t as u8;
        on_count += usize::from(is_on & !is_off);
        open_lanes[open_count & 15] = t as u8;
        open_count += usize::from(!is_on & !is_off);
    }
    if on_count > 0 {
        fold::<FMA>(heads, matrix, affine, &on_lanes[..on_count], ids, open, child);
    }
    // The panel that is being filled, then the next one.
    let mut lanes = &open_lanes[..open_count];
    while !lanes.is_empty() {
        let place = child.rows.len % LANES;
        let (now, later) = lanes.split_at(lanes.len().min(LANES - place));
        for &lane in now {
            child.rows.push(affine, lane as usize, ids[lane as usize], open.len());
        }
        let first = child.rows.matrix.len() - open.len();
        for (out, term) in child.rows.matrix[first..].iter_mut().zip(open) {
            let weights = &matrix[term.column as usize];
            for (out, &lane) in out.0[place..].iter_mut().zip(now) {
                *out = weights.0[(lane & 15) as usize];
            }
        }
        lanes = later;
    }
}

/// Makes rows that are on part of the output.
#[inline(always)]
fn fold<const FMA: bool>(
    heads: &Heads,
    matrix: &[Lanes],
    affine: &[Lanes; 4],
    lanes: &[u8],
    ids: &[u32],
    open: &[Term],
    child: &mut Part,
) {
    let groups = heads.groups;
    for group in 0..groups {
        let mut weights = [Lanes::ZERO; LANES];
        for (weights, &lane) in weights.iter_mut().zip(lanes) {
            *weights = heads.weights[ids[lane as usize] as usize * groups + group];
        }
        let mut sum = [Lanes::ZERO; 4];
        for (weights, &lane) in weights.iter().zip(lanes) {
            for k in 0..4 {
                let factor = affine[k].0[(lane & 15) as usize];
                for t in 0..LANES {
                    sum[k].0[t] = multiply_add::<FMA>(factor, weights.0[t], sum[k].0[t]);
                }
            }
        }
        add(&mut child.output[group], &sum);

        let through = |j: usize| j * groups + group;
        let mut j = 0;
        while j + 4 <= open.len() {
            let columns: [&Lanes; 4] = std::array::from_fn(|c| &matrix[open[j + c].column as usize]);
            let mut sum: [Lanes; 4] = std::array::from_fn(|c| child.through[through(j + c)]);
            for (weights, &lane) in weights.iter().zip(lanes) {
                for c in 0..4 {
                    let factor = columns[c].0[(lane & 15) as usize];
                    for t in 0..LANES {
                        sum[c].0[t] = multiply_add::<FMA>(factor, weights.0[t], sum[c].0[t]);
                    }
                }
            }
            for c in 0..4 {
                child.through[through(j + c)] = sum[c];
            }
            j += 4;
        }
        for (j, term) in open.iter().enumerate().skip(j) {
            let column = &matrix[term.column as usize];
            let mut sum = child.through[through(j)];
            for (weights, &lane) in weights.iter().zip(lanes) {
                let factor = column.0[(lane & 15) as usize];
                for t in 0..LANES {
                    sum.0[t] = multiply_add::<FMA>(factor, weights.0[t], sum.0[t]);
                }
            }
            child.through[through(j)] = sum;
        }
    }
}
