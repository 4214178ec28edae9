//! Weights, and points bound to them.

use js_sys::{Array, Float32Array, Float64Array};
use neuralmls_core::progress::Progress;
use neuralmls_core::{Better, Kind, Probe};
use neuralmls_core::{Deformer, Error, Frame, InverseDistance, PointTree, Pose, Transform};
use wasm_bindgen::prelude::*;

use crate::handles::{named, Handles};
use crate::refused;

enum Function {
    Neural(Box<neuralmls_core::Trained>),
    Classic(InverseDistance),
}

/// A weight function of control points.
#[wasm_bindgen]
pub struct Weights {
    p: Vec<f64>,
    function: Function,
}

#[wasm_bindgen]
impl Weights {
    /// Mean cross-entropy after the training; undefined for classic weights.
    pub fn loss(&self) -> Option<f64> {
        match &self.function {
            Function::Neural(fit) => Some(fit.loss),
            Function::Classic(_) => None,
        }
    }

    /// Steps that were trained.
    pub fn steps(&self) -> usize {
        match &self.function {
            Function::Neural(fit) => fit.losses.len(),
            Function::Classic(_) => 0,
        }
    }
}

impl Weights {
    pub(crate) fn neural(p: Vec<f64>, fit: neuralmls_core::Trained) -> Weights {
        Weights { p, function: Function::Neural(Box::new(fit)) }
    }

    pub(crate) fn classic(p: Vec<f64>, function: InverseDistance) -> Weights {
        Weights { p, function: Function::Classic(function) }
    }

    pub(crate) fn is_neural(&self) -> bool {
        matches!(self.function, Function::Neural(_))
    }

    /// At the points `x`, which `tree` (if any) holds too.
    fn logits(
        &self,
        x: &[f64],
        tree: Option<&PointTree>,
        progress: &mut Progress<'_>,
    ) -> Result<Vec<f32>, Error> {
        match (&self.function, tree) {
            (Function::Neural(fit), Some(tree)) => fit.network.logits_of_tree(tree, progress),
            (Function::Neural(fit), None) => fit.network.logits(x, progress),
            (Function::Classic(function), _) => function.logits(x, progress),
        }
    }
}

/// The points of a shape, and the control points themselves, bound to weights.
#[wasm_bindgen]
pub struct Fit {
    weights: Weights,
    dim: usize,
    /// The longest side of the box.
    side: f64,
    points: Deformer,
    control_points: Handles,
    /// Made when it is first asked for.
    probe: Option<Probe>,
}

#[wasm_bindgen]
impl Fit {
    /// The logits of the points, n x m.
    pub fn logits(&self) -> Float32Array {
        Float32Array::from(self.points.logits())
    }

    /// The logits at the control points' own places, m x m.
    pub fn own_logits(&self) -> Float32Array {
        Float32Array::from(self.control_points.logits())
    }

    /// [`Handles::aim`] of the control points: what to give to [`Fit::deform`] for the targets `q`.
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
        self.control_points.aim(q, turns, transform, temperature, adherence)
    }

    /// [`Handles::land`] of the control points.
    ///
    /// # Errors
    /// Where `q` does not fit, or a number is out of its range.
    pub fn land(
        &mut self,
        q: &[f64],
        turns: Option<Vec<f64>>,
        transform: &str,
        temperature: f64,
        adherence: f64,
    ) -> Result<Array, JsError> {
        self.control_points.land(q, turns, transform, temperature, adherence)
    }

    /// What is likely bad about the shape when the control points are pulled to `q`, looked at in `places` (k x dim, always the same): for each
    /// thing its kind, how bad, the worst place, the two control points next to it (their numbers), and what is better: "soft", a temperature,
    /// or null, with the part that is left.
    ///
    /// # Errors
    /// As [`Fit::land`].
    pub fn advise(
        &mut self,
        places: &[f64],
        q: &[f64],
        turns: Option<Vec<f64>>,
        transform: &str,
        temperature: f64,
        adherence: f64,
    ) -> Result<Array, JsError> {
        let pose = Pose { q, orientations: turns.as_deref() };
        if self.probe.is_none() {
            let points = Probe::points(places, self.dim, self.side);
            let logits = self.weights.logits(&points, None, &mut |_| true).map_err(refused)?;
            let own = self.control_points.logits().to_vec();
            let probe = Probe::of_logits(
                &self.weights.p,
                self.dim,
                places,
                self.side,
                logits,
                own,
                Transform::Rigid,
                true,
            );
            self.probe = Some(probe.map_err(refused)?);
        }
        let result = Array::new();
        if let Some(probe) = &mut self.probe {
            probe.set_transform(named(transform)?);
            for advice in probe.advise(pose, temperature, &[adherence]).map_err(refused)? {
                let (kind, amount) = match advice.kind {
                    Kind::Folds(part) => ("folds", part),
                    Kind::Torn(stretch) => ("torn", stretch),
                    Kind::Ungoverned(far) => ("ungoverned", far),
                };
                let (better, left) = match advice.better {
                    Some((Better::Temperature(other), left)) => (JsValue::from_f64(other), left),
                    Some((Better::Soft, left)) => (JsValue::from_str("soft"), left),
                    None => (JsValue::NULL, 0.0),
                };
                let [first, second] = advice.near.map(|i| JsValue::from_f64(i as f64));
                let place = JsValue::from_f64(advice.place as f64);
                let told = [JsValue::from_str(kind), JsValue::from_f64(amount), place, first, second, better];
                result.push(&told.iter().chain([&JsValue::from_f64(left)]).collect::<Array>());
            }
        }
        Ok(result)
    }

    /// The points' new positions (n x dim), then their maps (n x dim x dim) if `maps`.
    ///
    /// # Errors
    /// As [`Fit::land`].
    pub fn deform(
        &mut self,
        q: &[f64],
        turns: Option<Vec<f64>>,
        transform: &str,
        temperature: f64,
        maps: bool,
        tell: &js_sys::Function,
    ) -> Result<Array, JsError> {
        self.points.set_transform(named(transform)?);
        let pose = Pose { q, orientations: turns.as_deref() };
        let deformed =
            self.points.deform(pose, temperature, maps, &mut crate::reporter(tell)).map_err(refused)?;
        let result = Array::of1(&Float64Array::from(&deformed.positions[..]));
        if let Some(maps) = deformed.maps {
            result.push(&Float64Array::from(&maps[..]));
        }
        Ok(result)
    }
}

impl Fit {
    pub(crate) fn new(
        weights: Weights,
        x: &[f64],
        dim: usize,
        frame: Frame,
        tree: Option<&PointTree>,
        progress: &mut Progress<'_>,
    ) -> Result<Fit, Error> {
        let p = &weights.p;
        let own = weights.logits(p, None, &mut |_| true)?;
        let control_points = Handles::of(p, dim, own)?;
        let logits = weights.logits(x, tree, progress)?;
        let points = Deformer::of_logits(x.to_vec(), dim, p, logits, Transform::Rigid)?;
        Ok(Fit { dim, side: 2.0 * frame.half, points, control_points, probe: None, weights })
    }
}
