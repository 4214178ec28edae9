//! What happened to the control points, and what a person should know of it, in words.

use neuralmls_core::{softmax, Aim, Composed, Soft, Weights};

use serde_json::json;

use crate::map::ARRIVED;
use crate::text::{general, listed, names, quoted};
use crate::words::{distance, percent, remedy_in_words};
use crate::{ControlPoints, Error, HandlesSetting, Map, WeightsSettings};

/// A control point with less of the weight at its own place shares it; the training aims at 0.9.
const OWNED: f64 = 0.85;
/// A network that did not learn so much of the shape. On 34 manufactured shapes and five animals with 12 control points it is at most 0.007,
/// with 40 at most 0.019 (studies/shape_aware_law.py).
const MISSED: f64 = 0.02;
/// A file whose numbers are farther apart than this part of the longest move does not hold the motion.
const HELD: f64 = 0.01;

/// How one control point fared.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrival {
    /// Its name.
    pub name: String,
    /// How far where it is to go is from its place at rest.
    pub moved: f64,
    /// How far it ends from where it is to go (its target, but in a group, or locked), in the file as it is written.
    pub distance_to_target: f64,
    /// Of an oriented one: by how many degrees it was to turn, how many are missing, and its scale.
    pub orientation: Option<OrientationArrival>,
}

/// How the rotation of an oriented control point fared.
#[derive(Clone, Debug, PartialEq)]
pub struct OrientationArrival {
    /// By how much it was to turn.
    pub degrees: f64,
    /// The angle between the rotation there and the one that was asked for.
    pub degrees_to_rotation: f64,
    /// How much larger its surroundings were to become.
    pub scale: f64,
}

/// What happened.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Each control point, in their order.
    pub control_points: Vec<Arrival>,
    /// How closely they were met, in a few words.
    pub handles: String,
    /// Why all of them were left soft although more was asked for, and what would help; none where they were not.
    pub soft: Option<String>,
    /// That control points do not arrive, one of the warnings; [`Map::advise`] says it too, by other means.
    pub not_arrived: Option<String>,
    /// What a person should know, a sentence each.
    pub warnings: Vec<String>,
    /// Where the control points land, m x d.
    pub places: Vec<f64>,
    /// How many steps the map takes; 1 without `no_folds`.
    pub steps: usize,
    /// With `no_folds`: the least `det J` that was found on the shape and around it, at places other than those of the search.
    pub least: Option<f64>,
    /// With `no_folds`: which part of the shape folds over all the same.
    pub folded: Option<f64>,
}

impl Report {
    /// For a face that takes JSON.
    pub fn to_json(&self) -> String {
        let distances: Vec<f64> = self.control_points.iter().map(|point| point.distance_to_target).collect();
        json!({
            "places": self.places,
            "distances": distances,
            "handles": self.handles,
            "soft": self.soft,
            "warnings": self.warnings,
            "steps": self.steps,
            "least": self.least,
            "folded": self.folded,
        })
        .to_string()
    }
}

/// What a file can hold: its numbers are rounded as it writes them.
pub struct Held<'a> {
    /// What the file is called in a sentence: its format.
    pub format: &'a str,
    /// Places as the file would hold them.
    pub round: &'a dyn Fn(&[f64]) -> Vec<f64>,
    /// The distance between neighbouring numbers of the file at the shape's place; 0 where they are as close as doubles.
    pub step: f64,
}

