//! Stub.

use crate::document::Parsed;
use crate::error::Error;

pub(crate) fn read(_source: &[u8]) -> Result<Parsed, Error> {
    Err(Error::unsupported("not written yet"))
}
