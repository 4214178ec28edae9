//! Makes small glTF files, and reads accessors of written ones in its own plain way.

use neuralmls_shapes::{Error, Format, Shape, Written};
use serde_json::{json, Value};

/// A file in the making: its JSON and its one buffer.
pub struct Builder {
    pub json: Value,
    pub bin: Vec<u8>,
}

impl Builder {
    pub fn new() -> Self {
        let json = json!({
            "asset": { "version": "2.0" },
            "scene": 0,
            "scenes": [{ "nodes": [] }],
            "nodes": [],
            "meshes": [],
            "accessors": [],
            "bufferViews": [],
        });
        Builder { json, bin: Vec::new() }
    }

    pub fn push(&mut self, key: &str, value: Value) -> usize {
        if self.json.get(key).is_none() {
            self.json[key] = json!([]);
        }
        let array = self.json[key].as_array_mut().unwrap();
        array.push(value);
        array.len() - 1
    }

    /// Bytes at the next multiple of four, as a new view.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let offset = self.bin.len();
        self.bin.extend_from_slice(bytes);
        self.push("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }))
    }

    pub fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let view = self.view(&le(values));
        let width = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            "MAT4" => 16,
            _ => unreachable!(),
        };
        let mut accessor = json!({
            "bufferView": view, "componentType": 5126, "count": values.len() / width, "type": kind
        });
        if kind == "VEC3" {
            let bound = |start: f32, pick: fn(f32, f32) -> f32| -> Vec<f32> {
                (0..3).map(|k| values.iter().skip(k).step_by(3).copied().fold(start, pick)).collect()
            };
            accessor["min"] = json!(bound(f32::INFINITY, f32::min));
            accessor["max"] = json!(bound(f32::NEG_INFINITY, f32::max));
        }
        self.push("accessors", accessor)
    }

    pub fn shorts(&mut self, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes);
        let accessor = json!({
            "bufferView": view, "componentType": 5123, "count": values.len(), "type": "SCALAR"
        });
        self.push("accessors", accessor)
    }

    /// A mesh of one primitive.
    pub fn mesh(&mut self, primitive: Value) -> usize {
        self.push("meshes", json!({ "primitives": [primitive] }))
    }

    /// A node at the root of the scene.
    pub fn node(&mut self, node: Value) -> usize {
        let index = self.push("nodes", node);
        self.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(index.into());
        index
    }

    fn finished(&self, uri: Option<String>) -> Value {
        let mut json = self.json.clone();
        if !self.bin.is_empty() {
            json["buffers"] = json!([{ "byteLength": self.bin.len() }]);
            if let Some(uri) = uri {
                json["buffers"][0]["uri"] = uri.into();
            }
        }
        json
    }

    pub fn glb(&self) -> Vec<u8> {
        let text = self.finished(None).to_string();
        let bin = (!self.bin.is_empty()).then_some(&self.bin[..]);
        glb(text.as_bytes(), bin, &[])
    }

    /// The text of a `.gltf` whose buffer is `shape.bin`.
    pub fn text(&self) -> String {
        self.finished(Some("shape.bin".to_string())).to_string()
    }

    pub fn read(&self) -> Shape {
        read_glb(&self.glb()).unwrap()
    }

    pub fn refusal(&self) -> String {
        read_glb(&self.glb()).err().expect("it should be refused").to_string()
    }
}

