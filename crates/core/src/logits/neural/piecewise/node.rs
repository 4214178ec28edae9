//! What is left of the network over a box.

use std::ops::Range;

use super::columns::{sort, Columns, Sorted, Term};
use super::rows::{bound, Rows};
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
    pub outputs: usize,
    /// Registers that hold all outputs.
    pub groups: usize,
    pub weights: Vec<Aligned>,
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
        through.copy_from_slice(&parent[term.column as usize * groups..][..groups]);
    }
    for (group, output) in output.iter_mut().enumerate() {
        let mut sum = [L::splat(0.0); 4];
        for term in sorted.on() {
            let weights = L::load(&parent[term.column as usize * groups + group].0);
            for k in 0..4 {
                sum[k] = weights.mul_add(L::splat(term.map[k]), sum[k]);
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
    let mut p = panels.start;
    // Two panels at a time, so that there are more sums than an addition takes cycles.
    while p + 1 < panels.end {
        absorb_panels::<L, 2>(heads, parent, p, region, sorted, child);
        p += 2;
    }
    if p < panels.end {
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
    let columns = parent.matrix.len() / parent.affine.len();
    let mut matrix = [&parent.matrix[..0]; P];
    let mut affine = [&parent.affine[first]; P];
    for p in 0..P {
        matrix[p] = &parent.matrix[(first + p) * columns..(first + p + 1) * columns];
        affine[p] = &parent.affine[first + p];
    }
    let (on, open) = (sorted.on(), sorted.open());
    let bounded = bound::<L, P>(matrix, affine, on, open, region);
    for p in 0..P {
        let panel =
            Panel { matrix: matrix[p], affine: &bounded.affine[p], ids: &parent.ids[WIDTH * (first + p)..] };
        // Rows that only fill up the last panel have both bounds 0, which is off.
        let (mut on_lanes, mut open_lanes) = ([0u32; WIDTH], [0u32; WIDTH]);
        let (mut on_count, mut open_count) = (0, 0);
        for t in 0..WIDTH {
            let (is_off, is_on) = (bounded.upper[p][t] <= 0.0, bounded.lower[p][t] >= 0.0);
            on_lanes[on_count % WIDTH] = t as u32;
            on_count += usize::from(is_on & !is_off);
            open_lanes[open_count % WIDTH] = t as u32;
            open_count += usize::from(!is_on & !is_off);
        }
        if on_count > 0 {
            fold::<L>(heads, &panel, &on_lanes[..on_count], open, child);
        }
        if open_count > 0 {
            keep::<L>(&panel, &open_lanes, open_count, open, &mut child.rows);
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

/// Appends the rows in `count` of the panel's lanes, and of their columns the open ones.
#[inline(always)]
fn keep<L: Lanes>(panel: &Panel<'_>, lanes: &[u32; WIDTH], count: usize, open: &[Term], rows: &mut Rows) {
    let place = rows.len % WIDTH;
    rows.ids.extend(lanes[..count].iter().map(|lane| panel.ids[*lane as usize]));
    rows.len += count;
    // First what fills up the last panel, then the rest in a new one.
    let mut done = 0;
    while done < count {
        let at = if done == 0 { place } else { 0 };
        if at == 0 {
            rows.affine.push([Aligned::ZERO; 4]);
            rows.matrix.resize(rows.matrix.len() + open.len(), Aligned::ZERO);
        }
        let taken = (count - done).min(WIDTH - at);
        let mut places = [0; WIDTH];
        let mut wanted = [0.0; WIDTH];
        for t in 0..taken {
            places[at + t] = lanes[done + t];
            wanted[at + t] = 1.0;
        }
        let places = L::places(&places);
        let wanted = L::splat(0.0).less(L::load(&wanted));
        let select = |from: &Aligned, to: &mut Aligned| {
            let chosen = L::load(&from.0).permute(places);
            *to = Aligned(L::select(wanted, chosen, L::load(&to.0)).store());
        };
        let last = rows.affine.last_mut().expect("pushed before");
        for k in 0..4 {
            select(&panel.affine[k], &mut last[k]);
        }
        let first = rows.matrix.len() - open.len();
        for (to, term) in rows.matrix[first..].iter_mut().zip(open) {
            select(&panel.matrix[term.column as usize], to);
        }
        done += taken;
    }
}

/// Makes the rows in some of the panel's lanes, which are on, part of the output.
#[inline(always)]
fn fold<L: Lanes>(heads: &Heads, panel: &Panel<'_>, lanes: &[u32], open: &[Term], child: &mut Part) {
    let groups = heads.groups;
    let lane = |lane: &u32| *lane as usize % WIDTH;
    for group in 0..groups {
        let weights = |lane: usize| L::load(&heads.weights[panel.ids[lane] as usize * groups + group].0);
        let mut sum = [L::splat(0.0); 4];
        for lane in lanes.iter().map(lane) {
            let weights = weights(lane);
            for k in 0..4 {
                sum[k] = L::splat(panel.affine[k].0[lane]).mul_add(weights, sum[k]);
            }
        }
        add(&mut child.output[group], sum);

        let mut first = 0;
        while first < open.len() {
            // Four columns at a time; the last ones may be done twice, but are stored once.
            let columns = [0, 1, 2, 3].map(|c| open[(first + c).min(open.len() - 1)].column as usize);
            let mut sum = [L::splat(0.0); 4];
            for lane in lanes.iter().map(lane) {
                let weights = weights(lane);
                for c in 0..4 {
                    let factor = L::splat(panel.matrix[columns[c]].0[lane]);
                    sum[c] = factor.mul_add(weights, sum[c]);
                }
            }
            for (c, sum) in sum.into_iter().enumerate().take(open.len() - first) {
                let through = &mut child.through[(first + c) * groups + group];
                *through = Aligned(L::load(&through.0).add(sum).store());
            }
            first += 4;
        }
    }
}
