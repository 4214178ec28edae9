//! What every format's module gives: the positions and faces that it found, and how to write them back.

use crate::error::Error;
use crate::precision::{self, Precision};

/// Gives the bytes of a file beside the shape, by the relative path that the shape names (`"chair.bin"`).
pub type SideFiles<'a> = dyn Fn(&str) -> Result<Vec<u8>, String> + 'a;

/// One thing that a file holds, for a person to read: `("materials", "oak, steel")`.
pub type Fact = (String, String);

/// A file written anew.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// The file's bytes.
    pub bytes: Vec<u8>,
    /// Side files whose content changed too (the buffers of a `.gltf`).
    pub side_files: Vec<SideFile>,
}

/// A side file written anew.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SideFile {
    /// The relative path by which the written file names it.
    pub name: String,
    /// The relative path by which the original named it.
    pub was: String,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

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

    /// How the file holds the coordinates of an axis.
    fn precision(&self, axis: usize) -> Precision;

    /// Points (`dim` numbers each) as the file would hold them. As many as the shape has are its positions, moved; others are places
    /// anywhere, as a vertex there would be held.
    fn round(&self, before: &[f64], points: &[f64], dim: usize) -> Result<Vec<f64>, Error> {
        precision::round(|axis| self.precision(axis), before, points, dim)
    }

    /// The largest distance between neighbouring numbers of the file's type at the shape's coordinates, whose largest along
    /// each axis are `largest`; 0 where it holds doubles, or text.
    fn step(&self, largest: &[f64]) -> Result<f64, Error> {
        let steps = largest.iter().enumerate().map(|(axis, &at)| self.precision(axis).step(at));
        Ok(steps.fold(0.0, f64::max))
    }

    /// Files beside this one that it names: buffers, images, material libraries. All readings, where a name may be read in several ways.
    fn named_files(&self) -> Vec<String> {
        Vec::new()
    }

    /// Those of the named files that are missing where only those that `is_there` says are there.
    fn missing_files(&self, is_there: &dyn Fn(&str) -> bool) -> Vec<String> {
        self.named_files().into_iter().filter(|name| !is_there(name)).collect()
    }

    /// The side files that [`Document::write`] may write for a shape that moves, as they are called after `stem`.
    fn side_files(&self, _stem: &str) -> Vec<String> {
        Vec::new()
    }

    /// The file with the positions of `moved`. `source` is the file's bytes as they were read. Not called for a shape that did
    /// not move: that one's bytes are returned as they are.
    fn write(&self, source: &[u8], moved: &Moved<'_>) -> Result<Written, Error>;
}
