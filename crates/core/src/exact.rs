//! Handles that arrive: effective targets that take each control point all the way to its target.
//!
//! MLS approximates: the deformation `f(.; q)` takes the control point `p_i` near its target `q_i`, not onto it. Since the weights do not depend
//! on the targets, one may aim elsewhere: [`ExactHandles::aim`] solves
//!
//! ```text
//! f(p_i; q') = q_i   for all i
//! ```
//!
//! by `q' <- q' + (q - f(p; q'))`, with Anderson's acceleration (Anderson 1965; Walker, Ni 2011). The unknowns are the targets alone, so
//! it costs a few frames of as many points as there are control points. [`ExactHandles::aim_carefully`] does so only where it is worth it.

use crate::deformer::{Deformer, Pose};
use crate::error::Error;
use crate::mls::Transform;
use crate::softmax;

/// Differences that the acceleration looks back on.
const HISTORY: usize = 6;
/// Evaluations at most.
const MOST: usize = 100;
/// A handle has arrived when it misses by less than this part of the targets' extent.
const ARRIVED: f64 = 1e-11;
/// Halvings of a step that does not help, until no shorter one is tried.
const HALVINGS: i32 = 8;
/// With less of the weight at its own place a control point is aimed so far past its target that the shape suffers: of the published
/// displacements, those with 0.15 or less fold and miss, those with 0.28 or more do neither (docs/beyond-the-paper.md).
const OWNED: f64 = 0.25;
/// For the careful aim a handle has arrived when it misses by no more than this part of the targets' extent.
const REACHED: f64 = 1e-6;

/// The control points as points that are deformed themselves.
pub struct ExactHandles {
    handles: Deformer,
    dim: usize,
    p: Vec<f64>,
}

/// Where to aim.
#[derive(Clone, Debug, PartialEq)]
pub struct Aim {
    /// The effective targets `q'`, m x dim: what to give to [`Deformer::deform`] in the place of `q`.
    pub targets: Vec<f64>,
    /// How far each control point stays from where it was to go, m.
    pub misses: Vec<f64>,
    /// Why a careful aim has left them soft; none where it has not.
    pub soft: Option<Soft>,
}

/// Why control points are left where plain MLS takes them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Soft {
    /// The control point has only so much of the weight at its own place.
    Shared(usize, f64),
    /// The control point would stay so far from its target all the same.
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

impl ExactHandles {
    /// For the control points `p` (m x dim), `logits` (m x m) being what the weight function says of each.
    ///
    /// # Errors
    /// As [`Deformer::new`].
    pub fn new(p: &[f64], dim: usize, logits: Vec<f32>, transform: Transform) -> Result<ExactHandles, Error> {
        let handles = Deformer::new(p.to_vec(), dim, p, logits, transform)?;
        Ok(ExactHandles { handles, dim, p: p.to_vec() })
    }

    /// Lets the control points do something else to the shape locally.
    pub fn set_transform(&mut self, transform: Transform) {
        self.handles.set_transform(transform);
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

    /// [`ExactHandles::aim`] where it is worth it: the targets themselves, and why, where a control point has too little of the
    /// weight at its own place, or would not arrive.
    ///
    /// # Errors
    /// As [`ExactHandles::aim`].
    pub fn aim_carefully<'a>(
        &self,
        pose: impl Into<Pose<'a>>,
        temperature: f64,
        adherence: f64,
    ) -> Result<Aim, Error> {
        let pose = pose.into();
        check_adherence(adherence)?;
        let landed = self.land(pose, temperature)?;
        let misses = distances(&landed, pose.q, self.dim);
        let mut soft = Aim { targets: pose.q.to_vec(), misses, soft: None };
        let reached = REACHED * self.extent(pose.q);
        let (_, miss) = greatest(soft.misses.iter().copied());
        if adherence == 0.0 || miss <= reached {
            return Ok(soft);
        }
        let m = soft.misses.len();
        let mut weights = vec![0.0; m];
        let (least, lost) = greatest(self.logits().chunks_exact(m).enumerate().map(|(i, logits)| {
            softmax::weights(logits, temperature, &mut weights);
            1.0 - weights[i]
        }));
        if 1.0 - lost < OWNED {
            soft.soft = Some(Soft::Shared(least, 1.0 - lost));
            return Ok(soft);
        }
        let aim = self.solve(pose, temperature, adherence, &landed)?;
        let (worst, miss) = greatest(aim.misses.iter().copied());
        if miss > reached {
            soft.soft = Some(Soft::Unreached(worst, miss));
            return Ok(soft);
        }
        Ok(aim)
    }

