//! Control points where a person would put them: at the ends of a shape, and in the middles of its parts.
//!
//! ```text
//! along        ~600 places of the shape, and how far they are from each other along it
//! hidden       which of them are seen from outside: only these count
//! extremities  feet, wing tips: there the mean distance to all the rest is greatest; at most two thirds of the control points
//! medoids      the others, so that the way along the shape from anywhere to the nearest is short in the mean
//! folded       the same on half of a shape, for control points in exact pairs
//! ```
//!
//! What differs from [`placement::farthest_points`]: distances are along the shape, and a control point is in the middle of what it is to move.
//! studies/placement.py has what this is worth on true poses.

mod along;
mod board;
mod extremities;
mod folded;
mod hidden;
mod medoids;
mod snap;
#[cfg(test)]
mod tests;

use crate::error::Error;
use crate::geometry::{placement, Frame};
use crate::machine::progress::{report, Progress};
use crate::machine::random::Random;
use crate::symmetry::{self, Mirror, Plane, Verdict};
use crate::weights::shape_graph::{check_shape, largest_piece, Position, Shape};
use along::Along;
use board::Board;
use extremities::extremities;
use folded::folded;
use medoids::{medoids, Choice, Kind};
use snap::{snap, Snapped};

/// More are spread by [`placement::farthest_points`]: their spacing is then that of the places there are.
pub const MOST: usize = 128;
/// The largest piece of a shape that is one, whatever else is on it, has at least this part of the surface.
const ONE_PIECE: f64 = 0.75;
/// Of `auto`: the fewest and the most.
const AUTO: std::ops::RangeInclusive<usize> = 6..=32;
/// `auto` stops where one more would lower the mean distance by less than this part of it, in the mean of the next two.
const LITTLE: f64 = 0.04;

/// How many control points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Count {
    /// So many.
    Of(usize),
    /// As many as make much of a difference.
    Auto,
}

/// What is wished of control points.
#[derive(Clone, Copy, Debug)]
pub struct Wish {
    /// How many.
    pub count: Count,
    /// In exact pairs, by the shape's plane of symmetry.
    pub symmetric: bool,
    /// Of what is drawn at random.
    pub seed: u64,
}

/// Control points for a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    /// Where, count x dim: the ends of the shape first; of pairs, the one on the positive side of the plane just before the other.
    pub points: Vec<f64>,
    /// Whose mirror image each is: of the second of each pair, the number of the first.
    pub mirror_of: Vec<Option<usize>>,
    /// By which plane.
    pub plane: Option<Plane>,
    /// Of `auto`: for each number of control points the mean distance along the shape to the nearest, in parts of the longest side.
    pub curve: Vec<(usize, f64)>,
}

/// Control points for the points `x` (n x dim) and the surface of `faces` (none for a cloud).
///
/// # Errors
/// As [`placement::farthest_points`]; where pairs are wished of a shape that is not symmetric; [`Error::Cancelled`].
pub fn place(
    x: &[f64],
    dim: usize,
    faces: &[[u32; 3]],
    wish: &Wish,
    progress: &mut Progress<'_>,
) -> Result<Placed, Error> {
    check_shape(Shape { x, faces }, dim)?;
    report(progress, 0.0)?;
    let plane = if wish.symmetric { Some(plane_of(x, dim, faces)?) } else { None };
    report(progress, 0.2)?;
    if let Count::Of(count) = wish.count {
        if !(1..=MOST).contains(&count) && plane.is_none() {
            let points = placement::farthest_points(x, dim, faces, count, wish.seed, progress)?;
            return Ok(Placed {
                mirror_of: vec![None; points.len() / dim],
                points,
                plane,
                curve: Vec::new(),
            });
        }
    }
    let frame = Frame::around(x, dim);
    let entered: Vec<Position> = x.chunks_exact(dim).map(|x| symmetry::place(&frame, x)).collect();
    let along = Along::new(
        &entered,
        faces,
        match wish.count {
            Count::Of(count) => count,
            Count::Auto => *AUTO.end(),
        },
    );
    report(progress, 0.6)?;
    let seen = hidden::seen(&entered, faces, &along.nodes, dim);
    let of_parts = largest_piece(&entered, faces) < ONE_PIECE;
    let choosing = Choosing {
        board: Board { along: &along, seen: &seen, of_parts },
        mirror: plane.map(|plane| entered_plane(&frame, &plane)),
        seed: wish.seed,
    };
    report(progress, 0.8)?;
    let mut curve = Vec::new();
    let count = match wish.count {
        Count::Of(count) => count,
        Count::Auto => choosing.enough(&mut curve),
    };
    let Some((chosen, _)) = choosing.chosen(count) else {
        let points = placement::farthest_points(x, dim, faces, count, wish.seed, progress)?;
        return Ok(Placed { mirror_of: vec![None; points.len() / dim], points, plane, curve });
    };
    let shape = OfShape { x, dim, faces, entered: &entered, frame: &frame, along: &along };
    Ok(shape.placed(&chosen, plane, curve))
}

