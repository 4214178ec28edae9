//! Control points spread over a shape.

use neuralmls_core::place::{self, Count, Wish};
use neuralmls_core::{placement, symmetry};
use numpy::{PyArray1, PyArray2, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::arrays::table;
use crate::control_points::{raised, ControlPoints};
use crate::errors::from_core;
use crate::progress::run;

/// Places spread over points n x d and triangles f x 3 of them: count x d.
#[pyfunction]
pub(crate) fn farthest_points<'py>(
    py: Python<'py>,
    x: PyReadonlyArray2<'py, f64>,
    faces: PyReadonlyArray2<'py, u32>,
    count: usize,
    seed: u64,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (dim, x) = (x.shape()[1], x.as_slice()?);
    let (faces, _) = faces.as_slice()?.as_chunks::<3>();
    table(py, run(py, None, |report| placement::farthest_points(x, dim, faces, count, seed, report))?, dim)
}

/// The indices of points n x d that are spread evenly, at most `count`.
#[pyfunction]
pub(crate) fn farthest_of<'py>(
    py: Python<'py>,
    x: PyReadonlyArray2<'py, f64>,
    count: usize,
) -> PyResult<Bound<'py, PyArray1<i64>>> {
    let (dim, x) = (x.shape()[1], x.as_slice()?);
    let chosen = run(py, None, |report| placement::farthest_of(x, dim, count, report))?;
    Ok(PyArray1::from_iter(py, chosen.into_iter().map(|index| index as i64)))
}

/// Places on triangles f x 3 of points n x d, by area: count x d, or 0 x d where no triangle has area.
#[pyfunction]
pub(crate) fn sample_surface<'py>(
    py: Python<'py>,
    x: PyReadonlyArray2<'py, f64>,
    faces: PyReadonlyArray2<'py, u32>,
    count: usize,
    seed: u64,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (dim, x) = (x.shape()[1], x.as_slice()?);
    let (faces, _) = faces.as_slice()?.as_chunks::<3>();
    let places = py.detach(|| placement::sample_surface(x, dim, faces, count, seed));
    table(py, places.map_err(|error| from_core(error, None))?, dim)
}

/// Control points at the ends of a shape and in its parts, `count` or (None) as many as make a difference; by the plane of symmetry
/// that was used, and, where the number is found, each number with what it costs.
#[pyfunction]
pub(crate) fn place_points<'py>(
    py: Python<'py>,
    x: PyReadonlyArray2<'py, f64>,
    faces: PyReadonlyArray2<'py, u32>,
    count: Option<usize>,
    symmetric: bool,
    seed: u64,
) -> PyResult<(ControlPoints, Option<Plane>, Curve)> {
    let (dim, x) = (x.shape()[1], x.as_slice()?);
    let (faces, _) = faces.as_slice()?.as_chunks::<3>();
    let wish = Wish { count: count.map_or(Count::Auto, Count::Of), symmetric, seed };
    let placed = run(py, None, |report| place::place(x, dim, faces, &wish, report))?;
    let points = neuralmls_session::ControlPoints::placed(&placed, dim).map_err(raised)?;
    Ok((ControlPoints(points), placed.plane.map(|plane| told(&plane)), placed.curve))
}

/// Each number of control points with what it costs.
type Curve = Vec<(usize, f64)>;

/// Normal, offset, score, matched, verdict.
type Plane = ([f64; 3], f64, f64, f64, &'static str);

/// The planes by which points n x d and triangles f x 3 of them may be symmetric, the best first.
#[pyfunction]
pub(crate) fn mirror_planes(
    py: Python<'_>,
    x: PyReadonlyArray2<'_, f64>,
    faces: PyReadonlyArray2<'_, u32>,
) -> PyResult<Vec<Plane>> {
    let (dim, x) = (x.shape()[1], x.as_slice()?);
    let (faces, _) = faces.as_slice()?.as_chunks::<3>();
    let planes = py.detach(|| symmetry::planes(x, dim, faces)).map_err(|error| from_core(error, None))?;
    Ok(planes.iter().map(told).collect())
}

fn told(plane: &symmetry::Plane) -> Plane {
    (plane.normal, plane.offset, plane.score, plane.matched, plane.verdict.word())
}
