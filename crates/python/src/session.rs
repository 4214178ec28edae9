//! Sessions, and what comes of them: the objects of `crates/session`, as Python has them.

use neuralmls_core::memory::copy_of;
use neuralmls_core::progress::Progress;
use neuralmls_session::{Advice, Error, Held};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::{as_shape, table, GivenShape};
use crate::control_points::{raised, ControlPoints};
use crate::deformer::Deformer;
use crate::handles::Handles;
use crate::progress::run_session;
use crate::report::Report;
use crate::shape_file::ShapeFile;
use crate::weights::{PointTree, Weights};

/// What reading a file gave.
#[pyclass(frozen)]
pub(crate) struct Read(neuralmls_session::Read);

#[pymethods]
impl Read {
    /// A file of control points of any kind.
    #[new]
    fn new(data: &[u8], name: &str) -> PyResult<Read> {
        neuralmls_session::read(data, name).map(Read).map_err(raised)
    }

    /// Sources of this one and targets of another.
    fn joined(&self, targets: &Read, by_order: bool) -> PyResult<Read> {
        neuralmls_session::join(self.0.clone(), targets.0.clone(), by_order).map(Read).map_err(raised)
    }

    #[getter]
    fn session(&self) -> Session {
        Session(self.0.session.clone())
    }

    /// What was left out, a sentence each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.0.notes.clone()
    }
}

/// Control points, settings, frame.
#[pyclass(frozen)]
#[derive(Clone)]
pub(crate) struct Session(pub neuralmls_session::Session);

#[pymethods]
impl Session {
    #[new]
    fn new(points: &ControlPoints) -> Session {
        Session(neuralmls_session::Session::new(points.0.clone()))
    }

    fn to_json(&self) -> String {
        self.0.to_json()
    }

    fn to_csv(&self) -> PyResult<String> {
        self.0.to_csv().map_err(raised)
    }

    #[getter]
    fn points(&self) -> ControlPoints {
        ControlPoints(self.0.points.clone())
    }

    fn with_points(&self, points: &ControlPoints) -> Session {
        Session(neuralmls_session::Session { points: points.0.clone(), ..self.0.clone() })
    }

    /// The settings as the session file has them, JSON.
    #[getter]
    fn settings(&self) -> String {
        self.0.settings.to_json()
    }

    /// Whether the settings were said, and not only left at their defaults.
    #[getter]
    fn has_settings(&self) -> bool {
        self.0.has_settings
    }

    /// The same with those settings that `changes`, JSON as in a session file, names.
    fn with_settings(&self, changes: &str) -> PyResult<Session> {
        self.0.with_settings(changes).map(Session).map_err(raised)
    }

    /// The box in which the weights are trained, (2, d).
    #[getter]
    fn frame<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let corners = |frame: &neuralmls_session::Bounds| [&frame.min[..], &frame.max[..]].concat();
        self.0.frame.as_ref().map(|frame| table(py, corners(frame), self.0.points.dim())).transpose()
    }

    fn with_frame(&self, frame: Option<PyReadonlyArray2<'_, f64>>) -> PyResult<Session> {
        let frame = bounds(frame, self.0.points.dim())?;
        Ok(Session(neuralmls_session::Session { frame, ..self.0.clone() }))
    }

    /// Where to aim so that the control points arrive as closely as the settings say, m x d; `handles` are those of its control points.
    fn aim<'py>(&self, py: Python<'py>, handles: &Handles) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let posed = self.0.posed();
        let aim = py.detach(|| self.0.aim(&handles.0, posed.pose())).map_err(raised)?;
        table(py, aim.targets, self.0.points.dim())
    }

    /// Fits the weights: in the session's frame, else in the box `bounds`, else in that of the control points; `shape`: points n x d and
    /// triangles f x 3, for weights that learn from them.
    fn fit(
        &self,
        py: Python<'_>,
        bounds: Option<PyReadonlyArray2<'_, f64>>,
        shape: Option<GivenShape<'_>>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Map> {
        let bounds = self::bounds(bounds, self.0.points.dim())?;
        let shape = shape.as_ref().map(as_shape).transpose()?;
        run_session(py, progress, |report| self.0.fit(bounds.as_ref(), shape, report)).map(Map)
    }
}