fn plane_of(x: &[f64], dim: usize, faces: &[[u32; 3]]) -> Result<Plane, Error> {
    let found = symmetry::planes(x, dim, faces)?;
    match found.into_iter().next() {
        Some(plane) if plane.verdict == Verdict::Symmetric => Ok(plane),
        _ => Err(Error::argument("symmetric", "the shape is not its own mirror image")),
    }
}

fn entered_plane(frame: &Frame, plane: &Plane) -> Mirror {
    let through = symmetry::dot(&plane.normal, &frame.centre);
    Mirror { normal: plane.normal, offset: (plane.offset - through) / frame.half }
}

/// A place that is chosen.
enum Chosen {
    Free(usize),
    OnPlane(usize),
    Pair(usize),
}

/// How it is chosen.
struct Choosing<'a> {
    board: Board<'a>,
    mirror: Option<Mirror>,
    seed: u64,
}

impl Choosing<'_> {
    /// `count` places and their mean distance; none where there are not so many.
    fn chosen(&self, count: usize) -> Option<(Vec<Chosen>, f64)> {
        let mut random = Random::new(self.seed);
        if let Some(mirror) = &self.mirror {
            let found = folded(&self.board, mirror, count, &mut random)?;
            let single = found.single.into_iter().map(Chosen::OnPlane);
            return Some((single.chain(found.pairs.into_iter().map(Chosen::Pair)).collect(), found.cost));
        }
        let Board { along, seen, of_parts } = self.board;
        let fixed = extremities(along, seen, of_parts, count);
        let area = |node: usize| if seen[node] { along.areas[node] } else { 0.0 };
        let areas: Vec<f64> = (0..along.len()).map(area).collect();
        let candidates = (0..along.len()).filter(|&node| seen[node]).collect();
        let kinds = [Kind { candidates, count: count - fixed.len() }];
        let choice = Choice { cost: &along.far, areas: &areas, fixed: &fixed };
        let (chosen, cost) = medoids(&choice, &kinds, &mut random);
        (chosen.len() == count).then(|| (chosen.into_iter().map(Chosen::Free).collect(), cost))
    }

    /// How many are enough, with what each number costs.
    fn enough(&self, curve: &mut Vec<(usize, f64)>) -> usize {
        for count in AUTO {
            let Some((_, cost)) = self.chosen(count) else { break };
            curve.push((count, cost / 2.0));
            if let [.., (count, before), _, (_, after)] = curve[..] {
                if before - after < 2.0 * LITTLE * before {
                    return count;
                }
            }
        }
        curve.last().map_or(*AUTO.start(), |&(count, _)| count)
    }
}

/// What places are brought back to.
struct OfShape<'a> {
    x: &'a [f64],
    dim: usize,
    faces: &'a [[u32; 3]],
    entered: &'a [Position],
    frame: &'a Frame,
    along: &'a Along,
}

impl OfShape<'_> {
    fn placed(&self, chosen: &[Chosen], plane: Option<Plane>, curve: Vec<(usize, f64)>) -> Placed {
        let (mut points, mut mirror_of) = (Vec::new(), Vec::new());
        for one in chosen {
            let (Chosen::Free(node) | Chosen::OnPlane(node) | Chosen::Pair(node)) = *one;
            let mut at = self.world(&self.along.nodes[node]);
            match (one, &plane) {
                (Chosen::OnPlane(_), Some(plane)) => {
                    let image = plane.image(&at);
                    at.iter_mut().zip(image).for_each(|(c, other)| *c = 0.5 * (*c + other));
                }
                (Chosen::Pair(_), Some(plane)) => {
                    mirror_of.push(None);
                    points.extend_from_slice(&at);
                    mirror_of.push(Some(mirror_of.len() - 1));
                    points.extend(plane.image(&at));
                    continue;
                }
                _ => (),
            }
            mirror_of.push(None);
            points.extend(at);
        }
        Placed { points, mirror_of, plane, curve }
    }

    /// On the shape, in its own coordinates.
    fn world(&self, node: &Position) -> Vec<f64> {
        let frame = self.frame;
        match snap(self.entered, self.faces, node) {
            Snapped::Vertex(vertex) => self.x[self.dim * vertex..][..self.dim].to_vec(),
            Snapped::Place(place) => (0..self.dim).map(|k| frame.centre[k] + frame.half * place[k]).collect(),
        }
    }
}
