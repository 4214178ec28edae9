//! Where the points of a batch go.

use super::{Frame, Scratch};
use crate::machine::simd::{multiversion, Doubles, Lanes, WIDEST};

multiversion! {
    /// `y = x + (M - I)(x - p*) + (q* - p*)`.
    pub(super) fn land(frame: &Frame, scratch: &Scratch, x: &[f64], y: &mut [f64]) = land_body
}

#[inline(always)]
fn land_body<L: Lanes>(frame: &Frame, scratch: &Scratch, x: &[f64], y: &mut [f64]) {
    let size = 3 * L::Doubles::WIDTH;
    let chunks = x.chunks(size).zip(y.chunks_mut(size));
    for (at, (x, y)) in chunks.enumerate() {
        let first = at * L::Doubles::WIDTH;
        if x.len() == size {
            land_some::<L::Doubles>(frame, scratch, first, x, y);
        } else {
            let (mut some, mut moved) = ([0.0; 3 * WIDEST], [0.0; 3 * WIDEST]);
            some[..x.len()].copy_from_slice(x);
            land_some::<L::Doubles>(frame, scratch, first, &some, &mut moved);
            y.copy_from_slice(&moved[..y.len()]);
        }
    }
}

#[inline(always)]
fn land_some<D: Doubles>(frame: &Frame, scratch: &Scratch, first: usize, x: &[f64], y: &mut [f64]) {
    let Scratch { p_mean, shift, change, .. } = scratch;
    let (half, inverse) = (D::splat(frame.half), D::splat(1.0 / frame.half));
    let x = D::load_points(x);
    let (mut arm, mut moved) = (x, x);
    for c in 0..3 {
        // p* - x.
        let from_centre = x[c].sub(D::splat(frame.centre[c]));
        arm[c] = from_centre.mul_sub_from(inverse, D::load(&p_mean[c][first..]));
    }
    for r in 0..3 {
        let mut by = D::load(&shift[r][first..]);
        for c in 0..3 {
            by = D::load(&change[3 * r + c][first..]).mul_sub_from(arm[c], by);
        }
        moved[r] = half.mul_add(by, x[r]);
    }
    D::store_points(moved, y);
}
