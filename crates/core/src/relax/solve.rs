//! Where the nodes go: rounds of reweighted least squares, each of a few local and global steps.
//!
//! ```text
//! minimise  sum_links W_e (|y_i - y_j - R_i (x_i - x_j)|^2 + |... R_j ...|^2) / 2 + sum_ij k_i b_ij |y_i - q_j - R_i (x_i - p_j)|^2
//! links     W_e = W0_e / sqrt(rho_e^2 + 0.03^2), rho_e how much the link is bent or stretched: in the L1 sense
//! nodes     b_ij = w_ij / sqrt(|y_i - q_j - R_i (x_i - p_j)|^2 + (0.03 n0)^2): each node chooses the control points it is rigid with
//! ```

use super::system::System;
use super::turn::turned;
use super::{apply, distance, Body, Position};
use crate::mls::matrix::Matrix;

/// How much nodes are rigid with control points: times the square of the nodes' spacing in that of the control points. As the other constants here
/// from true poses of four animals and a dancer (docs/notes/relax.md).
const KAPPA: f64 = 8.0;
/// Of the control points' spacing: what counts as rigid.
const SOFT: f64 = 0.03;
/// The same of links.
const SOFT_LINK: f64 = 0.03;
/// How much the rotations of neighbours count where links leave a rotation open.
const ALIKE: f64 = 1e-3;
const ROUNDS: usize = 6;
const STEPS: usize = 6;
const TURNS: usize = 2;

/// What is the same in every frame.
pub(super) struct Rest {
    pub(super) m: usize,
    pub(super) nodes: Vec<Position>,
    /// The median distance of a control point to the nearest other, and the square of each's.
    pub(super) apart: f64,
    pub(super) squares: Vec<f64>,
    /// The median distance of a node to the nearest one that it is linked to.
    pub(super) spacing: f64,
    kappa: f64,
    starts: Vec<u32>,
    others: Vec<(u32, u32)>,
    arms: Vec<Position>,
}

/// A pose: weights of the nodes, where control points go, and the maps of those that are oriented.
pub(super) struct Posed<'a> {
    pub(super) w: &'a [f64],
    pub(super) q: &'a [Position],
    pub(super) held: &'a [Option<Matrix<3>>],
}

/// Where nodes are, and their maps.
pub(super) struct Moved {
    pub(super) y: Vec<Position>,
    pub(super) maps: Vec<Matrix<3>>,
}

impl Rest {
    pub(super) fn new(nodes: &[Position], m: usize, body: &Body) -> Rest {
        let mut starts = vec![0_u32; nodes.len() + 1];
        body.links.iter().flatten().for_each(|&end| starts[end as usize + 1] += 1);
        (1..starts.len()).for_each(|node| starts[node] += starts[node - 1]);
        let (mut next, mut others) = (starts.clone(), vec![(0, 0); 2 * body.links.len()]);
        for (link, &[a, b]) in body.links.iter().enumerate() {
            for (from, to) in [(a, b), (b, a)] {
                others[next[from as usize] as usize] = (to, link as u32);
                next[from as usize] += 1;
            }
        }
        let far = |[a, b]: &[u32; 2]| distance(&nodes[*a as usize], &nodes[*b as usize]);
        let lengths: Vec<f64> = body.links.iter().map(far).collect();
        let spacing = super::spacing(nodes.len(), &body.links, &lengths);
        let away = |i: usize| {
            (0..m).filter(|&k| k != i).map(|k| distance(&nodes[i], &nodes[k])).fold(f64::INFINITY, f64::min)
        };
        let away: Vec<f64> = (0..m).map(away).collect();
        let apart = super::median(away.clone());
        let squares = away.iter().map(|far| if far.is_finite() { far * far } else { 1.0 }).collect();
        let arm = |[a, b]: &[u32; 2]| -> Position {
            std::array::from_fn(|k| nodes[*a as usize][k] - nodes[*b as usize][k])
        };
        Rest {
            m,
            nodes: nodes.to_vec(),
            apart,
            squares,
            spacing,
            kappa: KAPPA * (spacing / apart).powi(2),
            starts,
            others,
            arms: body.links.iter().map(arm).collect(),
        }
    }

