//! One control point of a session file.

use serde_json::{Map, Value};

use super::style::found;
use super::values::{number, text, vector};
use crate::control_points::ControlPoint;
use crate::error::Error;
use crate::orientation::Orientation;

/// Keys that mean nothing in a file of version 1.
pub const NEW_KEYS: [&str; 3] = ["weight", "mirror_of", "group"];

/// The control point of these keys; `dim`: that of those before it.
pub fn control_point(
    mut keys: Map<String, Value>,
    place: &str,
    dim: Option<usize>,
) -> Result<ControlPoint, Error> {
    let name = text(&keys, "name", place)?;
    let position = vector(&keys, "position", place, dim)?;
    let dim = position.len();
    let mut point = ControlPoint::new(name, position);
    if keys.contains_key("target") {
        point.target = vector(&keys, "target", place, Some(dim))?;
    }
    point.orientation = orientation(&keys, place, dim)?;
    if keys.contains_key("weight") {
        point.weight = number(&keys, "weight", place)?;
    }
    if let Some(locked) = keys.get("locked") {
        let Value::Bool(locked) = locked else {
            let found = found(Some(locked));
            return Err(Error::file(format!("{place}.locked: expected true or false, found {found}")));
        };
        point.locked = *locked;
    }
    for (key, into) in [("mirror_of", &mut point.mirror_of), ("group", &mut point.group)] {
        if keys.get(key).is_some_and(|value| !value.is_null()) {
            *into = Some(text(&keys, key, place)?);
        }
    }
    for key in ["name", "position", "target", "scale", "weight", "locked", "mirror_of", "group"] {
        keys.shift_remove(key);
    }
    // Other programs' keys beside the axis and the angle.
    if let Some(Value::Object(rotation)) = keys.get_mut("rotation") {
        rotation.shift_remove("degrees");
        if dim == 3 {
            rotation.shift_remove("axis");
        }
        if rotation.is_empty() {
            keys.shift_remove("rotation");
        }
    }
    point.others = keys;
    Ok(point)
}

fn orientation(keys: &Map<String, Value>, place: &str, dim: usize) -> Result<Option<Orientation>, Error> {
    if !keys.contains_key("rotation") && !keys.contains_key("scale") {
        return Ok(None);
    }
    let (mut axis, mut degrees, mut scale) = (vec![0.0, 0.0, 1.0], 0.0, 1.0);
    if let Some(rotation) = keys.get("rotation") {
        let place = format!("{place}.rotation");
        if dim == 1 {
            return Err(Error::file(format!("{place}: a control point on a line has none")));
        }
        let Value::Object(inner) = rotation else {
            let expected = if dim == 3 { "axis and degrees" } else { "degrees" };
            let found = found(Some(rotation));
            return Err(Error::file(format!("{place}: expected an object with {expected}, found {found}")));
        };
        if dim == 3 {
            axis = vector(inner, "axis", &place, Some(3))?;
        }
        degrees = number(inner, "degrees", &place)?;
    }
    if keys.contains_key("scale") {
        scale = number(keys, "scale", place)?;
    }
    let [x, y, z] = axis[..] else { unreachable!("three numbers were read") };
    Orientation::new([x, y, z], degrees, scale).map(Some).map_err(|error| error.at(place))
}
