//! The pipeline: logits -> softmax(T) -> MLS, for points that are bound once and deformed many times.

use crate::check::check_points;
use crate::error::Error;
use crate::geometry::{Frame, PointTree};
use crate::machine::memory::zeros;
use crate::machine::parallel::{any, for_each_at_once};
use crate::machine::progress::{report, Progress};
use crate::machine::simd::prefetch;
use crate::machine::threads::briefly;
use crate::mls::batch::{BatchMls, BatchPoints, Scratch, BATCH};
use crate::mls::{check_orientations, oriented, Global, Mls, Transform};
use crate::relax::{Elastic, Lift, Relaxed};
use crate::softmax::{check_temperature, relative_weights, PackedWeights};
use crate::weights::Weights;
use std::sync::{Arc, Mutex};

/// Points between two reports of progress.
const CHUNK: usize = 1 << 18;
/// Points that one thread takes at a time.
const BLOCK: usize = 2048;

/// Points bound to the logits that a weight function gave for them. Dragging changes the targets alone.
///
/// ```
/// use neuralmls_core::{Deformer, Frame, InverseDistance, Transform, Weights};
/// let weights = InverseDistance::new(&[0.0, 2.0], 1, Frame::IDENTITY, 1.0, 0.0).unwrap();
/// let weights = Weights::InverseDistance(weights);
/// let deformer = Deformer::new(vec![0.0, 1.0, 2.0], &weights, None, Transform::Rigid, &mut |_| true).unwrap();
/// let moved = deformer.deform(&[1.0, 3.0], 1.0, false, &mut |_| true).unwrap();
/// assert_eq!(moved.positions, [1.0, 2.0, 3.0]);
/// ```
pub struct Deformer {
    dim: usize,
    frame: Frame,
    x: Vec<f64>,
    p: Vec<f64>,
    logits: Vec<f32>,
    transform: Transform,
    /// See [`Mls::undecided`].
    undecided: f64,
    lift: Option<Lift>,
    /// The weights of the last frame.
    last: Mutex<Option<Arc<PackedWeights>>>,
}

/// The control points moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose<'a> {
    /// Where they go, m x dim.
    pub q: &'a [f64],
    /// How they are oriented, m x dim x dim, row-major: of each a rotation times a scale above 0, `s_i R_i`, or NaN throughout for one that says
    /// nothing; none where none of them does. Rigid maps leave the scale away.
    pub orientations: Option<&'a [f64]>,
}

impl<'a, Q: AsRef<[f64]> + ?Sized> From<&'a Q> for Pose<'a> {
    fn from(q: &'a Q) -> Self {
        Pose { q: q.as_ref(), orientations: None }
    }
}

/// The result of [`Deformer::deform`].
pub struct Deformed {
    /// `y`, as the points were given.
    pub positions: Vec<f64>,
    /// The local maps `M`, row-major, where they were asked for.
    pub maps: Option<Vec<f64>>,
}

impl Deformer {
    /// Binds the points `x` (n x dim) to the control points of `weights`; with a tree of the same points, where there is one, in which networks
    /// are evaluated sooner.
    ///
    /// # Errors
    /// [`Error::Cancelled`]; where a coordinate is not finite, or the tree does not fit.
    pub fn new(
        x: Vec<f64>,
        weights: &Weights,
        tree: Option<&PointTree>,
        transform: Transform,
        progress: &mut Progress<'_>,
    ) -> Result<Deformer, Error> {
        let logits = match (weights, tree) {
            // From the points themselves, which the tree has in single precision.
            (Weights::InverseDistance(_), _) | (_, None) => weights.logits(&x, progress)?,
            (_, Some(tree)) => weights.logits_of_tree(tree, progress)?,
        };
        Deformer::of_logits(x, weights.dim(), weights.control_points(), logits, transform)
    }

