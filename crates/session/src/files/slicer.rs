//! 3D Slicer's markups, `.mrk.json` and the older `.fcsv`.
//!
//! Positions are taken as they are written, in LPS or RAS: meshes that Slicer writes are in LPS, and so are markups by default.

use serde_json::{Map, Value};

use super::json::{found, text, vector, Document};
use super::landmarks::{name_of, numbers, Landmarks};
use super::table::cells;
use crate::control_points::ControlPoints;
use crate::error::Error;
use crate::session::{Read, Session};
use crate::text::shown;

/// Where a session keeps the coordinate system of its file.
const SYSTEM: &str = "coordinate_system";
const TAKEN_AS_RAS: &str =
    "the landmarks are in RAS and taken as they are; meshes that Slicer writes are in LPS, with x and y negated";

/// Whether it is a `.mrk.json`.
pub fn is_markups(document: &Value) -> bool {
    document.get("markups").is_some_and(Value::is_array)
}

/// Every control point of every list of a `.mrk.json`.
pub fn read_markups(document: Document) -> Result<Read, Error> {
    if let Some(error) = document.mended {
        return Err(error);
    }
    let mut landmarks = Landmarks::new(3);
    let mut systems: Vec<String> = Vec::new();
    let lists = document.value.get("markups").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    for (i, list) in lists.iter().enumerate() {
        let place = format!("markups[{i}]");
        systems.push(system_of(list.get("coordinateSystem"), &place)?);
        let points = match list.get("controlPoints") {
            Some(Value::Array(points)) => points.as_slice(),
            None => &[],
            other => {
                let found = found(other);
                return Err(Error::file(format!("{place}.controlPoints: expected a list, found {found}")));
            }
        };
        for (j, point) in points.iter().enumerate() {
            let place = format!("{place}.controlPoints[{j}]");
            let Value::Object(point) = point else {
                let found = found(Some(point));
                return Err(Error::file(format!(
                    "{place}: expected an object with a position, found {found}"
                )));
            };
            push(&mut landmarks, point, &place)?;
        }
    }
    systems.dedup();
    if systems.len() > 1 {
        return Err(Error::file(
            "markups: some of the lists are in LPS and some in RAS: expected one of them",
        ));
    }
    finish(landmarks, systems.pop().as_deref())
}

fn push(landmarks: &mut Landmarks, point: &Map<String, Value>, place: &str) -> Result<(), Error> {
    let key = ["label", "id"].into_iter().find(|key| point.get(*key).is_some_and(|text| text != ""));
    let name = match key {
        Some(key) => text(point, key, place)?,
        None => name_of(landmarks.count()),
    };
    match point.get("positionStatus").map(Value::as_str) {
        None | Some(Some("defined")) => {}
        Some(Some(status @ ("undefined" | "missing" | "preview"))) => {
            landmarks.leave_out(name, &format!("its position is {status}"));
            return Ok(());
        }
        Some(_) => {
            let found = found(point.get("positionStatus"));
            let expected = "expected \"defined\", \"undefined\", \"missing\" or \"preview\"";
            return Err(Error::file(format!("{place}.positionStatus: {expected}, found {found}")));
        }
    }
    landmarks.push(name, vector(point, "position", place, Some(3))?, None);
    Ok(())
}

fn system_of(found_in_file: Option<&Value>, place: &str) -> Result<String, Error> {
    match found_in_file.map(|value| (value, value.as_str())) {
        None => Ok("LPS".into()),
        Some((_, Some(system @ ("LPS" | "RAS")))) => Ok(system.into()),
        Some((other, _)) => {
            let found = found(Some(other));
            Err(Error::file(format!("{place}.coordinateSystem: expected \"LPS\" or \"RAS\", found {found}")))
        }
    }
}

/// Whether it is a `.fcsv`.
pub fn is_fiducials(text: &str) -> bool {
    text.trim_start().starts_with("# Markups fiducial file")
        || comments(text).any(|(key, _)| key == "columns")
}

/// `key = value` in the comments that a file begins with.
fn comments(text: &str) -> impl Iterator<Item = (&str, &str)> {
    let head = text.lines().map_while(|line| line.trim_start().strip_prefix('#'));
    head.filter_map(|line| line.split_once('=')).map(|(key, value)| (key.trim(), value.trim()))
}

/// The fiducials of a `.fcsv`.
pub fn read_fiducials(text: &str) -> Result<Read, Error> {
    let comment = |wanted: &str| comments(text).find(|(key, _)| *key == wanted).map(|(_, value)| value);
    let system = match comment("CoordinateSystem") {
        Some("LPS" | "1") => "LPS",
        // Before version 4.10 there was no other, nor a word of it.
        Some("RAS" | "0") | None => "RAS",
        Some(other) => {
            let found = shown(other);
            return Err(Error::file(format!("CoordinateSystem: expected LPS or RAS, found {found}")));
        }
    };
    let columns: Vec<&str> =
        comment("columns").unwrap_or("id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label").split(',').collect();
    let column = |title: &str| columns.iter().position(|column| column.trim().eq_ignore_ascii_case(title));
    let axes = ["x", "y", "z"].map(column);
    let [Some(x), Some(y), Some(z)] = axes else {
        let found = shown(&columns.join(","));
        return Err(Error::file(format!("columns: expected x, y and z among them, found {found}")));
    };
    let names: Vec<usize> = ["label", "id"].into_iter().filter_map(column).collect();
    let mut landmarks = Landmarks::new(3);
    for row in cells(text, ',')? {
        if row.cells[0].starts_with('#') {
            continue;
        }
        let cell = |at: usize| row.cells.get(at).map_or("", |cell| &**cell);
        let name = names.iter().map(|at| cell(*at)).find(|name| !name.is_empty());
        let name = name.map_or_else(|| name_of(landmarks.count()), str::to_string);
        let Some(position) = numbers([x, y, z].map(cell)) else {
            let (line, found) = (row.line, shown(&row.cells.join(",")));
            return Err(Error::file(format!("line {line}: expected numbers for x, y and z, found {found}")));
        };
        landmarks.push(name, position, None);
    }
    finish(landmarks, Some(system))
}

fn finish(mut landmarks: Landmarks, system: Option<&str>) -> Result<Read, Error> {
    if system == Some("RAS") {
        landmarks.notes.push(TAKEN_AS_RAS.into());
    }
    let mut read = landmarks.finish()?;
    if let Some(system) = system {
        read.session.others.insert(SYSTEM.into(), system.into());
    }
    Ok(read)
}

/// Takes the second file's positions to the first's system, where both say in which they are.
pub fn flip(source: &Session, targets: &mut Read) -> Result<(), Error> {
    let system = |session: &Session| match session.others.get(SYSTEM).and_then(Value::as_str) {
        Some("LPS") => Some("LPS"),
        Some("RAS") => Some("RAS"),
        _ => None,
    };
    let (Some(here), Some(there)) = (system(source), system(&targets.session)) else { return Ok(()) };
    if here == there || targets.session.points.dim() != 3 {
        return Ok(());
    }
    let mut list = targets.session.points.to_vec();
    for point in &mut list {
        for place in [&mut point.position, &mut point.target] {
            place[..2].iter_mut().for_each(|c| *c = -*c);
        }
    }
    targets.session.points = ControlPoints::new(3, list)?;
    targets.notes.retain(|note| note != TAKEN_AS_RAS);
    targets
        .notes
        .push(format!("the targets are in {there}: x and y are negated, as the sources are in {here}"));
    Ok(())
}