impl Map {
    /// What happens to the control points by `aim`; `held`: in a file of this kind, else in double precision.
    ///
    /// # Errors
    /// As [`Map::aim`].
    pub fn report(&self, aim: &Aim, held: Option<&Held<'_>>) -> Result<Report, Error> {
        let points = &self.session().points;
        let (dim, posed, stay) = (points.dim(), self.session().posed(), points.stay());
        let landed = self.landed(aim)?;
        let arrived = held.map_or_else(|| landed.positions.clone(), |held| (held.round)(&landed.positions));
        let maps = landed.maps.unwrap_or_default();
        let control_points: Vec<Arrival> = points
            .iter()
            .enumerate()
            .map(|(i, point)| Arrival {
                name: point.name.clone(),
                moved: distance(&posed.targets[dim * i..][..dim], &point.position),
                distance_to_target: distance(&arrived[dim * i..][..dim], &posed.targets[dim * i..][..dim]),
                orientation: point.orientation.filter(|_| !stay[i]).map(|orientation| OrientationArrival {
                    degrees: orientation.degrees,
                    degrees_to_rotation: angle(
                        &maps[dim * dim * i..][..dim * dim],
                        &orientation.matrix(),
                        dim,
                    ),
                    scale: orientation.scale,
                }),
            })
            .collect();
        let in_steps = self.steps().is_some(); // what else would help is known of one step only
        let remedy = match !in_steps && (aim.soft.is_some() || self.any_short(aim)) {
            true => self.remedy()?,
            false => None,
        };
        let soft = self.why_soft(aim, remedy.as_deref());
        let not_arrived = match soft {
            None => self.not_arrived(aim, remedy.as_deref()),
            Some(_) => None,
        };
        let mut warnings = points.left_by_holding(&posed, self.transform(), ARRIVED * self.side());
        warnings.extend(self.not_parted()?.into_iter().chain(self.missed()).chain(not_arrived.clone()));
        let longest = control_points.iter().map(|point| point.moved).fold(0.0, f64::max);
        let coarse = held.and_then(|held| not_held(held, longest));
        let handles = self.in_words(soft.is_some(), self.any_short(aim), coarse.is_some());
        warnings.extend(coarse);
        warnings.extend(self.still_folded());
        let found = self.composed().map(Composed::found);
        Ok(Report {
            control_points,
            handles,
            soft,
            not_arrived,
            warnings,
            places: arrived,
            steps: self.composed().map_or(1, |composed| composed.steps().len()),
            least: found.map(|found| found.least),
            folded: found.map(|found| found.folded),
        })
    }

    /// Whether one stays short of where it was to go.
    fn any_short(&self, aim: &Aim) -> bool {
        aim.misses.iter().any(|miss| *miss > ARRIVED * self.side())
    }

    fn in_words(&self, soft: bool, short: bool, coarse: bool) -> String {
        match self.session().settings.handles {
            HandlesSetting::Soft => "soft".into(),
            _ if soft => "left soft".into(),
            HandlesSetting::Part(part) => format!("{} of the way", general(part, 6)),
            _ if short => "as far as they go".into(),
            _ if self.session().points.iter().any(|point| point.weight < 1.0) => {
                "as closely as their weights say".into()
            }
            _ if coarse => "exact, but for the file's steps".into(),
            _ => "exact".into(),
        }
    }

    /// With what the control points would arrive, in words; none where nothing that was tried helps.
    pub(crate) fn remedy(&self) -> Result<Option<String>, Error> {
        let posed = self.session().posed();
        let adherence = match self.session().settings.handles {
            HandlesSetting::Soft => self.session().points.weights(),
            _ => self.session().adherence(),
        };
        let found = self.handles().remedy(posed.pose(), self.session().settings.temperature, &adherence)?;
        Ok(found.map(remedy_in_words))
    }

    /// Why all control points were left soft, and what would take them to their targets.
    fn why_soft(&self, aim: &Aim, remedy: Option<&str>) -> Option<String> {
        let Some(Soft::Shared(control_point, owned)) = aim.soft else {
            return None;
        };
        let name = quoted(&self.session().points[control_point].name);
        let mut said = format!("{name} has only {} of the weight at its own place", general(owned, 2));
        if let Some(remedy) = remedy {
            said += &format!("; {remedy} they arrive");
        }
        if matches!(self.session().settings.weights, WeightsSettings::Neural { steps: Some(_), .. }) {
            said += "; without a fixed number of steps it is trained until they own their places";
        }
        Some(said)
    }

    /// Control points that the whole training did not part, and which then move together.
    fn not_parted(&self) -> Result<Option<String>, Error> {
        let steps = match (self.weights(), &self.session().settings.weights) {
            (Weights::Neural(trained), WeightsSettings::Neural { steps: None, .. }) => trained.losses.len(),
            _ => return Ok(None),
        };
        let points = &self.session().points;
        let (m, logits) = (points.len(), self.handles().logits());
        let mut w = vec![0.0; m];
        let mut shared: Vec<(f64, usize)> = Vec::new();
        for (i, logits) in logits.chunks_exact(m).enumerate() {
            softmax::weights(logits, 1.0, &mut w);
            if w[i] < OWNED {
                shared.push((w[i], i));
            }
        }
        if shared.is_empty() {
            return Ok(None);
        }
        shared.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(Some(format!(
            "after {} steps of training, control points still share their places with others, and stop short of their targets: {}; \
             they are probably too close together",
            thousands(steps),
            names(shared.iter().map(|(_, i)| &*points[*i].name))
        )))
    }

