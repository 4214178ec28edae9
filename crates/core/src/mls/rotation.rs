//! The rotation nearest to a moment matrix.
//!
//! `R = argmax over SO(d) of tr(R (C / |C| + 1e-9 G^T))` (docs/rotation.md, eq. 2): a rotation, never a reflection, whatever the sign of det C; it does
//! not depend on the scale of the weights; and where C lacks rank, what it leaves open follows the anchor G.
//!
//! At very low temperatures it is the anchor that decides, and not the paper's equation: below T of about 0.3 what C says of a turn falls below
//! 1e-9 of its size at ever more points (against 400 digits, rotations differ by 8e-4 at T = 0.3, by 0.26 at T = 0.1). That is deliberate: there the
//! equation hangs on weights below 1e-9 of those that count, and turns each point by another angle, while the anchor turns it with the whole.
//!
//! 3D: Horn, "Closed-form solution of absolute orientation using unit quaternions", 1987: the best quaternion is the
//! eigenvector of a symmetric 4 x 4 matrix for its largest eigenvalue, which cyclic Jacobi rotations find to full
//! precision relative to the gap, with no special cases.

use super::matrix::{cholesky, norm, solve, Matrix};

/// How much the global map counts against the local one, relative to its size: enough to decide what is open, too little to
/// be seen where anything is determined.
pub const ANCHOR_WEIGHT: f64 = 1e-9;

/// The rule: the rotation that `moment` (C, at any scale) asks for, with the anchor `g` where it leaves something open.
pub(super) fn anchored<const D: usize>(moment: &Matrix<D>, g: &Matrix<D>) -> Matrix<D> {
    best_rotation(&target(moment, g))
}

/// The same from a rotation that is near it, as that of a place nearby is, by Newton's method: `u`, which becomes its own. In 3D sooner there than
/// Jacobi rotations are.
pub(super) fn anchored_near<const D: usize>(
    moment: &Matrix<D>,
    g: &Matrix<D>,
    u: &mut [f64; 4],
) -> Matrix<D> {
    let target = target(moment, g);
    if D != 3 {
        return best_rotation(&target);
    }
    *u = refined(&target, *u).unwrap_or_else(|| best_quaternion(&target));
    let full = of_quaternion(u);
    std::array::from_fn(|r| std::array::from_fn(|c| full[r][c]))
}

/// Newton's method for `tr(R A)` (docs/rotation.md, eq. 9) until a step leaves nothing; `None` where it is not at the maximum, where alone
/// `H = tr(S) I - S` is positive definite, or takes too long.
fn refined<const D: usize>(a: &Matrix<D>, mut u: [f64; 4]) -> Option<[f64; 4]> {
    /// From a tenth of a radian there are three.
    const MOST_STEPS: usize = 5;
    /// The square of a last step, which leaves its own square.
    const LAST: f64 = 1e-16;
    for _ in 0..MOST_STEPS {
        let r = of_quaternion(&u);
        let s: Matrix<3> =
            std::array::from_fn(|i| std::array::from_fn(|k| (0..3).map(|l| r[i][l] * a[l][k]).sum()));
        let trace = s[0][0] + s[1][1] + s[2][2];
        let h: Matrix<3> = std::array::from_fn(|i| {
            std::array::from_fn(|k| f64::from(u8::from(i == k)) * trace - 0.5 * (s[i][k] + s[k][i]))
        });
        let z = solve(&cholesky(&h)?, [s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]]);
        let size: f64 = z.iter().map(|e| e * e).sum();
        // Not if it is NaN; a longer step than a radian is out of what the method is good for.
        if size.is_nan() || size > 1.0 {
            return None;
        }
        u = turned_by(&u, &z.map(|e| 0.5 * e));
        if size < LAST {
            return Some(u);
        }
    }
    None
}

/// `C / |C| + 1e-9 G^T`.
fn target<const D: usize>(moment: &Matrix<D>, g: &Matrix<D>) -> Matrix<D> {
    let size = norm(moment);
    let inverse = if size > 0.0 { 1.0 / size } else { 0.0 };
    let inverse = if inverse.is_finite() { inverse } else { 0.0 };
    std::array::from_fn(|r| std::array::from_fn(|c| moment[r][c] * inverse + ANCHOR_WEIGHT * g[c][r]))
}

