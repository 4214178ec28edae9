//! Layer 2 over a box: its rows' affine parts, and bounds on what they can be.

use super::bounds::bounds;
use super::columns::Term;
use crate::simd::{Aligned, Lanes, WIDTH};
use crate::tree::Region;

/// Rows of layer 2, in panels of 16.
#[derive(Default)]
pub(super) struct Rows {
    /// Rows, not counting those that fill up the last panel.
    pub len: usize,
    /// For each row which one of the network's it is.
    pub ids: Vec<u32>,
    /// The affine part of each panel's rows.
    pub affine: Vec<[Aligned; 4]>,
    /// Panel by panel, in it column by column: the weights of that column in the panel's rows.
    pub matrix: Vec<Aligned>,
}

impl Rows {
    pub(super) fn clear(&mut self) {
        self.len = 0;
        self.ids.clear();
        self.affine.clear();
        self.matrix.clear();
    }
}

/// Panels over a box.
pub(super) struct Bounded<const P: usize> {
    /// The affine parts of their rows, with the columns that are on.
    pub affine: [[Aligned; 4]; P],
    pub lower: [[f32; WIDTH]; P],
    pub upper: [[f32; WIDTH]; P],
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
        for k in 0..4 {
            maps[p][k] = L::load(&affine[p][k].0);
        }
    }
    for term in on {
        let map = [0, 1, 2, 3].map(|k| L::splat(term.map[k]));
        for p in 0..P {
            let weights = L::load(&matrix[p][term.column as usize].0);
            for k in 0..4 {
                maps[p][k] = weights.mul_add(map[k], maps[p][k]);
            }
        }
    }
    let mut result =
        Bounded { affine: [[Aligned::ZERO; 4]; P], lower: [[0.0; WIDTH]; P], upper: [[0.0; WIDTH]; P] };
    for p in 0..P {
        for k in 0..4 {
            result.affine[p][k] = Aligned(maps[p][k].store());
        }
    }
    let mut spreads = [L::splat(0.0); P];
    for term in open {
        let map = [0, 1, 2, 3].map(|k| L::splat(term.map[k]));
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
        (result.lower[p], result.upper[p]) = (lower.store(), upper.store());
    }
    result
}
