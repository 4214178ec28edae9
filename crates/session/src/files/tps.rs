//! tpsDig's `.tps`: `LM=n` or `LM3=n`, then n lines of numbers, then keys; perhaps several specimens.

use super::land::rows;
use super::landmarks::{name_of, numbers, Landmarks};
use crate::error::Error;
use crate::session::Read;
use crate::text::{quoted, shown};

/// The number of coordinates and of landmarks that a line announces, if it does.
fn head(line: &str) -> Option<(usize, &str)> {
    let (key, count) = line.split_once('=')?;
    let key = key.trim();
    let dim = [("LM3", 3), ("LM", 2)].iter().find(|(known, _)| key.eq_ignore_ascii_case(known))?.1;
    Some((dim, count.trim()))
}

/// Whether a file begins so.
pub fn is(first: &str) -> bool {
    head(first).is_some()
}

/// The first specimen.
pub fn read(text: &str) -> Result<Read, Error> {
    let mut specimens = 0;
    let (mut landmarks, mut dim, mut count) = (Landmarks::new(2), 2, 0);
    let mut id = None;
    for row in rows(text) {
        let line = row.words.join(" ");
        if let Some((d, announced)) = head(&line) {
            specimens += 1;
            if specimens == 1 {
                dim = d;
                landmarks = Landmarks::new(dim);
                count = announced.parse::<usize>().map_err(|_| {
                    let found = shown(announced);
                    Error::file(format!("line {}: expected the number of landmarks, found {found}", row.line))
                })?;
            }
        } else if specimens > 1 {
            continue;
        } else if landmarks.count() < count {
            let Some(values) = numbers(row.words.iter().copied()).filter(|values| values.len() == dim) else {
                let (at, found) = (row.line, shown(&line));
                return Err(Error::file(format!("line {at}: expected {dim} numbers, found {found}")));
            };
            landmarks.push(name_of(landmarks.count()), values, None);
        } else if let Some((key, value)) = line.split_once('=') {
            match key.trim().to_ascii_uppercase().as_str() {
                "SCALE" => landmarks.notes.push(format!(
                    "SCALE={} is not applied: coordinates are as the file has them",
                    shown(value)
                )),
                "ID" => id = Some(value.to_string()),
                "CURVES" => landmarks.notes.push("curves are passed over: landmarks only are read".into()),
                _ => {}
            }
        }
    }
    if landmarks.count() < count {
        let found = landmarks.count();
        return Err(Error::file(format!("expected {count} landmarks, found {found}")));
    }
    if specimens > 1 {
        let which = id.map_or(String::new(), |id| format!(", {},", quoted(&id)));
        landmarks.notes.push(format!("there are {specimens} specimens: the first{which} is read"));
    }
    landmarks.finish()
}
