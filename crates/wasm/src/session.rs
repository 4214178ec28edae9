//! Sessions: control points and settings, read and written.

use wasm_bindgen::prelude::*;

use crate::refused;

/// Control points, settings, frame.
#[wasm_bindgen]
pub struct Session {
    pub(crate) session: neuralmls_session::Session,
    notes: Vec<String>,
}

#[wasm_bindgen]
impl Session {
    /// A file of control points of any kind; `name` is looked at for its ending only.
    ///
    /// # Errors
    /// One sentence without the file's name.
    pub fn read(bytes: &[u8], name: &str) -> Result<Session, JsError> {
        let read = neuralmls_session::read(bytes, name).map_err(refused)?;
        Ok(Session { session: read.session, notes: read.notes })
    }

    /// Where the control points of this session go, from a second file: by name, or by order.
    ///
    /// # Errors
    /// Where they have nothing in common.
    pub fn joined(&self, targets: &Session, by_order: bool) -> Result<Session, JsError> {
        let read = neuralmls_session::join(self.session.clone(), targets.session.clone(), by_order);
        let read = read.map_err(refused)?;
        let notes = [&self.notes[..], &targets.notes, &read.notes].concat();
        Ok(Session { session: read.session, notes })
    }

    /// What reading left out, a sentence each.
    pub fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// Coordinates a control point.
    pub fn dim(&self) -> usize {
        self.session.points.dim()
    }

    /// The text of a session file, version 2.
    pub fn to_json(&self) -> String {
        self.session.to_json()
    }

    /// The text of a landmark file.
    ///
    /// # Errors
    /// Where there are orientations, which it cannot hold.
    pub fn to_csv(&self) -> Result<String, JsError> {
        self.session.to_csv().map_err(refused)
    }

    /// What a person should know of the control points beside a shape with this box.
    ///
    /// # Errors
    /// Where they have another dimension.
    pub fn check(&self, min: &[f64], max: &[f64]) -> Result<Vec<String>, JsError> {
        self.session.points.check((min, max)).map_err(refused)
    }
}

/// What shaders, which have arithmetic of their own, take from the core: JSON.
#[wasm_bindgen]
pub fn constants() -> String {
    format!("{{\"anchor_weight\": {:e}}}", neuralmls_core::ANCHOR_WEIGHT)
}

/// The settings that hold where nothing is said, as a session file has them.
#[wasm_bindgen(js_name = defaultSettings)]
pub fn default_settings() -> String {
    neuralmls_session::Settings::default().to_json()
}

/// The settings of weights of a kind that hold where nothing is said.
///
/// # Errors
/// Where there is no such kind.
#[wasm_bindgen(js_name = defaultWeights)]
pub fn default_weights(kind: &str) -> Result<String, JsError> {
    neuralmls_session::WeightsSettings::of_kind(kind)
        .map(|weights| weights.to_json())
        .ok_or_else(|| refused(format!("there are no weights called {kind}")))
}