pub fn le(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// The container around its chunks.
pub fn glb(text: &[u8], bin: Option<&[u8]>, more: &[u8]) -> Vec<u8> {
    let mut chunks = Vec::new();
    let mut chunk = |kind: &[u8; 4], data: &[u8], filler: u8| {
        let padded = data.len().next_multiple_of(4);
        chunks.extend_from_slice(&(padded as u32).to_le_bytes());
        chunks.extend_from_slice(kind);
        chunks.extend_from_slice(data);
        chunks.resize(chunks.len() + padded - data.len(), filler);
    };
    chunk(b"JSON", text, b' ');
    if let Some(bin) = bin {
        chunk(b"BIN\0", bin, 0);
    }
    chunks.extend_from_slice(more);
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend_from_slice(&(chunks.len() as u32 + 12).to_le_bytes());
    file.extend(chunks);
    file
}

pub fn no_files(name: &str) -> Result<Vec<u8>, String> {
    Err(format!("no {name} here"))
}

pub fn read_glb(bytes: &[u8]) -> Result<Shape, Error> {
    Shape::read(bytes.to_vec(), Format::Glb, &no_files)
}

/// A bend that moves every position.
pub fn bent(before: &[f64]) -> Vec<f64> {
    let size = before.iter().fold(1e-9f64, |m, c| m.max(c.abs()));
    let bend = |p: &[f64]| {
        let [x, y, z] = [p[0] / size, p[1] / size, p[2] / size];
        [x + 0.1 * y * y + 0.05, y + 0.07 * x - 0.02, z + 0.1 * x * y + 0.01].map(|c| c * size)
    };
    before.chunks_exact(3).flat_map(bend).collect()
}

/// A GLB taken apart.
pub struct Parts {
    pub json: Value,
    pub bin: Vec<u8>,
}

pub fn parts(glb: &[u8]) -> Parts {
    let word = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!(word(8), glb.len());
    let end = 20 + word(12);
    assert_eq!(end % 4, 0);
    let json = serde_json::from_slice(&glb[20..end]).unwrap();
    let bin = if end < glb.len() { glb[end + 8..end + 8 + word(end)].to_vec() } else { Vec::new() };
    Parts { json, bin }
}

impl Parts {
    /// The stored numbers of a dense accessor.
    pub fn numbers(&self, accessor: usize) -> Vec<f64> {
        let a = &self.json["accessors"][accessor];
        assert!(a.get("sparse").is_none());
        let number = |v: &Value, key: &str| v.get(key).map_or(0, |n| n.as_u64().unwrap() as usize);
        let view = &self.json["bufferViews"][number(a, "bufferView")];
        let (size, load): (usize, fn(&[u8]) -> f64) = match number(a, "componentType") {
            5120 => (1, |b| f64::from(b[0] as i8)),
            5121 => (1, |b| f64::from(b[0])),
            5122 => (2, |b| f64::from(i16::from_le_bytes([b[0], b[1]]))),
            5123 => (2, |b| f64::from(u16::from_le_bytes([b[0], b[1]]))),
            _ => (4, |b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]))),
        };
        let width = match a["type"].as_str().unwrap() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let stride = if view.get("byteStride").is_some() { number(view, "byteStride") } else { size * width };
        let start = number(view, "byteOffset") + number(a, "byteOffset");
        (0..number(a, "count"))
            .flat_map(|i| (0..width).map(move |k| start + i * stride + k * size))
            .map(|at| load(&self.bin[at..]))
            .collect()
    }

    /// The accessor of an attribute of a mesh's first primitive.
    pub fn attribute(&self, mesh: usize, name: &str) -> usize {
        self.json["meshes"][mesh]["primitives"][0]["attributes"][name].as_u64().unwrap() as usize
    }
}

/// Moves a GLB by `after`, checks that what is read again is that, and gives the new file.
pub fn moved(shape: &Shape, after: &[f64], maps: Option<&[f64]>, tolerance: f64) -> (Written, Parts) {
    let written = shape.write(after, maps).unwrap();
    let again = read_glb(&written.bytes).unwrap();
    assert_eq!(again.faces(), shape.faces());
    assert_eq!(again.positions().len(), after.len());
    for (i, (a, b)) in after.iter().zip(again.positions()).enumerate() {
        assert!((a - b).abs() <= tolerance, "number {i}: {b} instead of {a}");
    }
    let parts = parts(&written.bytes);
    (written, parts)
}
