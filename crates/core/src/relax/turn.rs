//! Rotations that follow a moment matrix step by step.
//!
//! Müller, Bender, Chentanez, Macklin, "A robust method to extract the rotational part of deformations", 2016. Each step turns by
//! `z = sum r_k x m_k / |sum r_k . m_k|`, `r_k` and `m_k` the columns of the rotation and of the matrix: no case is special, and from one
//! matrix to the next the rotation has no jumps. What differs: the turn is that of the quaternion `(1, z / 2)`, which needs no sine.

use crate::mls::matrix::Matrix;

/// Against a division by 0, in parts of the matrix.
const LEAST: f64 = 1e-9;

/// The rotation `r` after `steps` steps towards the one that maximises `tr(R^T M)`.
pub(super) fn turned(r: &Matrix<3>, m: &Matrix<3>, steps: usize) -> Matrix<3> {
    let size = m.as_flattened().iter().fold(0.0, |size: f64, e| size.max(e.abs()));
    let mut r = *r;
    for _ in 0..steps {
        let dot = |i: usize, k: usize| m[i][0] * r[k][0] + m[i][1] * r[k][1] + m[i][2] * r[k][2];
        let along = (dot(0, 0) + dot(1, 1) + dot(2, 2)).abs() + LEAST * size;
        if along > 0.0 {
            let half = 0.5 / along;
            let z = [
                half * (dot(2, 1) - dot(1, 2)),
                half * (dot(0, 2) - dot(2, 0)),
                half * (dot(1, 0) - dot(0, 1)),
            ];
            r = by(&z, &r);
        }
    }
    r
}

/// `r`, turned by the quaternion `(1, z)`.
fn by(&[x, y, z]: &[f64; 3], r: &Matrix<3>) -> Matrix<3> {
    let two = 2.0 / (1.0 + x * x + y * y + z * z);
    let turn = [
        [1.0 - two * (y * y + z * z), two * (x * y - z), two * (x * z + y)],
        [two * (x * y + z), 1.0 - two * (x * x + z * z), two * (y * z - x)],
        [two * (x * z - y), two * (y * z + x), 1.0 - two * (x * x + y * y)],
    ];
    std::array::from_fn(|i| {
        std::array::from_fn(|k| turn[i][0] * r[0][k] + turn[i][1] * r[1][k] + turn[i][2] * r[2][k])
    })
}
