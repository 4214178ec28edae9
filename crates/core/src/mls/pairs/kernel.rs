//! The kernel of [`super`]: a block's 16 points in registers from their weights to where they go.
//!
//! With S = R' C, the torque `t = (S12 - S21, S20 - S02, S01 - S10)` is 0 at the best rotation, and near it `H w = t`, `H = tr(S) I - S`
//! (its symmetric part), gives the rotation w that is missing. The tangent of half of |w| taken from the solution as if
//! that were the tangent of |w|, each step leaves its cube. Where H is positive definite there is no other best
//! rotation: tr(R C) has one maximum over SO(3).

// Lanes and rows are counted: most loops are over several arrays at once.
#![allow(clippy::needless_range_loop)]

use super::order::Block;
use super::weights::{BlockRows, Rows};
use super::{ChunkOut, PairFrame, Table, CHUNK, TERMS};
use crate::mls::matrix::Matrix;
use crate::mls::rotation::of_quaternion;
use crate::simd::{multiversion, Lanes};
use crate::softmax::{Row, LANES};

/// Newton's steps before the last one, at the most: without a mirror, one.
const STEPS: usize = 4;
/// Blocks that go through each phase together.
const GROUP: usize = 8;
/// The square of half the angle after which one step is not enough: it may leave a tenth of its cube.
const FAR: f32 = 0.02;
/// The square of half the angle after which no step is needed: what the last one leaves is its cube, 1e-8.
const DONE: f32 = 4e-6;
/// The square of the longest quaternion whose inverse is a number.
const LONGEST: f32 = 1e36;
/// Half of a turn that is not made.
const NOTHING: f32 = 1e-9;
/// How much of the sums may have cancelled in the curvature about the first axis, and about the others.
const CANCELLED: [f32; 2] = [0.5, 0.25];

/// Where the sums for C begin: too little to turn anything by more than 3e-8, even where only the anchor does, but enough that no product
/// of two differences becomes a denormal number, with which processors take a hundred times as long.
const SEEDS: [f32; 9] = [0.0, 2e-17, 3e-17, 4e-17, 2.2e-17, 3.5e-17, 2.7e-17, 1.2e-17, 4.1e-17];

/// A block between two phases.
struct State {
    /// C, then S.
    s: [Row; 9],
    /// `sum r_i beta_i`.
    beta: [Row; 3],
    /// What may have cancelled in C, about the first axis and in all.
    sizes: [Row; 2],
    /// `R'` as a quaternion of any length.
    turn: [Row; 4],
    /// `y` less `q_k`, in the world.
    from_own: [Row; 3],
    /// 0 if the lane is sound, 1 if it is not.
    unsound: Row,
    /// Whether all are.
    sound: bool,
}

impl State {
    const fn new() -> State {
        const ZERO: Row = Row([0.0; LANES]);
        State {
            s: [ZERO; 9],
            beta: [ZERO; 3],
            sizes: [ZERO; 2],
            turn: [ZERO; 4],
            from_own: [ZERO; 3],
            unsound: ZERO,
            sound: true,
        }
    }
}

