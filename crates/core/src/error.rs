//! Why a computation was refused.

use std::fmt;

use crate::machine::parallel::any;

/// What can go wrong; each says it in one sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Error {
    /// An argument is out of its range, or does not fit another.
    Argument {
        /// The argument's name, as the symbols of the documentation have it.
        name: &'static str,
        /// What was expected and what was found.
        message: String,
    },
    /// The caller's progress function asked to stop.
    Cancelled,
    /// What grows with the number of points does not fit into memory.
    Memory,
}

impl Error {
    pub(crate) fn argument(name: &'static str, message: impl Into<String>) -> Self {
        Error::Argument { name, message: message.into() }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Argument { name, message } => write!(f, "{name}: {message}"),
            Error::Cancelled => f.write_str("cancelled"),
            Error::Memory => f.write_str("there is not enough memory for this"),
        }
    }
}

impl std::error::Error for Error {}

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
