//! The elastic finish: what control points leave open is decided by the shape's own stiffness.
//!
//! ```text
//! fit    some 500 nodes spread along the shape, the control points first; neighbours are linked, stiffly where the shape is wide
//! frame  nodes go where links keep their lengths and turn with the shape, and where each node is rigid with the control points of which
//!        it has most: both in the L1 sense, so that bending gathers at joints, and a node chooses whom it follows (solve)
//! points each by its nearest nodes, along the shape rather than through the air (lift)
//! ```
//!
//! The control points are nodes that go where the map takes them without it: it changes nothing at them. All of it is a continuous function
//! of space and of the pose, always from the same start.
//!
//! Sources: Sorkine, Alexa, "As-rigid-as-possible surface modeling", 2007; Sumner, Schmid, Pauly, "Embedded deformation for shape
//! manipulation", 2007; graduated non-convexity: Blake, Zisserman, "Visual reconstruction", 1987.

use crate::error::Error;
use crate::geometry::Frame;
use crate::mls::matrix::Matrix;
use crate::weights::shape_graph::{check_shape, coarse, Near, Position, Shape};
use crate::weights::Weights;

mod frame;
mod lift;
mod solve;
mod start;
mod system;
mod turn;

pub use lift::Lift;
use solve::Rest;
use system::System;

/// Nodes of a shape, where control points are few.
const NODES: usize = 500;
/// Nodes a control point, where they are many.
const NODES_EACH: usize = 3;
/// Of the spacing of the nodes: over which distance links lose their stiffness.
const REACH: f64 = 1.2;
/// The least stiffness of a link.
const LEAST_STIFFNESS: f64 = 1e-4;
/// The least area of a node, in parts of the mean: one in a body has none of the surface.
const LEAST_AREA: f64 = 0.1;
/// What the finish knows of a shape. All but the arrays of [`Body`] follows from them and the weights.
pub struct Elastic {
    dim: usize,
    frame: Frame,
    body: Body,
    nodes: Vec<Position>,
    /// The control points at rest and the nodes in the world, and the logits of these.
    p: Vec<f64>,
    world: Vec<f64>,
    logits: Vec<f32>,
    rest: Rest,
    system: System,
    near: Near,
    /// Square roots of the weights of the nodes at the temperature 1, node by node.
    roots: Vec<f32>,
}

/// Nodes of a shape and the links between them, as they are kept in a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Body {
    /// Nodes, k x dim, in halves of the frame's longest side; the control points first.
    pub nodes: Vec<f64>,
    /// Each pair of linked nodes once, the smaller first.
    pub links: Vec<[u32; 2]>,
    /// How stiff each link is, above 0.
    pub stiffness: Vec<f64>,
    /// How much of the shape each node stands for, above 0; 1 in the mean.
    pub areas: Vec<f64>,
}

/// A pose, relaxed: where each node goes.
#[derive(Clone, Debug)]
pub struct Relaxed {
    /// Of each node its place, and the map of what is near it: a rotation, with a scale where a control point says so.
    x: Vec<Position>,
    y: Vec<Position>,
    maps: Vec<Matrix<3>>,
}

impl Elastic {
    /// Of a shape and the `weights` of its control points.
    ///
    /// # Errors
    /// Where the shape has no finite points, or a face names none; in 1D.
    pub fn new(weights: &Weights, shape: Shape<'_>) -> Result<Elastic, Error> {
        let (dim, frame) = (weights.dim(), weights.frame());
        check_shape(shape, dim)?;
        let entered = |x: &[f64]| -> Vec<Position> {
            x.chunks_exact(dim).map(|x| position(&frame.enter_all(x, dim))).collect()
        };
        let p = entered(weights.control_points());
        let count = NODES.max(NODES_EACH * p.len());
        let coarse = coarse(&entered(shape.x), shape.faces, &p, count);
        let spacing = spacing(coarse.nodes.len(), &coarse.ends, &coarse.lengths);
        let mean = coarse.areas.iter().sum::<f64>() / coarse.nodes.len() as f64;
        let areas: Vec<f64> = coarse.areas.iter().map(|area| (area / mean).max(LEAST_AREA)).collect();
        let stiff = |([a, b], length): (&[u32; 2], &f64)| {
            let area = mean * (areas[*a as usize] * areas[*b as usize]).sqrt();
            ((-(length / (REACH * spacing)).powi(2)).exp() * area / (spacing * spacing)).max(LEAST_STIFFNESS)
        };
        let stiffness = coarse.ends.iter().zip(&coarse.lengths).map(stiff).collect();
        let nodes = coarse.nodes.iter().flat_map(|x| x[..dim].to_vec()).collect();
        Elastic::of(weights, Body { nodes, links: coarse.ends, stiffness, areas })
    }

