//! The rule for the rotation (DESIGN, [`super::super::rotation`]) in lanes: Horn's quaternion by the characteristic polynomial.
//!
//! ```text
//! A = C / |C| + 1e-9 G^T, scaled to |A| = 1
//! K = cofactors of A    k = |K|^2    d = det A = <A, cofactors of K>
//! v = largest root of (v (2 + v))^2 = 8 d (1 + v) + 4 k, by Newton's method from above
//! u = column of the adjugate of N(A) - (1 + v) I with the largest diagonal, times that adjugate
//! R - I from the quaternion u
//! ```
//!
//! Horn 1987 has the matrix N and its quartic; the largest eigenvalue is s1 + s2 + s3, with s3 < 0 where det A < 0: a
//! rotation, never a reflection. What differs: the unknown is the eigenvalue less 1, and the quartic is written in
//! the cofactors. Where A is close to rank 1 (low temperatures) all eigenvalues are close to 1 or -1, and the roots
//! of the ordinary form lose half of their digits; k, d and v here are small numbers that keep theirs: the
//! error of v is that of A's entries. The quartic has four real roots, so that Newton's steps from above never pass the largest.

use super::super::matrix::Matrix;
use super::{multiply_add, multiply_add_f32, Lane, ANCHOR_WEIGHT, BATCH};

/// Newton's steps before the first look at whether all lanes are done: enough for nearly all of them.
const FIRST_STEPS: usize = 4;
/// Steps between two looks.
const STEPS: usize = 3;
/// A lane that needs more looks than this has two roots so close that rounding hides which is which.
const MOST_LOOKS: usize = 8;
/// How much the slope may cancel.
const MIRRORED: f64 = 32.0;
/// Rounding of the quartic's coefficients, relative to the length of K; and of the adjugate.
const ROUNDING: f64 = 2e-15;

/// What the rotation is found by.
pub(super) struct Turn {
    pub a: [Lane; 9],
    pub d: Lane,
    pub k: Lane,
    pub v: Lane,
    /// The quartic's derivative at v, `8 (s1 + s2)(s1 + s3)(s2 + s3)`.
    pub slope: Lane,
}

/// `R - I` of each lane whose moments are `moment`, and whether it is sound.
#[inline(always)]
pub(super) fn rotations<const FMA: bool>(
    moment: &[Lane; 9],
    g: &Matrix<3>,
    turn: &mut Turn,
    change: &mut [Lane; 9],
    sound: &mut Lane,
) {
    let Turn { a, d, k, v, slope } = turn;
    normalise::<FMA>(moment, g, a, sound);
    coefficients::<FMA>(a, d, k, v);
    largest_root::<FMA>(d, k, v, slope);
    judge(k, v, d, slope, sound);
    quaternions::<FMA>(a, v, change);
}

/// `A`.
#[inline(always)]
fn normalise<const FMA: bool>(moment: &[Lane; 9], g: &Matrix<3>, a: &mut [Lane; 9], sound: &mut Lane) {
    for lane in 0..BATCH {
        let mut square = 0.0;
        for k in 0..9 {
            square = multiply_add::<FMA>(moment[k][lane], moment[k][lane], square);
        }
        // Single precision is enough for a first scale: the second one corrects it to the last digit.
        let inverse = f64::from(1.0 / (square as f32).sqrt());
        let known = square > 1e-30 && square < 1e30;
        let inverse = if known { inverse } else { 0.0 };
        let mut entries = [0.0; 9];
        let mut excess = -1.0;
        for (k, entry) in entries.iter_mut().enumerate() {
            *entry = multiply_add::<FMA>(moment[k][lane], inverse, ANCHOR_WEIGHT * g[k % 3][k / 3]);
            excess = multiply_add::<FMA>(*entry, *entry, excess);
        }
        // (1 + e)^(-1/2).
        let scale = 1.0 - excess * (0.5 - 0.375 * excess);
        for k in 0..9 {
            a[k][lane] = entries[k] * scale;
        }
        sound[lane] = if known { 1.0 } else { 0.0 };
    }
}

/// The cofactors of a 3 x 3 matrix.
#[inline(always)]
fn cofactors<const FMA: bool>(a: &[f64; 9]) -> [f64; 9] {
    let minor = |i: usize, j: usize, k: usize, l: usize| multiply_add::<FMA>(a[i], a[j], -(a[k] * a[l]));
    [
        minor(4, 8, 5, 7),
        minor(5, 6, 3, 8),
        minor(3, 7, 4, 6),
        minor(2, 7, 1, 8),
        minor(0, 8, 2, 6),
        minor(1, 6, 0, 7),
        minor(1, 5, 2, 4),
        minor(2, 3, 0, 5),
        minor(0, 4, 1, 3),
    ]
}