    /// Binds the points `x` (n x dim) to the control points `p` (m x dim) by `logits` (n x m).
    ///
    /// # Errors
    /// Where a size does not fit another, a coordinate is not finite, or a logit is NaN.
    pub fn of_logits(
        x: Vec<f64>,
        dim: usize,
        p: &[f64],
        logits: Vec<f32>,
        transform: Transform,
    ) -> Result<Deformer, Error> {
        let n = check_points("x", &x, dim)?;
        let m = check_points("p", p, dim)?;
        if m == 0 {
            return Err(Error::argument("p", "expected at least one control point, found none"));
        }
        if logits.len() != n * m {
            let message = format!("expected {n} x {m} logits, found {}", logits.len());
            return Err(Error::argument("logits", message));
        }
        if any(&logits, |l| l.is_nan()) {
            let at = logits.iter().position(|l| l.is_nan()).unwrap_or_default();
            return Err(Error::argument("logits", format!("the one at ({}, {}) is NaN", at / m, at % m)));
        }
        let frame = Frame::around(&x, dim);
        Ok(Deformer {
            dim,
            frame,
            x,
            p: p.to_vec(),
            logits,
            transform,
            undecided: 0.0,
            lift: None,
            last: Mutex::new(None),
        })
    }

    /// Lets it move points as [`Mls::undecided`] says.
    pub(crate) fn undecided(self, part: f64) -> Deformer {
        Deformer { undecided: part, ..self }
    }

    /// The same, bound to the nodes of an elastic shape too: for [`Deformer::relax`].
    ///
    /// # Errors
    /// [`Error::Memory`].
    pub fn lifted(self, elastic: &Elastic) -> Result<Deformer, Error> {
        let lift = Lift::new(elastic, &self.x, &self.logits)?;
        Ok(Deformer { lift: Some(lift), ..self })
    }

    /// Whether they are bound to an elastic shape.
    pub fn is_lifted(&self) -> bool {
        self.lift.is_some()
    }

    /// Takes the points from `y`, where [`Deformer::deform`] took them in the same pose, the part `amount` (0 to 1) of the way to where an elastic
    /// shape takes them: `y <- y + amount (E(x) - y)`; their `maps` likewise, where there are any.
    ///
    /// # Errors
    /// Where they are not [lifted](Deformer::lifted) to that shape, or `y` or `maps` have another size.
    pub fn relax(
        &self,
        relaxed: &Relaxed,
        amount: f64,
        y: &mut [f64],
        maps: Option<&mut [f64]>,
    ) -> Result<(), Error> {
        let Some(lift) = self.lift.as_ref().filter(|lift| lift.fits(relaxed)) else {
            return Err(Error::argument("relax", "the points are not bound to this elastic shape"));
        };
        let maps = maps.unwrap_or_default();
        if y.len() != self.x.len() || !maps.is_empty() && maps.len() != self.x.len() * self.dim {
            return Err(Error::argument("relax", "expected the positions and maps of these points"));
        }
        lift.apply(relaxed, amount, &self.x, y, maps);
        Ok(())
    }

    /// Points, n.
    pub fn len(&self) -> usize {
        self.x.len() / self.dim
    }

    /// The points, n x dim.
    pub fn points(&self) -> &[f64] {
        &self.x
    }

    /// What the points are bound by, n x m.
    pub fn logits(&self) -> &[f32] {
        &self.logits
    }

    /// Lets the next frames do something else to the shape locally; neither the logits nor the weights change by it.
    pub fn set_transform(&mut self, transform: Transform) {
        self.transform = transform;
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Where the points go when the control points go to the targets of `pose` (m x dim numbers, or with orientations a [`Pose`]), with
    /// the weights at `temperature` > 0; with the local maps if `maps`. If every target is its control point, and no orientation anything but the
    /// identity, the positions are the input bit for bit.
    ///
    /// The first frame at a temperature computes the weights; the next ones find them.
    ///
    /// # Errors
    /// [`Error::Cancelled`], [`Error::Memory`]; where the pose does not fit, is not finite, an orientation is none, or the temperature is not above 0.
    pub fn deform<'a>(
        &self,
        pose: impl Into<Pose<'a>>,
        temperature: f64,
        maps: bool,
        progress: &mut Progress<'_>,
    ) -> Result<Deformed, Error> {
        let mut positions = zeros(self.x.len())?;
        let mut matrices = if maps { Some(zeros(self.x.len() * self.dim)?) } else { None };
        self.deform_into(pose, temperature, &mut positions, matrices.as_deref_mut(), progress)?;
        Ok(Deformed { positions, maps: matrices })
    }

