//! Neurons that are on become part of the output's affine map.

use super::columns::{Sorted, Term};
use super::node::{Heads, Part};
use super::rows::{loads, splats, stores, Block, Bounded};
use crate::simd::{multiversion, Aligned, Lanes, WIDTH};

multiversion! {
    /// The parent's output: `V` of the open columns is kept, of those that are on it becomes part of the affine map.
    pub(super) fn inherit(parent: &Part, sorted: &Sorted, child: &mut Part) = inherit_body
}

#[inline(always)]
fn inherit_body<L: Lanes>(parent: &Part, sorted: &Sorted, child: &mut Part) {
    let (groups, columns) = (parent.output.len(), sorted.open().len());
    child.output.clear();
    child.output.extend_from_slice(&parent.output);
    let through = &mut child.through;
    through.resize(through.len().max(columns * groups), Aligned::ZERO);
    let through = &mut through[..columns * groups];
    if parent.through.is_empty() {
        through.fill(Aligned::ZERO);
        return;
    }
    for (through, term) in through.chunks_exact_mut(groups).zip(sorted.open()) {
        let from = &parent.through[term.column as usize * groups..][..groups];
        for (to, from) in through.iter_mut().zip(from) {
            *to = Aligned(L::load(&from.0).store());
        }
    }
    for (group, output) in child.output.iter_mut().enumerate() {
        let mut sum = loads::<L>(output);
        for term in sorted.on() {
            let weights = L::load(&parent.through[term.column as usize * groups + group].0);
            let map = splats::<L>(&term.map);
            for k in 0..4 {
                sum[k] = weights.mul_add(map[k], sum[k]);
            }
        }
        *output = stores(sum);
    }
}

multiversion! {
    /// Adds what the block's rows that are on give: their affine parts to `output`, their open columns' weights to `through`.
    pub(super) fn fold(
        heads: &Heads,
        block: Block<'_>,
        bounded: &Bounded,
        open: &[Term],
        output: &mut [[Aligned; 4]],
        through: &mut [Aligned],
    ) = fold_body
}

/// Columns of `V` that rows are added to at a time.
const COLUMNS: usize = 8;

#[inline(always)]
fn fold_body<L: Lanes>(
    heads: &Heads,
    block: Block<'_>,
    bounded: &Bounded,
    open: &[Term],
    output: &mut [[Aligned; 4]],
    through: &mut [Aligned],
) {
    if bounded.on.is_empty() {
        return;
    }
    let groups = heads.groups;
    assert!(open.iter().all(|term| (term.column as usize) < block.columns));
    for (group, output) in output.iter_mut().enumerate() {
        let weights = |id: u32| L::load(&heads.weights[id as usize * groups + group].0);
        let mut sum = loads::<L>(output);
        for row in &bounded.on {
            let weights = weights(row.id);
            let affine = &bounded.affine[row.panel as usize];
            for k in 0..4 {
                sum[k] = L::splat(affine[k].0[row.lane as usize % WIDTH]).mul_add(weights, sum[k]);
            }
        }
        *output = stores(sum);

        for (index, open) in open.chunks(COLUMNS).enumerate() {
            // The last columns may be done twice, but are stored once.
            let mut columns = [0; COLUMNS];
            for c in 0..COLUMNS {
                columns[c] = open[c.min(open.len() - 1)].column as usize;
            }
            let mut sum = [L::splat(0.0); COLUMNS];
            for row in &bounded.on {
                let (weights, panel) = (weights(row.id), block.panel(row.panel as usize));
                for c in 0..COLUMNS {
                    // SAFETY: a panel has all of the block's columns, and those of `open` are among them, as asserted.
                    let number = unsafe { panel.get_unchecked(columns[c]) }.0[row.lane as usize % WIDTH];
                    sum[c] = L::splat(number).mul_add(weights, sum[c]);
                }
            }
            for c in 0..open.len() {
                let through = &mut through[(index * COLUMNS + c) * groups + group];
                *through = Aligned(L::load(&through.0).add(sum[c]).store());
            }
        }
    }
}
