//! Handles that arrive.

use neuralmls_core::{Error, Pose, Remedy, Soft};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::deformer::{pose, transform};
use crate::errors::from_core;

/// Solves for effective targets.
#[pyclass(frozen)]
pub(crate) struct ExactHandles(neuralmls_core::Handles);

/// Effective targets m x d, how far each control point stays from where it was to go, and why they do not arrive: a reason, which
/// control point, how much.
type Aim<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>, Option<(&'static str, usize, f64)>);

#[pymethods]
impl ExactHandles {
    #[new]
    fn new(
        p: PyReadonlyArray2<'_, f64>,
        logits: PyReadonlyArray2<'_, f32>,
        transform: &str,
    ) -> PyResult<ExactHandles> {
        let transform = self::transform(transform)?;
        neuralmls_core::Handles::of_logits(
            p.as_slice()?,
            p.shape()[1],
            logits.as_slice()?.to_vec(),
            transform,
        )
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
        given(py, q, turns, |pose| self.0.aim(pose, temperature, &[adherence]))
    }

    fn aim_carefully<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray2<'py, f64>,
        turns: Option<PyReadonlyArray3<'py, f64>>,
        temperature: f64,
        adherence: f64,
    ) -> PyResult<Aim<'py>> {
        given(py, q, turns, |pose| self.0.aim_carefully(pose, temperature, &[adherence]))
    }

    /// A temperature, or none for the affine transform; none at all where neither helps.
    fn remedy(
        &self,
        py: Python<'_>,
        q: PyReadonlyArray2<'_, f64>,
        turns: Option<PyReadonlyArray3<'_, f64>>,
        temperature: f64,
        adherence: f64,
    ) -> PyResult<Option<(&'static str, Option<f64>)>> {
        let pose = pose(&q, turns.as_ref())?;
        let remedy = py
            .detach(|| self.0.remedy(pose, temperature, &[adherence]))
            .map_err(|error| from_core(error, None))?;
        Ok(remedy.map(|remedy| match remedy {
            Remedy::Temperature(other) => ("temperature", Some(other)),
            Remedy::Affine => ("affine", None),
        }))
    }
}

/// An aim of the core as Python takes it, computed without the GIL.
fn given<'py>(
    py: Python<'py>,
    q: PyReadonlyArray2<'py, f64>,
    turns: Option<PyReadonlyArray3<'py, f64>>,
    aimed: impl FnOnce(Pose<'_>) -> Result<neuralmls_core::Aim, Error> + Send,
) -> PyResult<Aim<'py>> {
    let (shape, pose) = ([q.shape()[0], q.shape()[1]], pose(&q, turns.as_ref())?);
    let aim = py.detach(|| aimed(pose)).map_err(|error| from_core(error, None))?;
    let soft = aim.soft.map(Soft::named);
    Ok((PyArray1::from_vec(py, aim.targets).reshape(shape)?, PyArray1::from_vec(py, aim.misses), soft))
}
