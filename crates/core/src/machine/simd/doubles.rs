//! Double-precision numbers side by side: one register of them, whatever its size.
//!
//! As [`super::Lanes`] has them in single precision; but not a fixed number of them, since kernels in double precision run out of registers
//! long before they run out of lanes.

use super::numbers::{Array, Numbers};

/// The most numbers of any [`Doubles`].
pub(crate) const WIDEST: usize = 8;

/// [`Doubles::WIDTH`] double-precision numbers, and what kernels do with them.
pub(crate) trait Doubles: Numbers {
    /// How many: 2, 4 or 8.
    const WIDTH: usize;

    fn splat(value: f64) -> Self;
    /// The first numbers of `from`; so for all that load and store.
    fn load(from: &[f64]) -> Self;
    fn load_singles(from: &[f32]) -> Self;
    fn store(self, to: &mut [f64]);
    /// `1 / self`, but for its last digit, for numbers within 1e-300 to 1e300.
    fn inverse(self) -> Self;
    fn sqrt(self) -> Self;
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Whether the mask has all lanes.
    fn all(mask: Self::Mask) -> bool;

    /// In each lane the entry of `column` that the bits of `index` say. The column's length is a multiple of 16.
    #[inline(always)]
    fn look_up(column: &[f64], index: &[f32]) -> Self {
        let mut found = [0.0; WIDEST];
        for (found, index) in found[..Self::WIDTH].iter_mut().zip(index) {
            *found = column[index.to_bits() as usize];
        }
        Self::load(&found)
    }

    /// The coordinates of points of three, one after another in `from`.
    #[inline(always)]
    fn load_points(from: &[f64]) -> [Self; 3] {
        let mut lanes = [[0.0; WIDEST]; 3];
        for (lane, point) in from[..3 * Self::WIDTH].chunks_exact(3).enumerate() {
            for (lanes, coordinate) in lanes.iter_mut().zip(point) {
                lanes[lane] = *coordinate;
            }
        }
        [Self::load(&lanes[0]), Self::load(&lanes[1]), Self::load(&lanes[2])]
    }

    /// The other way.
    #[inline(always)]
    fn store_points(points: [Self; 3], to: &mut [f64]) {
        let mut lanes = [[0.0; WIDEST]; 3];
        for (lanes, coordinates) in lanes.iter_mut().zip(points) {
            coordinates.store(lanes);
        }
        for (lane, point) in to[..3 * Self::WIDTH].chunks_exact_mut(3).enumerate() {
            for (coordinate, lanes) in point.iter_mut().zip(&lanes) {
                *coordinate = lanes[lane];
            }
        }
    }
}

/// For every machine.
pub(crate) type Pair = Array<f64, 2>;

