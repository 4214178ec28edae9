//! What of a coordinate arrives in a file.

use crate::error::Error;
use crate::memory;
use crate::number::Style;

/// How a file holds the coordinates of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Precision {
    /// 64-bit floats.
    Double,
    /// 32-bit floats.
    Single,
    /// Whole numbers.
    Whole,
    /// Text whose most precise coordinate had so many decimals.
    Digits(usize),
}

impl Precision {
    /// The distance from a number to the next that the file can hold; 0 for text, which is printed as precisely as it needs.
    pub(crate) fn step(self, at: f64) -> f64 {
        match self {
            Precision::Double | Precision::Digits(_) => 0.0,
            Precision::Whole => 1.0,
            Precision::Single => {
                let at = at.abs() as f32;
                if at < f32::MAX {
                    f64::from(at.next_up()) - f64::from(at)
                } else {
                    f64::from(f32::MAX) - f64::from(f32::MAX.next_down())
                }
            }
        }
    }
}

/// The nearest 32-bit float; the number itself where it is beyond their range, which a writer refuses.
pub(crate) fn single(value: f64) -> f64 {
    let single = value as f32;
    if single.is_finite() {
        single.into()
    } else {
        value
    }
}

/// See [`Document::round`](crate::document::Document::round).
pub(crate) fn round(
    precision: impl Fn(usize) -> Precision,
    before: &[f64],
    points: &[f64],
    dim: usize,
) -> Result<Vec<f64>, Error> {
    let moved = points.len() == before.len();
    let mut rounded = memory::copy(points)?;
    let mut style = None;
    for axis in 0..dim {
        let column = rounded.iter_mut().enumerate().skip(axis).step_by(dim);
        match precision(axis) {
            Precision::Double => {}
            Precision::Single => column.for_each(|(_, value)| *value = single(*value)),
            Precision::Whole => column.for_each(|(_, value)| *value = value.round()),
            Precision::Digits(decimals) => {
                let shape = if moved { points } else { before };
                let style: Style = *style.get_or_insert_with(|| Style::new(decimals, shape, dim));
                column.for_each(|(at, value)| {
                    *value = match before.get(at) {
                        Some(&was) if moved && !style.differs(was, *value) => was,
                        _ => style.rounded(*value),
                    };
                });
            }
        }
    }
    Ok(rounded)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_of_each_kind() {
        assert_eq!(Precision::Single.step(1.0), f64::from(f32::EPSILON));
        assert_eq!(Precision::Single.step(-5e6), 0.5);
        assert!(Precision::Single.step(1e300).is_finite() && Precision::Single.step(0.0) > 0.0);
        assert_eq!(Precision::Whole.step(7.0), 1.0);
        assert_eq!(Precision::Double.step(5e6) + Precision::Digits(2).step(5e6), 0.0);
    }

    #[test]
    fn each_axis_by_its_own_kind() {
        let kinds = [Precision::Double, Precision::Single, Precision::Whole];
        let rounded = round(|axis| kinds[axis], &[0.0; 6], &[0.1, 0.1, 0.6], 3).unwrap();
        assert_eq!(rounded, [0.1, f64::from(0.1f32), 1.0]);
        assert_eq!(single(1e300), 1e300);
    }

    #[test]
    fn what_moves_by_less_than_the_last_digit_stays() {
        let before = [0.123_456_789_012, 1.0];
        let digits = |_| Precision::Digits(1);
        assert_eq!(round(digits, &before, &[0.123_456_789, 1.25], 1).unwrap(), [before[0], 1.25]);
        assert_eq!(round(digits, &before, &[0.123_456_789], 1).unwrap(), [0.123_456_79]);
    }
}