/// The mean of the rotations that fit `moment` almost as well as the best one: as [`anchored`] where the best one fits better than any
/// that is turned against it by at least the `part` of what it does at rest (`rest` is the moment matrix of p with itself); no rotation, and
/// shorter, where it does not.
///
/// `sum f_i R(u_i) / sum f_i`, with `u_i` the eigenvectors of Horn's matrix and `f_i = max(0, 1 - (l_1 - l_i) / gap)`, `l_i` their eigenvalues, the
/// `tr(R C)` of each. Unlike the best rotation it has no jumps: it changes by at most about `1 / gap` times what C changes.
pub(super) fn mean<const D: usize>(
    moment: &Matrix<D>,
    g: &Matrix<D>,
    rest: &Matrix<D>,
    part: f64,
) -> Matrix<D> {
    let size = norm(moment);
    let target = target(moment, g);
    let part = if size > 0.0 { part / size } else { 0.0 };
    let mut r = [[0.0; D]; D];
    match D {
        1 => r[0][0] = 1.0,
        2 => {
            let best = best_rotation(&target);
            let (cos, sin) = (target[0][0] + target[1][1], target[0][1] - target[1][0]);
            // Of the best and that which is turned by half a turn against it, which cancels it.
            let gap = part * 2.0 * (rest[0][0] + rest[1][1]);
            let other = (1.0 - 2.0 * cos.hypot(sin) / gap).max(0.0);
            r = best.map(|row| row.map(|e| e * (1.0 - other) / (1.0 + other)));
        }
        _ => {
            let (values, vectors) = eigen(horn(&target));
            let best = greatest(&values);
            let next = (0..4).filter(|&i| i != best).map(|i| values[i]).fold(f64::MIN, f64::max);
            // Of symmetric matrices without negative eigenvalues this is the sum of the two lesser ones, twice. Bounded first, which is cheap.
            let diagonal = || (0..D).map(|k| rest[k][k]);
            let bound = 2.0 * (diagonal().sum::<f64>() - diagonal().fold(0.0, f64::max));
            let gap = if values[best] - next >= part * bound { 0.0 } else { part * gap(horn(rest)) };
            let mut sum = 0.0;
            for (i, value) in values.iter().enumerate() {
                // Where the gap is 0 only the best counts.
                let share = if i == best { 1.0 } else { (1.0 - (values[best] - value) / gap).max(0.0) };
                if share > 0.0 {
                    let one = of_quaternion(&unit(&vectors, i));
                    for (row, one) in r.iter_mut().zip(one) {
                        row.iter_mut().zip(one).for_each(|(sum, e)| *sum += share * e);
                    }
                    sum += share;
                }
            }
            r.iter_mut().flatten().for_each(|e| *e /= sum);
        }
    }
    r
}

/// By how much the greatest eigenvalue is above the next.
fn gap(n: [[f64; 4]; 4]) -> f64 {
    let (mut values, _) = eigen(n);
    values.sort_by(f64::total_cmp);
    values[3] - values[2]
}

/// The rotation `R` that maximises `tr(R C)`.
pub fn best_rotation<const D: usize>(c: &Matrix<D>) -> Matrix<D> {
    let mut r = [[1.0; D]; D];
    match D {
        1 => {}
        2 => {
            let (cos, sin) = (c[0][0] + c[1][1], c[0][1] - c[1][0]);
            let length = cos.hypot(sin);
            let (cos, sin) = if length > 0.0 { (cos / length, sin / length) } else { (1.0, 0.0) };
            (r[0][0], r[0][1], r[1][0], r[1][1]) = (cos, -sin, sin, cos);
        }
        _ => {
            let full = of_quaternion(&best_quaternion(c));
            for (row, full) in r.iter_mut().zip(full) {
                row.copy_from_slice(&full[..D]);
            }
        }
    }
    r
}

