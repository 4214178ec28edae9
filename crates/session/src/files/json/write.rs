//! A session as the text of a session file, version 2.

use serde_json::{json, Map, Number, Value};

use super::style::line;
use super::FORMAT;
use crate::control_points::ControlPoint;
use crate::session::Session;
use crate::settings::{HandlesSetting, Settings, WeightsSettings, TRANSFORMS};
use crate::text;

/// One control point a line.
pub(crate) fn json_text(session: &Session) -> String {
    let dim = session.points.dim();
    let points: Vec<String> =
        session.points.iter().map(|point| format!("    {}", line(&entry(point, dim)))).collect();
    let mut out = format!("{{\n  \"format\": \"{FORMAT}\",\n  \"version\": 2,\n  \"control_points\": [\n");
    out += &points.join(",\n");
    out += "\n  ]";
    let mut rest = Map::new();
    if session.has_settings || session.settings != Settings::default() {
        rest.insert(
            "settings".into(),
            with(settings_value(&session.settings), session.others.get("settings")),
        );
    }
    if let Some(frame) = &session.frame {
        let corners = json!({"min": numbers(&frame.min), "max": numbers(&frame.max)});
        rest.insert("frame".into(), with(corners, session.others.get("frame")));
    }
    let own = ["format", "version", "control_points", "settings", "frame"];
    rest.extend(session.others.iter().filter(|(key, _)| !own.contains(&&***key)).map(owned));
    for (key, value) in rest {
        out += &format!(",\n  {}: {}", line(&Value::String(key)), line(&value));
    }
    out + "\n}\n"
}

fn entry(point: &ControlPoint, dim: usize) -> Value {
    let mut entry = Map::new();
    entry.insert("name".into(), point.name.clone().into());
    entry.insert("position".into(), numbers(&point.position));
    entry.insert("target".into(), numbers(&point.target));
    if let Some(orientation) = &point.orientation {
        let degrees = number(orientation.degrees);
        let rotation = match dim {
            1 => None,
            2 => Some(json!({"degrees": degrees})),
            _ => Some(json!({"axis": numbers(&orientation.axis), "degrees": degrees})),
        };
        if let Some(rotation) = rotation {
            entry.insert("rotation".into(), with(rotation, point.others.get("rotation")));
        }
        if orientation.scale != 1.0 || dim == 1 {
            entry.insert("scale".into(), number(orientation.scale));
        }
    }
    if point.weight != 1.0 {
        entry.insert("weight".into(), number(point.weight));
    }
    if point.locked {
        entry.insert("locked".into(), true.into());
    }
    for (key, text) in [("mirror_of", &point.mirror_of), ("group", &point.group)] {
        if let Some(text) = text {
            entry.insert(key.into(), text.clone().into());
        }
    }
    let own = ["name", "position", "target", "rotation", "scale", "weight", "locked", "mirror_of", "group"];
    entry.extend(point.others.iter().filter(|(key, _)| !own.contains(&&***key)).map(owned));
    Value::Object(entry)
}

pub(crate) fn settings_value(settings: &Settings) -> Value {
    let optional = |value: Option<f64>| value.map_or(Value::Null, number);
    let mut weights = Map::new();
    weights.insert("kind".into(), settings.weights.kind().into());
    match settings.weights {
        WeightsSettings::Neural { width, steps, seed, rate, fourier_sigma } => {
            weights.insert("width".into(), width.into());
            weights.insert("steps".into(), steps.into());
            weights.insert("seed".into(), seed.into());
            weights.insert("rate".into(), number(rate));
            weights.insert("fourier_sigma".into(), optional(fourier_sigma));
        }
        WeightsSettings::ShapeAware { seed } => {
            weights.insert("seed".into(), seed.into());
        }
        WeightsSettings::InverseDistance { alpha, epsilon } => {
            weights.insert("alpha".into(), number(alpha));
            weights.insert("epsilon".into(), number(epsilon));
        }
    }
    let transform = TRANSFORMS.iter().find(|(_, transform)| *transform == settings.transform);
    let handles = match settings.handles {
        HandlesSetting::Auto => "auto".into(),
        HandlesSetting::Exact => "exact".into(),
        HandlesSetting::Soft => "soft".into(),
        HandlesSetting::Part(share) => number(share),
    };
    json!({
        "weights": weights,
        "transform": transform.map_or("rigid", |(name, _)| name),
        "temperature": number(settings.temperature),
        "handles": handles,
        "relax": number(settings.relax),
        "no_folds": settings.no_folds,
    })
}

/// An object with the keys of other programs that it was read with, and those of the objects in it.
fn with(mut own: Value, others: Option<&Value>) -> Value {
    let (Value::Object(map), Some(Value::Object(others))) = (&mut own, others) else { return own };
    for (key, value) in others {
        match map.get_mut(key) {
            Some(inner @ Value::Object(_)) => *inner = with(inner.take(), Some(value)),
            Some(_) => {}
            None => {
                map.insert(key.clone(), value.clone());
            }
        }
    }
    own
}

fn owned((key, value): (&String, &Value)) -> (String, Value) {
    (key.clone(), value.clone())
}

fn numbers(values: &[f64]) -> Value {
    values.iter().map(|&value| number(value)).collect()
}

/// With as many digits as it takes to read back the same double.
fn number(value: f64) -> Value {
    text::number(value).parse::<Number>().map_or(Value::Null, Value::Number)
}