/// d, k and a bound of v that is v itself where s3 is 0 or s1: with `b = s1 s2 + s1 s3 + s2 s3`, `b^2 = k + 2 d (1 + v)`, and
/// `v <= sqrt(3) - 1`; then `v = sqrt(1 + 2 b) - 1`.
#[inline(always)]
fn coefficients<const FMA: bool>(a: &[Lane; 9], d: &mut Lane, k: &mut Lane, v: &mut Lane) {
    for lane in 0..BATCH {
        let entries: [f64; 9] = [
            a[0][lane], a[1][lane], a[2][lane], a[3][lane], a[4][lane], a[5][lane], a[6][lane], a[7][lane],
            a[8][lane],
        ];
        let first = cofactors::<FMA>(&entries);
        let second = cofactors::<FMA>(&first);
        let (mut square, mut determinant) = (0.0, 0.0);
        for i in 0..9 {
            square = multiply_add::<FMA>(first[i], first[i], square);
            determinant = multiply_add::<FMA>(entries[i], second[i], determinant);
        }
        d[lane] = determinant;
        k[lane] = square;
        // In single precision, and a little more than that.
        let positive = if determinant > 0.0 { determinant } else { 0.0 };
        let b = 1.000_001 * multiply_add_f32::<FMA>(3.464_102, positive as f32, square as f32).sqrt();
        v[lane] = f64::from(2.0 * b / (1.0 + (1.0 + 2.0 * b).sqrt()));
    }
}

/// Newton's method for v.
#[inline(always)]
fn largest_root<const FMA: bool>(d: &Lane, k: &Lane, v: &mut Lane, slope: &mut Lane) {
    let mut restless = descend::<FMA, FIRST_STEPS>(d, k, v, slope);
    for _ in 0..MOST_LOOKS {
        if restless == 0.0 {
            break;
        }
        restless = descend::<FMA, STEPS>(d, k, v, slope);
    }
}

/// `N` steps of each lane; gives how many lanes may want more.
#[inline(always)]
fn descend<const FMA: bool, const N: usize>(d: &Lane, k: &Lane, v: &mut Lane, slope: &mut Lane) -> f64 {
    let mut open = [0.0; BATCH];
    for lane in 0..BATCH {
        let (d8, k4) = (8.0 * d[lane], 4.0 * k[lane]);
        let (mut root, mut step, mut derivative) = (v[lane], 0.0, 0.0);
        for _ in 0..N {
            (step, derivative) = newton::<FMA>(d8, k4, root);
            root -= step;
        }
        v[lane] = root;
        slope[lane] = derivative;
        // What a step leaves is of the order of its square over the slope; the polish squares its ratio to the gap again.
        open[lane] = if step.abs() <= 1e-5 * derivative { 0.0 } else { 1.0 };
    }
    open.iter().sum()
}

/// A step of Newton's method, and the derivative.
#[inline(always)]
fn newton<const FMA: bool>(d8: f64, k4: f64, v: f64) -> (f64, f64) {
    // e = v (2 + v) is the eigenvalue's square less 1.
    let e = multiply_add::<FMA>(v, v, 2.0 * v);
    let value = multiply_add::<FMA>(e, e, -multiply_add::<FMA>(d8, v, d8 + k4));
    let derivative = multiply_add::<FMA>(4.0 * e, v, multiply_add::<FMA>(4.0, e, -d8));
    // A division in single precision: a step may be wrong in its eighth digit, the next one is right in the sixteenth.
    let step = value * f64::from(1.0 / derivative as f32);
    (if derivative > 0.0 { step } else { 0.0 }, derivative)
}

/// A lane is sound if the error of v is small beside the distance to the next eigenvalue, so is the rounding of the adjugate, and so is
/// that of the weights, which are single: without a mirror the length of K is an eighth of the slope at most, and their
/// rounding turns nothing by more than itself; with one, what K measures cancels in the slope.
#[inline(always)]
fn judge(k: &Lane, v: &Lane, d: &Lane, slope: &Lane, sound: &mut Lane) {
    for lane in 0..BATCH {
        let (t, root) = (slope[lane], v[lane]);
        let length = f64::from((k[lane] as f32).sqrt());
        let e = root * (2.0 + root);
        let value = (e * e - 8.0 * d[lane] * (1.0 + root) - 4.0 * k[lane]).abs();
        // The step that is still open, and the one that rounding hides: both divided by the gap, which is above t / 11.
        // The quaternion's polish squares their ratio.
        let open = value + ROUNDING * length;
        let good = t > 1e-9 && length < MIRRORED * t && 11.0 * open < 1e-4 * t * t;
        sound[lane] = if good { sound[lane] } else { 0.0 };
    }
}

