//! Honest advice: where a deformation is likely bad, and which setting would help.
//!
//! The thresholds were set on what people did to the chairs and airplanes of the paper's user study, none of
//! which looks torn: each lies beyond what those cases reach (studies/advice_thresholds.py, docs/notes/beyond-the-paper.md).

use crate::aim::greatest;
use crate::deformer::Pose;
use crate::error::Error;
use crate::probe::{distance, Look, Probe};

/// This part of the places may be folded (study: 0.0003 at most, but for one true fold of 0.003 to 0.011).
const FOLDED: f64 = 0.002;
/// A stretch may be so many times that of most of the shape (study: 3.3 at most) ...
const STRETCH: f64 = 4.0;
/// ... but on this part of the places: bands where weights switch are thin.
const TORN: f64 = 0.0005;
/// A place may be so many spacings away from all control points (study: up to 0.83; points spread by farthest-point sampling: about 1) ...
const FAR: f64 = 1.5;
/// ... if it moves by more than this part of the longest side.
const MOVED: f64 = 0.01;

/// What is likely bad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Space is turned inside out, `det J <= 0`, in this part of the places.
    Folds(f64),
    /// Parts move apart, so that `J` stretches so many times as much as in most places.
    Torn(f64),
    /// What moves is so many spacings of the control points away from the nearest of them.
    Ungoverned(f64),
}

/// One thing that is likely bad.
#[derive(Clone, Debug, PartialEq)]
pub struct Advice {
    /// What.
    pub kind: Kind,
    /// Which place is the worst.
    pub place: usize,
    /// The two control points with the most weight there, the one that has most first; of what is ungoverned, the nearest one.
    pub near: [usize; 2],
    /// Which other setting at least halves it, and to which part of the places.
    pub better: Option<(Better, f64)>,
}

/// Another setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Better {
    /// Another temperature.
    Temperature(f64),
    /// No exact handles.
    Soft,
}

impl Look {
    fn folded(&self) -> f64 {
        part(&self.determinants, |det| det <= 0.0)
    }

    fn torn(&self) -> f64 {
        part(&self.stretches, |stretch| stretch > STRETCH)
    }
}

impl Probe {
    /// What is likely bad when the control points go to the targets of `pose` (m x dim), soft or exact by the adherence; nothing where everything moves as one.
    ///
    /// # Errors
    /// As [`Handles::aim`].
    pub fn advise<'a>(
        &self,
        pose: impl Into<Pose<'a>>,
        temperature: f64,
        adherence: &[f64],
    ) -> Result<Vec<Advice>, Error> {
        let pose = pose.into();
        let look = self.look(pose, temperature, adherence)?;
        if look.alike {
            return Ok(Vec::new());
        }
        let mut found = Vec::new();
        if look.folded() > FOLDED {
            let place = greatest(look.determinants.iter().map(|det| -det)).0;
            let better = self.better(pose, temperature, adherence, Look::folded, look.folded())?;
            let near = self.governing(place, temperature);
            found.push(Advice { kind: Kind::Folds(look.folded()), place, near, better });
        }
        if look.torn() > TORN {
            let (place, stretch) = greatest(look.stretches.iter().copied());
            let better = self.better(pose, temperature, adherence, Look::torn, look.torn())?;
            let near = self.governing(place, temperature);
            found.push(Advice { kind: Kind::Torn(stretch), place, near, better });
        }
        found.extend(self.ungoverned(&look));
        Ok(found)
    }

    /// The part of the places that is folded, and the part that is torn.
    ///
    /// # Errors
    /// As [`Handles::aim`].
    pub fn parts<'a>(
        &self,
        pose: impl Into<Pose<'a>>,
        temperature: f64,
        adherence: &[f64],
    ) -> Result<(f64, f64), Error> {
        let pose = pose.into();
        let look = self.look(pose, temperature, adherence)?;
        Ok((look.folded(), look.torn()))
    }

    fn ungoverned(&self, look: &Look) -> Option<Advice> {
        let far = self.far();
        let moves = |place: usize| {
            let dim = self.places().len() / far.len();
            let [from, to] = [self.places(), &look.positions].map(|x| &x[dim * place..][..dim]);
            distance(from, to) > MOVED * self.side()
        };
        let (place, away) =
            greatest(far.iter().enumerate().map(|(place, &(far, _))| if moves(place) { far } else { 0.0 }));
        let near = [far[place].1; 2];
        (away > FAR).then_some(Advice { kind: Kind::Ungoverned(away), place, near, better: None })
    }

    /// Which other setting at least halves a part of the places, if one does.
    fn better(
        &self,
        pose: Pose<'_>,
        temperature: f64,
        adherence: &[f64],
        part: impl Fn(&Look) -> f64,
        now: f64,
    ) -> Result<Option<(Better, f64)>, Error> {
        if self.is_composed() {
            // Another setting would want steps of its own.
            return Ok(None);
        }
        let mut best: Option<(Better, f64)> = None;
        let mut offer = |better: Better, look: &Look| {
            if part(look) < best.map_or(f64::INFINITY, |(_, part)| part) {
                best = Some((better, part(look)));
            }
        };
        for other in [1.0, temperature / 2.0, temperature * 2.0] {
            if other != temperature {
                offer(Better::Temperature(other), &self.look(pose, other, adherence)?);
            }
        }
        if adherence.iter().any(|part| *part > 0.0) {
            offer(Better::Soft, &self.look(pose, temperature, &[0.0])?);
        }
        Ok(best.filter(|(_, part)| *part <= now / 2.0))
    }
}

fn part(values: &[f64], is: impl Fn(f64) -> bool) -> f64 {
    values.iter().filter(|value| is(**value)).count() as f64 / values.len() as f64
}

#[cfg(test)]
mod tests;
