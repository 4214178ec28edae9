//! Landmark lists that begin with a count, `.land`: the coordinates a line, after a name or alone.

use super::landmarks::{name_of, numbers, Landmarks};
use crate::error::Error;
use crate::session::Read;
use crate::text::shown;

/// A line that is not blank, in words.
pub struct Row<'a> {
    /// Its number, from 1.
    pub line: usize,
    /// What stands between its blanks.
    pub words: Vec<&'a str>,
}

impl Row<'_> {
    /// As a sentence may quote it.
    pub fn shown(&self) -> String {
        shown(&self.words.join(" "))
    }
}

/// The lines that are not blank.
pub fn rows(text: &str) -> impl Iterator<Item = Row<'_>> {
    let all = text.lines().enumerate();
    all.map(|(i, line)| Row { line: i + 1, words: line.split_whitespace().collect() })
        .filter(|row| !row.words.is_empty())
}

/// Whether a file begins with a count, of so many lines of several words.
pub fn is(text: &str) -> bool {
    let mut rows = rows(text);
    let count =
        rows.next().filter(|row| row.words.len() == 1).and_then(|row| row.words[0].parse::<usize>().ok());
    let named = rows.next().is_some_and(|row| row.words.len() > 1 && row.words[0].parse::<f64>().is_err());
    // Numbers alone are a table, unless there are just as many lines of them.
    count.is_some_and(|count| {
        named || count > 1 && rows.filter(|row| row.words.len() > 1).count() == count - 1
    })
}

/// As many landmarks as the first line says. A line of fewer than four numbers has no name.
pub fn read(text: &str) -> Result<Read, Error> {
    let mut rows = rows(text);
    let found = rows.next();
    let count = found.as_ref().and_then(|row| row.words[0].parse::<usize>().ok());
    let Some(count) = count else {
        let found = found.map_or("nothing".into(), |row| row.shown());
        return Err(Error::file(format!("line 1: expected the number of landmarks, found {found}")));
    };
    let mut landmarks = Landmarks::new(3);
    let (mut dim, mut names) = (0, 1);
    for row in rows {
        if dim == 0 {
            names = usize::from(row.words.len() > 3 || row.words[0].parse::<f64>().is_err());
            dim = (row.words.len() - names).clamp(1, 3);
            landmarks = Landmarks::new(dim);
        }
        let values = numbers(row.words[names.min(row.words.len())..].iter().copied());
        let Some(values) = values.filter(|values| values.len() == dim) else {
            let (line, found) = (row.line, row.shown());
            let (a, s) = (if names == 1 { "a name and " } else { "" }, if dim == 1 { "" } else { "s" });
            return Err(Error::file(format!("line {line}: expected {a}{dim} number{s}, found {found}")));
        };
        let name = if names == 1 { row.words[0].to_string() } else { name_of(landmarks.count()) };
        landmarks.push(name, values, None);
    }
    if landmarks.count() != count {
        let found = landmarks.count();
        return Err(Error::file(format!(
            "expected {count} landmarks, as the first line says, found {found}"
        )));
    }
    landmarks.finish()
}
