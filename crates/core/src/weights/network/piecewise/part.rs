//! What is left of a network: parts that are affine, and neurons that are open.

use super::columns::Columns;
use super::rows::Rows;
use crate::machine::simd::Aligned;

/// `o = A x + c + sum_{j open} V_j relu(w_j x + b_j) + sum_{i open} U_i relu(z_i)`.
#[derive(Default)]
pub(super) struct Part {
    /// `w_j, b_j`.
    pub columns: Columns,
    /// `z_i`.
    pub rows: Rows,
    /// `A, c`: outputs in lanes.
    pub output: Vec<[Aligned; 4]>,
    /// `V_j`: for each column all outputs, in lanes. It only grows; empty if it is all zeros.
    pub through: Vec<Aligned>,
}

/// `U`: for each row of layer 2 what it adds to all outputs, in lanes.
pub(super) struct Heads {
    /// Registers that hold all outputs.
    pub groups: usize,
    pub weights: Vec<Aligned>,
}
