//! Two files, source and target, joined into one session.

use std::collections::{HashMap, HashSet};

use crate::control_points::{ControlPoint, ControlPoints};
use crate::error::Error;
use crate::session::{Read, Session};
use crate::text::listed;

/// Joins two files: the control points of the one, with the positions of the other as their targets, by name or by order.
///
/// Everything but the targets is the first file's. What has no partner is left out and listed in the notes.
///
/// # Errors
/// Control points, where they have nothing in common or other dimensions.
pub fn join(source: Session, targets: Session, by_order: bool) -> Result<Read, Error> {
    let (dim, other) = (source.points.dim(), targets.points.dim());
    if dim != other {
        let message = format!("the sources have {dim} coordinates each, but the targets have {other}");
        return Err(Error::control_point(message));
    }
    let mut notes = Vec::new();
    for (which, session) in [("sources", &source), ("targets", &targets)] {
        if session.points.iter().any(|point| point.target != point.position) {
            notes.push(format!("the file of the {which} has targets of its own: they are passed over"));
        }
    }
    let flip = super::slicer::flip(&source, &targets, &mut notes);
    let place = |point: &ControlPoint| -> Vec<f64> {
        point.position.iter().zip(flip).map(|(c, by)| c * by).collect()
    };
    let places: HashMap<&str, Vec<f64>> =
        targets.points.iter().map(|point| (&*point.name, place(point))).collect();
    let mut found = Vec::new();
    let mut alone = Vec::new();
    let mut list = Vec::new();
    for (i, point) in source.points.iter().enumerate() {
        let partner = if by_order { targets.points.get(i) } else { None };
        let target = if by_order { partner.map(&place) } else { places.get(&*point.name).cloned() };
        match target {
            Some(target) => {
                found.push(partner.map_or(&*point.name, |partner| &*partner.name));
                list.push(ControlPoint { target, ..point.clone() });
            }
            None => alone.push(&*point.name),
        }
    }
    if list.is_empty() {
        let message =
            "no name is in both the sources and the targets: to join them by their order, use --by-order";
        return Err(Error::control_point(message));
    }
    let found: HashSet<&str> = found.into_iter().collect();
    let others = targets.points.iter().map(|point| &*point.name).filter(|name| !found.contains(name));
    for (names, whose, of) in [(alone, "sources", "targets"), (others.collect(), "targets", "sources")] {
        if !names.is_empty() {
            let (s, are) = if names.len() == 1 { ("", "is") } else { ("s", "are") };
            let names = listed(names);
            notes.push(format!("landmark{s} {names} of the {whose} {are} left out: not among the {of}"));
        }
    }
    let names: HashSet<String> = list.iter().map(|point| point.name.clone()).collect();
    for point in &mut list {
        point.mirror_of = point.mirror_of.take().filter(|twin| names.contains(twin));
    }
    Ok(Read { session: Session { points: ControlPoints::new(dim, list)?, ..source }, notes })
}