/// The longest side of a shape's box (2, d).
#[pyfunction]
pub(crate) fn longest_side(bounds: PyReadonlyArray2<'_, f64>) -> PyResult<f64> {
    let (low, high) = corners(&bounds);
    neuralmls_session::longest_side(&low, &high).map_err(raised)
}

/// Refuses the box (2, d) of a shape of so many points that has no size.
#[pyfunction]
pub(crate) fn check_size(bounds: PyReadonlyArray2<'_, f64>, count: usize) -> PyResult<()> {
    let (low, high) = corners(&bounds);
    neuralmls_session::Bounds::of_shape(low, high, count).map(drop).map_err(raised)
}

fn corners(bounds: &PyReadonlyArray2<'_, f64>) -> (Vec<f64>, Vec<f64>) {
    (bounds.as_array().row(0).to_vec(), bounds.as_array().row(1).to_vec())
}

fn bounds(
    bounds: Option<PyReadonlyArray2<'_, f64>>,
    dim: usize,
) -> PyResult<Option<neuralmls_session::Bounds>> {
    let Some(bounds) = bounds else {
        return Ok(None);
    };
    let (low, high) = corners(&bounds);
    neuralmls_session::Bounds::new(low, high, dim).map(Some).map_err(raised)
}

/// A map of space.
#[pyclass(frozen)]
#[derive(Clone)]
pub(crate) struct Map(pub neuralmls_session::Map);

