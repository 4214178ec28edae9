//! Fitted sessions, and the points of a shape bound to them.

use js_sys::{Array, Float32Array, Float64Array, Function};
use neuralmls_core::{Deformer, PointTree, Probe, Shape};
use wasm_bindgen::prelude::*;

use crate::session::Session;
use crate::{refused, reporter};

/// The points of a shape.
#[wasm_bindgen]
pub struct Points {
    x: Vec<f64>,
    dim: usize,
    faces: Vec<[u32; 3]>,
    /// Built when weights are first evaluated, for all sessions of one frame.
    tree: Option<PointTree>,
}

#[wasm_bindgen]
impl Points {
    /// `x`: n x dim; `triangles`: f x 3, none for a cloud.
    #[wasm_bindgen(constructor)]
    pub fn new(x: Vec<f64>, dim: usize, triangles: &[u32]) -> Points {
        Points { x, dim, faces: triangles.as_chunks::<3>().0.to_vec(), tree: None }
    }

    /// Fits the weights of a session: in its frame, else in the box of the points.
    ///
    /// # Errors
    /// Where the control points have another dimension, or the points no size.
    pub fn train(&self, session: &Session, tell: &Function) -> Result<Map, JsError> {
        let bounds = neuralmls_session::Bounds::around(&self.x, self.dim).map_err(refused)?;
        let shape = Shape { x: &self.x, faces: &self.faces };
        let map = session.session().fit(Some(&bounds), Some(shape), &mut reporter(tell)).map_err(refused)?;
        Ok(Map(map))
    }

    /// Evaluates a map's weights at the points.
    ///
    /// # Errors
    /// Where the weights are of another dimension.
    pub fn bind(&mut self, map: Map, tell: &Function) -> Result<Bound, JsError> {
        let frame = map.0.weights().frame();
        if self.tree.as_ref().is_none_or(|tree| *tree.frame() != frame) {
            let tree = PointTree::new(&self.x, self.dim, frame, &mut reporter(tell));
            self.tree = Some(tree.map_err(refused)?);
        }
        let points = map.0.bind(self.x.clone(), self.tree.as_ref(), &mut reporter(tell)).map_err(refused)?;
        Ok(Bound { map: map.0, points, probe: None })
    }

    /// What is likely bad about these points as they are bound, a sentence each: a JSON list of kind, sentence, the numbers of the control
    /// points that it is about, and how bad.
    ///
    /// # Errors
    /// Where a face names no point.
    pub fn advise(&self, bound: &mut Bound) -> Result<String, JsError> {
        if bound.probe.is_none() {
            bound.probe = Some(bound.map.probe(&self.x, &self.faces).map_err(refused)?);
        }
        let probe = bound.probe.as_mut().expect("made above");
        bound.map.set_up(probe);
        let found = bound.map.advise(probe, &mut || None, false).map_err(refused)?;
        Ok(neuralmls_session::advice_to_json(&found))
    }
}

/// A fitted session.
#[wasm_bindgen]
pub struct Map(neuralmls_session::Map);

#[wasm_bindgen]
impl Map {
    /// Mean cross-entropy after the training; undefined for weights that are not trained.
    pub fn loss(&self) -> Option<f64> {
        self.0.trained().map(|trained| trained.loss)
    }

    /// Steps that were trained.
    pub fn steps(&self) -> usize {
        self.0.trained().map_or(0, |trained| trained.losses.len())
    }
}

/// The points of a shape, and the control points themselves, bound to the weights of a map.
#[wasm_bindgen]
pub struct Bound {
    map: neuralmls_session::Map,
    points: Deformer,
    /// Made when it is first asked for.
    probe: Option<Probe>,
}

#[wasm_bindgen]
impl Bound {
    /// The logits of the points, n x m.
    pub fn logits(&self) -> Float32Array {
        Float32Array::from(self.points.logits())
    }

    /// The logits at the control points' own places, m x m.
    pub fn own_logits(&self) -> Float32Array {
        Float32Array::from(self.map.handles().logits())
    }

    /// The session as it was fitted, with its frame: what is to be saved.
    pub fn session(&self) -> String {
        self.map.session().to_json()
    }

    /// Takes other targets, orientations, transform, temperature or handles.
    ///
    /// # Errors
    /// Where the control points at rest or the weights are others.
    pub fn set_session(&mut self, session: &Session) -> Result<(), JsError> {
        self.map = self.map.with(session.session().clone()).map_err(refused)?;
        self.points.set_transform(self.map.transform());
        Ok(())
    }

    /// What happens to the control points: JSON with `places` (m x dim numbers), `distances`, `soft` and `warnings`.
    ///
    /// # Errors
    /// Where an orientation does not fit.
    pub fn report(&self) -> Result<String, JsError> {
        let aim = self.map.aim().map_err(refused)?;
        Ok(self.map.report(&aim, None).map_err(refused)?.to_json())
    }

    /// The points' new positions (n x dim), then their maps (n x dim x dim) if `maps`.
    ///
    /// # Errors
    /// As [`Bound::report`].
    pub fn deform(&self, maps: bool, tell: &Function) -> Result<Array, JsError> {
        let aim = self.map.aim().map_err(refused)?;
        let deformed = self.map.deform(&self.points, &aim, maps, &mut reporter(tell)).map_err(refused)?;
        let result = Array::of1(&Float64Array::from(&deformed.positions[..]));
        if let Some(maps) = deformed.maps {
            result.push(&Float64Array::from(&maps[..]));
        }
        Ok(result)
    }
}
