//! Control points that arrive. The main thread has one of these for each frame of a drag; workers have it in their fit.

use js_sys::{Array, Float64Array};
use neuralmls_core::{Aim, Error, Pose, Remedy, Transform};
use wasm_bindgen::prelude::*;

use crate::refused;

/// The control points as points that are moved themselves.
#[wasm_bindgen]
pub struct Handles(neuralmls_core::Handles);

#[wasm_bindgen]
impl Handles {
    /// Of the control points `p` (m x dim), with the logits at their own places (m x m).
    ///
    /// # Errors
    /// Where the lengths do not fit.
    #[wasm_bindgen(constructor)]
    pub fn new(p: &[f64], dim: usize, own_logits: Vec<f32>) -> Result<Handles, JsError> {
        Handles::of(p, dim, own_logits).map_err(refused)
    }

    /// Where to aim for the targets `q` (m x dim), turned by `turns` (m x dim x dim, NaN for those that are not; undefined: none is): as
    /// [`neuralmls_core::Handles::aim_carefully`] has it.
    ///
    /// # Errors
    /// Where `q` does not fit, or a number is out of its range.
    pub fn aim(
        &mut self,
        q: &[f64],
        turns: Option<Vec<f64>>,
        transform: &str,
        temperature: f64,
        adherence: f64,
    ) -> Result<Float64Array, JsError> {
        let pose = Pose { q, orientations: turns.as_deref() };
        Ok(Float64Array::from(&self.aimed(pose, transform, temperature, adherence)?.targets[..]))
    }

    /// Where the control points land when they are pulled to `q` (m x dim); then, where they do not arrive as the adherence says:
    /// "shared" (they are left soft) or "unreached", the control point to blame, how much, and what helps: "affine", a temperature, or null.
    ///
    /// # Errors
    /// As [`Handles::aim`].
    pub fn land(
        &mut self,
        q: &[f64],
        turns: Option<Vec<f64>>,
        transform: &str,
        temperature: f64,
        adherence: f64,
    ) -> Result<Array, JsError> {
        let pose = Pose { q, orientations: turns.as_deref() };
        let Aim { targets, soft, .. } = self.aimed(pose, transform, temperature, adherence)?;
        let landed = self.0.land(Pose { q: &targets, ..pose }, temperature).map_err(refused)?;
        let result = Array::of1(&Float64Array::from(&landed[..]));
        if let Some(soft) = soft {
            let (reason, control_point, amount) = soft.named();
            let remedy = match self.0.remedy(pose, temperature, &[adherence]).map_err(refused)? {
                Some(Remedy::Temperature(other)) => JsValue::from_f64(other),
                Some(Remedy::Affine) => JsValue::from_str("affine"),
                None => JsValue::NULL,
            };
            result.push(&JsValue::from_str(reason));
            result.push(&JsValue::from_f64(control_point as f64));
            result.push(&JsValue::from_f64(amount));
            result.push(&remedy);
        }
        Ok(result)
    }
}

impl Handles {
    pub(crate) fn of(p: &[f64], dim: usize, own_logits: Vec<f32>) -> Result<Handles, Error> {
        neuralmls_core::Handles::of_logits(p, dim, own_logits, Transform::Rigid).map(Handles)
    }

    pub(crate) fn logits(&self) -> &[f32] {
        self.0.logits()
    }

    pub(crate) fn aimed(
        &mut self,
        pose: Pose<'_>,
        transform: &str,
        temperature: f64,
        adherence: f64,
    ) -> Result<Aim, JsError> {
        self.0.set_transform(named(transform)?);
        self.0.aim_carefully(pose, temperature, &[adherence]).map_err(refused)
    }
}

pub(crate) fn named(transform: &str) -> Result<Transform, JsError> {
    match transform {
        "rigid" => Ok(Transform::Rigid),
        "similarity" => Ok(Transform::Similarity),
        "affine" => Ok(Transform::Affine),
        other => Err(refused(format!("transform: expected rigid, similarity or affine, found {other}"))),
    }
}
