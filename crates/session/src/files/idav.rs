//! IDAV Landmark's `.pts` and `.ptsAscii`: two lines of head, then a name and three numbers a line.

use super::land::rows;
use super::landmarks::{numbers, Landmarks};
use crate::error::Error;
use crate::session::Read;

/// Whether a file begins so.
pub fn is(first: &str) -> bool {
    first.strip_prefix("Version").is_some_and(|rest| rest.trim().parse::<f64>().is_ok())
}

/// As many landmarks as the head says. 9999 stands for what is missing.
pub fn read(text: &str) -> Result<Read, Error> {
    let mut lines = rows(text).skip(1);
    let found = lines.next();
    let count = found.as_ref().and_then(|row| row.words.first()?.parse::<usize>().ok());
    let Some(count) = count else {
        let found = found.map_or("nothing".into(), |row| row.shown());
        return Err(Error::file(format!("line 2: expected the number of landmarks, found {found}")));
    };
    let mut landmarks = Landmarks::new(3);
    let mut rest = 0;
    for row in lines {
        if landmarks.count() == count {
            rest += 1;
            continue;
        }
        match row.words[..] {
            [name, x, y, z, ..] if numbers([x, y, z]).is_some() => {
                landmarks.push(name.to_string(), numbers([x, y, z]).unwrap_or_default(), None);
            }
            _ => {
                let (line, found) = (row.line, row.shown());
                return Err(Error::file(format!(
                    "line {line}: expected a name and 3 numbers, found {found}"
                )));
            }
        }
    }
    if landmarks.count() < count {
        let found = landmarks.count();
        return Err(Error::file(format!("expected {count} landmarks, as line 2 says, found {found}")));
    }
    if rest > 0 {
        let lines = if rest == 1 { "1 line is".to_string() } else { format!("{rest} lines are") };
        landmarks.notes.push(format!("{lines} passed over after the landmarks that line 2 announces"));
    }
    landmarks.finish()
}