    /// Of what [`Elastic::body`] gave, and the same weights.
    ///
    /// # Errors
    /// Where an array does not fit another, or the weights.
    pub fn of(weights: &Weights, body: Body) -> Result<Elastic, Error> {
        let (dim, frame, p) = (weights.dim(), weights.frame(), weights.control_points());
        if dim == 1 {
            return Err(Error::argument(
                "relax",
                "a line has no stiffness: expected points of 2 or 3 coordinates",
            ));
        }
        let m = p.len() / dim;
        check_body(&body, &frame.enter_all(p, dim), dim)?;
        let nodes: Vec<Position> = body.nodes.chunks_exact(dim).map(position).collect();
        let mut world = p.to_vec();
        let rest_of = &body.nodes[p.len()..];
        world.extend(rest_of.iter().enumerate().map(|(at, c)| c * frame.half + frame.centre[at % dim]));
        let system = System::new(m, nodes.len(), &body.links);
        // By themselves, as `Handles` has them.
        let mut logits = weights.logits(p, &mut |_| true)?;
        logits.extend(weights.logits(&world[p.len()..], &mut |_| true)?);
        Ok(Elastic {
            dim,
            frame,
            p: p.to_vec(),
            world,
            rest: Rest::new(&nodes, m, &body),
            system,
            near: Near::new(&nodes),
            roots: lift::roots(&logits, m),
            nodes,
            logits,
            body,
        })
    }

    /// Its nodes and links.
    pub fn body(&self) -> &Body {
        &self.body
    }
}

fn position(x: &[f64]) -> Position {
    std::array::from_fn(|k| x.get(k).copied().unwrap_or(0.0))
}

fn apply(m: &Matrix<3>, x: &Position) -> Position {
    std::array::from_fn(|k| m[k][0] * x[0] + m[k][1] * x[1] + m[k][2] * x[2])
}

fn distance(a: &Position, b: &Position) -> f64 {
    ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2) + (a[2] - b[2]).powi(2)).sqrt()
}

/// The median distance of a node to its nearest neighbour.
fn spacing(count: usize, links: &[[u32; 2]], lengths: &[f64]) -> f64 {
    let mut nearest = vec![f64::INFINITY; count];
    for (ends, length) in links.iter().zip(lengths) {
        ends.iter().for_each(|&end| nearest[end as usize] = length.min(nearest[end as usize]));
    }
    median(nearest)
}

/// The middle one of the finite numbers, the lower of two; 1 of none.
fn median(mut of: Vec<f64>) -> f64 {
    of.retain(|value| value.is_finite());
    of.sort_by(f64::total_cmp);
    of.get(of.len().saturating_sub(1) / 2).copied().unwrap_or(1.0)
}

fn check_body(body: &Body, p: &[f64], dim: usize) -> Result<(), Error> {
    let refused = |message: &str| Err(Error::argument("relax", message.to_string()));
    let count = body.nodes.len() / dim;
    if !body.nodes.len().is_multiple_of(dim) || !body.nodes.starts_with(p) {
        return refused("expected nodes of which the control points are the first");
    }
    if body.nodes.iter().any(|c| !c.is_finite()) {
        return refused("expected finite nodes");
    }
    if body.areas.len() != count || body.stiffness.len() != body.links.len() {
        return refused("expected an area for each node, and a stiffness for each link");
    }
    if body.areas.iter().chain(&body.stiffness).any(|value| !(*value > 0.0 && value.is_finite())) {
        return refused("expected finite areas and stiffnesses above 0");
    }
    if body.links.iter().any(|[a, b]| a >= b || *b as usize >= count) {
        return refused("expected links of two different nodes, the smaller first");
    }
    // From the control points on, as often as there is something new: or a system has no solution.
    let mut reached: Vec<bool> = (0..count).map(|node| node < p.len() / dim).collect();
    let mut more = true;
    while std::mem::take(&mut more) {
        for ends in &body.links {
            let [a, b] = ends.map(|end| end as usize);
            more |= reached[a] != reached[b];
            (reached[a], reached[b]) = (reached[a] | reached[b], reached[a] | reached[b]);
        }
    }
    if reached.contains(&false) {
        return refused("expected every node to be linked to a control point");
    }
    Ok(())
}

#[cfg(test)]
mod tests;
