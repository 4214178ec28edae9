//! The scale of a similarity, and the affine map, in lanes: [`super::super::similarity`] and [`super::super::affine`].

use super::super::affine::RIDGE;
use super::super::matrix::Matrix;
use super::{multiply_add, Lane, BATCH};

/// From `R - I` to `s R - I`, `s = tr(R C) / extent`, at least 0.
#[inline(always)]
pub(super) fn scale<const FMA: bool>(
    moment: &[Lane; 9],
    extent: &Lane,
    change: &mut [Lane; 9],
    sound: &mut Lane,
) {
    for lane in 0..BATCH {
        let mut trace = moment[0][lane] + moment[4][lane] + moment[8][lane];
        for r in 0..3 {
            for c in 0..3 {
                trace = multiply_add::<FMA>(change[3 * r + c][lane], moment[3 * c + r][lane], trace);
            }
        }
        let ratio = trace / extent[lane];
        let known = extent[lane] > 1e-30 && ratio < 1e30;
        let ratio = if ratio > 0.0 { ratio } else { 0.0 };
        for k in 0..9 {
            let one = if k % 4 == 0 { ratio - 1.0 } else { 0.0 };
            change[k][lane] = multiply_add::<FMA>(change[k][lane], ratio, one);
        }
        sound[lane] = if known { sound[lane] } else { 0.0 };
    }
}

/// Below this, the control points lie so flat that rounding shows in the map (by 1e-16 over it); the twin's does as well, but differently.
const FLAT: f64 = 1e-9;

/// `M - I = G - I + E^T (P / |P| + ridge)^-1 / |P|`, E the moments of the residuals of G; by P = L D L^T.
#[inline(always)]
pub(super) fn affine<const FMA: bool>(
    residual: &[Lane; 9],
    extent: &[Lane; 6],
    g: &Matrix<3>,
    change: &mut [Lane; 9],
    sound: &mut Lane,
) {
    let mut rest = *g;
    for (k, row) in rest.iter_mut().enumerate() {
        row[k] -= 1.0;
    }
    for lane in 0..BATCH {
        let (xx, xy, xz) = (extent[0][lane], extent[1][lane], extent[2][lane]);
        let (yy, yz, zz) = (extent[3][lane], extent[4][lane], extent[5][lane]);
        let square = xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + xz * xz + yz * yz);
        let inverse = 1.0 / square.sqrt();
        // P / |P| = L D L^T.
        let d0 = xx * inverse + RIDGE;
        let i0 = 1.0 / d0;
        let (p10, p20) = (xy * inverse, xz * inverse);
        let (l10, l20) = (p10 * i0, p20 * i0);
        let d1 = yy * inverse + RIDGE - l10 * p10;
        let i1 = 1.0 / d1;
        let p21 = yz * inverse - l20 * p10;
        let l21 = p21 * i1;
        let d2 = zz * inverse + RIDGE - l20 * p20 - l21 * p21;
        let i2 = 1.0 / d2;
        let known = square > 1e-60 && square < 1e60 && d1 > FLAT && d2 > FLAT;
        for r in 0..3 {
            let b0 = residual[r][lane] * inverse;
            let b1 = residual[3 + r][lane] * inverse - l10 * b0;
            let b2 = residual[6 + r][lane] * inverse - l20 * b0 - l21 * b1;
            let c2 = b2 * i2;
            let c1 = b1 * i1 - l21 * c2;
            let c0 = b0 * i0 - l10 * c1 - l20 * c2;
            change[3 * r][lane] = rest[r][0] + c0;
            change[3 * r + 1][lane] = rest[r][1] + c1;
            change[3 * r + 2][lane] = rest[r][2] + c2;
        }
        sound[lane] = if known { 1.0 } else { 0.0 };
    }
}
