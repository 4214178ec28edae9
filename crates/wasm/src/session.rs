//! Sessions: control points and settings, read and written.

use neuralmls_session::Read;
use wasm_bindgen::prelude::*;

use crate::refused;

/// Control points, settings, frame.
#[wasm_bindgen]
pub struct Session(Read);

impl Session {
    pub(crate) fn session(&self) -> &neuralmls_session::Session {
        &self.0.session
    }
}

#[wasm_bindgen]
impl Session {
    /// A file of control points of any kind; `name` is looked at for its ending only.
    ///
    /// # Errors
    /// One sentence without the file's name.
    pub fn read(bytes: &[u8], name: &str) -> Result<Session, JsError> {
        neuralmls_session::read(bytes, name).map(Session).map_err(refused)
    }

    /// Where the control points of this session go, from a second file: by name, or by order.
    ///
    /// # Errors
    /// Where they have nothing in common.
    pub fn joined(&self, targets: &Session, by_order: bool) -> Result<Session, JsError> {
        neuralmls_session::join(self.0.clone(), targets.0.clone(), by_order).map(Session).map_err(refused)
    }

    /// What reading left out, a sentence each.
    pub fn notes(&self) -> Vec<String> {
        self.0.notes.clone()
    }

    /// Coordinates a control point.
    pub fn dim(&self) -> usize {
        self.0.session.points.dim()
    }

    /// The text of a session file, version 2.
    pub fn to_json(&self) -> String {
        self.0.session.to_json()
    }

    /// What a person should know of the control points beside a shape with this box.
    ///
    /// # Errors
    /// Where they have another dimension.
    pub fn check(&self, min: &[f64], max: &[f64]) -> Result<Vec<String>, JsError> {
        self.0.session.points.check((min, max)).map_err(refused)
    }
}

/// What shaders, which have arithmetic of their own, take from the core: JSON.
#[wasm_bindgen]
pub fn constants() -> String {
    let (anchor_weight, ridge) = (neuralmls_core::ANCHOR_WEIGHT, neuralmls_core::RIDGE);
    format!("{{\"anchor_weight\": {anchor_weight:e}, \"ridge\": {ridge:e}}}")
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
