//! The thin plate through the control points, and how well it foretells each of them from the others. There is none where control points are
//! oriented, which it could not follow.
//!
//! ```text
//! h(x) = G(x) + sum_i c_i |x - p_i| + A x + b,     h(p_i) = q_i
//! ```
//!
//! `G` is the rigid motion that fits all of them best, so that a rigid motion is that motion however few they are; `A` is 0 where they span
//! no volume (no area in 2D). Duchon, "Splines minimizing rotation-invariant semi-norms in Sobolev spaces", 1977. The error at a control
//! point of the plate through all others is `c_i / (K^-1)_ii`: Rippa, "An algorithm for selecting a good value for the parameter c in
//! radial basis function interpolation", 1999.

use super::{apply, distance, Position};
use crate::mls::matrix::Matrix;

/// Control points whose spread in one direction is less than this of that in another are taken for a plane: a linear term fitted across it
/// would throw what is not in the plane a hundred times as far as the control points go. (As the rival in `research` has it.)
const FLAT: f64 = 0.01;

/// What depends on the control points at rest.
pub(super) struct Plate {
    p: Vec<Position>,
    /// Of the equations, row by row, in order: control points, 1, and the coordinates of `A` where there is one.
    inverse: Vec<f64>,
    size: usize,
}

/// The plate of a frame.
#[derive(Clone, Debug)]
pub(super) struct Bent {
    rotation: Matrix<3>,
    shift: Position,
    p: Vec<Position>,
    /// One a row of the equations.
    coefficients: Vec<Position>,
    /// The mean error of foretelling.
    pub(super) error: f64,
}

impl Plate {
    /// `None` where control points are too few to foretell one from the others.
    pub(super) fn new(p: &[Position], dim: usize) -> Option<Plate> {
        let m = p.len();
        let size = m + 1 + if fills(p, dim) { dim } else { 0 };
        if size > 2 * m - 1 {
            return None;
        }
        let mut equations = vec![0.0; size * size];
        for i in 0..m {
            for k in 0..m {
                equations[size * i + k] = -distance(&p[i], &p[k]);
            }
            for k in m..size {
                let term = if k == m { 1.0 } else { p[i][k - m - 1] };
                equations[size * i + k] = term;
                equations[size * k + i] = term;
            }
        }
        Some(Plate { p: p.to_vec(), inverse: inverse(equations, size)?, size })
    }

    /// The plate that takes the control points to `q`; `rotation` is that of the motion which fits all of them best.
    pub(super) fn bent(&self, q: &[Position], rotation: &Matrix<3>) -> Bent {
        let m = self.p.len();
        let mean = |points: &[Position]| -> Position {
            std::array::from_fn(|k| points.iter().map(|x| x[k]).sum::<f64>() / m as f64)
        };
        let (p_mean, q_mean) = (mean(&self.p), mean(q));
        let turned = apply(rotation, &p_mean);
        let shift = std::array::from_fn(|k| q_mean[k] - turned[k]);
        let mut bent =
            Bent { rotation: *rotation, shift, p: self.p.clone(), coefficients: Vec::new(), error: 0.0 };
        let left: Vec<Position> = (0..m)
            .map(|i| {
                let rigid = apply(rotation, &self.p[i]);
                std::array::from_fn(|k| q[i][k] - rigid[k] - shift[k])
            })
            .collect();
        bent.coefficients = (0..self.size)
            .map(|row| {
                let row = &self.inverse[self.size * row..][..m];
                std::array::from_fn(|k| row.iter().zip(&left).map(|(e, left)| e * left[k]).sum())
            })
            .collect();
        let error =
            |i: usize| distance(&bent.coefficients[i], &[0.0; 3]) / self.inverse[self.size * i + i].abs();
        bent.error = (0..m).map(error).sum::<f64>() / m as f64;
        bent
    }
}

impl Bent {
    /// Where the place `x` goes, and the linear map there.
    pub(super) fn at(&self, x: &Position) -> (Position, Matrix<3>) {
        let (m, rigid) = (self.p.len(), apply(&self.rotation, x));
        let one = &self.coefficients[m];
        let mut y: Position = std::array::from_fn(|k| rigid[k] + self.shift[k] + one[k]);
        let mut map = self.rotation;
        for (axis, of_axis) in self.coefficients[m + 1..].iter().enumerate() {
            for k in 0..3 {
                y[k] += x[axis] * of_axis[k];
                map[k][axis] += of_axis[k];
            }
        }
        for (p, c) in self.p.iter().zip(&self.coefficients) {
            let arm: Position = std::array::from_fn(|k| x[k] - p[k]);
            let far = distance(&arm, &[0.0; 3]);
            for k in 0..3 {
                y[k] -= far * c[k];
                if far > 0.0 {
                    (0..3).for_each(|axis| map[k][axis] -= c[k] * arm[axis] / far);
                }
            }
        }
        (y, map)
    }
}

/// Whether points span a volume (an area in 2D): the least eigenvalue of their moments is not too small.
fn fills(p: &[Position], dim: usize) -> bool {
    let m = p.len() as f64;
    let mean: Position = std::array::from_fn(|k| p.iter().map(|x| x[k]).sum::<f64>() / m);
    let moment = |i: usize, k: usize| p.iter().map(|x| (x[i] - mean[i]) * (x[k] - mean[k])).sum::<f64>();
    let mut a: Vec<f64> = (0..dim * dim).map(|at| moment(at / dim, at % dim)).collect();
    let trace: f64 = (0..dim).map(|k| a[dim * k + k]).sum();
    // Positive definite with the bound taken off: by Cholesky's pivots.
    let bound = FLAT * FLAT * trace;
    (0..dim).for_each(|k| a[dim * k + k] -= bound);
    (0..dim).all(|k| {
        let pivot = a[dim * k + k];
        for i in k + 1..dim {
            let factor = a[dim * i + k] / pivot;
            (k..dim).for_each(|c| a[dim * i + c] -= factor * a[dim * k + c]);
        }
        pivot > 0.0
    })
}

/// By Gauss and Jordan, with the largest pivot of each column; `None` where there is none.
fn inverse(mut a: Vec<f64>, n: usize) -> Option<Vec<f64>> {
    let mut inverse: Vec<f64> = (0..n * n).map(|at| f64::from(u8::from(at / n == at % n))).collect();
    for column in 0..n {
        let size = |row: &usize| a[n * row + column].abs();
        let pivot = (column..n).max_by(|r, s| size(r).total_cmp(&size(s)))?;
        let value = a[n * pivot + column];
        if value.abs() < 1e-14 {
            return None;
        }
        for k in 0..n {
            a.swap(n * pivot + k, n * column + k);
            inverse.swap(n * pivot + k, n * column + k);
        }
        for k in 0..n {
            a[n * column + k] /= value;
            inverse[n * column + k] /= value;
        }
        for row in (0..n).filter(|&row| row != column) {
            let factor = a[n * row + column];
            if factor != 0.0 {
                for k in 0..n {
                    a[n * row + k] -= factor * a[n * column + k];
                    inverse[n * row + k] -= factor * inverse[n * column + k];
                }
            }
        }
    }
    Some(inverse)
}
