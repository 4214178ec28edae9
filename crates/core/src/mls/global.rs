//! The one map of its kind that fits all control points with equal weights: what local maps follow where they are open.
//!
//! The rotation that best takes all control points to their targets is
//!
//! ```text
//! G = argmax over SO(d) of tr(R (C / |C| + w I))
//! w = 1e-9 min(1, (e^2 + 1e-18) / h^2)^2                          (docs/rotation.md, eq. 15)
//! ```
//!
//! with `h` the thickness of the control points about their longest axis, and `e` what the best similarity leaves of their targets, each relative
//! to the whole.
//!
//! How all of them turn about a line that they nearly lie on is seen in no more than `h^2` of C. Anchored at I with 1e-9 throughout, a
//! rigid motion of handles with `h = 1e-4` would turn by a hundredth of a circle less than they do. But where targets depart from a
//! motion by more than `h`, that turn is not known, and must not be made of rounding. So the anchor counts by what is known: in full
//! where `e` is as large as `h`, and where `h` is below 3e-8, which is the rounding of single precision; for a motion of all of
//! them with `h = 1e-6`, not at all.
//!
//! Since C has lost its 17th digit, and so `h^2` its 5th, the last steps are taken from the displacements that are left, `b - s R a`, not from
//! C: their moment `sum (R a) x (b - s R a)` is that of `(R a) x b`, to the last digit of `h` (docs/rotation.md, eq. 14).

use super::affine;
use super::matrix::{apply, cholesky, identity, norm, solve, transposed, Matrix};
use super::moments::Moments;
use super::oriented::{self, Oriented};
use super::rotation::{best_quaternion, best_rotation, of_quaternion, turned_by, ANCHOR_WEIGHT};
use super::similarity;
use crate::softmax::Dominant;

/// Departure from a motion that is taken for rounding: its square, in parts of the whole.
const ROUNDING: f64 = 1e-18;
/// The least anchor of a first estimate: what C has lost.
const LOST: f64 = 1e-16;
/// Newton's steps. From an estimate that is off by 1e-2 two are enough; the third is for one of 0.1.
const STEPS: usize = 3;
/// A longer step than this, in radians, is out of what Newton's method is good for.
const LONGEST: f64 = 0.5;

/// The global fit: what a local map follows where the control points around it leave something open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Global<const D: usize> {
    /// The best rotation of all control points; the identity where even they leave it open.
    pub rotation: Matrix<D>,
    /// The best scale (similarity); 1 where there is none.
    pub scale: f64,
    /// The best linear map (affine).
    pub linear: Matrix<D>,
}

impl<const D: usize> Global<D> {
    pub(super) fn new(p: &[[f64; D]], q: &[[f64; D]], oriented: &[Oriented<D>]) -> Global<D> {
        let equal = vec![1.0; p.len()];
        let dominant = Dominant { index: 0, second: 1.0 / p.len() as f64 };
        let mut moments = Moments::new(p, q, &equal, dominant, None);
        let added = oriented::add(&mut moments, oriented, &equal, dominant, None);
        let rotation = rotation(p, q, oriented, &moments.pq);
        added.align(&mut moments, &rotation);
        let scale = similarity::scale(&moments, &rotation, 1.0);
        let mut residuals = Moments::new(p, q, &equal, dominant, Some(&rotation));
        oriented::add(&mut residuals, oriented, &equal, dominant, Some(&rotation));
        let linear = affine::linear(&residuals.pq, &residuals.pp, &rotation);
        Global { rotation, scale, linear }
    }
}

/// G of `moment` (C, at any scale).
fn rotation<const D: usize>(
    p: &[[f64; D]],
    q: &[[f64; D]],
    oriented: &[Oriented<D>],
    moment: &Matrix<D>,
) -> Matrix<D> {
    let size = norm(moment);
    if !(size > 0.0 && (1.0 / size).is_finite()) {
        return identity();
    }
    let anchored = |w: f64| -> Matrix<D> {
        std::array::from_fn(|r| std::array::from_fn(|c| moment[r][c] / size + if r == c { w } else { 0.0 }))
    };
    if D != 3 {
        return best_rotation(&anchored(ANCHOR_WEIGHT));
    }
    let arms = Arms::new(p, q, oriented);
    let free = arms.refined(best_quaternion(&anchored(LOST)), 0.0);
    let w = arms.anchor_weight(&of_quaternion(&free));
    let full = of_quaternion(&arms.refined(best_quaternion(&anchored(w.max(LOST))), w));
    std::array::from_fn(|r| std::array::from_fn(|c| full[r][c]))
}

/// What rotations are found from, `sum share a b^T = C`: the control points from their centre, and the frames of those that are oriented.
struct Arms(Vec<Arm>);

struct Arm {
    share: f64,
    a: [f64; 3],
    b: [f64; 3],
    /// Whether it is of a control point's place; frames have no scale.
    place: bool,
}

