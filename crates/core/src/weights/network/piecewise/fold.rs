//! Neurons that are on become part of the output's affine map.

use super::columns::Sorted;
use super::part::{Heads, Part};
use super::rows::{loads, stores, Bounded, COLUMNS};
use crate::machine::simd::{multiversion, Aligned, Lanes, WIDTH};

multiversion! {
    /// The parent's output: `V` of the open columns is kept, of those that are on it becomes part of the affine map.
    pub(super) fn inherit(parent: &Part, sorted: &Sorted, child: &mut Part) = inherit_body
}

#[inline(always)]
fn inherit_body<L: Lanes>(parent: &Part, sorted: &Sorted, child: &mut Part) {
    let (groups, columns) = (parent.output.len(), sorted.open.len);
    child.output.clear();
    child.output.extend_from_slice(&parent.output);
    let through = &mut child.through;
    through.resize(through.len().max(columns * groups), Aligned::ZERO);
    let through = &mut through[..columns * groups];
    if parent.through.is_empty() {
        through.fill(Aligned::ZERO);
        return;
    }
    for (through, column) in through.chunks_exact_mut(groups).zip(sorted.open.plane(5)) {
        let from = &parent.through[column.to_bits() as usize * groups..][..groups];
        for (to, from) in through.iter_mut().zip(from) {
            *to = Aligned(L::load(&from.0).store());
        }
    }
    for (group, output) in child.output.iter_mut().enumerate() {
        let mut sum = [L::splat(0.0); 4];
        for (t, column) in sorted.on.plane(4).iter().enumerate() {
            let weights = L::load(&parent.through[column.to_bits() as usize * groups + group].0);
            for k in 0..4 {
                sum[k] = weights.mul_add(L::splat(sorted.on.plane(k)[t]), sum[k]);
            }
        }
        add_to::<L>(output, sum);
    }
}

/// Adds what was summed apart. Summed onto the output one by one, hundreds of rows would each round to its size: the logits of a place
/// would differ by 1e-5 between one box and another, in which other rows are on.
#[inline(always)]
fn add_to<L: Lanes>(output: &mut [Aligned; 4], sum: [L; 4]) {
    let mut whole = loads::<L>(output);
    for k in 0..4 {
        whole[k] = whole[k].add(sum[k]);
    }
    *output = stores(whole);
}

multiversion! {
    /// Adds what rows that are on give: their affine parts to `output`, the weights of their `open` columns to `through`.
    pub(super) fn fold(
        heads: &Heads,
        bounded: &Bounded,
        open: usize,
        output: &mut [[Aligned; 4]],
        through: &mut [Aligned],
    ) = fold_body
}

#[inline(always)]
fn fold_body<L: Lanes>(
    heads: &Heads,
    bounded: &Bounded,
    open: usize,
    output: &mut [[Aligned; 4]],
    through: &mut [Aligned],
) {
    if bounded.on.is_empty() {
        return;
    }
    let groups = heads.groups;
    for (group, output) in output.iter_mut().enumerate() {
        let weights = |id: u32| L::load(&heads.weights[id as usize * groups + group].0);
        let mut sum = [L::splat(0.0); 4];
        for row in &bounded.on {
            let weights = weights(row.id);
            let affine = &bounded.affine[row.panel as usize];
            for k in 0..4 {
                sum[k] = L::splat(affine[k].0[row.lane as usize % WIDTH]).mul_add(weights, sum[k]);
            }
        }
        add_to::<L>(output, sum);

        for first in (0..open).step_by(COLUMNS) {
            let mut sum = [L::splat(0.0); COLUMNS];
            for row in &bounded.on {
                let (weights, panel) =
                    (weights(row.id), &bounded.panel(row.panel as usize)[first..][..COLUMNS]);
                for c in 0..COLUMNS {
                    let number = panel[c].0[row.lane as usize % WIDTH];
                    sum[c] = L::splat(number).mul_add(weights, sum[c]);
                }
            }
            for c in 0..COLUMNS.min(open - first) {
                let through = &mut through[(first + c) * groups + group];
                *through = Aligned(L::load(&through.0).add(sum[c]).store());
            }
        }
    }
}
