//! Points bound to their logits.

use neuralmls_core::memory::copy_of;
use neuralmls_core::progress::Progress;
use neuralmls_core::{Pose, Transform};
use neuralmls_session::Error as SessionError;
use numpy::{PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::arrays::table;
use crate::errors::{argument, from_core};
use crate::progress::{run, run_session};
use crate::weights::{PointTree, Weights};

/// Deforms bound points.
#[pyclass(frozen)]
pub(crate) struct Deformer {
    pub inner: neuralmls_core::Deformer,
    pub dim: usize,
}

/// Positions n x d, and the maps n x d x d where they were asked for.
type Deformed<'py> = (Bound<'py, PyArray2<f64>>, Option<Bound<'py, PyArray3<f64>>>);

/// Targets, and orientations where there are any, as the core takes them.
pub(crate) fn pose<'a>(
    q: &'a PyReadonlyArray2<'_, f64>,
    orientations: Option<&'a PyReadonlyArray3<'_, f64>>,
) -> PyResult<Pose<'a>> {
    let orientations = orientations.map(|orientations| orientations.as_slice()).transpose()?;
    Ok(Pose { q: q.as_slice()?, orientations })
}

/// A transform by its name.
pub(crate) fn transform(name: &str) -> PyResult<Transform> {
    neuralmls_session::transform(name).map_err(|error| argument(error.message))
}

#[pymethods]
impl Deformer {
    /// Binds points by weights; with a tree of the points, where there is one.
    #[new]
    fn new(
        py: Python<'_>,
        x: PyReadonlyArray2<'_, f64>,
        weights: &Weights,
        tree: Option<&PointTree>,
        transform: &str,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Deformer> {
        let (dim, x) = (x.shape()[1], x.as_slice()?);
        Deformer::bound(py, x, dim, &weights.0, tree, self::transform(transform)?, progress)
    }

    /// Binds points by logits of any weights of the control points `p`.
    #[staticmethod]
    fn of_logits(
        x: PyReadonlyArray2<'_, f64>,
        p: PyReadonlyArray2<'_, f64>,
        logits: PyReadonlyArray2<'_, f32>,
        transform: &str,
    ) -> PyResult<Deformer> {
        let (dim, transform) = (x.shape()[1], self::transform(transform)?);
        let (x, p, logits) = (x.as_slice()?, p.as_slice()?, logits.as_slice()?);
        let bound = || neuralmls_core::Deformer::of_logits(copy_of(x)?, dim, p, copy_of(logits)?, transform);
        Ok(Deformer { inner: bound().map_err(|error| from_core(error, None))?, dim })
    }

    /// The points, n x d.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(py, self.inner.points().to_vec(), self.dim)
    }

    /// What they are bound by, n x m.
    #[getter]
    fn logits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let logits = self.inner.logits().to_vec();
        let columns = logits.len() / self.inner.len().max(1);
        table(py, logits, columns)
    }

    /// Computes the weights at a temperature.
    fn prepare(&self, py: Python<'_>, temperature: f64) -> PyResult<()> {
        py.detach(|| self.inner.prepare(temperature)).map_err(|error| from_core(error, None))
    }

    /// Writes the positions into `out`, n x d, or into a new array.
    #[allow(clippy::too_many_arguments)]
    fn deform<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray2<'py, f64>,
        orientations: Option<PyReadonlyArray3<'py, f64>>,
        temperature: f64,
        maps: bool,
        out: Option<Bound<'py, PyArray2<f64>>>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Deformed<'py>> {
        let pose = pose(&q, orientations.as_ref())?;
        self.frame(py, maps, out, progress, |y, maps, report| {
            Ok(self.inner.deform_into(pose, temperature, y, maps, report)?)
        })
    }
}

impl Deformer {
    /// Binds points without the GIL.
    pub(crate) fn bound(
        py: Python<'_>,
        x: &[f64],
        dim: usize,
        weights: &neuralmls_core::Weights,
        tree: Option<&PointTree>,
        transform: Transform,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Deformer> {
        let tree = tree.map(|tree| &tree.0);
        let bind = |report: &mut dyn FnMut(f64) -> bool| {
            neuralmls_core::Deformer::new(copy_of(x)?, weights, tree, transform, report)
        };
        Ok(Deformer { inner: run(py, progress, bind)?, dim })
    }

    /// One frame, which `deform` writes into positions and maps, without the GIL.
    pub(crate) fn frame<'py>(
        &self,
        py: Python<'py>,
        maps: bool,
        out: Option<Bound<'py, PyArray2<f64>>>,
        progress: Option<Py<PyAny>>,
        deform: impl FnOnce(&mut [f64], Option<&mut [f64]>, &mut Progress<'_>) -> Result<(), SessionError> + Send,
    ) -> PyResult<Deformed<'py>> {
        let (n, d) = (self.inner.len(), self.dim);
        // By NumPy's own function, which raises MemoryError where there is too little.
        let zeros = || py.import("numpy")?.getattr("zeros");
        let positions = match out {
            Some(out) => out,
            None => zeros()?.call1(((n, d),))?.cast_into::<PyArray2<f64>>()?,
        };
        let maps =
            maps.then(|| zeros()?.call1(((n, d, d),))?.cast_into::<PyArray3<f64>>().map_err(PyErr::from));
        let maps = maps.transpose()?;
        {
            let taken = |_| argument("out: another call reads or writes this array at the same time");
            let mut y = positions.try_readwrite().map_err(taken)?;
            let y = y.as_slice_mut()?;
            let mut m = maps.as_ref().map(|maps| maps.try_readwrite()).transpose()?;
            let m = m.as_mut().map(|maps| maps.as_slice_mut()).transpose()?;
            run_session(py, progress, |report| deform(y, m, report))?;
        }
        Ok((positions, maps))
    }
}
