//! Weight functions.

use neuralmls_core::{Error, Frame, InverseDistance, Layer, Samples, Schedule, Training, Weights};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::errors::{argument, from_core};
use crate::progress::run;

fn frame(centre: &[f64], half: f64) -> PyResult<Frame> {
    if centre.len() > 3 || !(half > 0.0 && half.is_finite()) || centre.iter().any(|c| !c.is_finite()) {
        return Err(argument("bounds: expected a finite box with a size above 0"));
    }
    let mut frame = Frame { centre: [0.0; 3], half };
    frame.centre[..centre.len()].copy_from_slice(centre);
    Ok(frame)
}

fn schedule(steps: Option<usize>) -> Schedule {
    steps.map_or(Training::default().schedule, Schedule::Fixed)
}

fn matrix<'py>(py: Python<'py>, numbers: Vec<f32>, columns: usize) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let rows = numbers.len() / columns.max(1);
    PyArray1::from_vec(py, numbers).reshape([rows, columns])
}

/// The classic weights' logits, n x m float32.
#[pyfunction]
#[pyo3(signature = (x, p, half, alpha, epsilon, progress))]
pub(crate) fn inverse_distance_logits<'py>(
    py: Python<'py>,
    x: PyReadonlyArray2<'py, f64>,
    p: PyReadonlyArray2<'py, f64>,
    half: f64,
    alpha: f64,
    epsilon: f64,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let [m, dim] = [p.shape()[0], p.shape()[1]];
    let function = InverseDistance::new(p.as_slice()?, dim, frame(&[], half)?, alpha, epsilon)
        .map_err(|error| from_core(error, None))?;
    let points = x.as_slice()?;
    let logits = run(py, progress, |report| function.logits(points, report))?;
    matrix(py, logits, m)
}

/// Points ordered for the evaluation of networks of one frame.
#[pyclass(frozen)]
pub(crate) struct PointTree(pub neuralmls_core::PointTree);

#[pymethods]
impl PointTree {
    #[new]
    fn new(
        py: Python<'_>,
        x: PyReadonlyArray2<'_, f64>,
        centre: Vec<f64>,
        half: f64,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<PointTree> {
        let (dim, frame) = (x.shape()[1], frame(&centre, half)?);
        let points = x.as_slice()?;
        run(py, progress, |report| neuralmls_core::PointTree::new(points, dim, frame, report)).map(PointTree)
    }
}

/// A trained network.
#[pyclass(frozen)]
pub(crate) struct Network(pub neuralmls_core::Network);

/// The weight and the bias of a layer.
type LayerArrays<'py> = (Bound<'py, PyArray2<f32>>, Bound<'py, PyArray1<f32>>);

#[pymethods]
impl Network {
    /// A network of given parameters: three (weight, bias), and the frequencies of Fourier features (0 rows without).
    #[new]
    fn new(
        dim: usize,
        centre: Vec<f64>,
        half: f64,
        frequencies: PyReadonlyArray2<'_, f32>,
        layers: [(PyReadonlyArray2<'_, f32>, PyReadonlyArray1<'_, f32>); 3],
    ) -> PyResult<Network> {
        let mut read = Vec::with_capacity(3);
        for (weight, bias) in &layers {
            read.push(Layer { weight: weight.as_slice()?.to_vec(), bias: bias.as_slice()?.to_vec() });
        }
        let layers: [Layer; 3] = read.try_into().expect("three layers");
        neuralmls_core::Network::new(dim, frame(&centre, half)?, frequencies.as_slice()?.to_vec(), layers)
            .map(Network)
            .map_err(|error| from_core(error, None))
    }

    #[getter]
    fn dim(&self) -> usize {
        self.0.dim()
    }

    #[getter]
    fn centre(&self) -> Vec<f64> {
        self.0.frame().centre[..self.0.dim()].to_vec()
    }

    #[getter]
    fn half(&self) -> f64 {
        self.0.frame().half
    }

