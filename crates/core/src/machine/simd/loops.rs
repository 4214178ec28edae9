//! Kernels that are loops over lanes: `for lane in 0..64 { arithmetic on numbers[lane] }`.
//!
//! A loop whose body is straight arithmetic (choices as `if a { b } else { c }`, no calls, inner loops of constant length) is what compilers
//! turn into vector instructions without help, for single and double precision alike. [`multiversion_loops!`] compiles such a
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
        $crate::machine::simd::compiled! {
            $(#[$meta])* $vis fn $name($($arg: $type),*) = $body [false] [true] [true]
        }
    };
}
pub(crate) use multiversion_loops;

/// The instruction sets that this machine has, for tests of a kernel on each.
#[cfg(test)]
pub(crate) fn all() -> impl Iterator<Item = super::Simd> {
    use super::Simd;
    [Simd::Portable, Simd::Avx2, Simd::Avx512].into_iter().filter(|simd| *simd <= Simd::best())
}

#[cfg(test)]
mod tests {
    use super::*;

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
        for simd in all() {
            let mut out = [0.0; 64];
            squares(simd, &numbers, &mut out);
            for (number, square) in numbers.iter().zip(out) {
                assert!((number * number + 1.0 - square).abs() < 1e-15, "{simd:?}");
            }
        }
    }
}
