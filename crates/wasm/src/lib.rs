//! The browser face of NeuralMLS: converts arguments, calls the crates. No mathematics.
//!
//! The editor's worker (`editor/src/worker`) is the only caller. Long calls tell a JavaScript function how far they are; they are
//! stopped by ending their worker.

mod handles;
mod map;
mod session;
mod shape_file;

use js_sys::Function;
use wasm_bindgen::prelude::*;

/// An error of the crates as a JavaScript `Error` with the same sentence.
fn refused(error: impl std::fmt::Display) -> JsError {
    JsError::new(&error.to_string())
}

/// What the core reports its progress to: `tell(fraction)`.
fn reporter(tell: &Function) -> impl FnMut(f64) -> bool + '_ {
    |fraction| tell.call1(&JsValue::NULL, &JsValue::from_f64(fraction)).is_ok()
}
