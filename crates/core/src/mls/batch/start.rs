//! Where the rotation is looked for: Horn's quaternion by the characteristic polynomial, in single precision, 16 lanes at a time.
//!
//! ```text
//! A = C / |C| + 1e-6 G^T
//! K = cofactors of A    k = |K|^2    d = det A
//! v = largest root of (v (2 + v))^2 = 8 d (1 + v) + 4 k, by Newton's method from above   (docs/rotation.md, eq. 6)
//! u = column of the adjugate of N(A) - (1 + v) I with the largest diagonal               (eq. 8)
//! ```
//!
//! Horn 1987 has the matrix N and its quartic; the largest eigenvalue is s1 + s2 + s3, with s3 < 0 where det A < 0: a rotation, never
//! a reflection. What differs: the unknown is the eigenvalue less 1, and the quartic is written in the cofactors. Where A is close to
//! rank 1 (low temperatures) all eigenvalues are close to 1 or -1, and the roots of the ordinary form lose half of
//! their digits. The anchor counts for more here than in the rule: rounding must not drown it.

use super::super::matrix::Matrix;
use super::{Start, BATCH};
use crate::machine::simd::{minor, multiversion, square_of, Lanes, WIDTH};

/// The weight of the anchor here.
const ANCHOR: f32 = 1e-6;
/// What is added to each entry, so that no product of some of them is denormal (below 1e-38), where numbers cost a hundred times as much.
const LEAST: f32 = 1e-9;
/// Newton's steps: what they leave, the corrections in double precision take away.
const STEPS: usize = 3;

multiversion! {
    /// Of each lane `1 / |C|`, or 0 where that is beyond single precision's range, and a quaternion.
    pub(super) fn start(g: &Matrix<3>, start: &mut Start) = start_body
}

#[inline(always)]
fn start_body<L: Lanes>(g: &Matrix<3>, start: &mut Start) {
    // Each step for all lanes: its operations wait for one another, those of other lanes need not.
    for block in 0..BATCH / WIDTH {
        let mut moment = [L::splat(0.0); 9];
        for k in 0..9 {
            moment[k] = L::load(&start.moment[k][block]);
        }
        let square = square_of(&moment);
        let inverse = square.max(L::splat(1e-30)).inverse_sqrt();
        let inverse = L::select(L::splat(1e-30).less(square), inverse, L::splat(0.0));
        let inverse = L::select(square.less(L::splat(1e30)), inverse, L::splat(0.0));
        start.inverse[block] = inverse.store();
        for k in 0..9 {
            let anchor = L::splat(ANCHOR * g[k % 3][k / 3] as f32 + LEAST);
            moment[k] = moment[k].mul_add(inverse, anchor);
            start.moment[k][block] = moment[k].store();
        }
        let (d, k) = coefficients(&moment);
        start.d[block] = d.store();
        start.k[block] = k.store();
    }
    for block in 0..BATCH / WIDTH {
        let v = largest_root(L::load(&start.d[block]), L::load(&start.k[block]));
        start.v[block] = v.store();
    }
    for block in 0..BATCH / WIDTH {
        let mut a = [L::splat(0.0); 9];
        for k in 0..9 {
            a[k] = L::load(&start.moment[k][block]);
        }
        let u = quaternion_of::<L>(a, L::load(&start.v[block]));
        for k in 0..4 {
            start.quaternion[k][block] = u[k].store();
        }
    }
}

/// d and k.
#[inline(always)]
fn coefficients<L: Lanes>(a: &[L; 9]) -> (L, L) {
    let minor_of = |i: usize, j: usize, k: usize, l: usize| minor(a[i], a[j], a[k], a[l]);
    let first = [minor_of(4, 8, 5, 7), minor_of(5, 6, 3, 8), minor_of(3, 7, 4, 6)];
    let other = [
        minor_of(2, 7, 1, 8),
        minor_of(0, 8, 2, 6),
        minor_of(1, 6, 0, 7),
        minor_of(1, 5, 2, 4),
        minor_of(2, 3, 0, 5),
        minor_of(0, 4, 1, 3),
    ];
    let k = square_of(&first).add(square_of(&other));
    let d = a[0].mul_add(first[0], a[1].mul_add(first[1], a[2].mul(first[2])));
    (d, k)
}

