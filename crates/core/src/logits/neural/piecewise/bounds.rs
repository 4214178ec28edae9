//! What an affine map can be over a box.

use crate::simd::Lanes;
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
