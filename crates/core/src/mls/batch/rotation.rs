//! The rule for the rotation (DESIGN, [`super::super::rotation`]) in lanes, in double precision from where [`super::start`] is.
//!
//! ```text
//! A = C / |C| + 1e-9 G^T                                                   (docs/rotation.md, eq. 2)
//! until all lanes are there:
//!     S = R A    g = its antisymmetric part, where tr(exp(z) S) rises    H = tr(S) I - its symmetric part
//!     z = (2 H)^-1 g    R = the rotation of the quaternion (1, z (1 - |z|^2)), times R     (eq. 9 to 11)
//! ```
//!
//! Newton's method; since `tr(exp(z) S)` has no cubic term where S is symmetric, a step leaves the cube of its length: 1e-4 becomes
//! 1e-12. (Beside the direction that A determines least, s2 + s3 apart, another one leaves its square over that.) Along z alone the
//! maximum is known: at `atan(2 |z|)`, and beyond a right angle where `z g < 0`. Where single precision cannot tell the turn that A
//! determines least, that finds it.
//!
//! H is positive definite at the maximum and there only, since on all rotations `tr(R A)` has no other.

use super::{Lane, Start, Turning, ANCHOR_WEIGHT, BATCH};
use crate::machine::simd::{minor, multiversion, square_of, Doubles, Lanes, Numbers};

/// `|z|^2` of a last step, and `z g` over the least eigenvalue of 2 H: what it leaves is below 1e-9.
const CLOSE: f64 = 1e-6;
/// `|K|^2` where A is so close to rank 1 that single precision is lost.
const FLAT: f64 = 1e-6;
/// Steps of a lane that is not given up: where two turns are open at once, none of them finds both.
const MOST_STEPS: usize = 8;
/// The least eigenvalue of 2 H: the anchor's part of A is at least that, and rounding must not be.
const OPEN: f64 = 3e-10;
/// How much a mirror may cancel.
const MIRRORED: f64 = 512.0;

multiversion! {
    /// `R - I` of each lane whose moments are `moment`, and whether it is sound.
    pub(super) fn rotations(
        moment: &[Lane; 9], start: &Start, anchor: &Turning, turn: &mut [Lane; 4], change: &mut [Lane; 9], sound: &mut Lane,
    ) = rotations_body
}

#[inline(always)]
fn rotations_body<L: Lanes>(
    moment: &[Lane; 9],
    start: &Start,
    anchor: &Turning,
    turn: &mut [Lane; 4],
    change: &mut [Lane; 9],
    sound: &mut Lane,
) {
    let width = L::Doubles::WIDTH;
    for first in (0..BATCH).step_by(width) {
        let mut u = [L::Doubles::splat(0.0); 4];
        for k in 0..4 {
            u[k] = L::Doubles::load_singles(&start.quaternion[k].as_flattened()[first..]);
        }
        let (k, flat) = (L::Doubles::load_singles(&start.k.as_flattened()[first..]), L::Doubles::splat(FLAT));
        if !L::Doubles::all(flat.less(k)) {
            let aligned = aligned(&target::<L::Doubles>(moment, start, anchor, first), anchor);
            for c in 0..4 {
                u[c] = L::Doubles::select(flat.less(k), u[c], aligned[c]);
            }
        }
        store(u, first, turn);
    }
    let mut open = [true; BATCH];
    for step in 0..=MOST_STEPS {
        for first in (0..BATCH).step_by(width) {
            if open[first] {
                open[first] = better::<L::Doubles>(moment, start, anchor, step, first, turn, sound);
            }
        }
        if (0..BATCH).step_by(width).all(|first| !open[first]) {
            break;
        }
    }
    for first in (0..BATCH).step_by(width) {
        let u = load::<L::Doubles, 4>(turn, first);
        store(turn_of(u), first, change);
    }
}

/// One step of some lanes; gives whether they want more.
#[inline(always)]
fn better<D: Doubles>(
    moment: &[Lane; 9],
    start: &Start,
    anchor: &Turning,
    step: usize,
    first: usize,
    turn: &mut [Lane; 4],
    sound: &mut Lane,
) -> bool {
    let (zero, one) = (D::splat(0.0), D::splat(1.0));
    let a = target::<D>(moment, start, anchor, first);
    let u = load::<D, 4>(turn, first);
    let Step { z, size, rise, close, sound: good } = newton(&a, &u);
    if D::all(close) || step == MOST_STEPS {
        store(turned(&u, scaled(&z, one.sub(size))), first, turn);
        let known = zero.less(D::load_singles(&start.inverse.as_flattened()[first..]));
        let good = D::and(D::and(good, close), known);
        D::select(good, one, zero).store(&mut sound[first..]);
        return false;
    }
    // The tangent of half of the angle, over |z|.
    let root = size.mul_add(D::splat(4.0), one).sqrt().add(one);
    let ahead = root.inverse().add(root.inverse());
    let behind = D::splat(-0.5).mul(root).mul(size.inverse());
    let u = turned(&u, scaled(&z, D::select(rise.less(zero), behind, ahead)));
    store(scaled(&u, square_of(&u).sqrt().inverse()), first, turn);
    true
}

