//! Newton's method for many points at once: each by itself, but the network is asked about all of them together.

use super::field::{Field, Place};
use crate::error::Error;
use crate::machine::memory::zeros;
use crate::machine::parallel::for_each_block;
use crate::machine::progress::{report, Progress};
use crate::mls::matrix::{identity, transposed, Matrix};
use crate::weights::shape_graph::Near;
use crate::weights::Weights;

/// Samples of the map along each axis, in 1D, 2D and 3D.
const SAMPLES: [usize; 3] = [257, 65, 17];
/// How far they reach, in parts of the frame: what is around a shape moves too.
const REACH: f64 = 1.25;
/// Samples that are tried for a point, one after the other.
const STARTS: usize = 6;
/// Evaluations from one sample: full steps need 3 to 5, and each halving is one.
const ROUNDS: usize = 25;
/// The least part of a step.
const LEAST: f64 = 1.0 / 256.0;
/// How far a point is still from its place when the last step is taken, in halves of the frame. What that leaves is about the square of it.
const CLOSE: f64 = 1e-7;
/// The same of a network, whose logits are in single precision: what they round moves places by about 1e-7.
const CLOSE_SINGLE: f64 = 5e-7;
/// What counts as arrived where no step comes nearer; of a network.
const ARRIVED: f64 = 1e-9;
const ARRIVED_SINGLE: f64 = 2e-6;
/// Rounding of a coordinate, in parts of [`ARRIVED`] of itself.
const ROUNDED: f64 = 4.0 * f64::EPSILON / ARRIVED;

/// Samples of the map, by where they go.
pub(super) struct Starts<const D: usize> {
    samples: Vec<([f64; D], Place<D>)>,
    near: Near,
}

impl<const D: usize> Starts<D> {
    pub(super) fn new(field: &Field<'_, D>) -> Result<Starts<D>, Error> {
        let (frame, count) = (field.frame, SAMPLES[D - 1]);
        let mut x = field.weights.control_points().to_vec();
        for at in 0..count.pow(D as u32) {
            for k in 0..D {
                let step = at / count.pow(k as u32) % count;
                let part = 2.0 * step as f64 / (count - 1) as f64 - 1.0;
                x.push(frame.centre[k] + REACH * frame.half * part);
            }
        }
        let mut places = vec![None; x.len() / D];
        field.visit(&x, &mut places, 1, &mut |_| true, |place, out| out[0] = Some(place))?;
        let places = x.chunks_exact(D).zip(places).filter_map(|(x, place)| {
            let x = std::array::from_fn(|k| x[k]);
            place.filter(|place| determinant(&place.jacobian) > 0.0).map(|place| (x, place))
        });
        let samples: Vec<_> = places.collect();
        let near: Vec<_> = samples.iter().map(|(_, place)| position(field, &place.y)).collect();
        Ok(Starts { near: Near::new(&near), samples })
    }

    /// Those that go nearest to a place.
    fn nearest(&self, field: &Field<'_, D>, y: &[f64; D], count: usize, found: &mut Vec<(f64, u32)>) {
        self.near.nearest(&position(field, y), count, f64::INFINITY, |_| true, found);
    }
}

fn position<const D: usize>(field: &Field<'_, D>, y: &[f64; D]) -> [f64; 3] {
    let at: [f64; D] = field.frame.enter(y);
    std::array::from_fn(|k| if k < D { at[k] } else { 0.0 })
}

/// A point on its way back.
pub(super) struct Seek<const D: usize> {
    target: [f64; D],
    /// Where it is.
    pub x: [f64; D],
    pub map: Matrix<D>,
    pub found: bool,
    /// Whether `det J > 0` where it is, `|f(x) - y|`, and the step from x.
    upright: bool,
    left: f64,
    step: [f64; D],
    /// The part of the step that is tried.
    part: f64,
    rounds: usize,
    start: usize,
    /// The place that came nearest of those from which no step led on, and how near.
    best: Option<(f64, [f64; D])>,
    done: bool,
}

/// Finds from where each of the points `y` came.
pub(super) fn seek<const D: usize>(
    field: &Field<'_, D>,
    starts: &Starts<D>,
    y: &[f64],
    seeks: &mut Vec<Seek<D>>,
    progress: &mut Progress<'_>,
) -> Result<(), Error> {
    let (close, arrived) = match field.weights {
        Weights::InverseDistance(_) => (CLOSE, ARRIVED),
        _ => (CLOSE_SINGLE, ARRIVED_SINGLE),
    };
    let rule = Rule { field, starts, close, arrived };
    seeks.extend(y.chunks_exact(D).map(|y| {
        let target = std::array::from_fn(|k| y[k]);
        Seek {
            target,
            x: target,
            map: [[0.0; D]; D],
            found: false,
            upright: false,
            left: f64::INFINITY,
            step: [0.0; D],
            part: 1.0,
            rounds: 0,
            start: 0,
            best: None,
            done: false,
        }
    }));
    for_each_block(seeks, 256, |_, seeks| seeks.iter_mut().for_each(|seek| rule.begin(seek)));
    let mut open: Vec<&mut Seek<D>> = seeks.iter_mut().filter(|seek| !seek.done).collect();
    let all = open.len().max(1) as f64;
    while !open.is_empty() {
        report(progress, 1.0 - open.len() as f64 / all)?;
        let mut x = zeros(D * open.len())?;
        for (x, seek) in x.chunks_exact_mut(D).zip(&open) {
            x.copy_from_slice(&seek.trial());
        }
        field.visit(&x, &mut open, 1, &mut |_| true, |place, seek| rule.judge(seek[0], &place))?;
        open.retain(|seek| !seek.done);
    }
    Ok(())
}

