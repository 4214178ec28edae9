//! MeshLab's picked points, `.pp`.

use roxmltree::{Document, Node, ParsingOptions};

use super::landmarks::{name_of, numbers, Landmarks};
use crate::error::Error;
use crate::session::Read;
use crate::text::{quoted, shown};

/// More than any person picks; entities could make as many of a short text.
const MOST_NODES: u32 = 1_000_000;

/// The points that are active.
pub fn read(text: &str) -> Result<Read, Error> {
    let options = ParsingOptions { allow_dtd: true, nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| sentence(&error))?;
    let root = document.root_element();
    if root.tag_name().name() != "PickedPoints" {
        let found = shown(root.tag_name().name());
        let message =
            format!("expected MeshLab's <PickedPoints>, found XML of <{found}>: another kind of file");
        return Err(Error::file(message));
    }
    let mut landmarks = Landmarks::new(3);
    for point in root.descendants().filter(|node| node.has_tag_name("point")) {
        push(&mut landmarks, point)?;
    }
    landmarks.finish()
}

fn sentence(error: &roxmltree::Error) -> Error {
    if matches!(error, roxmltree::Error::UnexpectedEndOfStream) {
        return Error::file("not XML: the file ends before its elements do");
    }
    let (at, words) = (error.pos(), error.to_string());
    let words = shown(words.split(" at ").next().unwrap_or_default());
    Error::file(format!("line {}, column {}: not XML: {words}", at.row, at.col))
}

fn push(landmarks: &mut Landmarks, point: Node<'_, '_>) -> Result<(), Error> {
    let name = point.attribute("name").map(str::trim).filter(|name| !name.is_empty());
    let name = name.map_or_else(|| name_of(landmarks.count()), str::to_string);
    if point.attribute("active") == Some("0") {
        landmarks.leave_out(name, "it is not active");
        return Ok(());
    }
    let axes = ["x", "y", "z"];
    let Some(position) = numbers(axes.map(|axis| point.attribute(axis).unwrap_or_default().trim())) else {
        let line = point.document().text_pos_at(point.range().start).row;
        let found: Vec<String> = axes
            .iter()
            .map(|axis| format!("{axis}=\"{}\"", point.attribute(*axis).unwrap_or_default()))
            .collect();
        let (name, found) = (quoted(&name), shown(&found.join(" ")));
        return Err(Error::file(format!(
            "line {line}: expected numbers for x, y and z of {name}, found {found}"
        )));
    };
    landmarks.push(name, position, None);
    Ok(())
}
