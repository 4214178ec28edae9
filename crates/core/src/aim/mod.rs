//! Handles that arrive: effective targets that take each control point all the way to its target.
//!
//! MLS approximates: the deformation `f(.; q)` takes the control point `p_i` near its target `q_i`, not onto it. Since the weights do not depend
//! on the targets, one may aim elsewhere: [`Handles::aim`] solves
//!
//! ```text
//! f(p_i; q') = q_i   for all i
//! ```
//!
//! by `q' <- q' + (q - f(p; q'))`, with Anderson's acceleration (Anderson 1965; Walker, Ni 2011). The unknowns are the targets alone, so
//! it costs a few frames of as many points as there are control points. [`Handles::aim_carefully`] does so only where it is worth it, and
//! without jumps.

use crate::deformer::{Deformed, Deformer, Pose};
use crate::error::Error;
use crate::mls::{squares, Transform};
use crate::softmax;
use crate::weights::Weights;
use anderson::Guess;

mod anderson;
mod left_out;

pub use left_out::Stiff;

/// A handle has arrived when it misses by less than this part of the targets' extent.
const ARRIVED: f64 = 1e-11;
/// With less of the weight at its own place a control point is aimed so far past its target that the shape suffers: of the published
/// displacements, those with 0.15 or less fold and miss, those with 0.28 or more do neither (docs/notes/beyond-the-paper.md).
const OWNED: f64 = 0.25;
/// Two control points have the same weights when each has this much at the other's place, in what it has at its own (product of both): rigid
/// maps cannot part them. Published displacements with 0.25 of the weight and more: up to 0.40.
const ALIKE: f64 = 0.7;
/// For the careful aim a handle has arrived when it misses by no more than this part of the targets' extent.
const REACHED: f64 = 1e-6;
/// Two ways to take a handle to a place are the same when they differ by no more than this part of the targets' extent.
const SAME: f64 = 1e-7;
/// A careful aim does not rely on a rotation at a control point that is better than others by less than this part of what it is at rest. Of
/// 0.02, 0.05 and 0.1 this had the fewest drags with jumps, and all of the published displacements still arrive (docs/notes/beyond-the-paper.md).
const UNDECIDED: f64 = 0.1;

/// The control points as points that are deformed themselves.
pub struct Handles {
    handles: Deformer,
    /// The same, but by the mean of the rotations where one is as good as another.
    decided: Deformer,
    dim: usize,
    p: Vec<f64>,
    transform: Transform,
}

/// The map that fits all control points with equal weights.
#[derive(Clone, Debug, PartialEq)]
pub struct Anchor {
    /// The best rotation, dim x dim, row-major; the identity where the control points leave it open.
    pub rotation: Vec<f64>,
    /// The best scale (similarity); 1 where there is none.
    pub scale: f64,
    /// The best linear map (affine), dim x dim, row-major.
    pub linear: Vec<f64>,
}

/// Where to aim.
#[derive(Clone, Debug, PartialEq)]
pub struct Aim {
    /// The effective targets `q'`, m x dim: what to give to [`Deformer::deform`] in the place of `q`.
    pub targets: Vec<f64>,
    /// How far each control point stays from where it was to go, m.
    pub misses: Vec<f64>,
    /// Why a careful aim does not take them there; none where it does.
    pub soft: Option<Soft>,
}

/// Why control points do not arrive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Soft {
    /// All are left where plain MLS takes them: the control point has only so much of the weight at its own place.
    Shared(usize, f64),
    /// They are taken as far as it goes without a jump; the control point stays so far from where it was to go, the farthest.
    Unreached(usize, f64),
}

impl Soft {
    /// Its name in every face, the control point, and how much.
    pub fn named(self) -> (&'static str, usize, f64) {
        match self {
            Soft::Shared(control_point, owned) => ("shared", control_point, owned),
            Soft::Unreached(control_point, miss) => ("unreached", control_point, miss),
        }
    }
}

/// What would let control points arrive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Remedy {
    /// Another temperature.
    Temperature(f64),
    /// The affine transform.
    Affine,
}

impl Handles {
    /// For the control points of `weights`.
    ///
    /// # Errors
    /// As [`Deformer::new`].
    pub fn new(weights: &Weights, transform: Transform) -> Result<Handles, Error> {
        let own_logits = weights.logits(weights.control_points(), &mut |_| true)?;
        Handles::of_logits(weights.control_points(), weights.dim(), own_logits, transform)
    }

    /// For the control points `p` (m x dim), `own_logits` (m x m) being what the weight function says of each.
    ///
    /// # Errors
    /// As [`Deformer::of_logits`].
    pub fn of_logits(
        p: &[f64],
        dim: usize,
        own_logits: Vec<f32>,
        transform: Transform,
    ) -> Result<Handles, Error> {
        let handles = Deformer::of_logits(p.to_vec(), dim, p, own_logits.clone(), transform)?;
        let decided = Deformer::of_logits(p.to_vec(), dim, p, own_logits, transform)?.undecided(UNDECIDED);
        Ok(Handles { handles, decided, dim, p: p.to_vec(), transform })
    }

