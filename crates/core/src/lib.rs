//! The mathematics of NeuralMLS: slices in, slices out. No files, no Python, no globals, no printing.
//!
//! The way of the data: control points -> fit -> **weights -> softmax(T) -> MLS** -> points.
//!
//! | folder | what |
//! |---|---|
//! | `weights` | weight functions: what each says of a point, before the softmax (inverse distance, a trained network; what a shape teaches it) |
//! | [`softmax`] | logits at a temperature -> weights, and the form of them that stays accurate however small T is |
//! | `mls` | weights and moved control points -> a rigid, similarity or affine map a point |
//! | `deformer` | joins them: points bound to weights once, deformed many times |
//! | `inverse` | the whole map's Jacobian, and from where a point came |
//! | `aim` | the targets with which control points arrive |
//! | `compose` | many small maps, one after the other, that fold nothing |
//! | `relax` | what control points leave open, decided by the shape's own stiffness |
//! | `probe`, `advice` | a deformation looked at in places all over a shape; what is likely bad about it, and which setting would help |
//! | [`symmetry`], [`place`] | the planes by which a shape is its own mirror image; control points at its ends and in its parts |
//! | `geometry` | coordinates relative to a box, a kd-tree over points, [`placement`] of control points |
//! | `machine` | wide registers, threads, [`memory`], [`progress`] |
//!
//! Source: Shechter, Hanocka, Metzer, Giryes, Cohen-Or, "NeuralMLS: Geometry-Aware Control Point Deformation",
//! Eurographics Short Papers 2022, arXiv 2201.01873.
//!
//! Points are flat slices of `f64`, `dim` coordinates each (1, 2 or 3), in one coordinate system throughout.

mod advice;
mod aim;
mod check;
mod compose;
mod deformer;
mod error;
mod geometry;
mod inverse;
mod machine;
mod mls;
pub mod place;
mod probe;
mod relax;
pub mod softmax;
pub mod symmetry;
mod weights;

pub use advice::{Advice, Better, Kind};
pub use aim::{Aim, Anchor, Handles, Remedy, Soft, Stiff};
pub use compose::{Composed, Found, Refit, Rules, Step, Watched, MOST_STEPS};
pub use deformer::{Deformed, Deformer, Pose};
pub use error::Error;
pub use geometry::{placement, Frame, Order, PointTree};
pub use inverse::{Inverse, Motion};
pub use machine::{memory, progress};
pub use mls::{best_rotation, piece, Piece, Transform, ANCHOR_WEIGHT, RIDGE};
pub use probe::{places, Look, Probe, PLACES};
pub use relax::{Body, Elastic, Lift, Relaxed};
pub use weights::inverse_distance::InverseDistance;
pub use weights::network::{train, Layer, Network, Schedule, Trained, Training, MOST_CONTROL_POINTS};
pub use weights::shape_graph::{labels, Labels, Shape};
pub use weights::Weights;
