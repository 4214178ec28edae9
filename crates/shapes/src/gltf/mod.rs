//! glTF 2, as JSON and as GLB.
//!
//! Positions are those that a viewer shows at rest: every POSITION accessor once for each node that shows it, in world
//! space. Written back in each node's own space, in place where nothing else reads those bytes, else as new data at the
//! end of the buffer; the JSON changes only where that demands it.
//!
//! | file | what |
//! |---|---|
//! | `glb` | the chunks of a GLB |
//! | `json` | JSON values with their paths, for errors |
//! | `buffers`, `accessor` | the bytes, and typed arrays in them |
//! | `extensions` | what is refused by name |
//! | `scene`, `affine` | nodes, skins and their maps into the world |
//! | `mesh` | primitives and instances: positions and faces |
//! | `turned` | new positions, normals and tangents in a node's own space |
//! | `rounded` | what of a position arrives there |
//! | `write`, `output`, `splice` | which accessor gets what; the changed buffers; the changed text |

mod accessor;
mod affine;
mod buffers;
mod extensions;
mod facts;
mod glb;
mod json;
mod mesh;
mod output;
mod rounded;
mod scene;
mod splice;
mod turned;
mod write;

use serde_json::Value;

use self::accessor::{Accessor, View};
use self::buffers::{percent_decoded, Buffers, Origin};
use self::json::At;
use self::mesh::{Block, Instance, Primitive};
use self::scene::{Node, Skin};
use crate::document::{Document, Moved, Parsed, SideFiles, Written};
use crate::error::Error;
use crate::memory;
use crate::precision::Precision;

/// What of a glTF file says where its vertices are.
struct Model {
    buffers: Buffers,
    views: Vec<View>,
    accessors: Vec<Accessor>,
    meshes: Vec<Vec<Primitive>>,
    nodes: Vec<Node>,
    skins: Vec<Skin>,
    instances: Vec<Instance>,
    blocks: Vec<Block>,
}

struct Gltf {
    json: Value,
    model: Model,
    binary: bool,
}

/// Reads a `.gltf`.
pub(crate) fn read_gltf(source: &[u8], side_files: &SideFiles<'_>) -> Result<Parsed, Error> {
    read(source, without_mark(source), None, side_files)
}

/// Reads a `.glb`.
pub(crate) fn read_glb(source: &[u8], side_files: &SideFiles<'_>) -> Result<Parsed, Error> {
    let glb = glb::split(source)?;
    read(source, glb.text(source), Some(glb.bin.map_or(&[][..], |bin| &source[bin])), side_files)
}

/// The text without a byte order mark.
fn without_mark(text: &[u8]) -> &[u8] {
    text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text)
}

fn read(source: &[u8], text: &[u8], bin: Option<&[u8]>, side_files: &SideFiles<'_>) -> Result<Parsed, Error> {
    // The values of a document take more memory than its text, and their reader does not say so if there is too little.
    memory::expect(text.len().saturating_mul(2))?;
    let json: Value = serde_json::from_slice(text).map_err(|e| {
        let message = format!("not JSON: {e}");
        match bin {
            Some(_) => Error::malformed(format!("the JSON chunk: {message}")),
            None if e.line() > 0 => Error::at_line(e.line() as u64, message),
            None => Error::malformed(message),
        }
    })?;
    let root = At::root(&json);
    check_version(&root)?;
    extensions::check(&root)?;

    let buffers = Buffers::load(&root, bin, side_files)?;
    let input = buffers.storages.iter().fold(source.len(), |sum, s| sum.saturating_add(s.bytes.len()));
    let views = accessor::read_views(&root, &buffers)?;
    let accessors = accessor::read_accessors(&root, &views, room(input, 1))?;
    let meshes = mesh::read_meshes(&root, &accessors)?;
    let nodes = scene::read_nodes(&root, meshes.len(), root.items("skins")?.len())?;
    let skins = scene::read_skins(&root, &nodes, &accessors, &views, &buffers, room(input, 1))?;
    let mut model =
        Model { buffers, views, accessors, meshes, nodes, skins, instances: Vec::new(), blocks: Vec::new() };
    mesh::place(&mut model, room(input, 4))?;
    if model.blocks.is_empty() {
        return Err(Error::malformed(
            "no node of a scene shows a mesh with positions, so that there is no shape",
        ));
    }
    let positions = model.positions()?;
    let faces = model.faces(room(input, 4))?;
    let facts = facts::facts(&root, &model)?;
    let document = Box::new(Gltf { json, model, binary: bin.is_some() });
    Ok(Parsed { dim: 3, positions, faces, facts, document })
}

