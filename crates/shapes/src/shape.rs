//! A shape read from a file, and the way back.

use crate::bounds::Bounds;
use crate::document::{Document, Fact, Moved, Parsed, SideFiles, Written};
use crate::error::Error;
use crate::format::Format;
use crate::{gltf, memory, normals, npy, obj, off, ply, stl, table};

/// A shape read from a file: positions, a triangulated view of the faces, and everything else as it was.
///
/// ```
/// use neuralmls_shapes::{Format, Shape};
/// let file = b"# a triangle\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
/// let shape = Shape::read(file.to_vec(), Format::Obj, &|_| Err("no side files here".into())).unwrap();
/// assert_eq!(shape.faces(), Some(&[[0, 1, 2]][..]));
/// assert_eq!(shape.write(shape.positions(), None).unwrap().bytes, file);
/// let mut moved = shape.positions().to_vec();
/// moved[2] = 0.5;
/// let written = shape.write(&moved, None).unwrap();
/// assert!(written.bytes.starts_with(b"# a triangle\nv 0 0 0.5"));
/// ```
pub struct Shape {
    source: Vec<u8>,
    format: Format,
    dim: usize,
    positions: Vec<f64>,
    faces: Option<Vec<[u32; 3]>>,
    facts: Vec<Fact>,
    document: Box<dyn Document>,
    bounds: Bounds,
    /// The ending of the file's own name, without the dot.
    extension: Option<String>,
}

impl Shape {
    /// Reads a file whose format is told by its content, or by its ending (`"obj"`) where that does not tell.
    ///
    /// # Errors
    /// As [`Format::sniff`] and [`Shape::read`].
    pub fn open(
        source: Vec<u8>,
        extension: Option<&str>,
        side_files: &SideFiles<'_>,
    ) -> Result<Shape, Error> {
        let format = Format::sniff(&source, extension)?;
        let shape = Shape::read(source, format, side_files)?;
        Ok(Shape { extension: extension.map(str::to_lowercase), ..shape })
    }

    /// Reads a file of the given format.
    ///
    /// # Errors
    /// One sentence with the line or byte, for a file that is broken, that uses what this crate does not read, that has a
    /// position that is not finite, or no position at all.
    pub fn read(source: Vec<u8>, format: Format, side_files: &SideFiles<'_>) -> Result<Shape, Error> {
        if source.is_empty() {
            return Err(Error::malformed("the file is empty"));
        }
        let Parsed { dim, positions, faces, facts, document } = match format {
            Format::Obj => obj::read(&source)?,
            Format::Ply => ply::read(&source)?,
            Format::Off => off::read(&source)?,
            Format::Stl => stl::read(&source)?,
            Format::Gltf => gltf::read_gltf(&source, side_files)?,
            Format::Glb => gltf::read_glb(&source, side_files)?,
            Format::Table => table::read(&source)?,
            Format::Npy => npy::read(&source)?,
        };
        if positions.is_empty() {
            return Err(Error::malformed(format!(
                "the {} file has no vertices, expected at least one",
                format.name()
            )));
        }
        debug_assert_eq!(positions.len() % dim, 0);
        let bounds = Bounds::of(&positions, dim);
        Ok(Shape { source, format, dim, positions, faces, facts, document, bounds, extension: None })
    }

    /// The format that it was read as.
    pub fn format(&self) -> Format {
        self.format
    }

    /// The endings that the file may have when it is written, without the dot, in lower case: those of its format, and its own.
    pub fn extensions(&self) -> Vec<&str> {
        let known = self.format.extensions();
        let own = self.extension.as_deref().filter(|own| !known.contains(own));
        known.iter().copied().chain(own).collect()
    }

    /// Coordinates a position (3, or 1 or 2 for tables of numbers).
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// The positions, `dim` numbers each, in file order.
    pub fn positions(&self) -> &[f64] {
        &self.positions
    }

    /// The box of the positions: least and greatest corner.
    pub fn bounds(&self) -> (&[f64], &[f64]) {
        (&self.bounds.low, &self.bounds.high)
    }

