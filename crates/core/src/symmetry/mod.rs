//! The planes by which a shape is its own mirror image.
//!
//! ```text
//! samples  2,000 places of the shape, to be mirrored, and 12,000 to be met; floor: how far such places are from each other anyway
//! planes   across many directions, through the centroid and the middle of the box; the best go on
//! refine   each is brought to where the mirrored places lie best on the shape
//! score    mean of how far mirrored places are from the nearest, in floors; matched: the share that is met
//! ```
//!
//! Thresholds: of 32 shapes those that look symmetric score at most 1.3, and the others (an armadillo, a bunny, a hand) 1.9 or more;
//! studies/symmetry.py repeats it on shapes that are turned and sampled anew. Planes as candidates, refined by matching: Podolak et al., "A
//! planar-reflective symmetry transform for 3D shapes", 2006; Mitra et al., "Partial and approximate symmetry detection", 2006.

mod mirror;
mod refine;
mod samples;
#[cfg(test)]
mod tests;

use crate::check::check_points;
use crate::error::Error;
use crate::geometry::Frame;
use crate::mls::eigen;
use crate::weights::shape_graph::Position;
pub(crate) use mirror::{dot, unit, Mirror};
use refine::{away, refined};
use samples::{moments, Samples};

/// Directions of candidates: across the grid points of a cube of so many to each side, in the plane of a square.
const GRID: i32 = 2;
const GRID_2D: i32 = 6;
/// Places by which candidates are compared, and how many go on; then again.
const FIRST: usize = 150;
const BEST: usize = 10;
const SECOND: usize = 500;
const REFINED: usize = 4;
/// What is missed counts at most so many floors (of the 90th percentile).
const MOST: f64 = 4.0;
/// Met is what is no farther than so many floors.
const MET: f64 = 1.5;
/// Cosine and distance (in halves of the longest side) within which two planes are one.
const SAME_TURN: f64 = 0.99;
const SAME_PLACE: f64 = 0.05;
/// Fewer points of a cloud say nothing.
const LEAST: usize = 8;
/// Scores that differ by less are as good.
const AS_GOOD: f64 = 0.1;

/// What is said of a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The shape is its own mirror image.
    Symmetric,
    /// Nearly, or in most of it: a person is to say.
    Asks,
    /// It is not.
    No,
}

impl Verdict {
    /// In a word.
    pub fn word(self) -> &'static str {
        match self {
            Verdict::Symmetric => "symmetric",
            Verdict::Asks => "nearly",
            Verdict::No => "no",
        }
    }

    fn of(score: f64, matched: f64) -> Verdict {
        if score <= 1.3 && matched >= 0.95 {
            Verdict::Symmetric
        } else if score <= 1.95 && matched >= 0.85 {
            Verdict::Asks
        } else {
            Verdict::No
        }
    }
}

/// `normal . x = offset`, in the coordinates of the points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Of length 1, its largest component positive; zeros beyond the dimension.
    pub normal: [f64; 3],
    /// Along the normal.
    pub offset: f64,
    /// How far mirrored places are from the shape, in what places of it are from each other: 1 is as good as can be.
    pub score: f64,
    /// The part of the shape that is met by what is mirrored.
    pub matched: f64,
    /// What follows from these.
    pub verdict: Verdict,
}

impl Plane {
    /// The mirror image of a point, `x - 2 (n . x - o) n`.
    pub fn image(&self, x: &[f64]) -> Vec<f64> {
        let height: f64 = x.iter().zip(&self.normal).map(|(x, n)| x * n).sum::<f64>() - self.offset;
        x.iter().zip(&self.normal).map(|(x, n)| x - 2.0 * height * n).collect()
    }
}

/// The planes by which the points `x` (n x dim) and the surface of `faces` (none for a cloud) may be symmetric, the best first; of those
/// that are as good, the one most across the first axis. A plane in which the shape itself lies is none.
///
/// # Errors
/// Where there are no finite points, or a face names none.
pub fn planes(x: &[f64], dim: usize, faces: &[[u32; 3]]) -> Result<Vec<Plane>, Error> {
    if check_points("positions", x, dim)? < LEAST.min(4 * dim) && faces.is_empty() {
        return Ok(Vec::new());
    }
    let frame = Frame::around(x, dim);
    let entered: Vec<Position> = x.chunks_exact(dim).map(|x| place(&frame, x)).collect();
    let samples = Samples::new(&entered, faces, dim)?;
    if samples.floor[0] <= 0.0 {
        return Ok(Vec::new());
    }
    let mut found: Vec<(Mirror, f64, f64)> = Vec::new();
    for mirror in chosen(&samples, dim) {
        let mirror = refined(&samples, mirror);
        if !found.iter().any(|(other, ..)| same(other, &mirror)) && !within(&samples, &mirror) {
            let (score, matched) = judged(&samples, &mirror);
            found.push((mirror, score, matched));
        }
    }
    found.sort_by(|a, b| a.1.total_cmp(&b.1));
    // Of the best that are as good, the one that a person would call left and right.
    let as_good = found.iter().take_while(|one| one.1 < found[0].1 + AS_GOOD).count();
    let across = |one: &(Mirror, f64, f64)| (1e3 * one.0.normal[0].abs()).round();
    found[..as_good].sort_by(|a, b| across(b).total_cmp(&across(a)));
    Ok(found.into_iter().map(|(mirror, score, matched)| of_world(&frame, &mirror, score, matched)).collect())
}

