//! Control points that arrive. The main thread has one of these for each frame of a drag; workers have it in their map.

use js_sys::Float64Array;
use neuralmls_session::Posed;
use wasm_bindgen::prelude::*;

use crate::refused;
use crate::session::Session;

/// The control points of a session as points that are moved themselves.
#[wasm_bindgen]
pub struct Handles {
    session: neuralmls_session::Session,
    core: neuralmls_core::Handles,
}

#[wasm_bindgen]
impl Handles {
    /// Of a session, with the logits at its control points' own places (m x m).
    ///
    /// # Errors
    /// Where the lengths do not fit.
    #[wasm_bindgen(constructor)]
    pub fn new(session: &Session, own_logits: Vec<f32>) -> Result<Handles, JsError> {
        let session = session.session().clone();
        let (p, dim) = (session.points.sources(), session.points.dim());
        let core = neuralmls_core::Handles::of_logits(&p, dim, own_logits, session.settings.transform);
        Ok(Handles { core: core.map_err(refused)?, session })
    }

    /// Other settings, or weights of control points, for the same control points at rest.
    pub fn set_session(&mut self, session: &Session) {
        self.session = session.session().clone();
        self.core.set_transform(self.session.settings.transform);
    }

    /// How far each control point is from the nearest other one, squared: what an oriented one counts by.
    pub fn squares(&self) -> Float64Array {
        Float64Array::from(&self.core.squares()[..])
    }

    /// Where to aim for the targets `q` (m x dim), oriented by `orientations` (m x dim x dim, NaN for those that are not; undefined: none is),
    /// but for what the session holds: m x dim numbers; then the map that fits all control points with equal weights, from `q` as they are
    /// aimed at: its rotation (9), its scale, its linear map (9), which the shader falls back on (dim x dim each); then the orientations, as
    /// groups and locks leave them.
    ///
    /// # Errors
    /// Where `q` does not fit.
    pub fn aim(&self, q: &[f64], orientations: Option<Vec<f64>>) -> Result<Float64Array, JsError> {
        let (points, transform) = (&self.session.points, self.session.settings.transform);
        let (dim, m) = (points.dim(), points.len());
        let fits = |numbers: &[f64], each: usize| numbers.len() == m * each;
        if !fits(q, dim) || !orientations.as_deref().is_none_or(|all| fits(all, dim * dim)) {
            return Err(refused(format!("expected targets and orientations of {m} control points")));
        }
        let posed = points.hold(Posed { targets: q.to_vec(), orientations }, transform);
        let aim = self.session.aim(&self.core, posed.pose()).map_err(refused)?;
        let anchor = self.core.anchor(&aim.targets, posed.orientations.as_deref()).map_err(refused)?;
        let orientations = posed.orientations.unwrap_or_else(|| vec![f64::NAN; m * dim * dim]);
        let numbers: Vec<f64> = aim
            .targets
            .into_iter()
            .chain(anchor.rotation)
            .chain([anchor.scale])
            .chain(anchor.linear)
            .chain(orientations)
            .collect();
        Ok(Float64Array::from(&numbers[..]))
    }
}
