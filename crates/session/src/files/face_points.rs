//! Points on faces as the 300-W challenge and its kin have them, `.pts`: `version: 1`, `n_points: 68`, then coordinates in braces.

use super::land::rows;
use super::landmarks::{name_of, numbers, Landmarks};
use crate::error::Error;
use crate::session::Read;
use crate::text::shown;

/// Whether a file begins so.
pub fn is(first: &str) -> bool {
    first.strip_prefix("version:").is_some_and(|rest| rest.trim().parse::<f64>().is_ok())
}

/// The points between the braces.
pub fn read(text: &str) -> Result<Read, Error> {
    let (mut count, mut landmarks, mut dim, mut open) = (None, Landmarks::new(2), 2, false);
    for row in rows(text).skip(1) {
        let line = row.words.join(" ");
        if let Some(found) = line.strip_prefix("n_points:") {
            let number = found.trim().parse::<usize>();
            count = Some(number.map_err(|_| {
                let (at, found) = (row.line, shown(found.trim()));
                Error::file(format!("line {at}: expected the number of points, found {found}"))
            })?);
        } else if line == "{" {
            open = true;
        } else if line == "}" {
            break;
        } else if open {
            if landmarks.count() == 0 {
                dim = row.words.len().clamp(2, 3);
                landmarks = Landmarks::new(dim);
            }
            let Some(values) = numbers(row.words.iter().copied()).filter(|values| values.len() == dim) else {
                let (at, found) = (row.line, shown(&line));
                return Err(Error::file(format!("line {at}: expected {dim} numbers, found {found}")));
            };
            landmarks.push(name_of(landmarks.count()), values, None);
        }
    }
    let found = landmarks.count();
    match count {
        Some(count) if count != found => Err(Error::file(format!("expected {count} points, found {found}"))),
        _ => landmarks.finish(),
    }
}
