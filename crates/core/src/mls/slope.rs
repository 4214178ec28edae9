//! How the place to which a point goes changes with the point: the Jacobian of the whole map, its weights' change included.
//!
//! ```text
//! y = x + (M - I)(x - p*) + (q* - p*)
//! J = dy/dx = M (I - Dp*) + Dq* + sum_c (dM/dx_c)(x - p*) e_c^T
//! ```
//!
//! `Dp*`, `Dq*` and the change of C come from moments of [`Dual`] numbers. That of a rotation follows from what it is the best of: at
//! `R = argmax tr(R A)` the matrix `S = R A` is symmetric, and where A changes by dA it stays so:
//!
//! ```text
//! dR = [z] R,  (tr(S) I - S) z = the axis of the antisymmetric part of R dA
//! ```

use super::matrix::{apply, cholesky, norm, solve, Matrix};
use super::moments::Moments;
use super::number::{Dual, Number};
use super::{affine, oriented, rotation, Local, Mls, Transform, ANCHOR_WEIGHT};
use crate::softmax::Dominant;

type DualMatrix<const D: usize> = [[Dual<D>; D]; D];

impl<const D: usize> Mls<'_, D> {
    /// As [`Mls::deform`], of weights with their derivatives; and the Jacobian of where the point goes. `near` is the quaternion of a rotation that is
    /// near that of the point, and becomes its own.
    pub(crate) fn differentiate(
        &self,
        x: &[f64; D],
        relative: &[Dual<D>],
        dominant: Dominant<Dual<D>>,
        near: &mut [f64; 4],
    ) -> (Local<D>, Matrix<D>) {
        let base = (self.transform == Transform::Affine).then_some(&self.anchor.linear);
        let mut moments = Moments::new(self.p, self.q, relative, dominant, base);
        let added = oriented::add(&mut moments, &self.oriented, relative, dominant, base);
        let map: DualMatrix<D> = match self.transform {
            Transform::Rigid => turned(&moments.pq, &self.anchor.rotation, near),
            Transform::Similarity => {
                let rotation = turned(&moments.pq, &self.anchor.rotation, near);
                added.align(&mut moments, &rotation);
                let scale = scale(&moments, &rotation, self.anchor.scale);
                rotation.map(|row| row.map(|e| e * scale))
            }
            Transform::Affine => linear(&moments, &self.anchor.linear),
        };
        let arm: [Dual<D>; D] = std::array::from_fn(|k| {
            let here = Dual { value: x[k], slope: std::array::from_fn(|c| f64::from(u8::from(c == k))) };
            here - moments.p_mean[k]
        });
        let displacement: [Dual<D>; D] = std::array::from_fn(|r| {
            let moved = (0..D).fold(Dual::ZERO, |sum, c| sum + map[r][c] * arm[c]);
            moved - arm[r] + moments.shift[r]
        });
        let jacobian = std::array::from_fn(|r| {
            std::array::from_fn(|c| displacement[r].slope[c] + f64::from(u8::from(r == c)))
        });
        (Local { displacement: displacement.map(Number::value), map: values(&map) }, jacobian)
    }
}

fn values<const D: usize>(m: &DualMatrix<D>) -> Matrix<D> {
    m.map(|row| row.map(Number::value))
}

/// How it changes along an axis.
fn slopes<const D: usize>(m: &DualMatrix<D>, axis: usize) -> Matrix<D> {
    m.map(|row| row.map(|e| e.slope[axis]))
}

/// A matrix and how it changes along each axis.
fn joined<const D: usize>(value: &Matrix<D>, slopes: &[Matrix<D>; D]) -> DualMatrix<D> {
    std::array::from_fn(|r| {
        std::array::from_fn(|c| Dual {
            value: value[r][c],
            slope: std::array::from_fn(|axis| slopes[axis][r][c]),
        })
    })
}

fn product<const D: usize>(a: &Matrix<D>, b: &Matrix<D>) -> Matrix<D> {
    std::array::from_fn(|r| std::array::from_fn(|c| (0..D).map(|k| a[r][k] * b[k][c]).sum()))
}

fn sum_of_products<const D: usize>(a: &Matrix<D>, b: &Matrix<D>) -> f64 {
    a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| a * b).sum()
}

