//! Handles that arrive.

use neuralmls_core::Pose;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::deformer::transform;
use crate::errors::from_core;

/// Solves for effective targets.
#[pyclass(frozen)]
pub(crate) struct ExactHandles(neuralmls_core::ExactHandles);

/// Effective targets m x d, and how far each control point stays from where it was to go.
type Aim<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>);

#[pymethods]
impl ExactHandles {
    #[new]
    fn new(
        p: PyReadonlyArray2<'_, f64>,
        logits: PyReadonlyArray2<'_, f32>,
        transform: &str,
    ) -> PyResult<ExactHandles> {
        let transform = self::transform(transform)?;
        neuralmls_core::ExactHandles::new(p.as_slice()?, p.shape()[1], logits.as_slice()?.to_vec(), transform)
            .map(ExactHandles)
            .map_err(|error| from_core(error, None))
    }

    fn aim<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray2<'py, f64>,
        turns: Option<PyReadonlyArray3<'py, f64>>,
        temperature: f64,
        adherence: f64,
    ) -> PyResult<Aim<'py>> {
        let turns = turns.as_ref().map(|turns| turns.as_slice()).transpose()?;
        let (shape, pose) = ([q.shape()[0], q.shape()[1]], Pose { q: q.as_slice()?, turns });
        let aim =
            py.detach(|| self.0.aim(pose, temperature, adherence)).map_err(|error| from_core(error, None))?;
        Ok((PyArray1::from_vec(py, aim.targets).reshape(shape)?, PyArray1::from_vec(py, aim.misses)))
    }
}
