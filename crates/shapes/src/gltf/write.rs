//! Which accessor gets which new elements, so that nothing else in the file changes what it shows.
//!
//! Each use (a mesh, a primitive, an attribute) of an accessor may want other elements: because several nodes show the
//! mesh, or because primitives share it. A mesh whose nodes want different things is copied, one copy for each thing. Of
//! an accessor the first new *version* takes its place if no use wants it as it was; the others become new accessors.

use std::collections::HashMap;
use std::rc::Rc;

use super::accessor::Reach;
use super::json::At;
use super::mesh::{Instance, Primitive};
use super::output::Output;
use super::turned::Content;
use super::{Gltf, Model};
use crate::document::{Moved, Written};
use crate::error::Error;

const ATTRIBUTES: [&str; 3] = ["POSITION", "NORMAL", "TANGENT"];

/// What the three attributes of a primitive become: the number of a version, `None` for as it was.
type Form = Vec<[Option<usize>; 3]>;

/// The new elements of each accessor.
type Versions = HashMap<usize, Vec<Rc<Content>>>;

fn accessors_of(primitive: &Primitive) -> [Option<usize>; 3] {
    [primitive.position, primitive.normal, primitive.tangent]
}

pub(super) fn write(gltf: &Gltf, source: &[u8], moved: &Moved<'_>) -> Result<Written, Error> {
    let model = &gltf.model;
    let mut planner =
        Planner { model, moved, versions: Versions::new(), known: HashMap::new(), numbers: HashMap::new() };
    let mut forms: Vec<Vec<Form>> = model.meshes.iter().map(|_| Vec::new()).collect();
    let mut form_numbers: HashMap<(usize, Form), usize> = HashMap::new();
    let mut form_of_instance = Vec::with_capacity(model.instances.len());
    for instance in &model.instances {
        let form = planner.form(instance)?;
        let known = &mut forms[instance.mesh];
        form_of_instance.push(*form_numbers.entry((instance.mesh, form.clone())).or_insert_with(|| {
            known.push(form);
            known.len() - 1
        }));
    }
    let versions = planner.versions;
    let kept = kept(gltf, &forms)?;
    let shared = shared(gltf)?;
    let mut output = Output::new(gltf, source);

    // The index of every version among the new accessors.
    let mut place: HashMap<(usize, usize), usize> = HashMap::new();
    let mut changed: Vec<_> = versions.iter().collect();
    changed.sort_unstable_by_key(|(accessor, _)| **accessor);
    for (&accessor, contents) in changed {
        // Copies are made before the original changes, perhaps to another component type.
        let own = |version: usize| version == 0 && !kept[accessor];
        let indices: Vec<usize> = (0..contents.len())
            .map(|version| if own(version) { accessor } else { output.copy("accessors", accessor) })
            .collect();
        for (version, (content, index)) in contents.iter().zip(indices).enumerate() {
            let old = &model.accessors[accessor];
            if own(version) && old.component == content.component && !shared[accessor] && old.sparse.is_none()
            {
                output.overwrite(accessor, content)?;
            } else {
                output.append(index, accessor, content)?;
            }
            place.insert((accessor, version), index);
        }
    }

    let mut entries: Vec<Vec<usize>> = Vec::with_capacity(forms.len());
    for (mesh, forms) in forms.iter().enumerate() {
        // Copies are made before the original changes.
        let indices: Vec<usize> =
            (0..forms.len()).map(|k| if k == 0 { mesh } else { output.copy("meshes", mesh) }).collect();
        for (&entry, form) in indices.iter().zip(forms) {
            for (p, (primitive, uses)) in model.meshes[mesh].iter().zip(form).enumerate() {
                for (k, accessor) in accessors_of(primitive).into_iter().enumerate() {
                    let (Some(accessor), Some(version)) = (accessor, uses[k]) else { continue };
                    let index = place[&(accessor, version)];
                    if index != accessor {
                        output.json["meshes"][entry]["primitives"][p]["attributes"][ATTRIBUTES[k]] =
                            index.into();
                    }
                }
            }
        }
        entries.push(indices);
    }
    for (instance, form) in model.instances.iter().zip(form_of_instance) {
        if form > 0 {
            output.json["nodes"][instance.node]["mesh"] = entries[instance.mesh][form].into();
        }
    }
    output.finish(moved.stem)
}

struct Planner<'a> {
    model: &'a Model,
    moved: &'a Moved<'a>,
    versions: Versions,
    /// The version of (block, accessor, accessor of the normals), once found.
    known: HashMap<(usize, usize, Option<usize>), Option<usize>>,
    /// The number of each version of an accessor by what it holds.
    numbers: HashMap<(usize, Rc<Content>), usize>,
}

