//! What every format's module gives: the positions and faces that it found, and how to write them back.

use crate::error::Error;
use crate::shape::{Fact, Written};

/// The result of reading a file.
pub(crate) struct Parsed {
    /// Coordinates a position: 3, or 1 or 2 for tables of numbers (NPY, XYZ, CSV).
    pub dim: usize,
    /// The positions, `dim` numbers each, in file order; all finite.
    pub positions: Vec<f64>,
    /// Triangles (n-gons as fans), every index below the number of positions; `None` where the file has no faces.
    pub faces: Option<Vec<[u32; 3]>>,
    /// What else is in the file, for a person to read, in the order worth telling.
    pub facts: Vec<Fact>,
    /// How to write the file again.
    pub document: Box<dyn Document>,
}

/// Positions after a deformation, as [`Document::write`] gets them. Lengths are checked before.
pub(crate) struct Moved<'a> {
    /// Positions as they were read.
    pub before: &'a [f64],
    /// Positions now.
    pub after: &'a [f64],
    /// Row-major `dim x dim` local map of each position: the caller's, or estimated from the faces, or (a cloud without
    /// maps) none, and then normals stay as they are. Always given where possible if [`Document::has_normals`].
    pub maps: Option<&'a [f64]>,
    /// What side files that change are to be called, without ending; `None` to keep their names.
    pub stem: Option<&'a str>,
}

/// A file that was read, ready to be written again with other positions.
pub(crate) trait Document: Send + Sync {
    /// Whether the file holds normals or tangents, so that the local maps matter.
    fn has_normals(&self) -> bool;

    /// Files beside this one that it names: buffers, images, material libraries.
    fn named_files(&self) -> Vec<String> {
        Vec::new()
    }

    /// The side files that [`Document::write`] may write for a shape that moves, as they are called after `stem`.
    fn side_files(&self, _stem: &str) -> Vec<String> {
        Vec::new()
    }

    /// The file with the positions of `moved`. `source` is the file's bytes as they were read. Not called for a shape that did
    /// not move: that one's bytes are returned as they are.
    fn write(&self, source: &[u8], moved: &Moved<'_>) -> Result<Written, Error>;
}
