//! The rotation, and the scale, that a control point may carry besides its target.

use crate::error::Error;
use crate::text::{float, general};

/// Rounding, and a file's last digits, may leave this much of `R^T R - I`.
const ROUNDING: f64 = 1e-6;

const AXIS: [f64; 3] = [0.0, 0.0, 1.0];

/// How a control point is oriented: turned about an axis by an angle, and scaled.
///
/// In the plane the axis is (0, 0, 1); on a line the angle is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orientation {
    /// Not all 0, of any length. Seen from its tip, positive angles turn counterclockwise.
    pub axis: [f64; 3],
    /// The angle.
    pub degrees: f64,
    /// How much larger the surroundings become, > 0. Rigid deformations leave it away.
    pub scale: f64,
}

impl Orientation {
    /// The orientation of these numbers.
    ///
    /// # Errors
    /// An argument, where a number is out of its range.
    pub fn new(axis: [f64; 3], degrees: f64, scale: f64) -> Result<Self, Error> {
        if axis.iter().any(|c| !c.is_finite()) || axis == [0.0; 3] {
            let found: Vec<String> = axis.iter().map(|&c| float(c)).collect();
            let found = found.join(", ");
            let expected = "expected three finite numbers that are not all 0";
            return Err(Error::argument(format!("axis: {expected}, found [{found}]")));
        }
        if !degrees.is_finite() {
            return Err(Error::argument(format!(
                "degrees: expected a finite number, found {}",
                float(degrees)
            )));
        }
        if !(scale > 0.0 && scale.is_finite()) {
            return Err(Error::argument(format!("scale: expected a number above 0, found {}", float(scale))));
        }
        Ok(Orientation { axis, degrees, scale })
    }

    /// That which scales only.
    ///
    /// # Errors
    /// An argument, where the scale is not above 0.
    pub fn of_scale(scale: f64) -> Result<Self, Error> {
        Orientation::new(AXIS, 0.0, scale)
    }

    /// The orientation of a rotation matrix, row-major, `dim` x `dim`.
    ///
    /// # Errors
    /// An argument, where it is no rotation, or the scale is not above 0.
    pub fn of_matrix(matrix: &[f64], dim: usize, scale: f64) -> Result<Self, Error> {
        check_rotation(matrix, dim)?;
        match dim {
            1 => Orientation::of_scale(scale),
            2 => Orientation::new(AXIS, matrix[2].atan2(matrix[0]).to_degrees(), scale),
            _ => {
                let (axis, degrees) = of_quaternion(quaternion(matrix));
                Orientation::new(axis, degrees, scale)
            }
        }
    }

    /// The rotation without the scale, row-major, 3 x 3.
    pub fn matrix(&self) -> [f64; 9] {
        let (sin, cos) = (self.degrees % 360.0).to_radians().sin_cos();
        // Squares of very small or large numbers would be 0 or infinite.
        let largest = self.axis.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
        let [x, y, z] = self.axis.map(|c| c / largest);
        let length = (x * x + y * y + z * z).sqrt();
        let [x, y, z] = [x / length, y / length, z / length];
        let rest = 1.0 - cos;
        [
            1.0 - rest * (y * y + z * z),
            rest * (x * y) - sin * z,
            rest * (x * z) + sin * y,
            rest * (x * y) + sin * z,
            1.0 - rest * (x * x + z * z),
            rest * (y * z) - sin * x,
            rest * (x * z) - sin * y,
            rest * (y * z) + sin * x,
            1.0 - rest * (x * x + y * y),
        ]
    }

    /// The rotation without the scale, row-major, `dim` x `dim`.
    pub fn rotation(&self, dim: usize) -> Vec<f64> {
        match dim {
            1 => vec![1.0],
            2 => {
                let (sin, cos) = (self.degrees % 360.0).to_radians().sin_cos();
                vec![cos, -sin, sin, cos]
            }
            _ => self.matrix().to_vec(),
        }
    }

    /// The axis, as long as the angle is in radians: a turn of 370 degrees is not one of 10.
    pub fn vector(&self) -> [f64; 3] {
        let largest = self.axis.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
        let axis = self.axis.map(|c| c / largest);
        let length = axis.iter().map(|c| c * c).sum::<f64>().sqrt();
        axis.map(|c| self.degrees.to_radians() * c / length)
    }

