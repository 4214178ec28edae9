//! A kd-tree over points: what an evaluation that gains from small boxes walks over. It depends on the points alone, so that one
//! tree serves every network that is fitted to the same shape.
//!
//! ```text
//! a node is a range of leaves; all leaves have LEAF points, but for the last
//! split(node): its points at the median of their longest side, so that each half has whole leaves
//! ```
//!
//! Nodes are numbered in preorder: the left half of node `i` is `i + 1`, its right half comes after the whole left half. So
//! there are no pointers, and a subtree's points, order and boxes are each one slice. Bentley, "Multidimensional binary search
//! trees used for associative searching", 1975.

use std::cmp::Ordering;
use std::ops::Range;
use std::sync::Mutex;

use crate::check::check_points;
use crate::error::Error;
use crate::geometry::Frame;
use crate::machine::memory::{room, try_filled, zeros};
use crate::machine::parallel::for_each_task;
use crate::machine::progress::{report, Progress};
use crate::machine::simd::{Aligned, WIDTH};

/// Points a leaf.
pub(crate) const LEAF: usize = 64;
/// Blocks a leaf.
pub(crate) const LEAF_BLOCKS: usize = LEAF / WIDTH;
/// Points at all of whose coordinates the processor looks at once.
const SEVERAL: usize = 8;
/// Points of which not all are asked for the longest side.
const MANY: usize = 1 << 9;
/// Levels that are split one after the other, all nodes of a level at once; below, each subtree is one task.
const LEVELS: usize = 6;

/// Points in the order of a kd-tree, normalised by a frame, in single precision.
pub struct PointTree {
    dim: usize,
    frame: Frame,
    /// In the order of the tree.
    points: Vec<Point>,
    /// One a node, in preorder.
    boxes: Vec<Region>,
}

/// A box: every point x of it has `|x - centre| <= half` on each axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Region {
    pub centre: [f32; 3],
    pub half: [f32; 3],
}

/// A node of the tree: `count` leaves from leaf `first` on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    index: usize,
    pub first: usize,
    pub count: usize,
}

/// In which order something of a tree's points is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// As the points were given.
    Given,
    /// As the points are in the tree: neighbours side by side, which is faster. [`PointTree::order`] says which is where.
    Tree,
}

impl Order {
    /// The rows of the points at some places of the tree, no two of which are the same.
    #[inline(always)]
    pub(crate) fn rows(
        self,
        tree: &PointTree,
        places: Range<usize>,
    ) -> impl Iterator<Item = usize> + Clone + '_ {
        places.map(move |place| if self == Order::Tree { place } else { tree.index(place) })
    }
}

impl Node {
    /// Its two halves; `None` for a leaf.
    pub(crate) fn halves(self) -> Option<[Node; 2]> {
        let left = self.count.div_ceil(2);
        (self.count > 1).then(|| {
            [
                Node { index: self.index + 1, first: self.first, count: left },
                Node { index: self.index + 2 * left, first: self.first + left, count: self.count - left },
            ]
        })
    }
}

/// Coordinates, and the point's own index: the bits of the last number are it.
pub(crate) type Point = [f32; 4];

impl PointTree {
    /// The tree of the points `x` (n x dim), which it normalises by `frame`: that of the networks it is for.
    ///
    /// # Errors
    /// [`Error::Cancelled`]; where a coordinate is not finite, or there are more than 2^32 points.
    pub fn new(x: &[f64], dim: usize, frame: Frame, progress: &mut Progress<'_>) -> Result<PointTree, Error> {
        let n = check_points("x", x, dim)?;
        if u32::try_from(n).is_err() {
            return Err(Error::argument("x", format!("expected at most 2^32 - 1 points, found {n}")));
        }
        report(progress, 0.0)?;
        let mut points = try_filled(Vec::new(), n, [0.0; 4], 1 << 12, |block, points| {
            let first = block << 12;
            for (i, (point, x)) in points.iter_mut().zip(x[dim * first..].chunks_exact(dim)).enumerate() {
                let [x, y, z] = frame.enter_single(x);
                *point = [x, y, z, f32::from_bits((first + i) as u32)];
            }
        })?;
        let nodes = (2 * n.div_ceil(LEAF)).saturating_sub(1);
        let mut boxes = room(nodes)?;
        boxes.resize(nodes, Region { centre: [0.0; 3], half: [0.0; 3] });
        build(&mut points, &mut boxes, progress)?;

        report(progress, 1.0)?;
        Ok(PointTree { dim, frame, points, boxes })
    }

