//! Advice in words: what is likely bad about a deformation, where, and what would help. What is measured, and from when on it is told,
//! stands in the core.

use neuralmls_core::{Better, Kind, Look, Pose, Probe, Stiff, Transform};

use serde_json::{json, Value};

use crate::map::ARRIVED;
use crate::report::short_of;
use crate::text::{general, quoted};
use crate::words::{at_temperature, distance, percent, place};
use crate::{Error, HandlesSetting, Map};

/// A soft handle may stop short by this part of the longest move (study: up to 0.075) ...
const SHORT: f64 = 0.1;
/// ... and of the longest side (study: 0.011).
const WIDE: f64 = 0.02;

/// One thing that is likely bad.
#[derive(Clone, Debug, PartialEq)]
pub struct Advice {
    /// "misses", "stiff", "folds", "torn" or "ungoverned".
    pub kind: &'static str,
    /// What is likely bad, where, and what would help.
    pub sentence: String,
    /// The worst place, at rest.
    pub place: Vec<f64>,
    /// The control points that it is about, by their numbers, the worst first.
    pub control_points: Vec<usize>,
    /// How bad: the greatest distance from a target (misses), how far a control point ends from its target where the others alone take it
    /// (stiff), the part of the shape (folds), the greatest stretch (torn), the distance to the nearest control point (ungoverned).
    pub amount: f64,
}

/// A map of other weights, made when it is first asked for; none where there are none.
pub type Other<'a> = &'a mut dyn FnMut() -> Option<Map>;

impl Map {
    /// Places on the shape of points `x` (n x dim) and triangles to look at, bound to this map's weights.
    ///
    /// # Errors
    /// Where there are no points, or a face names none.
    pub fn probe(&self, x: &[f64], faces: &[[u32; 3]]) -> Result<Probe, Error> {
        let dim = self.session().points.dim();
        if x.is_empty() {
            return Err(Error::argument("x: expected at least one point, found none"));
        }
        let places = neuralmls_core::places(x, dim, faces, neuralmls_core::PLACES)?;
        let side = 2.0 * neuralmls_core::Frame::around(x, dim).half;
        self.probe_at(&places, side)
    }

    /// The same at places of a shape whose longest side is `side`.
    fn probe_at(&self, places: &[f64], side: f64) -> Result<Probe, Error> {
        let mut probe = Probe::new(self.weights(), places, side, self.transform(), true)?;
        if let Some(elastic) = self.shared_elastic() {
            probe = probe.with(elastic)?;
        }
        self.set_up(&mut probe);
        Ok(probe)
    }

    /// Lets a probe of this map's weights look at it with other settings.
    pub fn set_up(&self, probe: &mut Probe) {
        probe.set_transform(self.transform());
        probe.set_careful(self.session().settings.handles != HandlesSetting::Exact);
        probe.set_relax(self.session().settings.relax);
        probe.set_composed(self.steps().cloned());
    }

    /// What this map does at the places that are probed.
    ///
    /// # Errors
    /// As [`Map::aim`].
    pub fn look(&self, probe: &Probe) -> Result<Look, Error> {
        let posed = self.session().posed();
        Ok(probe.look(posed.pose(), self.session().settings.temperature, &self.session().adherence())?)
    }

    /// What is likely bad about the shape that was probed, and what would help; nothing where everything moves as one.
    ///
    /// What would help was tried: another temperature, soft handles and, where neither does, `other` weights are named only where they at
    /// least halve it; exact handles only where they arrive. Where `unfolds`, `no_folds` is tried for folds, which takes as long as a fit with it.
    ///
    /// # Errors
    /// As [`Map::aim`].
    pub fn advise(&self, probe: &Probe, other: Other<'_>, unfolds: bool) -> Result<Vec<Advice>, Error> {
        let (points, settings) = (&self.session().points, &self.session().settings);
        let posed = self.session().posed();
        let pose = posed.pose();
        let mut found: Vec<Advice> = self.misses()?.into_iter().chain(self.stiff()?).collect();
        for advice in probe.advise(pose, settings.temperature, &self.session().adherence())? {
            let dim = points.dim();
            let at = probe.places()[dim * advice.place..][..dim].to_vec();
            let [first, second] = advice.near;
            let (kind, amount, sentence, near) = match advice.kind {
                Kind::Folds(part) => {
                    let help = match advice.better {
                        Some(better) => better_in_words(better),
                        None => self.with_other(probe, pose, other, |(folded, _)| folded)?.unwrap_or(
                            "move the control points there less far towards or past each other".into(),
                        ),
                    };
                    let in_steps = if unfolds { self.in_steps(probe, part) } else { None };
                    let sentence = format!(
                        "{} of the shape is folded over, most of all near {}, at {}; {help}{}",
                        percent(part),
                        quoted(&points[first].name),
                        place(&at),
                        in_steps.unwrap_or_default()
                    );
                    ("folds", part, sentence, vec![first])
                }
                Kind::Torn(stretch) => {
                    let help = match advice.better {
                        Some(better) => better_in_words(better),
                        None => self
                            .with_other(probe, pose, other, |(_, torn)| torn)?
                            .unwrap_or("move them less far apart, or put control points between them".into()),
                    };
                    let sentence = format!(
                        "the shape is torn between {} and {}, stretched up to {stretch:.0} times at {}; {help}",
                        quoted(&points[first].name),
                        quoted(&points[second].name),
                        place(&at)
                    );
                    ("torn", stretch, sentence, vec![first, second])
                }
                Kind::Ungoverned(spacings) => {
                    let away = distance(&at, &points[first].position);
                    let sentence = format!(
                        "no control point governs the part around {}, which moves all the same: the nearest, {}, is {} away, {spacings:.1} \
                         times as far as they are from each other; put a control point there",
                        place(&at),
                        quoted(&points[first].name),
                        general(away, 3)
                    );
                    ("ungoverned", away, sentence, vec![first])
                }
            };
            found.push(Advice { kind, sentence, place: at, control_points: near, amount });
        }
        Ok(found)
    }