    /// What would let a careful aim arrive, tried: half the temperature, else the affine transform.
    ///
    /// # Errors
    /// As [`ExactHandles::aim`].
    pub fn remedy<'a>(
        &self,
        pose: impl Into<Pose<'a>>,
        temperature: f64,
        adherence: f64,
    ) -> Result<Option<Remedy>, Error> {
        let pose = pose.into();
        let arrives = |handles: &ExactHandles, temperature: f64| -> Result<bool, Error> {
            Ok(handles.aim_carefully(pose, temperature, adherence)?.soft.is_none())
        };
        if arrives(self, temperature / 2.0)? {
            return Ok(Some(Remedy::Temperature(temperature / 2.0)));
        }
        let affine = ExactHandles::new(&self.p, self.dim, self.logits().to_vec(), Transform::Affine)?;
        Ok(arrives(&affine, temperature)?.then_some(Remedy::Affine))
    }

    /// The effective targets for the targets of `pose` (m x dim), at `temperature` > 0; its turns are taken as they are.
    ///
    /// With `adherence` 1 the control points go to their targets; with 0 to where MLS takes them, and the effective targets are the
    /// targets; between, to that part of the way from the one to the other. Where that cannot be reached, the nearest that was found.
    ///
    /// # Errors
    /// As [`Deformer::deform`]; where the adherence is not from 0 to 1.
    pub fn aim<'a>(&self, pose: impl Into<Pose<'a>>, temperature: f64, adherence: f64) -> Result<Aim, Error> {
        let pose = pose.into();
        check_adherence(adherence)?;
        self.solve(pose, temperature, adherence, &self.land(pose, temperature)?)
    }

    /// [`ExactHandles::aim`], where plain MLS takes the control points to `landed`.
    fn solve(&self, pose: Pose<'_>, temperature: f64, adherence: f64, landed: &[f64]) -> Result<Aim, Error> {
        let Pose { q, turns } = pose;
        let arrive = |targets: &[f64]| self.land(Pose { q: targets, turns }, temperature);
        let goal: Vec<f64> = landed.iter().zip(q).map(|(soft, q)| soft + adherence * (q - soft)).collect();
        let rest = |arrived: &[f64]| -> Vec<f64> { goal.iter().zip(arrived).map(|(g, a)| g - a).collect() };
        let enough = ARRIVED * self.extent(q);

        let mut now = Guess { rest: rest(landed), targets: q.to_vec() };
        let mut best = now.clone();
        let mut history = History::default();
        let mut halvings = 0;
        for _ in 0..MOST {
            if best.worst() <= enough || halvings > HALVINGS {
                break;
            }
            let step = history.step(&now.rest);
            let step = step.iter().map(|s| s * 0.5f64.powi(halvings));
            let targets: Vec<f64> = now.targets.iter().zip(step).map(|(t, s)| t + s).collect();
            let next = Guess { rest: rest(&arrive(&targets)?), targets };
            if next.square() < best.square() {
                halvings = 0;
                history.push(&now, &next);
                best = next.clone();
                now = next;
            } else {
                // What was learned leads astray: from the best again, by a plain and shorter step.
                halvings += 1;
                history = History::default();
                now = best.clone();
            }
        }
        let misses = distances(&best.rest, &vec![0.0; q.len()], self.dim);
        Ok(Aim { targets: best.targets, misses, soft: None })
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

fn check_adherence(adherence: f64) -> Result<(), Error> {
    if (0.0..=1.0).contains(&adherence) {
        Ok(())
    } else {
        Err(Error::argument("adherence", format!("expected 0 to 1, found {adherence}")))
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

/// Targets that were tried, and what they leave.
#[derive(Clone)]
struct Guess {
    targets: Vec<f64>,
    rest: Vec<f64>,
}

impl Guess {
    fn worst(&self) -> f64 {
        self.rest.iter().fold(0.0, |worst, r| r.abs().max(worst))
    }

    fn square(&self) -> f64 {
        self.rest.iter().map(|r| r * r).sum()
    }
}

/// The last differences of targets and rests.
#[derive(Default)]
struct History {
    targets: Vec<Vec<f64>>,
    rests: Vec<Vec<f64>>,
}

impl History {
    fn push(&mut self, before: &Guess, after: &Guess) {
        let difference = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect();
        if self.rests.len() == HISTORY {
            self.targets.remove(0);
            self.rests.remove(0);
        }
        self.targets.push(difference(&after.targets, &before.targets));
        self.rests.push(difference(&after.rest, &before.rest));
    }

    /// The step to take: the rest, less what the differences explain of it, which they know a better step for.
    ///
    /// `rest - (dT + dR) gamma`, `gamma` minimising `|rest - dR gamma|`.
    fn step(&self, rest: &[f64]) -> Vec<f64> {
        let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let mut step = rest.to_vec();
        // Gram and Schmidt on the differences, the newest first, each with what it does to the targets.
        let mut basis: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
        for (target, rest_difference) in self.targets.iter().zip(&self.rests).rev() {
            let (mut t, mut r) = (target.clone(), rest_difference.clone());
            let length = dot(&r, &r);
            for (bt, br) in &basis {
                let along = dot(&r, br);
                r.iter_mut().zip(br).for_each(|(r, b)| *r -= along * b);
                t.iter_mut().zip(bt).for_each(|(t, b)| *t -= along * b);
            }
            let left = dot(&r, &r);
            if left <= 1e-20 * length || left == 0.0 {
                continue; // says nothing new
            }
            let scale = left.sqrt().recip();
            r.iter_mut().chain(&mut t).for_each(|v| *v *= scale);
            basis.push((t, r));
        }
        for (t, r) in &basis {
            let along = dot(rest, r);
            for ((step, t), r) in step.iter_mut().zip(t).zip(r) {
                *step -= along * (t + r);
            }
        }
        step
    }
}

#[cfg(test)]
mod tests;