impl<const D: usize> Seek<D> {
    /// Where it is looked next.
    fn trial(&self) -> [f64; D] {
        std::array::from_fn(|k| self.x[k] - self.part * self.step[k])
    }
}

struct Rule<'a, const D: usize> {
    field: &'a Field<'a, D>,
    starts: &'a Starts<D>,
    close: f64,
    arrived: f64,
}

impl<const D: usize> Rule<'_, D> {
    /// Sets a point to the next sample; it is done where there is none any more.
    fn begin(&self, seek: &mut Seek<D>) {
        let mut found = Vec::new();
        self.starts.nearest(self.field, &seek.target, seek.start + 1, &mut found);
        if seek.start >= STARTS.min(found.len()) {
            seek.done = true;
            seek.x = seek.best.map_or(seek.target, |(_, x)| x);
            return;
        }
        let (x, place) = &self.starts.samples[found[seek.start].1 as usize];
        seek.start += 1;
        (seek.left, seek.rounds) = (f64::INFINITY, 0);
        self.arrive(seek, x, place);
    }

    /// The place of the trial was looked at.
    fn judge(&self, seek: &mut Seek<D>, place: &Place<D>) {
        seek.rounds += 1;
        let left = distance(&place.y, &seek.target);
        if left < (1.0 - 1e-4 * seek.part) * seek.left {
            let x = seek.trial();
            return self.arrive(seek, &x, place);
        }
        seek.part *= 0.5;
        if seek.part < LEAST || seek.rounds >= ROUNDS {
            self.give_up(seek);
        }
    }

    /// It is at x now.
    fn arrive(&self, seek: &mut Seek<D>, x: &[f64; D], place: &Place<D>) {
        let away: [f64; D] = std::array::from_fn(|k| place.y[k] - seek.target[k]);
        (seek.x, seek.map, seek.part) = (*x, place.map, 1.0);
        seek.left = distance(&place.y, &seek.target);
        seek.step = solved(&place.jacobian, &away);
        seek.upright = determinant(&place.jacobian) > 0.0;
        let (known, close) =
            (seek.step.iter().all(|s| s.is_finite()), seek.left <= self.close * self.unit(seek));
        if known && close && seek.upright {
            seek.x = seek.trial();
            (seek.found, seek.done) = (true, true);
        } else if !known || close || seek.rounds >= ROUNDS {
            self.give_up(seek);
        }
    }

    /// No step leads on from where it is.
    fn give_up(&self, seek: &mut Seek<D>) {
        if seek.upright && seek.left <= self.arrived * self.unit(seek) {
            (seek.found, seek.done) = (true, true);
            return;
        }
        if seek.best.is_none_or(|(left, _)| seek.left < left) {
            seek.best = Some((seek.left, seek.x));
        }
        self.begin(seek);
    }

    /// Half of the frame; more where it is so far from the origin, or from the point, that coordinates round to more than that.
    fn unit(&self, seek: &Seek<D>) -> f64 {
        let largest = seek.target.iter().chain(&seek.x).fold(0.0f64, |most, c| most.max(c.abs()));
        self.field.frame.half + ROUNDED * largest
    }
}

fn distance<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

fn determinant<const D: usize>(m: &Matrix<D>) -> f64 {
    match D {
        1 => m[0][0],
        2 => m[0][0] * m[1][1] - m[0][1] * m[1][0],
        _ => (0..3).map(|k| m[0][k] * cofactor(m, 0, k)).sum(),
    }
}

/// That of an entry, in 3D.
fn cofactor<const D: usize>(m: &Matrix<D>, row: usize, column: usize) -> f64 {
    let ([i, j], [k, l]) = ([(row + 1) % 3, (row + 2) % 3], [(column + 1) % 3, (column + 2) % 3]);
    m[i][k] * m[j][l] - m[i][l] * m[j][k]
}

/// `m^-1 b`; not finite where there is none.
fn solved<const D: usize>(m: &Matrix<D>, b: &[f64; D]) -> [f64; D] {
    let by = determinant(m);
    std::array::from_fn(|r| match D {
        1 => b[0] / by,
        2 if r == 0 => (m[1][1] * b[0] - m[0][1] * b[1]) / by,
        2 => (m[0][0] * b[1] - m[1][0] * b[0]) / by,
        _ => (0..3).map(|c| cofactor(m, c, r) * b[c]).sum::<f64>() / by,
    })
}

/// `m^-1`; the identity where there is none.
pub(super) fn inverted<const D: usize>(m: &Matrix<D>) -> Matrix<D> {
    let unit: Matrix<D> = identity();
    let columns = unit.map(|column| solved(m, &column));
    if columns.as_flattened().iter().all(|e| e.is_finite()) {
        transposed(&columns)
    } else {
        unit
    }
}