/// A.
#[inline(always)]
fn target<D: Doubles>(moment: &[Lane; 9], start: &Start, anchor: &Turning, first: usize) -> [D; 9] {
    let inverse = D::load_singles(&start.inverse.as_flattened()[first..]);
    let mut a = load::<D, 9>(moment, first);
    for k in 0..9 {
        a[k] = a[k].mul_add(inverse, D::splat(ANCHOR_WEIGHT * anchor.matrix[k % 3][k / 3]));
    }
    a
}

/// Of A close to `s a b^T` the rotation from a to b that turns least after the anchor: what A leaves open follows that.
#[inline(always)]
fn aligned<D: Doubles>(a: &[D; 9], anchor: &Turning) -> [D; 4] {
    let dot = |x: &[D; 3], y: &[D; 3]| x[0].mul_add(y[0], x[1].mul_add(y[1], x[2].mul(y[2])));
    let [xx, xy, xz, yx, yy, yz, zx, zy, zz] = *a;
    let (rows, columns) =
        ([[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]], [[xx, yx, zx], [xy, yy, zy], [xz, yz, zz]]);
    // The largest row is nearly b.
    let (mut to, mut best) = (rows[0], square_of(&rows[0]));
    for row in &rows[1..] {
        let square = square_of(row);
        let better = best.less(square);
        for c in 0..3 {
            to[c] = D::select(better, row[c], to[c]);
        }
        best = D::select(better, square, best);
    }
    let from = [dot(&rows[0], &to), dot(&rows[1], &to), dot(&rows[2], &to)];
    let to = [dot(&columns[0], &from), dot(&columns[1], &from), dot(&columns[2], &from)];
    let mut by_anchor = from;
    for c in 0..3 {
        let [x, y, z] = anchor.matrix[c];
        by_anchor[c] = dot(&[D::splat(x), D::splat(y), D::splat(z)], &from);
    }
    let [x, y, z] = by_anchor;
    let length = square_of(&by_anchor).mul(square_of(&to)).sqrt();
    let across = [
        z.mul_sub_from(to[1], y.mul(to[2])),
        x.mul_sub_from(to[2], z.mul(to[0])),
        y.mul_sub_from(to[0], x.mul(to[1])),
    ];
    let [qw, qx, qy, qz] = anchor.quaternion;
    let least = [D::splat(qw), D::splat(qx), D::splat(qy), D::splat(qz)];
    let u = turned(&least, scaled(&across, length.add(dot(&by_anchor, &to)).inverse()));
    scaled(&u, square_of(&u).sqrt().inverse())
}

#[inline(always)]
fn load<D: Doubles, const N: usize>(from: &[Lane; N], first: usize) -> [D; N] {
    let mut numbers = [D::splat(0.0); N];
    for k in 0..N {
        numbers[k] = D::load(&from[k][first..]);
    }
    numbers
}

#[inline(always)]
fn store<D: Doubles, const N: usize>(numbers: [D; N], first: usize, to: &mut [Lane; N]) {
    for k in 0..N {
        numbers[k].store(&mut to[k][first..]);
    }
}

/// A step of Newton's method.
struct Step<D: Doubles> {
    z: [D; 3],
    /// `|z|^2`.
    size: D,
    /// `z g`.
    rise: D,
    /// Where it is the last one.
    close: D::Mask,
    /// Where R then is sound.
    sound: D::Mask,
}

