//! Control points: the objects of `crates/session`, as Python has them.

use neuralmls_session::{ControlPoint, Error};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::arrays::table;
use crate::errors::{argument, from_session};

pub(crate) fn raised(error: Error) -> PyErr {
    from_session(error, None)
}

/// How a control point is oriented: turned about an axis, by an angle, and scaled.
///
/// Parameters
/// ----------
/// axis : 3 floats, not all 0, of any length
///     Seen from its tip, positive angles turn counterclockwise. In the plane (0, 0, 1).
/// degrees : float
///     The angle; on a line 0.
/// scale : float > 0
///     How much larger the surroundings become. Rigid deformations leave it away.
///
/// Raises
/// ------
/// ArgumentError
///     A number is out of its range.
///
/// Examples
/// --------
/// >>> Orientation((0, 0, 1), 90).matrix.round(6).tolist()
/// [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
#[pyclass(frozen, eq, from_py_object, module = "neuralmls._core")]
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct Orientation(pub neuralmls_session::Orientation);

#[pymethods]
impl Orientation {
    #[new]
    #[pyo3(signature = (axis=[0.0, 0.0, 1.0], degrees=0.0, scale=1.0))]
    fn new(axis: [f64; 3], degrees: f64, scale: f64) -> PyResult<Orientation> {
        neuralmls_session::Orientation::new(axis, degrees, scale).map(Orientation).map_err(raised)
    }

    /// The orientation of a rotation matrix (d, d).
    #[staticmethod]
    #[pyo3(signature = (matrix, scale=1.0))]
    fn of(matrix: PyReadonlyArray2<'_, f64>, scale: f64) -> PyResult<Orientation> {
        let (rows, columns) = (matrix.shape()[0], matrix.shape()[1]);
        if rows != columns {
            let expected = "matrix: expected a matrix (d, d) with d = 1, 2 or 3";
            return Err(argument(format!("{expected}, found shape ({rows}, {columns})")));
        }
        let numbers: Vec<f64> = matrix.as_array().iter().copied().collect();
        neuralmls_session::Orientation::of_matrix(&numbers, rows, scale).map(Orientation).map_err(raised)
    }

    #[getter]
    fn axis(&self) -> (f64, f64, f64) {
        self.0.axis.into()
    }

    #[getter]
    fn degrees(&self) -> f64 {
        self.0.degrees
    }

    #[getter]
    fn scale(&self) -> f64 {
        self.0.scale
    }

    /// The rotation without its scale, (3, 3).
    #[getter]
    fn matrix<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(py, self.0.matrix().to_vec(), 3)
    }

    /// The rotation without its scale in `dimension` coordinates, (d, d).
    fn rotation<'py>(&self, py: Python<'py>, dimension: usize) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(py, self.0.rotation(dimension), dimension)
    }

    /// Oriented so, and then further.
    fn then(&self, further: &Orientation) -> Orientation {
        Orientation(self.0.then(&further.0))
    }

    fn __repr__(&self) -> String {
        let neuralmls_session::Orientation { axis: [x, y, z], degrees, scale } = self.0;
        format!("Orientation(({x:?}, {y:?}, {z:?}), {degrees:?}, {scale:?})")
    }

    fn __reduce__(&self, py: Python<'_>) -> (Py<PyAny>, ([f64; 3], f64, f64)) {
        let neuralmls_session::Orientation { axis, degrees, scale } = self.0;
        (py.get_type::<Orientation>().into_any().unbind(), (axis, degrees, scale))
    }
}

/// The checked list of control points.
#[pyclass(frozen)]
#[derive(Clone)]
pub(crate) struct ControlPoints(pub neuralmls_session::ControlPoints);