    /// The neighbours of a node, and by which links.
    pub(super) fn neighbours(&self, node: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let range = self.starts[node] as usize..self.starts[node + 1] as usize;
        self.others[range].iter().map(|&(other, link)| (other as usize, link as usize))
    }
}

/// How a node is attached to the control points.
#[derive(Clone, Copy, Default)]
struct Attached {
    p: Position,
    q: Position,
    firm: f64,
}

/// Moves the nodes.
pub(super) fn solve(rest: &Rest, body: &Body, system: &System, posed: &Posed<'_>, moved: &mut Moved) {
    let Some(mut factors) = system.prepared() else { return };
    let m = rest.m;
    let mut right: [Vec<f64>; 3] = std::array::from_fn(|_| vec![0.0; rest.nodes.len() - m]);
    for round in 0..ROUNDS {
        let stiffness = reweighted(rest, body, moved);
        let firmness = rest.kappa * 10_f64.powf(round as f64 / (ROUNDS - 1) as f64 - 1.0);
        let attached = attached(rest, body, posed, moved, firmness);
        system.factor(&body.links, &stiffness, |free| attached[m + free].firm, &mut factors);
        for _ in 0..STEPS {
            turn(rest, &stiffness, &attached, posed, moved);
            balance(rest, body, &stiffness, &attached, moved, &mut right);
            factors.solve(&mut right);
            settle(&right, m, &mut moved.y);
        }
    }
}

/// The stiffness of links that are bent or stretched is less, in the mean as before.
fn reweighted(rest: &Rest, body: &Body, moved: &Moved) -> Vec<f64> {
    let factor = |(link, [a, b]): (usize, &[u32; 2])| {
        let ([a, b], arm) = ([*a as usize, *b as usize], &rest.arms[link]);
        let square = arm[0] * arm[0] + arm[1] * arm[1] + arm[2] * arm[2];
        let mut left = 0.0;
        for end in [a, b] {
            let turned = apply(&moved.maps[end], arm);
            let off: Position = std::array::from_fn(|k| moved.y[a][k] - moved.y[b][k] - turned[k]);
            left += off[0] * off[0] + off[1] * off[1] + off[2] * off[2];
        }
        1.0 / (left / (2.0 * square) + SOFT_LINK * SOFT_LINK).sqrt()
    };
    let factors: Vec<f64> = body.links.iter().enumerate().map(factor).collect();
    let all: f64 = body.stiffness.iter().sum();
    let mean = body.stiffness.iter().zip(&factors).map(|(stiff, factor)| stiff * factor).sum::<f64>() / all;
    body.stiffness.iter().zip(&factors).map(|(stiff, factor)| stiff * factor / mean).collect()
}

/// Each node's centres of the control points that it is rigid with, and how firmly it is.
fn attached(rest: &Rest, body: &Body, posed: &Posed<'_>, moved: &Moved, firmness: f64) -> Vec<Attached> {
    let m = rest.m;
    let soft = (SOFT * rest.apart).powi(2);
    let mut all = vec![Attached::default(); rest.nodes.len()];
    let (mut sum, mut areas) = (0.0, 0.0);
    for (i, own) in all.iter_mut().enumerate().skip(m) {
        let map = &moved.maps[i];
        let turned = apply(map, &rest.nodes[i]);
        for (j, w) in posed.w[m * i..][..m].iter().enumerate() {
            let (p, q) = (&rest.nodes[j], &posed.q[j]);
            let of_p = apply(map, p);
            let left = |k: usize| moved.y[i][k] - turned[k] - q[k] + of_p[k];
            let b = w / (left(0).powi(2) + left(1).powi(2) + left(2).powi(2) + soft).sqrt();
            own.firm += b;
            (0..3).for_each(|k| (own.p[k], own.q[k]) = (own.p[k] + b * p[k], own.q[k] + b * q[k]));
        }
        own.p = own.p.map(|c| c / own.firm);
        own.q = own.q.map(|c| c / own.firm);
        (sum, areas) = (sum + body.areas[i] * own.firm, areas + body.areas[i]);
    }
    let scale = firmness * areas / sum;
    all.iter_mut().zip(&body.areas).for_each(|(own, area)| own.firm *= scale * area);
    all
}

