//! How a long call reports how far it is, and how its caller stops it.

use crate::error::Error;

/// Called now and then with the fraction done, from 0 to 1, on the thread that made the call; `false` stops the work, which then
/// returns [`Error::Cancelled`].
pub type Progress<'a> = dyn FnMut(f64) -> bool + 'a;

/// Reports, and turns a wish to stop into the error.
pub(crate) fn report(progress: &mut Progress<'_>, fraction: f64) -> Result<(), Error> {
    if progress(fraction) {
        Ok(())
    } else {
        Err(Error::Cancelled)
    }
}
