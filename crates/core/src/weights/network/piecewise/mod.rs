//! The logits of a ReLU network at many points, without a dense pass for each.
//!
//! A network of ReLU is affine in each region of space where no neuron changes its sign. Over a small box nearly every neuron is surely
//! on or surely off: those are folded into an affine map, and only the ones that cross zero inside the box are evaluated a point.
//!
//! ```text
//! h_j = relu(w_j x + b_j)                                     layer 1, of which columns j are open
//! z_i = a_i x + c_i + sum_{j open} W_ij h_j                   layer 2, of which rows i are open
//! o   = A x + c + sum_{j open} V_j h_j + sum_{i open} U_i relu(z_i)
//!
//! descend(node of the points' tree, what its parent left open):
//!     bound each open column over the box, or at its points if they are few: on -> fold into a_i, c_i, A, c; off -> drop
//!     bound each open row: on -> fold into A, c, V; off -> drop
//!     at a leaf evaluate what is left, else keep it together and descend into the nodes some levels below
//! ```
//!
//! At the top of the tree copies are not worth it: all nodes of some depth are made from the whole network at once, so that layer 2
//! is read but once, and inherit from those above only the columns that are on. Nor are they at two of three levels below. The
//! result is exact up to rounding, and does not depend on the threads.
//!
//! Bounds: intervals as in Gowal et al., "On the effectiveness of interval bound propagation", 2018; for layer 2 with the linear
//! relaxation of ReLU of Zhang et al., "Efficient neural network robustness certification with general activation functions" (CROWN), 2018.

// Kernels walk over several arrays in step.
#![allow(clippy::needless_range_loop)]

mod bounds;
mod columns;
mod evaluate;
mod fold;
mod keep;
mod leaf;
mod node;
mod planes;
mod rows;
mod whole;

pub(super) use evaluate::write_logits;
pub(super) use whole::Prepared;

#[cfg(test)]
mod tests;
