//! Handles that arrive.

use neuralmls_core::{Error, Pose, Soft};
use numpy::{PyArray1, PyArray2, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::arrays::table;
use crate::deformer::{pose, transform};
use crate::errors::from_core;

/// Solves for effective targets.
#[pyclass(frozen)]
pub(crate) struct Handles(pub neuralmls_core::Handles);

/// Effective targets m x d, how far each control point stays from where it was to go, and why they do not arrive: a reason, which
/// control point, how much.
type Aim<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>, Option<(&'static str, usize, f64)>);

#[pymethods]
impl Handles {
    /// Of the control points `p`, with the logits at their own places.
    #[new]
    fn new(
        p: PyReadonlyArray2<'_, f64>,
        logits: PyReadonlyArray2<'_, f32>,
        transform: &str,
    ) -> PyResult<Handles> {
        let transform = self::transform(transform)?;
        neuralmls_core::Handles::of_logits(
            p.as_slice()?,
            p.shape()[1],
            logits.as_slice()?.to_vec(),
            transform,
        )
        .map(Handles)
        .map_err(|error| from_core(error, None))
    }

    /// Adherence: one number, or one for each control point.
    #[pyo3(signature = (q, orientations, temperature, adherence, carefully))]
    fn aim<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray2<'py, f64>,
        orientations: Option<PyReadonlyArray3<'py, f64>>,
        temperature: f64,
        adherence: Vec<f64>,
        carefully: bool,
    ) -> PyResult<Aim<'py>> {
        let (dim, pose) = (q.shape()[1], pose(&q, orientations.as_ref())?);
        let aimed = |pose: Pose<'_>| -> Result<neuralmls_core::Aim, Error> {
            match carefully {
                true => self.0.aim_carefully(pose, temperature, &adherence),
                false => self.0.aim(pose, temperature, &adherence),
            }
        };
        let aim = py.detach(|| aimed(pose)).map_err(|error| from_core(error, None))?;
        Ok((table(py, aim.targets, dim)?, PyArray1::from_vec(py, aim.misses), aim.soft.map(Soft::named)))
    }

    /// With what the control points would arrive, in words; None where nothing that was tried helps.
    fn remedy(
        &self,
        py: Python<'_>,
        q: PyReadonlyArray2<'_, f64>,
        orientations: Option<PyReadonlyArray3<'_, f64>>,
        temperature: f64,
        adherence: Vec<f64>,
    ) -> PyResult<Option<String>> {
        let pose = pose(&q, orientations.as_ref())?;
        let remedy = py
            .detach(|| self.0.remedy(pose, temperature, &adherence))
            .map_err(|error| from_core(error, None))?;
        Ok(remedy.map(neuralmls_session::remedy_in_words))
    }
}