/// The rule for the rotation ([`rotation::anchored`]).
fn turned<const D: usize>(moment: &DualMatrix<D>, g: &Matrix<D>, near: &mut [f64; 4]) -> DualMatrix<D> {
    let value = values(moment);
    let r = rotation::anchored_near(&value, g, near);
    let size = norm(&value);
    let inverse = 1.0 / size;
    if D == 1 || size == 0.0 || !inverse.is_finite() {
        return joined(&r, &[[[0.0; D]; D]; D]);
    }
    let unit: Matrix<D> = value.map(|row| row.map(|e| e * inverse));
    let anchored = |of: &Matrix<D>, size: f64| -> Matrix<D> {
        std::array::from_fn(|i| std::array::from_fn(|k| of[i][k] + ANCHOR_WEIGHT * size * g[k][i]))
    };
    let turning = Turning::new(&r, &product(&r, &anchored(&unit, 1.0)));
    let along = std::array::from_fn(|axis| {
        let change = slopes(moment, axis).map(|row| row.map(|e| e * inverse));
        turning.change(&anchored(&change, sum_of_products(&unit, &change)))
    });
    joined(&r, &along)
}

/// A best rotation R of A, and what resists its turning.
struct Turning<'a, const D: usize> {
    r: &'a Matrix<D>,
    /// In 2D tr(S); 0 where the turn is open.
    trace: f64,
    /// In 3D `tr(S) I - S`, decomposed; `None` where the turn is open.
    lower: Option<Matrix<3>>,
}

impl<'a, const D: usize> Turning<'a, D> {
    fn new(r: &'a Matrix<D>, s: &Matrix<D>) -> Self {
        let trace: f64 = (0..D).map(|k| s[k][k]).sum();
        let lower = (D == 3).then(|| {
            let resistance: Matrix<3> = std::array::from_fn(|i| {
                std::array::from_fn(|k| f64::from(u8::from(i == k)) * trace - 0.5 * (s[i][k] + s[k][i]))
            });
            cholesky(&resistance)
        });
        Turning { r, trace, lower: lower.flatten() }
    }

    /// dR, where A changes by `da`. Where the turn is open there is no derivative, and it is left away.
    fn change(&self, da: &Matrix<D>) -> Matrix<D> {
        let ds = product(self.r, da);
        let mut cross = [[0.0; D]; D];
        if D == 2 {
            let z = if self.trace > 0.0 { (ds[0][1] - ds[1][0]) / self.trace } else { 0.0 };
            (cross[0][1], cross[1][0]) = (-z, z);
        } else if let Some(lower) = &self.lower {
            let z = solve(lower, [ds[1][2] - ds[2][1], ds[2][0] - ds[0][2], ds[0][1] - ds[1][0]]);
            for (k, z) in z.into_iter().enumerate() {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                (cross[i][j], cross[j][i]) = (-z, z);
            }
        }
        product(&cross, self.r)
    }
}

/// That of [`super::similarity::scale`].
fn scale<const D: usize>(moments: &Moments<D, Dual<D>>, rotation: &DualMatrix<D>, otherwise: f64) -> Dual<D> {
    let extent = (0..D).fold(Dual::ZERO, |sum, k| sum + moments.pp[k][k]);
    let entries = (0..D * D).map(|at| rotation[at / D][at % D] * moments.pq[at % D][at / D]);
    let along = entries.fold(Dual::ZERO, |sum, term| sum + term);
    let value = along.value / extent.value;
    if !(extent.value > 0.0 && value.is_finite()) {
        return Dual { value: otherwise, ..Dual::ZERO };
    }
    if value <= 0.0 {
        return Dual::ZERO;
    }
    let slope = std::array::from_fn(|c| (along.slope[c] - value * extent.slope[c]) / extent.value);
    Dual { value, slope }
}

/// That of [`affine::linear`]: from `X S = E^T` follows `dX S = dE^T - X dS`.
fn linear<const D: usize>(moments: &Moments<D, Dual<D>>, g: &Matrix<D>) -> DualMatrix<D> {
    let (pp, residual) = (values(&moments.pp), values(&moments.pq));
    let fitted = affine::linear(&residual, &pp, g);
    let size = norm(&pp);
    let Some(lower) = affine::ridged(&pp).as_ref().and_then(cholesky) else {
        return joined(&fitted, &[[[0.0; D]; D]; D]);
    };
    let along = std::array::from_fn(|axis| {
        let (dp, de) = (slopes(&moments.pp, axis), slopes(&moments.pq, axis));
        let growth = sum_of_products(&pp, &dp) / size;
        let ds: Matrix<D> = std::array::from_fn(|r| {
            std::array::from_fn(|c| dp[r][c] + if r == c { affine::RIDGE * growth } else { 0.0 })
        });
        std::array::from_fn(|r| {
            let row: [f64; D] = std::array::from_fn(|c| fitted[r][c] - g[r][c]);
            // Symmetric: X dS, row by row.
            let moved = apply(&ds, &row);
            solve(&lower, std::array::from_fn(|c| (de[c][r] - moved[c]) / size))
        })
    });
    joined(&fitted, &along)
}
