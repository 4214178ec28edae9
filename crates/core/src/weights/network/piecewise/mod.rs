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
//! # Two neurons a layer, one coordinate
//!
//! ```text
//! h1 = relu(2 x + 1)    h2 = relu(x - 0.5)
//! z1 = h1 - 4 h2 + 1    z2 = -h1 + h2        o = 3 relu(z1) + 5 relu(z2) + 0.5
//! ```
//!
//! over the box 0 <= x <= 1:
//!
//! - h1: `2 x + 1` lies in 1..3, so it is **on**, and folds: `2 x + 1` takes its place in z1 and z2. No point evaluates it any more.
//! - h2: `x - 0.5` lies in -0.5..0.5, so it **crosses**, and stays open. Over the box it lies within `0.5 x - 0.125 +- 0.125`: the chord of
//!   the ReLU has the slope u / (u - l) = 0.5, and a band of the half-width -u l / (2 (u - l)) = 0.125 about it holds the whole.
//! - z1 = `2 x + 2 - 4 h2` = `2.5 +- 0.5` with that band: **on**. (With the interval 0..0.5 of h2 alone, z1 would be anywhere from 0 to 4, and open:
//!   that the two terms cancel is what the band knows.) It folds into the output, and leaves there what it had of the open h2: V = 3 x -4.
//! - z2 = `-2 x - 1 + h2` = `-1.5 x - 1.125 +- 0.125` is below -1: **off**, and dropped.
//!
//! What is left of four neurons is `o = 6 x + 6.5 - 12 relu(x - 0.5)`; at x = 0.75 that is 8, as it was. In the left half of the box h2 is off, and
//! o = 6 x + 6.5; in the right half it is on, and o = -6 x + 12.5. Of the 1,024 neurons of a trained network's layer about 28 are
//! open at a leaf of a shape of 100,000 points.
//!
//! # Why each trick
//!
//! - *Inherit, never begin at the root again*: a child asks only about what its parent left open ([`node`]), so that a level costs as little as
//!   the one above has left.
//! - *Compact* ([`compact`]): open rows are put together, sixteen to a register; lanes of those that were folded would be computed for nothing.
//! - *Points instead of boxes* ([`bounds`]): where there are few points, the least and the most at them is closer than over the box, and costs no more.
//! - *Structure of arrays* ([`lane_list`]): columns are lists of numbers side by side, so that sixteen of them are classified at a time, and
//!   those that stay are appended by one instruction.
//! - *The whole network laid out once* ([`layout`]), in panels of 16 rows, column by column: what a kernel reads is in the order in which it reads it.
//! - *Workspaces are kept* ([`workspace`]): new memory costs more than the work at small shapes.
//!
//! # Where it is done
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
mod compact;
mod evaluate;
mod fold;
mod lane_list;
mod layout;
mod leaf;
mod node;
mod part;
mod rows;
mod workspace;

pub(super) use evaluate::{write_logits, write_slopes};
pub(super) use layout::Prepared;

#[cfg(test)]
mod tests;
