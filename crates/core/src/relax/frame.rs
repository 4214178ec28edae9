//! A frame: where the nodes go in a pose.

use super::{position, solve, start, Elastic, Position, Relaxed};
use crate::deformer::{Deformer, Pose};
use crate::error::Error;
use crate::mls::matrix::Matrix;
use crate::mls::{best_rotation, Transform};
use crate::softmax;

/// Steepness of the passage to the thin plate, and where it is: how much better it must foretell.
const PASSAGE: i32 = 6;
const FORETELLS: f64 = 0.45;
/// An error of foretelling that is rounding, in halves of the frame's longest side.
const ROUNDING: f64 = 1e-9;

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
        let force = solve::solve(&self.rest, &self.body, &self.system, &frame, &mut y_and_r);
        let (global, _, _) = nodes.global(pose)?;
        // It knows nothing of how control points are oriented.
        let plate = self.plate.as_ref().filter(|_| held.iter().all(Option::is_none));
        let plate = plate.map(|plate| plate.bent(&landed, &embedded(&global, self.dim)));
        let share = plate.as_ref().map_or(0.0, |plate| {
            1.0 / (1.0 + (FORETELLS * (plate.error + ROUNDING) / (force + ROUNDING)).powi(PASSAGE))
        });
        let solve::Moved { y, maps } = y_and_r;
        Ok(Some(Relaxed { x: self.nodes.clone(), y, maps, share, plate }))
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
