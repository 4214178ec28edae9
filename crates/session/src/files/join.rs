//! Two files, source and target, joined into one session.

use std::collections::{HashMap, HashSet};

use super::slicer;
use crate::control_points::{ControlPoint, ControlPoints};
use crate::error::Error;
use crate::session::{Read, Session};
use crate::text;

/// Joins two files: the control points of the one, with the positions of the other as their targets, by name or by order.
///
/// Everything but the targets is the first file's. What has no partner is left out and listed in the notes, after those of both
/// files.
///
/// # Errors
/// Control points, where they have nothing in common or other dimensions.
pub fn join(source: Read, mut targets: Read, by_order: bool) -> Result<Read, Error> {
    let (dim, other) = (source.session.points.dim(), targets.session.points.dim());
    if dim != other {
        let message = format!("the sources have {dim} coordinates each, but the targets have {other}");
        return Err(Error::control_point(message));
    }
    slicer::flip(&source.session, &mut targets)?;
    let partners =
        if by_order { by_place(&source, &targets) } else { by_name(&source.session, &targets.session) };
    let (here, there) = (&source.session.points, &targets.session.points);
    let partner = |(point, partner): (&ControlPoint, &Option<usize>)| {
        Some(ControlPoint { target: there[(*partner)?].position.clone(), ..point.clone() })
    };
    let mut list: Vec<ControlPoint> = here.iter().zip(&partners).filter_map(partner).collect();
    if list.is_empty() {
        return Err(Error::control_point(if by_order {
            "no landmark of the sources has a partner at its place among the targets"
        } else {
            "no name is in both the sources and the targets: to join them by their order, use --by-order"
        }));
    }
    let names: HashSet<String> = list.iter().map(|point| point.name.clone()).collect();
    for point in &mut list {
        point.mirror_of = point.mirror_of.take().filter(|twin| names.contains(twin));
    }

    let mut notes = [source.notes, targets.notes].concat();
    for (which, points) in [("sources", here), ("targets", there)] {
        if points.iter().any(|point| point.target != point.position) {
            notes.push(format!("the file of the {which} has targets of its own: they are passed over"));
        }
    }
    let taken: HashSet<usize> = partners.iter().flatten().copied().collect();
    let is_alone = |points: &ControlPoints, alone: &dyn Fn(usize) -> bool| -> Vec<String> {
        let each = points.iter().enumerate().filter(|(i, _)| alone(*i));
        each.map(|(_, point)| point.name.clone()).collect()
    };
    for (names, whose, of) in [
        (is_alone(here, &|i| partners[i].is_none()), "sources", "targets"),
        (is_alone(there, &|i| !taken.contains(&i)), "targets", "sources"),
    ] {
        if !names.is_empty() {
            let (s, are) = if names.len() == 1 { ("", "is") } else { ("s", "are") };
            let names = text::names(names.iter().map(String::as_str));
            notes.push(format!("landmark{s} {names} of the {whose} {are} left out: not among the {of}"));
        }
    }
    let session = Session { points: ControlPoints::new(dim, list)?, ..source.session };
    Ok(Read { session, notes, left_out: Vec::new() })
}

/// For each of the sources its partner's index, if it has one.
fn by_name(source: &Session, targets: &Session) -> Vec<Option<usize>> {
    let places: HashMap<&str, usize> =
        targets.points.iter().enumerate().map(|(i, point)| (&*point.name, i)).collect();
    source.points.iter().map(|point| places.get(&*point.name).copied()).collect()
}

/// Landmarks that are left out keep their place: what comes after them must not move up.
fn by_place(source: &Read, targets: &Read) -> Vec<Option<usize>> {
    let index: HashMap<usize, usize> =
        places(targets).into_iter().enumerate().map(|(i, place)| (place, i)).collect();
    places(source).iter().map(|place| index.get(place).copied()).collect()
}

/// The places in the file of those that were read.
fn places(read: &Read) -> Vec<usize> {
    let left_out: HashSet<usize> = read.left_out.iter().copied().collect();
    let all = 0..read.session.points.len() + left_out.len();
    all.filter(|place| !left_out.contains(place)).collect()
}
