//! Control points that carry a rotation, in lanes: [`super::super::turned`].

use super::super::matrix::Matrix;
use super::super::turned::Turned;
use super::{multiply_add, multiversion_loops, Lane, Row, Scratch, Transform, BATCH, LANES};

/// What the turned control points add to C, kept for the scale.
pub(super) struct Added {
    rotation: [Lane; 9],
    scale: Lane,
}

impl Added {
    pub(super) const ZERO: Added = Added { rotation: [[0.0; BATCH]; 9], scale: [0.0; BATCH] };
}

multiversion_loops! {
    /// Adds the turned control points to the moments of a block.
    pub(super) fn add(
        rows: &[Row], turned: &[Turned<3>], transform: Transform, base: &Matrix<3>, block: usize, scratch: &mut Scratch,
    ) = add_body
}

#[inline(always)]
fn add_body<const FMA: bool>(
    rows: &[Row],
    turned: &[Turned<3>],
    transform: Transform,
    base: &Matrix<3>,
    block: usize,
    scratch: &mut Scratch,
) {
    let Scratch { moment, extent, added, .. } = scratch;
    let (weights, more) = rows.split_at(rows.len() - 3);
    let (mut second, mut largest) = ([0.0; LANES], [1.0; LANES]);
    for lane in 0..LANES {
        second[lane] = f64::from(more[0].0[lane]) + f64::from(more[1].0[lane]);
    }
    for row in weights {
        for lane in 0..LANES {
            largest[lane] = multiply_add::<FMA>(-second[lane], f64::from(row.0[lane]), largest[lane]);
        }
    }
    let dominates = |t: &Turned<3>, lane: usize| more[2].0[lane].to_bits() == t.index as u32;
    let mut owned = [false; LANES];
    for t in turned {
        for lane in 0..LANES {
            owned[lane] |= dominates(t, lane);
        }
    }
    for lane in 0..LANES {
        let (at, scale) = (block * LANES + lane, if owned[lane] { second[lane] } else { 1.0 });
        for sum in moment.iter_mut().chain(extent.iter_mut()) {
            sum[at] *= scale;
        }
        for sum in added.rotation.iter_mut().chain([&mut added.scale]) {
            sum[at] = 0.0;
        }
    }
    for t in turned {
        let turn: [f64; 9] = std::array::from_fn(|k| t.rotation[k % 3][k / 3]);
        let residual: [f64; 9] = std::array::from_fn(|k| t.scale * turn[k] - base[k % 3][k / 3]);
        let row = &weights[t.index].0;
        for lane in 0..LANES {
            let at = block * LANES + lane;
            let relative = f64::from(row[lane]);
            let w = if dominates(t, lane) { largest[lane] } else { second[lane] * relative };
            let share = t.square * w * if owned[lane] { w } else { relative };
            for k in 0..9 {
                let part = if transform == Transform::Affine { residual[k] } else { turn[k] };
                moment[k][at] = multiply_add::<FMA>(share, part, moment[k][at]);
            }
            match transform {
                Transform::Rigid => {}
                Transform::Similarity => {
                    for k in 0..9 {
                        added.rotation[k][at] = multiply_add::<FMA>(share, turn[k], added.rotation[k][at]);
                    }
                    added.scale[at] = multiply_add::<FMA>(share, t.scale, added.scale[at]);
                    extent[0][at] += 3.0 * share;
                }
                Transform::Affine => {
                    for diagonal in [0, 3, 5] {
                        extent[diagonal][at] += share;
                    }
                }
            }
        }
    }
}

/// Makes of moments that rotations were found from those that their scales are found from; `change` holds `R - I`.
#[inline(always)]
pub(super) fn align<const FMA: bool>(added: &Added, change: &[Lane; 9], moment: &mut [Lane; 9]) {
    for r in 0..3 {
        for c in 0..3 {
            let one = if r == c { 1.0 } else { 0.0 };
            for lane in 0..BATCH {
                let turned = multiply_add::<FMA>(
                    added.scale[lane],
                    change[3 * c + r][lane] + one,
                    -added.rotation[3 * r + c][lane],
                );
                moment[3 * r + c][lane] += turned;
            }
        }
    }
}
