//! Vectorised kernels (SIMD): one kernel, compiled for several instruction sets, the best of which is chosen when it runs.
//!
//! A kernel is written once over [`Lanes`], sixteen numbers in registers, and `#[inline(always)]`. [`multiversion!`] compiles it
//! for each instruction set and calls the version that was detected.
//!
//! Why that is safe: the types of wide registers are private to this folder. [`Simd::choose`] alone names them, each for kernels that are compiled
//! for its instruction set; and a [`Simd`] that stands for it is made by detection alone. So no code can make such a value, or call such
//! a kernel, on a machine that has not got the registers.
//!
//! Plain arrays of 16 in place of intrinsics were tried: the compiler turns nested loops over them into gathers. Kernels that are one
//! loop over lanes, without a nested one, need no intrinsics: [`loops`].

mod doubles;
mod lanes;
pub(crate) mod loops;
mod numbers;

pub(crate) use doubles::{Doubles, WIDEST};
#[cfg(test)]
pub(crate) use lanes::Portable;
pub(crate) use lanes::{prefetch, Aligned, Lanes, WIDTH};
pub(crate) use numbers::{minor, square_of, Numbers};

/// An instruction set that this machine has: a token that detection alone makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Simd(InstructionSet);

/// What kernels are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))] // The others are made nowhere else.
pub(crate) enum InstructionSet {
    /// What every machine of the target has.
    Portable,
    /// 256 bits with fused multiply-add (x86-64-v3).
    Avx2,
    /// 512 bits (x86-64-v4).
    Avx512,
}

use InstructionSet::{Avx2, Portable as Every};

impl Simd {
    /// The best that this machine has; the environment variable `NEURALMLS_SIMD` (portable, avx2) asks for less.
    pub(crate) fn detect() -> Simd {
        let best = best();
        Simd(match std::env::var("NEURALMLS_SIMD").as_deref() {
            Ok("portable") => Every,
            Ok("avx2") => best.min(Avx2),
            _ => best,
        })
    }

    /// All that this machine has, for tests of a kernel on each.
    #[cfg(test)]
    pub(crate) fn all() -> impl Iterator<Item = Simd> {
        [Every, Avx2, InstructionSet::Avx512].into_iter().filter(|set| *set <= best()).map(Simd)
    }

    /// Which one it is.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(crate) fn set(self) -> InstructionSet {
        self.0
    }

    /// The version of a kernel for it: this machine has what that is compiled for.
    #[inline(always)]
    pub(crate) fn choose<K: Kernel>(self) -> K::Call {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 => K::avx512::<lanes::Avx512>(),
            #[cfg(target_arch = "x86_64")]
            Avx2 => K::avx2::<lanes::Avx2>(),
            _ => K::portable::<lanes::Portable>(),
        }
    }
}

