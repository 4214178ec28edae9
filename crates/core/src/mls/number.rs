//! Numbers that may carry how they change from place to place, so that a rule is written once for its value and its derivative.

use std::ops::{Add, AddAssign, Mul, Sub, SubAssign};

/// What moments are made of: [`f64`], or [`Dual`].
pub(super) trait Number:
    Copy
    + Add<Output = Self>
    + Add<f64, Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + AddAssign
    + SubAssign
{
    const ZERO: Self;

    fn value(self) -> f64;
}

impl Number for f64 {
    const ZERO: f64 = 0.0;

    fn value(self) -> f64 {
        self
    }
}

/// A number and its derivatives by the D coordinates of the place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Dual<const D: usize> {
    pub value: f64,
    pub slope: [f64; D],
}

impl<const D: usize> Number for Dual<D> {
    const ZERO: Dual<D> = Dual { value: 0.0, slope: [0.0; D] };

    fn value(self) -> f64 {
        self.value
    }
}

impl<const D: usize> Add for Dual<D> {
    type Output = Dual<D>;

    #[inline(always)]
    fn add(self, other: Dual<D>) -> Dual<D> {
        let slope = std::array::from_fn(|c| self.slope[c] + other.slope[c]);
        Dual { value: self.value + other.value, slope }
    }
}

impl<const D: usize> Add<f64> for Dual<D> {
    type Output = Dual<D>;

    #[inline(always)]
    fn add(self, other: f64) -> Dual<D> {
        Dual { value: self.value + other, ..self }
    }
}

impl<const D: usize> Sub for Dual<D> {
    type Output = Dual<D>;

    #[inline(always)]
    fn sub(self, other: Dual<D>) -> Dual<D> {
        let slope = std::array::from_fn(|c| self.slope[c] - other.slope[c]);
        Dual { value: self.value - other.value, slope }
    }
}

impl<const D: usize> Mul for Dual<D> {
    type Output = Dual<D>;

    #[inline(always)]
    #[allow(clippy::suspicious_arithmetic_impl)] // The product rule.
    fn mul(self, other: Dual<D>) -> Dual<D> {
        let slope = std::array::from_fn(|c| self.slope[c] * other.value + self.value * other.slope[c]);
        Dual { value: self.value * other.value, slope }
    }
}

impl<const D: usize> Mul<f64> for Dual<D> {
    type Output = Dual<D>;

    #[inline(always)]
    fn mul(self, other: f64) -> Dual<D> {
        Dual { value: self.value * other, slope: self.slope.map(|s| s * other) }
    }
}

impl<const D: usize> AddAssign for Dual<D> {
    #[inline(always)]
    fn add_assign(&mut self, other: Dual<D>) {
        *self = *self + other;
    }
}

impl<const D: usize> SubAssign for Dual<D> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Dual<D>) {
        *self = *self - other;
    }
}
