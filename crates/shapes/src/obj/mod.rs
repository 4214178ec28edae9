//! Wavefront OBJ: statements of one line each (or of several, joined by `\`), named by their first word.
//!
//! Positions (`v`), normals (`vn`) and faces (`f`) are understood; anything else is carried over as it is. Nothing but
//! the positions and a triangulated view of the faces is kept in memory: to write, the file is gone through again.

mod corner;
mod statements;
mod tally;
mod turned;
mod write;

use crate::document::Parsed;
use crate::error::Error;
use crate::memory;
use crate::number;
use crate::text::quote;
use corner::Corner;
use statements::{Statement, Statements, Words};
use tally::Tally;
use write::Obj;

/// What reading gathers.
#[derive(Default)]
struct Reader {
    positions: Vec<f64>,
    triangles: Vec<[u32; 3]>,
    faces: usize,
    /// Digits behind the point of the most precise coordinate.
    decimals: usize,
    normals: usize,
    /// The highest position that a face names (from 0), and its line: it may be defined further down.
    furthest: Option<(u32, u64)>,
    /// The highest normal that a face names, from 0.
    furthest_normal: Option<u32>,
    /// What `mtllib` statements name.
    libraries: Vec<String>,
    /// Whether something names normals that cannot be renumbered.
    fixed_normals: bool,
}

pub(crate) fn read(source: &[u8]) -> Result<Parsed, Error> {
    let mut reader = Reader::default();
    let mut tally = Tally::default();
    for statement in Statements::new(source) {
        let mut words = statement.words();
        let Some(keyword) = words.next() else {
            tally.comment_or_blank(&statement);
            continue;
        };
        let rest = keyword.end;
        match &statement.bytes[keyword] {
            b"v" => tally.position(reader.position(&statement, words)?),
            b"vn" => reader.normals += 1,
            b"f" | b"fo" => tally.faces.add(reader.face(&statement, words)?),
            other => {
                // Surfaces name normals too.
                reader.fixed_normals |= other == b"surf";
                if other == b"mtllib" {
                    let names = statement.bytes[rest..].trim_ascii();
                    memory::push(&mut reader.libraries, String::from_utf8_lossy(names).into_owned())?;
                }
                tally.statement(other, &statement)?;
            }
        }
    }
    let count = reader.positions.len() / 3;
    if let Some((index, line)) = reader.furthest.filter(|&(index, _)| index as usize >= count) {
        return Err(Error::at_line(
            line,
            format!("a face names vertex {}, but the file has {count}", u64::from(index) + 1),
        ));
    }
    let in_range = reader.furthest_normal.is_none_or(|index| (index as usize) < reader.normals);
    let document = Obj {
        decimals: reader.decimals,
        has_normals: reader.normals > 0,
        may_split: in_range && !reader.fixed_normals,
        libraries: reader.libraries,
        by_vertex: reader.normals == count && reader.furthest_normal.is_none() && !reader.fixed_normals,
    };
    Ok(Parsed {
        dim: 3,
        positions: reader.positions,
        faces: (reader.faces > 0).then_some(reader.triangles),
        facts: tally.facts(reader.normals),
        document: Box::new(document),
    })
}

impl Reader {
    /// Reads a `v`, whose `words` follow, and returns how many numbers it has.
    fn position(&mut self, statement: &Statement<'_>, mut words: Words<'_>) -> Result<usize, Error> {
        memory::reserve(&mut self.positions, 3)?;
        for k in 0..3 {
            let word = words.next().map(|range| &statement.bytes[range]).ok_or_else(|| {
                Error::at_line(statement.line, format!("expected a position of three numbers, found {k}"))
            })?;
            let value = number::parse(word).ok_or_else(|| {
                let otherwise =
                    || format!("expected a coordinate, found {}, which is not a finite number", quote(word));
                Error::at_line(statement.line, number::wrong(word, otherwise))
            })?;
            self.decimals = self.decimals.max(number::decimals(word));
            self.positions.push(value);
        }
        Ok(3 + words.count())
    }

    /// Reads an `f`, whose `words` follow, and returns how many corners it has.
    fn face(&mut self, statement: &Statement<'_>, words: Words<'_>) -> Result<usize, Error> {
        let (mut first, mut previous, mut corners) = (0, 0, 0);
        for range in words {
            let word = &statement.bytes[range];
            let wrong = |what: String| Error::at_line(statement.line, what);
            let corner = Corner::parse(word).ok_or_else(|| {
                wrong(format!("expected a face's corner such as 1, 1/2 or 1/2/3, found {}", quote(word)))
            })?;
            let count = self.positions.len() / 3;
            let index = corner::resolve(corner.vertex, count).ok_or_else(|| {
                wrong(match corner.vertex {
                    0 => "a face names vertex 0, but they are counted from 1".into(),
                    index => format!("a face names vertex {index}, but {count} are defined up to here"),
                })
            })?;
            if self.furthest.is_none_or(|(furthest, _)| index > furthest) {
                self.furthest = Some((index, statement.line));
            }
            if let Some((normal, _)) = corner.normal {
                match corner::resolve(normal, self.normals) {
                    Some(index) => self.furthest_normal = self.furthest_normal.max(Some(index)),
                    None => self.fixed_normals = true,
                }
            }
            match corners {
                0 => first = index,
                1 => {}
                _ => memory::push(&mut self.triangles, [first, previous, index])?,
            }
            previous = index;
            corners += 1;
        }
        self.faces += 1;
        Ok(corners)
    }
}