#[cfg(target_arch = "x86_64")]
fn best() -> InstructionSet {
    let avx512 = is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl");
    if !(is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")) {
        Every
    } else if avx512 {
        InstructionSet::Avx512
    } else {
        Avx2
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn best() -> InstructionSet {
    Every
}

/// The versions of one kernel, as [`multiversion!`] makes them.
pub(crate) trait Kernel {
    /// Pointers to them, which may be called where the instruction set is.
    type Call;

    fn portable<L: Lanes>() -> Self::Call;
    /// Compiled for AVX2 and fused multiply-add.
    #[cfg(target_arch = "x86_64")]
    fn avx2<L: Lanes>() -> Self::Call;
    /// Compiled for AVX-512 (F, BW, DQ, VL) too.
    #[cfg(target_arch = "x86_64")]
    fn avx512<L: Lanes>() -> Self::Call;
}

/// Defines `fn name(simd: Simd, arguments...)`, which calls the kernel `body::<L: Lanes>(arguments...)` compiled for `simd`.
macro_rules! multiversion {
    ($(#[$meta:meta])* $vis:vis fn $name:ident($($arg:ident: $type:ty),* $(,)?) $(-> $result:ty)? = $body:ident) => {
        $(#[$meta])*
        #[allow(clippy::too_many_arguments)]
        $vis fn $name(simd: $crate::machine::simd::Simd, $($arg: $type),*) $(-> $result)? {
            struct Versions;
            #[allow(clippy::type_complexity)]
            impl $crate::machine::simd::Kernel for Versions {
                type Call = unsafe fn($($type),*) $(-> $result)?;

                fn portable<L: $crate::machine::simd::Lanes>() -> Self::Call {
                    $body::<L>
                }
                #[cfg(target_arch = "x86_64")]
                fn avx2<L: $crate::machine::simd::Lanes>() -> Self::Call {
                    #[target_feature(enable = "avx2,fma")]
                    fn compiled<L: $crate::machine::simd::Lanes>($($arg: $type),*) $(-> $result)? {
                        $body::<L>($($arg),*)
                    }
                    compiled::<L>
                }
                #[cfg(target_arch = "x86_64")]
                fn avx512<L: $crate::machine::simd::Lanes>() -> Self::Call {
                    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma")]
                    fn compiled<L: $crate::machine::simd::Lanes>($($arg: $type),*) $(-> $result)? {
                        $body::<L>($($arg),*)
                    }
                    compiled::<L>
                }
            }
            // SAFETY: a `Simd` is made by detection alone: this machine has what the chosen version is compiled for.
            unsafe { simd.choose::<Versions>()($($arg),*) }
        }
    };
}
pub(crate) use multiversion;

#[cfg(test)]
mod tests {
    use super::*;

    /// Every operation of [`Lanes`] on two arrays.
    #[inline(always)]
    fn all_body<L: Lanes>(a: &[f32; WIDTH], b: &[f32; WIDTH]) -> Vec<[f32; WIDTH]> {
        let (x, y) = (L::load(a), L::load(b));
        let results = [
            x.add(y),
            x.sub(y),
            x.mul(y),
            x.div(y),
            x.mul_add(y, L::splat(0.5)),
            x.mul_sub_from(y, L::splat(0.5)),
            x.max(y),
            y.inverse_sqrt(),
            y.sqrt(),
            y.inverse(),
            x.abs(),
            L::select(x.less(y), x, y),
            L::splat(x.total()),
        ];
        results.map(L::store).to_vec()
    }
    multiversion! { fn all(a: &[f32; WIDTH], b: &[f32; WIDTH]) -> Vec<[f32; WIDTH]> = all_body }

    #[inline(always)]
    fn permuted_body<L: Lanes>(a: &[f32; WIDTH], places: &[u32; WIDTH]) -> [f32; WIDTH] {
        L::load(a).permute(L::places(places)).store()
    }
    multiversion! { fn permuted(a: &[f32; WIDTH], places: &[u32; WIDTH]) -> [f32; WIDTH] = permuted_body }

    #[inline(always)]
    fn compressed_body<L: Lanes>(a: &[f32; WIDTH], bits: u32, to: &mut [f32; WIDTH]) {
        L::load(a).compress(bits, to);
    }
    multiversion! { fn compressed(a: &[f32; WIDTH], bits: u32, to: &mut [f32; WIDTH]) = compressed_body }

    #[test]
    fn the_lanes_of_some_bits_are_stored_side_by_side() {
        let a = std::array::from_fn(|i| i as f32);
        for simd in Simd::all() {
            for bits in (0..=0xffff).step_by(51) {
                let mut to = [-1.0; WIDTH];
                compressed(simd, &a, bits, &mut to);
                let expected: Vec<f32> = (0..16).filter(|i| bits >> i & 1 == 1).map(|i| i as f32).collect();
                assert_eq!(to[..expected.len()], expected, "{simd:?}, {bits:b}");
            }
        }
    }

    #[inline(always)]
    fn smaller_body<L: Lanes>(a: &[f32; WIDTH], b: &[f32; WIDTH]) -> u32 {
        L::bits(L::load(a).less(L::load(b)))
    }
    multiversion! { fn smaller(a: &[f32; WIDTH], b: &[f32; WIDTH]) -> u32 = smaller_body }

    #[inline(always)]
    fn first_body<L: Lanes>(a: &[f32; WIDTH], to: &mut [f32]) {
        L::load(a).store_first(to);
    }
    multiversion! { fn first(a: &[f32; WIDTH], to: &mut [f32]) = first_body }

    #[test]
    fn the_first_lanes_are_stored_and_nothing_beyond_them() {
        let a = std::array::from_fn(|i| i as f32 + 1.0);
        for simd in Simd::all() {
            for room in 0..20 {
                let mut to = [0.0; 20];
                first(simd, &a, &mut to[..room]);
                let expected = std::array::from_fn(|i| if i < room.min(WIDTH) { a[i] } else { 0.0 });
                assert_eq!(to, expected, "{simd:?}, room for {room}");
            }
        }
    }

    #[test]
    fn every_instruction_set_of_this_machine_gives_the_same_answers() {
        let a = std::array::from_fn(|i| (i as f32 * 0.7).sin());
        let b = std::array::from_fn(|i| (i as f32 * 1.3).cos() + 2.0);
        let operations: [fn(f32, f32) -> f32; 12] = [
            |a, b| a + b,
            |a, b| a - b,
            |a, b| a * b,
            |a, b| a / b,
            |a, b| a * b + 0.5,
            |a, b| 0.5 - a * b,
            f32::max,
            |_, b| 1.0 / b.sqrt(),
            |_, b| b.sqrt(),
            |_, b| 1.0 / b,
            |a, _| a.abs(),
            |a, b| if a < b { a } else { b },
        ];
        for simd in Simd::all() {
            let results = all(simd, &a, &b);
            for (k, operation) in operations.iter().enumerate() {
                for i in 0..WIDTH {
                    let expected = operation(a[i], b[i]);
                    assert!((results[k][i] - expected).abs() <= 1e-6, "{simd:?}, operation {k}, lane {i}");
                }
            }
            let places = std::array::from_fn(|i| ((5 * i + 3) % WIDTH) as u32);
            let bits = smaller(simd, &a, &b.map(|b| b - 2.0));
            for i in 0..WIDTH {
                assert_eq!(bits >> i & 1 == 1, a[i] < b[i] - 2.0, "{simd:?}, lane {i}");
            }
            assert_eq!(permuted(simd, &a, &places), places.map(|i| a[i as usize]), "{simd:?}");
            assert!((results[12][0] - a.iter().sum::<f32>()).abs() < 1e-5, "{simd:?}");
        }
    }
}
