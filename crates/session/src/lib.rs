//! What a person sets (control points, settings, frame), read from and written to files of every kind, and all sentences about
//! it. No I/O: bytes in, bytes out.
//!
//! | module | what |
//! |---|---|
//! | [`control_points`] | the checked list: where a shape is held, and where it is moved to |
//! | [`orientation`] | the rotation and the scale that a control point may carry |
//! | [`settings`] | weights, transform, temperature, handles, relax, no_folds, with their defaults and ranges |
//! | [`session`] | all of it together, and what reading a file gives |
//! | [`files`] | one file a format: bytes -> session, session -> text |
//! | [`map`] | a fitted session: where each point of space goes; [`map_file`]: saved |
//! | [`inverse`] | from where a point came, and the map's Jacobian |
//! | [`report`] | what happened to the control points; [`advice`]: what is likely bad, and what would help |
//!
//! Every refusal and every note is one line, whatever the file holds.

pub mod advice;
mod changes;
pub mod control_points;
mod error;
pub mod files;
pub mod inverse;
pub mod map;
pub mod map_file;
pub mod orientation;
pub mod report;
pub mod session;
pub mod settings;
mod text;
mod unfolded;
mod words;

pub use advice::{to_json as advice_to_json, Advice};
pub use control_points::{ControlPoint, ControlPoints, Posed};
pub use error::{Error, ErrorKind};
pub use files::{join, read};
pub use map::Map;
pub use map_file::{weights_from_bytes, weights_to_bytes};
pub use neuralmls_core::{Inverse, Transform};
pub use orientation::Orientation;
pub use report::{Arrival, Held, OrientationArrival, Report};
pub use session::{longest_side, Bounds, Read, Session};
pub use settings::{transform, HandlesSetting, Settings, WeightsSettings};
pub use words::remedy_in_words;
