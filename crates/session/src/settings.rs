//! How to deform: what a person sets besides the control points.

use std::fmt::Display;
use std::ops::RangeInclusive;

use neuralmls_core::progress::Progress;
use neuralmls_core::{Frame, InverseDistance, Schedule, Shape, Training, Weights};

use crate::error::Error;
use crate::text::number;
use crate::Transform;

/// The kind of weights, and its parameters.
#[derive(Clone, Debug, PartialEq)]
pub enum WeightsSettings {
    /// Learned from the control points.
    Neural {
        /// Neurons in each of the two hidden layers.
        width: usize,
        /// Steps of the training; `None`: until every control point has 0.9 of the weight at its own place.
        steps: Option<usize>,
        /// Where the random numbers start.
        seed: u64,
        /// Adam's learning rate.
        rate: f64,
        /// The deviation of random Fourier features; `None` for none.
        fourier_sigma: Option<f64>,
    },
    /// Learned from the control points and the shape.
    ShapeAware {
        /// Where the random numbers start.
        seed: u64,
    },
    /// `1 / (d^(2 alpha) + epsilon)`.
    InverseDistance {
        /// Exponent of the squared distance.
        alpha: f64,
        /// Above 0 caps the weight near a control point.
        epsilon: f64,
    },
}

impl WeightsSettings {
    /// The name of the kind, as in files.
    pub fn kind(&self) -> &'static str {
        match self {
            WeightsSettings::Neural { .. } => "neural",
            WeightsSettings::ShapeAware { .. } => "shape-aware",
            WeightsSettings::InverseDistance { .. } => "inverse-distance",
        }
    }

    /// The defaults of a kind; `None` where there is no such kind.
    pub fn of_kind(kind: &str) -> Option<Self> {
        match kind {
            "neural" => Some(WeightsSettings::default()),
            "shape-aware" => Some(WeightsSettings::ShapeAware { seed: 0 }),
            "inverse-distance" => Some(WeightsSettings::InverseDistance { alpha: 1.0, epsilon: 0.0 }),
            _ => None,
        }
    }

    /// Refuses what is out of its range, by name.
    ///
    /// # Errors
    /// An argument.
    pub fn check(&self) -> Result<(), Error> {
        match *self {
            WeightsSettings::Neural { width, steps, seed: _, rate, fourier_sigma } => {
                check_count("width", width, Training::WIDTHS)?;
                if let Some(steps) = steps {
                    check_count("steps", steps, Training::STEPS)?;
                }
                check_above("rate", rate)?;
                fourier_sigma.map_or(Ok(()), |sigma| check_above("fourier_sigma", sigma))
            }
            WeightsSettings::ShapeAware { .. } => Ok(()),
            WeightsSettings::InverseDistance { alpha, epsilon } => {
                check_above("alpha", alpha)?;
                check_number("epsilon", epsilon, epsilon >= 0.0, "of at least 0")
            }
        }
    }

    /// The weights of the control points `p` (m x dim), in coordinates of a frame.
    ///
    /// # Errors
    /// Where a setting is out of its range, or the control points cannot be told apart; for shape-aware weights, which need a shape:
    /// [`crate::Map::of`] takes them.
    pub fn fit(
        &self,
        p: &[f64],
        dim: usize,
        frame: Frame,
        shape: Option<Shape<'_>>,
        progress: &mut Progress<'_>,
    ) -> Result<Weights, Error> {
        self.check()?;
        match *self {
            WeightsSettings::Neural { width, steps, seed, rate, fourier_sigma } => {
                let schedule = steps.map_or(Training::default().schedule, Schedule::Fixed);
                let training = Training { width, schedule, rate, seed, fourier_sigma };
                Ok(Weights::neural(p, dim, frame, &training, progress)?)
            }
            WeightsSettings::InverseDistance { alpha, epsilon } => {
                Ok(Weights::InverseDistance(InverseDistance::new(p, dim, frame, alpha, epsilon)?))
            }
            WeightsSettings::ShapeAware { seed } => {
                let shape = shape.ok_or_else(|| {
                    Error::argument("shapes: shape-aware weights need at least one shape to learn from")
                })?;
                Ok(Weights::shape_aware(p, dim, frame, shape, seed, progress)?)
            }
        }
    }
}

impl Default for WeightsSettings {
    fn default() -> Self {
        WeightsSettings::Neural { width: 1024, steps: None, seed: 0, rate: 6e-4, fourier_sigma: None }
    }
}

/// How closely control points arrive at their targets.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum HandlesSetting {
    /// They arrive, but for those that this would harm.
    #[default]
    Auto,
    /// They arrive, whatever it does to the shape.
    Exact,
    /// As plain moving least squares leaves them, the paper's way.
    Soft,
    /// A share of the way from there to the targets, 0 to 1.
    Part(f64),
}

/// The names of the transforms, as in files.
pub const TRANSFORMS: [(&str, Transform); 3] =
    [("rigid", Transform::Rigid), ("similarity", Transform::Similarity), ("affine", Transform::Affine)];

