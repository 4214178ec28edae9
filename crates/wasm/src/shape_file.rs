//! Shapes read from bytes.

use js_sys::{Array, Float64Array, Function, Uint32Array, Uint8Array};
use neuralmls_core::{placement, places};
use neuralmls_shapes::Shape;
use wasm_bindgen::prelude::*;

use crate::refused;

/// A shape read from the bytes of a file.
#[wasm_bindgen]
pub struct ShapeFile(Shape);

#[wasm_bindgen]
impl ShapeFile {
    /// `extension` without its dot; `side_file` gives the bytes of a relative path, or null.
    ///
    /// # Errors
    /// One sentence without the file's name.
    #[wasm_bindgen(constructor)]
    pub fn new(data: Vec<u8>, extension: &str, side_file: &Function) -> Result<ShapeFile, JsError> {
        let side_files = |path: &str| -> Result<Vec<u8>, String> {
            side_file
                .call1(&JsValue::NULL, &JsValue::from_str(path))
                .ok()
                .and_then(|bytes| bytes.dyn_into::<Uint8Array>().ok())
                .map(|bytes| bytes.to_vec())
                .ok_or_else(|| "it was not opened along with it".to_string())
        };
        Shape::open(data, Some(extension), &side_files).map(ShapeFile).map_err(refused)
    }

    /// The format's name: "OBJ", "PLY" ...
    pub fn format(&self) -> String {
        self.0.format().name().into()
    }

    /// The endings of files of this format, without the dot.
    pub fn extensions(&self) -> Vec<String> {
        self.0.format().extensions().iter().map(|ending| ending.to_string()).collect()
    }

    /// Coordinates a position.
    pub fn dim(&self) -> usize {
        self.0.dim()
    }

    /// The positions, n x dim.
    pub fn positions(&self) -> Float64Array {
        Float64Array::from(self.0.positions())
    }

    /// Triangles, f x 3; undefined where the file has no faces.
    pub fn triangles(&self) -> Option<Uint32Array> {
        self.0.faces().map(|faces| Uint32Array::from(faces.as_flattened()))
    }

    /// What else is in the file: label, value, label, value ...
    pub fn facts(&self) -> Vec<String> {
        self.0.facts().iter().flat_map(|(label, value)| [label.clone(), value.clone()]).collect()
    }

    /// Whether the file holds normals or tangents.
    pub fn has_normals(&self) -> bool {
        self.0.has_normals()
    }

    /// Files beside this one that it names.
    pub fn named_files(&self) -> Vec<String> {
        self.0.named_files()
    }

    /// `count` places spread over the shape, count x dim.
    ///
    /// # Errors
    /// Where there are not so many distinct ones.
    pub fn farthest_points(&self, count: usize, seed: u64) -> Result<Float64Array, JsError> {
        let faces = self.0.faces().unwrap_or_default();
        placement::farthest_points(self.0.positions(), self.0.dim(), faces, count, seed, &mut |_| true)
            .map(|places| Float64Array::from(&places[..]))
            .map_err(refused)
    }

    /// `count` places on the shape to look at, each as likely as another.
    ///
    /// # Errors
    /// Where a face names no point.
    pub fn sample(&self, count: usize) -> Result<Float64Array, JsError> {
        let faces = self.0.faces().unwrap_or_default();
        places(self.0.positions(), self.0.dim(), faces, count)
            .map(|places| Float64Array::from(&places[..]))
            .map_err(refused)
    }

    /// The same file with other positions (n x dim) and its normals turned by `maps` (n x dim x dim): its bytes, then name and bytes
    /// of each side file that changed, which are called after `stem`.
    ///
    /// # Errors
    /// Where the lengths do not fit, or a position is not finite.
    pub fn write(&self, positions: &[f64], maps: Option<Vec<f64>>, stem: &str) -> Result<Array, JsError> {
        let written = self.0.write_as(positions, maps.as_deref(), Some(stem)).map_err(refused)?;
        let files = Array::of1(&Uint8Array::from(&written.bytes[..]));
        for file in written.side_files {
            files.push(&JsValue::from_str(&file.name));
            files.push(&Uint8Array::from(&file.bytes[..]));
        }
        Ok(files)
    }
}