/// `R - I` from the adjugate of `N - (1 + v) I`, which is a multiple of the quaternion's outer product with itself.
#[inline(always)]
fn quaternions<const FMA: bool>(a: &[Lane; 9], v: &Lane, change: &mut [Lane; 9]) {
    let fma = multiply_add::<FMA>;
    for lane in 0..BATCH {
        let [xx, xy, xz, yx, yy, yz, zx, zy, zz] = [
            a[0][lane], a[1][lane], a[2][lane], a[3][lane], a[4][lane], a[5][lane], a[6][lane], a[7][lane],
            a[8][lane],
        ];
        let largest = 1.0 + v[lane];
        let (n01, n02, n03) = (yz - zy, zx - xz, xy - yx);
        let (n12, n13, n23) = (xy + yx, zx + xz, yz + zy);
        let n00 = (xx + yy + zz) - largest;
        let n11 = (xx - yy - zz) - largest;
        let n22 = (yy - xx - zz) - largest;
        let n33 = (zz - xx - yy) - largest;
        // Minors of the upper two rows, and of the lower two.
        let minor = |a: f64, b: f64, c: f64, d: f64| fma(a, b, -(c * d));
        let s0 = minor(n00, n11, n01, n01);
        let s1 = minor(n00, n12, n01, n02);
        let s2 = minor(n00, n13, n01, n03);
        let s3 = minor(n01, n12, n11, n02);
        let s4 = minor(n01, n13, n11, n03);
        let s5 = minor(n02, n13, n12, n03);
        let c5 = minor(n22, n33, n23, n23);
        let c4 = minor(n12, n33, n13, n23);
        let c3 = minor(n12, n23, n13, n22);
        let c2 = minor(n02, n33, n03, n23);
        let c1 = minor(n02, n23, n03, n22);
        let three = |a: f64, b: f64, c: f64, d: f64, e: f64, f: f64| fma(a, b, fma(-c, d, e * f));
        let b00 = three(n11, c5, n12, c4, n13, c3);
        let b01 = -three(n01, c5, n02, c4, n03, c3);
        let b02 = three(n13, s5, n23, s4, n33, s3);
        let b03 = -three(n12, s5, n22, s4, n23, s3);
        let b11 = three(n00, c5, n02, c2, n03, c1);
        let b12 = -three(n03, s5, n23, s2, n33, s1);
        let b13 = three(n02, s5, n22, s2, n23, s1);
        let b22 = three(n03, s4, n13, s2, n33, s0);
        let b23 = -three(n02, s4, n12, s2, n23, s0);
        let b33 = three(n02, s3, n12, s1, n22, s0);
        // The column with the largest diagonal.
        let (mut u, mut best) = ([b00, b01, b02, b03], b00.abs());
        for (column, diagonal) in
            [([b01, b11, b12, b13], b11), ([b02, b12, b22, b23], b22), ([b03, b13, b23, b33], b33)]
        {
            let better = diagonal.abs() > best;
            for i in 0..4 {
                u[i] = if better { column[i] } else { u[i] };
            }
            best = if better { diagonal.abs() } else { best };
        }
        // A step of inverse iteration with the same adjugate.
        let dot = |p: f64, q: f64, r: f64, s: f64| fma(p, u[0], fma(q, u[1], fma(r, u[2], s * u[3])));
        let (w, x, y, z) = (
            dot(b00, b01, b02, b03),
            dot(b01, b11, b12, b13),
            dot(b02, b12, b22, b23),
            dot(b03, b13, b23, b33),
        );
        let two = 2.0 / fma(w, w, fma(x, x, fma(y, y, z * z)));
        let (x2, y2, z2) = (two * x, two * y, two * z);
        change[0][lane] = -fma(y2, y, z2 * z);
        change[4][lane] = -fma(x2, x, z2 * z);
        change[8][lane] = -fma(x2, x, y2 * y);
        change[1][lane] = minor(x2, y, z2, w);
        change[2][lane] = fma(x2, z, y2 * w);
        change[3][lane] = fma(x2, y, z2 * w);
        change[5][lane] = minor(y2, z, x2, w);
        change[6][lane] = minor(x2, z, y2, w);
        change[7][lane] = fma(y2, z, x2 * w);
    }
}