/// What is set for the whole shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The weight function.
    pub weights: WeightsSettings,
    /// The family of local maps.
    pub transform: Transform,
    /// T > 0.
    pub temperature: f64,
    /// How closely control points arrive.
    pub handles: HandlesSetting,
    /// How far the elastic finish goes, 0 (none) to 1 (all of it).
    pub relax: f64,
    /// Whether the map is to fold nothing: in as many small steps as that takes.
    pub no_folds: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            weights: WeightsSettings::default(),
            transform: Transform::Rigid,
            temperature: 1.0,
            handles: HandlesSetting::Auto,
            relax: 0.0,
            no_folds: false,
        }
    }
}

impl HandlesSetting {
    /// As a sentence has it.
    pub fn name(&self) -> String {
        match self {
            HandlesSetting::Auto => "auto".into(),
            HandlesSetting::Exact => "exact".into(),
            HandlesSetting::Soft => "soft".into(),
            HandlesSetting::Part(part) => number(*part),
        }
    }
}

/// A transform by its name.
///
/// # Errors
/// An argument, where there is none of that name.
pub fn transform(name: &str) -> Result<Transform, Error> {
    let found = TRANSFORMS.iter().find(|(known, _)| *known == name);
    found.map(|(_, transform)| *transform).ok_or_else(|| {
        let found = crate::text::quoted(name);
        Error::argument(format!("transform: expected rigid or similarity or affine, found {found}"))
    })
}

impl Settings {
    /// Refuses what is out of its range, by name.
    ///
    /// # Errors
    /// An argument.
    pub fn check(&self) -> Result<(), Error> {
        self.weights.check()?;
        check_above("temperature", self.temperature)?;
        if let HandlesSetting::Part(share) = self.handles {
            check_share("handles", share)?;
        }
        check_share("relax", self.relax)?;
        self.check_no_folds()
    }

    /// Shape-aware weights and the elastic finish would have to learn from the whole shape at each step.
    fn check_no_folds(&self) -> Result<(), Error> {
        if self.no_folds && matches!(self.weights, WeightsSettings::ShapeAware { .. }) {
            let message = "no_folds: it needs neural or inverse-distance weights, found shape-aware ones";
            return Err(Error::argument(message));
        }
        if self.no_folds && self.relax > 0.0 {
            let found = number(self.relax);
            return Err(Error::argument(format!(
                "no_folds: it cannot be had with relax, found relax {found}"
            )));
        }
        Ok(())
    }
}

fn check_count(name: &str, count: usize, range: RangeInclusive<usize>) -> Result<(), Error> {
    if range.contains(&count) {
        return Ok(());
    }
    Err(Error::argument(not_a_count(name, &range, count)))
}

/// That something is no whole number of a range.
pub(crate) fn not_a_count<T: Display>(name: &str, range: &RangeInclusive<T>, found: impl Display) -> String {
    format!("{name}: expected a whole number from {} to {}, found {found}", range.start(), range.end())
}

fn check_above(name: &str, value: f64) -> Result<(), Error> {
    check_number(name, value, value > 0.0, "above 0")
}

fn check_share(name: &str, value: f64) -> Result<(), Error> {
    check_number(name, value, (0.0..=1.0).contains(&value), "of at least 0 and at most 1")
}

fn check_number(name: &str, value: f64, ok: bool, expected: &str) -> Result<(), Error> {
    if ok && value.is_finite() {
        return Ok(());
    }
    Err(Error::argument(format!("{name}: expected a number {expected}, found {}", number(value))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_are_in_range() {
        Settings::default().check().unwrap();
        for kind in ["neural", "shape-aware", "inverse-distance"] {
            let weights = WeightsSettings::of_kind(kind).unwrap();
            assert_eq!(weights.kind(), kind);
            Settings { weights, ..Settings::default() }.check().unwrap();
        }
        assert_eq!(WeightsSettings::of_kind("classic"), None);
    }

    #[test]
    fn what_is_out_of_range_is_named() {
        let says = |settings: Settings| settings.check().unwrap_err().message;
        let some = Settings::default;
        let cold = Settings { temperature: -1.0, ..some() };
        assert_eq!(says(cold), "temperature: expected a number above 0, found -1");
        let far = Settings { handles: HandlesSetting::Part(1.5), ..some() };
        assert_eq!(says(far), "handles: expected a number of at least 0 and at most 1, found 1.5");
        let limp = Settings { relax: -0.5, ..some() };
        assert_eq!(says(limp), "relax: expected a number of at least 0 and at most 1, found -0.5");
        let aware = Settings { weights: WeightsSettings::ShapeAware { seed: 0 }, no_folds: true, ..some() };
        assert_eq!(
            says(aware),
            "no_folds: it needs neural or inverse-distance weights, found shape-aware ones"
        );
        let both = Settings { relax: 0.5, no_folds: true, ..some() };
        assert_eq!(says(both), "no_folds: it cannot be had with relax, found relax 0.5");
        let unsaid = Settings { relax: f64::NAN, ..some() };
        assert_eq!(says(unsaid), "relax: expected a number of at least 0 and at most 1, found nan");
        let weights = WeightsSettings::InverseDistance { alpha: f64::INFINITY, epsilon: 0.0 };
        assert_eq!(says(Settings { weights, ..some() }), "alpha: expected a number above 0, found inf");
        let weights =
            WeightsSettings::Neural { width: 0, steps: None, seed: 0, rate: 1.0, fourier_sigma: None };
        let expected = "width: expected a whole number from 1 to 16384, found 0";
        assert_eq!(says(Settings { weights, ..some() }), expected);
    }
}