/// The quaternion, its length 1.
#[inline(always)]
fn quaternion_of<L: Lanes>(a: [L; 9], v: L) -> [L; 4] {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let [xx, xy, xz, yx, yy, yz, zx, zy, zz] = a;
    let largest = v.add(one);
    let (n01, n02, n03) = (yz.sub(zy), zx.sub(xz), xy.sub(yx));
    let (n12, n13, n23) = (xy.add(yx), zx.add(xz), yz.add(zy));
    let (plus, minus) = (yy.add(zz), yy.sub(zz));
    let n00 = xx.add(plus).sub(largest);
    let n11 = xx.sub(plus).sub(largest);
    let n22 = minus.sub(xx).sub(largest);
    let n33 = zero.sub(minus).sub(xx).sub(largest);
    // Minors of the upper two rows, and of the lower two.
    let s3 = minor(n01, n12, n11, n02);
    let s4 = minor(n01, n13, n11, n03);
    let s5 = minor(n02, n13, n12, n03);
    let c5 = minor(n22, n33, n23, n23);
    let c4 = minor(n12, n33, n13, n23);
    let c3 = minor(n12, n23, n13, n22);
    // a b - c d + e f.
    let three = |a: L, b: L, c: L, d: L, e: L, f: L| a.mul_add(b, minor(e, f, c, d));
    let b00 = three(n11, c5, n12, c4, n13, c3);
    let b01 = three(n02, c4, n01, c5, zero.sub(n03), c3);
    let b02 = three(n13, s5, n23, s4, n33, s3);
    let b03 = three(n22, s4, n12, s5, zero.sub(n23), s3);
    let mut u = [b00, b01, b02, b03];
    // The first column is 0 where the turn is a half one; up to 150 degrees it is good.
    let good = square_of(&u).mul(L::splat(0.07)).less(b00.mul(b00));
    if L::bits(good) != (1 << WIDTH) - 1 {
        let s0 = minor(n00, n11, n01, n01);
        let s1 = minor(n00, n12, n01, n02);
        let s2 = minor(n00, n13, n01, n03);
        let c2 = minor(n02, n33, n03, n23);
        let c1 = minor(n02, n23, n03, n22);
        let b11 = three(n00, c5, n02, c2, n03, c1);
        let b12 = three(n23, s2, n03, s5, zero.sub(n33), s1);
        let b13 = three(n02, s5, n22, s2, n23, s1);
        let b22 = three(n03, s4, n13, s2, n33, s0);
        let b23 = three(n12, s2, n02, s4, zero.sub(n23), s0);
        let b33 = three(n02, s3, n12, s1, n22, s0);
        let mut best = b00.abs();
        for (column, diagonal) in
            [([b01, b11, b12, b13], b11), ([b02, b12, b22, b23], b22), ([b03, b13, b23, b33], b33)]
        {
            let better = best.less(diagonal.abs());
            for i in 0..4 {
                u[i] = L::select(better, column[i], u[i]);
            }
            best = best.max(diagonal.abs());
        }
    }
    let size = square_of(&u).max(L::splat(1e-36)).inverse_sqrt();
    [u[0].mul(size), u[1].mul(size), u[2].mul(size), u[3].mul(size)]
}

/// The root of a number, but for what is next to 0.
#[inline(always)]
fn root<L: Lanes>(square: L) -> L {
    let square = square.max(L::splat(1e-30));
    square.mul(square.inverse_sqrt())
}

/// v, from a bound of it (docs/rotation.md, eq. 7) that is v itself where s3 is 0 or s1: with `b = s1 s2 + s1 s3 + s2 s3`, `b^2 = k + 2 d (1 + v)`, and
/// `v <= sqrt(3) - 1`; then `v = sqrt(1 + 2 b) - 1`.
#[inline(always)]
fn largest_root<L: Lanes>(d: L, k: L) -> L {
    let (zero, one, two) = (L::splat(0.0), L::splat(1.0), L::splat(2.0));
    // A little more than that, for its rounding.
    let b = root(d.max(zero).mul_add(L::splat(3.464_102), k)).mul(L::splat(2.000_002));
    let mut v = b.mul(root(b.add(one)).add(one).inverse());
    let d8 = L::splat(8.0).mul(d);
    let both = L::splat(-4.0).mul_add(k, zero.sub(d8));
    for _ in 0..STEPS {
        // e = v (2 + v) is the eigenvalue's square less 1.
        let e = v.mul_add(v, two.mul(v));
        let value = d8.mul_sub_from(v, e.mul_add(e, both));
        let four = L::splat(4.0).mul(e);
        let slope = four.mul_add(v, four.sub(d8));
        let step = value.mul(slope.estimated_inverse());
        v = v.sub(L::select(zero.less(slope), step, zero));
    }
    v
}
