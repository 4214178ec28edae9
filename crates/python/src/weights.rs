//! Weight functions, and points ordered for their evaluation.

use std::sync::Arc;

use neuralmls_core::{Frame, Layer, Network, Schedule, Trained, Training};
use neuralmls_session::Settings;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::{as_shape, frame, table, GivenShape};
use crate::errors::{argument, from_core, from_session};
use crate::progress::{run, run_session};

/// Points ordered for the evaluation of networks of one frame.
#[pyclass(frozen)]
pub(crate) struct PointTree(pub neuralmls_core::PointTree);

#[pymethods]
impl PointTree {
    #[new]
    #[pyo3(signature = (x, bounds, progress))]
    fn new(
        py: Python<'_>,
        x: PyReadonlyArray2<'_, f64>,
        bounds: Option<PyReadonlyArray2<'_, f64>>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<PointTree> {
        let (dim, points) = (x.shape()[1], x.as_slice()?);
        let frame = frame(bounds, points, dim)?;
        run(py, progress, |report| neuralmls_core::PointTree::new(points, dim, frame, report)).map(PointTree)
    }
}

/// A weight function.
#[pyclass(frozen)]
pub(crate) struct Weights(pub Arc<neuralmls_core::Weights>);

/// The weight and the bias of a layer.
type LayerArrays<'py> = (Bound<'py, PyArray2<f32>>, Bound<'py, PyArray1<f32>>);
/// The same, as they are given.
type GivenLayer<'py> = (PyReadonlyArray2<'py, f32>, PyReadonlyArray1<'py, f32>);

impl Weights {
    fn of(weights: neuralmls_core::Weights) -> Weights {
        Weights(Arc::new(weights))
    }

    fn trained(&self) -> Option<&Trained> {
        match &*self.0 {
            neuralmls_core::Weights::Neural(trained) | neuralmls_core::Weights::ShapeAware(trained) => {
                Some(trained)
            }
            neuralmls_core::Weights::InverseDistance(_) => None,
        }
    }
}

#[pymethods]
impl Weights {
    /// The settings as JSON, `{"weights": {...}}` of a session file; `shape`: points n x d and triangles f x 3 (none of a cloud), for weights
    /// that learn from them. Without a box it is that of the shape, else of the control points.
    #[staticmethod]
    fn fitted(
        py: Python<'_>,
        p: PyReadonlyArray2<'_, f64>,
        bounds: Option<PyReadonlyArray2<'_, f64>>,
        shape: Option<GivenShape<'_>>,
        settings: &str,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Weights> {
        let (dim, p) = (p.shape()[1], p.as_slice()?);
        let shape = shape.as_ref().map(as_shape).transpose()?;
        let frame = frame(bounds, shape.map_or(p, |shape| shape.x), dim)?;
        let settings = Settings::default().with_text(settings).map_err(|error| from_session(error, None))?;
        run_session(py, progress, |report| settings.weights.fit(p, dim, frame, shape, report))
            .map(Weights::of)
    }

    /// What shape-aware weights are taught: places of the shape, k x d, and the logits of the control points there, k x m.
    #[staticmethod]
    fn labels<'py>(
        py: Python<'py>,
        p: PyReadonlyArray2<'_, f64>,
        bounds: Option<PyReadonlyArray2<'_, f64>>,
        shape: GivenShape<'_>,
    ) -> PyResult<[Bound<'py, PyArray2<f64>>; 2]> {
        let ([m, dim], p) = ([p.shape()[0], p.shape()[1]], p.as_slice()?);
        let shape = as_shape(&shape)?;
        let frame = frame(bounds, shape.x, dim)?;
        let labels = neuralmls_core::labels(p, dim, frame, shape, &mut |_| true)
            .map_err(|error| from_core(error, None))?;
        Ok([table(py, labels.x, dim)?, table(py, labels.logits, m)?])
    }