#[inline(always)]
fn newton<D: Doubles>(a: &[D; 9], u: &[D; 4]) -> Step<D> {
    let r = rotation(u);
    let entry = |i: usize, j: usize| {
        r[3 * i].mul_add(a[j], r[3 * i + 1].mul_add(a[3 + j], r[3 * i + 2].mul(a[6 + j])))
    };
    let row = |i: usize| [entry(i, 0), entry(i, 1), entry(i, 2)];
    let [[sxx, sxy, sxz], [syx, syy, syz], [szx, szy, szz]] = [row(0), row(1), row(2)];
    let g = [syz.sub(szy), szx.sub(sxz), sxy.sub(syx)];
    // 2 H, but for the signs beside the diagonal.
    let twice = |a: D, b: D| a.add(b).mul(D::splat(2.0));
    let (xx, yy, zz) = (twice(syy, szz), twice(sxx, szz), twice(sxx, syy));
    let (xy, xz, yz) = (sxy.add(syx), sxz.add(szx), syz.add(szy));
    // Its adjugate.
    let (bxx, byy, bzz) = (minor(yy, zz, yz, yz), minor(xx, zz, xz, xz), minor(xx, yy, xy, xy));
    let sum = |a: D, b: D, c: D, d: D| a.mul_add(b, c.mul(d));
    let (bxy, bxz, byz) = (sum(xz, yz, xy, zz), sum(xy, yz, xz, yy), sum(xy, xz, yz, xx));
    let determinant = xy.mul_sub_from(bxy, xz.mul_sub_from(bxz, xx.mul(bxx)));
    let inverse = determinant.inverse();
    let dot = |x: D, y: D, z: D, with: &[D; 3]| x.mul_add(with[0], y.mul_add(with[1], z.mul(with[2])));
    let z = scaled(&[dot(bxx, bxy, bxz, &g), dot(bxy, byy, byz, &g), dot(bxz, byz, bzz, &g)], inverse);

    // (docs/rotation.md, eq. 12) Of three numbers with a positive sum and a positive product, one of which is open, two would have to be below 0 if any were; then so
    // would be the sum of the products of two.
    let minors = bxx.add(byy).add(bzz);
    let definite = D::and((D::splat(0.0)).less(minors), minors.mul(D::splat(OPEN)).less(determinant));
    let definite = D::and(D::splat(0.0).less(xx.add(yy).add(zz)), definite);
    // Eq. 13. Weights are single. Without a mirror their rounding turns nothing by more than itself; with one, what the determinant of A
    // measures cancels in that of H.
    let first = [minor(a[4], a[8], a[5], a[7]), minor(a[5], a[6], a[3], a[8]), minor(a[3], a[7], a[4], a[6])];
    let mirrored = D::splat(0.0).sub(dot(a[0], a[1], a[2], &first));
    let sound = D::and(definite, mirrored.less(determinant.mul(determinant).mul(D::splat(MIRRORED))));
    let (size, rise) = (square_of(&z), dot(z[0], z[1], z[2], &g));
    let little = D::splat(CLOSE);
    let close = D::and(size.less(little), rise.mul(minors).less(determinant.mul(little)));
    Step { z, size, rise, close, sound }
}

/// The rotation of a quaternion times the square of its length.
#[inline(always)]
fn rotation<D: Doubles>(&[w, x, y, z]: &[D; 4]) -> [D; 9] {
    let difference = |a: D, b: D, c: D, d: D| c.mul_sub_from(d, a.mul(b));
    let (plus, minus) = (w.mul_add(w, x.mul(x)), difference(w, w, x, x));
    let (across, along) = (y.mul_add(y, z.mul(z)), difference(y, y, z, z));
    let (w2, x2, y2) = (w.add(w), x.add(x), y.add(y));
    let (xy, xz, yz) = (x2.mul(y), x2.mul(z), y2.mul(z));
    [
        plus.sub(across),
        w2.mul_sub_from(z, xy),
        w2.mul_add(y, xz),
        w2.mul_add(z, xy),
        minus.add(along),
        w2.mul_sub_from(x, yz),
        w2.mul_sub_from(y, xz),
        w2.mul_add(x, yz),
        minus.sub(along),
    ]
}

/// The quaternion `(1, z)` times `u`.
#[inline(always)]
fn turned<D: Doubles>(&[w, x, y, z]: &[D; 4], t: [D; 3]) -> [D; 4] {
    let sum =
        |a: D, b: D, c: D, d: D, e: D, f: D, rest: D| a.mul_add(b, c.mul_add(d, e.mul_sub_from(f, rest)));
    [
        t[0].mul_sub_from(x, t[1].mul_sub_from(y, t[2].mul_sub_from(z, w))),
        sum(t[0], w, t[1], z, t[2], y, x),
        sum(t[1], w, t[2], x, t[0], z, y),
        sum(t[2], w, t[0], y, t[1], x, z),
    ]
}

#[inline(always)]
fn scaled<D: Doubles, const N: usize>(numbers: &[D; N], by: D) -> [D; N] {
    let mut result = *numbers;
    for k in 0..N {
        result[k] = numbers[k].mul(by);
    }
    result
}

/// `R - I`.
#[inline(always)]
fn turn_of<D: Doubles>([w, x, y, z]: [D; 4]) -> [D; 9] {
    let inverse = square_of(&[w, x, y, z]).inverse();
    let [w2, x2, y2, z2] = scaled(&[w, x, y, z], inverse.add(inverse));
    let (xy, xz, yz) = (x2.mul(y), x2.mul(z), y2.mul(z));
    let zero = D::splat(0.0);
    let (xx, yy, zz) = (zero.sub(x2.mul(x)), y2.mul(y), z2.mul(z));
    [
        zero.sub(yy).sub(zz),
        w2.mul_sub_from(z, xy),
        w2.mul_add(y, xz),
        w2.mul_add(z, xy),
        xx.sub(zz),
        w2.mul_sub_from(x, yz),
        w2.mul_sub_from(y, xz),
        w2.mul_add(x, yz),
        xx.sub(yy),
    ]
}
