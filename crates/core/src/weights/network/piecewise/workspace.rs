//! What a task works with, kept from one evaluation to the next.

use super::leaf::Neurons;
use super::node::Level;
use super::rows::Rows;
use crate::machine::simd::Aligned;

/// What one task works with.
#[derive(Default)]
pub(super) struct Workspace {
    /// Nodes that are made from the whole network, and rows of it.
    pub tops: Vec<Level>,
    pub rows: Rows,
    /// The affine parts of those rows over the nodes above.
    pub affines: Vec<Vec<[Aligned; 4]>>,
    /// One a level of the tree.
    pub levels: Vec<Level>,
    pub neurons: Neurons,
}
