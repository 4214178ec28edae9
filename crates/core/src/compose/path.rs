//! The way of the control points from rest to their targets: as rigid as possible at every moment.
//!
//! ```text
//! R_i = argmax tr(R sum_j w_ij (p_j - p_i)(q_j - q_i)^T)              w_ij = 1 / |p_i - p_j|^4
//! e_ij(t) = (R_i(t) + R_j(t)) (p_i - p_j) / 2 + t r_ij                R_i(t): below
//! h(t) = argmin sum w_ij |h_i - h_j - e_ij(t)|^2
//! ```
//!
//! with `r_ij` what is left at t = 1, so that `h(0) = p` and `h(1) = q`. The one motion that fits all control points is taken out first, and comes
//! with the last step: rigid maps do not care. Straight lines would meet on the axis of a half turn.
//!
//! A rotation that was given in degrees turns by the part t of them, however many they are. Of one that is found from places no number of turns is
//! known; but it is that of the control point beside it, turned further: `R_i(t) = R_j(t) (R_j^T R_i)^t`, along a tree of nearest links. So rings of
//! control points say how often a bar is twisted. Where two have little to do with each other, each goes its own shortest way.
//!
//! Alexa, Cohen-Or, Levin, "As-rigid-as-possible shape interpolation", 2000; Sorkine, Alexa, "As-rigid-as-possible surface modeling", 2007.

use crate::deformer::Pose;
use crate::mls::matrix::{apply, identity, norm, scaled, transposed, Matrix};
use crate::mls::{best_quaternion, best_rotation};

use std::f64::consts::{FRAC_PI_2, TAU};

/// How much no rotation counts in a local one, where the neighbours leave it open.
const STILL: f64 = 1e-3;
/// Distances below this part of the extent count as this.
const NEAR: f64 = 1e-3;
/// A turn by less has no axis, radians.
const NO_TURN: f64 = 1e-6;
/// Control points that turn by more against each other have little to do with each other, radians.
const APART: f64 = 2.1;
/// By so much an orientation that was given may turn in a step, radians: two by no more than a quarter turn against each other.
pub(super) const LARGEST_TURN: f64 = FRAC_PI_2 / 2.0;

/// A rotation by its axis, times the angle in radians, which may be more than half a turn; in the plane about (0, 0, 1).
pub(super) type Turn = [f64; 3];

/// The way.
pub(super) struct Path<const D: usize> {
    p: Vec<[f64; D]>,
    /// The targets, without the motion of all.
    q: Vec<[f64; D]>,
    /// The targets as they are.
    goal: Vec<[f64; D]>,
    motion: Matrix<D>,
    turning: Turning,
    /// Of those whose orientation was given: its scale.
    scales: Option<Vec<Option<f64>>>,
    /// The largest turn that was given, without the motion of all, radians.
    largest: f64,
    links: Laplacian,
}

/// A piece of the way, as a map takes it.
pub(super) struct Leg {
    /// Where the control points go, m x dim.
    pub targets: Vec<f64>,
    /// How they are oriented on it, as [`Pose::orientations`].
    pub orientations: Option<Vec<f64>>,
    /// `max |d_i - d_j| / |h_i - h_j|` over all pairs, `d` their displacements without the motion of all.
    pub strain: f64,
}

impl<const D: usize> Path<D> {
    /// From `p` to the targets of `pose`, whose best motion is `motion` (row-major); `turns`: rotation vectors (m x 3) of orientations that were given
    /// as angles, NaN for others.
    pub(super) fn new(p: &[f64], pose: Pose<'_>, turns: Option<&[f64]>, motion: &[f64]) -> Path<D> {
        let p = p.as_chunks::<D>().0.to_vec();
        let goal = pose.q.as_chunks::<D>().0.to_vec();
        let motion: Matrix<D> = std::array::from_fn(|r| std::array::from_fn(|c| motion[D * r + c]));
        let back = transposed(&motion);
        let (from, to) = (centre(&p), centre(&goal));
        let q: Vec<[f64; D]> = goal
            .iter()
            .map(|g| {
                let arm = apply(&back, &std::array::from_fn(|k| g[k] - to[k]));
                std::array::from_fn(|k| from[k] + arm[k])
            })
            .collect();
        let links = Laplacian::new(&p);
        let given = given(pose.orientations, turns, &motion);
        let largest = given.iter().flatten().map(|given| given.largest).fold(0.0, f64::max);
        let scales =
            pose.orientations.map(|_| given.iter().map(|one| one.as_ref().map(|g| g.scale)).collect());
        let turning = Turning::new(&p, &q, &links, &given);
        Path { p, q, goal, motion, turning, scales, largest, links }
    }

