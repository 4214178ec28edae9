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
    let x = [0, 1, 2].map(|k| L::load(&x[k].0));
    let columns = part.columns.len;
    hidden.resize(columns.max(hidden.len()), Aligned::ZERO);
    let hidden = &mut hidden[..columns];
    for (planes, hidden) in part.columns.planes.iter().zip(hidden.chunks_mut(WIDTH)) {
        for (j, hidden) in hidden.iter_mut().enumerate() {
            *hidden = Aligned(affine(planes, j, x).max(L::splat(0.0)).store());
        }
    }

    let padded = part.rows.len.next_multiple_of(ROWS);
    rows.resize(padded.max(rows.len()), Aligned::ZERO);
    for (index, out) in rows[..padded].chunks_exact_mut(ROWS).enumerate() {
        let (panel, place) = (index * ROWS / WIDTH, index * ROWS % WIDTH);
        let mut sum = affines(&part.rows.affine[panel], place, x);
        let matrix = &part.rows.matrix[panel * columns..(panel + 1) * columns];
        for (weights, hidden) in matrix.iter().zip(&*hidden) {
            add(&mut sum, weights, place, hidden);
        }
        for r in 0..ROWS {
            out[r] = Aligned(sum[r].max(L::splat(0.0)).store());
        }
    }

    let padded = heads.outputs.next_multiple_of(ROWS);
    outputs.resize(padded, Aligned::ZERO);
    for (index, out) in outputs.chunks_exact_mut(ROWS).enumerate() {
        let (group, place) = (index * ROWS / WIDTH, index * ROWS % WIDTH);
        let mut sum = affines(&part.output[group], place, x);
        for (weights, hidden) in part.through.chunks_exact(heads.groups).zip(&*hidden) {
            add(&mut sum, &weights[group], place, hidden);
        }
        for (id, row) in part.rows.ids.iter().zip(&*rows) {
            add(&mut sum, &heads.weights[*id as usize * heads.groups + group], place, row);
        }
        for r in 0..ROWS {
            out[r] = Aligned(sum[r].store());
        }
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
fn affines<L: Lanes>(maps: &[Aligned; 4], place: usize, x: [L; 3]) -> [L; ROWS] {
    let mut values = [L::splat(0.0); ROWS];
    for r in 0..ROWS {
        values[r] = affine(maps, place + r, x);
    }
    values
}

#[inline(always)]
fn add<L: Lanes>(sum: &mut [L; ROWS], weights: &Aligned, place: usize, input: &Aligned) {
    let weights = &weights.0[place..place + ROWS];
    let input = L::load(&input.0);
    for r in 0..ROWS {
        sum[r] = L::splat(weights[r]).mul_add(input, sum[r]);
    }
}
