//! What a PLY file holds besides, for a person to read.

use super::faces::Faces;
use super::header::{Element, Encoding, Header, Kind};
use super::scalar::ByteOrder;
use super::{Body, Vertices};
use crate::document::Fact;
use crate::facts::SPLATS_MOVE;
use crate::text::printable;

pub(super) fn of(header: &Header, vertices: &Vertices, faces: &Faces, body: &Body) -> Vec<Fact> {
    let mut facts = Vec::new();
    let mut say = |what: &str, value: String| facts.push((what.to_string(), value));
    say(
        "encoding",
        match header.encoding {
            Encoding::Ascii => "ascii",
            Encoding::Binary(ByteOrder::Little) => "binary, little endian",
            Encoding::Binary(ByteOrder::Big) => "binary, big endian",
        }
        .into(),
    );
    faces.sizes.tell(&mut facts);
    let mut say = |what: &str, value: String| facts.push((what.to_string(), value));
    if faces.strips > 0 {
        say("triangle strips", faces.strips.to_string());
    }
    if let Some(scalar) = vertices.scalars[..3].iter().find(|scalar| scalar.is_integer()) {
        say("positions", format!("whole numbers ({}): written rounded to the nearest", scalar.name()));
    }
    if vertices.normals {
        say("normals", "turned with the surface".into());
    }
    let is_splat = ["f_dc_0", "scale_0", "rot_0"].iter().all(|name| vertices.element.find(name).is_some());
    if is_splat {
        say("splats", SPLATS_MOVE.into());
    }
    let others = names_of(&vertices.element, |index| match vertices.slots[index] {
        // Incomplete normals do not turn.
        Some(slot) => slot >= 3 && !vertices.normals,
        None => true,
    });
    if !others.is_empty() {
        say("vertex properties", format!("{others} (carried over)"));
    }
    let besides = |(index, _): &(usize, &Element)| *index != vertices.index;
    for (index, element) in header.elements.iter().enumerate().filter(besides) {
        let corners = faces.wanted(index).map(|(_, property)| property);
        let properties = names_of(element, |property| corners != Some(property));
        if corners.is_none() {
            say("element", format!("{} {}: {properties} (carried over)", element.count, element.name));
        } else if !properties.is_empty() {
            say(&format!("{} properties", element.name), format!("{properties} (carried over)"));
        }
        if corners.is_some() && element.find("nx").is_some() {
            say("face normals", "carried over as they are, not turned".into());
        }
    }
    if let Some(texture) = &header.texture {
        say("texture", printable(texture.as_bytes()));
    }
    if header.comments > 0 {
        say("comments", header.comments.to_string());
    }
    if body.longer > 0 {
        say("more than the header says", format!("on {} lines (carried over)", body.longer));
    }
    if body.extra > 0 {
        say("behind the last element", format!("{} bytes (carried over)", body.extra));
    }
    facts
}

/// The names of an element's properties, runs of numbered ones (`f_rest_0 to f_rest_44`) in short.
fn names_of(element: &Element, take: impl Fn(usize) -> bool) -> String {
    let stem = |name: &str| name.trim_end_matches(|c: char| c.is_ascii_digit()).to_string();
    const LONGEST: usize = 400;
    let taken: Vec<_> =
        element.properties.iter().enumerate().filter(|(i, _)| take(*i)).map(|(_, p)| p).collect();
    let mut names = taken
        .chunk_by(|a, b| stem(&a.name) == stem(&b.name) && stem(&a.name) != a.name)
        .map(|run| match run {
            [one] if matches!(one.kind, Kind::List { .. }) => format!("{} (list)", one.name),
            [first, .., last] if run.len() > 2 => format!("{} to {}", first.name, last.name),
            _ => run.iter().map(|p| p.name.as_str()).collect::<Vec<_>>().join(", "),
        })
        .collect::<Vec<_>>()
        .join(", ");
    if let Some((end, _)) = names.char_indices().nth(LONGEST) {
        names.truncate(end);
        names += "...";
    }
    names
}