    /// [`Deformer::deform`] into memory that the caller has: `y` (n x dim), and `maps` (n x dim x dim) where they are wanted.
    ///
    /// # Errors
    /// As [`Deformer::deform`], and where `y` or `maps` have another size. What they hold then is not a result.
    pub fn deform_into<'a>(
        &self,
        pose: impl Into<Pose<'a>>,
        temperature: f64,
        y: &mut [f64],
        maps: Option<&mut [f64]>,
        progress: &mut Progress<'_>,
    ) -> Result<(), Error> {
        let pose = pose.into();
        check_temperature(temperature)?;
        let unmoved = self.unmoved(pose)?;
        let room = |name, found: usize, expected: usize| {
            let message = || format!("expected room for {expected} numbers, found {found}");
            if found == expected {
                Ok(())
            } else {
                Err(Error::argument(name, message()))
            }
        };
        room("y", y.len(), self.x.len())?;
        if let Some(maps) = &maps {
            room("maps", maps.len(), self.x.len() * self.dim)?;
        }
        if !unmoved || maps.is_some() {
            match self.dim {
                1 => self.deform_in::<1>(pose, temperature, y, maps, progress)?,
                2 => self.deform_in::<2>(pose, temperature, y, maps, progress)?,
                _ => self.deform_in::<3>(pose, temperature, y, maps, progress)?,
            }
        }
        if unmoved {
            y.copy_from_slice(&self.x);
        }
        report(progress, 1.0)
    }

    /// Checks that a pose fits; gives whether it leaves everything where it is.
    pub(crate) fn unmoved(&self, pose: Pose<'_>) -> Result<bool, Error> {
        unmoved(&self.p, self.dim, pose)
    }

    /// The map of its kind that fits all control points with equal weights: its rotation (row-major), scale and linear map (row-major).
    pub(crate) fn global(&self, pose: Pose<'_>) -> Result<(Vec<f64>, f64, Vec<f64>), Error> {
        self.unmoved(pose)?;
        Ok(match self.dim {
            1 => self.global_in::<1>(pose),
            2 => self.global_in::<2>(pose),
            _ => self.global_in::<3>(pose),
        })
    }

    fn global_in<const D: usize>(&self, pose: Pose<'_>) -> (Vec<f64>, f64, Vec<f64>) {
        let (p, q) = (self.entered::<D>(&self.p), self.entered(pose.q));
        let mls = self.mls(&p, &q, pose.orientations);
        let Global { rotation, scale, linear } = mls.global();
        (rotation.as_flattened().to_vec(), *scale, linear.as_flattened().to_vec())
    }

    /// Points of the world in the frame.
    fn entered<const D: usize>(&self, points: &[f64]) -> Vec<[f64; D]> {
        points.chunks_exact(D).map(|point| self.frame.enter(point)).collect()
    }

    /// The map of control points in the frame.
    fn mls<'a, const D: usize>(
        &self,
        p: &'a [[f64; D]],
        q: &'a [[f64; D]],
        orientations: Option<&[f64]>,
    ) -> Mls<'a, D> {
        let oriented = orientations.map_or_else(Vec::new, |given| oriented(given, p));
        Mls::with_oriented(p, q, oriented, self.transform).undecided(self.undecided)
    }

    fn deform_in<const D: usize>(
        &self,
        pose: Pose<'_>,
        temperature: f64,
        y: &mut [f64],
        maps: Option<&mut [f64]>,
        progress: &mut Progress<'_>,
    ) -> Result<(), Error> {
        let (p, q) = (self.entered::<D>(&self.p), self.entered::<D>(pose.q));
        let mls = self.mls(&p, &q, pose.orientations);
        let batch = match mls.batch(self.frame) {
            Some(batch) => Some((batch, self.weights(temperature)?)),
            None => None,
        };
        let motion = Motion { x: &self.x, logits: &self.logits, frame: self.frame, temperature, mls, batch };
        let mut maps = maps.unwrap_or_default();
        for (chunk, y) in y.chunks_mut(CHUNK * D).enumerate() {
            let (first, count) = (CHUNK * chunk, y.len() / D);
            report(progress, first as f64 / self.len() as f64)?;
            let blocks = y.chunks_mut(BLOCK * D);
            if maps.is_empty() {
                for_each_at_once(blocks, |block, y| motion.block(first + BLOCK * block, y, &mut []));
            } else {
                let (now, later) = maps.split_at_mut(count * D * D);
                maps = later;
                for_each_at_once(blocks.zip(now.chunks_mut(BLOCK * D * D)), |block, (y, maps)| {
                    motion.block(first + BLOCK * block, y, maps);
                });
            }
        }
        Ok(())
    }

    /// Computes the weights at `temperature` now, so that the first frame at it takes no longer than the next ones. (In 1D and 2D
    /// nothing is kept between frames.)
    ///
    /// # Errors
    /// Where the temperature is not above 0; [`Error::Memory`].
    pub fn prepare(&self, temperature: f64) -> Result<(), Error> {
        check_temperature(temperature)?;
        if self.dim == 3 {
            self.weights(temperature)?;
        }
        Ok(())
    }

    /// The packed weights at `temperature`: those of the last frame, or new ones in their place.
    fn weights(&self, temperature: f64) -> Result<Arc<PackedWeights>, Error> {
        // Not locked while they are computed: this thread may meanwhile take up another frame of the same deformer.
        let last = match briefly(&self.last) {
            Some(mut last) => match &*last {
                Some(weights) if weights.temperature() == temperature => return Ok(weights.clone()),
                _ => last.take(),
            },
            None => None,
        };
        let memory = last.and_then(|last| Arc::try_unwrap(last).ok());
        let m = self.p.len() / self.dim;
        let weights = Arc::new(PackedWeights::new(&self.logits, m, temperature, memory)?);
        if let Some(mut last) = briefly(&self.last) {
            *last = Some(weights.clone());
        }
        Ok(weights)
    }
}