#[pymethods]
impl ControlPoints {
    #[new]
    fn new(
        names: Vec<String>,
        sources: PyReadonlyArray2<'_, f64>,
        targets: PyReadonlyArray2<'_, f64>,
        orientations: Vec<Option<Orientation>>,
        weights: Vec<f64>,
        groups: Vec<Option<String>>,
        locked: Vec<bool>,
    ) -> PyResult<ControlPoints> {
        let (p, q) = (sources.as_array(), targets.as_array());
        let points = names.into_iter().zip(groups).enumerate().map(|(i, (name, group))| ControlPoint {
            target: q.row(i).to_vec(),
            orientation: orientations[i].map(|orientation| orientation.0),
            weight: weights[i],
            group,
            locked: locked[i],
            ..ControlPoint::new(name, p.row(i).to_vec())
        });
        neuralmls_session::ControlPoints::new(sources.shape()[1], points.collect())
            .map(ControlPoints)
            .map_err(raised)
    }

    #[getter]
    fn names(&self) -> Vec<&str> {
        self.0.iter().map(|point| &*point.name).collect()
    }

    #[getter]
    fn sources<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(py, self.0.sources(), self.0.dim())
    }

    #[getter]
    fn targets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(py, self.0.targets(), self.0.dim())
    }

    #[getter]
    fn orientations(&self) -> Vec<Option<Orientation>> {
        self.0.iter().map(|point| point.orientation.map(Orientation)).collect()
    }

    /// The rotations without their scales, m x d x d; None where there is none.
    #[getter]
    fn rotations<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray3<f64>>>> {
        let (m, d) = (self.0.len(), self.0.dim());
        let Some(mut scaled) = self.0.orientations() else {
            return Ok(None);
        };
        for (matrix, point) in scaled.chunks_exact_mut(d * d).zip(self.0.iter()) {
            let orientation = point.orientation.map(|orientation| orientation.rotation(d));
            matrix.copy_from_slice(&orientation.unwrap_or_else(|| vec![f64::NAN; d * d]));
        }
        PyArray1::from_vec(py, scaled).reshape([m, d, d]).map(Some)
    }

    #[getter]
    fn scales<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.0.orientations()?;
        let scale =
            |point: &ControlPoint| point.orientation.map_or(f64::NAN, |orientation| orientation.scale);
        Some(PyArray1::from_vec(py, self.0.iter().map(scale).collect()))
    }

    #[getter]
    fn weights<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.0.weights())
    }

    #[getter]
    fn groups(&self) -> Vec<Option<&str>> {
        self.0.iter().map(|point| point.group.as_deref()).collect()
    }

    #[getter]
    fn mirror_of(&self) -> Vec<Option<&str>> {
        self.0.iter().map(|point| point.mirror_of.as_deref()).collect()
    }

    #[getter]
    fn locked<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_iter(py, self.0.iter().map(|point| point.locked))
    }

    fn grouped(&self, names: Vec<String>, group: Option<&str>) -> PyResult<ControlPoints> {
        self.0.grouped(&names, group).map(ControlPoints).map_err(raised)
    }

    fn with_locked(&self, names: Vec<String>) -> PyResult<ControlPoints> {
        self.0.with_locked(&names).map(ControlPoints).map_err(raised)
    }

    fn index(&self, name: &str) -> PyResult<usize> {
        self.0.index(name).map_err(raised)
    }

    fn moved(&self, name: &str, offset: Vec<f64>) -> PyResult<ControlPoints> {
        self.0.moved(name, &offset).map(ControlPoints).map_err(raised)
    }

    fn oriented(&self, name: &str, orientation: &Orientation) -> PyResult<ControlPoints> {
        self.0.oriented(name, orientation.0).map(ControlPoints).map_err(raised)
    }

    fn with_targets(&self, targets: PyReadonlyArray2<'_, f64>) -> PyResult<ControlPoints> {
        self.0.with_targets(targets.as_slice()?).map(ControlPoints).map_err(raised)
    }

    /// Warnings about control points beside a shape with the box `bounds` (2, d).
    fn check(&self, bounds: PyReadonlyArray2<'_, f64>) -> PyResult<Vec<String>> {
        let corners = bounds.as_slice()?;
        let (low, high) = corners.split_at(bounds.shape()[1]);
        self.0.check((low, high)).map_err(raised)
    }

    fn __len__(&self) -> usize {
        self.0.len()
    }
}
