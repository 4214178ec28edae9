//! Shape files: bytes -> positions -> the same bytes with new positions. Nothing else is touched.
//!
//! [`Shape::read`] takes the bytes of a file and gives its positions (and a triangulated view of its faces);
//! [`Shape::write`] gives the same file with other positions. What the file had besides (vertex order, n-gons, groups,
//! materials, UVs, colours, comments, unknown elements) is in the result as it was; only normals and tangents turn with
//! the surface. A shape that did not move gives back its very bytes.
//!
//! The crate opens no files and prints nothing: side files (the buffers of a `.gltf`) come from a function that the
//! caller passes, and go back to the caller in [`Written`].
//!
//! | module | what |
//! |---|---|
//! | [`mod@format`] | which format are these bytes? |
//! | `obj`, `ply`, `off`, `stl`, `gltf`, `table`, `npy` | one format each, all behind the trait `Document` |
//! | `text`, `number` | lines and tokens with their places in the file; numbers read and printed |
//! | `precision` | what of a coordinate arrives in a file |
//! | `memory` | allocation that may fail |
//! | `facts` | what several formats tell alike about their content |
//! | `normals` | a normal turned by a local map's inverse transpose |

#![forbid(unsafe_code)]

mod bounds;
mod document;
mod error;
mod facts;
pub mod format;
mod gltf;
mod memory;
mod normals;
mod npy;
mod number;
mod obj;
mod off;
mod ply;
mod precision;
mod shape;
mod stl;
mod table;
mod text;

pub use document::{Fact, SideFile, SideFiles, Written};
pub use error::{Error, ErrorKind, Place};
pub use format::Format;
pub use shape::Shape;
