//! Landmark lists that begin with a count, `.land`: a name and the coordinates a line.

use super::landmarks::{numbers, Landmarks};
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

/// Whether a file begins with a count, and goes on with names.
pub fn is(text: &str) -> bool {
    let mut rows = rows(text);
    let count = rows.next().is_some_and(|row| row.words.len() == 1 && row.words[0].parse::<usize>().is_ok());
    count && rows.next().is_some_and(|row| row.words.len() > 1 && row.words[0].parse::<f64>().is_err())
}

/// As many landmarks as the first line says.
pub fn read(text: &str) -> Result<Read, Error> {
    let mut rows = rows(text);
    let found = rows.next();
    let count = found.as_ref().and_then(|row| row.words[0].parse::<usize>().ok());
    let Some(count) = count else {
        let found = found.map_or("nothing".into(), |row| row.shown());
        return Err(Error::file(format!("line 1: expected the number of landmarks, found {found}")));
    };
    let mut landmarks: Option<Landmarks> = None;
    let mut dim = 0;
    for row in rows {
        let values = numbers(row.words[1..].iter().copied());
        let Some(values) =
            values.filter(
                |values| if dim == 0 { (1..=3).contains(&values.len()) } else { values.len() == dim },
            )
        else {
            let expected = if dim == 0 { "1 to 3".to_string() } else { dim.to_string() };
            let (line, found) = (row.line, row.shown());
            return Err(Error::file(format!(
                "line {line}: expected a name and {expected} numbers, found {found}"
            )));
        };
        dim = values.len();
        landmarks.get_or_insert_with(|| Landmarks::new(dim)).push(row.words[0].to_string(), values, None);
    }
    let landmarks = landmarks.unwrap_or(Landmarks::new(3));
    if landmarks.count() != count {
        let found = landmarks.count();
        return Err(Error::file(format!(
            "expected {count} landmarks, as the first line says, found {found}"
        )));
    }
    landmarks.finish()
}
