//! The points of a leaf, all of them at once.
//!
//! Neurons are evaluated with points in lanes, some rows of layer 2 and all points at a time, so that a weight that was loaded
//! serves them all. Logits are added up with outputs in lanes, some points at a time: so they come out point by point.

use super::node::Level;
use super::part::Heads;
use super::rows::{loads, Row};
use crate::geometry::LEAF_BLOCKS;
use crate::machine::simd::{multiversion, Aligned, Lanes, WIDTH};

/// A number of each point of a leaf.
type Points = [Aligned; LEAF_BLOCKS];

const NO_POINTS: Points = [Aligned::ZERO; LEAF_BLOCKS];

/// Rows of layer 2 at a time, and points of which logits are added up at a time where there are many registers, or few.
const ROWS: usize = 4;
const MANY: usize = 16;
const FEW: usize = 4;

/// Terms of a logit that are summed apart: hundreds onto one sum would each round to its size, and the logits of a place would differ
/// from one box to another by more than they need to.
const APART: usize = 64;

/// Scratch of [`evaluate`]: what the open neurons of both layers are at each point.
#[derive(Default)]
pub(super) struct Neurons {
    hidden: Vec<Points>,
    rows: Vec<Points>,
}

multiversion! {
    /// Evaluates what is left over a leaf at its points `x`, and writes the logits of each into its row.
    pub(super) fn evaluate(
        leaf: &Level,
        heads: &Heads,
        x: &[[Aligned; 3]],
        neurons: &mut Neurons,
        logits: &mut [&mut [f32]],
    ) = evaluate_body
}

#[inline(always)]
fn evaluate_body<L: Lanes>(
    leaf: &Level,
    heads: &Heads,
    x: &[[Aligned; 3]],
    neurons: &mut Neurons,
    logits: &mut [&mut [f32]],
) {
    let (columns, rows) = (leaf.sorted.open.len, leaf.bounded.open.len());
    let Neurons { hidden: h, rows: z } = neurons;
    h.resize(columns.max(h.len()), NO_POINTS);
    z.resize(rows.next_multiple_of(ROWS).max(z.len()), NO_POINTS);
    let (h, z) = (&mut h[..columns], &mut z[..rows.next_multiple_of(ROWS)]);
    if L::REGISTERS >= 32 && x.len() == LEAF_BLOCKS {
        evaluate_neurons::<L, LEAF_BLOCKS>(leaf, x, 0, h, z);
    } else {
        (0..x.len()).for_each(|block| evaluate_neurons::<L, 1>(leaf, x, block, h, z));
    }

    Terms { leaf, heads, x, hidden: h, rows: z }.all::<L>(true, logits);
}

multiversion! {
    /// How the logits of a leaf's points, whose neurons [`evaluate`] left, change along an axis: writes that of each point into its row.
    pub(super) fn differentiate(
        leaf: &Level,
        heads: &Heads,
        axis: usize,
        neurons: &Neurons,
        change: &mut Neurons,
        slopes: &mut [&mut [f32]],
    ) = differentiate_body
}

#[inline(always)]
fn differentiate_body<L: Lanes>(
    leaf: &Level,
    heads: &Heads,
    axis: usize,
    neurons: &Neurons,
    change: &mut Neurons,
    slopes: &mut [&mut [f32]],
) {
    let (columns, bounded) = (leaf.sorted.open.len, &leaf.bounded);
    let zero = L::splat(0.0);
    change.hidden.resize(columns.max(change.hidden.len()), NO_POINTS);
    change.rows.resize(bounded.open.len().max(change.rows.len()), NO_POINTS);
    let weights = leaf.part.columns.plane(axis);
    for j in 0..columns {
        for b in 0..slopes.len().div_ceil(WIDTH) {
            let on = zero.less(L::load(&neurons.hidden[j][b].0));
            change.hidden[j][b] = Aligned(L::select(on, L::splat(weights[j]), zero).store());
        }
    }
    for (at, Row { panel, lane, .. }) in bounded.open.iter().enumerate() {
        let (panel, lane) = (*panel as usize, *lane as usize % WIDTH);
        let weights = &bounded.panel(panel)[..columns];
        for b in 0..slopes.len().div_ceil(WIDTH) {
            let mut sum = L::splat(bounded.affine[panel][axis].0[lane]);
            for j in 0..columns {
                sum = L::splat(weights[j].0[lane]).mul_add(L::load(&change.hidden[j][b].0), sum);
            }
            let on = zero.less(L::load(&neurons.rows[at][b].0));
            change.rows[at][b] = Aligned(L::select(on, sum, zero).store());
        }
    }
    let mut x = [[Aligned::ZERO; 3]; LEAF_BLOCKS];
    x.iter_mut().for_each(|x| x[axis] = Aligned([1.0; WIDTH]));
    Terms { leaf, heads, x: &x, hidden: &change.hidden[..columns], rows: &change.rows[..bounded.open.len()] }
        .all::<L>(false, slopes);
}