multiversion! {
    /// Moves the points of some blocks of a chunk.
    pub(super) fn deform(frame: &PairFrame<'_>, blocks: &[Block], rows: &Rows<'_>, out: &mut ChunkOut<'_>) = deform_body
}

#[inline(always)]
fn deform_body<L: Lanes>(frame: &PairFrame<'_>, blocks: &[Block], rows: &Rows<'_>, out: &mut ChunkOut<'_>) {
    let table = |block: &Block| frame.tables[block.pair as usize].as_ref();
    let mut states = [const { State::new() }; GROUP];
    for (group, blocks) in blocks.chunks(GROUP).enumerate() {
        let rows = || rows.blocks(GROUP * group);
        // Each phase for one block after another: a block alone would be one long chain of operations that wait for each other.
        for ((block, rows), state) in blocks.iter().zip(rows()).zip(&mut states) {
            if let Some(table) = table(block) {
                moments::<L>(&rows, table, state);
            }
        }
        for ((block, rows), state) in blocks.iter().zip(rows()).zip(&mut states) {
            if let Some(table) = table(block) {
                begin::<L>(&rows, table, state);
            }
        }
        for _ in 0..STEPS {
            let mut far = false;
            for (block, state) in blocks.iter().zip(&mut states) {
                far |= table(block).is_some() && step::<L>(state);
            }
            if !far {
                break;
            }
        }
        for ((block, rows), state) in blocks.iter().zip(rows()).zip(&mut states) {
            match table(block) {
                Some(table) => {
                    land::<L>(&rows, table, state);
                    put(block, table, state, out);
                    if !out.maps.is_empty() {
                        put_maps(block, table, &frame.order.pairs[block.pair as usize].axes, state, out);
                    }
                }
                None => out.rest.extend(block.points),
            }
        }
    }
}

/// The sums over the control points.
#[inline(always)]
fn moments<L: Lanes>(rows: &BlockRows<'_>, table: &Table, state: &mut State) {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let mut sums = [zero; TERMS];
    for k in 1..9 {
        sums[k] = L::splat(SEEDS[k]);
    }
    // The second control point's part.
    (sums[0], sums[9], sums[13]) = (one, one, one);
    for (row, terms) in rows.weights.iter().zip(&table.terms) {
        let r = L::load(&row.0);
        for k in 0..TERMS {
            sums[k] = r.mul_add(L::splat(terms[k]), sums[k]);
        }
    }
    for k in 0..9 {
        state.s[k].0 = sums[k].store();
    }
    for k in 0..3 {
        state.beta[k].0 = sums[9 + k].store();
    }
    for k in 0..2 {
        state.sizes[k].0 = sums[12 + k].store();
    }
}

/// From the sums to S after the best turn about the first axis.
#[inline(always)]
fn begin<L: Lanes>(rows: &BlockRows<'_>, table: &Table, state: &mut State) {
    let (zero, one, two) = (L::splat(0.0), L::splat(1.0), L::splat(2.0));
    let mut s: [L; 9] = load(&state.s);
    for r in 0..3 {
        let mean = L::load(&rows.mean[r].0);
        for c in 0..3 {
            s[3 * r + c] = s[3 * r + c].sub_mul(mean, L::load(&state.beta[c].0));
        }
    }
    let row = [dot(&[s[0], s[1], s[2]], &[s[0], s[1], s[2]]), dot(&[s[3], s[4], s[5]], &[s[3], s[4], s[5]])];
    let square = row[0].add(row[1]).add(dot(&[s[6], s[7], s[8]], &[s[6], s[7], s[8]]));
    let norm = square.mul(square.inverse_sqrt());
    for k in 0..9 {
        s[k] = norm.mul_add(L::splat(table.anchor[k]), s[k]);
    }

    // The angle whose cosine and sine are as these two.
    let (cos, sin) = (s[4].add(s[8]), s[5].sub(s[7]));
    let inverse = plus(cos, cos, sin, sin).inverse_sqrt();
    // Its cosine plus 1 and its sine: half of the angle.
    let (w, x) = (cos.mul_add(inverse, one), sin.mul(inverse));
    let twice = x.mul(two).mul(plus(w, w, x, x).inverse());
    let (cos, sin) = (one.sub_mul(twice, x), twice.mul(w));
    for c in 3..6 {
        let (upper, lower) = (s[c], s[c + 3]);
        s[c] = minor(cos, upper, sin, lower);
        s[c + 3] = plus(cos, lower, sin, upper);
    }
    for k in 0..9 {
        state.s[k].0 = s[k].store();
    }
    state.turn = [Row(w.store()), Row(x.store()), Row(zero.store()), Row(zero.store())];
}

/// One of Newton's steps; gives whether any lane's was so large that the next one will not be the last.
#[inline(always)]
fn step<L: Lanes>(state: &mut State) -> bool {
    let mut s: [L; 9] = load(&state.s);
    let (half, _) = newton(&s, &state.sizes);
    let angle = dot(&half, &half);
    let real = angle.add(L::splat(1.0));
    let turn = compose(real, &half, &state.turn);
    let scale = L::splat(2.0).mul(real.mul_add(real, angle).inverse());
    for c in 0..3 {
        let column = rotate(real, &half, scale, &[s[c], s[3 + c], s[6 + c]]);
        (s[c], s[3 + c], s[6 + c]) = (column[0], column[1], column[2]);
    }
    for k in 0..9 {
        state.s[k].0 = s[k].store();
    }
    for k in 0..4 {
        state.turn[k].0 = turn[k].store();
    }
    L::any(L::less(L::splat(FAR), angle))
}

/// The last step, and the points state.
#[inline(always)]
fn land<L: Lanes>(rows: &BlockRows<'_>, table: &Table, state: &mut State) {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let (half, open) = newton::<L>(&load(&state.s), &state.sizes);
    // So small that its cosine is 1.
    let turn = compose(one, &half, &state.turn);
    let axis = [turn[1], turn[2], turn[3]];
    let square = turn[0].mul_add(turn[0], dot(&axis, &axis));
    let scale = L::splat(2.0).mul(square.inverse());
    let arm = [L::load(&rows.arm[0].0), L::load(&rows.arm[1].0), L::load(&rows.arm[2].0)];
    let mut place = rotate(turn[0], &axis, scale, &arm);
    let share = L::load(&rows.second.0).mul(L::splat(table.stretch));
    for c in 0..3 {
        place[c] = share.mul_add(L::load(&state.beta[c].0), place[c]);
    }
    for r in 0..3 {
        let v = &table.landing[3 * r..3 * r + 3];
        state.from_own[r].0 = dot(&[L::splat(v[0]), L::splat(v[1]), L::splat(v[2])], &place).store();
    }
    for k in 0..4 {
        state.turn[k].0 = turn[k].store();
    }
    // What is not a number is not below anything.
    let unsound = L::select(L::less(open, L::splat(DONE)), zero, one);
    let unsound = L::select(L::less(square, L::splat(LONGEST)), unsound, one);
    state.unsound.0 = unsound.store();
    state.sound = !L::any(L::less(zero, unsound));
}

/// The quaternion of `real` and `axis` after that of `turn`.
#[inline(always)]
fn compose<L: Lanes>(real: L, axis: &[L; 3], turn: &[Row; 4]) -> [L; 4] {
    let w = L::load(&turn[0].0);
    let v = [L::load(&turn[1].0), L::load(&turn[2].0), L::load(&turn[3].0)];
    let across = cross(axis, &v);
    [
        real.mul(w).sub(dot(axis, &v)),
        real.mul_add(v[0], w.mul_add(axis[0], across[0])),
        real.mul_add(v[1], w.mul_add(axis[1], across[1])),
        real.mul_add(v[2], w.mul_add(axis[2], across[2])),
    ]
}

#[inline(always)]
fn load<L: Lanes>(rows: &[Row; 9]) -> [L; 9] {
    let mut loaded = [L::splat(0.0); 9];
    for k in 0..9 {
        loaded[k] = L::load(&rows[k].0);
    }
    loaded
}

/// Newton's step from S, half of it; and its square, or 1 where H is not positive definite or too much has cancelled.
#[inline(always)]
fn newton<L: Lanes>(s: &[L; 9], sizes: &[Row; 2]) -> ([L; 3], L) {
    let zero = L::splat(0.0);
    let torque = [s[5].sub(s[7]), s[6].sub(s[2]), s[1].sub(s[3])];
    // 2 H.
    let two = L::splat(2.0);
    let (d0, d1, d2) = (s[4].add(s[8]).mul(two), s[0].add(s[8]).mul(two), s[0].add(s[4]).mul(two));
    // Its other entries, negative.
    let (o01, o02, o12) = (s[1].add(s[3]), s[2].add(s[6]), s[5].add(s[7]));
    let (k00, k01, k02) = (minor(d1, d2, o12, o12), plus(o02, o12, o01, d2), plus(o01, o12, o02, d1));
    let (k11, k12, k22) = (minor(d0, d2, o02, o02), plus(o01, o02, d0, o12), minor(d0, d1, o01, o01));
    let determinant = d0.mul(k00).sub_mul(o01, k01).sub_mul(o02, k02);
    // A step may be wrong by a thousandth of itself: it leaves more than that, or is the last one and small.
    let inverse = determinant.estimated_inverse();
    let mut half = [
        dot(&[k01, k02, k00], &[torque[1], torque[2], torque[0]]).mul(inverse),
        dot(&[k01, k12, k11], &[torque[0], torque[2], torque[1]]).mul(inverse),
        dot(&[k02, k12, k22], &torque).mul(inverse),
    ];
    // What turns nothing is 0: products of such numbers would be denormal.
    for axis in &mut half {
        *axis = L::select(L::less(axis.abs(), L::splat(NOTHING)), zero, *axis);
    }
    // The determinant over a cofactor is the curvature about that axis if the others follow.
    let least = L::load(&sizes[0].0).mul(L::splat(CANCELLED[0])).mul(k00);
    let least = least.max(L::load(&sizes[1].0).mul(L::splat(CANCELLED[1])).mul(k11.max(k22)));
    let missing = least.sub(determinant).max(zero.sub(k00)).max(zero.sub(d1));
    (half, L::select(L::less(missing, zero), dot(&half, &half), L::splat(1.0)))
}

#[inline(always)]
fn dot<L: Lanes>(a: &[L; 3], b: &[L; 3]) -> L {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2].mul(b[2])))
}

