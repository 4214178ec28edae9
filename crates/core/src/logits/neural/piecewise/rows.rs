//! Layer 2 over a box: its rows' affine parts, and bounds on what they can be.

use std::ops::Range;

use super::bounds::{bounds, classify, lanes_of};
use super::columns::Sorted;
use crate::memory::filled;
use crate::simd::{multiversion, Aligned, Lanes, WIDTH};
use crate::tree::Region;

/// Rows of layer 2, in panels of 16.
#[derive(Default)]
pub(super) struct Rows {
    /// Columns of the matrix.
    columns: usize,
    /// For each row which one of the network's it is.
    pub ids: Vec<u32>,
    /// The affine part of each panel's rows.
    pub affine: Vec<[Aligned; 4]>,
    /// Panel by panel, in it column by column: the weights of that column in the panel's rows. It only grows; lanes beyond the
    /// last row hold anything.
    matrix: Vec<Aligned>,
}

impl Rows {
    /// No rows, of so many columns, with room for so many panels.
    pub(super) fn clear(&mut self, columns: usize, panels: usize) {
        self.columns = columns;
        self.ids.clear();
        self.affine.clear();
        // Room, which costs nothing until it is used, so that nothing is ever moved; more than is needed, so that the next node
        // finds it too.
        let room = (columns * panels).next_power_of_two();
        if self.matrix.capacity() < room {
            self.matrix = Vec::with_capacity(room);
        }
    }

    /// Has the weights of each panel, whose affine parts are there, written by `write(panel, weights)`.
    pub(super) fn fill_panels(&mut self, write: impl Fn(usize, &mut [Aligned]) + Sync + Send) {
        let (memory, columns) = (std::mem::take(&mut self.matrix), self.columns);
        self.matrix = filled(memory, columns * self.panels(), Aligned::ZERO, columns, write);
    }

    pub(super) fn panels(&self) -> usize {
        self.affine.len()
    }

    /// Appends a panel, whose weights are to be written.
    pub(super) fn push(&mut self, affine: [Aligned; 4]) {
        self.affine.push(affine);
        let needed = self.panels() * self.columns;
        if self.matrix.len() < needed {
            self.matrix.resize(needed, Aligned::ZERO);
        }
    }

    /// The weights of the last panel.
    #[inline(always)]
    pub(super) fn last_panel(&mut self) -> &mut [Aligned] {
        let end = self.panels() * self.columns;
        &mut self.matrix[end - self.columns..end]
    }

    /// Some panels.
    pub(super) fn block(&self, panels: Range<usize>) -> Block<'_> {
        Block {
            columns: self.columns,
            ids: &self.ids[WIDTH * panels.start..self.ids.len().min(WIDTH * panels.end)],
            affine: &self.affine[panels.clone()],
            matrix: &self.matrix[panels.start * self.columns..panels.end * self.columns],
        }
    }

    /// All panels.
    pub(super) fn all(&self) -> Block<'_> {
        self.block(0..self.panels())
    }
}

/// Some panels of [`Rows`].
#[derive(Clone, Copy)]
pub(super) struct Block<'a> {
    pub columns: usize,
    ids: &'a [u32],
    affine: &'a [[Aligned; 4]],
    matrix: &'a [Aligned],
}

impl<'a> Block<'a> {
    /// The weights of one panel.
    #[inline(always)]
    pub(super) fn panel(&self, panel: usize) -> &'a [Aligned] {
        &self.matrix[panel * self.columns..][..self.columns]
    }
}

/// One row of a [`Block`].
#[derive(Clone, Copy)]
pub(super) struct Row {
    pub panel: u32,
    pub lane: u32,
    /// Which one of the network's it is.
    pub id: u32,
}

/// What the rows of a block are in a child's box.
#[derive(Default)]
pub(super) struct Bounded {
    /// The affine parts of all panels, with the columns that are on.
    pub affine: Vec<[Aligned; 4]>,
    /// Which rows are on, and which open; the others are off.
    pub on: Vec<Row>,
    pub open: Vec<Row>,
}