    /// Lets the control points do something else to the shape locally.
    pub fn set_transform(&mut self, transform: Transform) {
        self.handles.set_transform(transform);
        self.decided.set_transform(transform);
        self.transform = transform;
    }

    /// What the weight function says of each control point, m x m.
    pub fn logits(&self) -> &[f32] {
        self.handles.logits()
    }

    /// Where the control points go when they are pulled to the targets of `pose` (m x dim): near them.
    ///
    /// # Errors
    /// As [`Deformer::deform`].
    pub fn land<'a>(&self, pose: impl Into<Pose<'a>>, temperature: f64) -> Result<Vec<f64>, Error> {
        Ok(self.handles.deform(pose, temperature, false, &mut |_| true)?.positions)
    }

    /// The same with the local maps at the control points.
    ///
    /// # Errors
    /// As [`Deformer::deform`].
    pub fn land_with_maps<'a>(&self, pose: impl Into<Pose<'a>>, temperature: f64) -> Result<Deformed, Error> {
        self.handles.deform(pose, temperature, true, &mut |_| true)
    }

    /// What local maps follow where the control points around them leave something open.
    ///
    /// # Errors
    /// Where `q` (m x dim) or `orientations` (m x dim x dim) do not fit.
    pub fn anchor(&self, q: &[f64], orientations: Option<&[f64]>) -> Result<Anchor, Error> {
        let (rotation, scale, linear) = self.handles.global(Pose { q, orientations })?;
        Ok(Anchor { rotation, scale, linear })
    }

    /// How far each control point is from the nearest other one, squared; 1 where there is no other place. What an oriented one counts by.
    pub fn squares(&self) -> Vec<f64> {
        match self.dim {
            1 => squares(self.p.as_chunks::<1>().0),
            2 => squares(self.p.as_chunks::<2>().0),
            _ => squares(self.p.as_chunks::<3>().0),
        }
    }

    /// [`Handles::aim`] where it is worth it, and without jumps: the targets themselves where a control point has too little of the weight
    /// at its own place; near them where it would not arrive.
    ///
    /// Arms turn at control points, `f(p_i; q') = sum w_k q'_k + M_i (p_i - p*)`. Where a drag takes `M_i` through a half turn there are
    /// targets that no `q'` reaches, and beside them a `q'` that jumps. So the equation is solved with the mean of the rotations that fit nearly
    /// as well as the best one. Where that one is better by [`UNDECIDED`] this is the same; elsewhere `q'` goes on smoothly, and
    /// the control point stays off by no more than its arm.
    ///
    /// # Errors
    /// As [`Handles::aim`].
    pub fn aim_carefully<'a>(
        &self,
        pose: impl Into<Pose<'a>>,
        temperature: f64,
        adherence: &[f64],
    ) -> Result<Aim, Error> {
        let pose = pose.into();
        let goal = self.goal(pose, temperature, adherence)?;
        let reached = REACHED * self.extent(pose.q);
        let shared = self.shared(temperature);
        let mut aim = if adherence.iter().all(|part| *part == 0.0) || shared.is_some() {
            let misses = distances(&self.land(pose, temperature)?, &goal, self.dim);
            Aim { targets: pose.q.to_vec(), misses, soft: None }
        } else {
            let aim = self.solve(pose, temperature, &goal, false)?;
            let landed =
                self.decided.deform(Pose { q: &aim.targets, ..pose }, temperature, false, &mut |_| true)?;
            let away = distances(&landed.positions, &goal, self.dim);
            // Most often this solves the other equation too, and took a tenth of the time.
            if greatest(away.iter().copied()).1 <= SAME * self.extent(pose.q) {
                aim
            } else {
                self.solve(pose, temperature, &goal, true)?
            }
        };
        let (worst, miss) = greatest(aim.misses.iter().copied());
        if miss > reached {
            aim.soft = shared.or(Some(Soft::Unreached(worst, miss)));
        }
        Ok(aim)
    }

    /// The control point that has too little of the weight at its own place, if there is one. The targets are nothing to it.
    fn shared(&self, temperature: f64) -> Option<Soft> {
        let m = self.p.len() / self.dim;
        let mut w = vec![0.0; m * m];
        for (w, logits) in w.chunks_exact_mut(m).zip(self.logits().chunks_exact(m)) {
            softmax::weights(logits, temperature, w);
        }
        let own = |i: usize| w[(m + 1) * i];
        let (least, lost) = greatest((0..m).map(|i| 1.0 - own(i)));
        if 1.0 - lost < OWNED {
            return Some(Soft::Shared(least, 1.0 - lost));
        }
        let alike = |i: usize| (0..i).any(|k| w[m * i + k] * w[m * k + i] > ALIKE * own(i) * own(k));
        let one = (0..m).find(|&i| self.transform != Transform::Affine && alike(i))?;
        Some(Soft::Shared(one, own(one)))
    }

    /// Where an aim is to take the control points: the part `adherence` of the way from where plain MLS takes them to their targets.
    pub(crate) fn goal(
        &self,
        pose: Pose<'_>,
        temperature: f64,
        adherence: &[f64],
    ) -> Result<Vec<f64>, Error> {
        let m = self.p.len() / self.dim;
        if adherence.len() != 1 && adherence.len() != m {
            let message = format!(
                "expected one number, or one for each of {m} control points, found {}",
                adherence.len()
            );
            return Err(Error::argument("adherence", message));
        }
        if let Some(found) = adherence.iter().find(|part| !(0.0..=1.0).contains(*part)) {
            return Err(Error::argument("adherence", format!("expected 0 to 1, found {found}")));
        }
        let landed = self.land(pose, temperature)?;
        // One for all, or each its own.
        let part = |at: usize| adherence[(at / self.dim).min(adherence.len() - 1)];
        let goal = |(at, (soft, q)): (usize, (&f64, &f64))| soft + part(at) * (q - soft);
        Ok(landed.iter().zip(pose.q).enumerate().map(goal).collect())
    }

    /// What would let a careful aim arrive, tried: half the temperature, else the affine transform.
    ///
    /// # Errors
    /// As [`Handles::aim`].
    pub fn remedy<'a>(
        &self,
        pose: impl Into<Pose<'a>>,
        temperature: f64,
        adherence: &[f64],
    ) -> Result<Option<Remedy>, Error> {
        let pose = pose.into();
        let arrives = |handles: &Handles, temperature: f64| -> Result<bool, Error> {
            Ok(handles.aim_carefully(pose, temperature, adherence)?.soft.is_none())
        };
        if arrives(self, temperature / 2.0)? {
            return Ok(Some(Remedy::Temperature(temperature / 2.0)));
        }
        let affine = Handles::of_logits(&self.p, self.dim, self.logits().to_vec(), Transform::Affine)?;
        Ok(arrives(&affine, temperature)?.then_some(Remedy::Affine))
    }

    /// The effective targets for the targets of `pose` (m x dim), at `temperature` > 0; its turns are taken as they are.
    ///
    /// `adherence` is one number for all, or one for each control point. With 1 the control points go to their targets; with 0 to where MLS takes them, and the effective targets are the
    /// targets; between, to that part of the way from the one to the other. Where that cannot be reached, the nearest that was found.
    ///
    /// # Errors
    /// As [`Deformer::deform`]; where the adherence is not from 0 to 1.
    pub fn aim<'a>(
        &self,
        pose: impl Into<Pose<'a>>,
        temperature: f64,
        adherence: &[f64],
    ) -> Result<Aim, Error> {
        let pose = pose.into();
        let goal = self.goal(pose, temperature, adherence)?;
        self.solve(pose, temperature, &goal, false)
    }

    /// The effective targets where control points are taken to `goal`, or as near as was found, and how far they stay away; `decided`: by
    /// the equation that is solved without jumps.
    fn solve(&self, pose: Pose<'_>, temperature: f64, goal: &[f64], decided: bool) -> Result<Aim, Error> {
        let way = if decided { &self.decided } else { &self.handles };
        let rest = |targets: &[f64]| -> Result<Vec<f64>, Error> {
            let arrived =
                way.deform(Pose { q: targets, ..pose }, temperature, false, &mut |_| true)?.positions;
            Ok(goal.iter().zip(arrived).map(|(g, a)| g - a).collect())
        };
        let start = Guess { rest: rest(pose.q)?, targets: pose.q.to_vec() };
        let targets = anderson::solve(start, ARRIVED * self.extent(pose.q), decided, rest)?.targets;
        let misses = distances(&self.land(Pose { q: &targets, ..pose }, temperature)?, goal, self.dim);
        Ok(Aim { targets, misses, soft: None })
    }

    /// The longest side of the box around the control points and the targets.
    fn extent(&self, q: &[f64]) -> f64 {
        let side = |axis: usize| {
            let values = || self.p.iter().chain(q).skip(axis).step_by(self.dim);
            let (low, high) =
                (values().copied().fold(f64::MAX, f64::min), values().copied().fold(f64::MIN, f64::max));
            high - low
        };
        (0..self.dim).map(side).fold(0.0, f64::max)
    }
}

/// How far each of the points `a` is from that of `b`.
fn distances(a: &[f64], b: &[f64], dim: usize) -> Vec<f64> {
    let square = |(a, b): (&[f64], &[f64])| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    a.chunks_exact(dim).zip(b.chunks_exact(dim)).map(|pair| square(pair).sqrt()).collect()
}

/// The greatest value, the first of equals, and where it is.
pub(crate) fn greatest(values: impl Iterator<Item = f64>) -> (usize, f64) {
    values.enumerate().fold((0, f64::NEG_INFINITY), |most, (i, v)| if v > most.1 { (i, v) } else { most })
}

#[cfg(test)]
mod tests;
