//! The file while it is written: its JSON and its buffers, and in the end its bytes.

use std::borrow::Cow;

use base64::Engine;
use serde_json::{json, Map, Value};

use super::accessor::Component;
use super::buffers::{percent_encoded, Origin, BASE64};
use super::splice::splice;
use super::turned::Content;
use super::{glb, without_mark, Gltf};
use crate::document::{SideFile, Written};
use crate::error::Error;
use crate::memory;

pub(super) struct Output<'a> {
    gltf: &'a Gltf,
    source: &'a [u8],
    pub json: Value,
    storages: Vec<Cow<'a, [u8]>>,
    /// The bytes of a buffer that the file did not have, for data that has no other place.
    fresh: Vec<u8>,
}

impl<'a> Output<'a> {
    pub fn new(gltf: &'a Gltf, source: &'a [u8]) -> Self {
        let storages = gltf.model.buffers.storages.iter().map(|s| Cow::Borrowed(&s.bytes[..])).collect();
        Output { gltf, source, json: gltf.json.clone(), storages, fresh: Vec::new() }
    }

    /// The array `key` of the file, made if it is missing.
    fn array(&mut self, key: &str) -> &mut Vec<Value> {
        let root = self.json.as_object_mut().expect("the reader saw an object");
        let array = root.entry(key).or_insert_with(|| json!([]));
        array.as_array_mut().expect("the reader saw an array")
    }

    /// Adds a copy of an entry of the array `key`, and gives its index.
    pub fn copy(&mut self, key: &str, index: usize) -> usize {
        let array = self.array(key);
        let copy = array[index].clone();
        array.push(copy);
        array.len() - 1
    }

    fn accessor(&mut self, index: usize) -> &mut Map<String, Value> {
        self.array("accessors")[index].as_object_mut().expect("the reader saw an object")
    }

    /// Writes the elements of an accessor where they are. One without a view gets one.
    pub fn overwrite(&mut self, accessor: usize, content: &Content) -> Result<(), Error> {
        let model = &self.gltf.model;
        let old = &model.accessors[accessor];
        let Some(reach) = old.reach(&model.views, &model.buffers) else {
            return self.append(accessor, accessor, content);
        };
        let bytes = &mut owned(&mut self.storages[reach.storage])?[reach.start..reach.end()];
        for (element, new) in bytes.chunks_mut(reach.stride).zip(content.bytes.chunks_exact(old.size)) {
            element[..old.size].copy_from_slice(new);
        }
        self.set_bounds(accessor, old.width, content);
        Ok(())
    }

    /// Writes elements to the end of the buffer of the accessor `old`, and has the accessor `index`, which is `old` or a
    /// copy of it, read them.
    pub fn append(&mut self, index: usize, old: usize, content: &Content) -> Result<(), Error> {
        let model = &self.gltf.model;
        let old = &model.accessors[old];
        let element = old.width * content.component.size();
        let stride = element.next_multiple_of(4);
        let mut data = memory::with_room(content.bytes.len() / element * stride)?;
        for bytes in content.bytes.chunks_exact(element) {
            data.extend_from_slice(bytes);
            data.resize(data.len().next_multiple_of(4), 0);
        }
        let target = old.view.and_then(|v| self.json["bufferViews"][v].get("target").cloned());
        let (buffer, offset) = self.extend(old.buffer(&model.views), &data)?;

        let mut view = json!({ "buffer": buffer, "byteOffset": offset, "byteLength": data.len() });
        if stride != element {
            view["byteStride"] = stride.into();
        }
        if let Some(target) = target {
            view["target"] = target;
        }
        let views = self.array("bufferViews");
        views.push(view);
        let view = views.len() - 1;
        let accessor = self.accessor(index);
        accessor.insert("bufferView".to_string(), view.into());
        accessor.shift_remove("byteOffset");
        accessor.shift_remove("sparse");
        if content.component != old.component {
            accessor.insert("componentType".to_string(), 5126.into());
            accessor.shift_remove("normalized");
        }
        self.set_bounds(index, old.width, content);
        Ok(())
    }

    /// Adds data to the end of a buffer, from a multiple of four bytes on; gives the buffer and the offset.
    fn extend(&mut self, buffer: Option<usize>, data: &[u8]) -> Result<(usize, usize), Error> {
        let buffers = &self.gltf.model.buffers.buffers;
        let buffer = buffer.or(if buffers.is_empty() { None } else { Some(0) });
        let bytes = match buffer {
            Some(b) => owned(&mut self.storages[buffers[b].storage])?,
            None => &mut self.fresh,
        };
        let offset = bytes.len().next_multiple_of(4);
        memory::reserve(bytes, offset - bytes.len() + data.len())?;
        bytes.resize(offset, 0);
        bytes.extend_from_slice(data);
        let length = bytes.len();
        let index = buffer.unwrap_or(0);
        let entries = self.array("buffers");
        if entries.is_empty() {
            entries.push(json!({}));
        }
        entries[index]["byteLength"] = length.into();
        Ok((index, offset))
    }

