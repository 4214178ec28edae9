//! What a person sets: control points, settings, frame.

use crate::control_points::{ControlPoints, Posed};
use neuralmls_core::Frame;

use crate::error::Error;
use crate::settings::Settings;
use crate::text::{general, shown_numbers};
use serde_json::{Map, Value};

/// Units; beyond it, squares of lengths overflow.
pub(crate) const LARGEST: f64 = 1e150;

/// The frame of a session: the box in which its weights are trained.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    /// The least corner.
    pub min: Vec<f64>,
    /// The greatest corner.
    pub max: Vec<f64>,
}

impl Bounds {
    /// The checked box of `dim` coordinates.
    ///
    /// # Errors
    /// An argument, where it is of another dimension, not finite, upside down, or a single place.
    pub fn new(min: Vec<f64>, max: Vec<f64>, dim: usize) -> Result<Self, Error> {
        for (name, corner) in [("min", &min), ("max", &max)] {
            if corner.len() != dim || corner.iter().any(|c| !c.is_finite()) {
                let found = shown_numbers(corner);
                let message = format!("frame: expected {dim} finite numbers for {name}, found {found}");
                return Err(Error::argument(message));
            }
        }
        let upside_down = min.iter().zip(&max).any(|(low, high)| low > high);
        if upside_down || min == max {
            let (min, max) = (shown_numbers(&min), shown_numbers(&max));
            let message = format!("frame: expected a max above the min, found {min} and {max}");
            return Err(Error::argument(message));
        }
        Ok(Bounds { min, max })
    }

    /// The box around the points of a shape, n x dim.
    ///
    /// # Errors
    /// As [`Bounds::of_shape`].
    pub fn around(points: &[f64], dim: usize) -> Result<Self, Error> {
        let (mut min, mut max) = (vec![f64::INFINITY; dim], vec![f64::NEG_INFINITY; dim]);
        for point in points.chunks_exact(dim) {
            for (k, c) in point.iter().enumerate() {
                (min[k], max[k]) = (min[k].min(*c), max[k].max(*c));
            }
        }
        Bounds::of_shape(min, max, points.len() / dim)
    }

    /// The box of a shape of so many points, which lengths can be measured by.
    ///
    /// # Errors
    /// A file, where all points are in one place, or as [`longest_side`].
    pub fn of_shape(min: Vec<f64>, max: Vec<f64>, count: usize) -> Result<Self, Error> {
        if longest_side(&min, &max)? > 0.0 {
            return Ok(Bounds { min, max });
        }
        let found = match count {
            0 => "there is no vertex".into(),
            1 => "there is only one vertex".into(),
            _ => format!("all {count} vertices are in one place"),
        };
        Err(Error::file(format!("{found}, so that there is no size to measure by")))
    }

    /// The same as the core has it.
    ///
    /// # Errors
    /// An argument, where it is of another dimension, or has no size that a number could hold.
    pub fn frame(&self, dim: usize) -> Result<Frame, Error> {
        let checked = Bounds::new(self.min.clone(), self.max.clone(), dim)?;
        Ok(Frame::of_box(&checked.min, &checked.max)?)
    }
}

/// The longest side of a shape's box.
///
/// # Errors
/// A file, where it is so long that squares of lengths overflow.
pub fn longest_side(min: &[f64], max: &[f64]) -> Result<f64, Error> {
    if min.iter().zip(max).any(|(low, high)| high / LARGEST - low / LARGEST > 1.0) {
        let largest = general(LARGEST, 6);
        let message = format!("the shape is more than {largest} units long: no coordinates of a real thing");
        return Err(Error::file(message));
    }
    Ok(longest(min, max))
}

/// The same of any box.
pub(crate) fn longest(min: &[f64], max: &[f64]) -> f64 {
    min.iter().zip(max).map(|(low, high)| high - low).fold(0.0, f64::max)
}

/// Control points, settings and frame: one session is one map of space, whatever file it is applied to.
#[derive(Clone, Debug, PartialEq)]
pub struct Session {
    /// The control points.
    pub points: ControlPoints,
    /// How to deform.
    pub settings: Settings,
    /// Whether the settings were said, and not only left at their defaults.
    pub has_settings: bool,
    /// The box in which weights are trained; `None`: that of the shape at hand.
    pub frame: Option<Bounds>,
    /// Keys of other programs, kept. Those within `settings` and `frame` are here under these names.
    pub others: Map<String, Value>,
}

/// What reading a file gave.
#[derive(Clone, Debug, PartialEq)]
pub struct Read {
    /// The session.
    pub session: Session,
    /// What was left out or passed over, a sentence each.
    pub notes: Vec<String>,
    /// The places in the file of the landmarks that were left out, counted from 0: joining by order needs them.
    pub left_out: Vec<usize>,
}

impl Session {
    /// A session of control points alone.
    pub fn new(points: ControlPoints) -> Self {
        Session {
            points,
            settings: Settings::default(),
            has_settings: false,
            frame: None,
            others: Map::new(),
        }
    }

    /// Where the map takes the control points: to their targets, but for groups and what is locked.
    pub fn posed(&self) -> Posed {
        self.points.posed(self.settings.transform)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn says(points: &[f64]) -> String {
        Bounds::around(points, 2).unwrap_err().message
    }

    #[test]
    fn a_shape_is_measured_by_the_longest_side_of_its_box() {
        let bounds = Bounds::around(&[1.0, 0.0, 4.0, 1.0], 2).unwrap();
        assert_eq!((&bounds.min[..], &bounds.max[..]), (&[1.0, 0.0][..], &[4.0, 1.0][..]));
        assert_eq!(longest_side(&bounds.min, &bounds.max), Ok(3.0));
        assert_eq!(longest_side(&[1.0], &[1.0]), Ok(0.0));
    }

    #[test]
    fn a_shape_without_a_size_is_refused() {
        assert_eq!(says(&[]), "there is no vertex, so that there is no size to measure by");
        assert_eq!(says(&[1.0, 2.0]), "there is only one vertex, so that there is no size to measure by");
        let three = "all 3 vertices are in one place, so that there is no size to measure by";
        assert_eq!(says(&[1.0, 2.0, 1.0, 2.0, 1.0, 2.0]), three);
        let long = "the shape is more than 1e+150 units long: no coordinates of a real thing";
        assert_eq!(says(&[-1e308, 0.0, 1e308, 0.0]), long);
        assert_eq!(longest_side(&[0.0], &[1e150]), Ok(1e150));
    }
}
