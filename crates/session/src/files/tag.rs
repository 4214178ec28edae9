//! MNI tag point files, `.tag`: points in one volume, or the same points in two (source and target).

use super::landmarks::{name_of, numbers, Landmarks};
use crate::error::Error;
use crate::session::Read;
use crate::text::shown;

/// Whether a file begins so.
pub fn is(first: &str) -> bool {
    first.starts_with("MNI Tag Point File")
}

/// The points, with their labels as names.
pub fn read(text: &str) -> Result<Read, Error> {
    let (mut volumes, mut landmarks, mut ended) = (1, None, false);
    for (i, line) in text.lines().enumerate().skip(1) {
        let place = format!("line {}", i + 1);
        let mut line = line.trim();
        if line.is_empty() || line.starts_with(['%', '#']) || ended {
            continue;
        }
        if landmarks.is_none() {
            let Some((key, value)) = line.split_once('=') else {
                let message = format!("{place}: expected Volumes = or Points =, found {}", shown(line));
                return Err(Error::file(message));
            };
            match key.trim() {
                "Volumes" => {
                    volumes = match value.trim().trim_end_matches(';').trim() {
                        "1" => 1,
                        "2" => 2,
                        other => {
                            let found = shown(other);
                            return Err(Error::file(format!(
                                "{place}: expected 1 or 2 volumes, found {found}"
                            )));
                        }
                    };
                    continue;
                }
                "Points" => {
                    landmarks = Some(Landmarks::new(3));
                    line = value.trim();
                }
                _ => continue,
            }
        }
        if let Some(landmarks) = &mut landmarks {
            ended = points(line, volumes, &place, landmarks)?;
        }
    }
    match landmarks {
        Some(landmarks) if ended || landmarks.count() > 0 => landmarks.finish(),
        _ => Err(Error::file("expected Points = with at least one point, found nothing")),
    }
}

/// The points of one line: the coordinates in each volume, perhaps three numbers of no concern here, perhaps a label.
/// Returns whether the list ends here.
fn points(line: &str, volumes: usize, place: &str, landmarks: &mut Landmarks) -> Result<bool, Error> {
    let mut rest = line;
    loop {
        let end = rest.find(['"', ';']).unwrap_or(rest.len());
        let words: Vec<&str> = rest[..end].split_whitespace().collect();
        let labelled = rest[end..].starts_with('"');
        let label = if labelled {
            let inner = &rest[end + 1..];
            let Some(close) = inner.find('"') else {
                return Err(Error::file(format!("{place}: a quotation mark is not closed")));
            };
            rest = &inner[close + 1..];
            inner[..close].trim()
        } else {
            rest = &rest[end..];
            ""
        };
        if labelled || !words.is_empty() {
            let count = 3 * volumes;
            let right = words.len() == count || words.len() == count + 3;
            let Some(values) = numbers(words.iter().copied()).filter(|_| right) else {
                let found = shown(&words.join(" "));
                let s = if volumes == 1 { "" } else { "s" };
                let message =
                    format!("{place}: expected {count} numbers for {volumes} volume{s}, found {found}");
                return Err(Error::file(message));
            };
            let name = if label.is_empty() { name_of(landmarks.count()) } else { label.to_string() };
            let target = (volumes == 2).then(|| values[3..6].to_vec());
            landmarks.push(name, values[..3].to_vec(), target);
        }
        rest = rest.trim_start();
        if rest.starts_with(';') {
            return Ok(true);
        }
        if rest.is_empty() {
            return Ok(false);
        }
    }
}
