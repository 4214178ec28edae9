//! Points bound to their logits.

use neuralmls_core::Transform;
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::errors::{argument, from_core};
use crate::progress::run;

/// Deforms bound points.
#[pyclass(frozen)]
pub(crate) struct Deformer {
    inner: neuralmls_core::Deformer,
    dim: usize,
}

/// Positions n x d, and the maps n x d x d where they were asked for.
type Deformed<'py> = (Bound<'py, PyArray2<f64>>, Option<Bound<'py, PyArray3<f64>>>);

#[pymethods]
impl Deformer {
    #[new]
    fn new(
        x: PyReadonlyArray2<'_, f64>,
        p: PyReadonlyArray2<'_, f64>,
        logits: PyReadonlyArray2<'_, f32>,
        transform: &str,
    ) -> PyResult<Deformer> {
        let dim = x.shape()[1];
        let transform = match transform {
            "rigid" => Transform::Rigid,
            "similarity" => Transform::Similarity,
            "affine" => Transform::Affine,
            other => {
                let expected = "expected 'rigid', 'similarity' or 'affine'";
                return Err(argument(format!("transform: {expected}, found '{other}'")));
            }
        };
        let (x, p, logits) = (x.as_slice()?.to_vec(), p.as_slice()?, logits.as_slice()?.to_vec());
        let inner = neuralmls_core::Deformer::new(x, dim, p, logits, transform)
            .map_err(|error| from_core(error, None))?;
        Ok(Deformer { inner, dim })
    }

    #[pyo3(signature = (q, temperature, maps, progress))]
    fn deform<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray2<'py, f64>,
        temperature: f64,
        maps: bool,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Deformed<'py>> {
        let targets = q.as_slice()?;
        let deformed = run(py, progress, |report| self.inner.deform(targets, temperature, maps, report))?;
        let (n, d) = (self.inner.len(), self.dim);
        let positions = PyArray1::from_vec(py, deformed.positions).reshape([n, d])?;
        let maps = deformed.maps.map(|maps| PyArray1::from_vec(py, maps).reshape([n, d, d])).transpose()?;
        Ok((positions, maps))
    }
}
