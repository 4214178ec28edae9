//! Long calls: the GIL released, Ctrl-C heeded, progress told.

use pyo3::prelude::*;

use crate::errors::{from_core, from_session};

/// Runs `work` without the GIL. The function that it reports to calls the Python `progress` (if any) with the fraction done, and stops
/// the work when that raises or a signal handler does.
pub(crate) fn run<T: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&mut dyn FnMut(f64) -> bool) -> Result<T, neuralmls_core::Error> + Send,
) -> PyResult<T> {
    run_with(py, progress, work, from_core)
}

/// The same for what a session does.
pub(crate) fn run_session<T: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&mut dyn FnMut(f64) -> bool) -> Result<T, neuralmls_session::Error> + Send,
) -> PyResult<T> {
    run_with(py, progress, work, from_session)
}

fn run_with<T: Send, E: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&mut dyn FnMut(f64) -> bool) -> Result<T, E> + Send,
    raised: impl FnOnce(E, Option<PyErr>) -> PyErr + Send,
) -> PyResult<T> {
    py.detach(|| {
        let mut cause = None;
        let result = work(&mut |fraction| {
            Python::attach(|py| {
                let heard = py.check_signals().and_then(|()| match &progress {
                    Some(progress) => progress.call1(py, (fraction,)).map(drop),
                    None => Ok(()),
                });
                cause = heard.err();
                cause.is_none()
            })
        });
        result.map_err(|error| raised(error, cause))
    })
}