multiversion! {
    /// Folds the columns that are on into the affine parts of the block's rows, and bounds the rows over the box.
    pub(super) fn bound(block: Block<'_>, sorted: &Sorted, region: &Region, bounded: &mut Bounded) = bound_body
}

#[inline(always)]
fn bound_body<L: Lanes>(block: Block<'_>, sorted: &Sorted, region: &Region, bounded: &mut Bounded) {
    bounded.affine.clear();
    bounded.on.clear();
    bounded.open.clear();
    let (mut p, panels) = (0, block.affine.len());
    // Several panels at a time, so that there are more sums than an addition takes cycles: as many as there are registers for.
    while p < panels {
        p += match panels - p {
            4 | 6.. if L::REGISTERS >= 32 => bound_panels::<L, 4>(block, p, sorted, region, bounded),
            3 | 5 if L::REGISTERS >= 32 => bound_panels::<L, 3>(block, p, sorted, region, bounded),
            1 => bound_panels::<L, 1>(block, p, sorted, region, bounded),
            _ => bound_panels::<L, 2>(block, p, sorted, region, bounded),
        };
    }
}

/// The panels from `first` on, `P` of them, which it returns.
#[inline(always)]
fn bound_panels<L: Lanes, const P: usize>(
    block: Block<'_>,
    first: usize,
    sorted: &Sorted,
    region: &Region,
    bounded: &mut Bounded,
) -> usize {
    let mut matrix = [block.panel(first); P];
    let mut maps = [[L::splat(0.0); 4]; P];
    for p in 0..P {
        matrix[p] = block.panel(first + p);
        maps[p] = loads(&block.affine[first + p]);
    }
    for term in sorted.on() {
        let map = splats::<L>(&term.map);
        for p in 0..P {
            let weights = L::load(&matrix[p][term.column as usize].0);
            for k in 0..4 {
                maps[p][k] = weights.mul_add(map[k], maps[p][k]);
            }
        }
    }
    for p in 0..P {
        bounded.affine.push(stores(maps[p]));
    }
    let mut spreads = [L::splat(0.0); P];
    for term in sorted.open() {
        let map = splats::<L>(&term.map);
        let spread = L::splat(term.spread);
        for p in 0..P {
            let weights = L::load(&matrix[p][term.column as usize].0);
            for k in 0..4 {
                maps[p][k] = weights.mul_add(map[k], maps[p][k]);
            }
            spreads[p] = weights.abs().mul_add(spread, spreads[p]);
        }
    }
    for p in 0..P {
        let (lower, upper) = bounds(maps[p], spreads[p], region);
        let [on, open] = classify(lower, upper);
        // The last panel may have lanes without rows.
        let ids = &block.ids[WIDTH * (first + p)..];
        let rows = u32::MAX >> (32 - WIDTH.min(ids.len()));
        let row = |lane: usize| Row { panel: (first + p) as u32, lane: lane as u32, id: ids[lane] };
        bounded.on.extend(lanes_of(on & rows).map(row));
        bounded.open.extend(lanes_of(open & rows).map(row));
    }
    P
}

/// Four registers from memory. (An `array::map` would be a call, outside of the instruction set.)
#[inline(always)]
pub(super) fn loads<L: Lanes>(from: &[Aligned; 4]) -> [L; 4] {
    [L::load(&from[0].0), L::load(&from[1].0), L::load(&from[2].0), L::load(&from[3].0)]
}

/// Four registers to memory.
#[inline(always)]
pub(super) fn stores<L: Lanes>(from: [L; 4]) -> [Aligned; 4] {
    [Aligned(from[0].store()), Aligned(from[1].store()), Aligned(from[2].store()), Aligned(from[3].store())]
}

/// Four numbers, each in all lanes.
#[inline(always)]
pub(super) fn splats<L: Lanes>(values: &[f32; 4]) -> [L; 4] {
    [L::splat(values[0]), L::splat(values[1]), L::splat(values[2]), L::splat(values[3])]
}
