//! Shapes read from bytes.

use neuralmls_shapes::Shape;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3};
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
        Shape::open(data.to_vec(), Some(extension), &side_files)
            .map(ShapeFile)
            .map_err(|error| from_shapes(&error))
    }

    /// The format's name: "OBJ", "PLY" ...
    #[getter]
    fn format(&self) -> &'static str {
        self.0.format().name()
    }

    /// The endings of files of this format, without the dot.
    #[getter]
    fn extensions(&self) -> Vec<&'static str> {
        self.0.format().extensions().to_vec()
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
        let positions = self.0.positions();
        PyArray1::from_slice(py, positions).reshape([positions.len() / self.0.dim(), self.0.dim()])
    }

    /// f x 3 uint32, or None.
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<u32>>>> {
        let faces =
            |faces: &[[u32; 3]]| PyArray1::from_slice(py, faces.as_flattened()).reshape([faces.len(), 3]);
        self.0.faces().map(faces).transpose()
    }

    /// Files beside this one that it names.
    #[getter]
    fn named_files(&self) -> Vec<String> {
        self.0.named_files()
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
        let side_files =
            written.side_files.into_iter().map(|f| (f.name, f.was, PyBytes::new(py, &f.bytes))).collect();
        Ok((PyBytes::new(py, &written.bytes), side_files))
    }
}
