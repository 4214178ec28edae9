//! The arithmetic of numbers side by side, single or double.

use std::ops::{Add, Mul, Sub};

/// Numbers side by side, and what is done with them in either precision.
pub(crate) trait Numbers: Copy {
    /// Which lanes.
    type Mask: Copy;

    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    /// `self * b + c`, rounded once where the instruction set can; so for the next one.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// `c - self * b`.
    fn mul_sub_from(self, b: Self, c: Self) -> Self;
    /// The lanes where `self < other`.
    fn less(self, other: Self) -> Self::Mask;
    /// `yes` in the lanes of the mask, `no` in the others.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
}

/// `a b - c d`.
#[inline(always)]
pub(crate) fn minor<N: Numbers>(a: N, b: N, c: N, d: N) -> N {
    c.mul_sub_from(d, a.mul(b))
}

/// The sum of the squares.
#[inline(always)]
pub(crate) fn square_of<N: Numbers, const K: usize>(of: &[N; K]) -> N {
    let mut sum = of[0].mul(of[0]);
    for number in &of[1..] {
        sum = number.mul_add(*number, sum);
    }
    sum
}

/// An array of them, for every machine.
#[derive(Clone, Copy)]
pub(crate) struct Array<T, const N: usize>(pub [T; N]);

impl<T: Copy, const N: usize> Array<T, N> {
    #[inline(always)]
    pub(super) fn zip(self, other: Self, f: impl Fn(T, T) -> T) -> Self {
        Array(std::array::from_fn(|l| f(self.0[l], other.0[l])))
    }
}

impl<T, const N: usize> Numbers for Array<T, N>
where
    T: Copy + PartialOrd + Add<Output = T> + Sub<Output = T> + Mul<Output = T>,
{
    type Mask = [bool; N];

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self.mul(b).add(c)
    }
    #[inline(always)]
    fn mul_sub_from(self, b: Self, c: Self) -> Self {
        c.sub(self.mul(b))
    }
    #[inline(always)]
    fn less(self, other: Self) -> Self::Mask {
        std::array::from_fn(|l| self.0[l] < other.0[l])
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Array(std::array::from_fn(|l| if mask[l] { yes.0[l] } else { no.0[l] }))
    }
}