#[inline(always)]
fn cross<L: Lanes>(a: &[L; 3], b: &[L; 3]) -> [L; 3] {
    [minor(a[1], b[2], a[2], b[1]), minor(a[2], b[0], a[0], b[2]), minor(a[0], b[1], a[1], b[0])]
}

/// `a b - c d`.
#[inline(always)]
fn minor<L: Lanes>(a: L, b: L, c: L, d: L) -> L {
    a.mul(b).sub_mul(c, d)
}

/// `a b + c d`.
#[inline(always)]
fn plus<L: Lanes>(a: L, b: L, c: L, d: L) -> L {
    a.mul_add(b, c.mul(d))
}

/// `v` turned by the quaternion, `scale` 2 over the square of its length.
#[inline(always)]
fn rotate<L: Lanes>(real: L, axis: &[L; 3], scale: L, v: &[L; 3]) -> [L; 3] {
    let [x, y, z] = cross(axis, v);
    let once = [x.mul(scale), y.mul(scale), z.mul(scale)];
    let twice = cross(axis, &once);
    [
        real.mul_add(once[0], v[0].add(twice[0])),
        real.mul_add(once[1], v[1].add(twice[1])),
        real.mul_add(once[2], v[2].add(twice[2])),
    ]
}

/// Puts the points of a block where they go.
#[inline(always)]
fn put(block: &Block, table: &Table, state: &State, out: &mut ChunkOut<'_>) {
    let mut places = [[0.0; LANES]; 3];
    for c in 0..3 {
        for lane in 0..LANES {
            places[c][lane] = table.own[c] + f64::from(state.from_own[c].0[lane]);
        }
    }
    let first = CHUNK * out.chunk;
    if !state.sound {
        let unsound = block.points.iter().zip(state.unsound.0).filter(|(_, unsound)| *unsound > 0.0);
        out.rest.extend(unsound.map(|(point, _)| *point));
    }
    for lane in 0..LANES {
        let at = 3 * (block.points[lane] as usize - first);
        if let Some(y) = out.y.get_mut(at..at + 3) {
            y.copy_from_slice(&[places[0][lane], places[1][lane], places[2][lane]]);
        }
    }
}

/// Their maps: `V R' U`.
fn put_maps(block: &Block, table: &Table, axes: &Matrix<3>, state: &State, out: &mut ChunkOut<'_>) {
    for (lane, point) in block.points.iter().enumerate() {
        let turn = of_quaternion(state.turn.map(|row| f64::from(row.0[lane])));
        let at = 9 * (*point as usize - CHUNK * out.chunk);
        for r in 0..3 {
            for c in 0..3 {
                let row: [f64; 3] = std::array::from_fn(|k| (0..3).map(|l| table.v[r][l] * turn[l][k]).sum());
                out.maps[at + 3 * r + c] = (0..3).map(|k| row[k] * axes[k][c]).sum();
            }
        }
    }
}
