//! What is left of the network over a box.

use super::bounds::Place;
use super::columns::{sort, Columns, Sorted};
use super::fold::{fold, inherit};
use super::keep::keep;
use super::rows::{bound, Block, Bounded, Rows};
use crate::machine::simd::{Aligned, Simd};

/// `o = A x + c + sum_{j open} V_j relu(w_j x + b_j) + sum_{i open} U_i relu(z_i)`.
#[derive(Default)]
pub(super) struct Part {
    /// `w_j, b_j`.
    pub columns: Columns,
    /// `z_i`.
    pub rows: Rows,
    /// `A, c`: outputs in lanes.
    pub output: Vec<[Aligned; 4]>,
    /// `V_j`: for each column all outputs, in lanes. It only grows; empty if it is all zeros.
    pub through: Vec<Aligned>,
}

/// `U`: for each row of layer 2 what it adds to all outputs, in lanes.
pub(super) struct Heads {
    /// Registers that hold all outputs.
    pub groups: usize,
    pub weights: Vec<Aligned>,
}

/// A box's part of the network, and scratch for making it.
#[derive(Default)]
pub(super) struct Level {
    pub part: Part,
    pub sorted: Sorted,
    pub bounded: Bounded,
}

impl Level {
    /// Starts from what the parent left open of layer 1; its rows, of so many panels at most, are then to be
    /// [absorbed](Level::absorb).
    pub(super) fn begin(&mut self, simd: Simd, parent: &Part, place: Place<'_>, panels: usize) {
        let Level { part, sorted, .. } = self;
        sort(simd, &parent.columns, place, &mut part.columns, sorted);
        part.rows.clear(part.columns.len, panels);
        inherit(simd, parent, sorted, part);
        // From here on they are its own.
        for (number, column) in part.columns.plane_mut(4).iter_mut().enumerate() {
            *column = f32::from_bits(number as u32);
        }
    }

    /// Takes over rows of the parent: those that are on become part of the output, open ones stay.
    pub(super) fn absorb(&mut self, simd: Simd, heads: &Heads, rows: Block<'_>, place: Place<'_>) {
        self.resolve(simd, heads, rows, place);
        keep(simd, &self.bounded, &mut self.part.rows);
    }

    /// Makes those rows of the parent that are on part of the output. Which ones are open is left in `bounded`.
    pub(super) fn resolve(&mut self, simd: Simd, heads: &Heads, rows: Block<'_>, place: Place<'_>) {
        let Level { part, sorted, bounded } = self;
        bound(simd, rows, sorted, place, bounded);
        fold(simd, heads, bounded, sorted.open.len, &mut part.output, &mut part.through);
    }
}
