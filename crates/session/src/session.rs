//! What a person sets: control points, settings, frame.

use crate::control_points::ControlPoints;
use neuralmls_core::Frame;

use crate::error::Error;
use crate::settings::Settings;
use crate::text::shown_numbers;
use serde_json::{Map, Value};

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

    /// The box around points of `dim` coordinates, n x dim.
    ///
    /// # Errors
    /// An argument, where there are none, or all are in one place.
    pub fn around(points: &[f64], dim: usize) -> Result<Self, Error> {
        let (mut min, mut max) = (vec![f64::INFINITY; dim], vec![f64::NEG_INFINITY; dim]);
        for point in points.chunks_exact(dim) {
            for (k, c) in point.iter().enumerate() {
                (min[k], max[k]) = (min[k].min(*c), max[k].max(*c));
            }
        }
        Bounds::new(min, max, dim)
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
}
