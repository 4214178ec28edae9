//! Stub.

use crate::document::Parsed;
use crate::error::Error;
use crate::shape::SideFiles;

pub(crate) fn read_gltf(_source: &[u8], _side_files: &SideFiles<'_>) -> Result<Parsed, Error> {
    Err(Error::unsupported("not written yet"))
}

pub(crate) fn read_glb(_source: &[u8], _side_files: &SideFiles<'_>) -> Result<Parsed, Error> {
    Err(Error::unsupported("not written yet"))
}
