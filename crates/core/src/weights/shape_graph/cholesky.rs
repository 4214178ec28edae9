//! A sparse system of equations, symmetric and positive definite: ordered by approximate minimum degree, factored once as `L D L^T`, solved
//! for all right-hand sides.
//!
//! By QDLDL as Clarabel has it, in scalars: its order of additions is the same on every machine. Stellato et al., "OSQP: an operator splitting
//! solver for quadratic programs", 2020; Amestoy, Davis, Duff, "An approximate minimum degree ordering algorithm", 1996.

use clarabel::algebra::CscMatrix;
use clarabel::qdldl::{QDLDLFactorisation, QDLDLSettings};

/// Solves `(L + diag(ground)) X = B`, `L` the Laplacian of links that conduct, each once; `B` and the result n x m, row by row.
pub(super) fn solve(ends: &[[u32; 2]], conductances: &[f64], ground: &[f64], b: &mut [f64]) {
    let n = ground.len();
    let m = b.len() / n;
    // Positive definite, so that nothing is to be regularised.
    let settings = QDLDLSettings { regularize_enable: false, ..QDLDLSettings::default() };
    let matrix = upper(ends, conductances, ground);
    let mut factors = QDLDLFactorisation::new(&matrix, Some(settings)).expect("positive definite");
    for k in 0..m {
        let mut column: Vec<f64> = b.iter().skip(k).step_by(m).copied().collect();
        factors.solve(&mut column);
        b.iter_mut().skip(k).step_by(m).zip(column).for_each(|(b, x)| *b = x);
    }
}

/// The upper triangle of `L + diag(ground)`.
fn upper(ends: &[[u32; 2]], conductances: &[f64], ground: &[f64]) -> CscMatrix<f64> {
    let n = ground.len();
    let mut diagonal = ground.to_vec();
    let mut entries: Vec<(u32, u32, f64)> = Vec::with_capacity(ends.len() + n);
    for (&[a, b], conducts) in ends.iter().zip(conductances) {
        diagonal[a as usize] += conducts;
        diagonal[b as usize] += conducts;
        entries.push((a.max(b), a.min(b), -conducts));
    }
    entries.extend((0..n as u32).zip(&diagonal).map(|(node, value)| (node, node, *value)));
    entries.sort_unstable_by_key(|&(column, row, _)| (column, row));
    let mut starts = vec![0; n + 1];
    entries.iter().for_each(|&(column, ..)| starts[column as usize + 1] += 1);
    (0..n).for_each(|column| starts[column + 1] += starts[column]);
    let (rows, values) = entries.iter().map(|&(_, row, value)| (row as usize, value)).unzip();
    CscMatrix::new(n, n, starts, rows, values)
}