/// The local step: each node turns as its links and what it is attached to ask for.
fn turn(rest: &Rest, stiffness: &[f64], attached: &[Attached], posed: &Posed<'_>, moved: &mut Moved) {
    let Moved { y, maps } = moved;
    let asked = |i: usize, maps: &[Matrix<3>]| -> Matrix<3> {
        let mut sum = [[0.0; 3]; 3];
        for (other, link) in rest.neighbours(i) {
            let (x, stiff) = (&rest.nodes[other], stiffness[link]);
            let dx: Position = std::array::from_fn(|k| rest.nodes[i][k] - x[k]);
            for r in 0..3 {
                let dy = stiff * (y[i][r] - y[other][r]);
                (0..3).for_each(|c| sum[r][c] += dy * dx[c] + ALIKE * stiff * maps[other][r][c]);
            }
        }
        let own = &attached[i];
        let dx: Position = std::array::from_fn(|k| rest.nodes[i][k] - own.p[k]);
        for r in 0..3 {
            let dy = own.firm * (y[i][r] - own.q[r]);
            (0..3).for_each(|c| sum[r][c] += dy * dx[c]);
        }
        sum
    };
    let before = maps.clone();
    for i in 0..rest.nodes.len() {
        if posed.held.get(i).copied().flatten().is_none() {
            maps[i] = turned(&before[i], &asked(i, &before), TURNS);
        }
    }
}

/// The right-hand side of the global step.
fn balance(
    rest: &Rest,
    body: &Body,
    stiffness: &[f64],
    attached: &[Attached],
    moved: &Moved,
    right: &mut [Vec<f64>; 3],
) {
    let m = rest.m;
    for (free, own) in attached[m..].iter().enumerate() {
        let i = m + free;
        let arm: Position = std::array::from_fn(|k| rest.nodes[i][k] - own.p[k]);
        let turned = apply(&moved.maps[i], &arm);
        (0..3).for_each(|k| right[k][free] = own.firm * (turned[k] + own.q[k]));
    }
    for (link, [a, b]) in body.links.iter().enumerate() {
        let ([a, b], stiff) = ([*a as usize, *b as usize], stiffness[link]);
        let (of_a, of_b) = (apply(&moved.maps[a], &rest.arms[link]), apply(&moved.maps[b], &rest.arms[link]));
        for k in 0..3 {
            let along = 0.5 * stiff * (of_a[k] + of_b[k]);
            if a >= m {
                right[k][a - m] += along;
            } else if b >= m {
                right[k][b - m] += stiff * moved.y[a][k];
            }
            if b >= m {
                right[k][b - m] -= along;
            }
        }
    }
}

fn settle(solved: &[Vec<f64>; 3], m: usize, y: &mut [Position]) {
    for (free, y) in y[m..].iter_mut().enumerate() {
        *y = std::array::from_fn(|k| solved[k][free]);
    }
}

#[cfg(test)]
/// One local and one global step of the last round: the stiffness of the links, and of the free nodes what they are attached to.
pub(super) fn one_step(
    rest: &Rest,
    body: &Body,
    system: &System,
    posed: &Posed<'_>,
    moved: &mut Moved,
) -> (Vec<f64>, Vec<(Position, Position, f64)>) {
    let mut factors = system.prepared().unwrap();
    let stiffness = reweighted(rest, body, moved);
    let attached = attached(rest, body, posed, moved, rest.kappa);
    let mut right = std::array::from_fn(|_| vec![0.0; rest.nodes.len() - rest.m]);
    system.factor(&body.links, &stiffness, |free| attached[rest.m + free].firm, &mut factors);
    turn(rest, &stiffness, &attached, posed, moved);
    balance(rest, body, &stiffness, &attached, moved, &mut right);
    factors.solve(&mut right);
    settle(&right, rest.m, &mut moved.y);
    (stiffness, attached[rest.m..].iter().map(|own| (own.p, own.q, own.firm)).collect())
}
