//! Where points are: coordinates relative to a box, a kd-tree over points, and places spread over a shape.

mod frame;
pub mod placement;
mod tree;

pub use frame::Frame;
pub(crate) use tree::{Node, Point, Region, LEAF, LEAF_BLOCKS};
pub use tree::{Order, PointTree};