    /// The largest turn that was given, without the motion of all, radians: one map knows no more than half a turn.
    pub(super) fn largest_turn(&self) -> f64 {
        self.largest
    }

    /// From where the control points are at `from` (m x dim, near `h(t)`) to `h(to)`; to the targets themselves where `to` is 1.
    pub(super) fn leg(&self, at: &[f64], from: f64, to: f64) -> Leg {
        let at = at.as_chunks::<D>().0;
        let next = if to < 1.0 { self.at(to) } else { self.q.clone() };
        let last = to >= 1.0;
        let orientations = self.scales.as_ref().map(|scales| {
            let [now, then] = [from, to].map(|t| self.turning.at::<D>(t));
            let turned = |(i, scale): (usize, &Option<f64>)| -> Matrix<D> {
                let Some(scale) = scale else { return [[f64::NAN; D]; D] };
                let further = product(&then[i], &transposed(&now[i]));
                let further = if last { product(&self.motion, &further) } else { further };
                scaled(&further, scale.powf(to - from))
            };
            scales.iter().enumerate().flat_map(|pair| turned(pair).as_flattened().to_vec()).collect()
        });
        let targets = if last { &self.goal } else { &next };
        Leg { targets: targets.as_flattened().to_vec(), orientations, strain: strain(at, &next) }
    }

    /// `h(t)`.
    fn at(&self, t: f64) -> Vec<[f64; D]> {
        let m = self.p.len();
        let [now, end] = [t, 1.0].map(|t| self.turning.at::<D>(t));
        let mut b = vec![[0.0; D]; m];
        for i in 0..m {
            for j in 0..i {
                let p: [f64; D] = std::array::from_fn(|k| self.p[i][k] - self.p[j][k]);
                let turned = |r: &[Matrix<D>]| -> [f64; D] {
                    let (a, b) = (apply(&r[i], &p), apply(&r[j], &p));
                    std::array::from_fn(|k| 0.5 * (a[k] + b[k]))
                };
                let (now, end) = (turned(&now), turned(&end));
                let w = self.links.weight(i, j);
                for k in 0..D {
                    let left = self.q[i][k] - self.q[j][k] - end[k];
                    let e = w * (now[k] + t * left);
                    b[i][k] += e;
                    b[j][k] -= e;
                }
            }
        }
        self.links.solve(&mut b);
        // The middle stays: that of `q` is where that of `p` is.
        let (middle, found) = (centre(&self.p), centre(&b));
        b.iter().map(|h| std::array::from_fn(|k| h[k] - found[k] + middle[k])).collect()
    }
}

/// An orientation that was given: turned by `turn`, and back by the motion of all.
struct Given {
    turn: Turn,
    back: Turn,
    scale: f64,
    /// Radians, without the motion of all.
    largest: f64,
}

fn given<const D: usize>(
    orientations: Option<&[f64]>,
    turns: Option<&[f64]>,
    motion: &Matrix<D>,
) -> Vec<Option<Given>> {
    let numbers = |i: usize| turns.map(|turns| &turns[3 * i..][..3]).filter(|turn| !turn[0].is_nan());
    // Of all that turn by 350 degrees the motion is one by 350, not by -10.
    let count = orientations.map_or(0, |all| all.len() / (D * D));
    let said: Vec<&[f64]> = (0..count).filter_map(numbers).collect();
    let mean =
        std::array::from_fn(|k| said.iter().map(|turn| turn[k]).sum::<f64>() / said.len().max(1) as f64);
    let back = wound(vector(motion), mean).map(|c| -c);
    let one = |(i, matrix): (usize, &[f64])| {
        if matrix[0].is_nan() {
            return None;
        }
        let matrix: Matrix<D> = std::array::from_fn(|r| std::array::from_fn(|c| matrix[D * r + c]));
        let scale = norm(&matrix) / (D as f64).sqrt();
        let turn = match numbers(i) {
            Some(turn) => std::array::from_fn(|k| turn[k]),
            None => vector(&scaled(&matrix, 1.0 / scale)),
        };
        let largest = length(&std::array::from_fn(|k| turn[k] + back[k]));
        Some(Given { turn, back, scale, largest })
    };
    orientations.map_or_else(Vec::new, |all| all.chunks_exact(D * D).enumerate().map(one).collect())
}

/// How control points turn on their way, `R_i(t)`.
struct Turning {
    /// Each after the one that it goes with.
    order: Vec<usize>,
    of: Vec<Way>,
}

enum Way {
    /// By the part t of the second, and then of the first.
    Own(Turn, Turn),
    /// As another one, which is turned by the part t of this first.
    Beside(usize, Turn),
}

