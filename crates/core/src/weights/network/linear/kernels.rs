//! The loops of a linear layer in training, over lanes of columns.

use super::{Activations, Rates, GROUP, ROWS};
use crate::machine::simd::{multiversion, prefetch, Aligned, Lanes, WIDTH};

/// Points that share the loads of the weights in a product with the transposed weights: their sums stay in the nearest cache.
const POINTS: usize = 64;

multiversion! {
    /// Adam on the blocks of eight rows of a group.
    pub(super) fn update(
        state: &mut [Aligned], lanes: usize, blocks: &[usize], error: &[Aligned], input: &[Aligned], m: usize, rates: Rates,
    ) = update_body
}

/// As many rows at a time as there are registers for. The sums are the same.
#[inline(always)]
fn update_body<L: Lanes>(
    state: &mut [Aligned],
    lanes: usize,
    blocks: &[usize],
    error: &[Aligned],
    input: &[Aligned],
    m: usize,
    rates: Rates,
) {
    if L::REGISTERS >= 32 {
        update_of::<L, 8>(state, lanes, blocks, error, input, m, rates);
    } else {
        update_of::<L, 4>(state, lanes, blocks, error, input, m, rates);
    }
}

#[inline(always)]
fn update_of<L: Lanes, const TILE: usize>(
    state: &mut [Aligned],
    lanes: usize,
    blocks: &[usize],
    error: &[Aligned],
    input: &[Aligned],
    m: usize,
    rates: Rates,
) {
    let rows = state.len() / (3 * lanes);
    let (weights, moments) = state.split_at_mut(rows * lanes);
    for (c, input) in input.chunks_exact(m).take(lanes).enumerate() {
        for &block in blocks {
            let error = &error[block / (WIDTH / ROWS) * m..][..m];
            let (weights, more) = weights[c * rows + ROWS * block..].split_at_mut(ROWS);
            let (moments, further) = moments[2 * (c * rows + ROWS * block)..].split_at_mut(2 * ROWS);
            prefetch_next(more, rows - ROWS, ROWS);
            prefetch_next(further, 2 * (rows - ROWS), 2 * ROWS);
            let (first, second) = moments.split_at_mut(ROWS);
            for start in (0..ROWS).step_by(TILE) {
                let row = block % (WIDTH / ROWS) * ROWS + start;
                let mut gradient = [L::splat(0.0); TILE];
                for (x, e) in input.iter().zip(error) {
                    let x = L::load(&x.0);
                    let e: &[f32; TILE] = e.0[row..].first_chunk().expect("part of a lane");
                    for r in 0..TILE {
                        gradient[r] = L::splat(e[r]).mul(x).add(gradient[r]);
                    }
                }
                for (r, gradient) in (start..).zip(gradient) {
                    rates.descend(&mut weights[r].0, &mut first[r].0, &mut second[r].0, gradient);
                }
            }
        }
    }
}

/// Of the numbers behind some, what the next lanes of columns need.
#[inline(always)]
fn prefetch_next(behind: &[Aligned], skip: usize, count: usize) {
    if let Some(next) = behind.get(skip..skip + count) {
        prefetch(next);
    }
}

multiversion! {
    /// `z = W input` of a group of rows.
    pub(super) fn product(weights: &[Aligned], lanes: usize, input: &[Aligned], m: usize, z: &mut [Aligned]) = product_body
}

/// Some rows and points at a time: as many as there are registers for.
#[inline(always)]
fn product_body<L: Lanes>(weights: &[Aligned], lanes: usize, input: &[Aligned], m: usize, z: &mut [Aligned]) {
    if L::REGISTERS >= 32 {
        product_of::<L, 4, 5>(weights, lanes, input, m, z);
    } else {
        product_of::<L, 2, 3>(weights, lanes, input, m, z);
    }
}

