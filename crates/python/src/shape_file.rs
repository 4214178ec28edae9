//! Shapes read from bytes.

use std::collections::HashSet;

use neuralmls_shapes::{Error, Shape, SideFile};
use numpy::{Element, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors::from_shapes;

/// A shape read from the bytes of a file.
#[pyclass(frozen)]
pub(crate) struct ShapeFile(pub Shape);

/// The file's bytes, and its changed side files: the path that it names, the path that the original names, the bytes.
type Written<'py> = (Bound<'py, PyBytes>, Vec<(String, String, Bound<'py, PyBytes>)>);

#[pymethods]
impl ShapeFile {
    /// `extension` without its dot; `side_file` gives the bytes of a relative path, or raises.
    #[new]
    fn new(data: &[u8], extension: &str, side_file: Bound<'_, PyAny>) -> PyResult<ShapeFile> {
        let side_files = |path: &str| -> Result<Vec<u8>, String> {
            side_file
                .call1((path,))
                .and_then(|b| b.extract())
                .map_err(|error| error.value(side_file.py()).to_string())
        };
        Shape::open(copy(data)?, Some(extension), &side_files)
            .map(ShapeFile)
            .map_err(|error| from_shapes(&error))
    }

    /// The format's name: "OBJ", "PLY" ...
    #[getter]
    fn format(&self) -> &'static str {
        self.0.format().name()
    }

    /// The endings that the file may be written with, without the dot: those of its format and its own.
    #[getter]
    fn extensions(&self) -> Vec<&str> {
        self.0.extensions()
    }

    #[getter]
    fn facts(&self) -> Vec<(String, String)> {
        self.0.facts().to_vec()
    }

    #[getter]
    fn has_normals(&self) -> bool {
        self.0.has_normals()
    }

    /// n x d float64.
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, copy(self.0.positions())?, self.0.dim())
    }

    /// 2 x d float64: least and greatest corner.
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (low, high) = self.0.bounds();
        rows(py, [low, high].concat(), self.0.dim())
    }

    /// Points (n x d) as the file holds them once it is written.
    fn round<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let points = points.as_slice()?;
        let rounded = py.detach(|| self.0.round(points)).map_err(|error| from_shapes(&error))?;
        rows(py, rounded, self.0.dim())
    }

    /// The largest distance between neighbouring numbers of the file's type at the shape's coordinates.
    fn step(&self, py: Python<'_>) -> PyResult<f64> {
        py.detach(|| self.0.step()).map_err(|error| from_shapes(&error))
    }

    /// f x 3 uint32, or None.
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<u32>>>> {
        self.0.faces().map(|faces| rows(py, copy(faces.as_flattened())?, 3)).transpose()
    }

    /// Files beside this one that it names.
    #[getter]
    fn named_files(&self) -> Vec<String> {
        self.0.named_files()
    }

    /// Those of the named files that are missing, where only those of `found` are there.
    fn missing_files(&self, found: HashSet<String>) -> Vec<String> {
        self.0.missing_files(&|name| found.contains(name))
    }

    /// The side files that a moved shape may be written with, called after `stem`.
    fn side_files(&self, stem: &str) -> Vec<String> {
        self.0.side_files(stem)
    }

    /// The same file with other positions, its changed side files called after `stem`.
    #[pyo3(signature = (positions, maps, stem))]
    fn write<'py>(
        &self,
        py: Python<'py>,
        positions: PyReadonlyArray2<'py, f64>,
        maps: Option<PyReadonlyArray3<'py, f64>>,
        stem: Option<&str>,
    ) -> PyResult<Written<'py>> {
        let positions = positions.as_slice()?;
        let maps = maps.as_ref().map(|maps| maps.as_slice()).transpose()?;
        let written =
            py.detach(|| self.0.write_as(positions, maps, stem)).map_err(|error| from_shapes(&error))?;
        let side_file = |f: SideFile| Ok((f.name, f.was, bytes(py, &f.bytes)?));
        let side_files = written.side_files.into_iter().map(side_file).collect::<PyResult<_>>()?;
        Ok((bytes(py, &written.bytes)?, side_files))
    }
}

/// A copy, where there is memory for it.
fn copy<T: Copy>(items: &[T]) -> PyResult<Vec<T>> {
    let mut list = Vec::new();
    list.try_reserve_exact(items.len()).map_err(|_| from_shapes(&Error::memory()))?;
    list.extend_from_slice(items);
    Ok(list)
}

/// Numbers as an array of rows, without another copy.
fn rows<T: Element>(py: Python<'_>, numbers: Vec<T>, width: usize) -> PyResult<Bound<'_, PyArray2<T>>> {
    let count = numbers.len() / width;
    PyArray1::from_vec(py, numbers).reshape([count, width])
}

/// Bytes for Python, where there is memory for them.
fn bytes<'py>(py: Python<'py>, content: &[u8]) -> PyResult<Bound<'py, PyBytes>> {
    PyBytes::new_with(py, content.len(), |new| {
        new.copy_from_slice(content);
        Ok(())
    })
}
