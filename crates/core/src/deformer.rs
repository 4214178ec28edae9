//! The pipeline: logits -> softmax(T) -> MLS, for points that are bound once and deformed many times.

use crate::error::{check_points, Error};
use crate::frame::Frame;
use crate::mls::{Handles, Transform};
use crate::parallel::{for_each_block, for_each_block_pair};
use crate::progress::{report, Progress};
use crate::softmax::{check_temperature, relative_weights};

/// Points between two reports of progress.
const CHUNK: usize = 1 << 16;
/// Points that one thread takes at a time.
const BLOCK: usize = 256;

/// Points bound to the logits that a weight function gave for them. Dragging changes the targets alone.
///
/// ```
/// use neuralmls_core::{Deformer, Frame, InverseDistance, Transform};
/// let (x, p) = ([0.0, 1.0, 2.0], [0.0, 2.0]);
/// let weights = InverseDistance::new(&p, 1, Frame::IDENTITY, 1.0, 0.0).unwrap();
/// let logits = weights.logits(&x, &mut |_| true).unwrap();
/// let deformer = Deformer::new(x.to_vec(), 1, &p, logits, Transform::Rigid).unwrap();
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
}

/// The result of [`Deformer::deform`].
pub struct Deformed {
    /// `y`, as the points were given.
    pub positions: Vec<f64>,
    /// The local maps `M`, row-major, where they were asked for.
    pub maps: Option<Vec<f64>>,
}

impl Deformer {
    /// Binds the points `x` (n x dim) to the control points `p` (m x dim) by `logits` (n x m).
    ///
    /// # Errors
    /// Where a size does not fit another, a coordinate is not finite, or a logit is NaN.
    pub fn new(
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
        if let Some(at) = logits.iter().position(|l| l.is_nan()) {
            return Err(Error::argument("logits", format!("the one at ({}, {}) is NaN", at / m, at % m)));
        }
        let frame = Frame::around(&x, dim);
        Ok(Deformer { dim, frame, x, p: p.to_vec(), logits, transform })
    }

    /// Points, n.
    pub fn len(&self) -> usize {
        self.x.len() / self.dim
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Where the points go when the control points go to `q` (m x dim), with the weights at `temperature` > 0; with the local maps
    /// if `maps`. If every target is its control point, the positions are the input bit for bit.
    ///
    /// # Errors
    /// [`Error::Cancelled`]; where `q` does not fit, is not finite, or the temperature is not above 0.
    pub fn deform(
        &self,
        q: &[f64],
        temperature: f64,
        maps: bool,
        progress: &mut Progress<'_>,
    ) -> Result<Deformed, Error> {
        check_points("q", q, self.dim)?;
        check_temperature(temperature)?;
        if q.len() != self.p.len() {
            let (found, expected) = (q.len() / self.dim, self.p.len() / self.dim);
            return Err(Error::argument("q", format!("expected {expected} targets, found {found}")));
        }
        let mut deformed =
            Deformed { positions: self.x.clone(), maps: maps.then(|| vec![0.0; self.x.len() * self.dim]) };
        match self.dim {
            1 => self.deform_in::<1>(q, temperature, &mut deformed, progress)?,
            2 => self.deform_in::<2>(q, temperature, &mut deformed, progress)?,
            _ => self.deform_in::<3>(q, temperature, &mut deformed, progress)?,
        }
        Ok(deformed)
    }

    fn deform_in<const D: usize>(
        &self,
        q: &[f64],
        temperature: f64,
        deformed: &mut Deformed,
        progress: &mut Progress<'_>,
    ) -> Result<(), Error> {
        let enter = |points: &[f64]| -> Vec<[f64; D]> {
            points.chunks_exact(D).map(|point| self.frame.enter(point)).collect()
        };
        let (p, handles_q) = (enter(&self.p), enter(q));
        let handles = Handles::new(&p, &handles_q, self.transform);
        let unmoved = q == self.p;
        let m = p.len();
        let one = |index: usize, relative: &mut [f64], y: &mut [f64], map: Option<&mut [f64]>| {
            let dominant = relative_weights(&self.logits[m * index..m * (index + 1)], temperature, relative);
            let x = self.frame.enter(y);
            let local = handles.deform(&x, relative, dominant);
            if !unmoved {
                for (y, d) in y.iter_mut().zip(local.displacement) {
                    *y += self.frame.half * d;
                }
            }
            if let Some(map) = map {
                map.copy_from_slice(local.map.as_flattened());
            }
        };
        let chunks = self.len().div_ceil(CHUNK).max(1);
        for (chunk, y) in deformed.positions.chunks_mut(CHUNK * D).enumerate() {
            report(progress, chunk as f64 / chunks as f64)?;
            let first = |block: usize| CHUNK * chunk + BLOCK * block;
            match &mut deformed.maps {
                None => for_each_block(y, BLOCK * D, |block, y| {
                    let mut relative = vec![0.0; m];
                    for (i, y) in y.chunks_exact_mut(D).enumerate() {
                        one(first(block) + i, &mut relative, y, None);
                    }
                }),
                Some(maps) => {
                    let maps = &mut maps[CHUNK * chunk * D * D..][..y.len() * D];
                    for_each_block_pair(y, BLOCK * D, maps, BLOCK * D * D, |block, y, maps| {
                        let mut relative = vec![0.0; m];
                        for (i, (y, map)) in
                            y.chunks_exact_mut(D).zip(maps.chunks_exact_mut(D * D)).enumerate()
                        {
                            one(first(block) + i, &mut relative, y, Some(map));
                        }
                    });
                }
            }
        }
        report(progress, 1.0)
    }
}

#[cfg(test)]
mod tests;
