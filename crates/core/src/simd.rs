//! One kernel, compiled for several instruction sets, the best of which is chosen when it runs.
//!
//! A kernel is plain Rust over arrays of 16 lanes, `#[inline(always)]`, with the constant `FMA` that says whether a fused
//! multiply-add is one instruction. [`multiversion!`] compiles it once for each instruction set; the compiler turns the
//! arrays into registers. No intrinsics, and the only `unsafe` is the call of a function whose instructions were detected.

pub(crate) mod loops;

/// An instruction set that kernels are compiled for. Its values come from [`Simd::detect`] alone, which is what makes [`multiversion!`]
/// sound.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Simd {
    /// What every machine of the target has.
    Portable,
    /// 256 bits with fused multiply-add (x86-64-v3).
    Avx2,
    /// 512 bits (x86-64-v4).
    Avx512,
}

impl Simd {
    /// The best that this machine has, or what the environment variable `NEURALMLS_SIMD` (portable, avx2, avx512) names, if
    /// this machine has that.
    pub(crate) fn detect() -> Simd {
        let best = Simd::best();
        let named = match std::env::var("NEURALMLS_SIMD").as_deref() {
            Ok("portable") => Simd::Portable,
            Ok("avx2") => Simd::Avx2,
            _ => best,
        };
        named.min(best)
    }

    #[cfg(target_arch = "x86_64")]
    fn best() -> Simd {
        if is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("fma")
        {
            Simd::Avx512
        } else if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
            Simd::Avx2
        } else {
            Simd::Portable
        }
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn best() -> Simd {
        Simd::Portable
    }
}

/// `a * b + c`, in one instruction where `FMA`.
#[inline(always)]
pub(crate) fn multiply_add<const FMA: bool>(a: f32, b: f32, c: f32) -> f32 {
    if FMA {
        a.mul_add(b, c)
    } else {
        a * b + c
    }
}

/// Defines `fn name(simd: Simd, arguments...)` that calls the kernel `body::<FMA>(arguments...)` compiled for `simd`.
macro_rules! multiversion {
    ($(#[$meta:meta])* fn $name:ident($($arg:ident: $type:ty),* $(,)?) $(-> $result:ty)? = $body:ident) => {
        $(#[$meta])*
        #[allow(clippy::too_many_arguments)]
        fn $name(simd: $crate::simd::Simd, $($arg: $type),*) $(-> $result)? {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt")]
                #[allow(clippy::too_many_arguments)]
                fn avx2($($arg: $type),*) $(-> $result)? {
                    $body::<true>($($arg),*)
                }
                #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt")]
                #[allow(clippy::too_many_arguments)]
                fn avx512($($arg: $type),*) $(-> $result)? {
                    $body::<true>($($arg),*)
                }
                match simd {
                    // SAFETY: `Simd` names an instruction set only where it was detected.
                    $crate::simd::Simd::Avx512 => return unsafe { avx512($($arg),*) },
                    // SAFETY: as above.
                    $crate::simd::Simd::Avx2 => return unsafe { avx2($($arg),*) },
                    $crate::simd::Simd::Portable => {}
                }
            }
            #[cfg(not(target_arch = "x86_64"))]
            let _ = simd;
            $body::<false>($($arg),*)
        }
    };
}
pub(crate) use multiversion;

#[cfg(test)]
mod tests {
    use super::*;

    #[inline(always)]
    fn dot_body<const FMA: bool>(a: &[f32], b: &[f32]) -> f32 {
        a.iter().zip(b).fold(0.0, |sum, (a, b)| multiply_add::<FMA>(*a, *b, sum))
    }
    multiversion! { fn dot(a: &[f32], b: &[f32]) -> f32 = dot_body }

    #[test]
    fn every_instruction_set_of_this_machine_gives_the_same_answer() {
        let a: Vec<f32> = (0..100).map(|i| (i as f32).sin()).collect();
        for simd in [Simd::Portable, Simd::Avx2, Simd::Avx512].into_iter().filter(|s| *s <= Simd::best()) {
            let expected: f32 = a.iter().map(|v| v * v).sum();
            assert!((dot(simd, &a, &a) - expected).abs() < 1e-4, "{simd:?}");
        }
    }
}
