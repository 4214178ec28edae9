//! The Python face of NeuralMLS: converts arguments, releases the GIL, calls the crates. No mathematics.
//!
//! The package's own modules are the only callers; they check and explain arguments before they come here.

mod advice;
mod deformer;
mod errors;
mod exact;
mod placement;
mod progress;
mod shape_file;
mod weights;

use pyo3::prelude::*;

#[pymodule]
mod _core {
    #[pymodule_export]
    use crate::advice::Probe;
    #[pymodule_export]
    use crate::deformer::Deformer;
    #[pymodule_export]
    use crate::exact::ExactHandles;
    #[pymodule_export]
    use crate::placement::{farthest_of, farthest_points, sample_surface};
    #[pymodule_export]
    use crate::shape_file::ShapeFile;
    #[pymodule_export]
    use crate::weights::{fit, inverse_distance_logits, train, Network, PointTree};
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
