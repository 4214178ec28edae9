//! The mathematics of NeuralMLS: slices in, slices out. No files, no Python, no globals, no printing.
//!
//! The way of the data: control points -> fit -> **logits -> softmax(T) -> MLS** -> points.
//!
//! | module | what |
//! |---|---|
//! | [`frame`] | coordinates relative to a box, in double precision |
//! | [`logits`] | weight functions: what each says of a point, before the softmax (inverse distance, neural) |
//! | [`softmax`] | logits at a temperature -> weights, and the form of them that stays accurate however small T is |
//! | [`mls`] | weights and moved control points -> a rigid, similarity or affine map a point |
//! | [`placement`] | control points spread over a shape |
//! | [`tree`] | a kd-tree over points, built once a shape |
//! | [`memory`] | large arrays, made by all threads |
//! | `simd` | one kernel, compiled for several instruction sets |
//! | [`deformer`] | joins them: points bound to their logits once, deformed many times |
//!
//! Source: Shechter, Hanocka, Metzer, Giryes, Cohen-Or, "NeuralMLS: Geometry-Aware Control Point Deformation",
//! Eurographics Short Papers 2022, arXiv 2201.01873.
//!
//! Points are flat slices of `f64`, `dim` coordinates each (1, 2 or 3), in one coordinate system throughout.

pub mod advice;
pub mod deformer;
mod error;
pub mod exact;

pub mod frame;
pub mod logits;
pub mod memory;
pub mod mls;
mod parallel;
pub mod placement;
pub mod progress;
mod simd;
pub mod softmax;
pub mod tree;

pub use deformer::{Deformed, Deformer, Pose};
pub use error::Error;
pub use exact::{Aim, ExactHandles, Remedy, Soft};
pub use frame::Frame;
pub use logits::inverse_distance::InverseDistance;
pub use logits::neural::{Fit, Layer, Network, Samples, Schedule, Training};
pub use mls::Transform;
pub use tree::{Order, PointTree};
