//! What is left of the network over a box.

use std::ops::Range;

use super::bounds::lanes_of;
use super::columns::{sort, Columns, Sorted, Term};
use super::rows::{bound, splats, Rows};
use crate::simd::{multiversion, Aligned, Lanes, Simd, WIDTH};
use crate::tree::Region;

/// `o = A x + c + sum_{j open} V_j relu(w_j x + b_j) + sum_{i open} U_i relu(z_i)`.
#[derive(Default)]
pub(super) struct Part {
    /// `w_j, b_j`.
    pub columns: Columns,
    /// `z_i`.
    pub rows: Rows,
    /// `A, c`: outputs in lanes.
    pub output: Vec<[Aligned; 4]>,
    /// `V_j`: for each column all outputs, in lanes. Empty while it is all zeros.
    pub through: Vec<Aligned>,
}

/// `U`: for each row of layer 2 what it adds to all outputs, in lanes.
pub(super) struct Heads {
    /// Registers that hold all outputs.
    pub groups: usize,
    pub weights: Vec<Aligned>,
}

impl Part {
    /// Starts from what the parent left open of layer 1; its rows, of so many panels at most, are then to be [absorbed](Part::absorb).
    pub(super) fn begin(
        &mut self,
        simd: Simd,
        parent: &Part,
        region: &Region,
        sorted: &mut Sorted,
        panels: usize,
    ) {
        sort(simd, &parent.columns, region, &mut self.columns, sorted);
        self.rows.clear(self.columns.len, panels);
        self.output.clear();
        self.output.extend_from_slice(&parent.output);
        self.through.clear();
        let groups = self.output.len();
        self.through.resize(self.columns.len * groups, Aligned::ZERO);
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
        parent: &[Aligned],
        sorted: &Sorted,
        output: &mut [[Aligned; 4]],
        through: &mut [Aligned],
    ) = inherit_body
}

#[inline(always)]
fn inherit_body<L: Lanes>(
    parent: &[Aligned],
    sorted: &Sorted,
    output: &mut [[Aligned; 4]],
    through: &mut [Aligned],
) {
    let groups = output.len();
    for (through, term) in through.chunks_exact_mut(groups).zip(sorted.open()) {
        let from = &parent[term.column as usize * groups..][..groups];
        for (to, from) in through.iter_mut().zip(from) {
            *to = Aligned(L::load(&from.0).store());
        }
    }
    for (group, output) in output.iter_mut().enumerate() {
        let mut sum = [L::splat(0.0); 4];
        for term in sorted.on() {
            let weights = L::load(&parent[term.column as usize * groups + group].0);
            let map = splats::<L>(&term.map);
            for k in 0..4 {
                sum[k] = weights.mul_add(map[k], sum[k]);
            }
        }
        add(output, sum);
    }
}

