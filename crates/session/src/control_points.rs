//! Control points: where a shape is held (sources, `p`) and where they are moved to (targets, `q`).

use std::collections::HashMap;
use std::ops::Deref;

use crate::error::Error;
use crate::orientation::Orientation;
use crate::text::{float, general, number, quoted, shown, tuple};
use serde_json::{Map, Value};

mod axes;
mod check;
mod fit;
mod hold;
mod placed;

pub use hold::Posed;

/// One control point, in the coordinates of the shape's file.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlPoint {
    /// What the user calls it.
    pub name: String,
    /// Where it is at rest.
    pub position: Vec<f64>,
    /// Where it is moved to.
    pub target: Vec<f64>,
    /// How it is turned and scaled; without it, it only moves, and does not resist turning.
    pub orientation: Option<Orientation>,
    /// How closely it is to be met, 0 to 1, of what `handles` asks of all.
    pub weight: f64,
    /// Whether it stays as it is at rest, and holds what is around it.
    pub locked: bool,
    /// The name of the control point whose mirror image it is.
    pub mirror_of: Option<String>,
    /// What it moves with as one piece: all control points of the same group.
    pub group: Option<String>,
    /// Keys of other programs, kept.
    pub others: Map<String, Value>,
}

impl ControlPoint {
    /// A control point that stays where it is.
    pub fn new(name: impl Into<String>, position: Vec<f64>) -> Self {
        ControlPoint {
            name: name.into(),
            target: position.clone(),
            position,
            orientation: None,
            weight: 1.0,
            locked: false,
            mirror_of: None,
            group: None,
            others: Map::new(),
        }
    }
}

/// Control points of one shape: at least one, of the same dimension, finite, each name and each place once.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlPoints {
    dim: usize,
    list: Vec<ControlPoint>,
}

impl Deref for ControlPoints {
    type Target = [ControlPoint];

    fn deref(&self) -> &[ControlPoint] {
        &self.list
    }
}

impl ControlPoints {
    /// The checked list.
    ///
    /// # Errors
    /// Control points, where there are none, or one cannot be used.
    pub fn new(dim: usize, list: Vec<ControlPoint>) -> Result<Self, Error> {
        if list.is_empty() {
            return Err(Error::control_point("there are no control points; at least one is needed"));
        }
        if !(1..=3).contains(&dim) {
            let message = format!("expected sources of shape (m, d) with d = 1, 2 or 3, found d = {dim}");
            return Err(Error::control_point(message));
        }
        check_names(&list)?;
        for (what, of) in [
            ("position", (|point| &point.position) as fn(&ControlPoint) -> &Vec<f64>),
            ("target", |point| &point.target),
        ] {
            for point in &list {
                check_coordinates(what, of(point), &point.name, dim)?;
            }
        }
        check_distinct(&list)?;
        for point in &list {
            check_rest(point, dim)?;
        }
        let points = ControlPoints { dim, list };
        points.check_twins()?;
        Ok(points)
    }

    /// The number of coordinates of each: 1, 2 or 3.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// The list, to change and to check again.
    pub fn into_list(self) -> Vec<ControlPoint> {
        self.list
    }

    /// The control points at rest, m x d.
    pub fn sources(&self) -> Vec<f64> {
        self.list.iter().flat_map(|point| point.position.iter().copied()).collect()
    }

    /// The control points moved, m x d.
    pub fn targets(&self) -> Vec<f64> {
        self.list.iter().flat_map(|point| point.target.iter().copied()).collect()
    }

    /// `s_i R_i` of each, m x d x d row-major, NaN for those that have none; `None` where none has.
    pub fn orientations(&self) -> Option<Vec<f64>> {
        let dim = self.dim;
        self.list.iter().any(|point| point.orientation.is_some()).then(|| {
            let of = |point: &ControlPoint| match &point.orientation {
                Some(orientation) => {
                    orientation.rotation(dim).iter().map(|c| orientation.scale * c).collect()
                }
                None => vec![f64::NAN; dim * dim],
            };
            self.list.iter().flat_map(of).collect()
        })
    }

    /// The orientations of those that turn by them as rotation vectors, m x 3, NaN for others; `None` where none does.
    pub fn turns(&self) -> Option<Vec<f64>> {
        let of = |(point, stays): (&ControlPoint, bool)| match point.orientation.filter(|_| !stays) {
            Some(orientation) => orientation.vector(),
            None => [f64::NAN; 3],
        };
        self.list
            .iter()
            .any(|point| point.orientation.is_some())
            .then(|| self.list.iter().zip(self.stay()).flat_map(of).collect())
    }

    /// How closely each is to be met.
    pub fn weights(&self) -> Vec<f64> {
        self.list.iter().map(|point| point.weight).collect()
    }

    /// The place of a name in the list.
    ///
    /// # Errors
    /// An argument, where there is none; the sentence has the name that is nearest.
    pub fn index(&self, name: &str) -> Result<usize, Error> {
        if let Some(index) = self.list.iter().position(|point| point.name == name) {
            return Ok(index);
        }
        // Distances take the product of the lengths.
        let likeness = |other: &str| match name.len().max(other.len()) {
            0..=1000 => strsim::normalized_damerau_levenshtein(name, other),
            _ => 0.0,
        };
        let nearest = self.list.iter().map(|point| (likeness(&point.name), &point.name));
        let nearest = nearest.reduce(|best, next| if next.0 > best.0 { next } else { best });
        let nearest = quoted(nearest.map_or("", |(_, name)| name));
        let message = format!("there is no control point {}; the nearest name is {nearest}", quoted(name));
        Err(Error::argument(message))
    }