impl Doubles for Pair {
    const WIDTH: usize = 2;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Array([value; 2])
    }
    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        Array([from[0], from[1]])
    }
    #[inline(always)]
    fn load_singles(from: &[f32]) -> Self {
        Array([f64::from(from[0]), f64::from(from[1])])
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        to[..2].copy_from_slice(&self.0);
    }
    #[inline(always)]
    fn inverse(self) -> Self {
        Array(self.0.map(|v| 1.0 / v))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Array(self.0.map(f64::sqrt))
    }
    #[inline(always)]
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        [a[0] & b[0], a[1] & b[1]]
    }
    #[inline(always)]
    fn all(mask: Self::Mask) -> bool {
        mask[0] & mask[1]
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) use x86::{Eight, Four};

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{Doubles, Numbers};
    use std::arch::x86_64::*;

    /// 256 bits.
    #[derive(Clone, Copy)]
    pub(in crate::machine::simd) struct Four(__m256d);

    /// 512 bits.
    #[derive(Clone, Copy)]
    pub(in crate::machine::simd) struct Eight(__m512d);

    /// The methods that are intrinsics.
    macro_rules! intrinsics {
        ($type:ident: $($method:ident($($arg:ident),*) = $intrinsic:ident;)*) => { $(
            #[inline(always)]
            fn $method(self, $($arg: Self),*) -> Self {
                // SAFETY: values of this type exist only in kernels compiled for it, where it was detected.
                unsafe { $type($intrinsic(self.0, $($arg.0),*)) }
            }
        )* };
    }

    impl Numbers for Four {
        type Mask = __m256d;

        intrinsics! { Four:
            add(other) = _mm256_add_pd;
            sub(other) = _mm256_sub_pd;
            mul(other) = _mm256_mul_pd;
            mul_add(b, c) = _mm256_fmadd_pd;
            mul_sub_from(b, c) = _mm256_fnmadd_pd;
        }
        #[inline(always)]
        fn less(self, other: Self) -> Self::Mask {
            // SAFETY: called in kernels compiled for it, where it was detected.
            unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0) }
        }
        #[inline(always)]
        fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
            // SAFETY: called in kernels compiled for it, where it was detected.
            unsafe { Four(_mm256_blendv_pd(no.0, yes.0, mask)) }
        }
    }

    impl Doubles for Four {
        const WIDTH: usize = 4;

        intrinsics! { Four:
            sqrt() = _mm256_sqrt_pd;
        }
        #[inline(always)]
        fn splat(value: f64) -> Self {
            // SAFETY: called in kernels compiled for it, where it was detected; so for all below.
            unsafe { Four(_mm256_set1_pd(value)) }
        }
        #[inline(always)]
        fn load(from: &[f64]) -> Self {
            let from = &from[..Self::WIDTH];
            // SAFETY: as above; 4 numbers are there to be read.
            unsafe { Four(_mm256_loadu_pd(from.as_ptr())) }
        }
        #[inline(always)]
        fn load_singles(from: &[f32]) -> Self {
            let from = &from[..Self::WIDTH];
            // SAFETY: as above; 4 numbers are there to be read.
            unsafe { Four(_mm256_cvtps_pd(_mm_loadu_ps(from.as_ptr()))) }
        }
        #[inline(always)]
        fn store(self, to: &mut [f64]) {
            let to = &mut to[..Self::WIDTH];
            // SAFETY: as above; 4 numbers may be written.
            unsafe { _mm256_storeu_pd(to.as_mut_ptr(), self.0) }
        }
        #[inline(always)]
        fn inverse(self) -> Self {
            // SAFETY: as above.
            unsafe { Four(_mm256_div_pd(_mm256_set1_pd(1.0), self.0)) }
        }
        #[inline(always)]
        fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask {
            // SAFETY: as above.
            unsafe { _mm256_and_pd(a, b) }
        }
        #[inline(always)]
        fn all(mask: Self::Mask) -> bool {
            // SAFETY: as above.
            unsafe { _mm256_movemask_pd(mask) == 15 }
        }
    }

    impl Eight {
        /// The numbers of `a` at the places below 8, and of `b` at those from 8 on.
        #[inline(always)]
        fn of_both(self, b: Self, places: [i64; 8]) -> Self {
            let [p0, p1, p2, p3, p4, p5, p6, p7] = places;
            // SAFETY: values of this type exist only in kernels compiled for it, where it was detected.
            unsafe {
                let places = _mm512_setr_epi64(p0, p1, p2, p3, p4, p5, p6, p7);
                Eight(_mm512_permutex2var_pd(self.0, places, b.0))
            }
        }
    }

    impl Numbers for Eight {
        type Mask = __mmask8;

        intrinsics! { Eight:
            add(other) = _mm512_add_pd;
            sub(other) = _mm512_sub_pd;
            mul(other) = _mm512_mul_pd;
            mul_add(b, c) = _mm512_fmadd_pd;
            mul_sub_from(b, c) = _mm512_fnmadd_pd;
        }
        #[inline(always)]
        fn less(self, other: Self) -> Self::Mask {
            // SAFETY: called in kernels compiled for it, where it was detected.
            unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, other.0) }
        }
        #[inline(always)]
        fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
            // SAFETY: called in kernels compiled for it, where it was detected.
            unsafe { Eight(_mm512_mask_blend_pd(mask, no.0, yes.0)) }
        }
    }

    impl Doubles for Eight {
        const WIDTH: usize = 8;

        intrinsics! { Eight:
            sqrt() = _mm512_sqrt_pd;
        }
        #[inline(always)]
        fn splat(value: f64) -> Self {
            // SAFETY: called in kernels compiled for it, where it was detected; so for all below.
            unsafe { Eight(_mm512_set1_pd(value)) }
        }
        #[inline(always)]
        fn load(from: &[f64]) -> Self {
            let from = &from[..Self::WIDTH];
            // SAFETY: as above; 8 numbers are there to be read.
            unsafe { Eight(_mm512_loadu_pd(from.as_ptr())) }
        }
        #[inline(always)]
        fn load_singles(from: &[f32]) -> Self {
            let from = &from[..Self::WIDTH];
            // SAFETY: as above; 8 numbers are there to be read.
            unsafe { Eight(_mm512_cvtps_pd(_mm256_loadu_ps(from.as_ptr()))) }
        }
        #[inline(always)]
        fn store(self, to: &mut [f64]) {
            let to = &mut to[..Self::WIDTH];
            // SAFETY: as above; 8 numbers may be written.
            unsafe { _mm512_storeu_pd(to.as_mut_ptr(), self.0) }
        }
        #[inline(always)]
        fn inverse(self) -> Self {
            // 14 bits, then 28, then all: a fraction of the time of a division.
            // SAFETY: as above.
            let mut y = unsafe { Eight(_mm512_rcp14_pd(self.0)) };
            for _ in 0..2 {
                y = self.mul_sub_from(y, Self::splat(1.0)).mul_add(y, y);
            }
            y
        }
        #[inline(always)]
        fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask {
            a & b
        }
        #[inline(always)]
        fn all(mask: Self::Mask) -> bool {
            mask == u8::MAX
        }
        #[inline(always)]
        fn look_up(column: &[f64], index: &[f32]) -> Self {
            let index = &index[..Self::WIDTH];
            // SAFETY: as above; 8 numbers are there to be read.
            let index = unsafe { _mm512_cvtepu32_epi64(_mm256_loadu_si256(index.as_ptr().cast())) };
            let mut found = Self::splat(0.0);
            for (k, sixteen) in column.chunks_exact(16).enumerate() {
                let (low, high) = (Self::load(&sixteen[..8]), Self::load(&sixteen[8..]));
                // SAFETY: as above. The permutation looks at the low four bits of the index, the comparison at the others.
                unsafe {
                    let here =
                        _mm512_cmpeq_epi64_mask(_mm512_srli_epi64::<4>(index), _mm512_set1_epi64(k as i64));
                    let those = _mm512_permutex2var_pd(low.0, index, high.0);
                    found = Eight(_mm512_mask_mov_pd(found.0, here, those));
                }
            }
            found
        }
        #[inline(always)]
        fn load_points(from: &[f64]) -> [Self; 3] {
            let (a, b, c) = (Self::load(from), Self::load(&from[8..]), Self::load(&from[16..]));
            [
                a.of_both(b, [0, 3, 6, 9, 12, 15, 0, 0]).of_both(c, [0, 1, 2, 3, 4, 5, 10, 13]),
                a.of_both(b, [1, 4, 7, 10, 13, 0, 0, 0]).of_both(c, [0, 1, 2, 3, 4, 8, 11, 14]),
                a.of_both(b, [2, 5, 8, 11, 14, 0, 0, 0]).of_both(c, [0, 1, 2, 3, 4, 9, 12, 15]),
            ]
        }
        #[inline(always)]
        fn store_points([x, y, z]: [Self; 3], to: &mut [f64]) {
            let (to, rest) = to.split_at_mut(8);
            x.of_both(y, [0, 8, 0, 1, 9, 0, 2, 10]).of_both(z, [0, 1, 8, 3, 4, 9, 6, 7]).store(to);
            x.of_both(y, [0, 3, 11, 0, 4, 12, 0, 5]).of_both(z, [10, 1, 2, 11, 4, 5, 12, 7]).store(rest);
            let last = x.of_both(y, [13, 0, 6, 14, 0, 7, 15, 0]).of_both(z, [0, 13, 2, 3, 14, 5, 6, 15]);
            last.store(&mut rest[8..]);
        }
    }
}

#[cfg(test)]
mod tests;