impl Turning {
    fn new<const D: usize>(
        p: &[[f64; D]],
        q: &[[f64; D]],
        links: &Laplacian,
        given: &[Option<Given>],
    ) -> Turning {
        let m = p.len();
        let said = |i: usize| given.get(i).and_then(Option::as_ref);
        let ends: Vec<Matrix<D>> = (0..m)
            .map(|i| match said(i) {
                Some(Given { turn, back, .. }) => product(&rotation(back, 1.0), &rotation(turn, 1.0)),
                None => of_surroundings(i, p, q, links),
            })
            .collect();
        let own = |i: usize| match said(i) {
            Some(Given { turn, back, .. }) => Way::Own(*back, *turn),
            None => Way::Own([0.0; 3], vector(&ends[i])),
        };
        let mut of: Vec<Way> = (0..m).map(own).collect();
        // From those that were given, or from the one that turns least, to the nearest one that is left, and so on (Prim 1957).
        let mut order: Vec<usize> = (0..m).filter(|&i| said(i).is_some()).collect();
        if order.is_empty() {
            let angle = |i: usize| length(&vector(&ends[i]));
            order.extend((0..m).min_by(|&a, &b| angle(a).total_cmp(&angle(b))));
        }
        let mut done = vec![false; m];
        // Of each that is left, the nearest that is done.
        let mut nearest: Vec<Option<usize>> = vec![None; m];
        let mut seen = 0;
        loop {
            for &new in &order[seen..] {
                done[new] = true;
                for (i, nearest) in nearest.iter_mut().enumerate() {
                    if nearest.is_none_or(|j| links.weight(i, new) > links.weight(i, j)) {
                        *nearest = Some(new);
                    }
                }
            }
            seen = order.len();
            let weight = |i: usize| nearest[i].map_or(0.0, |j| links.weight(i, j));
            let left = (0..m).filter(|&i| !done[i]);
            let Some(next) = left.reduce(|best, i| if weight(i) > weight(best) { i } else { best }) else {
                break;
            };
            if let Some(beside) = nearest[next] {
                let further = vector(&product(&transposed(&ends[beside]), &ends[next]));
                if length(&further) < APART {
                    of[next] = Way::Beside(beside, further);
                }
            }
            order.push(next);
        }
        Turning { order, of }
    }

    fn at<const D: usize>(&self, t: f64) -> Vec<Matrix<D>> {
        let mut r = vec![identity(); self.of.len()];
        for &i in &self.order {
            r[i] = match &self.of[i] {
                Way::Own(back, turn) => product(&rotation(back, t), &rotation(turn, t)),
                Way::Beside(other, further) => product(&r[*other], &rotation(further, t)),
            };
        }
        r
    }
}

/// The rotation that takes the other control points around one nearest to their targets.
fn of_surroundings<const D: usize>(i: usize, p: &[[f64; D]], q: &[[f64; D]], links: &Laplacian) -> Matrix<D> {
    let mut c = [[0.0; D]; D];
    for j in (0..p.len()).filter(|&j| j != i) {
        let w = links.weight(i, j);
        for (r, row) in c.iter_mut().enumerate() {
            for (s, e) in row.iter_mut().enumerate() {
                *e += w * (p[j][r] - p[i][r]) * (q[j][s] - q[i][s]);
            }
        }
    }
    let size = norm(&c);
    if !(size > 0.0 && size.is_finite()) {
        return identity();
    }
    let still = |r: usize, s: usize| if r == s { STILL } else { 0.0 };
    best_rotation(&std::array::from_fn(|r| std::array::from_fn(|s| c[r][s] / size + still(r, s))))
}

/// The links of all control points with each other, and their Laplacian in a form that is solved with.
struct Laplacian {
    m: usize,
    weights: Vec<f64>,
    /// `L` with `L L^T` the Laplacian that holds the middle too.
    lower: Vec<f64>,
}

impl Laplacian {
    fn new<const D: usize>(p: &[[f64; D]]) -> Laplacian {
        let m = p.len();
        let square = |a: &[f64; D], b: &[f64; D]| (0..D).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>();
        let extent = p.iter().map(|a| square(a, &p[0])).fold(0.0, f64::max);
        let extent = if extent > 0.0 { extent } else { 1.0 };
        let mut weights = vec![0.0; m * m];
        for i in 0..m {
            for j in (0..m).filter(|&j| j != i) {
                weights[m * i + j] = (square(&p[i], &p[j]) / extent).max(NEAR * NEAR).powi(-2);
            }
        }
        // The middle is free; held, the matrix is positive definite, and what is found is shifted anyway.
        let mean = weights.iter().sum::<f64>() / (m * m) as f64;
        let held = if mean > 0.0 { mean } else { 1.0 };
        let mut lower = vec![0.0; m * m];
        for i in 0..m {
            for j in 0..=i {
                let entry = match i == j {
                    true => weights[m * i..][..m].iter().sum::<f64>(),
                    false => -weights[m * i + j],
                };
                let (a, b) = (&lower[m * i..][..j], &lower[m * j..][..j]);
                let rest = entry + held - a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
                lower[m * i + j] =
                    if i == j { rest.max(f64::MIN_POSITIVE).sqrt() } else { rest / lower[m * j + j] };
            }
        }
        Laplacian { m, weights, lower }
    }