    /// A network of given parameters: three (weight, bias), and the frequencies of Fourier features (0 rows without).
    #[staticmethod]
    fn of_layers(
        p: PyReadonlyArray2<'_, f64>,
        centre: Vec<f64>,
        half: f64,
        frequencies: PyReadonlyArray2<'_, f32>,
        layers: [GivenLayer<'_>; 3],
    ) -> PyResult<Weights> {
        let dim = p.shape()[1];
        if centre.len() != dim || !(half > 0.0 && half.is_finite()) || centre.iter().any(|c| !c.is_finite()) {
            return Err(argument("expected a finite frame with a size above 0"));
        }
        let mut frame = Frame { centre: [0.0; 3], half };
        frame.centre[..dim].copy_from_slice(&centre);
        let mut read = Vec::with_capacity(3);
        for (weight, bias) in &layers {
            read.push(Layer { weight: weight.as_slice()?.to_vec(), bias: bias.as_slice()?.to_vec() });
        }
        let layers: [Layer; 3] = read.try_into().expect("three layers");
        let network = Network::new(dim, frame, frequencies.as_slice()?.to_vec(), layers)
            .map_err(|error| from_core(error, None))?;
        let control_points = p.as_slice()?.to_vec();
        let trained =
            Trained { control_points, network, losses: Vec::new(), loss: f64::NAN, missed: Vec::new() };
        Ok(Weights::of(neuralmls_core::Weights::Neural(trained)))
    }

    /// The same network, trained further on the control points.
    fn further(
        &self,
        py: Python<'_>,
        steps: Option<usize>,
        rate: f64,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Weights> {
        let trained = self.trained().ok_or_else(|| argument("expected weights of a network"))?;
        let schedule = steps.map_or(Training::default().schedule, Schedule::Fixed);
        run(py, progress, |report| trained.further(schedule, rate, report))
            .map(|trained| Weights::of(neuralmls_core::Weights::Neural(trained)))
    }

    #[getter]
    fn kind(&self) -> &'static str {
        self.0.kind()
    }

    #[getter]
    fn control_points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(py, self.0.control_points().to_vec(), self.0.dim())
    }

    /// The centre and half of the longest side of the box.
    #[getter]
    fn frame(&self) -> (Vec<f64>, f64) {
        let frame = self.0.frame();
        (frame.centre[..self.0.dim()].to_vec(), frame.half)
    }

    /// The loss before each step; None but for networks.
    #[getter]
    fn losses<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        Some(PyArray1::from_slice(py, &self.trained()?.losses))
    }

    /// The loss after the training.
    #[getter]
    fn loss(&self) -> Option<f64> {
        Some(self.trained()?.loss)
    }

    /// Alpha and epsilon of the classic ones.
    #[getter]
    fn parameters(&self) -> Option<(f64, f64)> {
        match &*self.0 {
            neuralmls_core::Weights::InverseDistance(function) => {
                Some((function.alpha(), function.epsilon()))
            }
            _ => None,
        }
    }

    /// Weight and bias of each layer.
    #[getter]
    fn layers<'py>(&self, py: Python<'py>) -> PyResult<Vec<LayerArrays<'py>>> {
        let arrays = |layer: &Layer| {
            Ok((table(py, layer.weight.clone(), layer.inputs())?, PyArray1::from_slice(py, &layer.bias)))
        };
        self.trained().map_or(Ok(Vec::new()), |trained| trained.network.layers().iter().map(arrays).collect())
    }

    /// Logits, n x m float32.
    fn logits<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray2<'py, f64>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let points = x.as_slice()?;
        let logits = run(py, progress, |report| self.0.logits(points, report))?;
        table(py, logits, self.0.control_points().len() / self.0.dim())
    }

    /// Logits of the points of a tree, in their own order.
    fn logits_of_tree<'py>(
        &self,
        py: Python<'py>,
        tree: &PointTree,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let logits = run(py, progress, |report| self.0.logits_of_tree(&tree.0, report))?;
        table(py, logits, self.0.control_points().len() / self.0.dim())
    }

    /// As a file (crates/session/src/map_file.rs).
    fn to_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &neuralmls_session::weights_to_bytes(&self.0))
    }

    /// Reads what `to_bytes` wrote.
    #[staticmethod]
    fn from_bytes(data: &[u8]) -> PyResult<Weights> {
        neuralmls_session::weights_from_bytes(data)
            .map(Weights::of)
            .map_err(|error| from_session(error, None))
    }
}
