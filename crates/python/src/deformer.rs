//! Points bound to their logits.

use neuralmls_core::memory::copy_of;
use neuralmls_core::{Pose, Transform};
use numpy::{PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::errors::{argument, from_core};
use crate::progress::run;
use crate::weights::{Network, PointTree};

/// Deforms bound points.
#[pyclass(frozen)]
pub(crate) struct Deformer {
    inner: neuralmls_core::Deformer,
    dim: usize,
}

/// Positions n x d, and the maps n x d x d where they were asked for.
type Deformed<'py> = (Bound<'py, PyArray2<f64>>, Option<Bound<'py, PyArray3<f64>>>);

/// Targets, and turns where there are any, as the core takes them.
pub(crate) fn pose<'a>(
    q: &'a PyReadonlyArray2<'_, f64>,
    turns: Option<&'a PyReadonlyArray3<'_, f64>>,
) -> PyResult<Pose<'a>> {
    let turns = turns.map(|turns| turns.as_slice()).transpose()?;
    Ok(Pose { q: q.as_slice()?, orientations: turns })
}

/// A transform by its name.
pub(crate) fn transform(name: &str) -> PyResult<Transform> {
    match name {
        "rigid" => Ok(Transform::Rigid),
        "similarity" => Ok(Transform::Similarity),
        "affine" => Ok(Transform::Affine),
        other => {
            let expected = "expected 'rigid', 'similarity' or 'affine'";
            Err(argument(format!("transform: {expected}, found '{other}'")))
        }
    }
}

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
        let transform = self::transform(transform)?;
        let (x, p, logits) = (x.as_slice()?, p.as_slice()?, logits.as_slice()?);
        let bound = || neuralmls_core::Deformer::of_logits(copy_of(x)?, dim, p, copy_of(logits)?, transform);
        let inner = bound().map_err(|error| from_core(error, None))?;
        Ok(Deformer { inner, dim })
    }

    /// Binds points to the logits of a network, which are not copied; with a tree of the points, where there is one.
    #[staticmethod]
    #[allow(clippy::too_many_arguments)]
    fn of_network(
        py: Python<'_>,
        x: PyReadonlyArray2<'_, f64>,
        p: PyReadonlyArray2<'_, f64>,
        network: &Network,
        tree: Option<&PointTree>,
        transform: &str,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Deformer> {
        let dim = x.shape()[1];
        let transform = self::transform(transform)?;
        let (x, p) = (x.as_slice()?, p.as_slice()?);
        let inner = run(py, progress, |report| {
            let logits = match tree {
                Some(tree) => network.0.logits_of_tree(&tree.0, report)?,
                None => network.0.logits(x, report)?,
            };
            neuralmls_core::Deformer::of_logits(copy_of(x)?, dim, p, logits, transform)
        })?;
        Ok(Deformer { inner, dim })
    }

    /// Computes the weights at a temperature.
    fn prepare(&self, py: Python<'_>, temperature: f64) -> PyResult<()> {
        py.detach(|| self.inner.prepare(temperature)).map_err(|error| from_core(error, None))
    }

    /// Writes the positions into `out`, n x d, or into a new array.
    #[pyo3(signature = (q, turns, temperature, maps, out, progress))]
    #[allow(clippy::too_many_arguments)]
    fn deform<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray2<'py, f64>,
        turns: Option<PyReadonlyArray3<'py, f64>>,
        temperature: f64,
        maps: bool,
        out: Option<Bound<'py, PyArray2<f64>>>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Deformed<'py>> {
        let (n, d) = (self.inner.len(), self.dim);
        let pose = pose(&q, turns.as_ref())?;
        let positions = out.unwrap_or_else(|| PyArray2::zeros(py, [n, d], false));
        let maps = maps.then(|| PyArray3::zeros(py, [n, d, d], false));
        {
            // Refused if anything else reads or writes it meanwhile.
            let mut y = positions.try_readwrite()?;
            let y = y.as_slice_mut()?;
            let mut m = maps.as_ref().map(|maps| maps.try_readwrite()).transpose()?;
            let m = m.as_mut().map(|maps| maps.as_slice_mut()).transpose()?;
            run(py, progress, |report| self.inner.deform_into(pose, temperature, y, m, report))?;
        }
        Ok((positions, maps))
    }
}
