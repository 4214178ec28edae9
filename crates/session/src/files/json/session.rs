//! The document of a session file.

use serde_json::{Map, Value};

use super::parse::{Document, STAND_IN};
use super::settings::{object, read_settings};
use super::style::{found, kind};
use super::values::{keep, passed_over, vector};
use super::{editor, entry, FORMAT};
use crate::control_points::{ControlPoint, ControlPoints};
use crate::error::Error;
use crate::session::{Bounds, Read, Session};
use crate::text::names;

/// What a file of an older version may hold as another program's keys, and means something in this one.
const NEW_KEYS: [&str; 2] = ["settings", "frame"];

/// The session that a JSON document holds. Keys that are not known are kept.
pub(crate) fn session_of(document: Document) -> Result<Read, Error> {
    let Document { value, mended } = document;
    let Value::Object(mut keys) = value else {
        return Err(Error::file(format!("expected a JSON object, found {}", kind(&value))));
    };
    if keys.get("format").and_then(Value::as_str) != Some(FORMAT) {
        let found = found(keys.get("format"));
        return Err(Error::file(format!("format: expected \"{FORMAT}\", found {found}")));
    }
    let version = match keys.get("version") {
        Some(Value::Number(number)) if number.as_f64() == Some(1.0) => 1,
        Some(Value::Number(number)) if number.as_f64() == Some(2.0) => 2,
        other => return Err(Error::file(format!("version: expected 1 or 2, found {}", found(other)))),
    };
    let list = match keys.get("control_points") {
        Some(Value::Array(list)) if !list.is_empty() => list.clone(),
        other => {
            let found = found(other);
            let expected = "expected a list with at least one control point";
            return Err(Error::file(format!("control_points: {expected}, found {found}")));
        }
    };
    let mut notes = Vec::new();
    let mut list = entries(&list, version, &mut notes)?;
    if mended.is_some() {
        check_surrogates(&list)?;
    }
    let dim = list[0].position.len();
    for key in ["format", "version", "control_points"] {
        keys.shift_remove(key);
    }
    let mut session = if version == 1 {
        for key in NEW_KEYS {
            if keys.shift_remove(key).is_some() {
                notes.push(passed_over(key));
            }
        }
        editor::session_of(&mut keys, &mut list, dim, &mut notes)?
    } else {
        let mut session = Session::new(ControlPoints::new(dim, list)?);
        take_settings(&mut session, &mut keys)?;
        session
    };
    // Numbers that are not finite in a place where no number is looked at.
    if let Some(error) = mended {
        return Err(error);
    }
    session.others.extend(keys);
    Ok(Read { session, notes, left_out: Vec::new() })
}

fn entries(list: &[Value], version: u8, notes: &mut Vec<String>) -> Result<Vec<ControlPoint>, Error> {
    let mut points: Vec<ControlPoint> = Vec::with_capacity(list.len());
    let mut new_keys = Vec::new();
    for (i, found) in list.iter().enumerate() {
        let place = format!("control_points[{i}]");
        let Value::Object(keys) = found else {
            let expected = "expected an object with a name and a position";
            return Err(Error::file(format!("{place}: {expected}, found {}", kind(found))));
        };
        let mut keys = keys.clone();
        if version == 1 {
            let known = entry::NEW_KEYS.into_iter().filter(|key| keys.shift_remove(*key).is_some());
            new_keys.extend(known);
        }
        let dim = points.first().map(|point| point.position.len());
        points.push(entry::control_point(keys, &place, dim)?);
    }
    if version == 1 {
        notes.extend(free_what_was_moved(&mut points));
    }
    notes.extend(entry::NEW_KEYS.into_iter().filter(|key| new_keys.contains(key)).map(passed_over));
    Ok(points)
}

/// In version 1 the lock only kept the editor from control points, moved ones among them, which would go back to rest by today's.
fn free_what_was_moved(points: &mut [ControlPoint]) -> Option<String> {
    let mut freed = Vec::new();
    for point in points.iter_mut().filter(|point| point.locked) {
        if point.target != point.position || point.orientation.is_some() {
            point.locked = false;
            freed.push(&*point.name);
        }
    }
    (!freed.is_empty()).then(|| {
        format!(
            "the lock of {} is left out: in version 1 it kept what was moved where it was, now it would take it back to rest",
            names(freed)
        )
    })
}

fn take_settings(session: &mut Session, keys: &mut Map<String, Value>) -> Result<(), Error> {
    if let Some(found) = keys.shift_remove("settings") {
        let (settings, rest) =
            read_settings(object(&found, "settings")?).map_err(|error| error.at("settings"))?;
        session.settings = settings;
        session.has_settings = true;
        keep(session, "settings", rest);
    }
    if let Some(found) = keys.shift_remove("frame") {
        let mut corners = object(&found, "frame")?;
        let dim = session.points.dim();
        let [min, max] = ["min", "max"].map(|key| vector(&corners, key, "frame", Some(dim)));
        let frame = Bounds::new(min?, max?, dim).map_err(|error| Error::file(error.message))?;
        session.frame = Some(frame);
        corners.shift_remove("min");
        corners.shift_remove("max");
        keep(session, "frame", corners);
    }
    Ok(())
}

fn check_surrogates(list: &[ControlPoint]) -> Result<(), Error> {
    match list.iter().position(|point| point.name.contains(STAND_IN)) {
        None => Ok(()),
        Some(i) => {
            let message = format!("the name of control point {} has half of a surrogate pair in it", i + 1);
            Err(Error::control_point(message))
        }
    }
}
