//! The points of a leaf, 16 at a time in lanes, 8 rows at a time.

use super::node::{Heads, Part};
use crate::simd::{multiply_add, multiversion, Lanes, LANES};

/// Rows at a time: their sums and a few operands fill the registers.
const ROWS: usize = 8;

/// Scratch of [`evaluate`].
#[derive(Default)]
pub(super) struct Activations {
    hidden: Vec<Lanes>,
    rows: Vec<Lanes>,
    /// Output by output, points in lanes.
    pub outputs: Vec<Lanes>,
}

multiversion! {
    /// Evaluates `part` at 16 points.
    pub(super) fn evaluate(
        part: &Part,
        heads: &Heads,
        x: &[Lanes; 3],
        activations: &mut Activations,
    ) = evaluate_body
}

#[inline(always)]
fn evaluate_body<const FMA: bool>(part: &Part, heads: &Heads, x: &[Lanes; 3], activations: &mut Activations) {
    let Activations { hidden, rows, outputs } = activations;
    let columns = part.columns.len;
    hidden.resize(columns.max(hidden.len()), Lanes::ZERO);
    let hidden = &mut hidden[..columns];
    for (planes, hidden) in part.columns.planes.iter().zip(hidden.chunks_mut(LANES)) {
        for (j, hidden) in hidden.iter_mut().enumerate() {
            *hidden = relu(affine::<FMA>(planes, j, x));
        }
    }

    let padded = part.rows.len.next_multiple_of(ROWS);
    rows.resize(padded.max(rows.len()), Lanes::ZERO);
    for (index, out) in rows[..padded].chunks_exact_mut(ROWS).enumerate() {
        let (panel, place) = (index * ROWS / LANES, index * ROWS % LANES);
        let map = &part.rows.affine[panel];
        let mut sum: [Lanes; ROWS] = std::array::from_fn(|r| affine::<FMA>(map, place + r, x));
        let matrix = &part.rows.matrix[panel * columns..(panel + 1) * columns];
        for (weights, hidden) in matrix.iter().zip(&*hidden) {
            add::<FMA>(&mut sum, &weights.0[place..place + ROWS], hidden);
        }
        for r in 0..ROWS {
            out[r] = relu(sum[r]);
        }
    }

    let padded = heads.outputs.next_multiple_of(ROWS);
    outputs.resize(padded, Lanes::ZERO);
    for (index, out) in outputs.chunks_exact_mut(ROWS).enumerate() {
        let (group, place) = (index * ROWS / LANES, index * ROWS % LANES);
        let map = &part.output[group];
        let mut sum: [Lanes; ROWS] = std::array::from_fn(|r| affine::<FMA>(map, place + r, x));
        for (weights, hidden) in part.through.chunks_exact(heads.groups).zip(&*hidden) {
            add::<FMA>(&mut sum, &weights[group].0[place..place + ROWS], hidden);
        }
        for (id, row) in part.rows.ids.iter().zip(&*rows) {
            let weights = &heads.weights[*id as usize * heads.groups + group];
            add::<FMA>(&mut sum, &weights.0[place..place + ROWS], row);
        }
        out.copy_from_slice(&sum);
    }
}

/// Map `r` of `maps` at the points `x`.
#[inline(always)]
fn affine<const FMA: bool>(maps: &[Lanes; 4], r: usize, x: &[Lanes; 3]) -> Lanes {
    let mut value = Lanes([maps[3].0[r]; LANES]);
    for k in 0..3 {
        for t in 0..LANES {
            value.0[t] = multiply_add::<FMA>(maps[k].0[r], x[k].0[t], value.0[t]);
        }
    }
    value
}

#[inline(always)]
fn relu(mut value: Lanes) -> Lanes {
    for v in &mut value.0 {
        *v = if *v > 0.0 { *v } else { 0.0 };
    }
    value
}

#[inline(always)]
fn add<const FMA: bool>(sum: &mut [Lanes; ROWS], weights: &[f32], input: &Lanes) {
    for r in 0..ROWS {
        for t in 0..LANES {
            sum[r].0[t] = multiply_add::<FMA>(weights[r], input.0[t], sum[r].0[t]);
        }
    }
}
