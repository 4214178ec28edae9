//! An OBJ file with other positions: the file is gone through again, and what changed is replaced.

use std::io::Write;
use std::ops::Range;

use super::corner::{self, Corner};
use super::statements::{Statement, Statements, Words};
use super::turned::{turn, Turned};
use crate::document::{Document, Moved, Written};
use crate::error::Error;
use crate::memory;
use crate::number::{self, Style};
use crate::precision::Precision;
use crate::text::{Patcher, LONGEST_NUMBER};

pub(super) struct Obj {
    /// Digits behind the point of the most precise coordinate.
    pub decimals: usize,
    pub has_normals: bool,
    /// Whether a normal may become several, which renumbers those that follow.
    pub may_split: bool,
    /// What `mtllib` statements name: one file, or several with spaces between them.
    pub libraries: Vec<String>,
    /// Whether normal i belongs to position i (a point cloud).
    pub by_vertex: bool,
}

impl Document for Obj {
    fn has_normals(&self) -> bool {
        self.has_normals
    }

    fn precision(&self, _axis: usize) -> Precision {
        Precision::Digits(self.decimals)
    }

    fn named_files(&self) -> Vec<String> {
        let words = self.libraries.iter().flat_map(|line| line.split_ascii_whitespace());
        words.chain(self.libraries.iter().map(String::as_str)).map(String::from).collect()
    }

    /// A statement names one file, or several with spaces between them: where none of the words is there, all of it is missing.
    fn missing_files(&self, is_there: &dyn Fn(&str) -> bool) -> Vec<String> {
        let missing = |line: &String| {
            let words = || line.split_ascii_whitespace();
            match (is_there(line), words().any(is_there)) {
                (true, _) => Vec::new(),
                (false, true) => words().filter(|word| !is_there(word)).map(String::from).collect(),
                (false, false) => vec![line.clone()],
            }
        };
        self.libraries.iter().filter(|line| !line.is_empty()).flat_map(missing).collect()
    }

    fn write(&self, source: &[u8], moved: &Moved<'_>) -> Result<Written, Error> {
        let turned = moved
            .maps
            .filter(|_| self.has_normals)
            .map(|maps| turn(source, maps, self.by_vertex, self.may_split))
            .transpose()?;
        let mut writer = Writer {
            source,
            patcher: Patcher::new(source)?,
            style: Style::new(self.decimals, moved.after, 3),
            position: 0,
            normal: 0,
            use_of_normal: 0,
        };
        let renumbered = turned.as_ref().filter(|turned| turned.corners.is_some());
        for statement in Statements::new(source) {
            let mut words = statement.words();
            let Some(keyword) = words.next() else { continue };
            match (&statement.bytes[keyword], &turned, renumbered) {
                (b"v", _, _) => writer.position(&statement, words, moved)?,
                (b"vn", Some(turned), _) => writer.normal(&statement, words, turned)?,
                (b"f" | b"fo", _, Some(turned)) => writer.face(&statement, words, turned)?,
                _ => {}
            }
        }
        Ok(Written { bytes: writer.patcher.finish()?, side_files: Vec::new() })
    }
}

struct Writer<'a> {
    source: &'a [u8],
    patcher: Patcher<'a>,
    style: Style,
    /// As many positions, normals and corners with normals were met.
    position: usize,
    normal: usize,
    use_of_normal: usize,
}

impl Writer<'_> {
    /// Replaces a word where its number changed.
    fn put(
        &mut self,
        statement: &Statement<'_>,
        word: Range<usize>,
        was: f64,
        is: f64,
        style: Style,
    ) -> Result<(), Error> {
        if style.differs(was, is) {
            let range = statement.start + word.start..statement.start + word.end;
            style.print(is, self.patcher.replace(range)?);
        }
        Ok(())
    }

    fn position(
        &mut self,
        statement: &Statement<'_>,
        words: Words<'_>,
        moved: &Moved<'_>,
    ) -> Result<(), Error> {
        let at = 3 * self.position;
        self.position += 1;
        if moved.before[at..at + 3] == moved.after[at..at + 3] {
            return Ok(());
        }
        for (k, word) in words.take(3).enumerate() {
            self.put(statement, word, moved.before[at + k], moved.after[at + k], self.style)?;
        }
        Ok(())
    }

    /// Replaces a normal, and adds a line for each further one that it became.
    fn normal(
        &mut self,
        statement: &Statement<'_>,
        mut words: Words<'_>,
        turned: &Turned,
    ) -> Result<(), Error> {
        let range = turned.first[self.normal] as usize..turned.first[self.normal + 1] as usize;
        self.normal += 1;
        let mut now = turned.normals[range].iter().flatten();
        let Some(first) = now.next() else { return Ok(()) };
        let Some(words) = (|| Some([words.next()?, words.next()?, words.next()?]))() else { return Ok(()) };
        let style = Style::for_normal(words.each_ref().map(|word| &statement.bytes[word.clone()]));
        for (word, is) in words.into_iter().zip(first) {
            let was = number::parse(&statement.bytes[word.clone()]).unwrap_or(*is);
            self.put(statement, word, was, *is, style)?;
        }
        let out = self.patcher.replace(statement.end()..statement.end())?;
        for further in now {
            memory::reserve(out, 3 * LONGEST_NUMBER)?;
            out.extend_from_slice(line_ending(&self.source[statement.end()..]));
            out.extend_from_slice(b"vn");
            for &number in further {
                out.push(b' ');
                style.print(number, out);
            }
        }
        Ok(())
    }

    /// Renumbers the normals of a face.
    fn face(&mut self, statement: &Statement<'_>, words: Words<'_>, turned: &Turned) -> Result<(), Error> {
        let chosen = turned.corners.as_deref().unwrap_or_default();
        // As many normals are in the new file up to here.
        let count = i64::from(turned.first[self.normal]);
        for word in words {
            let corner = Corner::parse(&statement.bytes[word.clone()]);
            let Some((number, place)) = corner.and_then(|corner| corner.normal) else { continue };
            if corner::resolve(number, self.normal).is_none() {
                continue;
            }
            let index = i64::from(chosen[self.use_of_normal]);
            self.use_of_normal += 1;
            let new = if number > 0 { index + 1 } else { index - count };
            if new != number {
                let start = statement.start + word.start;
                write!(self.patcher.replace(start + place.start..start + place.end)?, "{new}")
                    .expect("a Vec takes all that is written");
            }
        }
        Ok(())
    }
}

/// The line ending that the rest of a file starts with.
fn line_ending(rest: &[u8]) -> &'static [u8] {
    match rest {
        [b'\r', b'\n', ..] => b"\r\n",
        [b'\r', ..] => b"\r",
        _ => b"\n",
    }
}