    /// Points as the file holds them once it is written: 32-bit floats, digits, whole numbers. As many points as the shape has
    /// positions are taken for these, and become exactly what reading the written file gives; others are places anywhere, as a vertex there would be.
    ///
    /// ```
    /// use neuralmls_shapes::{Format, Shape};
    /// let mut stl = vec![0u8; 134];
    /// stl[80] = 1;
    /// stl[96..100].copy_from_slice(&5e6f32.to_le_bytes());
    /// let shape = Shape::read(stl, Format::Stl, &|_| Err("none".into())).unwrap();
    /// assert_eq!(shape.round(&[5e6 + 0.05, 0.0, 0.0]).unwrap(), [5e6, 0.0, 0.0]);
    /// assert_eq!(shape.step().unwrap(), 0.5);
    /// ```
    ///
    /// # Errors
    /// Where the number of coordinates does not fit, one is not finite, or the file cannot hold one.
    pub fn round(&self, points: &[f64]) -> Result<Vec<f64>, Error> {
        if !points.len().is_multiple_of(self.dim) {
            let (dim, found) = (self.dim, points.len());
            return Err(Error::argument(format!(
                "expected points of {dim} coordinates, found {found} numbers"
            )));
        }
        self.check_finite(points)?;
        self.document.round(&self.positions, points, self.dim)
    }

    /// The largest distance between neighbouring numbers of the file's type at the shape's coordinates, in the shape's units;
    /// 0 where the file holds doubles, or text, which is printed as precisely as the shape needs.
    ///
    /// # Errors
    /// Where memory runs out.
    pub fn step(&self) -> Result<f64, Error> {
        self.document.step(&self.bounds.largest())
    }

    /// The faces as triangles, `None` where the file has none.
    pub fn faces(&self) -> Option<&[[u32; 3]]> {
        self.faces.as_deref()
    }

    /// What else is in the file, for a person to read.
    pub fn facts(&self) -> &[Fact] {
        &self.facts
    }

    /// Whether [`Shape::write`] turns normals or tangents, so that passing the local maps is worth it.
    pub fn has_normals(&self) -> bool {
        self.document.has_normals()
    }

    /// Files beside this one that it names, by their relative paths: buffers, images, material libraries.
    pub fn named_files(&self) -> Vec<String> {
        self.document.named_files()
    }

    /// Those of the named files that are missing, as the shape calls them, where only those that `is_there` says are there.
    pub fn missing_files(&self, is_there: &dyn Fn(&str) -> bool) -> Vec<String> {
        self.document.missing_files(is_there)
    }

    /// The side files that [`Shape::write_as`] may write for other positions, as it calls them after `stem`: those of a shape that
    /// moves as a whole. One of which only some vertices move may need fewer.
    pub fn side_files(&self, stem: &str) -> Vec<String> {
        self.document.side_files(stem)
    }

    /// The same file with other positions, its side files under their own names.
    ///
    /// # Errors
    /// As [`Shape::write_as`].
    pub fn write(&self, positions: &[f64], maps: Option<&[f64]>) -> Result<Written, Error> {
        self.write_as(positions, maps, None)
    }

    /// The same file with other positions. Side files that change are called after `stem` if given (`"bent"`: `bent.bin`,
    /// `bent-2.bin` ...), so that those of the original need not be overwritten.
    ///
    /// `maps` holds a row-major `dim x dim` local map a position, by whose inverse transpose the normals turn. Without
    /// it, normals turn as the faces around each position do; a cloud without maps keeps its normals.
    ///
    /// # Errors
    /// Where the lengths do not fit the shape, or a position is not finite.
    pub fn write_as(
        &self,
        positions: &[f64],
        maps: Option<&[f64]>,
        stem: Option<&str>,
    ) -> Result<Written, Error> {
        let (before, dim) = (&self.positions, self.dim);
        if positions.len() != before.len() {
            return Err(Error::argument(format!(
                "expected {} positions of {dim} coordinates, found {} numbers",
                before.len() / dim,
                positions.len()
            )));
        }
        if maps.is_some_and(|maps| maps.len() != before.len() * dim) {
            return Err(Error::argument(format!("expected a {dim} x {dim} map for each position")));
        }
        self.check_finite(positions)?;
        if positions == before {
            return Ok(Written { bytes: memory::copy(&self.source)?, side_files: Vec::new() });
        }
        let estimated = match (maps, &self.faces) {
            (None, Some(faces)) if self.has_normals() && dim == 3 => {
                Some(normals::maps_from_faces(before, positions, faces)?)
            }
            _ => None,
        };
        let moved = Moved { before, after: positions, maps: maps.or(estimated.as_deref()), stem };
        self.document.write(&self.source, &moved)
    }

    fn check_finite(&self, points: &[f64]) -> Result<(), Error> {
        match points.iter().position(|c| !c.is_finite()) {
            Some(at) => Err(Error::argument(format!("position {} is not finite", at / self.dim))),
            None => Ok(()),
        }
    }
}
