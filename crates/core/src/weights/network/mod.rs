//! The paper's weights: a small network, trained on nothing but the control points, says how much each of them matters at a place.
//!
//! MLP `d -> width -> width -> m`, ReLU, trained full-batch with Adam to give control point i the class i. Its outputs are the
//! logits. Shechter et al. 2022, section 3.

mod activations;
mod adam;
mod dense;
mod features;
mod first;
mod gemm;
mod initialise;
mod inverse;
mod linear;
mod mlp;
mod parameters;
mod piecewise;
mod prototypes;
mod samples;
mod train;

pub use mlp::Network;
pub use parameters::Layer;
pub use samples::Samples;
pub use train::{fit, train, Schedule, Trained, Training, MOST_CONTROL_POINTS};
