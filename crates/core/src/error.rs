//! Why a computation was refused.

use std::fmt;

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
    /// There is too little memory for what grows with the number of points.
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