    #[getter]
    fn frequencies<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        matrix(py, self.0.frequencies().to_vec(), self.0.dim())
    }

    #[getter]
    fn layers<'py>(&self, py: Python<'py>) -> PyResult<Vec<LayerArrays<'py>>> {
        let arrays = |layer: &Layer| {
            Ok((matrix(py, layer.weight.clone(), layer.inputs())?, PyArray1::from_slice(py, &layer.bias)))
        };
        self.0.layers().iter().map(arrays).collect()
    }

    /// Logits, n x m float32.
    #[pyo3(signature = (x, progress))]
    fn logits<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray2<'py, f64>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let points = x.as_slice()?;
        let logits = run(py, progress, |report| self.0.logits(points, report))?;
        matrix(py, logits, self.0.outputs())
    }

    /// Logits of the points of a tree, in their own order.
    #[pyo3(signature = (tree, progress))]
    fn logits_of_tree<'py>(
        &self,
        py: Python<'py>,
        tree: &PointTree,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let logits = run(py, progress, |report| self.0.logits_of_tree(&tree.0, report))?;
        matrix(py, logits, self.0.outputs())
    }
}

/// A network, the losses before each step, and the loss after the last.
type Trained = (Network, Vec<f64>, f64);

fn trained(fit: neuralmls_core::Trained) -> Trained {
    (Network(fit.network), fit.losses, fit.loss)
}

/// Points with soft labels, n x m, and how many of them a step looks at.
type SampleArrays<'py> = (PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, f32>, usize);

/// Makes a network from a seed and trains it; `steps` None: until the loss is small.
#[pyfunction]
#[pyo3(signature = (p, centre, half, width, steps, rate, seed, fourier_sigma, progress, samples=None))]
#[allow(clippy::too_many_arguments)] // One a keyword of the package's own function.
pub(crate) fn fit(
    py: Python<'_>,
    p: PyReadonlyArray2<'_, f64>,
    centre: Vec<f64>,
    half: f64,
    width: usize,
    steps: Option<usize>,
    rate: f64,
    seed: u64,
    fourier_sigma: Option<f64>,
    progress: Option<Py<PyAny>>,
    samples: Option<SampleArrays<'_>>,
) -> PyResult<Trained> {
    let (dim, frame) = (p.shape()[1], frame(&centre, half)?);
    let schedule = match (steps, &samples) {
        (Some(steps), Some(_)) => Schedule::Cosine(steps),
        _ => schedule(steps),
    };
    let training = Training { width, schedule, rate, seed, fourier_sigma };
    let points = p.as_slice()?;
    let samples = match &samples {
        Some((x, labels, batch)) => {
            Some(Samples { x: x.as_slice()?, labels: labels.as_slice()?, batch: *batch })
        }
        None => None,
    };
    let work = |report: &mut dyn FnMut(f64) -> bool| {
        let weights = match samples {
            Some(samples) => Weights::shape_aware(points, dim, frame, samples, &training, report)?,
            None => Weights::neural(points, dim, frame, &training, report)?,
        };
        match weights {
            Weights::Neural(trained) | Weights::ShapeAware(trained) => Ok(trained),
            Weights::InverseDistance(_) => unreachable!("a network was trained"),
        }
    };
    run(py, progress, work).map(trained)
}

/// Trains a given network.
#[pyfunction]
#[pyo3(signature = (network, p, steps, rate, progress))]
pub(crate) fn train(
    py: Python<'_>,
    network: &Network,
    p: PyReadonlyArray2<'_, f64>,
    steps: Option<usize>,
    rate: f64,
    progress: Option<Py<PyAny>>,
) -> PyResult<Trained> {
    let (network, points) = (network.0.clone(), p.as_slice()?);
    let work = |report: &mut dyn FnMut(f64) -> bool| -> Result<neuralmls_core::Trained, Error> {
        neuralmls_core::train(network, points, schedule(steps), rate, report)
    };
    run(py, progress, work).map(trained)
}
