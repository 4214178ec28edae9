//! Errors of the crates as exceptions of the package.

use pyo3::exceptions::{PyKeyboardInterrupt, PyMemoryError};
use pyo3::prelude::*;

/// An exception of `neuralmls.errors`.
fn exception(name: &str, message: String) -> PyErr {
    Python::attach(|py| {
        match py.import("neuralmls.errors").and_then(|m| m.getattr(name)?.call1((message,))) {
            Ok(value) => PyErr::from_value(value),
            Err(error) => error,
        }
    })
}

/// A wrong argument.
pub(crate) fn argument(message: impl Into<String>) -> PyErr {
    exception("ArgumentError", message.into())
}

/// An error of the mathematics; where it was cancelled, what cancelled it.
pub(crate) fn from_core(error: neuralmls_core::Error, cause: Option<PyErr>) -> PyErr {
    match (error, cause) {
        (neuralmls_core::Error::Cancelled, Some(cause)) => cause,
        (neuralmls_core::Error::Cancelled, None) => PyKeyboardInterrupt::new_err(()),
        (error @ neuralmls_core::Error::Memory, _) => PyMemoryError::new_err(error.to_string()),
        (error, _) => argument(error.to_string()),
    }
}

/// An error of a shape file.
pub(crate) fn from_shapes(error: &neuralmls_shapes::Error) -> PyErr {
    match error.kind {
        neuralmls_shapes::ErrorKind::Argument => argument(error.message.clone()),
        _ => exception("FileError", error.to_string()),
    }
}
