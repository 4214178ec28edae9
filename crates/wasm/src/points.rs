//! The points of a shape, to which weights are fitted.

use js_sys::Function;
use neuralmls_core::{Frame, InverseDistance, PointTree, Schedule, Training};
use wasm_bindgen::prelude::*;

use crate::fit::{Fit, Weights};
use crate::{refused, reporter};

/// The points of a shape.
#[wasm_bindgen]
pub struct Points {
    pub(crate) x: Vec<f64>,
    pub(crate) dim: usize,
    frame: Frame,
    /// Built when neural weights are first evaluated.
    tree: Option<PointTree>,
}

#[wasm_bindgen]
impl Points {
    /// `x`: n x dim.
    ///
    /// # Errors
    /// Where all points are in one place, or the box is beyond what squares of lengths can hold.
    #[wasm_bindgen(constructor)]
    pub fn new(x: Vec<f64>, dim: usize) -> Result<Points, JsError> {
        let frame = Frame::around(&x, dim);
        Ok(Points { x, dim, frame, tree: None })
    }

    /// Trains a network on the control points `p` (m x dim); `steps` undefined: until each of them owns its place.
    ///
    /// # Errors
    /// Where a number is out of its range, or two control points are in one place.
    pub fn train(
        &self,
        p: Vec<f64>,
        width: usize,
        seed: u64,
        steps: Option<usize>,
        tell: &Function,
    ) -> Result<Weights, JsError> {
        let schedule = steps.map_or(Training::default().schedule, Schedule::Fixed);
        let training = Training { width, seed, schedule, ..Training::default() };
        let weights =
            neuralmls_core::Weights::neural(&p, self.dim, self.frame, &training, &mut reporter(tell));
        match weights.map_err(refused)? {
            neuralmls_core::Weights::Neural(trained) => Ok(Weights::neural(p, trained)),
            _ => unreachable!("neural weights were trained"),
        }
    }

    /// The classic weights of the control points `p` (m x dim).
    ///
    /// # Errors
    /// Where a number is out of its range.
    pub fn classic(&self, p: Vec<f64>, alpha: f64, epsilon: f64) -> Result<Weights, JsError> {
        let function = InverseDistance::new(&p, self.dim, self.frame, alpha, epsilon).map_err(refused)?;
        Ok(Weights::classic(p, function))
    }

    /// Evaluates weights at the points.
    ///
    /// # Errors
    /// Where the weights are of another dimension.
    pub fn evaluate(&mut self, weights: Weights, tell: &Function) -> Result<Fit, JsError> {
        let tree = if weights.is_neural() {
            let built = self
                .tree
                .take()
                .map_or_else(|| PointTree::new(&self.x, self.dim, self.frame, &mut reporter(tell)), Ok);
            self.tree = Some(built.map_err(refused)?);
            self.tree.as_ref()
        } else {
            None
        };
        Fit::new(weights, &self.x, self.dim, self.frame, tree, &mut reporter(tell)).map_err(refused)
    }
}
