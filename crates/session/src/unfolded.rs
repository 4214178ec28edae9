//! Maps that fold nothing: in as many steps as that takes.

use std::sync::Arc;

use neuralmls_core::progress::Progress;
use neuralmls_core::{Composed, Frame, InverseDistance, Probe, Rules, Schedule, Training, Watched, Weights};

use crate::text::general;
use crate::words::{percent, place};
use crate::{Error, HandlesSetting, Map, Session, WeightsSettings};

/// Neurons of the networks after the first step, of which a search fits many: narrow for their time.
const WIDTH: usize = 128;

impl Session {
    /// The steps that take the control points to their targets and fold nothing at the places of a shape; one, where that does.
    pub(crate) fn unfold(
        &self,
        weights: Arc<Weights>,
        watched: &Watched,
        progress: &mut Progress<'_>,
    ) -> Result<Composed, Error> {
        let (settings, posed, turns) = (&self.settings, self.posed(), self.points.turns());
        let dim = self.points.dim();
        let first = weights.clone();
        let refit = |p: &[f64], frame: Frame, progress: &mut Progress<'_>| match (&*first, &settings.weights)
        {
            (Weights::InverseDistance(function), _) => {
                let (alpha, epsilon) = (function.alpha(), function.epsilon());
                Ok(Weights::InverseDistance(InverseDistance::new(p, dim, frame, alpha, epsilon)?))
            }
            (_, &WeightsSettings::Neural { width, steps, seed, rate, fourier_sigma }) => {
                let schedule = steps.map_or(Training::default().schedule, Schedule::Fixed);
                let training = Training { width: width.min(WIDTH), schedule, rate, seed, fourier_sigma };
                Weights::neural(p, dim, frame, &training, progress)
            }
            _ => unreachable!("other weights are refused with the settings"),
        };
        let rules = Rules {
            transform: settings.transform,
            temperature: settings.temperature,
            careful: settings.handles != HandlesSetting::Exact,
            adherence: &self.adherence(),
            turns: turns.as_deref(),
        };
        Ok(Composed::search(weights, posed.pose(), rules, watched, &refit, progress)?)
    }
}

impl Map {
    /// Whether `no_folds` at least halves the part of the shape that is folded, in words.
    pub(crate) fn in_steps(&self, probe: &Probe, now: f64) -> Option<String> {
        let mut session = self.session().clone();
        if session.settings.no_folds {
            return None;
        }
        session.settings.no_folds = true;
        session.settings.check().ok()?; // what it does not go with, it cannot help
        let watched = Watched::of(probe.places().to_vec(), session.points.dim()).ok()?;
        let composed = session.unfold(self.shared_weights(), &watched, &mut |_| true).ok()?;
        let then = composed.found().folded;
        (then <= now / 2.0)
            .then(|| format!("; in {} steps, with no_folds, it is {}", composed.steps().len(), percent(then)))
    }

    /// What of the shape folds all the same, in words.
    pub(crate) fn still_folded(&self) -> Option<String> {
        let composed = self.composed()?;
        let found = composed.found();
        (found.folded > 0.0).then(|| {
            format!(
                "{} of the shape folds over all the same, in {} steps, most of all at {} (det J {}): move the control points there less far \
                 towards or past each other",
                percent(found.folded),
                composed.steps().len(),
                place(&found.place),
                general(found.least, 2)
            )
        })
    }
}
