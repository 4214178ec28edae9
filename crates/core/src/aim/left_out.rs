//! What control points say of each other: where each lands if it says nothing itself.
//!
//! ```text
//! e_i = |f_i(p_i; q) - q_i|,   f_i being f with w_i = 0
//! ```
//!
//! The weights of the others at `p_i` are those that there are, made to sum to 1, so that nothing is fitted again. With many control points,
//! each of which has others all around it, this goes with how far the shape between them is from where it should be: over 54 motions of 50
//! to 400 control points its root mean square, with neural weights and rigid maps, was 1.0 to 5.2 times that (studies/left_out.py).

use super::{greatest, Handles};
use crate::deformer::{Deformer, Pose};
use crate::error::Error;
use crate::mls::Transform;
use crate::probe::distance;

/// With fewer control points most have none beyond them to one side, and what the others say of them is a guess.
const MANY: usize = 50;
/// Affine maps are named where they leave at most this part, both in the median and in the root mean square. Study (studies/left_out.py, three
/// kinds of weights): so they do in 14 of 162 cases, smooth motions and parts pulled longer, and there leave at most 0.22 and 0.31 on the
/// shape itself; of creatures' poses the larger of both is at least 0.7, and of a part that is turned 0.88.
const PART: f64 = 0.5;
/// What is left out ends so far off its target (in the longest move, root mean square) before there is anything to say.
const SEEN: f64 = 0.005;
/// The logit of a control point that says nothing.
const NOTHING: f32 = -1e30;

/// Motions that affine maps follow far more closely than those that are set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiff {
    /// The median of how far a control point that is left out ends from its target.
    pub now: f64,
    /// The same with affine maps.
    pub affine: f64,
    /// The control point that ends farthest off.
    pub worst: usize,
}

impl Handles {
    /// How far each control point ends from its target in `pose` where the others alone take it, with maps of a kind.
    ///
    /// # Errors
    /// As [`Deformer::deform`].
    pub fn left_out(
        &self,
        pose: Pose<'_>,
        temperature: f64,
        transform: Transform,
    ) -> Result<Vec<f64>, Error> {
        let (dim, mut logits) = (self.dim, self.logits().to_vec());
        let m = self.p.len() / dim;
        logits.iter_mut().step_by(m + 1).for_each(|own| *own = NOTHING);
        let others = Deformer::of_logits(self.p.clone(), dim, &self.p, logits, transform)?;
        let landed = others.deform(pose, temperature, false, &mut |_| true)?.positions;
        Ok(landed.chunks_exact(dim).zip(pose.q.chunks_exact(dim)).map(|(y, q)| distance(y, q)).collect())
    }

    /// Whether affine maps would follow many control points far more closely; `None` where not.
    ///
    /// # Errors
    /// As [`Handles::left_out`].
    pub fn stiff(&self, pose: Pose<'_>, temperature: f64) -> Result<Option<Stiff>, Error> {
        let count = self.p.len() / self.dim;
        if count < MANY || self.transform == Transform::Affine {
            return Ok(None);
        }
        let moves = self.p.chunks_exact(self.dim).zip(pose.q.chunks_exact(self.dim));
        let longest = moves.map(|(p, q)| distance(p, q)).fold(0.0, f64::max);
        let now = self.left_out(pose, temperature, self.transform)?;
        if mean_square(&now) <= (SEEN * longest).powi(2) {
            return Ok(None);
        }
        let affine = self.left_out(pose, temperature, Transform::Affine)?;
        let better = mean_square(&affine) <= PART * PART * mean_square(&now);
        let worst = greatest(now.iter().copied()).0;
        let found = Stiff { now: median(now), affine: median(affine), worst };
        Ok((better && found.affine <= PART * found.now).then_some(found))
    }
}

fn mean_square(away: &[f64]) -> f64 {
    away.iter().map(|e| e * e).sum::<f64>() / away.len() as f64
}

fn median(mut away: Vec<f64>) -> f64 {
    let middle = away.len() / 2;
    *away.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Frame;
    use crate::weights::inverse_distance::InverseDistance;
    use crate::weights::Weights;

    /// The first of 4 x 4 x 4 control points.
    fn lattice(count: usize) -> Vec<f64> {
        (0..count).flat_map(|i| [i % 4, i / 4 % 4, i / 16].map(|k| k as f64)).collect()
    }

    fn weights(p: &[f64]) -> Weights {
        let frame = Frame::around(p, 3);
        Weights::InverseDistance(InverseDistance::new(p, 3, frame, 2.0, 0.0).unwrap())
    }

    fn sheared(p: &[f64]) -> Vec<f64> {
        p.chunks(3).flat_map(|x| [x[0] + 0.4 * x[1] + 0.02 * x[2] * x[2], 1.2 * x[1], x[2]]).collect()
    }

    fn twisted(p: &[f64]) -> Vec<f64> {
        let turned = |x: &[f64]| {
            let (s, c) = (if x[0] < 1.5 { 0.0f64 } else { 1.2 }).sin_cos();
            [x[0], c * x[1] - s * x[2], s * x[1] + c * x[2]]
        };
        p.chunks(3).flat_map(turned).collect()
    }

    #[test]
    fn what_is_left_out_lands_where_the_others_alone_take_it() {
        let p = lattice(64);
        let q = sheared(&p);
        for transform in [Transform::Rigid, Transform::Similarity, Transform::Affine] {
            let handles = Handles::new(&weights(&p), transform).unwrap();
            let all = handles.left_out(Pose { q: &q, orientations: None }, 1.0, transform).unwrap();
            for i in [0, 21, 63] {
                let without = |points: &[f64]| [&points[..3 * i], &points[3 * i + 3..]].concat();
                let others = weights(&without(&p));
                let bound =
                    Deformer::new(p[3 * i..][..3].to_vec(), &others, None, transform, &mut |_| true).unwrap();
                let landed = bound.deform(&without(&q), 1.0, false, &mut |_| true).unwrap().positions;
                assert!((distance(&landed, &q[3 * i..][..3]) - all[i]).abs() < 1e-3, "{transform:?} {i}");
            }
        }
    }

    #[test]
    fn affine_maps_are_named_for_a_shear_and_not_for_what_turns() {
        let p = lattice(64);
        let said = |q: &[f64], transform: Transform| {
            let handles = Handles::new(&weights(&p), transform).unwrap();
            handles.stiff(Pose { q, orientations: None }, 1.0).unwrap()
        };
        let found = said(&sheared(&p), Transform::Rigid).unwrap();
        assert!(found.affine < 0.5 * found.now, "{found:?}");
        assert!(said(&sheared(&p), Transform::Similarity).is_some());
        assert_eq!(said(&sheared(&p), Transform::Affine), None);
        assert_eq!(said(&twisted(&p), Transform::Rigid), None);
        assert_eq!(said(&p, Transform::Rigid), None);
    }

    #[test]
    fn nothing_is_said_of_few_control_points() {
        let p = lattice(48);
        let handles = Handles::new(&weights(&p), Transform::Rigid).unwrap();
        assert_eq!(handles.stiff(Pose { q: &sheared(&p), orientations: None }, 1.0).unwrap(), None);
    }
}