/// The neurons at `B` blocks of points.
#[inline(always)]
fn evaluate_neurons<L: Lanes, const B: usize>(
    leaf: &Level,
    x: &[[Aligned; 3]],
    first: usize,
    hidden: &mut [Points],
    rows: &mut [Points],
) {
    let mut points = [[L::splat(0.0); 3]; B];
    for b in 0..B {
        for k in 0..3 {
            points[b][k] = L::load(&x[first + b][k].0);
        }
    }
    let columns = &leaf.part.columns;
    for (j, hidden) in hidden.iter_mut().enumerate() {
        let mut map = [0.0; 4];
        for k in 0..4 {
            map[k] = columns.plane(k)[j];
        }
        for b in 0..B {
            hidden[first + b] = Aligned(affine(map, points[b]).max(L::splat(0.0)).store());
        }
    }
    let bounded = &leaf.bounded;
    let affines = &bounded.affine;
    for (which, out) in leaf.bounded.open.chunks(ROWS).zip(rows.chunks_exact_mut(ROWS)) {
        // A shorter last chunk repeats its last row, which nobody asks for.
        let (mut weights, mut lanes) = ([bounded.panel(0); ROWS], [0; ROWS]);
        let mut sum = [[L::splat(0.0); B]; ROWS];
        for r in 0..ROWS {
            let Row { panel, lane, .. } = which[r.min(which.len() - 1)];
            (weights[r], lanes[r]) = (&bounded.panel(panel as usize)[..hidden.len()], lane as usize % WIDTH);
            let mut map = [0.0; 4];
            for k in 0..4 {
                map[k] = affines[panel as usize][k].0[lanes[r]];
            }
            for b in 0..B {
                sum[r][b] = affine(map, points[b]);
            }
        }
        for (c, hidden) in hidden.iter().enumerate() {
            let mut inputs = [L::splat(0.0); B];
            for b in 0..B {
                inputs[b] = L::load(&hidden[first + b].0);
            }
            for r in 0..ROWS {
                let weight = L::splat(weights[r][c].0[lanes[r]]);
                for b in 0..B {
                    sum[r][b] = weight.mul_add(inputs[b], sum[r][b]);
                }
            }
        }
        for r in 0..ROWS {
            for b in 0..B {
                out[r][first + b] = Aligned(sum[r][b].max(L::splat(0.0)).store());
            }
        }
    }
}

/// An affine map at the points `x`.
#[inline(always)]
fn affine<L: Lanes>(map: [f32; 4], x: [L; 3]) -> L {
    let value = x[0].mul_add(L::splat(map[0]), L::splat(map[3]));
    let value = x[1].mul_add(L::splat(map[1]), value);
    x[2].mul_add(L::splat(map[2]), value)
}

/// What logits are made of.
struct Terms<'a> {
    leaf: &'a Level,
    heads: &'a Heads,
    x: &'a [[Aligned; 3]],
    hidden: &'a [Points],
    rows: &'a [Points],
}

impl Terms<'_> {
    /// All outputs at all points; `whole`, or without what is the same everywhere.
    #[inline(always)]
    fn all<L: Lanes>(&self, whole: bool, logits: &mut [&mut [f32]]) {
        for (group, output) in self.leaf.part.output.iter().enumerate() {
            let mut output = loads::<L>(output);
            if !whole {
                output[3] = L::splat(0.0);
            }
            let mut first = 0;
            while first < logits.len() {
                first += if L::REGISTERS >= 32 && first + MANY <= logits.len() {
                    self.add_up::<L, MANY>(group, output, first, logits)
                } else if first + FEW <= logits.len() {
                    self.add_up::<L, FEW>(group, output, first, logits)
                } else {
                    self.add_up::<L, 1>(group, output, first, logits)
                };
            }
        }
    }

    /// Outputs of one group at `P` points from `first` on, all of one block. Returns `P`.
    #[inline(always)]
    fn add_up<L: Lanes, const P: usize>(
        &self,
        group: usize,
        output: [L; 4],
        first: usize,
        logits: &mut [&mut [f32]],
    ) -> usize {
        let (leaf, groups) = (self.leaf, self.heads.groups);
        let (block, lane) = (first / WIDTH, first % WIDTH);
        let mut sum = [output[3]; P];
        for k in 0..3 {
            add(&mut sum, output[k], &self.x[block][k], lane);
        }
        let through = leaf.part.through.chunks(groups * APART);
        for (weights, hidden) in through.zip(self.hidden.chunks(APART)) {
            let mut apart = [L::splat(0.0); P];
            for (weights, hidden) in weights.chunks_exact(groups).zip(hidden) {
                add(&mut apart, L::load(&weights[group].0), &hidden[block], lane);
            }
            add_all(&mut sum, apart);
        }
        for (open, rows) in leaf.bounded.open.chunks(APART).zip(self.rows.chunks(APART)) {
            let mut apart = [L::splat(0.0); P];
            for (Row { id, .. }, row) in open.iter().zip(rows) {
                add(
                    &mut apart,
                    L::load(&self.heads.weights[*id as usize * groups + group].0),
                    &row[block],
                    lane,
                );
            }
            add_all(&mut sum, apart);
        }
        for p in 0..P {
            sum[p].store_first(&mut logits[first + p][WIDTH * group..]);
        }
        P
    }
}

/// Adds what was summed apart.
#[inline(always)]
fn add_all<L: Lanes, const P: usize>(sum: &mut [L; P], apart: [L; P]) {
    for p in 0..P {
        sum[p] = sum[p].add(apart[p]);
    }
}

/// Adds `weights` times each of the numbers from `lane` on.
#[inline(always)]
fn add<L: Lanes, const P: usize>(sum: &mut [L; P], weights: L, numbers: &Aligned, lane: usize) {
    let numbers = &numbers.0[lane..lane + P];
    for p in 0..P {
        sum[p] = weights.mul_add(L::splat(numbers[p]), sum[p]);
    }
}
