//! NumPy arrays and what the crates take.

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use neuralmls_core::{Frame, Shape};

use crate::errors::from_core;

/// Numbers as a table of so many columns.
pub(crate) fn table<'py, T: numpy::Element>(
    py: Python<'py>,
    numbers: Vec<T>,
    columns: usize,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    let rows = numbers.len() / columns.max(1);
    PyArray1::from_vec(py, numbers).reshape([rows, columns])
}

/// The frame of a box (2, d); without it that of the control points' own box.
pub(crate) fn frame(bounds: Option<PyReadonlyArray2<'_, f64>>, p: &[f64], dim: usize) -> PyResult<Frame> {
    let Some(bounds) = bounds else {
        return Ok(Frame::around(p, dim));
    };
    let corners = bounds.as_slice()?;
    let (low, high) = corners.split_at(bounds.shape()[1]);
    Frame::of_box(low, high).map_err(|error| from_core(error, None))
}

/// A shape as Python hands it over: points n x d, and triangles f x 3, none of a cloud.
pub(crate) type GivenShape<'py> = (PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, u32>);

pub(crate) fn as_shape<'a>((x, faces): &'a GivenShape<'_>) -> PyResult<Shape<'a>> {
    Ok(Shape { x: x.as_slice()?, faces: faces.as_slice()?.as_chunks::<3>().0 })
}
