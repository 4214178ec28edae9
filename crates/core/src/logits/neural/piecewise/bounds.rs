//! What an affine map can be over a box.

use crate::simd::{Lanes, WIDTH};
use crate::tree::Region;

/// Bounds are widened by this much of the magnitudes that they were computed from, so that they hold in spite of rounding,
/// however far away the box is. A neuron that is nearer to zero adds but rounding, on whichever side it is taken to be.
const SLACK: f32 = 2e-6;

/// The least and the most that `map (x, 1) +- spread` can be over the box.
#[inline(always)]
pub(super) fn bounds<L: Lanes>(map: [L; 4], spread: L, region: &Region) -> (L, L) {
    let (mut middle, mut half, mut size) = (map[3], spread, map[3].abs());
    for k in 0..3 {
        let term = map[k].mul(L::splat(region.centre[k]));
        middle = middle.add(term);
        size = size.add(term.abs());
        half = map[k].abs().mul_add(L::splat(region.half[k]), half);
    }
    half = size.add(half).mul_add(L::splat(SLACK), half);
    (middle.sub(half), middle.add(half))
}

/// Which lanes are surely on, and which may be on or off; the others are surely off. A lane without bounds may be either.
#[inline(always)]
pub(super) fn classify<L: Lanes>(lower: L, upper: L) -> [u32; 2] {
    let off = L::bits(upper.less(L::splat(f32::MIN_POSITIVE)));
    let on = L::bits(L::splat(-f32::MIN_POSITIVE).less(lower)) & !off;
    [on, !(on | off) & ((1 << WIDTH) - 1)]
}

/// The numbers of the bits that are set.
#[inline(always)]
pub(super) fn lanes_of(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize;
        let found = bits != 0;
        bits &= bits.wrapping_sub(1);
        found.then_some(lane % WIDTH)
    })
}