impl Planner<'_> {
    fn form(&mut self, instance: &Instance) -> Result<Form, Error> {
        let primitives = &self.model.meshes[instance.mesh];
        let mut form = Form::with_capacity(primitives.len());
        for (primitive, block) in primitives.iter().zip(&instance.blocks) {
            form.push(match block {
                None => [None; 3],
                Some(block) => self.uses(primitive, *block)?,
            });
        }
        Ok(form)
    }

    fn uses(&mut self, primitive: &Primitive, index: usize) -> Result<[Option<usize>; 3], Error> {
        let (model, moved) = (self.model, self.moved);
        let block = &model.blocks[index];
        let position = self.version((index, block.accessor, None), |_| model.new_positions(block, moved))?;
        let normal = match primitive.normal {
            None => None,
            Some(a) => self.version((index, a, Some(a)), |_| model.new_normals(block, a, moved))?,
        };
        let tangent = match primitive.tangent {
            None => None,
            Some(a) => self.version((index, a, primitive.normal), |versions| {
                let packed = match (primitive.normal, normal) {
                    (Some(n), None) => Some((n, model.packed(n)?)),
                    _ => None,
                };
                let normals = match (primitive.normal, normal) {
                    (Some(n), Some(version)) => Some((n, &versions[&n][version].bytes[..])),
                    _ => packed.as_ref().map(|(n, bytes)| (*n, &bytes[..])),
                };
                model.new_tangents(block, a, normals, moved)
            })?,
        };
        Ok([position, normal, tangent])
    }

    /// The number of the version that `make` gives for the accessor `key.1`, `None` for as it was.
    fn version(
        &mut self,
        key: (usize, usize, Option<usize>),
        make: impl FnOnce(&Versions) -> Result<Option<Content>, Error>,
    ) -> Result<Option<usize>, Error> {
        if let Some(known) = self.known.get(&key) {
            return Ok(*known);
        }
        let version = make(&self.versions)?.map(|content| {
            let content = Rc::new(content);
            *self.numbers.entry((key.1, Rc::clone(&content))).or_insert_with(|| {
                let all = self.versions.entry(key.1).or_default();
                all.push(content);
                all.len() - 1
            })
        });
        self.known.insert(key, version);
        Ok(version)
    }
}

/// Of each accessor, whether something wants it as it was.
fn kept(gltf: &Gltf, forms: &[Vec<Form>]) -> Result<Vec<bool>, Error> {
    let mut kept = vec![false; gltf.model.accessors.len()];
    for (primitives, forms) in gltf.model.meshes.iter().zip(forms) {
        for (p, primitive) in primitives.iter().enumerate() {
            primitive.others.iter().for_each(|&a| kept[a] = true);
            for (k, accessor) in accessors_of(primitive).into_iter().enumerate() {
                let Some(accessor) = accessor else { continue };
                kept[accessor] |= forms.is_empty() || forms.iter().any(|form| form[p][k].is_none());
            }
        }
    }
    let root = At::root(&gltf.json);
    let mut keep = |at: &At<'_>, key: &str| -> Result<(), Error> {
        if let Some(a) = at.index_of(key, kept.len(), "accessors")? {
            kept[a] = true;
        }
        Ok(())
    };
    for skin in root.items("skins")? {
        keep(&skin, "inverseBindMatrices")?;
    }
    for animation in root.items("animations")? {
        for sampler in animation.items("samplers")? {
            keep(&sampler, "input")?;
            keep(&sampler, "output")?;
        }
    }
    Ok(kept)
}

/// Of each accessor, whether some byte of it is read by something else too.
fn shared(gltf: &Gltf) -> Result<Vec<bool>, Error> {
    let model = &gltf.model;
    let (views, buffers) = (&model.views, &model.buffers);
    let mut readers: Vec<(Reach, Option<usize>)> = Vec::new();
    for (a, accessor) in model.accessors.iter().enumerate() {
        readers.extend(accessor.reach(views, buffers).map(|reach| (reach, Some(a))));
        readers.extend(accessor.sparse_reach(views, buffers).into_iter().map(|reach| (reach, None)));
    }
    for image in At::root(&gltf.json).items("images")? {
        if let Some(v) = image.index_of("bufferView", views.len(), "bufferViews")? {
            let (view, size) = (&views[v], views[v].length);
            let storage = buffers.buffers[view.buffer].storage;
            readers.push((Reach { storage, start: view.offset, stride: size.max(1), size, count: 1 }, None));
        }
    }
    readers.sort_unstable_by_key(|(reach, _)| (reach.storage, reach.start));
    let mut shared = vec![false; model.accessors.len()];
    let mut mark = |accessor: Option<usize>| accessor.into_iter().for_each(|a| shared[a] = true);
    // A reader that overlaps very many others counts as shared with all in its stretch, so that time stays linear.
    let mut crowded = (0, 0);
    for (i, (reach, accessor)) in readers.iter().enumerate() {
        if crowded.0 == reach.storage && reach.start < crowded.1 {
            mark(*accessor);
        }
        let near = |other: &&(Reach, _)| other.0.storage == reach.storage && other.0.start < reach.end();
        let mut seen = 0;
        for (other, other_accessor) in readers[i + 1..].iter().take_while(near) {
            seen += 1;
            if seen > 256 {
                mark(*accessor);
                let end = if crowded.0 == reach.storage { crowded.1.max(reach.end()) } else { reach.end() };
                crowded = (reach.storage, end);
                break;
            }
            if reach.meets(other) {
                mark(*accessor);
                mark(*other_accessor);
            }
        }
    }
    Ok(shared)
}
