//! Kernels that are loops over lanes: `for lane in 0..64 { arithmetic on numbers[lane] }`.
//!
//! A loop whose body is straight arithmetic (choices as `if a { b } else { c }`, no calls, inner loops of constant length) is what compilers
//! vectorise without help, for single and double precision alike. [`multiversion_loops!`] compiles such a
//! kernel, `#[inline(always)]`, for each instruction set, with the constant `FMA` that says whether a fused multiply-add is one
//! instruction.

/// `a * b + c`, rounded once where `FMA`.
#[inline(always)]
pub(crate) fn multiply_add_f32<const FMA: bool>(a: f32, b: f32, c: f32) -> f32 {
    if FMA {
        a.mul_add(b, c)
    } else {
        a * b + c
    }
}

/// The same in double precision.
#[inline(always)]
pub(crate) fn multiply_add<const FMA: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FMA {
        a.mul_add(b, c)
    } else {
        a * b + c
    }
}

/// Defines `fn name(simd: Simd, arguments...)` that calls the kernel `body::<FMA>(arguments...)` compiled for `simd`.
macro_rules! multiversion_loops {
    ($(#[$meta:meta])* $vis:vis fn $name:ident($($arg:ident: $type:ty),* $(,)?) = $body:ident) => {
        $(#[$meta])*
        #[allow(clippy::too_many_arguments)]
        $vis fn $name(simd: $crate::machine::simd::Simd, $($arg: $type),*) {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2,fma")]
                #[allow(clippy::too_many_arguments)]
                fn avx2($($arg: $type),*) {
                    $body::<true>($($arg),*)
                }
                #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma")]
                #[allow(clippy::too_many_arguments)]
                fn avx512($($arg: $type),*) {
                    $body::<true>($($arg),*)
                }
                match simd.set() {
                    // SAFETY: a `Simd` is made by detection alone: this machine has AVX-512.
                    $crate::machine::simd::InstructionSet::Avx512 => return unsafe { avx512($($arg),*) },
                    // SAFETY: as above, AVX2 and fused multiply-add.
                    $crate::machine::simd::InstructionSet::Avx2 => return unsafe { avx2($($arg),*) },
                    $crate::machine::simd::InstructionSet::Portable => {}
                }
            }
            #[cfg(not(target_arch = "x86_64"))]
            let _ = simd;
            $body::<false>($($arg),*)
        }
    };
}
pub(crate) use multiversion_loops;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::simd::Simd;

    #[inline(always)]
    fn squares_body<const FMA: bool>(numbers: &[f64; 64], out: &mut [f64; 64]) {
        for lane in 0..64 {
            out[lane] = multiply_add::<FMA>(numbers[lane], numbers[lane], 1.0);
        }
    }
    multiversion_loops! { fn squares(numbers: &[f64; 64], out: &mut [f64; 64]) = squares_body }

    #[test]
    fn every_instruction_set_of_this_machine_gives_the_same_answer() {
        let numbers = std::array::from_fn(|i| (i as f64).sin());
        for simd in Simd::all() {
            let mut out = [0.0; 64];
            squares(simd, &numbers, &mut out);
            for (number, square) in numbers.iter().zip(out) {
                assert!((number * number + 1.0 - square).abs() < 1e-15, "{simd:?}");
            }
        }
    }
}
