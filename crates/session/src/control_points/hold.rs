//! What is held: groups move as one piece, locked control points stay at rest.
//!
//! Targets are kept as they were given. The map takes those of a group to the rigid motion of it that fits them best (a similarity
//! where the transform is one), and gives each of its control points, but for one that has an orientation of its own, the rotation of
//! the group, so that what is around them turns with it. A locked control point has itself at rest for its target, and for its
//! orientation none: it holds what is around it, and if it is in a group, all of the group.

use neuralmls_core::{piece, Aim, Pose, Transform};

use super::{ControlPoint, ControlPoints};
use crate::error::Error;
use crate::orientation::Orientation;
use crate::text::{general, listed, names, quoted};
use crate::words::distance;

/// Where a map takes the control points: to their targets, but for what is held.
#[derive(Clone, Debug, PartialEq)]
pub struct Posed {
    /// m x d.
    pub targets: Vec<f64>,
    /// `s_i R_i` of each, m x d x d row-major, NaN for those that have none; `None` where none has.
    pub orientations: Option<Vec<f64>>,
}

impl Posed {
    /// The same, as the core takes it.
    pub fn pose(&self) -> Pose<'_> {
        Pose { q: &self.targets, orientations: self.orientations.as_deref() }
    }

    /// The same with the targets that were found to aim at.
    pub fn aimed<'a>(&'a self, aim: &'a Aim) -> Pose<'a> {
        Pose { q: &aim.targets, ..self.pose() }
    }
}

impl ControlPoints {
    /// Where a map of this transform takes them.
    pub fn posed(&self, transform: Transform) -> Posed {
        self.hold(Posed { targets: self.targets(), orientations: self.orientations() }, transform)
    }

    /// The same of other targets and orientations, as many.
    pub fn hold(&self, mut posed: Posed, transform: Transform) -> Posed {
        let (dim, pieces) = (self.dim(), self.pieces());
        if pieces.is_empty() {
            return posed;
        }
        let size = dim * dim;
        let orientations = posed.orientations.get_or_insert_with(|| vec![f64::NAN; size * self.len()]);
        for Held { members, stays } in pieces {
            let each =
                |points: &[f64]| members.iter().flat_map(|&i| points[dim * i..][..dim].to_vec()).collect();
            let rest: Vec<f64> = members.iter().flat_map(|&i| self[i].position.iter().copied()).collect();
            let to: Vec<f64> = if stays { rest.clone() } else { each(&posed.targets) };
            let moved = piece(&rest, &to, dim, transform == Transform::Similarity);
            for (&i, place) in members.iter().zip(moved.places.chunks_exact(dim)) {
                posed.targets[dim * i..][..dim].copy_from_slice(place);
                let own = &mut orientations[size * i..][..size];
                if stays || own[0].is_nan() {
                    own.copy_from_slice(&moved.linear);
                }
            }
        }
        posed
    }

    /// Whether each stays at rest: it is locked, or in a group with one that is.
    pub fn stay(&self) -> Vec<bool> {
        let mut stay = vec![false; self.len()];
        for Held { members, stays } in self.pieces() {
            members.iter().for_each(|&i| stay[i] = stays);
        }
        stay
    }

    /// The same, those of these names in this group, or in none.
    ///
    /// # Errors
    /// An argument, where there is no such name; control points, where the group has no name.
    pub fn grouped(&self, names: &[String], group: Option<&str>) -> Result<ControlPoints, Error> {
        let mut list = self.to_vec();
        for name in names {
            list[self.index(name)?].group = group.map(str::to_string);
        }
        ControlPoints::new(self.dim(), list)
    }

    /// The same, those of these names locked, and no others.
    ///
    /// # Errors
    /// An argument, where there is no such name.
    pub fn with_locked(&self, names: &[String]) -> Result<ControlPoints, Error> {
        let mut list = self.to_vec();
        list.iter_mut().for_each(|point| point.locked = false);
        for name in names {
            list[self.index(name)?].locked = true;
        }
        ControlPoints::new(self.dim(), list)
    }

