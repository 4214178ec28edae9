//! Registers of AVX2 and AVX-512.

use super::doubles::{Eight, Four};
use super::{Lanes, Numbers, WIDTH};
use std::arch::x86_64::*;

/// Two registers of 256 bits.
#[derive(Clone, Copy)]
pub(in crate::machine::simd) struct Avx2(__m256, __m256);

/// One register of 512 bits.
#[derive(Clone, Copy)]
pub(in crate::machine::simd) struct Avx512(__m512);

/// A method that is an intrinsic on each register.
macro_rules! intrinsics {
    (Avx2: $($method:ident($($arg:ident),*) = $intrinsic:ident;)*) => { $(
        #[inline(always)]
        fn $method(self, $($arg: Self),*) -> Self {
            // SAFETY: values of this type exist only in kernels compiled for it, where it was detected.
            unsafe { Avx2($intrinsic(self.0, $($arg.0),*), $intrinsic(self.1, $($arg.1),*)) }
        }
    )* };
    (Avx512: $($method:ident($($arg:ident),*) = $intrinsic:ident;)*) => { $(
        #[inline(always)]
        fn $method(self, $($arg: Self),*) -> Self {
            // SAFETY: values of this type exist only in kernels compiled for it, where it was detected.
            unsafe { Avx512($intrinsic(self.0, $($arg.0),*)) }
        }
    )* };
}

/// The sum of eight numbers, in the order of [`Lanes::total`].
///
/// # Safety
/// The machine has AVX.
#[inline(always)]
unsafe fn total(eight: __m256) -> f32 {
    // SAFETY: as the caller promises.
    unsafe {
        let four = _mm_add_ps(_mm256_castps256_ps128(eight), _mm256_extractf128_ps::<1>(eight));
        let two = _mm_add_ps(four, _mm_movehl_ps(four, four));
        _mm_cvtss_f32(_mm_add_ss(two, _mm_movehdup_ps(two)))
    }
}

/// For each eight bits the numbers of those that are set.
static COMPRESSED: [[u32; 8]; 256] = {
    let mut places = [[0; 8]; 256];
    let mut bits = 0;
    while bits < 256 {
        let (mut lane, mut count) = (0, 0);
        while lane < 8 {
            if bits >> lane & 1 == 1 {
                places[bits][count] = lane as u32;
                count += 1;
            }
            lane += 1;
        }
        bits += 1;
    }
    places
};

impl Numbers for Avx2 {
    type Mask = (__m256, __m256);

    intrinsics! { Avx2:
        add(other) = _mm256_add_ps;
        sub(other) = _mm256_sub_ps;
        mul(other) = _mm256_mul_ps;
        mul_add(b, c) = _mm256_fmadd_ps;
        mul_sub_from(b, c) = _mm256_fnmadd_ps;
    }
    #[inline(always)]
    fn less(self, other: Self) -> Self::Mask {
        // SAFETY: called in kernels compiled for it, where it was detected.
        unsafe {
            (_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0), _mm256_cmp_ps::<_CMP_LT_OQ>(self.1, other.1))
        }
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        // SAFETY: called in kernels compiled for it, where it was detected.
        unsafe { Avx2(_mm256_blendv_ps(no.0, yes.0, mask.0), _mm256_blendv_ps(no.1, yes.1, mask.1)) }
    }
}

impl Lanes for Avx2 {
    const REGISTERS: usize = 8;
    type Places = (__m256i, __m256i);
    type Doubles = Four;

    intrinsics! { Avx2:
        div(other) = _mm256_div_ps;
        max(other) = _mm256_max_ps;
        sqrt() = _mm256_sqrt_ps;
        estimated_inverse() = _mm256_rcp_ps;
        estimated_inverse_sqrt() = _mm256_rsqrt_ps;
    }
    #[inline(always)]
    fn splat(value: f32) -> Self {
        // SAFETY: called in kernels compiled for it, where it was detected; so for all below.
        unsafe { Avx2(_mm256_set1_ps(value), _mm256_set1_ps(value)) }
    }
    #[inline(always)]
    fn load(from: &[f32; WIDTH]) -> Self {
        // SAFETY: as above; 16 numbers are there to be read.
        unsafe { Avx2(_mm256_loadu_ps(from.as_ptr()), _mm256_loadu_ps(from.as_ptr().add(8))) }
    }
    #[inline(always)]
    fn store(self) -> [f32; WIDTH] {
        let mut to = [0.0; WIDTH];
        // SAFETY: as above; 16 numbers may be written.
        unsafe {
            _mm256_storeu_ps(to.as_mut_ptr(), self.0);
            _mm256_storeu_ps(to.as_mut_ptr().add(8), self.1);
        }
        to
    }
    #[inline(always)]
    fn compress(self, bits: u32, to: &mut [f32; WIDTH]) {
        let (low, high) = (bits as usize & 0xff, bits as usize >> 8 & 0xff);
        // SAFETY: as above; the first half is at most 8 lanes, so that 8 more may be written after it.
        unsafe {
            let places = |bits: usize| _mm256_loadu_si256(COMPRESSED[bits].as_ptr().cast());
            let to = to.as_mut_ptr();
            _mm256_storeu_ps(to, _mm256_permutevar8x32_ps(self.0, places(low)));
            let to = to.add(low.count_ones() as usize);
            _mm256_storeu_ps(to, _mm256_permutevar8x32_ps(self.1, places(high)));
        }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: as above.
        unsafe {
            let sign = _mm256_set1_ps(-0.0);
            Avx2(_mm256_andnot_ps(sign, self.0), _mm256_andnot_ps(sign, self.1))
        }
    }
    #[inline(always)]
    fn places(places: &[u32; WIDTH]) -> Self::Places {
        // SAFETY: as above; 16 numbers are there to be read.
        unsafe {
            let from: *const __m256i = places.as_ptr().cast();
            (_mm256_loadu_si256(from), _mm256_loadu_si256(from.add(1)))
        }
    }
    #[inline(always)]
    fn permute(self, places: Self::Places) -> Self {
        // SAFETY: as above.
        unsafe {
            // Bit 3 of a place, which says from which register, becomes the sign that the blend looks at.
            let half = |places| {
                let (low, high) =
                    (_mm256_permutevar8x32_ps(self.0, places), _mm256_permutevar8x32_ps(self.1, places));
                _mm256_blendv_ps(low, high, _mm256_castsi256_ps(_mm256_slli_epi32::<28>(places)))
            };
            Avx2(half(places.0), half(places.1))
        }
    }
    #[inline(always)]
    fn bits(mask: Self::Mask) -> u32 {
        // SAFETY: as above.
        unsafe { (_mm256_movemask_ps(mask.0) | _mm256_movemask_ps(mask.1) << 8) as u32 }
    }
    #[inline(always)]
    fn total(self) -> f32 {
        // SAFETY: as above.
        unsafe { total(_mm256_add_ps(self.0, self.1)) }
    }
}

