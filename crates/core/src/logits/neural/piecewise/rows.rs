//! Layer 2 over a box: its rows' affine parts, and bounds on what they can be.

use super::columns::Term;
use super::SLACK;
use crate::simd::{multiply_add, Lanes, LANES};
use crate::tree::Region;

/// Rows of layer 2, in panels of 16.
#[derive(Default)]
pub(super) struct Rows {
    /// Rows, not counting those that fill up the last panel.
    pub len: usize,
    /// For each row which one of the network's it is.
    pub ids: Vec<u32>,
    /// The affine part of each panel's rows.
    pub affine: Vec<[Lanes; 4]>,
    /// Panel by panel, in it column by column: the weights of that column in the panel's rows.
    pub matrix: Vec<Lanes>,
}

impl Rows {
    pub(super) fn clear(&mut self) {
        self.len = 0;
        self.ids.clear();
        self.affine.clear();
        self.matrix.clear();
    }

    /// Appends one lane of a panel whose affine part is `affine`; its weights are to follow.
    #[inline(always)]
    pub(super) fn push(&mut self, affine: &[Lanes; 4], lane: usize, id: u32, columns: usize) {
        let place = self.len % LANES;
        if place == 0 {
            self.affine.push([Lanes::ZERO; 4]);
            self.matrix.resize(self.matrix.len() + columns, Lanes::ZERO);
        }
        let last = self.affine.last_mut().expect("pushed above");
        for k in 0..4 {
            last[k].0[place] = affine[k].0[lane];
        }
        self.ids.push(id);
        self.len += 1;
    }
}

/// `P` panels over a box, of which the columns `on` are on and `open` are open.
pub(super) struct Bounded<const P: usize> {
    pub affine: [[Lanes; 4]; P],
    pub lower: [Lanes; P],
    pub upper: [Lanes; P],
}

/// Folds the columns that are on into the affine parts of `P` panels, and bounds the rows over the box. `matrix[p]` holds panel p.
#[inline(always)]
pub(super) fn bound<const FMA: bool, const P: usize>(
    matrix: [&[Lanes]; P],
    affine: [[Lanes; 4]; P],
    on: &[Term],
    open: &[Term],
    region: &Region,
) -> Bounded<P> {
    let mut affine = affine;
    for term in on {
        for p in 0..P {
            add::<FMA>(&mut affine[p], &matrix[p][term.column as usize], &term.map);
        }
    }
    let mut relaxed = affine;
    let mut spread = [Lanes::ZERO; P];
    for term in open {
        for p in 0..P {
            let weights = &matrix[p][term.column as usize];
            add::<FMA>(&mut relaxed[p], weights, &term.map);
            for t in 0..LANES {
                spread[p].0[t] = multiply_add::<FMA>(weights.0[t].abs(), term.spread, spread[p].0[t]);
            }
        }
    }
    let (mut lower, mut upper) = ([Lanes::ZERO; P], [Lanes::ZERO; P]);
    for p in 0..P {
        for t in 0..LANES {
            let terms: [f32; 3] = std::array::from_fn(|k| relaxed[p][k].0[t] * region.centre[k]);
            let middle = terms[0] + terms[1] + terms[2] + relaxed[p][3].0[t];
            let mut half = spread[p].0[t];
            for k in 0..3 {
                half = multiply_add::<FMA>(relaxed[p][k].0[t].abs(), region.half[k], half);
            }
            let size = terms[0].abs() + terms[1].abs() + terms[2].abs() + relaxed[p][3].0[t].abs() + half;
            half = multiply_add::<FMA>(SLACK, size, half);
            lower[p].0[t] = middle - half;
            upper[p].0[t] = middle + half;
        }
    }
    Bounded { affine, lower, upper }
}

#[inline(always)]
fn add<const FMA: bool>(affine: &mut [Lanes; 4], weights: &Lanes, map: &[f32; 4]) {
    for k in 0..4 {
        for t in 0..LANES {
            affine[k].0[t] = multiply_add::<FMA>(weights.0[t], map[k], affine[k].0[t]);
        }
    }
}
