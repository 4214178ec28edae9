//! A frame: where the nodes go in a pose.

use super::turn::turned;
use super::{apply, distance, position, solve, start, Elastic, Position, Relaxed};
use crate::deformer::{Deformer, Pose};
use crate::error::Error;
use crate::mls::matrix::Matrix;
use crate::mls::{best_rotation, Transform};
use crate::softmax;

/// By how much control points miss a rigid motion that is one but for rounding, in halves of the frame's longest side.
const ROUNDING: f64 = 1e-9;
/// Steps of the rotation of that motion.
const POLISHED: usize = 2;

impl Elastic {
    /// Where the nodes go in a pose, whose targets are those of an [`crate::Aim`]; `None` where nothing moves.
    ///
    /// # Errors
    /// As [`Deformer::deform`].
    pub fn relax<'a>(
        &self,
        pose: impl Into<Pose<'a>>,
        temperature: f64,
        transform: Transform,
    ) -> Result<Option<Relaxed>, Error> {
        let pose = pose.into();
        let nodes =
            Deformer::of_logits(self.world.clone(), self.dim, &self.p, self.logits.clone(), transform)?;
        if nodes.unmoved(pose)? {
            return Ok(None);
        }
        let moved = nodes.deform(pose, temperature, true, &mut |_| true)?;
        let m = self.p.len() / self.dim;
        let landed: Vec<Position> = moved.positions[..self.p.len()]
            .chunks_exact(self.dim)
            .map(|y| position(&self.frame.enter_all(y, self.dim)))
            .collect();
        let maps = moved.maps.expect("asked for");
        let rotations = maps.chunks_exact(self.dim * self.dim).map(|map| match transform {
            Transform::Rigid => embedded(map, self.dim),
            _ => nearest_rotation(map, self.dim),
        });
        let mut w = vec![0.0; self.nodes.len() * m];
        for (w, logits) in w.chunks_exact_mut(m).zip(self.logits.chunks_exact(m)) {
            softmax::weights(logits, temperature, w);
        }
        let held = self.held(pose, transform);
        let frame = solve::Posed { w: &w, q: &landed, held: &held };
        let mut y_and_r = start::start(&self.rest, &self.body, &frame, rotations.collect());
        solve::solve(&self.rest, &self.body, &self.system, &frame, &mut y_and_r);
        // It knows nothing of how control points are oriented.
        if held.iter().all(Option::is_none) {
            let (rotation, _, _) = nodes.global(pose)?;
            self.stiffen(&landed, &embedded(&rotation, self.dim), &mut y_and_r);
        }
        let solve::Moved { y, maps } = y_and_r;
        Ok(Some(Relaxed { x: self.nodes.clone(), y, maps }))
    }

    /// Moves all nodes by the rigid motion of that rotation where it takes the control points to `q`: two control points, or some on a line,
    /// leave a turn about it open, and rounding would decide.
    fn stiffen(&self, q: &[Position], rotation: &Matrix<3>, moved: &mut solve::Moved) {
        let mean = |points: &[Position]| -> Position {
            std::array::from_fn(|k| points.iter().map(|x| x[k]).sum::<f64>() / q.len() as f64)
        };
        let (p_mean, q_mean) = (mean(&self.nodes[..q.len()]), mean(q));
        let mut moment = [[0.0; 3]; 3];
        for (q, p) in q.iter().zip(&self.nodes) {
            (0..9).for_each(|at| {
                moment[at / 3][at % 3] += (q[at / 3] - q_mean[at / 3]) * (p[at % 3] - p_mean[at % 3])
            });
        }
        // To the last digits; about an axis that is open it stays.
        let rotation = &turned(rotation, &moment, POLISHED);
        let centre = apply(rotation, &p_mean);
        let rigid = |x: &Position| -> Position {
            let y = apply(rotation, x);
            std::array::from_fn(|k| y[k] - centre[k] + q_mean[k])
        };
        let off = q.iter().zip(&self.nodes).map(|(q, p)| distance(q, &rigid(p))).fold(0.0, f64::max);
        let share = 1.0 / (1.0 + (off / ROUNDING).powi(2));
        for ((y, map), x) in moved.y.iter_mut().zip(&mut moved.maps).zip(&self.nodes) {
            let all = rigid(x);
            for k in 0..3 {
                y[k] += share * (all[k] - y[k]);
                (0..3).for_each(|c| map[k][c] += share * (rotation[k][c] - map[k][c]));
            }
        }
    }

    /// The maps of the control points that are oriented.
    fn held(&self, pose: Pose<'_>, transform: Transform) -> Vec<Option<Matrix<3>>> {
        let m = self.p.len() / self.dim;
        let Some(orientations) = pose.orientations else { return vec![None; m] };
        let held = |map: &[f64]| match (map[0].is_nan(), transform) {
            (true, _) => None,
            (_, Transform::Rigid) => Some(nearest_rotation(map, self.dim)),
            _ => Some(embedded(map, self.dim)),
        };
        orientations.chunks_exact(self.dim * self.dim).map(held).collect()
    }
}

/// A map (row-major) in three dimensions, with what it lacks as it is.
fn embedded(map: &[f64], dim: usize) -> Matrix<3> {
    std::array::from_fn(|r| {
        std::array::from_fn(
            |c| {
                if r < dim && c < dim {
                    map[dim * r + c]
                } else {
                    f64::from(u8::from(r == c))
                }
            },
        )
    })
}

fn nearest_rotation(map: &[f64], dim: usize) -> Matrix<3> {
    if dim == 2 {
        let rotation = best_rotation::<2>(&[[map[0], map[2]], [map[1], map[3]]]);
        return embedded(rotation.as_flattened(), 2);
    }
    best_rotation::<3>(&std::array::from_fn(|r| std::array::from_fn(|c| map[3 * c + r])))
}
