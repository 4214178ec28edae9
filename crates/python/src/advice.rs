//! What is likely bad about a deformation.

use neuralmls_core::{Better, Kind};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::deformer::{pose, transform};
use crate::errors::from_core;

/// Places on a shape, bound to the weights of control points.
#[pyclass(frozen)]
pub(crate) struct Probe {
    probe: neuralmls_core::Probe,
    dim: usize,
}

/// A kind, how bad, the worst place, the two control points next to it, and what is better: another temperature, or none for soft
/// handles, with the part of the places that is left.
type Advice = (&'static str, f64, usize, [usize; 2], Option<(Option<f64>, f64)>);
/// Where places go, their determinants and stretches.
type Look<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

#[pymethods]
impl Probe {
    /// Where the weight function has to be asked.
    #[staticmethod]
    fn points<'py>(places: PyReadonlyArray2<'py, f64>, side: f64) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let dim = places.shape()[1];
        let points = neuralmls_core::Probe::points(places.as_slice()?, dim, side);
        let count = points.len() / dim;
        PyArray1::from_vec(places.py(), points).reshape([count, dim])
    }

    #[new]
    fn new(
        p: PyReadonlyArray2<'_, f64>,
        places: PyReadonlyArray2<'_, f64>,
        side: f64,
        logits: PyReadonlyArray2<'_, f32>,
        own_logits: PyReadonlyArray2<'_, f32>,
        transform: &str,
        careful: bool,
    ) -> PyResult<Probe> {
        let dim = p.shape()[1];
        neuralmls_core::Probe::of_logits(
            p.as_slice()?,
            dim,
            places.as_slice()?,
            side,
            logits.as_slice()?.to_vec(),
            own_logits.as_slice()?.to_vec(),
            self::transform(transform)?,
            careful,
        )
        .map(|probe| Probe { probe, dim })
        .map_err(|error| from_core(error, None))
    }

    fn advise(
        &self,
        py: Python<'_>,
        q: PyReadonlyArray2<'_, f64>,
        turns: Option<PyReadonlyArray3<'_, f64>>,
        temperature: f64,
        adherence: f64,
    ) -> PyResult<Vec<Advice>> {
        let pose = pose(&q, turns.as_ref())?;
        let found = py.detach(|| self.probe.advise(pose, temperature, &[adherence]));
        let named = |advice: neuralmls_core::Advice| {
            let (kind, amount) = match advice.kind {
                Kind::Folds(part) => ("folds", part),
                Kind::Torn(stretch) => ("torn", stretch),
                Kind::Ungoverned(far) => ("ungoverned", far),
            };
            let better = advice.better.map(|(better, part)| match better {
                Better::Temperature(other) => (Some(other), part),
                Better::Soft => (None, part),
            });
            (kind, amount, advice.place, advice.near, better)
        };
        Ok(found.map_err(|error| from_core(error, None))?.into_iter().map(named).collect())
    }

    /// The part of the places that is folded, and the part that is torn.
    fn parts(
        &self,
        py: Python<'_>,
        q: PyReadonlyArray2<'_, f64>,
        turns: Option<PyReadonlyArray3<'_, f64>>,
        temperature: f64,
        adherence: f64,
    ) -> PyResult<(f64, f64)> {
        let pose = pose(&q, turns.as_ref())?;
        py.detach(|| self.probe.parts(pose, temperature, &[adherence]))
            .map_err(|error| from_core(error, None))
    }

    fn look<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray2<'py, f64>,
        turns: Option<PyReadonlyArray3<'py, f64>>,
        temperature: f64,
        adherence: f64,
    ) -> PyResult<Look<'py>> {
        let pose = pose(&q, turns.as_ref())?;
        let look = py.detach(|| self.probe.look(pose, temperature, &[adherence]));
        let look = look.map_err(|error| from_core(error, None))?;
        let count = look.determinants.len();
        Ok((
            PyArray1::from_vec(py, look.positions).reshape([count, self.dim])?,
            PyArray1::from_vec(py, look.determinants),
            PyArray1::from_vec(py, look.stretches),
        ))
    }

    /// How far each place is from the nearest control point, in spacings of them.
    fn far<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.probe.far().into_iter().map(|(far, _)| far).collect())
    }
}