impl Numbers for Avx512 {
    type Mask = __mmask16;

    intrinsics! { Avx512:
        add(other) = _mm512_add_ps;
        sub(other) = _mm512_sub_ps;
        mul(other) = _mm512_mul_ps;
        mul_add(b, c) = _mm512_fmadd_ps;
        mul_sub_from(b, c) = _mm512_fnmadd_ps;
    }
    #[inline(always)]
    fn less(self, other: Self) -> Self::Mask {
        // SAFETY: called in kernels compiled for it, where it was detected.
        unsafe { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        // SAFETY: called in kernels compiled for it, where it was detected.
        unsafe { Avx512(_mm512_mask_blend_ps(mask, no.0, yes.0)) }
    }
}

impl Lanes for Avx512 {
    const REGISTERS: usize = 32;
    type Places = __m512i;
    type Doubles = Eight;

    intrinsics! { Avx512:
        div(other) = _mm512_div_ps;
        max(other) = _mm512_max_ps;
        sqrt() = _mm512_sqrt_ps;
        estimated_inverse() = _mm512_rcp14_ps;
        estimated_inverse_sqrt() = _mm512_rsqrt14_ps;
    }
    #[inline(always)]
    fn splat(value: f32) -> Self {
        // SAFETY: called in kernels compiled for it, where it was detected; so for all below.
        unsafe { Avx512(_mm512_set1_ps(value)) }
    }
    #[inline(always)]
    fn load(from: &[f32; WIDTH]) -> Self {
        // SAFETY: as above; 16 numbers are there to be read.
        unsafe { Avx512(_mm512_loadu_ps(from.as_ptr())) }
    }
    #[inline(always)]
    fn store(self) -> [f32; WIDTH] {
        let mut to = [0.0; WIDTH];
        // SAFETY: as above; 16 numbers may be written.
        unsafe { _mm512_storeu_ps(to.as_mut_ptr(), self.0) };
        to
    }
    #[inline(always)]
    fn store_first(self, to: &mut [f32]) {
        let mask = ((1u32 << to.len().min(WIDTH)) - 1) as __mmask16;
        // SAFETY: as above; where the mask is set there is room.
        unsafe { _mm512_mask_storeu_ps(to.as_mut_ptr(), mask, self.0) }
    }
    #[inline(always)]
    fn compress(self, bits: u32, to: &mut [f32; WIDTH]) {
        // SAFETY: as above; 16 numbers may be written.
        unsafe {
            _mm512_storeu_ps(to.as_mut_ptr(), _mm512_maskz_compress_ps(bits as __mmask16, self.0));
        }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: as above.
        unsafe { Avx512(_mm512_abs_ps(self.0)) }
    }
    #[inline(always)]
    fn places(places: &[u32; WIDTH]) -> Self::Places {
        // SAFETY: as above; 16 numbers are there to be read.
        unsafe { _mm512_loadu_si512(places.as_ptr().cast()) }
    }
    #[inline(always)]
    fn permute(self, places: Self::Places) -> Self {
        // SAFETY: as above.
        unsafe { Avx512(_mm512_permutexvar_ps(places, self.0)) }
    }
    #[inline(always)]
    fn bits(mask: Self::Mask) -> u32 {
        u32::from(mask)
    }
    #[inline(always)]
    fn total(self) -> f32 {
        // SAFETY: as above.
        unsafe { total(_mm256_add_ps(_mm512_castps512_ps256(self.0), _mm512_extractf32x8_ps::<1>(self.0))) }
    }
}
