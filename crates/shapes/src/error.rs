//! The one error of this crate: a sentence for a person, with the place in the file.

use std::fmt;

/// Where in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The line of a text file, counted from 1.
    Line(u64),
    /// The offset in a binary file, counted from 0.
    Byte(u64),
}

/// What a caller may want to tell apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// The bytes are not what the format demands.
    Malformed,
    /// The file is (probably) fine, but uses what we do not read; the message names it.
    Unsupported,
    /// A file beside this one (a glTF buffer) could not be had.
    SideFile,
    /// What the caller passed does not fit the shape (number of positions, size of the maps).
    Argument,
    /// There is not enough memory for what the file holds.
    Memory,
}

/// Why a shape could not be read or written: one sentence, without the file's name (which only the caller knows).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error {
    /// What sort of failure.
    pub kind: ErrorKind,
    /// Where in the file, if it is about a place.
    pub place: Option<Place>,
    /// What was wrong and what was expected; no capital letter at the start, no full stop at the end.
    pub message: String,
}

impl Error {
    /// Line `line` (from 1) of a text file is wrong.
    pub fn at_line(line: u64, message: impl Into<String>) -> Self {
        Error { kind: ErrorKind::Malformed, place: Some(Place::Line(line)), message: message.into() }
    }

    /// The bytes from offset `byte` on are wrong.
    pub fn at_byte(byte: u64, message: impl Into<String>) -> Self {
        Error { kind: ErrorKind::Malformed, place: Some(Place::Byte(byte)), message: message.into() }
    }

    /// The file as a whole is wrong.
    pub fn malformed(message: impl Into<String>) -> Self {
        Error { kind: ErrorKind::Malformed, place: None, message: message.into() }
    }

    /// The file uses what this crate does not read.
    pub fn unsupported(message: impl Into<String>) -> Self {
        Error { kind: ErrorKind::Unsupported, place: None, message: message.into() }
    }

    /// A file beside this one could not be had.
    pub fn side_file(message: impl Into<String>) -> Self {
        Error { kind: ErrorKind::SideFile, place: None, message: message.into() }
    }

    /// There is not enough memory for what the file holds.
    pub fn memory() -> Self {
        Error { kind: ErrorKind::Memory, place: None, message: "there is not enough memory for this".into() }
    }

    /// The caller's arguments do not fit the shape.
    pub fn argument(message: impl Into<String>) -> Self {
        Error { kind: ErrorKind::Argument, place: None, message: message.into() }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.place {
            Some(Place::Line(line)) => write!(f, "line {line}: {}", self.message),
            Some(Place::Byte(byte)) => write!(f, "byte {byte}: {}", self.message),
            None => f.write_str(&self.message),
        }
    }
}

impl std::error::Error for Error {}