/// Positions n x d, and the maps n x d x d where they were asked for.
type Deformed<'py> = (Bound<'py, PyArray2<f64>>, Option<Bound<'py, PyArray3<f64>>>);
/// From where points came, the maps back, and the numbers of those that were not found.
type Undone<'py> =
    (Bound<'py, PyArray2<f64>>, Option<Bound<'py, PyArray3<f64>>>, Bound<'py, PyArray1<usize>>);
/// A kind, a sentence, a place, control points by their numbers, how bad.
type Told = (&'static str, String, Vec<f64>, Vec<usize>, f64);

#[pymethods]
impl Map {
    /// Of weights that were fitted already.
    #[staticmethod]
    #[pyo3(signature = (session, weights, shape=None))]
    fn of(
        py: Python<'_>,
        session: &Session,
        weights: &Weights,
        shape: Option<GivenShape<'_>>,
    ) -> PyResult<Map> {
        let shape = shape.as_ref().map(as_shape).transpose()?;
        let (session, weights) = (session.0.clone(), weights.0.clone());
        let made = py.detach(|| neuralmls_session::Map::over_shape(session, weights, shape));
        made.map(Map).map_err(raised)
    }

    #[getter]
    fn session(&self) -> Session {
        Session(self.0.session().clone())
    }

    #[getter]
    fn weights(&self) -> Weights {
        Weights(self.0.shared_weights())
    }

    /// What lengths are measured by: the longest side of the box in which the weights were trained.
    #[getter]
    fn side(&self) -> f64 {
        self.0.side()
    }

    /// The same weights with other targets, transform, temperature, handles.
    fn with_session(&self, session: &Session) -> PyResult<Map> {
        self.0.with(session.0.clone()).map(Map).map_err(raised)
    }

    /// Where bound points go; into `out` where it is given.
    fn deform<'py>(
        &self,
        py: Python<'py>,
        bound: &Deformer,
        maps: bool,
        out: Option<Bound<'py, PyArray2<f64>>>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Deformed<'py>> {
        let aim = py.detach(|| self.0.aim()).map_err(raised)?;
        bound.frame(py, maps, out, progress, |y, maps, report| {
            self.0.deform_into(&bound.inner, &aim, y, maps, report)
        })
    }

    /// Binds points by its weights, and to its elastic shape if it has one; with a tree of the points, where there is one.
    fn bind(
        &self,
        py: Python<'_>,
        x: PyReadonlyArray2<'_, f64>,
        tree: Option<&PointTree>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Deformer> {
        let (dim, x, tree) = (x.shape()[1], x.as_slice()?, tree.map(|tree| &tree.0));
        let bound = |report: &mut Progress<'_>| self.0.bind(copy_of(x)?, tree, report);
        Ok(Deformer { inner: run_session(py, progress, bound)?, dim })
    }

    /// The Jacobians at points, n x d x d.
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray2<'_, f64>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let (n, dim, x) = (x.shape()[0], x.shape()[1], x.as_slice()?);
        let found = run_session(py, progress, |report| self.0.jacobian(x, report))?;
        PyArray1::from_vec(py, found).reshape([n, dim, dim])
    }

    /// From where points came, n x d, the maps back, n x d x d, where they were asked for, and the numbers of those that were not found, which are
    /// refused unless `partial`.
    fn inverse<'py>(
        &self,
        py: Python<'py>,
        y: PyReadonlyArray2<'_, f64>,
        partial: bool,
        maps: bool,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Undone<'py>> {
        let (n, dim, y) = (y.shape()[0], y.shape()[1], y.as_slice()?);
        let found = run_session(py, progress, |report| match partial {
            true => self.0.inverse_where_found(y, maps, report),
            false => self.0.inverse(y, maps, report),
        })?;
        let maps = found.maps.map(|maps| PyArray1::from_vec(py, maps).reshape([n, dim, dim])).transpose()?;
        Ok((table(py, found.points, dim)?, maps, PyArray1::from_vec(py, found.missed)))
    }

    /// What happens to the control points, in the file of a shape where one is given.
    fn report(&self, py: Python<'_>, shape: Option<&ShapeFile>) -> PyResult<Report> {
        let held = shape.map(|shape| (&shape.0, shape.0.step().unwrap_or(0.0)));
        py.detach(|| {
            let aim = self.0.aim()?;
            let Some((shape, step)) = held else {
                return self.0.report(&aim, None);
            };
            // What the file cannot hold at all is refused when it is written.
            let round = |places: &[f64]| shape.round(places).unwrap_or_else(|_| places.to_vec());
            self.0.report(&aim, Some(&Held { format: shape.format().name(), round: &round, step }))
        })
        .map(Report)
        .map_err(raised)
    }

    /// What is likely bad about a shape; `other`: called for a map of other weights (or None), if that might help.
    fn advise(
        &self,
        py: Python<'_>,
        x: PyReadonlyArray2<'_, f64>,
        faces: PyReadonlyArray2<'_, u32>,
        other: Option<Py<PyAny>>,
    ) -> PyResult<Vec<Told>> {
        let (x, (faces, _)) = (x.as_slice()?, faces.as_slice()?.as_chunks::<3>());
        let mut failed = None;
        let mut made = || -> Option<neuralmls_session::Map> {
            Python::attach(|py| {
                let found = other.as_ref()?.call0(py).and_then(|map| Ok(map.extract::<Option<Py<Map>>>(py)?));
                found.map_err(|error| failed = Some(error)).ok().flatten().map(|map| map.get().0.clone())
            })
        };
        let found = py.detach(|| self.0.advise(&self.0.probe(x, faces)?, &mut made, true)).map_err(raised)?;
        let told = |advice: Advice| {
            (advice.kind, advice.sentence, advice.place, advice.control_points, advice.amount)
        };
        failed.map_or_else(|| Ok(found.into_iter().map(told).collect()), Err)
    }

    /// Places all over a shape, and what this map does there.
    fn look<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray2<'py, f64>,
        faces: PyReadonlyArray2<'py, u32>,
    ) -> PyResult<Look<'py>> {
        let (x, (faces, _)) = (x.as_slice()?, faces.as_slice()?.as_chunks::<3>());
        let looked = || -> Result<_, Error> {
            let probe = self.0.probe(x, faces)?;
            let look = self.0.look(&probe)?;
            Ok((probe, look))
        };
        let (probe, look) = py.detach(looked).map_err(raised)?;
        let dim = self.0.session().points.dim();
        let far = probe.far().into_iter().map(|(far, _)| far).collect();
        Ok((
            table(py, probe.places().to_vec(), dim)?,
            table(py, look.positions, dim)?,
            PyArray1::from_vec(py, look.determinants),
            PyArray1::from_vec(py, look.stretches),
            PyArray1::from_vec(py, far),
        ))
    }

    fn to_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.0.to_bytes())
    }

    #[staticmethod]
    fn from_bytes(data: &[u8]) -> PyResult<Map> {
        neuralmls_session::Map::from_bytes(data).map(Map).map_err(raised)
    }
}

/// Places, where they go, their determinants, stretches, and distances from the control points.
type Look<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
);
