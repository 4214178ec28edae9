//! The Python face of NeuralMLS: converts arguments, releases the GIL, calls the crates. No mathematics, no rule, no sentence.
//!
//! The package's own modules are the only callers.

mod arrays;
mod control_points;
mod deformer;
mod errors;
mod handles;
mod placement;
mod progress;
mod report;
mod session;
mod shape_file;
mod weights;

use pyo3::prelude::*;

#[pymodule]
mod _core {
    #[pymodule_export]
    use crate::control_points::{ControlPoints, Orientation};
    #[pymodule_export]
    use crate::deformer::Deformer;
    #[pymodule_export]
    use crate::handles::Handles;
    #[pymodule_export]
    use crate::placement::{farthest_of, farthest_points, mirror_planes, place_points, sample_surface};
    #[pymodule_export]
    use crate::report::Report;
    #[pymodule_export]
    use crate::session::{check_size, longest_side, Map, Read, Session};
    #[pymodule_export]
    use crate::shape_file::ShapeFile;
    #[pymodule_export]
    use crate::weights::{PointTree, Weights};
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
