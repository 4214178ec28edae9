//! Why something was refused.

use std::fmt;

/// What was wrong: which exception it becomes, in languages that have them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ErrorKind {
    /// A file is not what it should be.
    File,
    /// Control points that cannot be used, however they came.
    ControlPoint,
    /// An argument is out of its range.
    Argument,
    /// There is not enough memory.
    Memory,
    /// The caller's progress function asked to stop.
    Cancelled,
}

/// A refusal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error {
    /// What was wrong.
    pub kind: ErrorKind,
    /// One sentence, without the file's name: the caller puts it before.
    pub message: String,
}

impl Error {
    pub(crate) fn file(message: impl Into<String>) -> Self {
        Error { kind: ErrorKind::File, message: message.into() }
    }

    pub(crate) fn control_point(message: impl Into<String>) -> Self {
        Error { kind: ErrorKind::ControlPoint, message: message.into() }
    }

    pub(crate) fn argument(message: impl Into<String>) -> Self {
        Error { kind: ErrorKind::Argument, message: message.into() }
    }

    /// The same, as what is wrong with a file at a place.
    pub(crate) fn at(self, place: &str) -> Self {
        Error::file(format!("{place}: {}", self.message))
    }
}

impl From<neuralmls_core::Error> for Error {
    fn from(error: neuralmls_core::Error) -> Self {
        let kind = match error {
            neuralmls_core::Error::Argument { .. } => ErrorKind::Argument,
            neuralmls_core::Error::Memory => ErrorKind::Memory,
            neuralmls_core::Error::Cancelled => ErrorKind::Cancelled,
        };
        Error { kind, message: error.to_string() }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Error {}
