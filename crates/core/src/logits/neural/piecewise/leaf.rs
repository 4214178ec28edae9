//! The points of a leaf, 16 at a time in lanes, 8 rows at a time.

use super::node::{Heads, Part};
use crate::simd::{multiversion, Aligned, Lanes, WIDTH};

/// Rows at a time: their sums and a few operands fill the registers.
const ROWS: usize = 8;

/// Scratch of [`evaluate`].
#[derive(Default)]
pub(super) struct Activations {
    hidden: Vec<Aligned>,
    rows: Vec<Aligned>,
    /// Output by output, points in lanes.
    pub outputs: Vec<Aligned>,
}

multiversion! {
    /// Evaluates `part` at 16 points.
    pub(super) fn evaluate(
        part: &Part,
        heads: &Heads,
        x: &[Aligned; 3],
        activations: &mut Activations,
    ) = evaluate_body
}

#[inline(always)]
fn evaluate_body<L: Lanes>(part: &Part, heads: &Heads, x: &[Aligned; 3], activations: &mut Activations) {
    let Activations { hidden, rows, outputs } = activations;
    let x = [L::load(&x[0].0), L::load(&x[1].0), L::load(&x[2].0)];
    let columns = part.columns.len;
    hidden.resize(columns.max(hidden.len()), Aligned::ZERO);
    let hidden = &mut hidden[..columns];
    for (planes, hidden) in part.columns.planes.iter().zip(hidden.chunks_mut(WIDTH)) {
        for (j, hidden) in hidden.iter_mut().enumerate() {
            *hidden = Aligned(affine(planes, j, x).max(L::splat(0.0)).store());
        }
    }

    let padded = part.rows.ids.len().next_multiple_of(ROWS);
    rows.resize(padded.max(rows.len()), Aligned::ZERO);
    for (index, out) in rows[..padded].chunks_exact_mut(ROWS).enumerate() {
        let (panel, place) = (index * ROWS / WIDTH, index * ROWS % WIDTH);
        let mut sum = affines::<L, ROWS>(&part.rows.affine[panel], place, x);
        for (weights, hidden) in part.rows.panel(panel).iter().zip(&*hidden) {
            add(&mut sum, weights, place, hidden);
        }
        for r in 0..ROWS {
            out[r] = Aligned(sum[r].max(L::splat(0.0)).store());
        }
    }

    outputs.resize(heads.outputs.next_multiple_of(WIDTH), Aligned::ZERO);
    for (group, out) in outputs.chunks_exact_mut(WIDTH).enumerate() {
        let sources = Sources { part, heads, group, x, hidden, rows };
        let (mut place, end) = (0, heads.outputs - WIDTH * group);
        while place < end.min(WIDTH) {
            let out = &mut out[place..];
            place += match end - place {
                1 => sources.add_up::<1>(place, out),
                2 => sources.add_up::<2>(place, out),
                3 | 4 => sources.add_up::<4>(place, out),
                _ => sources.add_up::<ROWS>(place, out),
            };
        }
    }
}

/// What 16 of the outputs are made of.
struct Sources<'a, L> {
    part: &'a Part,
    heads: &'a Heads,
    group: usize,
    x: [L; 3],
    hidden: &'a [Aligned],
    rows: &'a [Aligned],
}

impl<L: Lanes> Sources<'_, L> {
    /// `R` outputs from `place` on.
    #[inline(always)]
    fn add_up<const R: usize>(&self, place: usize, out: &mut [Aligned]) -> usize {
        let (part, group, groups) = (self.part, self.group, self.heads.groups);
        let mut sum = affines::<L, R>(&part.output[group], place, self.x);
        for (weights, hidden) in part.through.chunks_exact(groups).zip(self.hidden) {
            add(&mut sum, &weights[group], place, hidden);
        }
        for (id, row) in part.rows.ids.iter().zip(self.rows) {
            add(&mut sum, &self.heads.weights[*id as usize * groups + group], place, row);
        }
        for r in 0..R {
            out[r] = Aligned(sum[r].store());
        }
        R
    }
}

/// Map `r` of `maps` at the points `x`.
#[inline(always)]
fn affine<L: Lanes>(maps: &[Aligned; 4], r: usize, x: [L; 3]) -> L {
    let value = x[0].mul_add(L::splat(maps[0].0[r]), L::splat(maps[3].0[r]));
    let value = x[1].mul_add(L::splat(maps[1].0[r]), value);
    x[2].mul_add(L::splat(maps[2].0[r]), value)
}

/// The maps from `place` on.
#[inline(always)]
fn affines<L: Lanes, const R: usize>(maps: &[Aligned; 4], place: usize, x: [L; 3]) -> [L; R] {
    let mut values = [L::splat(0.0); R];
    for r in 0..R {
        values[r] = affine(maps, place + r, x);
    }
    values
}

#[inline(always)]
fn add<L: Lanes, const R: usize>(sum: &mut [L; R], weights: &Aligned, place: usize, input: &Aligned) {
    let weights = &weights.0[place..place + R];
    let input = L::load(&input.0);
    for r in 0..R {
        sum[r] = L::splat(weights[r]).mul_add(input, sum[r]);
    }
}