    /// How much of the shape was to follow control points and does not, as the network did not learn it: it cannot change within too small gaps.
    fn missed(&self) -> Option<String> {
        let parts = &self.trained()?.missed;
        let in_all: f64 = parts.iter().sum();
        let points = &self.session().points;
        let mut worst: Vec<usize> = (0..parts.len()).filter(|&i| parts[i] > 0.1 * in_all).collect();
        worst.sort_by(|&a, &b| parts[b].total_cmp(&parts[a]));
        (in_all > MISSED).then(|| {
            format!(
                "{} of the shape does not follow the control point that is nearest along it, above all {}: what the network learns cannot \
                 change across so small gaps; give those parts more control points, or move neighbours alike",
                percent(in_all),
                names(worst.iter().map(|&i| &*points[i].name))
            )
        })
    }

    /// Control points that were to be taken to their targets, as far as handles and weights say, and are not.
    fn not_arrived(&self, aim: &Aim, remedy: Option<&str>) -> Option<String> {
        let (_, named) = short_of(&self.session().points, &aim.misses, ARRIVED * self.side())?;
        let way_out = match remedy {
            Some(remedy) => format!("{remedy} they arrive"),
            None => "move them less, or try a lower temperature or the affine transform".into(),
        };
        Some(format!(
            "control points do not arrive exactly: {named}; their targets contradict each other under this transform: {way_out}"
        ))
    }
}

/// Which control points are farther off than is allowed, the farthest first, and the same in words; `None` where none is.
pub(crate) fn short_of(points: &ControlPoints, away: &[f64], allowed: f64) -> Option<(Vec<usize>, String)> {
    let mut short: Vec<usize> = (0..points.len()).filter(|&i| away[i] > allowed).collect();
    short.sort_by(|&a, &b| away[b].total_cmp(&away[a]));
    let named = |&i: &usize| format!("{} by {}", quoted(&points[i].name), general(away[i], 3));
    (!short.is_empty()).then(|| (short.clone(), listed(short.iter().map(named))))
}

/// That a file's numbers are too far apart for the motion.
fn not_held(held: &Held<'_>, longest: f64) -> Option<String> {
    (longest > 0.0 && held.step > HELD * longest).then(|| {
        format!(
            "this {} file holds coordinates in steps of {} here, too coarse for moves of at most {}: what was written is what is \
             reported; move the shape nearer to the origin, or use a file of double precision",
            held.format,
            general(held.step, 3),
            general(longest, 3)
        )
    })
}

/// The angle in degrees between the rotation nearest to a map (dim x dim) and a rotation (3 x 3), both row-major.
fn angle(map: &[f64], rotation: &[f64; 9], dim: usize) -> f64 {
    match dim {
        1 => 0.0,
        2 => angle_in::<2>(map, rotation, |trace| trace / 2.0),
        _ => angle_in::<3>(map, rotation, |trace| (trace - 1.0) / 2.0),
    }
}

fn angle_in<const D: usize>(map: &[f64], rotation: &[f64; 9], cosine: impl Fn(f64) -> f64) -> f64 {
    // The best rotation maximises tr(R C): C is the transpose of what is to be turned back, `map rotation^T`.
    let c = std::array::from_fn(|r| {
        std::array::from_fn(|c| (0..D).map(|k| map[D * c + k] * rotation[3 * r + k]).sum())
    });
    let missing = neuralmls_core::best_rotation::<D>(&c);
    let trace: f64 = (0..D).map(|k| missing[k][k]).sum();
    cosine(trace).clamp(-1.0, 1.0).acos().to_degrees()
}

/// A whole number with commas.
fn thousands(number: usize) -> String {
    let digits = number.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().map(|group| std::str::from_utf8(group).expect("digits")).collect();
    groups.join(",")
}
