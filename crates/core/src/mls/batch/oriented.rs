//! Control points that carry a rotation, in lanes: [`super::super::oriented`].

use super::super::matrix::Matrix;
use super::super::oriented::Oriented;
use super::{multiply_add, multiversion_loops, Lane, Row, Scratch, Transform, BATCH, LANES};

/// What the oriented control points add to C, kept for the scale.
pub(super) struct Added {
    rotation: [Lane; 9],
    scale: Lane,
}

impl Added {
    pub(super) const ZERO: Added = Added { rotation: [[0.0; BATCH]; 9], scale: [0.0; BATCH] };
}

multiversion_loops! {
    /// Adds the oriented control points to the moments of a block.
    pub(super) fn add(
        rows: &[Row], oriented: &[Oriented<3>], transform: Transform, base: &Matrix<3>, block: usize, scratch: &mut Scratch,
    ) = add_body
}

#[inline(always)]
fn add_body<const FMA: bool>(
    rows: &[Row],
    oriented: &[Oriented<3>],
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
    let dominant = more[2].0.map(f32::to_bits);
    // 1 where the dominant control point is oriented.
    let mut owned = [0.0; LANES];
    for t in oriented {
        for lane in 0..LANES {
            owned[lane] = if dominant[lane] == t.index as u32 { 1.0 } else { owned[lane] };
        }
    }
    let mut scale = [1.0; LANES];
    for lane in 0..LANES {
        scale[lane] = if owned[lane] > 0.0 { second[lane] } else { 1.0 };
    }
    let first = block * LANES;
    for sum in moment.iter_mut().chain(extent.iter_mut()) {
        for (sum, scale) in sum[first..first + LANES].iter_mut().zip(scale) {
            *sum *= scale;
        }
    }
    for sum in added.rotation.iter_mut().chain([&mut added.scale]) {
        sum[first..first + LANES].fill(0.0);
    }
    for t in oriented {
        let turn: [f64; 9] = std::array::from_fn(|k| t.rotation[k % 3][k / 3]);
        let row = &weights[t.index].0;
        let mut share = [0.0; LANES];
        for lane in 0..LANES {
            let relative = f64::from(row[lane]);
            let dominates = dominant[lane] == t.index as u32;
            let w = if dominates { largest[lane] } else { second[lane] * relative };
            share[lane] = t.square * w * if owned[lane] > 0.0 { w } else { relative };
        }
        let add = |sum: &mut Lane, part: f64| {
            for (sum, share) in sum[first..first + LANES].iter_mut().zip(share) {
                *sum = multiply_add::<FMA>(share, part, *sum);
            }
        };
        for k in 0..9 {
            let affine = transform == Transform::Affine;
            add(&mut moment[k], if affine { t.scale * turn[k] - base[k % 3][k / 3] } else { turn[k] });
        }
        match transform {
            Transform::Rigid => {}
            Transform::Similarity => {
                for k in 0..9 {
                    add(&mut added.rotation[k], turn[k]);
                }
                add(&mut added.scale, t.scale);
                add(&mut extent[0], 3.0);
            }
            Transform::Affine => {
                for diagonal in [0, 3, 5] {
                    add(&mut extent[diagonal], 1.0);
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
                let oriented = multiply_add::<FMA>(
                    added.scale[lane],
                    change[3 * c + r][lane] + one,
                    -added.rotation[3 * r + c][lane],
                );
                moment[3 * r + c][lane] += oriented;
            }
        }
    }
}
