//! Which control point a random walk over a shape meets first.
//!
//! Doyle, Snell, "Random walks and electric networks", 1984.

use super::cholesky::solve;
use super::links::Links;
use super::near::Near;
use super::paths::Reach;
use super::{attached, Position, CELL};
use crate::error::Error;

/// So many times as far as the nearest: the nodes at which a walk meets a control point.
const MET: f64 = 1.5;
/// Such nodes.
const MOST_MET: usize = 64;
/// What links of a control point conduct, a cell away; on a node ten times as much.
const FIRM: f64 = 1.0;
/// Of the way to the nearest other control point: how far one holds what is nearest to it.
const HOLD: f64 = 0.8;
/// How firmly, by area over the square of the distance.
const HELD: f64 = 0.5;

/// The probability that a random walk from each node meets each of `p` before the others: nodes x m, rows sum to 1.
///
/// The walk takes a link with a probability proportional to what it conducts: the result is the harmonic function `h_i` that is 1 at
/// control point i and 0 at the others. It knows how wide the shape is: a walk finds its way from a trunk into a thin leg seldom, and from
/// the leg to the trunk soon.
///
/// A control point is no needle, at which a harmonic function would be infinitely steep: it holds what is nearest to it, and a walk may end
/// wherever it does: `(L + k) h_i = k_i`, `k_i = HELD a / D^2 (1 - (D / r)^2)^2`, `a` the area that a node stands for, `D` its distance along the
/// shape, `r` = [`HOLD`] of the way to the nearest other control point. By `1 / D^2` every scale is held alike, whether the shape there is a sheet
/// or a stick: near the control point `1 - h_i` falls as a power of D in either.
///
/// # Errors
/// [`Error::Memory`].
pub(super) fn first_met(
    links: &Links,
    near: &Near,
    p: &[Position],
    reach: &Reach,
) -> Result<Vec<f64>, Error> {
    let (n, m) = (links.nodes.len(), p.len());
    let (mut met, mut ground) = (crate::machine::memory::zeros(n * m)?, vec![0.0; n]);
    let mut held = |node: usize, point: u32, firm: f64| {
        ground[node] += firm;
        met[node * m + point as usize] += firm;
    };
    for (point, node, far) in attached(near, p, MET, MOST_MET) {
        held(node as usize, point, FIRM * CELL / (far + 0.1 * CELL));
    }
    for (node, area) in links.areas.iter().enumerate() {
        let (point, far) = (reach.nearest[node], reach.far[node]);
        let radius = HOLD * reach.apart[point as usize];
        if far < radius {
            let density = HELD / (far * far + CELL * CELL) * (1.0 - (far / radius).powi(2)).powi(2);
            held(node, point, density * area);
        }
    }
    solve(&links.ends, &links.conductances, &ground, &mut met);
    Ok(met)
}
