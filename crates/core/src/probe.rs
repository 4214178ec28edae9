//! A deformation looked at in places (sample points) all over a shape.
//!
//! By its true Jacobian `J` there (central differences; the local map `M` leaves out how the weights change).

use crate::aim::{greatest, Handles};
use crate::check::check_points;
use crate::compose::Composed;
use crate::deformer::{Deformer, Pose};
use crate::error::Error;
use crate::geometry::placement::sample_surface;
use crate::mls::Transform;
use crate::relax::Elastic;
use crate::softmax;
use crate::weights::Weights;
use std::sync::Arc;

/// So many places are looked at on a shape.
pub const PLACES: usize = 4000;
/// Differences are over this part of the longest side, both ways, so that a band too narrow for places to lie in is seen from its sides.
const STEP: f64 = 2.5e-3;
/// Everything moves as one if the Jacobians differ by no more.
const ALIKE: f64 = 1e-6;

/// Places on a shape, bound to the weights of control points.
pub struct Probe {
    dim: usize,
    side: f64,
    p: Vec<f64>,
    places: Vec<f64>,
    /// The places, then for each axis those up and those down of them.
    all: Deformer,
    handles: Handles,
    careful: bool,
    transform: Transform,
    /// An elastic shape, and how far places go with it.
    elastic: Option<(Arc<Elastic>, f64)>,
    composed: Option<Arc<Composed>>,
}

/// What a deformation does at the places.
#[derive(Clone, Debug)]
pub struct Look {
    /// Where they go, k x dim.
    pub positions: Vec<f64>,
    /// `det J`.
    pub determinants: Vec<f64>,
    /// The greatest stretch at each place, in that of most places if that is above 1.
    pub stretches: Vec<f64>,
    /// Whether everything moves as one.
    pub alike: bool,
}

/// `count` places of a shape to look at (k x dim): of the surface by area, or points of the cloud `x`.
///
/// # Errors
/// Where there are no finite points, or a face names none.
pub fn places(x: &[f64], dim: usize, faces: &[[u32; 3]], count: usize) -> Result<Vec<f64>, Error> {
    let places = sample_surface(x, dim, faces, count, 0)?;
    if !places.is_empty() {
        return Ok(places);
    }
    let every = (x.len() / dim).div_ceil(count);
    Ok(x.chunks_exact(dim).step_by(every).flatten().copied().collect())
}

/// The places (k x dim) and those beside them, where the weights have to be known; `side` is the shape's longest.
pub(crate) fn with_those_beside(places: &[f64], dim: usize, side: f64) -> Vec<f64> {
    let mut points = places.to_vec();
    for axis in 0..dim {
        for way in [1.0, -1.0] {
            let from = points.len();
            points.extend_from_slice(places);
            points[from..].iter_mut().skip(axis).step_by(dim).for_each(|c| *c += way * STEP * side);
        }
    }
    points
}

/// `J` at places, from where those beside them (2 dim times as many) go.
fn jacobians(beside: &[f64], dim: usize, side: f64) -> Vec<[[f64; 3]; 3]> {
    let size = beside.len() / (2 * dim);
    let sides: Vec<&[f64]> = beside.chunks_exact(size).collect();
    let jacobian = |place: usize| -> [[f64; 3]; 3] {
        let mut j = [[0.0; 3]; 3];
        for axis in 0..dim {
            let (up, down) = (&sides[2 * axis][dim * place..], &sides[2 * axis + 1][dim * place..]);
            for row in 0..dim {
                j[row][axis] = (up[row] - down[row]) / (2.0 * STEP * side);
            }
        }
        j
    };
    (0..size / dim).map(jacobian).collect()
}

/// `det J` there.
pub(crate) fn determinants(beside: &[f64], dim: usize, side: f64) -> Vec<f64> {
    jacobians(beside, dim, side).iter().map(|j| determinant(j, dim)).collect()
}