    /// Oriented like this, and then by `further`.
    pub fn then(&self, further: &Orientation) -> Orientation {
        let (a, b) = (further.matrix(), self.matrix());
        let product: Vec<f64> =
            (0..9).map(|at| (0..3).map(|k| a[at / 3 * 3 + k] * b[k * 3 + at % 3]).sum()).collect();
        let (axis, degrees) = of_quaternion(quaternion(&product));
        // Two turns in the plane stay there, whichever way round is shorter.
        let (axis, degrees) = if axis == [0.0, 0.0, -1.0] { (AXIS, -degrees) } else { (axis, degrees) };
        Orientation { axis, degrees, scale: self.scale * further.scale }
    }

    /// Whether a control point of `dim` coordinates can be oriented so.
    pub fn fits(&self, dim: usize) -> bool {
        let [x, y, z] = self.axis;
        match dim {
            1 => self.degrees == 0.0,
            2 => x == 0.0 && y == 0.0 && z > 0.0,
            _ => true,
        }
    }
}

/// x, y, z, w of a rotation matrix, from the largest of them (Shepperd 1978).
fn quaternion(r: &[f64]) -> [f64; 4] {
    let [xx, yy, zz] = [r[0], r[4], r[8]];
    let squares = [1.0 + xx - yy - zz, 1.0 - xx + yy - zz, 1.0 - xx - yy + zz, 1.0 + xx + yy + zz];
    let largest = (0..4).fold(0, |best, k| if squares[k] > squares[best] { k } else { best });
    let (yx, zx, zy) = (r[3] + r[1], r[6] + r[2], r[7] + r[5]);
    let (wx, wy, wz) = (r[7] - r[5], r[2] - r[6], r[3] - r[1]);
    let rows = [
        [squares[0], yx, zx, wx],
        [yx, squares[1], zy, wy],
        [zx, zy, squares[2], wz],
        [wx, wy, wz, squares[3]],
    ];
    let row = rows[largest];
    let length = row.iter().map(|c| c * c).sum::<f64>().sqrt();
    row.map(|c| c / length)
}

/// Axis and degrees, the angle at most half a turn.
fn of_quaternion([x, y, z, w]: [f64; 4]) -> ([f64; 3], f64) {
    let length = x.hypot(y).hypot(z);
    // As close to none as doubles tell.
    if length < 1e-12 {
        return (AXIS, 0.0);
    }
    let side = if w >= 0.0 { 1.0 } else { -1.0 };
    let axis = [x, y, z].map(|c| side * c / length + 0.0);
    (axis, (2.0 * length.atan2(side * w)).to_degrees())
}

fn check_rotation(matrix: &[f64], dim: usize) -> Result<(), Error> {
    if !(1..=3).contains(&dim) || matrix.len() != dim * dim {
        let found = matrix.len();
        let message = format!("matrix: expected a matrix (d, d) with d = 1, 2 or 3, found {found} numbers");
        return Err(Error::argument(message));
    }
    if matrix.iter().any(|c| !c.is_finite()) {
        return Err(Error::argument("matrix is not a rotation: it has numbers that are not finite"));
    }
    let product =
        |i: usize, j: usize| (0..dim).map(|k| matrix[k * dim + i] * matrix[k * dim + j]).sum::<f64>();
    let off = (0..dim * dim)
        .map(|at| (product(at / dim, at % dim) - if at / dim == at % dim { 1.0 } else { 0.0 }).abs())
        .fold(0.0, f64::max);
    if off > ROUNDING {
        let off = general(off, 3);
        let message = format!("matrix is not a rotation: its columns are not orthonormal, off by {off}");
        return Err(Error::argument(message));
    }
    if determinant(matrix, dim) < 0.0 {
        return Err(Error::argument("matrix is not a rotation: its determinant is -1, as a reflection's"));
    }
    Ok(())
}

fn determinant(m: &[f64], dim: usize) -> f64 {
    match dim {
        1 => m[0],
        2 => m[0] * m[3] - m[1] * m[2],
        _ => {
            m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6])
                + m[2] * (m[3] * m[7] - m[4] * m[6])
        }
    }
}

#[cfg(test)]
mod tests;