#[inline(always)]
fn product_of<L: Lanes, const TILE: usize, const POINTS: usize>(
    weights: &[Aligned],
    lanes: usize,
    input: &[Aligned],
    m: usize,
    z: &mut [Aligned],
) {
    let rows = weights.len() / lanes;
    for i in (0..m).step_by(POINTS) {
        // A last, smaller tile repeats its last point: the same sum is written again.
        let points: [usize; POINTS] = std::array::from_fn(|k| (i + k).min(m - 1));
        for r in (0..rows).step_by(TILE) {
            let mut sums = [[L::splat(0.0); POINTS]; TILE];
            for (weights, input) in weights.chunks_exact(rows).zip(input.chunks_exact(m)) {
                let mut x = [L::splat(0.0); POINTS];
                for i in 0..POINTS {
                    x[i] = L::load(&input[points[i]].0);
                }
                for (k, weights) in weights[r..r + TILE].iter().enumerate() {
                    let w = L::load(&weights.0);
                    for i in 0..POINTS {
                        sums[k][i] = w.mul(x[i]).add(sums[k][i]);
                    }
                }
            }
            for (k, sums) in sums.iter().enumerate() {
                let (at, lane) = ((r + k) / WIDTH * m, (r + k) % WIDTH);
                for (point, sum) in points.iter().zip(sums) {
                    z[at + point].0[lane] = sum.total();
                }
            }
        }
    }
}

multiversion! {
    /// `sums = W^T error` for some lanes of columns from `first` on, over the blocks of rows that have an error, where `input` of
    /// those columns is above 0.
    pub(super) fn transposed_product(
        state: &[Aligned], lanes: usize, first: usize, with_error: &[bool], error: &Activations, input: &[Aligned], sums: &mut [Aligned],
    ) = transposed_product_body
}

#[inline(always)]
fn transposed_product_body<L: Lanes>(
    state: &[Aligned],
    lanes: usize,
    first: usize,
    with_error: &[bool],
    error: &Activations,
    input: &[Aligned],
    sums: &mut [Aligned],
) {
    let m = error.points;
    for points in (0..m).step_by(POINTS).map(|start| start..(start + POINTS).min(m)) {
        for (group, of_group) in state.chunks(GROUP * 3 * lanes).enumerate() {
            let rows = of_group.len() / (3 * lanes);
            let with_error = with_error[GROUP / ROWS * group..].iter().take(rows / ROWS).enumerate();
            let blocks = with_error.filter_map(|(block, with)| with.then_some(block));
            let count = sums.len() / m;
            for (c, sums) in sums.chunks_exact_mut(m).enumerate() {
                let sums = &mut sums[points.clone()];
                let weights = &of_group[(first + c) * rows..][..rows];
                // The next ones, of the next group after the last.
                let next = if c + 1 < count { (first + c + 1) * rows } else { of_group.len() + first * rows };
                let next = state.get(GROUP * 3 * lanes * group + next..).unwrap_or_default();
                for block in blocks.clone() {
                    let half = block % (WIDTH / ROWS) * ROWS;
                    let error =
                        &error.lanes[(GROUP / WIDTH * group + block / (WIDTH / ROWS)) * m..][points.clone()];
                    let weights: &[Aligned; ROWS] = weights[ROWS * block..].first_chunk().expect("a block");
                    let w: [L; ROWS] = std::array::from_fn(|r| L::load(&weights[r].0));
                    prefetch_next(next, ROWS * block, ROWS);
                    for (sum, e) in sums.iter_mut().zip(error) {
                        let e: &[f32; ROWS] = e.0[half..].first_chunk().expect("half a lane");
                        let mut total = L::load(&sum.0);
                        for r in 0..ROWS {
                            total = L::splat(e[r]).mul(w[r]).add(total);
                        }
                        *sum = Aligned(total.store());
                    }
                }
            }
        }
    }
    for (sum, input) in sums.iter_mut().zip(input) {
        let zero = L::splat(0.0);
        *sum = Aligned(L::select(zero.less(L::load(&input.0)), L::load(&sum.0), zero).store());
    }
}
