//! How long each step is: twice the last one, halved until it hardly bends space.

use super::path::{Leg, Path, LARGEST_TURN};
use super::watched::{Travellers, Watched};
use super::{Composed, Found, Step, MOST_STEPS};
use crate::aim::{greatest, Aim, Handles};
use crate::deformer::{Deformer, Pose};
use crate::error::Error;
use crate::geometry::Frame;
use crate::machine::progress::{report, Progress};
use crate::mls::Transform;
use crate::weights::Weights;
use std::f64::consts::PI;
use std::sync::Arc;

/// What `|d_i - d_j| / |h_i - h_j|` of a step may be, of all pairs of control points: what predicts a fold.
const STRAIN: f64 = 0.4;
/// The least `det J` that a step may have at the places of the search.
const LEAST: f64 = 0.3;
/// The part of the progress until one step has been tried, and for what is checked in the end.
const FIRST: f64 = 0.1;

/// Fits weights to control points (m x dim) where they are now, in a frame.
pub type Refit<'a> = dyn Fn(&[f64], Frame, &mut Progress<'_>) -> Result<Weights, Error> + 'a;

/// How control points are taken to where they are to go.
#[derive(Clone, Copy)]
pub struct Rules<'a> {
    /// The family of local maps.
    pub transform: Transform,
    /// T > 0.
    pub temperature: f64,
    /// Whether they are aimed as [`Handles::aim_carefully`] does, or as [`Handles::aim`] does.
    pub careful: bool,
    /// How much of the way, as in [`Handles::aim`].
    pub adherence: &'a [f64],
    /// Rotation vectors (m x 3, radians) of the orientations that were given as angles, NaN for others: a turn of 370 degrees is one.
    pub turns: Option<&'a [f64]>,
}

impl Rules<'_> {
    fn aim(&self, handles: &Handles, pose: Pose<'_>, adherence: &[f64]) -> Result<Aim, Error> {
        match self.careful {
            true => handles.aim_carefully(pose, self.temperature, adherence),
            false => handles.aim(pose, self.temperature, adherence),
        }
    }
}

impl Composed {
    /// The composition that takes the control points of `weights` to the targets of `pose` and folds nothing at the places of a shape, or the
    /// last of [`MOST_STEPS`] steps that were tried; one step, if that folds nothing.
    ///
    /// # Errors
    /// As [`Handles::aim`]; [`Error::Cancelled`]; where weights cannot be fitted on the way.
    pub fn search<'a>(
        weights: Arc<Weights>,
        pose: impl Into<Pose<'a>>,
        rules: Rules<'_>,
        watched: &Watched,
        refit: &Refit<'_>,
        progress: &mut Progress<'_>,
    ) -> Result<Composed, Error> {
        let pose = pose.into();
        let mut most: f64 = 0.0;
        let progress = &mut |done: f64| {
            most = most.max(done);
            progress(most)
        };
        report(progress, 0.0)?;
        let mut tried = |one: bool| {
            let stand = Stand::new(weights.clone(), watched.travellers(false), rules)?;
            let (steps, misses) = match weights.dim() {
                1 => steps::<1>(stand, pose, rules, one, refit, progress)?,
                2 => steps::<2>(stand, pose, rules, one, refit, progress)?,
                _ => steps::<3>(stand, pose, rules, one, refit, progress)?,
            };
            let found = checked(&steps, rules, watched, progress)?;
            Ok::<_, Error>((steps, misses, found))
        };
        let (mut steps, mut misses, mut found) = tried(true)?;
        if steps.len() == 1 && found.least <= 0.0 {
            // A fold that the search did not see.
            (steps, misses, found) = tried(false)?;
        }
        report(progress, 1.0)?;
        Composed::of(steps, rules.transform, rules.temperature, misses, found)
    }
}

/// Everything where it is before a step.
struct Stand {
    weights: Arc<Weights>,
    handles: Handles,
    travellers: Travellers,
    bound: Deformer,
}

/// A step that was tried.
struct Tried {
    aim: Aim,
    least: f64,
    /// Where it takes the places.
    places: Vec<f64>,
}

impl Stand {
    fn new(weights: Arc<Weights>, travellers: Travellers, rules: Rules<'_>) -> Result<Stand, Error> {
        let handles = Handles::new(&weights, rules.transform)?;
        let bound = travellers.bind(&weights, rules.transform)?;
        Ok(Stand { weights, handles, travellers, bound })
    }

    fn tried(&self, rules: Rules<'_>, pose: Pose<'_>, adherence: &[f64]) -> Result<Tried, Error> {
        let aim = rules.aim(&self.handles, pose, adherence)?;
        let aimed = Pose { q: &aim.targets, ..pose };
        let (places, determinants) =
            self.travellers.look(&self.bound, aimed, rules.temperature, &mut |_| true)?;
        let least = determinants.iter().copied().fold(f64::INFINITY, f64::min);
        Ok(Tried { aim, least, places })
    }

