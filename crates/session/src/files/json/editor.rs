//! What the browser editor wrote beside the control points in files of version 1.

use serde_json::{Map, Value};

use super::settings::{object, one_of, share, shared, weights, Keys, PARAMETERS};
use super::style::{found, line};
use super::values::{keep, passed_over};
use crate::control_points::{ControlPoint, ControlPoints};
use crate::error::Error;
use crate::session::Session;
use crate::settings::{HandlesSetting, Settings};
use crate::text::shown;

/// The session of these control points and of the settings under `editor`, in the terms of version 2: `adherence` is now
/// `handles`, `pairs` are `mirror_of`, and the mirror's axis is the editor's own.
pub fn session_of(
    keys: &mut Keys,
    list: &mut Vec<ControlPoint>,
    dim: usize,
    notes: &mut Vec<String>,
) -> Result<Session, Error> {
    let Some(Value::Object(editor)) = keys.get_mut("editor") else {
        return Ok(Session::new(ControlPoints::new(dim, std::mem::take(list))?));
    };
    if let Some(pairs) = editor.shift_remove("pairs") {
        take_pairs(&pairs, list, notes);
    }
    let mut session = Session::new(ControlPoints::new(dim, std::mem::take(list))?);
    let found = editor.shift_remove("settings").unwrap_or(Value::Object(Map::new()));
    let found = object(&found, "editor.settings")?;
    if !found.is_empty() {
        let (settings, mirror, rest) = read(found, notes).map_err(|error| error.at("editor.settings"))?;
        session.settings = settings;
        session.has_settings = true;
        if let Some(mirror) = mirror {
            editor.insert("mirror".into(), mirror.into());
        }
        keep(&mut session, "settings", rest);
    }
    if editor.is_empty() {
        keys.shift_remove("editor");
    }
    Ok(session)
}

fn read(mut keys: Keys, notes: &mut Vec<String>) -> Result<(Settings, Option<&'static str>, Keys), Error> {
    let mut settings = Settings::default();
    shared(&mut settings, &mut keys)?;
    if let Some(found) = keys.shift_remove("adherence") {
        settings.handles = match share("adherence", &found, "expected a number")? {
            1.0 => HandlesSetting::Auto,
            0.0 => HandlesSetting::Soft,
            part => HandlesSetting::Part(part),
        };
    }
    let kind = keys.shift_remove("kind").unwrap_or("neural".into());
    let kind = one_of("kind", &kind, &["neural", "classic"])?;
    // The parameters of the kind that was not chosen were not used.
    let [neural, classic] = ["neural", "classic"].map(|kind| keys.shift_remove(kind));
    let (found, kind) = if kind == "neural" { (neural, "neural") } else { (classic, "inverse-distance") };
    for key in ["weights", "handles", "relax", "no_folds"] {
        pass_over(key, &mut keys, notes);
    }
    let mut parameters = found.map_or(Ok(Keys::new()), |found| object(&found, kind))?;
    let known = if kind == "neural" { &["width", "steps", "seed"][..] } else { &["alpha", "epsilon"] };
    for key in
        PARAMETERS.iter().flat_map(|(_, names)| *names).chain(&["kind"]).filter(|key| !known.contains(key))
    {
        pass_over(key, &mut parameters, notes);
    }
    settings.weights = weights(kind, &mut parameters)?;
    if !parameters.is_empty() {
        keys.insert("weights".into(), parameters.into());
    }
    settings.check()?;
    let mirror = match keys.shift_remove("mirror") {
        None | Some(Value::Null) => None,
        Some(found) => Some(one_of("mirror", &found, &["x", "y", "z"])?),
    };
    Ok((settings, mirror, keys))
}

/// Leaves out another program's key that would mean something when the file is written again.
fn pass_over(key: &str, keys: &mut Keys, notes: &mut Vec<String>) {
    if keys.shift_remove(key).is_some() {
        notes.push(passed_over(key));
    }
}

/// Twins that mirror each other: the second is the mirror image of the first.
fn take_pairs(pairs: &Value, list: &mut [ControlPoint], notes: &mut Vec<String>) {
    let Value::Array(pairs) = pairs else {
        notes.push(format!(
            "editor.pairs: expected a list of pairs of names, found {}: passed over",
            found(Some(pairs))
        ));
        return;
    };
    let mut taken = Vec::new();
    for (i, pair) in pairs.iter().enumerate() {
        let names: Vec<&str> = pair.as_array().into_iter().flatten().filter_map(Value::as_str).collect();
        let places: Vec<usize> =
            names.iter().filter_map(|name| list.iter().position(|point| point.name == **name)).collect();
        match places[..] {
            [a, b] if names.len() == 2 && a != b && !taken.contains(&a) && !taken.contains(&b) => {
                taken.extend([a, b]);
                list[b].mirror_of = Some(list[a].name.clone());
            }
            _ => notes.push(format!(
                "editor.pairs[{i}]: expected two names of control points that are in no other pair, found {}: passed over",
                shown(&line(pair))
            )),
        }
    }
}
