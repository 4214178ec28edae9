//! Morphologika's `.txt`: sections with titles in square brackets.

use super::land::rows;
use super::landmarks::{name_of, numbers, Landmarks};
use crate::error::Error;
use crate::session::Read;
use crate::text::{quoted, shown};

/// Whether a file has its sections.
pub fn is(text: &str) -> bool {
    let titles = ["[individuals]", "[rawpoints]"];
    text.trim_start().starts_with('[')
        && text.lines().any(|line| titles.iter().any(|title| line.trim().eq_ignore_ascii_case(title)))
}

/// The first individual.
pub fn read(text: &str) -> Result<Read, Error> {
    let mut section = String::new();
    let (mut individuals, mut count, mut dim) = (1, None, 3);
    let (mut names, mut name) = (Vec::new(), None);
    let mut points: Vec<Vec<f64>> = Vec::new();
    for row in rows(text) {
        let line = row.words.join(" ");
        let refuse = |expected: &str| {
            let (at, found) = (row.line, shown(&line));
            Err(Error::file(format!("line {at}: expected {expected}, found {found}")))
        };
        if line.starts_with('[') {
            section = line.to_ascii_lowercase();
            continue;
        }
        match section.as_str() {
            "[individuals]" | "[landmarks]" | "[dimensions]" => {
                let Ok(number) = line.parse::<usize>() else { return refuse("a whole number") };
                match section.as_str() {
                    "[individuals]" => individuals = number,
                    "[landmarks]" => count = Some(number),
                    _ if !(1..=3).contains(&number) => return refuse("1, 2 or 3 dimensions"),
                    _ => dim = number,
                }
            }
            "[names]" => names.push(line),
            "[rawpoints]" if line.starts_with('\'') && points.is_empty() => {
                name = Some(line.trim_start_matches('\'').trim().to_string());
            }
            "[rawpoints]" if line.starts_with('\'') => {}
            "[rawpoints]" => {
                if count.is_some_and(|count| points.len() >= count) {
                    continue;
                }
                match numbers(row.words.iter().copied()) {
                    Some(values) if values.len() == dim => points.push(values),
                    _ => return refuse(&format!("{dim} numbers")),
                }
            }
            _ => {}
        }
    }
    let Some(count) = count else {
        return Err(Error::file("expected a section [landmarks] with their number, found none"));
    };
    if points.len() < count {
        let found = points.len();
        return Err(Error::file(format!("expected {count} landmarks, found {found}")));
    }
    let mut landmarks = Landmarks::new(dim);
    for (i, position) in points.into_iter().enumerate() {
        landmarks.push(name_of(i), position, None);
    }
    if individuals > 1 {
        let first = name.or_else(|| names.into_iter().next());
        let which = first.map_or(String::new(), |name| format!(", {},", quoted(&name)));
        landmarks.notes.push(format!("there are {individuals} individuals: the first{which} is read"));
    }
    landmarks.finish()
}
