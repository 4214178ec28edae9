//! What is left of the network over a box.

use super::bounds::Domain;
use super::columns::{sort, Sorted};
use super::compact::compact;
use super::fold::{fold, inherit};

use super::part::{Heads, Part};
use super::rows::{bound, Block, Bounded};
use crate::machine::simd::Simd;

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
    pub(super) fn begin(&mut self, simd: Simd, parent: &Part, domain: Domain<'_>, panels: usize) {
        let Level { part, sorted, .. } = self;
        sort(simd, &parent.columns, domain, &mut part.columns, sorted);
        part.rows.clear(part.columns.len, panels);
        inherit(simd, parent, sorted, part);
        // From here on they are its own.
        for (number, column) in part.columns.plane_mut(4).iter_mut().enumerate() {
            *column = f32::from_bits(number as u32);
        }
    }

    /// Takes over rows of the parent: those that are on become part of the output, open ones stay.
    pub(super) fn absorb(&mut self, simd: Simd, heads: &Heads, rows: Block<'_>, domain: Domain<'_>) {
        self.resolve(simd, heads, rows, domain);
        compact(simd, &self.bounded, &mut self.part.rows);
    }

    /// Makes those rows of the parent that are on part of the output. Which ones are open is left in `bounded`.
    pub(super) fn resolve(&mut self, simd: Simd, heads: &Heads, rows: Block<'_>, domain: Domain<'_>) {
        let Level { part, sorted, bounded } = self;
        bound(simd, rows, sorted, domain, bounded);
        fold(simd, heads, bounded, sorted.open.len, &mut part.output, &mut part.through);
    }
}
