//! Layer 2 over a box: its rows' affine parts, and bounds on what they can be.

use super::bounds::{bounds, classify};
use super::columns::Term;
use crate::memory::filled;
use crate::simd::{Aligned, Lanes};
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

    /// The weights of one panel.
    #[inline(always)]
    pub(super) fn panel(&self, panel: usize) -> &[Aligned] {
        &self.matrix[panel * self.columns..(panel + 1) * self.columns]
    }

    /// The weights of the last panel.
    #[inline(always)]
    pub(super) fn last_panel(&mut self) -> &mut [Aligned] {
        let end = self.panels() * self.columns;
        &mut self.matrix[end - self.columns..end]
    }
}

/// Panels over a box.
pub(super) struct Bounded<const P: usize> {
    /// The affine parts of their rows, with the columns that are on.
    pub affine: [[Aligned; 4]; P],
    /// Which of their rows are on, and which open.
    pub on: [u32; P],
    pub open: [u32; P],
}

/// Folds the columns that are on into the affine parts of `P` panels, and bounds their rows over the box.
#[inline(always)]
pub(super) fn bound<L: Lanes, const P: usize>(
    matrix: [&[Aligned]; P],
    affine: [&[Aligned; 4]; P],
    on: &[Term],
    open: &[Term],
    region: &Region,
) -> Bounded<P> {
    let mut maps = [[L::splat(0.0); 4]; P];
    for p in 0..P {
        maps[p] = loads(affine[p]);
    }
    for term in on {
        let map = splats::<L>(&term.map);
        for p in 0..P {
            let weights = L::load(&matrix[p][term.column as usize].0);
            for k in 0..4 {
                maps[p][k] = weights.mul_add(map[k], maps[p][k]);
            }
        }
    }
    let mut result = Bounded { affine: [[Aligned::ZERO; 4]; P], on: [0; P], open: [0; P] };
    for p in 0..P {
        for k in 0..4 {
            result.affine[p][k] = Aligned(maps[p][k].store());
        }
    }
    let mut spreads = [L::splat(0.0); P];
    for term in open {
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
        [result.on[p], result.open[p]] = classify(lower, upper);
    }
    result
}

/// Four registers from memory. (An `array::map` would be a call, outside of the instruction set.)
#[inline(always)]
pub(super) fn loads<L: Lanes>(from: &[Aligned; 4]) -> [L; 4] {
    [L::load(&from[0].0), L::load(&from[1].0), L::load(&from[2].0), L::load(&from[3].0)]
}

/// Four numbers, each in all lanes.
#[inline(always)]
pub(super) fn splats<L: Lanes>(values: &[f32; 4]) -> [L; 4] {
    [L::splat(values[0]), L::splat(values[1]), L::splat(values[2]), L::splat(values[3])]
}