/// Checks that a pose fits the control points `p` (m x dim); gives whether it leaves everything where it is.
///
/// # Errors
/// Where it does not fit, is not finite, or an orientation is none.
pub(crate) fn unmoved(p: &[f64], dim: usize, pose: Pose<'_>) -> Result<bool, Error> {
    let Pose { q, orientations } = pose;
    check_points("q", q, dim)?;
    if q.len() != p.len() {
        let (found, expected) = (q.len() / dim, p.len() / dim);
        return Err(Error::argument("q", format!("expected {expected} targets, found {found}")));
    }
    let check = |given| check_orientations(given, q.len() / dim, dim);
    Ok(orientations.map_or(Ok(true), check)? && q == p)
}

/// One frame: what is the same for all of its points.
struct Motion<'a, const D: usize> {
    x: &'a [f64],
    logits: &'a [f32],
    frame: Frame,
    temperature: f64,
    mls: Mls<'a, D>,
    /// The kernel that takes many points at a time, where there is one, and its weights.
    batch: Option<(BatchMls, Arc<PackedWeights>)>,
}

impl<const D: usize> Motion<'_, D> {
    /// Moves the points from `first` (a multiple of [`BLOCK`]) on into `y`; their maps into `maps` unless it is empty.
    fn block(&self, first: usize, y: &mut [f64], maps: &mut [f64]) {
        let n = y.len() / D;
        let Some((batch, weights)) = &self.batch else {
            return self.one_by_one(first, 0..n, y, maps);
        };
        let (mut scratch, mut unsound) = (Scratch::new(), Vec::new());
        for at in (0..n).step_by(BATCH) {
            let end = n.min(at + BATCH);
            let next = end..n.min(end + BATCH);
            if !next.is_empty() {
                prefetch(&self.x[(first + next.start) * D..(first + next.end) * D]);
                prefetch(&y[next.start * D..next.end * D]);
            }
            let x = &self.x[(first + at) * D..(first + end) * D];
            let maps = if maps.is_empty() { &mut [] } else { &mut maps[at * D * D..end * D * D] };
            let points = BatchPoints { x, y: &mut y[at * D..end * D], maps };
            batch.deform(weights.blocks(first + at), points, &mut scratch);
            unsound.extend(scratch.unsound(end - at).map(|lane| at + lane));
        }
        self.one_by_one(first, unsound.into_iter(), y, maps);
    }

    /// The twin of the kernel: each point by itself, from its logits.
    fn one_by_one(&self, first: usize, which: impl Iterator<Item = usize>, y: &mut [f64], maps: &mut [f64]) {
        let m = self.logits.len() / (self.x.len() / D);
        let mut relative = vec![0.0; m];
        for i in which {
            let index = first + i;
            let logits = &self.logits[m * index..m * (index + 1)];
            let dominant = relative_weights(logits, self.temperature, &mut relative);
            let x = &self.x[D * index..D * (index + 1)];
            let local = self.mls.deform(&self.frame.enter(x), &relative, dominant);
            for (k, d) in local.displacement.into_iter().enumerate() {
                y[D * i + k] = x[k] + self.frame.half * d;
            }
            if !maps.is_empty() {
                maps[D * D * i..D * D * (i + 1)].copy_from_slice(local.map.as_flattened());
            }
        }
    }
}

#[cfg(test)]
mod tests;