/// Its quaternion, in 3D.
pub(crate) fn best_quaternion<const D: usize>(c: &Matrix<D>) -> [f64; 4] {
    let (values, vectors) = eigen(horn(c));
    unit(&vectors, greatest(&values))
}

/// Horn's matrix (docs/rotation.md, eq. 3): `tr(R C) = u^T N u` for the rotation of the unit quaternion `u = (w, x, y, z)`.
fn horn<const D: usize>(s: &Matrix<D>) -> [[f64; 4]; 4] {
    let (yz, zx, xy) = (s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]);
    let (pxy, pyz, pzx) = (s[0][1] + s[1][0], s[1][2] + s[2][1], s[2][0] + s[0][2]);
    [
        [s[0][0] + s[1][1] + s[2][2], yz, zx, xy],
        [yz, s[0][0] - s[1][1] - s[2][2], pxy, pzx],
        [zx, pxy, s[1][1] - s[0][0] - s[2][2], pyz],
        [xy, pzx, pyz, s[2][2] - s[0][0] - s[1][1]],
    ]
}

/// Cyclic Jacobi: plane rotations that zero the off-diagonal, accumulated. The eigenvalues, and the eigenvectors in columns.
pub(crate) fn eigen<const N: usize>(mut n: [[f64; N]; N]) -> ([f64; N], [[f64; N]; N]) {
    /// Jacobi converges quadratically: a 4 x 4 matrix is done after 4 to 6 sweeps.
    const MOST_SWEEPS: usize = 24;
    let mut vectors = [[0.0; N]; N];
    for (i, row) in vectors.iter_mut().enumerate() {
        row[i] = 1.0;
    }
    for _ in 0..MOST_SWEEPS {
        let mut rotated = false;
        for i in 0..N - 1 {
            for j in i + 1..N {
                let off = n[i][j];
                // Too small to change either diagonal entry, twice over.
                if off.abs() <= 1e-18 * (n[i][i].abs() + n[j][j].abs()) {
                    continue;
                }
                rotated = true;
                let theta = (n[j][j] - n[i][i]) / (2.0 * off);
                let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
                let cos = 1.0 / t.hypot(1.0);
                let sin = t * cos;
                n[i][i] -= t * off;
                n[j][j] += t * off;
                n[i][j] = 0.0;
                n[j][i] = 0.0;
                for k in 0..N {
                    if k != i && k != j {
                        let (ki, kj) = (n[k][i], n[k][j]);
                        n[k][i] = cos * ki - sin * kj;
                        n[k][j] = sin * ki + cos * kj;
                        n[i][k] = n[k][i];
                        n[j][k] = n[k][j];
                    }
                    let (vi, vj) = (vectors[k][i], vectors[k][j]);
                    vectors[k][i] = cos * vi - sin * vj;
                    vectors[k][j] = sin * vi + cos * vj;
                }
            }
        }
        if !rotated {
            break;
        }
    }
    (std::array::from_fn(|i| n[i][i]), vectors)
}

/// The first of the greatest.
fn greatest(values: &[f64; 4]) -> usize {
    (1..4).fold(0, |most, i| if values[i] > values[most] { i } else { most })
}

/// A column of `vectors`, of length 1.
fn unit(vectors: &[[f64; 4]; 4], column: usize) -> [f64; 4] {
    let u: [f64; 4] = std::array::from_fn(|k| vectors[k][column]);
    let length = u.iter().map(|c| c * c).sum::<f64>().sqrt();
    u.map(|c| c / length)
}

pub(super) fn of_quaternion(&[w, x, y, z]: &[f64; 4]) -> [[f64; 3]; 3] {
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

/// The quaternion `(1, z)` times `u`, its length 1.
pub(super) fn turned_by(&[w, x, y, z]: &[f64; 4], t: &[f64; 3]) -> [f64; 4] {
    let u = [
        w - t[0] * x - t[1] * y - t[2] * z,
        x + t[0] * w + t[1] * z - t[2] * y,
        y + t[1] * w + t[2] * x - t[0] * z,
        z + t[2] * w + t[0] * y - t[1] * x,
    ];
    let length = u.iter().map(|c| c * c).sum::<f64>().sqrt();
    u.map(|c| c / length)
}