impl Arms {
    fn new<const D: usize>(p: &[[f64; D]], q: &[[f64; D]], oriented: &[Oriented<D>]) -> Arms {
        let share = 1.0 / p.len() as f64;
        // Relative to the first one, so that what is far from the origin keeps its digits.
        let from_centre = |points: &[[f64; D]]| -> Vec<[f64; 3]> {
            let from_first = |point: &[f64; D], k: usize| if k < D { point[k] - points[0][k] } else { 0.0 };
            let mean: [f64; 3] =
                std::array::from_fn(|k| points.iter().map(|point| share * from_first(point, k)).sum());
            points.iter().map(|point| std::array::from_fn(|k| from_first(point, k) - mean[k])).collect()
        };
        let places = from_centre(p).into_iter().zip(from_centre(q));
        let mut arms: Vec<Arm> = places.map(|(a, b)| Arm { share, a, b, place: true }).collect();
        for Oriented { rotation, square, .. } in oriented {
            // The columns of the rotation are where the axes go.
            for (axis, column) in transposed(rotation).iter().enumerate() {
                let a = std::array::from_fn(|k| f64::from(u8::from(k == axis)));
                let b = std::array::from_fn(|k| if k < D { column[k] } else { 0.0 });
                arms.push(Arm { share: share * share * square, a, b, place: false });
            }
        }
        Arms(arms)
    }

    fn sum(&self, term: impl Fn(&Arm) -> f64) -> f64 {
        self.0.iter().map(|arm| arm.share * term(arm)).sum()
    }

    /// The best scale of places that `r` turns.
    fn scale(&self, r: &Matrix<3>) -> f64 {
        let of_places = |arm: &Arm, term: f64| if arm.place { term } else { 0.0 };
        let extent = self.sum(|arm| of_places(arm, dot(&arm.a, &arm.a)));
        let along = self.sum(|arm| of_places(arm, dot(&apply(r, &arm.a), &arm.b)));
        if extent > 0.0 {
            (along / extent).max(0.0)
        } else {
            1.0
        }
    }

    /// w, `r` being the best rotation without it.
    fn anchor_weight(&self, r: &Matrix<3>) -> f64 {
        let (scale, axis) = (self.scale(r), self.longest_axis());
        let left = self.sum(|arm| square_of(&arm.left(&apply(r, &arm.a), scale)));
        let thickness = self.sum(|arm| square_of(&cross(&arm.a, &axis)));
        let all = [self.sum(|arm| square_of(&arm.b)), self.sum(|arm| square_of(&arm.a))];
        let part = (left / all[0] + ROUNDING) / (thickness / all[1]);
        // Written so that NaN is 1.
        let part = if part < 1.0 { part } else { 1.0 };
        ANCHOR_WEIGHT * part * part
    }

    /// The axis about which the arms are thinnest, if they are thin: the eighth power of `sum a a^T` has nothing else left.
    fn longest_axis(&self) -> [f64; 3] {
        let mut power: Matrix<3> =
            std::array::from_fn(|r| std::array::from_fn(|c| self.sum(|arm| arm.a[r] * arm.a[c])));
        for _ in 0..3 {
            let size = norm(&power);
            let of = power.map(|row| row.map(|e| e / size));
            power =
                std::array::from_fn(|r| std::array::from_fn(|c| (0..3).map(|k| of[r][k] * of[k][c]).sum()));
        }
        let longest = (0..3).max_by(|&i, &k| power[i][i].total_cmp(&power[k][k])).unwrap_or_default();
        let length = square_of(&power[longest]).sqrt();
        power[longest].map(|e| e / length)
    }

    /// Newton's method for `tr(R (C / |C| + w I))` from the quaternion `u` on (docs/rotation.md, eq. 9 and 14).
    fn refined(&self, mut u: [f64; 4], w: f64) -> [f64; 4] {
        let c: Matrix<3> =
            std::array::from_fn(|r| std::array::from_fn(|c| self.sum(|arm| arm.a[r] * arm.b[c])));
        let w = w * norm(&c);
        for _ in 0..STEPS {
            let r = of_quaternion(&u);
            let scale = self.scale(&r);
            // S = R (C + w |C| I), and its moment.
            let mut s: Matrix<3> = std::array::from_fn(|i| {
                std::array::from_fn(|k| (0..3).map(|l| r[i][l] * c[l][k]).sum::<f64>() + w * r[i][k])
            });
            let mut g: [f64; 3] = std::array::from_fn(|i| {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                w * (r[j][k] - r[k][j])
            });
            for arm in &self.0 {
                let turned = apply(&r, &arm.a);
                let moment = cross(&turned, &arm.left(&turned, scale));
                (0..3).for_each(|k| g[k] += arm.share * moment[k]);
            }
            let trace = s[0][0] + s[1][1] + s[2][2];
            s = std::array::from_fn(|i| {
                std::array::from_fn(|k| f64::from(u8::from(i == k)) * trace - 0.5 * (s[i][k] + s[k][i]))
            });
            let Some(lower) = cholesky(&s) else { return u };
            let z = solve(&lower, g);
            let short = square_of(&z) < LONGEST * LONGEST; // Not if it is NaN.
            if !short {
                return u;
            }
            u = turned_by(&u, &z.map(|e| 0.5 * e));
        }
        u
    }
}

impl Arm {
    /// What a motion that turns `a` to `turned` leaves of `b`.
    fn left(&self, turned: &[f64; 3], scale: f64) -> [f64; 3] {
        let scale = if self.place { scale } else { 1.0 };
        std::array::from_fn(|k| self.b[k] - scale * turned[k])
    }
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn square_of(a: &[f64; 3]) -> f64 {
    dot(a, a)
}

fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        a[i] * b[j] - a[j] * b[i]
    })
}