    /// What of the targets that were given holding leaves out, a sentence for each kind: targets and orientations of those that stay,
    /// and those of groups that are no motion of it, if by more than `allowed`.
    pub(crate) fn left_by_holding(&self, posed: &Posed, transform: Transform, allowed: f64) -> Vec<String> {
        let mut left = Vec::new();
        let moved = |i: &usize| self[*i].target != self[*i].position || self[*i].orientation.is_some();
        let (mut staying, mut bent) = (Vec::new(), Vec::new());
        for Held { members, stays } in self.pieces() {
            if stays {
                staying.extend(members.into_iter().filter(moved));
                continue;
            }
            let away = |&i: &usize| distance(&self[i].target, &posed.targets[self.dim() * i..][..self.dim()]);
            let farthest = members.iter().map(away).fold(0.0, f64::max);
            if farthest > allowed {
                let group = quoted(self[members[0]].group.as_deref().unwrap_or_default());
                bent.push(format!("{group} by up to {}", general(farthest, 3)));
            }
        }
        if !staying.is_empty() {
            staying.sort_unstable();
            left.push(format!(
                "locked control points and their groups stay as they are at rest: the targets and rotations of {} are not used",
                names(staying.iter().map(|&i| &*self[i].name))
            ));
        }
        if !bent.is_empty() {
            let motion = if transform == Transform::Similarity { "similarity" } else { "rigid motion" };
            left.push(format!(
                "a group moves as one piece, and its targets are no {motion} of it: control points end off their targets, those of {}",
                listed(bent)
            ));
        }
        left
    }

    /// The places in the list that a name stands for: that of the control point, or those of the group that is called so.
    ///
    /// # Errors
    /// An argument, where there is neither.
    pub(super) fn named(&self, name: &str) -> Result<Vec<usize>, Error> {
        let group: Vec<usize> = (0..self.len()).filter(|&i| self[i].group.as_deref() == Some(name)).collect();
        match self.index(name) {
            Err(error) if group.is_empty() => Err(error),
            Err(_) => Ok(group),
            Ok(index) => Ok(vec![index]),
        }
    }

    /// What is held, the groups in the order of their first control points. A group of one has nothing to hold together.
    fn pieces(&self) -> Vec<Held> {
        let mut pieces: Vec<Held> = Vec::new();
        let mut place_of: std::collections::HashMap<&str, usize> = std::collections::HashMap::new();
        for (i, point) in self.iter().enumerate() {
            let at = match &point.group {
                Some(group) => *place_of.entry(group).or_insert(pieces.len()),
                None => pieces.len(),
            };
            if at == pieces.len() {
                pieces.push(Held { members: Vec::new(), stays: false });
            }
            pieces[at].members.push(i);
            pieces[at].stays |= point.locked;
        }
        pieces.retain(|piece| piece.stays || piece.members.len() > 1);
        pieces
    }
}

/// Turns the targets of a group about their middle, and scales them.
pub(super) fn turn(list: &mut [ControlPoint], members: &[usize], orientation: &Orientation, dim: usize) {
    let linear = orientation.rotation(dim);
    let count = members.len() as f64;
    let middle: Vec<f64> =
        (0..dim).map(|k| members.iter().map(|&i| list[i].target[k] / count).sum()).collect();
    for &i in members {
        let arm: Vec<f64> = (0..dim).map(|k| list[i].target[k] - middle[k]).collect();
        for (k, c) in list[i].target.iter_mut().enumerate() {
            let turned: f64 = (0..dim).map(|l| linear[dim * k + l] * arm[l]).sum();
            *c = middle[k] + orientation.scale * turned;
        }
    }
}

/// Control points that move as one.
struct Held {
    /// Their places in the list.
    members: Vec<usize>,
    /// Whether one of them is locked, and with it all.
    stays: bool,
}

#[cfg(test)]
mod tests;
