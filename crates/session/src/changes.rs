//! Settings that are said one by one: options of a command line, keywords of a call, fields of a panel.

use serde_json::{Map, Value};

use crate::files::json;
use crate::text::shown;
use crate::{Error, Session, Settings, WeightsSettings};

impl Settings {
    /// As a session file has them.
    pub fn to_json(&self) -> String {
        json::settings_value(self).to_string()
    }

    /// The same with those settings that `changes`, an object as in a session file, names; `null` stands for a default. Weights of another kind
    /// start from their defaults.
    ///
    /// # Errors
    /// An argument, where there is no such setting, it belongs to other weights, or is out of its range.
    pub fn with(&self, changes: &Map<String, Value>) -> Result<Settings, Error> {
        let Value::Object(mut keys) = json::settings_value(self) else {
            unreachable!("settings are written as an object")
        };
        for (key, value) in changes {
            let value = match (key.as_str(), value) {
                ("weights", Value::Object(parameters)) => Value::Object(self.weights(parameters)),
                _ => value.clone(),
            };
            if value.is_null() {
                keys.shift_remove(key);
            } else {
                keys.insert(key.clone(), value);
            }
        }
        let (settings, unknown) = json::read_settings(keys)?;
        let unknown =
            unknown.get("weights").and_then(Value::as_object).unwrap_or(&unknown).keys().next().cloned();
        match unknown {
            Some(key) => Err(Error::argument(format!("{}: there is no such setting", shown(&key)))),
            None => Ok(settings),
        }
    }

    /// [`Settings::with`], of JSON text; in a number's place it may say `NaN` or `Infinity`, which are refused by the setting's name.
    ///
    /// # Errors
    /// As there, and where the text is no JSON object.
    pub fn with_text(&self, changes: &str) -> Result<Settings, Error> {
        let read = json::parse(changes)
            .map_err(|error| Error::argument(format!("settings: expected a JSON object: {error}")))?;
        match read.value {
            Value::Object(changes) => self.with(&changes),
            other => {
                let found = json::found(Some(&other));
                Err(Error::argument(format!("settings: expected a JSON object, found {found}")))
            }
        }
    }

    /// The parameters of the weights with others in their place.
    fn weights(&self, changes: &Map<String, Value>) -> Map<String, Value> {
        let same = changes.get("kind").is_none_or(|kind| kind == self.weights.kind());
        let mut parameters = match json::settings_value(self) {
            Value::Object(keys) if same => {
                keys.get("weights").and_then(Value::as_object).cloned().unwrap_or_default()
            }
            _ => Map::new(),
        };
        parameters.extend(changes.iter().map(|(key, value)| (key.clone(), value.clone())));
        parameters
    }
}

impl WeightsSettings {
    /// As a session file has them.
    pub fn to_json(&self) -> String {
        let settings = Settings { weights: self.clone(), ..Settings::default() };
        json::settings_value(&settings)["weights"].to_string()
    }
}

impl Session {
    /// The same session with [`Settings::with_text`].
    ///
    /// # Errors
    /// As there.
    pub fn with_settings(&self, changes: &str) -> Result<Session, Error> {
        let settings = self.settings.with_text(changes)?;
        let has_settings = self.has_settings || settings != Settings::default();
        let mut session = Session { settings, has_settings, ..self.clone() };
        if session.settings.weights.kind() != self.settings.weights.kind() {
            // What others kept beside the former weights says nothing about these.
            if let Some(kept) = session.others.get_mut("settings").and_then(Value::as_object_mut) {
                kept.shift_remove("weights");
            }
        }
        Ok(session)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(changes: &str) -> Result<Settings, Error> {
        Settings::default().with(&serde_json::from_str(changes).unwrap())
    }

    #[test]
    fn what_is_said_goes_before_what_is_there() {
        let settings =
            with(r#"{"temperature": 2, "handles": 0.5, "relax": 0.25, "weights": {"width": 64}}"#).unwrap();
        assert_eq!((settings.temperature, settings.relax), (2.0, 0.25));
        let WeightsSettings::Neural { width, seed, .. } = settings.weights else {
            panic!("neural by default")
        };
        assert_eq!((width, seed), (64, 0));
        let changes =
            serde_json::from_str(r#"{"weights": {"seed": 3}, "handles": null, "relax": null}"#).unwrap();
        let further = settings.with(&changes).unwrap();
        let WeightsSettings::Neural { width, seed, .. } = further.weights else { panic!("still neural") };
        assert_eq!((width, seed, further.handles), (64, 3, crate::HandlesSetting::Auto));
        assert_eq!(further.relax, 0.0);
    }

    #[test]
    fn other_weights_start_from_their_defaults() {
        let settings = with(r#"{"weights": {"kind": "inverse-distance", "alpha": 2}}"#).unwrap();
        assert_eq!(settings.weights, WeightsSettings::InverseDistance { alpha: 2.0, epsilon: 0.0 });
        assert_eq!(settings.weights.to_json(), r#"{"kind":"inverse-distance","alpha":2,"epsilon":0}"#);
    }

    #[test]
    fn a_text_of_settings_is_an_object_of_finite_numbers() {
        let says = |changes| Settings::default().with_text(changes).unwrap_err().message;
        assert_eq!(says("[1]"), "settings: expected a JSON object, found [1]");
        assert!(says("{").starts_with("settings: expected a JSON object: line 1, column"), "{}", says("{"));
        assert_eq!(
            says(r#"{"weights": {"rate": Infinity}}"#),
            "rate: expected a number above 0, found Infinity"
        );
        assert_eq!(says(r#"{"temperature": NaN}"#), "temperature: expected a number above 0, found NaN");
    }

    #[test]
    fn what_is_no_setting_is_named() {
        let says = |changes| with(changes).unwrap_err().message;
        assert_eq!(says(r#"{"colour": 1}"#), "colour: there is no such setting");
        assert_eq!(says(r#"{"weights": {"depth": 1}}"#), "depth: there is no such setting");
        assert_eq!(
            says(r#"{"weights": {"alpha": 1}}"#),
            "alpha belongs to inverse-distance weights, but the weights are neural"
        );
        assert_eq!(says(r#"{"temperature": -1}"#), "temperature: expected a number above 0, found -1");
        assert_eq!(says(r#"{"no_folds": 1}"#), "no_folds: expected true or false, found 1");
        let expected = "relax: expected a number of at least 0 and at most 1, found";
        assert_eq!(says(r#"{"relax": 1.5}"#), format!("{expected} 1.5"));
        assert_eq!(says(r#"{"relax": "much"}"#), format!("{expected} 'much'"));
    }
}