    fn step(&self, pose: Pose<'_>, aim: &Aim) -> Step {
        let orientations = pose.orientations.map(<[f64]>::to_vec);
        Step { weights: self.weights.clone(), targets: aim.targets.clone(), orientations }
    }
}

/// The steps, one if it may be one and that folds nothing, and how far the last one leaves each control point from where it was to go.
fn steps<const D: usize>(
    mut stand: Stand,
    pose: Pose<'_>,
    rules: Rules<'_>,
    one: bool,
    refit: &Refit<'_>,
    progress: &mut Progress<'_>,
) -> Result<(Vec<Step>, Vec<f64>), Error> {
    let (dim, frame) = (stand.weights.dim(), stand.weights.frame());
    let p = stand.weights.control_points().to_vec();
    let goal = stand.handles.goal(pose, rules.temperature, rules.adherence)?;
    let on_the_way = Pose { q: &goal, ..pose };
    let motion = stand.handles.anchor(on_the_way.q, pose.orientations)?.rotation;
    let path = Path::<D>::new(&p, on_the_way, rules.turns, &motion);
    if one && path.largest_turn() <= PI {
        let one = stand.tried(rules, pose, rules.adherence)?;
        if one.least > 0.0 {
            return Ok((vec![stand.step(pose, &one.aim)], one.aim.misses));
        }
    }
    report(progress, FIRST)?;
    let progress = &mut |done: f64| progress(FIRST + (1.0 - 2.0 * FIRST) * done);
    let (mut steps, mut h, mut t, mut last) = (Vec::new(), p, 0.0, f64::INFINITY);
    loop {
        report(progress, t)?;
        // Short enough to arrive with the steps that are left, even if each had to be the shortest.
        let left = 1.0 - t;
        let shortest = left / (MOST_STEPS - steps.len()) as f64;
        let mut length = left.min(2.0 * last);
        let (leg, tried, to) = loop {
            let to = if length >= left * (1.0 - 1e-9) { 1.0 } else { t + length };
            let leg = path.leg(&h, t, to);
            let no_shorter = length <= shortest * (1.0 + 1e-9);
            let turned = path.largest_turn() * (to - t);
            if no_shorter || (leg.strain <= STRAIN && turned <= LARGEST_TURN) {
                let tried = stand.tried(rules, leg.pose(), &[1.0])?;
                if no_shorter || tried.least >= LEAST {
                    break (leg, tried, to);
                }
            }
            length = (length / 2.0).max(shortest);
        };
        (t, last) = (to, length);
        steps.push(stand.step(leg.pose(), &tried.aim));
        if t >= 1.0 {
            return Ok((steps, tried.aim.misses));
        }
        let step = &steps[steps.len() - 1];
        h = stand.handles.land(step.pose(), rules.temperature)?;
        let weights = refit(&h, around(frame, &h, dim), &mut |_| progress(t))?;
        let mut travellers = stand.travellers;
        travellers.at = tried.places;
        stand = Stand::new(Arc::new(weights), travellers, rules)?;
    }
}

impl Leg {
    fn pose(&self) -> Pose<'_> {
        Pose { q: &self.targets, orientations: self.orientations.as_deref() }
    }
}

/// The frame, or a larger one where control points have left it.
fn around(frame: Frame, h: &[f64], dim: usize) -> Frame {
    let corners = |way: f64| (0..dim).map(move |k| frame.centre[k] + way * frame.half);
    let all: Vec<f64> = h.iter().copied().chain(corners(-1.0)).chain(corners(1.0)).collect();
    let larger = Frame::around(&all, dim);
    if larger.half > frame.half * (1.0 + 1e-9) {
        larger
    } else {
        frame
    }
}

/// What the steps do to other places.
fn checked(
    steps: &[Step],
    rules: Rules<'_>,
    watched: &Watched,
    progress: &mut Progress<'_>,
) -> Result<Found, Error> {
    let mut others = watched.travellers(true);
    let (rest, dim) = (others.at.clone(), steps[0].weights.dim());
    let mut whole = vec![1.0; rest.len() / dim];
    let mut folded = vec![false; whole.len()];
    for (k, step) in steps.iter().enumerate() {
        let bound = others.bind(&step.weights, rules.transform)?;
        let (places, determinants) = others.look(&bound, step.pose(), rules.temperature, &mut |_| true)?;
        others.at = places;
        for ((whole, folded), det) in whole.iter_mut().zip(&mut folded).zip(determinants) {
            // Turned inside out twice is no better.
            *folded |= det <= 0.0;
            *whole = if det < 0.0 { -(*whole * det).abs() } else { *whole * det };
        }
        report(progress, 1.0 - FIRST * (1.0 - k as f64 / steps.len() as f64))?;
    }
    let (worst, least) = greatest(whole.iter().map(|det| -det));
    let part = |folded: &[bool]| folded.iter().filter(|folded| **folded).count() as f64 / folded.len() as f64;
    let (on, off) = folded.split_at(others.on);
    Ok(Found {
        least: -least,
        folded: part(on),
        folded_around: part(off),
        place: rest[dim * worst..][..dim].to_vec(),
    })
}