impl Probe {
    /// Binds `places` (k x dim) of a shape, whose longest side is `side`, to the control points of `weights`, which are taken to their targets as
    /// [`Handles::aim_carefully`] does if `careful`, else as [`Handles::aim`] does.
    ///
    /// # Errors
    /// Where there is no place, or as [`Deformer::new`].
    pub fn new(
        weights: &Weights,
        places: &[f64],
        side: f64,
        transform: Transform,
        careful: bool,
    ) -> Result<Probe, Error> {
        let (p, dim) = (weights.control_points(), weights.dim());
        if check_points("places", places, dim)? == 0 {
            return Err(Error::argument("places", "expected at least one, found none"));
        }
        let all = with_those_beside(places, dim, side);
        let logits = weights.logits(&all, &mut |_| true)?;
        Ok(Probe {
            dim,
            side,
            p: p.to_vec(),
            places: places.to_vec(),
            all: Deformer::of_logits(all, dim, p, logits, transform)?,
            handles: Handles::new(weights, transform)?,
            careful,
            transform,
            elastic: None,
            composed: None,
        })
    }

    /// The same, of places that go with an elastic shape too: [`Probe::set_relax`] says how far, and at first it is not at all.
    ///
    /// # Errors
    /// [`Error::Memory`].
    pub fn with(self, elastic: Arc<Elastic>) -> Result<Probe, Error> {
        Ok(Probe { all: self.all.lifted(&elastic)?, elastic: Some((elastic, 0.0)), ..self })
    }

    /// Lets places go the part `amount` (0 to 1) of the way to where the elastic shape takes them, if there is one.
    pub fn set_relax(&mut self, amount: f64) {
        if let Some((_, relax)) = &mut self.elastic {
            *relax = amount;
        }
    }

    /// Lets places go the way of these steps, the first of them of the same weights, whatever the pose; or of one step.
    pub fn set_composed(&mut self, composed: Option<Arc<Composed>>) {
        self.composed = composed;
    }

    /// Whether they go in steps.
    pub(crate) fn is_composed(&self) -> bool {
        self.composed.is_some()
    }

    /// The places, k x dim.
    pub fn places(&self) -> &[f64] {
        &self.places
    }

    /// The shape's longest side.
    pub fn side(&self) -> f64 {
        self.side
    }

    /// Takes control points to their targets as [`Handles::aim_carefully`] does, or as [`Handles::aim`] does.
    pub fn set_careful(&mut self, careful: bool) {
        self.careful = careful;
    }

    /// Lets the deformations that are looked at do something else to the shape locally.
    pub fn set_transform(&mut self, transform: Transform) {
        self.transform = transform;
        self.all.set_transform(transform);
        self.handles.set_transform(transform);
    }

