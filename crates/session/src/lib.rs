//! What a person sets (control points, settings, frame), read from and written to files of every kind, and all sentences about
//! it. No I/O: bytes in, bytes out.
//!
//! | module | what |
//! |---|---|
//! | [`control_points`] | the checked list: where a shape is held, and where it is moved to |
//! | [`orientation`] | the rotation and the scale that a control point may carry |
//! | [`settings`] | weights, transform, temperature, handles, with their defaults and ranges |
//! | [`session`] | all of it together, and what reading a file gives |
//! | [`files`] | one file a format: bytes -> session, session -> text |
//!
//! Every refusal and every note is one line, whatever the file holds.

pub mod control_points;
mod error;
pub mod files;
pub mod orientation;
pub mod session;
pub mod settings;
mod text;

pub use control_points::{ControlPoint, ControlPoints};
pub use error::{Error, ErrorKind};
pub use files::{join, read};
pub use neuralmls_core::Transform;
pub use orientation::Orientation;
pub use serde_json::{Map, Value};
pub use session::{Box, Read, Session};
pub use settings::{HandlesSetting, Settings, WeightsSettings};
