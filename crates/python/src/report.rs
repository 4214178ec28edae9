//! What happened to the control points.

use numpy::PyArray1;
use pyo3::prelude::*;

/// What happened to the control points.
#[pyclass(frozen)]
pub(crate) struct Report(pub neuralmls_session::Report);

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

    /// The one of the warnings that control points do not arrive; None where they do.
    #[getter]
    fn not_arrived(&self) -> Option<&str> {
        self.0.not_arrived.as_deref()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.0.warnings.clone()
    }

    /// How many steps the map takes.
    #[getter]
    fn steps(&self) -> usize {
        self.0.steps
    }

    /// With `no_folds`: the least `det J` that was found.
    #[getter]
    fn least(&self) -> Option<f64> {
        self.0.least
    }

    /// With `no_folds`: which part of the shape folds over all the same.
    #[getter]
    fn folded(&self) -> Option<f64> {
        self.0.folded
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