    /// What the deformation does at the places.
    ///
    /// # Errors
    /// As [`Handles::aim`].
    pub fn look<'a>(
        &self,
        pose: impl Into<Pose<'a>>,
        temperature: f64,
        adherence: &[f64],
    ) -> Result<Look, Error> {
        let mut y = self.moved(pose.into(), temperature, adherence)?;
        let (dim, beside) = (self.dim, y.split_off(self.places.len()));
        let jacobians = jacobians(&beside, dim, self.side);
        let mut stretches: Vec<f64> = jacobians.iter().map(stretch).collect();
        let usual = median(&stretches).max(1.0);
        stretches.iter_mut().for_each(|stretch| *stretch /= usual);
        let differ = |row: usize, column: usize| {
            let entries = || jacobians.iter().map(|j| j[row][column]);
            entries().fold(f64::MIN, f64::max) - entries().fold(f64::MAX, f64::min)
        };
        Ok(Look {
            positions: y,
            determinants: jacobians.iter().map(|j| determinant(j, dim)).collect(),
            stretches,
            alike: (0..dim * dim).all(|at| differ(at / dim, at % dim) < ALIKE),
        })
    }

    /// Where the places and those beside them go.
    fn moved(&self, pose: Pose<'_>, temperature: f64, adherence: &[f64]) -> Result<Vec<f64>, Error> {
        if let Some(composed) = &self.composed {
            return Ok(composed.deform(&self.all, false, &mut |_| true)?.positions);
        }
        let aim = match self.careful {
            true => self.handles.aim_carefully(pose, temperature, adherence)?,
            false => self.handles.aim(pose, temperature, adherence)?,
        };
        let aimed = Pose { q: &aim.targets, ..pose };
        let mut y = self.all.deform(aimed, temperature, false, &mut |_| true)?.positions;
        if let Some((elastic, amount)) = self.elastic.as_ref().filter(|(_, amount)| *amount > 0.0) {
            if let Some(relaxed) = elastic.relax(aimed, temperature, self.transform)? {
                self.all.relax(&relaxed, *amount, &mut y, None)?;
            }
        }
        Ok(y)
    }

    /// How far each place is from the nearest control point, in the median distance of a control point to the next one, and which it is;
    /// 0 if there is but one.
    pub fn far(&self) -> Vec<(f64, usize)> {
        let p = || self.p.chunks_exact(self.dim);
        let apart: Vec<f64> = p()
            .enumerate()
            .map(|(i, a)| {
                p().enumerate()
                    .filter(|&(k, _)| k != i)
                    .map(|(_, b)| distance(a, b))
                    .fold(f64::INFINITY, f64::min)
            })
            .collect();
        let spacing = if apart.len() < 2 { f64::INFINITY } else { median(&apart) };
        self.places
            .chunks_exact(self.dim)
            .map(|place| {
                let (nearest, away) = greatest(p().map(|p| -distance(place, p)));
                (-away / spacing, nearest)
            })
            .collect()
    }

    /// The two control points with the most weight at a place; if there is but one, that.
    pub(crate) fn governing(&self, place: usize, temperature: f64) -> [usize; 2] {
        let m = self.p.len() / self.dim;
        let mut weights = vec![0.0; m];
        softmax::weights(&self.all.logits()[m * place..][..m], temperature, &mut weights);
        let first = greatest(weights.iter().copied()).0;
        let second = greatest(weights.iter().enumerate().map(|(i, w)| if i == first { -1.0 } else { *w })).0;
        [first, second]
    }
}

pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// The middle one; of an even number, the mean of the two in the middle.
fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let half = sorted.len() / 2;
    if sorted.len() % 2 == 1 {
        sorted[half]
    } else {
        (sorted[half - 1] + sorted[half]) / 2.0
    }
}

fn determinant(j: &[[f64; 3]; 3], dim: usize) -> f64 {
    match dim {
        1 => j[0][0],
        2 => j[0][0] * j[1][1] - j[0][1] * j[1][0],
        _ => (0..3)
            .map(|k| {
                let (a, b) = ((k + 1) % 3, (k + 2) % 3);
                j[0][k] * (j[1][a] * j[2][b] - j[1][b] * j[2][a])
            })
            .sum(),
    }
}

/// The greatest singular value: the root of the greatest eigenvalue of `J^T J`, in closed form (Smith, "Eigenvalues of a symmetric 3x3
/// matrix", 1961).
fn stretch(j: &[[f64; 3]; 3]) -> f64 {
    let a: [[f64; 3]; 3] =
        std::array::from_fn(|r| std::array::from_fn(|c| (0..3).map(|k| j[k][r] * j[k][c]).sum()));
    let mean = (a[0][0] + a[1][1] + a[2][2]) / 3.0;
    let shifted = |by: f64| -> [[f64; 3]; 3] {
        std::array::from_fn(|r| std::array::from_fn(|c| (a[r][c] - if r == c { mean } else { 0.0 }) / by))
    };
    let spread = (shifted(1.0).iter().flatten().map(|e| e * e).sum::<f64>() / 6.0).sqrt();
    if spread <= 1e-12 * mean {
        return mean.max(0.0).sqrt();
    }
    let cosine = (determinant(&shifted(spread), 3) / 2.0).clamp(-1.0, 1.0);
    (mean + 2.0 * spread * (cosine.acos() / 3.0).cos()).sqrt()
}

#[cfg(test)]
mod tests;
