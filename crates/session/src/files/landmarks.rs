//! Landmarks of other tools' files become control points. Those that were not placed are left out, with a word.

use crate::control_points::{ControlPoint, ControlPoints};
use crate::error::Error;
use crate::session::{Read, Session};
use crate::text;

/// What landmark tools write for a coordinate that is not known.
const MISSING: f64 = 9999.0;

/// The landmarks of a file.
pub struct Landmarks {
    dim: usize,
    list: Vec<ControlPoint>,
    /// Why landmarks are left out, and which: in the order in which the reasons came up.
    left_out: Vec<(String, Vec<String>)>,
    /// Their places in the file.
    places: Vec<usize>,
    /// Further sentences about the file.
    pub notes: Vec<String>,
}

impl Landmarks {
    /// None as yet, of `dim` coordinates each.
    pub fn new(dim: usize) -> Self {
        Landmarks { dim, list: Vec::new(), left_out: Vec::new(), places: Vec::new(), notes: Vec::new() }
    }

    /// One more. Without a target it stays where it is.
    pub fn push(&mut self, name: String, position: Vec<f64>, target: Option<Vec<f64>>) {
        for (what, place) in [("position", Some(&position)), ("target", target.as_ref())] {
            if let Some(missing) = place.and_then(|place| missing(place)) {
                return self.leave_out(name, &format!("its {what} is {missing}"));
            }
        }
        let mut point = ControlPoint::new(name, position);
        if let Some(target) = target {
            point.target = target;
        }
        self.list.push(point);
    }

    /// One that was not placed.
    pub fn leave_out(&mut self, name: String, why: &str) {
        self.places.push(self.count());
        match self.left_out.iter_mut().find(|(reason, _)| reason == why) {
            Some((_, names)) => names.push(name),
            None => self.left_out.push((why.to_string(), vec![name])),
        }
    }

    /// How many there are, those that are left out among them.
    pub fn count(&self) -> usize {
        self.list.len() + self.places.len()
    }

    /// The session of those that were placed.
    pub fn finish(self) -> Result<Read, Error> {
        let Landmarks { dim, list, left_out, places, notes } = self;
        let left_out: Vec<String> = left_out
            .iter()
            .map(|(why, names)| {
                let listed = text::names(names.iter().map(String::as_str));
                if names.len() == 1 {
                    format!("landmark {listed} is left out: {why}")
                } else {
                    format!("landmarks {listed} are left out: {}", why.replacen("its ", "their ", 1))
                }
            })
            .collect();
        if list.is_empty() && !left_out.is_empty() {
            let message = format!("there are no control points: {}", left_out.join("; "));
            return Err(Error::file(message));
        }
        let session = Session::new(ControlPoints::new(dim, list)?);
        Ok(Read { session, notes: [left_out, notes].concat(), left_out: places })
    }
}

/// What says that a place is missing: 9999 in every coordinate, or one that is no number.
fn missing(place: &[f64]) -> Option<&'static str> {
    if place.iter().any(|c| c.is_nan()) {
        Some("NaN")
    } else if place.len() > 1 && place.iter().all(|c| c.abs() == MISSING) {
        Some(if place[0] > 0.0 { "9999" } else { "-9999" })
    } else {
        None
    }
}

/// A name for the landmark of this index in a file that has none.
pub fn name_of(index: usize) -> String {
    format!("p{}", index + 1)
}

/// All as numbers; `NA` and its like are NaN.
pub fn numbers<'a>(words: impl IntoIterator<Item = &'a str>) -> Option<Vec<f64>> {
    let number = |word: &str| if is_mark(word) { Some(f64::NAN) } else { word.parse().ok() };
    words.into_iter().map(number).collect()
}

/// Whether it is what a tool writes instead of a number that is not known.
pub fn is_mark(word: &str) -> bool {
    const MARKS: [&str; 8] = ["na", "n/a", "nan", "none", "null", "undefined", "missing", "#n/a"];
    MARKS.iter().any(|mark| word.eq_ignore_ascii_case(mark))
}
