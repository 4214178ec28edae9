//! Where a frame begins: smooth rotations, near those of moving least squares.

use super::solve::{Moved, Posed, Rest};
use super::turn::turned;
use super::{apply, Body, Position};
use crate::mls::matrix::Matrix;

/// Sharpens the weights from which a node's rotation is found.
const POWER: f64 = 1.5;
/// Against a division by 0: a square, in those of the control points' spacing.
const LEAST: f64 = 1e-3;
/// Until rotations are smooth: 30 cost 0.2 to 0.5 % of the accuracy (docs/notes/relax.md).
const STEPS: usize = 60;
/// Steps of a rotation in one of these.
const TURNS: usize = 2;
/// Until control points arrive.
const ARRIVING: usize = 20;

/// `R_i <- polar(C_i + sum_j W_ij R_j)` from the `rotations` on; then `y = R (x - w p) + w q'`, with targets `q'` at which control points arrive.
pub(super) fn start(rest: &Rest, body: &Body, posed: &Posed<'_>, rotations: Vec<Matrix<3>>) -> Moved {
    let m = rest.m;
    let moments: Vec<Matrix<3>> =
        posed.w.chunks_exact(m).zip(&body.areas).map(|(w, area)| moment(rest, posed, w, *area)).collect();
    let held = |i: usize| posed.held.get(i).copied().flatten();
    let mut maps = rotations;
    for (i, map) in maps.iter_mut().enumerate().take(m) {
        *map = held(i).unwrap_or(*map);
    }
    let mut next = maps.clone();
    for _ in 0..STEPS {
        for (i, next) in next.iter_mut().enumerate().filter(|(i, _)| held(*i).is_none()) {
            let mut sum = moments[i];
            for (other, link) in rest.neighbours(i) {
                let stiff = body.stiffness[link];
                for (row, of) in sum.iter_mut().zip(&maps[other]) {
                    row.iter_mut().zip(of).for_each(|(sum, e)| *sum += stiff * e);
                }
            }
            *next = turned(&maps[i], &sum, TURNS);
        }
        std::mem::swap(&mut maps, &mut next);
    }
    let y = places(rest, posed, &maps);
    Moved { y, maps }
}

/// `C_i = a_i sum_j w'_ij (q_j - q*)(p_j - p*)^T / sum_j w'_ij |p_j - p*|^2`, with `w'` the weights to the power [`POWER`]; oriented control points
/// as moving least squares has them.
fn moment(rest: &Rest, posed: &Posed<'_>, w: &[f64], area: f64) -> Matrix<3> {
    let p = &rest.nodes[..rest.m];
    let sharp: Vec<f64> = w.iter().map(|w| w.powf(POWER)).collect();
    let sum: f64 = sharp.iter().sum();
    let mean = |of: &[Position]| -> Position {
        std::array::from_fn(|k| sharp.iter().zip(of).map(|(w, x)| w * x[k]).sum::<f64>() / sum)
    };
    let (p_mean, q_mean) = (mean(p), mean(posed.q));
    let (mut moment, mut extent) = ([[0.0; 3]; 3], LEAST * rest.apart * rest.apart);
    for (j, share) in sharp.iter().map(|w| w / sum).enumerate() {
        let a: Position = std::array::from_fn(|k| p[j][k] - p_mean[k]);
        let b: Position = std::array::from_fn(|k| posed.q[j][k] - q_mean[k]);
        extent += share * (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
        (0..9).for_each(|at| moment[at / 3][at % 3] += share * b[at / 3] * a[at % 3]);
        if let Some(map) = &posed.held[j] {
            let share = share * share * rest.squares[j];
            extent += share;
            (0..9).for_each(|at| moment[at / 3][at % 3] += share * map[at / 3][at % 3]);
        }
    }
    moment.map(|row| row.map(|e| area * e / extent))
}

/// `y`, by targets that take the control points where they go.
fn places(rest: &Rest, posed: &Posed<'_>, maps: &[Matrix<3>]) -> Vec<Position> {
    let m = rest.m;
    let mean = |w: &[f64], of: &[Position]| -> Position {
        std::array::from_fn(|k| w.iter().zip(of).map(|(w, x)| w * x[k]).sum())
    };
    let arms: Vec<Position> = (0..rest.nodes.len())
        .map(|i| {
            let p_mean = mean(&posed.w[m * i..][..m], &rest.nodes[..m]);
            apply(&maps[i], &std::array::from_fn(|k| rest.nodes[i][k] - p_mean[k]))
        })
        .collect();
    let at = |i: usize, q: &[Position]| -> Position {
        let q_mean = mean(&posed.w[m * i..][..m], q);
        std::array::from_fn(|k| arms[i][k] + q_mean[k])
    };
    let mut q = posed.q.to_vec();
    for _ in 0..ARRIVING {
        let arrived: Vec<Position> = (0..m).map(|i| at(i, &q)).collect();
        for (q, (wanted, arrived)) in q.iter_mut().zip(posed.q.iter().zip(arrived)) {
            (0..3).for_each(|k| q[k] += wanted[k] - arrived[k]);
        }
    }
    let mut y: Vec<Position> = (0..rest.nodes.len()).map(|i| at(i, &q)).collect();
    y[..m].copy_from_slice(posed.q);
    y
}