    /// Sets "min" and "max" where the accessor has them; numbers that stay keep their text.
    fn set_bounds(&mut self, index: usize, width: usize, content: &Content) {
        let (size, whole) = (content.component.size(), content.component != Component::F32);
        let mut low = vec![f64::INFINITY; width];
        let mut high = vec![f64::NEG_INFINITY; width];
        for (i, bytes) in content.bytes.chunks_exact(size).enumerate() {
            let stored = content.component.load(bytes);
            low[i % width] = low[i % width].min(stored);
            high[i % width] = high[i % width].max(stored);
        }
        for (key, bounds) in [("min", low), ("max", high)] {
            let Some(old) = self.accessor(index).get_mut(key) else { continue };
            if old.as_array().is_none_or(|a| a.len() != width) {
                *old = json!(vec![0; width]);
            }
            for (k, stored) in bounds.into_iter().enumerate() {
                if old[k].as_f64() != Some(stored) {
                    old[k] = if whole { Value::from(stored as i64) } else { Value::from(stored) };
                }
            }
        }
    }

    /// The file, and the side files that changed, called after `stem` if given.
    pub fn finish(mut self, stem: Option<&str>) -> Result<Written, Error> {
        let model = &self.gltf.model;
        let changed: Vec<bool> = self.storages.iter().map(|bytes| matches!(bytes, Cow::Owned(_))).collect();
        let mut names = stem.map(|stem| side_names(self.gltf, stem, &changed).into_iter());
        let mut side_files: Vec<SideFile> = Vec::new();
        let mut bin = None;
        for (s, bytes) in std::mem::take(&mut self.storages).into_iter().enumerate() {
            let Cow::Owned(bytes) = bytes else { continue };
            match &model.buffers.storages[s].origin {
                Origin::Bin => bin = Some(bytes),
                Origin::File(path) => {
                    let name = names.as_mut().and_then(Iterator::next).unwrap_or_else(|| path.clone());
                    if name != *path {
                        for (b, _) in model.buffers.buffers.iter().enumerate().filter(|(_, b)| b.storage == s)
                        {
                            self.array("buffers")[b]["uri"] = percent_encoded(&name).into();
                        }
                    }
                    side_files.push(SideFile { name, was: path.clone(), bytes });
                }
                Origin::Embedded(head) => {
                    memory::expect(2 * bytes.len())?;
                    let uri = format!("{head}{}", BASE64.encode(&bytes));
                    let buffer = model.buffers.buffers.iter().position(|b| b.storage == s);
                    self.array("buffers")[buffer.expect("every storage has a buffer")]["uri"] = uri.into();
                }
            }
        }
        if !self.fresh.is_empty() {
            let uri = format!("data:application/octet-stream;base64,{}", BASE64.encode(&self.fresh));
            self.array("buffers")[0]["uri"] = uri.into();
        }
        let same = self.json == self.gltf.json;
        // What changes the text allocates without asking.
        memory::expect(if same { 0 } else { 2 * self.source.len() })?;
        let bytes = if self.gltf.binary {
            let glb = glb::split(self.source)?;
            let text = (!same).then(|| splice(glb.text(self.source), &self.json));
            glb::join(&glb, self.source, text.as_deref(), bin.as_deref())?
        } else if same {
            memory::copy(self.source)?
        } else {
            let text = without_mark(self.source);
            let mark = &self.source[..self.source.len() - text.len()];
            [mark, &splice(text, &self.json)].concat()
        };
        Ok(Written { bytes, side_files })
    }
}

/// The bytes of a storage, copied where they are still those that were read.
fn owned<'s>(storage: &'s mut Cow<'_, [u8]>) -> Result<&'s mut Vec<u8>, Error> {
    if let Cow::Borrowed(bytes) = storage {
        *storage = Cow::Owned(memory::copy(bytes)?);
    }
    Ok(storage.to_mut())
}

/// What the side files of the storages that have changed are called after `stem`, in their order: `stem.bin`, `stem-2.bin` ..., but for
/// names of files that stay as they are.
pub(super) fn side_names(gltf: &Gltf, stem: &str, changed: &[bool]) -> Vec<String> {
    let storages = gltf.model.buffers.storages.iter().zip(changed);
    let files = storages.filter_map(|(storage, changed)| match &storage.origin {
        Origin::File(path) => Some((path, *changed)),
        _ => None,
    });
    let (own, kept): (Vec<_>, Vec<_>) = files.partition(|(_, changed)| *changed);
    let images = gltf.image_files();
    let free = |name: &String| {
        let mut stays = kept.iter().map(|(path, _)| *path).chain(&images);
        !stays.any(|path| path.trim_start_matches("./") == name)
    };
    let numbered = (2..).map(|number| format!("{stem}-{number}.bin"));
    std::iter::once(format!("{stem}.bin")).chain(numbered).filter(free).take(own.len()).collect()
}