    /// The same with other targets, m x d.
    ///
    /// # Errors
    /// Control points, where there are not so many, or a number is not finite.
    pub fn with_targets(&self, targets: &[f64]) -> Result<ControlPoints, Error> {
        let expected = self.list.len() * self.dim;
        if targets.len() != expected {
            let found = targets.len();
            let message = format!("expected as many targets as sources, {expected} numbers, found {found}");
            return Err(Error::control_point(message));
        }
        let mut list = self.list.clone();
        for (point, target) in list.iter_mut().zip(targets.chunks_exact(self.dim)) {
            point.target = target.to_vec();
        }
        ControlPoints::new(self.dim, list)
    }

    /// The same, the target of one, or of a group, moved by an offset.
    ///
    /// # Errors
    /// An argument, where there is no such name, or the offset is not of d finite numbers.
    pub fn moved(&self, name: &str, offset: &[f64]) -> Result<ControlPoints, Error> {
        let members = self.named(name)?;
        let dim = self.dim;
        if offset.len() != dim || offset.iter().any(|c| !c.is_finite()) {
            let found = shown(&tuple(offset, number));
            let message = format!("{} needs {dim} finite numbers to move by, found {found}", quoted(name));
            return Err(Error::argument(message));
        }
        let mut list = self.list.clone();
        for i in members {
            list[i].target.iter_mut().zip(offset).for_each(|(c, by)| *c += by);
        }
        ControlPoints::new(dim, list)
    }

    /// The same, one oriented further than it is, or the targets of a group turned about their middle.
    ///
    /// # Errors
    /// An argument, where there is no such name, or it cannot be oriented so.
    pub fn oriented(&self, name: &str, orientation: Orientation) -> Result<ControlPoints, Error> {
        let members = self.named(name)?;
        if !orientation.fits(self.dim) {
            let how = if self.dim == 1 {
                "on a line: it cannot turn"
            } else {
                "in the plane: it turns about no axis"
            };
            return Err(Error::argument(format!("{} is {how}", quoted(name))));
        }
        let mut list = self.list.clone();
        match members[..] {
            [index] if list[index].name == name => {
                let before = &mut list[index].orientation;
                *before = Some(before.map_or(orientation, |before| before.then(&orientation)));
            }
            _ => hold::turn(&mut list, &members, &orientation, self.dim),
        }
        ControlPoints::new(self.dim, list)
    }

    fn check_twins(&self) -> Result<(), Error> {
        let names: HashMap<&str, &ControlPoint> =
            self.list.iter().map(|point| (&*point.name, point)).collect();
        for point in &self.list {
            let Some(twin) = &point.mirror_of else { continue };
            let what = match names.get(&**twin) {
                Some(_) if *twin == point.name => "itself".to_string(),
                Some(_) => continue,
                None => format!("{}, which is not there", quoted(twin)),
            };
            let message = format!("{} is said to be the mirror image of {what}", quoted(&point.name));
            return Err(Error::control_point(message));
        }
        Ok(())
    }
}

fn check_names(list: &[ControlPoint]) -> Result<(), Error> {
    let mut seen = std::collections::HashSet::new();
    for (i, point) in list.iter().enumerate() {
        if point.name.trim().is_empty() {
            return Err(Error::control_point(format!("control point {} has no name", i + 1)));
        }
        if !seen.insert(&*point.name) {
            let message = format!("the name {} is given to more than one control point", quoted(&point.name));
            return Err(Error::control_point(message));
        }
    }
    Ok(())
}

fn check_coordinates(what: &str, values: &[f64], name: &str, dim: usize) -> Result<(), Error> {
    let name = quoted(name);
    if values.len() != dim {
        let found = values.len();
        return Err(Error::control_point(format!("the {what} of {name} has {found} coordinates, not {dim}")));
    }
    if values.iter().any(|c| !c.is_finite()) {
        let found = tuple(values, float);
        return Err(Error::control_point(format!("the {what} of {name} is not finite: {found}")));
    }
    Ok(())
}

fn check_distinct(list: &[ControlPoint]) -> Result<(), Error> {
    let mut seen: HashMap<Vec<u64>, &str> = HashMap::new();
    for point in list {
        // -0 and 0 are the same place.
        let place = point.position.iter().map(|c| (c + 0.0).to_bits()).collect();
        if let Some(other) = seen.insert(place, &point.name) {
            let (other, name) = (quoted(other), quoted(&point.name));
            let at = tuple(&point.position, |c| general(c + 0.0, 9));
            return Err(Error::control_point(format!("{other} and {name} are at the same place, {at}")));
        }
    }
    Ok(())
}

fn check_rest(point: &ControlPoint, dim: usize) -> Result<(), Error> {
    let name = quoted(&point.name);
    if let Some(orientation) = &point.orientation {
        let Orientation { axis, degrees, scale } = *orientation;
        Orientation::new(axis, degrees, scale).map_err(|e| Error::control_point(format!("{name}: {e}")))?;
        if !orientation.fits(dim) {
            let how = if dim == 1 { "turn" } else { "turn about an axis" };
            let s = if dim == 1 { "" } else { "s" };
            return Err(Error::control_point(format!("{name} has {dim} coordinate{s}, and cannot {how}")));
        }
    }
    if point.group.as_ref().is_some_and(|group| group.trim().is_empty()) {
        return Err(Error::control_point(format!("the group of {name} has no name")));
    }
    if !(0.0..=1.0).contains(&point.weight) {
        let found = number(point.weight);
        let message =
            format!("the weight of {name} is {found}: expected a number of at least 0 and at most 1");
        return Err(Error::control_point(message));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
