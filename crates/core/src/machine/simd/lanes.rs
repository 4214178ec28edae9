//! Sixteen numbers in registers: one of 512 bits, two of 256, or whatever the compiler makes of an array.

use super::doubles::{self, Doubles};
use super::numbers::{Array, Numbers};

/// Numbers side by side.
pub(crate) const WIDTH: usize = 16;

/// Sixteen numbers in memory, at an address that a register loads from at once.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Aligned(pub [f32; WIDTH]);

impl Aligned {
    pub(crate) const ZERO: Aligned = Aligned([0.0; WIDTH]);
}

/// Bytes that the processor fetches at a time.
const LINE: usize = 64;

/// Tells the processor that these are going to be used soon, where it can be told: by itself it looks no further ahead than the
/// end of a page of 4 KB.
#[inline(always)]
pub(crate) fn prefetch<T>(numbers: &[T]) {
    #[cfg(target_arch = "x86_64")]
    for line in numbers.chunks(LINE / size_of::<T>()) {
        use std::arch::x86_64::{_mm_prefetch, _MM_HINT_T0};
        // SAFETY: a prefetch reads and writes nothing.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(line.as_ptr().cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (numbers, LINE);
}

/// Sixteen single-precision numbers, and what kernels do with them.
pub(crate) trait Lanes: Numbers {
    /// Values that fit into registers.
    const REGISTERS: usize;
    /// Sixteen numbers of lanes.
    type Places: Copy;
    /// Double-precision numbers on the same machine.
    type Doubles: Doubles;

    fn splat(value: f32) -> Self;
    fn load(from: &[f32; WIDTH]) -> Self;
    fn store(self) -> [f32; WIDTH];
    /// Writes the first lanes, as many as there is room for.
    #[inline(always)]
    fn store_first(self, to: &mut [f32]) {
        let count = to.len().min(WIDTH);
        to[..count].copy_from_slice(&self.store()[..count]);
    }
    fn div(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    fn sqrt(self) -> Self;
    /// `1 / self` to 11 bits or more, in a fraction of the time of a division.
    fn estimated_inverse(self) -> Self;
    /// `1 / sqrt(self)` to 11 bits or more.
    fn estimated_inverse_sqrt(self) -> Self;
    fn abs(self) -> Self;
    /// `places`, each below 16, as [`permute`](Lanes::permute) wants them.
    fn places(places: &[u32; WIDTH]) -> Self::Places;
    /// In each lane what is in the lane that `places` has there.
    fn permute(self, places: Self::Places) -> Self;
    /// The lanes of the mask as bits, the first lane in the lowest.
    fn bits(mask: Self::Mask) -> u32;

    /// Writes the lanes whose bits are set, one after the other; beyond them anything.
    #[inline(always)]
    fn compress(self, mut bits: u32, to: &mut [f32; WIDTH]) {
        let from = self.store();
        for to in to {
            *to = from[bits.trailing_zeros() as usize % WIDTH];
            bits &= bits.wrapping_sub(1);
        }
    }

    /// `1 / self` to about 2e-7 of it, for normal numbers.
    #[inline(always)]
    fn inverse(self) -> Self {
        let y = self.estimated_inverse();
        let rest = self.mul_sub_from(y, Self::splat(1.0));
        y.mul_add(rest, y)
    }

    /// `1 / sqrt(self)` to about 4e-7 of it, for normal numbers above 0.
    #[inline(always)]
    fn inverse_sqrt(self) -> Self {
        let y = self.estimated_inverse_sqrt();
        let rest = Self::splat(1.0).sub(self.mul(y).mul(y));
        y.mul(Self::splat(0.5)).mul_add(rest, y)
    }

    /// The sum of the lanes, pairwise: the same order on every instruction set.
    #[inline(always)]
    fn total(self) -> f32 {
        let mut sums = self.store();
        for half in [8, 4, 2, 1] {
            for l in 0..half {
                sums[l] += sums[l + half];
            }
        }
        sums[0]
    }
}

/// For every machine.
pub(crate) type Portable = Array<f32, WIDTH>;

impl Lanes for Portable {
    const REGISTERS: usize = 4;
    type Places = [u32; WIDTH];
    type Doubles = doubles::Pair;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Array([value; WIDTH])
    }
    #[inline(always)]
    fn load(from: &[f32; WIDTH]) -> Self {
        Array(*from)
    }
    #[inline(always)]
    fn store(self) -> [f32; WIDTH] {
        self.0
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Array(self.0.map(f32::sqrt))
    }
    #[inline(always)]
    fn estimated_inverse(self) -> Self {
        Array(self.0.map(|v| 1.0 / v))
    }
    #[inline(always)]
    fn estimated_inverse_sqrt(self) -> Self {
        Array(self.0.map(|v| 1.0 / v.sqrt()))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Array(self.0.map(f32::abs))
    }
    #[inline(always)]
    fn places(places: &[u32; WIDTH]) -> Self::Places {
        *places
    }
    #[inline(always)]
    fn permute(self, places: Self::Places) -> Self {
        Array(places.map(|place| self.0[place as usize % WIDTH]))
    }
    #[inline(always)]
    fn bits(mask: Self::Mask) -> u32 {
        mask.iter().rev().fold(0, |bits, lane| 2 * bits + u32::from(*lane))
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) use x86::{Avx2, Avx512};

#[cfg(target_arch = "x86_64")]
mod x86;