    /// Control points that stop short of their targets.
    fn misses(&self) -> Result<Option<Advice>, Error> {
        let points = &self.session().points;
        let (dim, aim, posed) = (points.dim(), self.aim()?, self.session().posed());
        let landed = self.landed(&aim)?.positions;
        let each = |a: &[f64], b: &[f64]| -> Vec<f64> {
            a.chunks_exact(dim).zip(b.chunks_exact(dim)).map(|(a, b)| distance(a, b)).collect()
        };
        let away = each(&posed.targets, &landed);
        let longest = each(&posed.targets, &points.sources()).into_iter().fold(0.0, f64::max);
        let mut allowed = ARRIVED * self.side();
        if self.session().settings.handles == HandlesSetting::Soft {
            allowed = allowed.max((SHORT * longest).min(WIDE * self.side()));
        }
        let Some((short, named)) = short_of(points, &away, allowed) else {
            return Ok(None);
        };
        let worst = short[0];
        Ok(Some(Advice {
            kind: "misses",
            sentence: format!(
                "control points stop short of their targets, with {} handles: {}; {}",
                self.session().settings.handles.name(),
                named,
                self.what_arrives()?
            ),
            place: points[worst].position.clone(),
            control_points: short,
            amount: away[worst],
        }))
    }

    /// Many control points whose motion is none that the transform can follow between them.
    fn stiff(&self) -> Result<Option<Advice>, Error> {
        let (points, posed) = (&self.session().points, self.session().posed());
        let found = self.handles().stiff(posed.pose(), self.session().settings.temperature)?;
        let Some(Stiff { now, affine, worst }) = found else {
            return Ok(None);
        };
        let transform = if self.transform() == Transform::Similarity { "similarity" } else { "rigid" };
        Ok(Some(Advice {
            kind: "stiff",
            sentence: format!(
                "{transform} maps follow these {} control points worse than affine ones would: where the others alone take it, one ends {} \
                 from its target, in the median, with the affine transform {}",
                points.len(),
                general(now, 2),
                general(affine, 2)
            ),
            place: points[worst].position.clone(),
            control_points: vec![worst],
            amount: now,
        }))
    }

    /// What takes the control points to their targets.
    fn what_arrives(&self) -> Result<String, Error> {
        let points = &self.session().points;
        let posed = self.session().posed();
        let temperature = self.session().settings.temperature;
        let aim = self.handles().aim_carefully(posed.pose(), temperature, &points.weights())?;
        Ok(match (aim.soft, self.remedy()?) {
            (None, _) => "exact handles arrive".into(),
            (_, Some(remedy)) => format!("exact handles arrive {remedy}"),
            _ => "even exact handles, a lower temperature or the affine transform do not take them there: move them less".into(),
        })
    }

    /// Whether other weights at least halve a part of the shape, in words.
    fn with_other(
        &self,
        probe: &Probe,
        pose: Pose<'_>,
        other: Other<'_>,
        part: impl Fn((f64, f64)) -> f64,
    ) -> Result<Option<String>, Error> {
        if self.steps().is_some() {
            return Ok(None);
        }
        let Some(other) = other() else {
            return Ok(None);
        };
        let (temperature, adherence) = (self.session().settings.temperature, self.session().adherence());
        let theirs = other.probe_at(probe.places(), probe.side())?;
        let now = part(probe.parts(pose, temperature, &adherence)?);
        let then = part(theirs.parts(pose, temperature, &adherence)?);
        Ok((then <= now / 2.0)
            .then(|| format!("with {} weights it is {}", other.weights().kind(), percent(then))))
    }
}

/// What the core has found to at least halve it.
fn better_in_words((better, part): (Better, f64)) -> String {
    let how = match better {
        Better::Temperature(other) => at_temperature(other),
        Better::Soft => "without exact handles".into(),
    };
    format!("{how} it is {}", percent(part))
}

/// Advice for a face that takes JSON: a list of kind, sentence, the control points' numbers, and how bad.
pub fn to_json(advice: &[Advice]) -> String {
    let told = |one: &Advice| json!({"kind": one.kind, "sentence": one.sentence, "control_points": one.control_points, "amount": one.amount});
    Value::Array(advice.iter().map(told).collect()).to_string()
}