    /// Points, n.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Coordinates a point.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// The frame that the points are normalised by.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The index of each point of the tree among the points as they were given: each index once.
    pub fn order(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        (0..self.len()).map(|place| self.index(place))
    }

    /// The points in the order in which they were given, as exact as they are here.
    pub(crate) fn given(&self) -> Result<Vec<f64>, Error> {
        let mut x = zeros(self.dim * self.len())?;
        for (place, index) in self.order().enumerate() {
            let point = self.point(place);
            for (k, x) in x[self.dim * index..][..self.dim].iter_mut().enumerate() {
                *x = self.frame.centre[k] + self.frame.half * f64::from(point[k]);
            }
        }
        Ok(x)
    }

    fn index(&self, place: usize) -> usize {
        self.points[place][3].to_bits() as usize
    }

    /// The normalised point at a place of the tree; coordinates beyond the dimension are 0.
    pub(crate) fn point(&self, place: usize) -> [f32; 3] {
        let [x, y, z, _] = self.points[place];
        [x, y, z]
    }

    /// The points of a node.
    pub(crate) fn points(&self, node: Node) -> &[Point] {
        &self.points[node.first * LEAF..self.len().min((node.first + node.count) * LEAF)]
    }

    /// The 16 points from a place on, coordinate by coordinate; where there are fewer, the last one again and again.
    pub(crate) fn block(&self, first: usize) -> [Aligned; 3] {
        let points = &self.points[first..];
        let points: &[Point; WIDTH] = match points.first_chunk() {
            Some(points) => points,
            None => &std::array::from_fn(|lane| points[lane.min(points.len() - 1)]),
        };
        let mut block = [Aligned::ZERO; 3];
        for (lane, point) in points.iter().enumerate() {
            for (coordinates, x) in block.iter_mut().zip(point) {
                coordinates.0[lane] = *x;
            }
        }
        block
    }

    /// All leaves.
    pub(crate) fn root(&self) -> Node {
        Node { index: 0, first: 0, count: self.len().div_ceil(LEAF) }
    }

    pub(crate) fn region(&self, node: Node) -> &Region {
        &self.boxes[node.index]
    }
}

/// A subtree that is not split yet.
type Unsplit<'a> = Mutex<(&'a mut [Point], &'a mut [Region])>;

fn build(points: &mut [Point], boxes: &mut [Region], progress: &mut Progress<'_>) -> Result<(), Error> {
    if points.is_empty() {
        return Ok(());
    }
    let mut level: Vec<Unsplit<'_>> = vec![Mutex::new((points, &mut *boxes))];
    for depth in 0..LEVELS {
        let done = depth as f64 / (LEVELS + 4) as f64;
        for_each_task(level.len(), done..done, progress, |task, _| {
            let (points, boxes) = &mut *level[task].lock().expect("no task panics");
            split(points, boxes);
        })?;
        level = level.into_iter().flat_map(halves).collect();
    }
    let done = LEVELS as f64 / (LEVELS + 4) as f64;
    for_each_task(level.len(), done..1.0, progress, |task, stop| {
        let (points, boxes) = &mut *level[task].lock().expect("no task panics");
        split_all(points, boxes, stop);
    })?;
    drop(level);
    join(boxes, LEVELS);
    Ok(())
}

/// The boxes of the first levels, from those below.
fn join(boxes: &mut [Region], levels: usize) {
    if levels > 0 && boxes.len() > 1 {
        let left = middle(boxes);
        join(&mut boxes[1..2 * left], levels - 1);
        join(&mut boxes[2 * left..], levels - 1);
        boxes[0] = boxes[1].and(&boxes[2 * left]);
    }
}