#[inline(always)]
fn add<L: Lanes>(output: &mut [Aligned; 4], sum: [L; 4]) {
    for k in 0..4 {
        output[k] = Aligned(L::load(&output[k].0).add(sum[k]).store());
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
fn absorb_body<L: Lanes>(
    heads: &Heads,
    parent: &Rows,
    panels: Range<usize>,
    region: &Region,
    sorted: &Sorted,
    child: &mut Part,
) {
    let (mut p, panels) = (panels.start, panels.end);
    // Several panels at a time, so that there are more sums than an addition takes cycles: as many as there are registers for.
    while L::REGISTERS >= 32 && p + 4 <= panels {
        absorb_panels::<L, 4>(heads, parent, p, region, sorted, child);
        p += 4;
    }
    while p + 2 <= panels {
        absorb_panels::<L, 2>(heads, parent, p, region, sorted, child);
        p += 2;
    }
    if p < panels {
        absorb_panels::<L, 1>(heads, parent, p, region, sorted, child);
    }
}

#[inline(always)]
fn absorb_panels<L: Lanes, const P: usize>(
    heads: &Heads,
    parent: &Rows,
    first: usize,
    region: &Region,
    sorted: &Sorted,
    child: &mut Part,
) {
    let mut matrix = [parent.panel(first); P];
    let mut affine = [&parent.affine[first]; P];
    for p in 0..P {
        matrix[p] = parent.panel(first + p);
        affine[p] = &parent.affine[first + p];
    }
    let (on, open) = (sorted.on(), sorted.open());
    let bounded = bound::<L, P>(matrix, affine, on, open, region);
    for p in 0..P {
        let panel =
            Panel { matrix: matrix[p], affine: &bounded.affine[p], ids: &parent.ids[WIDTH * (first + p)..] };
        // The last panel may have lanes without rows.
        let rows = u32::MAX >> (32 - WIDTH.min(panel.ids.len()));
        let (on_rows, open_rows) = (bounded.on[p] & rows, bounded.open[p] & rows);
        if on_rows != 0 {
            fold::<L>(heads, &panel, on_rows, open, child);
        }
        if open_rows != 0 {
            keep::<L>(&panel, open_rows, open, &mut child.rows);
        }
    }
}

/// 16 rows of the parent.
struct Panel<'a> {
    matrix: &'a [Aligned],
    /// With the columns that are on.
    affine: &'a [Aligned; 4],
    ids: &'a [u32],
}

/// Appends some of the panel's rows, and of their columns the open ones.
#[inline(always)]
fn keep<L: Lanes>(panel: &Panel<'_>, which: u32, open: &[Term], rows: &mut Rows) {
    let place = rows.ids.len() % WIDTH;
    let (mut lanes, mut count) = ([0; WIDTH], 0);
    for lane in lanes_of(which) {
        rows.ids.push(panel.ids[lane]);
        lanes[count % WIDTH] = lane as u32;
        count += 1;
    }
    // First what fills up the last panel, then the rest in a new one.
    let filling = if place == 0 { 0 } else { count.min(WIDTH - place) };
    if filling > 0 {
        let (mut places, mut wanted) = ([0; WIDTH], [0.0; WIDTH]);
        for t in 0..filling {
            (places[place + t], wanted[place + t]) = (lanes[t], 1.0);
        }
        let places = L::places(&places);
        let wanted = L::splat(0.0).less(L::load(&wanted));
        let last = rows.panels() - 1;
        for k in 0..4 {
            let (from, to) = (&panel.affine[k], &mut rows.affine[last][k]);
            *to = Aligned(L::select(wanted, L::load(&from.0).permute(places), L::load(&to.0)).store());
        }
        for (to, term) in rows.last_panel().iter_mut().zip(open) {
            let from = &panel.matrix[term.column as usize];
            *to = Aligned(L::select(wanted, L::load(&from.0).permute(places), L::load(&to.0)).store());
        }
    }
    if filling < count {
        let mut places = [0; WIDTH];
        places[..count - filling].copy_from_slice(&lanes[filling..count]);
        let places = L::places(&places);
        let mut affine = [Aligned::ZERO; 4];
        for k in 0..4 {
            affine[k] = Aligned(L::load(&panel.affine[k].0).permute(places).store());
        }
        rows.push(affine);
        for (to, term) in rows.last_panel().iter_mut().zip(open) {
            let from = &panel.matrix[term.column as usize];
            *to = Aligned(L::load(&from.0).permute(places).store());
        }
    }
}

/// Columns of `V` that rows are added to at a time.
const COLUMNS: usize = 8;

/// Makes some of the panel's rows, which are on, part of the output.
#[inline(always)]
fn fold<L: Lanes>(heads: &Heads, panel: &Panel<'_>, which: u32, open: &[Term], child: &mut Part) {
    let groups = heads.groups;
    for group in 0..groups {
        let mut weights = [L::splat(0.0); WIDTH];
        let mut sum = [L::splat(0.0); 4];
        for (weights, lane) in weights.iter_mut().zip(lanes_of(which)) {
            *weights = L::load(&heads.weights[panel.ids[lane] as usize * groups + group].0);
            for k in 0..4 {
                sum[k] = L::splat(panel.affine[k].0[lane]).mul_add(*weights, sum[k]);
            }
        }
        add(&mut child.output[group], sum);

        let mut first = 0;
        while first < open.len() {
            // Some columns at a time; the last ones may be done twice, but are stored once.
            let mut columns = [&panel.matrix[0]; COLUMNS];
            for (c, column) in columns.iter_mut().enumerate() {
                *column = &panel.matrix[open[(first + c).min(open.len() - 1)].column as usize];
            }
            let mut sum = [L::splat(0.0); COLUMNS];
            for (weights, lane) in weights.iter().zip(lanes_of(which)) {
                for c in 0..COLUMNS {
                    let factor = L::splat(columns[c].0[lane]);
                    sum[c] = factor.mul_add(*weights, sum[c]);
                }
            }
            let through = &mut child.through;
            for c in 0..COLUMNS.min(open.len() - first) {
                let through = &mut through[(first + c) * groups + group];
                *through = Aligned(L::load(&through.0).add(sum[c]).store());
            }
            first += COLUMNS;
        }
    }
}
