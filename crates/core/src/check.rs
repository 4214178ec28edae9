//! Arguments that are checked everywhere in the same way.

use crate::error::Error;
use crate::machine::parallel::any;

/// Checks that `points` holds whole, finite points and gives their number.
pub(crate) fn check_points(name: &'static str, points: &[f64], dim: usize) -> Result<usize, Error> {
    if !(1..=3).contains(&dim) {
        return Err(Error::argument(name, format!("expected 1, 2 or 3 coordinates a point, found {dim}")));
    }
    if !points.len().is_multiple_of(dim) {
        return Err(Error::argument(name, format!("{} numbers are not whole points of {dim}", points.len())));
    }
    if any(points, |c| !c.is_finite()) {
        let at = points.iter().position(|c| !c.is_finite()).unwrap_or_default();
        return Err(Error::argument(name, format!("point {} has a coordinate that is not finite", at / dim)));
    }
    Ok(points.len() / dim)
}

/// Checks that a number lies in a range that a person can read.
pub(crate) fn check_number(name: &'static str, value: f64, ok: bool, expected: &str) -> Result<(), Error> {
    if ok && value.is_finite() {
        Ok(())
    } else {
        Err(Error::argument(name, format!("expected {expected}, found {value}")))
    }
}