/// How many elements a file of `input` bytes may claim `times` over. Instances repeat what is there once, hence more
/// than there are bytes; small files may have some anyway.
fn room(input: usize, times: usize) -> usize {
    input.saturating_mul(times).saturating_add(1 << 16).min(u32::MAX as usize)
}

fn check_version(root: &At<'_>) -> Result<(), Error> {
    let old = |version: &str| {
        Err(Error::unsupported(format!("this is glTF {version}, only glTF 2 is read; convert it first")))
    };
    let Some(asset) = root.get("asset")? else {
        // Files of version 1 have objects where version 2 has arrays, and could do without "asset".
        return if root.value["meshes"].is_object() {
            old("1")
        } else {
            Err(root.error("\"asset\" is missing"))
        };
    };
    let version = match asset.get("version")? {
        Some(version) => version.string()?,
        None => return Err(asset.error("\"version\" is missing")),
    };
    if version != "2" && !version.starts_with("2.") {
        return old(version);
    }
    match asset.get("minVersion")? {
        Some(least) if least.string()? != "2.0" => old(&format!("{} at least", least.string()?)),
        _ => Ok(()),
    }
}

impl Gltf {
    /// The primitives that a node shows and that have positions.
    fn shown(&self) -> impl Iterator<Item = &Primitive> {
        let primitives = self.model.instances.iter().flat_map(|i| &self.model.meshes[i.mesh]);
        primitives.filter(|primitive| primitive.position.is_some())
    }

    /// The paths of the images beside the file.
    fn image_files(&self) -> Vec<String> {
        let images = self.json["images"].as_array().into_iter().flatten();
        let uris = images.filter_map(|image| image["uri"].as_str()).filter(|uri| !uri.starts_with("data:"));
        uris.map(|uri| String::from_utf8_lossy(&percent_decoded(uri)).into_owned()).collect()
    }
}

impl Document for Gltf {
    fn precision(&self, _axis: usize) -> Precision {
        Precision::Single
    }

    fn round(&self, before: &[f64], points: &[f64], _dim: usize) -> Result<Vec<f64>, Error> {
        if points.len() == before.len() {
            self.model.positions_written(before, points)
        } else {
            self.model.places_written(before, points)
        }
    }

    fn step(&self, _largest: &[f64]) -> Result<f64, Error> {
        self.model.step()
    }

    fn has_normals(&self) -> bool {
        self.shown().any(|p| p.normal.is_some() || p.tangent.is_some())
    }

    fn named_files(&self) -> Vec<String> {
        let buffers = self.model.buffers.storages.iter().filter_map(|storage| match &storage.origin {
            Origin::File(path) => Some(path.clone()),
            _ => None,
        });
        buffers.chain(self.image_files()).collect()
    }

    fn side_files(&self, stem: &str) -> Vec<String> {
        let Model { buffers, views, accessors, .. } = &self.model;
        let mut moves = vec![false; buffers.storages.len()];
        for primitive in self.shown() {
            for accessor in [primitive.position, primitive.normal, primitive.tangent].into_iter().flatten() {
                let buffer = accessors[accessor].buffer(views).unwrap_or(0);
                buffers.buffers.get(buffer).into_iter().for_each(|buffer| moves[buffer.storage] = true);
            }
        }
        output::side_names(self, stem, &moves)
    }

    fn write(&self, source: &[u8], moved: &Moved<'_>) -> Result<Written, Error> {
        write::write(self, source, moved)
    }
}
