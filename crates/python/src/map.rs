//! Fitted sessions.

use neuralmls_core::Pose;
use neuralmls_session::{Advice, Error, Held};
use numpy::{PyArray1, PyArray2, PyArray3, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::table;
use crate::deformer::Deformer;
use crate::errors::from_session;
use crate::session::Session;
use crate::shape_file::ShapeFile;
use crate::weights::Weights;

fn raised(error: Error) -> PyErr {
    from_session(error, None)
}

/// A map of space.
#[pyclass(frozen)]
#[derive(Clone)]
pub(crate) struct Map(pub neuralmls_session::Map);

/// Positions n x d, and the maps n x d x d where they were asked for.
type Deformed<'py> = (Bound<'py, PyArray2<f64>>, Option<Bound<'py, PyArray3<f64>>>);
/// A kind, a sentence, a place, control points by their numbers, how bad.
type Told = (&'static str, String, Vec<f64>, Vec<usize>, f64);

#[pymethods]
impl Map {
    /// Of weights that were fitted already.
    #[staticmethod]
    fn of(session: &Session, weights: &Weights) -> PyResult<Map> {
        neuralmls_session::Map::over(session.0.clone(), weights.0.clone()).map(Map).map_err(raised)
    }

    #[getter]
    fn session(&self) -> Session {
        Session(self.0.session().clone())
    }

    #[getter]
    fn weights(&self) -> Weights {
        Weights(self.0.shared_weights())
    }

    /// The same weights with other targets, transform, temperature, handles.
    fn with_session(&self, session: &Session) -> PyResult<Map> {
        self.0.with(session.0.clone()).map(Map).map_err(raised)
    }

    /// The effective targets, and how far each control point stays from where it was to go.
    fn aim<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>)> {
        let aim = py.detach(|| self.0.aim()).map_err(raised)?;
        Ok((table(py, aim.targets, self.0.session().points.dim())?, PyArray1::from_vec(py, aim.misses)))
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
        let orientations = self.0.session().points.orientations();
        let pose = Pose { q: &aim.targets, orientations: orientations.as_deref() };
        bound.frame(py, pose, self.0.session().settings.temperature, maps, out, progress)
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
        let found = py.detach(|| self.0.advise(&self.0.probe(x, faces)?, &mut made)).map_err(raised)?;
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

/// What happened to the control points.
#[pyclass(frozen)]
pub(crate) struct Report(neuralmls_session::Report);

#[pymethods]
impl Report {
    /// How closely they were met, in a few words.
    #[getter]
    fn handles(&self) -> &str {
        &self.0.handles
    }

    /// Why all were left soft; None where they were not.
    #[getter]
    fn soft(&self) -> Option<&str> {
        self.0.soft.as_deref()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.0.warnings.clone()
    }

    #[getter]
    fn names(&self) -> Vec<&str> {
        self.0.control_points.iter().map(|point| &*point.name).collect()
    }

    #[getter]
    fn moved<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.0.control_points.iter().map(|point| point.moved))
    }

    #[getter]
    fn distance_to_target<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.0.control_points.iter().map(|point| point.distance_to_target))
    }

    /// Of each, by how many degrees it was to turn, how many are missing, and its scale; None of those that only move.
    #[getter]
    fn orientations(&self) -> Vec<Option<(f64, f64, f64)>> {
        let told = |arrival: &neuralmls_session::Arrival| {
            let told = arrival.orientation.as_ref()?;
            Some((told.degrees, told.degrees_to_rotation, told.scale))
        };
        self.0.control_points.iter().map(told).collect()
    }
}
