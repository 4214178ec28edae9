//! What an OBJ file holds, counted for a person.

use super::statements::Statement;
use crate::document::Fact;
use crate::error::Error;
use crate::facts::{FaceSizes, Names};

#[derive(Default)]
pub(super) struct Tally<'a> {
    pub faces: FaceSizes,
    objects: Names<'a>,
    groups: Names<'a>,
    materials: Names<'a>,
    libraries: Names<'a>,
    unknown: Names<'a>,
    coloured: usize,
    weighted: usize,
    texture_coordinates: usize,
    lines: usize,
    points: usize,
    free_form: usize,
    comments: usize,
}

impl<'a> Tally<'a> {
    pub(super) fn comment_or_blank(&mut self, statement: &Statement<'a>) {
        self.comments += usize::from(statement.bytes.trim_ascii_start().starts_with(b"#"));
    }

    /// A position of so many numbers.
    pub(super) fn position(&mut self, numbers: usize) {
        self.weighted += usize::from(numbers == 4);
        self.coloured += usize::from(matches!(numbers, 6 | 7));
    }

    /// A statement that is carried over.
    pub(super) fn statement(&mut self, keyword: &'a [u8], statement: &Statement<'a>) -> Result<(), Error> {
        let indent = statement.bytes.len() - statement.bytes.trim_ascii_start().len();
        let rest = statement.bytes[indent + keyword.len()..].trim_ascii();
        match keyword {
            b"vt" => self.texture_coordinates += 1,
            b"o" => self.objects.add(rest)?,
            b"g" => self.groups.add(rest)?,
            b"usemtl" => self.materials.add(rest)?,
            b"mtllib" => self.libraries.add(rest)?,
            b"l" => self.lines += 1,
            b"p" => self.points += 1,
            b"vp" | b"cstype" | b"deg" | b"bmat" | b"step" | b"curv" | b"curv2" | b"surf" | b"parm"
            | b"trim" | b"hole" | b"scrv" | b"sp" | b"end" | b"con" => self.free_form += 1,
            // Smoothing, rendering: known, and nothing to tell.
            b"s" | b"mg" | b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"shadow_obj" | b"trace_obj"
            | b"ctech" | b"stech" | b"usemap" | b"maplib" => {}
            _ => self.unknown.add(keyword)?,
        }
        Ok(())
    }

    pub(super) fn facts(self, normals: usize) -> Vec<Fact> {
        let mut facts = Vec::new();
        self.faces.tell(&mut facts);
        self.objects.tell("objects", &mut facts);
        self.groups.tell("groups", &mut facts);
        self.materials.tell("materials", &mut facts);
        self.libraries.tell("material libraries", &mut facts);
        for (count, name, note) in [
            (self.texture_coordinates, "texture coordinates", ""),
            (normals, "normals", " (turned with the surface)"),
            (self.coloured, "vertex colours", ""),
            (self.weighted, "rational weights", ""),
            (self.lines, "lines", ""),
            (self.points, "point elements", ""),
            (self.free_form, "free-form statements", " (carried over; their control points move)"),
            (self.comments, "comments", ""),
        ] {
            if count > 0 {
                facts.push((name.into(), format!("{count}{note}")));
            }
        }
        self.unknown.tell("unknown statements, carried over", &mut facts);
        facts
    }
}