/// Both halves of a subtree that was split; nothing of a leaf, which is done.
fn halves(subtree: Unsplit<'_>) -> Vec<Unsplit<'_>> {
    let (points, boxes) = subtree.into_inner().expect("no task panics");
    if boxes.len() == 1 {
        return Vec::new();
    }
    let left = middle(boxes);
    let (points, right_points) = points.split_at_mut(left * LEAF);
    let (boxes, right_boxes) = boxes[1..].split_at_mut(2 * left - 1);
    vec![Mutex::new((points, boxes)), Mutex::new((right_points, right_boxes))]
}

/// Leaves of the left half of a subtree of such boxes.
fn middle(boxes: &[Region]) -> usize {
    boxes.len().div_ceil(2).div_ceil(2)
}

/// Splits a subtree down to its leaves, and writes their boxes and those above.
fn split_all(points: &mut [Point], boxes: &mut [Region], stop: &(dyn Fn() -> bool + Sync)) {
    split(points, boxes);
    if boxes.len() == 1 || stop() {
        return;
    }
    let left = middle(boxes);
    let (points, right_points) = points.split_at_mut(left * LEAF);
    split_all(points, &mut boxes[1..2 * left], stop);
    split_all(right_points, &mut boxes[2 * left..], stop);
    boxes[0] = boxes[1].and(&boxes[2 * left]);
}

/// Puts the points of the left half of a subtree first; writes the box of a leaf.
fn split(points: &mut [Point], boxes: &mut [Region]) {
    if boxes.len() == 1 {
        boxes[0] = Region::around(points.chunks(SEVERAL));
        return;
    }
    let middle = middle(boxes) * LEAF;
    // Of many points some say which side is the longest.
    let step = if points.len() > MANY { SEVERAL } else { 1 };
    let half = Region::around(points.chunks(SEVERAL).step_by(step)).half;
    if half[0] >= half[1] && half[0] >= half[2] {
        select::<0>(points, middle);
    } else if half[1] >= half[2] {
        select::<1>(points, middle);
    } else {
        select::<2>(points, middle);
    }
}

fn select<const AXIS: usize>(points: &mut [Point], middle: usize) {
    points.select_nth_unstable_by(middle, |a, b| a[AXIS].partial_cmp(&b[AXIS]).unwrap_or(Ordering::Equal));
}

impl Region {
    fn around<'a>(points: impl Iterator<Item = &'a [Point]>) -> Region {
        let mut least = [[f32::INFINITY; 4]; SEVERAL];
        let mut most = [[f32::NEG_INFINITY; 4]; SEVERAL];
        for points in points {
            let points: &[Point; SEVERAL] = match points.try_into() {
                Ok(points) => points,
                Err(_) => &std::array::from_fn(|i| points[i.min(points.len() - 1)]),
            };
            for i in 0..SEVERAL {
                for k in 0..4 {
                    let x = points[i][k];
                    least[i][k] = if x < least[i][k] { x } else { least[i][k] };
                    most[i][k] = if x > most[i][k] { x } else { most[i][k] };
                }
            }
        }
        let least = |k: usize| least.iter().fold(f32::INFINITY, |least, of| least.min(of[k]));
        let most = |k: usize| most.iter().fold(f32::NEG_INFINITY, |most, of| most.max(of[k]));
        Region::between([0, 1, 2].map(least), [0, 1, 2].map(most))
    }

    /// Around both.
    fn and(&self, other: &Region) -> Region {
        let least = |of: &Region, k: usize| of.centre[k] - of.half[k];
        let most = |of: &Region, k: usize| of.centre[k] + of.half[k];
        Region::between(
            [0, 1, 2].map(|k| least(self, k).min(least(other, k))),
            [0, 1, 2].map(|k| most(self, k).max(most(other, k))),
        )
    }

    fn between(least: [f32; 3], most: [f32; 3]) -> Region {
        let mut region = Region { centre: [0.0; 3], half: [0.0; 3] };
        for k in 0..3 {
            let centre = 0.5 * least[k] + 0.5 * most[k];
            // A little more, because these differences are rounded.
            let half = (most[k] - centre).max(centre - least[k]);
            (region.centre[k], region.half[k]) = (centre, half * (1.0 + 4.0 * f32::EPSILON));
        }
        region
    }
}

#[cfg(test)]
mod tests;
