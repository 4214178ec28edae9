//! Affine maps of space, in double precision.

use crate::normals::{apply, cofactor};

/// `x -> linear x + translation`, `linear` row-major.
#[derive(Clone, Copy, Debug)]
pub(super) struct Affine {
    pub linear: [f64; 9],
    pub translation: [f64; 3],
}

pub(super) fn product(a: &[f64; 9], b: &[f64; 9]) -> [f64; 9] {
    std::array::from_fn(|i| (0..3).map(|k| a[i / 3 * 3 + k] * b[3 * k + i % 3]).sum())
}

pub(super) fn transpose(m: &[f64; 9]) -> [f64; 9] {
    std::array::from_fn(|i| m[i % 3 * 3 + i / 3])
}

impl Affine {
    pub const IDENTITY: Affine =
        Affine { linear: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], translation: [0.0; 3] };

    /// A 4 x 4 matrix, column by column as glTF has them; `None` if its last row is not 0 0 0 1.
    pub fn from_columns(m: &[f64; 16]) -> Option<Affine> {
        let last = [m[3], m[7], m[11], m[15] - 1.0];
        last.iter().all(|c| c.abs() < 1e-4).then(|| Affine {
            linear: [m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]],
            translation: [m[12], m[13], m[14]],
        })
    }

    /// Scales, then rotates by the quaternion x y z w (made of length 1), then translates.
    pub fn from_parts(translation: [f64; 3], [x, y, z, w]: [f64; 4], scale: [f64; 3]) -> Affine {
        let square = x * x + y * y + z * z + w * w;
        let s = if square > 0.0 { 2.0 / square } else { 0.0 };
        let rotation = [
            1.0 - s * (y * y + z * z),
            s * (x * y - z * w),
            s * (x * z + y * w),
            s * (x * y + z * w),
            1.0 - s * (x * x + z * z),
            s * (y * z - x * w),
            s * (x * z - y * w),
            s * (y * z + x * w),
            1.0 - s * (x * x + y * y),
        ];
        Affine { linear: std::array::from_fn(|i| rotation[i] * scale[i % 3]), translation }
    }

    pub fn apply(&self, x: [f64; 3]) -> [f64; 3] {
        let y = apply(&self.linear, x);
        std::array::from_fn(|k| y[k] + self.translation[k])
    }

    /// `x -> self(inner(x))`.
    pub fn after(&self, inner: &Affine) -> Affine {
        Affine { linear: product(&self.linear, &inner.linear), translation: self.apply(inner.translation) }
    }
}

/// The inverse of a matrix, and whether it has one: for one that crushes space (a node scaled to a plane) the
/// pseudo-inverse, which gives the nearest that the matrix can reach.
pub(super) fn inverse(m: &[f64; 9]) -> ([f64; 9], bool) {
    let determinant = |m: &[f64; 9], cofactor: &[f64; 9]| -> f64 { (0..3).map(|k| m[k] * cofactor[k]).sum() };
    let square: f64 = m.iter().map(|c| c * c).sum();
    let cof = cofactor(m);
    let det = determinant(m, &cof);
    if det.abs() > 1e-13 * square * square.sqrt() {
        return (transpose(&cof).map(|c| c / det), true);
    }
    if square == 0.0 || !square.is_finite() {
        return ([0.0; 9], false);
    }
    // Let B = m^T m, of rank 1 or 2. In rank 2 its cofactor matrix is a multiple of n n^T, n the crushed direction, and
    // (B + c n n^T)^-1 m^T is the pseudo-inverse for every c > 0; in rank 1 that is m^T / |m|^2.
    let across = transpose(m);
    let b = product(&across, m);
    let crushed = cofactor(&b);
    let trace = crushed[0] + crushed[4] + crushed[8];
    if trace <= 1e-26 * square * square {
        return (across.map(|c| c / square), false);
    }
    let filled: [f64; 9] = std::array::from_fn(|i| b[i] + square * crushed[i] / trace);
    let cof = cofactor(&filled);
    let det = determinant(&filled, &cof);
    (product(&transpose(&cof).map(|c| c / det), &across), false)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_times_its_pseudo_inverse_times_itself_is_itself() {
        let turned = Affine::from_parts([0.0; 3], [0.1, -0.5, 0.3, 0.8], [1.0; 3]).linear;
        for scale in [[2.0, 0.5, -3.0], [2.0, 0.0, 0.1], [0.0, 0.0, 4.0], [0.0; 3], [1e-6, 1.0, 1e3]] {
            let m = product(&turned, &[scale[0], 0.0, 0.0, 0.0, scale[1], 0.0, 0.0, 0.0, scale[2]]);
            let (inv, regular) = inverse(&m);
            assert_eq!(regular, scale.iter().all(|s| *s != 0.0), "{scale:?}");
            let again = product(&product(&m, &inv), &m);
            for k in 0..9 {
                assert!((again[k] - m[k]).abs() < 1e-9, "{scale:?} {m:?} {again:?}");
            }
        }
    }
}