/// A point in halves of the longest side, with zeros beyond the dimension.
pub(crate) fn place(frame: &Frame, x: &[f64]) -> Position {
    std::array::from_fn(|k| x.get(k).map_or(0.0, |x| (x - frame.centre[k]) / frame.half))
}

fn of_world(frame: &Frame, mirror: &Mirror, score: f64, matched: f64) -> Plane {
    let n = mirror.normal;
    let most = (1..3).fold(0, |most, k| if n[k].abs() > n[most].abs() + 1e-9 { k } else { most });
    let normal = n.map(|c| n[most].signum() * c + 0.0);
    let offset = dot(&normal, &frame.centre) + frame.half * n[most].signum() * mirror.offset;
    Plane { normal, offset, score, matched, verdict: Verdict::of(score, matched) }
}

/// The candidates that go on.
fn chosen(samples: &Samples, dim: usize) -> Vec<Mirror> {
    let middle = Frame::around(samples.mirrored.as_flattened(), 3).centre;
    let (mean, moments) = moments(&samples.mirrored);
    let (_, vectors) = eigen(moments);
    let principal = (0..3).map(|i| std::array::from_fn(|k| vectors[k][i]));
    let mut candidates = Vec::new();
    for normal in principal.chain(directions(dim)) {
        let normal: Position = std::array::from_fn(|k| if k < dim { normal[k] } else { 0.0 });
        if dot(&normal, &normal) > 0.5 {
            let normal = unit(normal);
            candidates
                .extend([mean, middle].map(|through| Mirror { normal, offset: dot(&normal, &through) }));
        }
    }
    let price = |mirror: &Mirror, count: usize| -> f64 {
        away(samples, mirror, count, MOST * samples.floor[1]).into_iter().sum()
    };
    let mut best = cheapest(candidates, |mirror| price(mirror, FIRST));
    best.truncate(BEST);
    let best = cheapest(best, |mirror| price(mirror, SECOND));
    best.into_iter().take(REFINED).collect()
}

/// In the order of their prices, each plane once.
fn cheapest(candidates: Vec<Mirror>, price: impl Fn(&Mirror) -> f64) -> Vec<Mirror> {
    let mut priced: Vec<(f64, Mirror)> =
        candidates.into_iter().map(|mirror| (price(&mirror), mirror)).collect();
    priced.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut kept: Vec<Mirror> = Vec::new();
    for (_, mirror) in priced {
        if !kept.iter().any(|other| same(other, &mirror)) {
            kept.push(mirror);
        }
    }
    kept
}

/// Half of the directions to the points of a grid, each once.
fn directions(dim: usize) -> Vec<Position> {
    let reach = |axis: usize| match dim {
        _ if axis >= dim => 0..=0,
        1 => 1..=1,
        2 => -GRID_2D..=GRID_2D,
        _ => -GRID..=GRID,
    };
    let mut found = Vec::new();
    for i in reach(0) {
        for j in reach(1) {
            for k in reach(2) {
                let shortest = (2..=GRID_2D).all(|by| [i, j, k].iter().any(|c| c % by != 0));
                if (i, j, k) > (0, 0, 0) && shortest {
                    found.push(unit([i, j, k].map(f64::from)));
                }
            }
        }
    }
    found
}

fn same(a: &Mirror, b: &Mirror) -> bool {
    let turn = dot(&a.normal, &b.normal);
    turn.abs() > SAME_TURN && (a.offset - turn.signum() * b.offset).abs() < SAME_PLACE
}

/// Whether the shape lies in the plane: mirroring it changes nothing.
fn within(samples: &Samples, mirror: &Mirror) -> bool {
    let off: f64 = samples.mirrored.iter().map(|x| mirror.height(x).abs()).sum();
    off < samples.floor[0] * samples.mirrored.len() as f64
}

/// Score, and the part that is matched.
fn judged(samples: &Samples, mirror: &Mirror) -> (f64, f64) {
    let [floor, high] = samples.floor;
    let away = away(samples, mirror, samples.mirrored.len(), MOST * high);
    let count = away.len() as f64;
    let matched = away.iter().filter(|away| **away <= MET * high).count() as f64;
    (away.into_iter().sum::<f64>() / floor / count, matched / count)
}
