//! The settings of a session file. Errors do not name the place: the caller does.

use std::fmt::Display;
use std::ops::RangeInclusive;

use neuralmls_core::Training;
use serde_json::{Map, Value};

use super::style::{found, found_setting};
use crate::error::Error;
use crate::settings::{not_a_count, HandlesSetting, Settings, WeightsSettings, TRANSFORMS};
use crate::Transform;

pub type Keys = Map<String, Value>;

/// Which parameters belong to which kind of weights.
pub const PARAMETERS: [(&str, &[&str]); 3] = [
    ("neural", &["width", "steps", "seed", "rate", "fourier_sigma"]),
    ("shape-aware", &["seed"]),
    ("inverse-distance", &["alpha", "epsilon"]),
];

/// Settings, and the keys that are not known, those of `weights` under that name.
pub fn read_settings(mut keys: Keys) -> Result<(Settings, Keys), Error> {
    let mut settings = Settings::default();
    let mut rest = Keys::new();
    if let Some(found) = keys.shift_remove("weights") {
        let mut parameters = object(&found, "weights")?;
        let kind = parameters.shift_remove("kind").unwrap_or("neural".into());
        let kinds = PARAMETERS.map(|(kind, _)| kind);
        settings.weights = weights(one_of("kind", &kind, &kinds)?, &mut parameters)?;
        refuse_others(&settings.weights, &parameters)?;
        if !parameters.is_empty() {
            rest.insert("weights".into(), parameters.into());
        }
    }
    shared(&mut settings, &mut keys)?;
    if let Some(found) = keys.shift_remove("handles") {
        settings.handles = handles(&found)?;
    }
    if let Some(found) = keys.shift_remove("relax") {
        settings.relax = share("relax", &found, "expected a number")?;
    }
    if let Some(found) = keys.shift_remove("no_folds") {
        settings.no_folds = flag("no_folds", &found)?;
    }
    settings.check()?;
    rest.extend(keys);
    Ok((settings, rest))
}

/// Transform and temperature, which every version calls so.
pub fn shared(settings: &mut Settings, keys: &mut Keys) -> Result<(), Error> {
    if let Some(found) = keys.shift_remove("temperature") {
        settings.temperature = number("temperature", &found, "above 0")?;
    }
    if let Some(found) = keys.shift_remove("transform") {
        let name = one_of("transform", &found, &TRANSFORMS.map(|(name, _)| name))?;
        let known = TRANSFORMS.iter().find(|(known, _)| *known == name);
        settings.transform = known.map_or(Transform::Rigid, |(_, transform)| *transform);
    }
    Ok(())
}

/// Weights of a kind, with the parameters that are among the keys. `null` is as if it were not there.
pub fn weights(kind: &str, keys: &mut Keys) -> Result<WeightsSettings, Error> {
    let mut weights = WeightsSettings::of_kind(kind).unwrap_or_default();
    let mut take = |key: &str| keys.shift_remove(key).filter(|value| !value.is_null());
    match &mut weights {
        WeightsSettings::Neural { width, steps, seed, rate, fourier_sigma } => {
            if let Some(found) = take("width") {
                *width = count("width", &found, Training::WIDTHS)?;
            }
            if let Some(found) = take("steps") {
                *steps = Some(count("steps", &found, Training::STEPS)?);
            }
            if let Some(found) = take("seed") {
                *seed = count("seed", &found, 0..=u64::MAX)?;
            }
            if let Some(found) = take("rate") {
                *rate = number("rate", &found, "above 0")?;
            }
            if let Some(found) = take("fourier_sigma") {
                *fourier_sigma = Some(number("fourier_sigma", &found, "above 0")?);
            }
        }
        WeightsSettings::ShapeAware { seed } => {
            if let Some(found) = take("seed") {
                *seed = count("seed", &found, 0..=u64::MAX)?;
            }
        }
        WeightsSettings::InverseDistance { alpha, epsilon } => {
            if let Some(found) = take("alpha") {
                *alpha = number("alpha", &found, "above 0")?;
            }
            if let Some(found) = take("epsilon") {
                *epsilon = number("epsilon", &found, "of at least 0")?;
            }
        }
    }
    Ok(weights)
}

/// A parameter of another kind of weights would do nothing, and nobody would know.
fn refuse_others(weights: &WeightsSettings, keys: &Keys) -> Result<(), Error> {
    for (kind, names) in PARAMETERS {
        if let Some(name) = names.iter().find(|name| keys.contains_key(**name)) {
            let found = weights.kind();
            let message = format!("{name} belongs to {kind} weights, but the weights are {found}");
            return Err(Error::argument(message));
        }
    }
    Ok(())
}

fn handles(found: &Value) -> Result<HandlesSetting, Error> {
    match found.as_str() {
        Some("auto") => Ok(HandlesSetting::Auto),
        Some("exact") => Ok(HandlesSetting::Exact),
        Some("soft") => Ok(HandlesSetting::Soft),
        _ => share("handles", found, "expected auto, exact, soft or a number").map(HandlesSetting::Part),
    }
}

/// A number from 0 to 1.
pub fn share(name: &str, found: &Value, expected: &str) -> Result<f64, Error> {
    match found.as_f64() {
        Some(share) if (0.0..=1.0).contains(&share) => Ok(share),
        _ => {
            let found = found_setting(found);
            let message = format!("{name}: {expected} of at least 0 and at most 1, found {found}");
            Err(Error::argument(message))
        }
    }
}

fn flag(name: &str, found: &Value) -> Result<bool, Error> {
    found.as_bool().ok_or_else(|| {
        Error::argument(format!("{name}: expected true or false, found {}", found_setting(found)))
    })
}

/// One of these texts.
pub fn one_of<'a>(name: &str, found: &Value, known: &[&'a str]) -> Result<&'a str, Error> {
    known.iter().find(|known| found.as_str() == Some(**known)).copied().ok_or_else(|| {
        let (known, found) = (known.join(" or "), found_setting(found));
        Error::argument(format!("{name}: expected {known}, found {found}"))
    })
}

/// The keys of an object.
pub fn object(value: &Value, place: &str) -> Result<Keys, Error> {
    match value {
        Value::Object(keys) => Ok(keys.clone()),
        other => Err(Error::file(format!("{place}: expected an object, found {}", found(Some(other))))),
    }
}

fn number(name: &str, found: &Value, expected: &str) -> Result<f64, Error> {
    found.as_f64().ok_or_else(|| {
        Error::argument(format!("{name}: expected a number {expected}, found {}", found_setting(found)))
    })
}

fn count<T>(name: &str, found: &Value, range: RangeInclusive<T>) -> Result<T, Error>
where
    T: TryFrom<u64> + PartialOrd + Display,
{
    let count =
        found.as_u64().and_then(|count| T::try_from(count).ok()).filter(|count| range.contains(count));
    count.ok_or_else(|| Error::argument(not_a_count(name, &range, found_setting(found))))
}