    fn weight(&self, i: usize, j: usize) -> f64 {
        self.weights[self.m * i + j]
    }

    fn solve<const D: usize>(&self, b: &mut [[f64; D]]) {
        let (m, l) = (self.m, &self.lower);
        for r in 0..m {
            let sum = |k: usize| (0..r).map(|s| l[m * r + s] * b[s][k]).sum::<f64>();
            b[r] = std::array::from_fn(|k| (b[r][k] - sum(k)) / l[m * r + r]);
        }
        for r in (0..m).rev() {
            let sum = |k: usize| (r + 1..m).map(|s| l[m * s + r] * b[s][k]).sum::<f64>();
            b[r] = std::array::from_fn(|k| (b[r][k] - sum(k)) / l[m * r + r]);
        }
    }
}

fn strain<const D: usize>(at: &[[f64; D]], next: &[[f64; D]]) -> f64 {
    let mut most: f64 = 0.0;
    for i in 0..at.len() {
        for j in 0..i {
            let (mut apart, mut moved) = (0.0, 0.0);
            for k in 0..D {
                let d = at[i][k] - at[j][k];
                apart += d * d;
                moved += (next[i][k] - next[j][k] - d).powi(2);
            }
            if moved > 0.0 {
                most = most.max(moved / apart);
            }
        }
    }
    most.sqrt()
}

fn centre<const D: usize>(points: &[[f64; D]]) -> [f64; D] {
    let first = points[0];
    let count = points.len() as f64;
    std::array::from_fn(|k| first[k] + points.iter().map(|point| point[k] - first[k]).sum::<f64>() / count)
}

fn product<const D: usize>(a: &Matrix<D>, b: &Matrix<D>) -> Matrix<D> {
    std::array::from_fn(|r| std::array::from_fn(|c| (0..D).map(|k| a[r][k] * b[k][c]).sum()))
}

/// The vector of a rotation, of at most half a turn.
fn vector<const D: usize>(rotation: &Matrix<D>) -> Turn {
    match D {
        1 => [0.0; 3],
        2 => [0.0, 0.0, rotation[1][0].atan2(rotation[0][0])],
        _ => {
            let c: Matrix<D> = transposed(rotation);
            let [w, x, y, z] = best_quaternion(&c);
            let side = if w < 0.0 { -1.0 } else { 1.0 };
            let sine = length(&[x, y, z]);
            let angle = 2.0 * sine.atan2(side * w);
            if sine > 0.0 {
                [x, y, z].map(|c| side * angle * c / sine)
            } else {
                [0.0; 3]
            }
        }
    }
}

/// The rotation by the part `t` of a turn.
fn rotation<const D: usize>(turn: &Turn, t: f64) -> Matrix<D> {
    let angle = length(turn);
    if angle == 0.0 || D == 1 {
        return identity();
    }
    let (sin, cos) = (t * angle).sin_cos();
    let [x, y, z] = turn.map(|c| c / angle);
    let rest = 1.0 - cos;
    let full = [
        [1.0 - rest * (y * y + z * z), rest * x * y - sin * z, rest * x * z + sin * y],
        [rest * x * y + sin * z, 1.0 - rest * (x * x + z * z), rest * y * z - sin * x],
        [rest * x * z - sin * y, rest * y * z + sin * x, 1.0 - rest * (x * x + y * y)],
    ];
    std::array::from_fn(|r| std::array::from_fn(|c| full[r][c]))
}

/// The turn of the same rotation that is nearest to another turn.
fn wound(turn: Turn, near: Turn) -> Turn {
    let (angle, far) = (length(&turn), length(&near));
    let axis = match angle < NO_TURN {
        true if far > NO_TURN => near.map(|c| c / far),
        true => return turn,
        false => turn.map(|c| c / angle),
    };
    let along: f64 = axis.iter().zip(near).map(|(a, b)| a * b).sum();
    let angle = angle + TAU * ((along - angle) / TAU).round();
    axis.map(|c| c * angle)
}

fn length(turn: &Turn) -> f64 {
    turn.iter().map(|c| c * c).sum::<f64>().sqrt()
}
