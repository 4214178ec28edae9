//! Fixed points by Anderson's acceleration (Anderson 1965; Walker, Ni 2011).

use crate::error::Error;

/// Differences that the acceleration looks back on.
const HISTORY: usize = 10;
/// Evaluations at most.
const MOST: usize = 100;
/// A step over hills may leave this many times the square of the best rest: where rotations swing, the way down leads over them.
const UPHILL: f64 = 9.0;
/// Halvings of a step downhill that does not help, until no shorter one is tried.
const HALVINGS: i32 = 8;
/// A difference of which no more than this part (of its square) is new says nothing new.
const SAME: f64 = 1e-12;

/// Targets that were tried, and what they leave.
#[derive(Clone)]
pub(super) struct Guess {
    pub targets: Vec<f64>,
    pub rest: Vec<f64>,
}

impl Guess {
    fn worst(&self) -> f64 {
        self.rest.iter().fold(0.0, |worst, r| r.abs().max(worst))
    }

    fn square(&self) -> f64 {
        self.rest.iter().map(|r| r * r).sum()
    }
}

/// From `start` to targets that leave no more than `enough` of any coordinate, or else the best that were found; only downhill, or `over_hills`, by
/// which an equation that has a solution is solved more often, and one that has none leads farther astray.
///
/// # Errors
/// Those of `rest`, which says what targets leave.
pub(super) fn solve(
    start: Guess,
    enough: f64,
    over_hills: bool,
    rest: impl Fn(&[f64]) -> Result<Vec<f64>, Error>,
) -> Result<Guess, Error> {
    let (mut now, mut best) = (start.clone(), start);
    let mut history = History::default();
    let mut halvings = 0;
    for _ in 0..MOST {
        if best.worst() <= enough || halvings > HALVINGS {
            break;
        }
        let step = history.step(&now.rest);
        let step = step.iter().map(|s| s * 0.5f64.powi(halvings));
        let targets: Vec<f64> = now.targets.iter().zip(step).map(|(t, s)| t + s).collect();
        let next = Guess { rest: rest(&targets)?, targets };
        let better = next.square() < best.square();
        if better || over_hills {
            history.push(&now, &next);
            halvings = 0;
        } else {
            // What was learned leads astray: from the best again, by a plain and shorter step.
            history = History::default();
            halvings += 1;
        }
        let near = over_hills && next.square() <= UPHILL * best.square();
        if better {
            best = next.clone();
        }
        now = if better || near { next } else { best.clone() };
    }
    Ok(best)
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
            if left <= SAME * length || left == 0.0 {
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
