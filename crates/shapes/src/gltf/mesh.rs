//! Primitives, the nodes that show them, and the blocks of positions that these make in the world.

use std::collections::HashMap;

use super::accessor::{Accessor, Component};
use super::affine::Affine;
use super::json::At;
use super::Model;
use crate::error::Error;
use crate::memory;

/// One draw call of a mesh.
pub(super) struct Primitive {
    mode: usize,
    indices: Option<usize>,
    pub position: Option<usize>,
    pub normal: Option<usize>,
    pub tangent: Option<usize>,
    /// Pairs of accessors: joints and weights.
    influences: Vec<(usize, usize)>,
    /// The other accessors that it names, which must keep what they hold.
    pub others: Vec<usize>,
    path: String,
}

/// A mesh at a node: for each primitive the index of its block.
pub(super) struct Instance {
    pub node: usize,
    pub mesh: usize,
    pub blocks: Vec<Option<usize>>,
}

/// The positions of one accessor at one node.
pub(super) struct Block {
    node: usize,
    pub accessor: usize,
    influences: Vec<(usize, usize)>,
    /// The index of its first position among all.
    pub first: usize,
}

pub(super) fn read_meshes(root: &At<'_>, accessors: &[Accessor]) -> Result<Vec<Vec<Primitive>>, Error> {
    let mesh = |at: &At<'_>| at.items("primitives")?.iter().map(|p| read_primitive(p, accessors)).collect();
    root.items("meshes")?.iter().map(mesh).collect()
}

fn read_primitive(at: &At<'_>, accessors: &[Accessor]) -> Result<Primitive, Error> {
    let mode = at.uint_or("mode", 4)?;
    if mode > 6 {
        return Err(at.error(format!("mode {mode} is not one of glTF (0 to 6)")));
    }
    let mut primitive = Primitive {
        mode,
        indices: at.index_of("indices", accessors.len(), "accessors")?,
        position: None,
        normal: None,
        tangent: None,
        influences: Vec::new(),
        others: Vec::new(),
        path: at.path.clone(),
    };
    primitive.others.extend(primitive.indices);
    let attributes = at.need("attributes")?;
    for (key, attribute) in attributes.members()? {
        let index = attribute.index(accessors.len(), "accessors")?;
        match key {
            "POSITION" => primitive.position = Some(vector(&attribute, index, &accessors[index], 3)?),
            "NORMAL" => primitive.normal = Some(vector(&attribute, index, &accessors[index], 3)?),
            "TANGENT" => primitive.tangent = Some(vector(&attribute, index, &accessors[index], 4)?),
            _ => primitive.others.push(index),
        }
    }
    for target in at.items("targets")? {
        for (_, delta) in target.members()? {
            primitive.others.push(delta.index(accessors.len(), "accessors")?);
        }
    }
    // No viewer blends more than a few sets; the limit keeps a hostile file from claiming thousands.
    for set in 0..8 {
        let of = |name: &str| attributes.index_of(&format!("{name}_{set}"), accessors.len(), "accessors");
        let (Some(joints), Some(weights)) = (of("JOINTS")?, of("WEIGHTS")?) else { break };
        for (index, fine) in [
            (joints, matches!(accessors[joints].component, Component::U8 | Component::U16)),
            (weights, accessors[weights].component == Component::F32 || accessors[weights].normalized),
        ] {
            if accessors[index].width != 4 || !fine {
                return Err(attributes.error(format!(
                    "accessors[{index}] is not of a type for joints or weights (set {set})"
                )));
            }
        }
        primitive.influences.push((joints, weights));
    }
    if let Some(position) = primitive.position {
        let skinning = primitive.influences.iter().flat_map(|&(joints, weights)| [joints, weights]);
        for other in primitive.normal.into_iter().chain(primitive.tangent).chain(skinning) {
            let (found, wanted) = (accessors[other].count, accessors[position].count);
            if found != wanted {
                return Err(attributes
                    .error(format!("accessors[{other}] has {found} elements for the {wanted} of POSITION")));
            }
        }
    }
    Ok(primitive)
}

/// Checks that an accessor holds vectors of `width` numbers.
fn vector(at: &At<'_>, index: usize, accessor: &Accessor, width: usize) -> Result<usize, Error> {
    if accessor.width != width || accessor.component == Component::U32 {
        return Err(at.error(format!("accessors[{index}] is not VEC{width} of floats, shorts or bytes")));
    }
    Ok(index)
}

/// What the nodes show: instances and blocks. `room` limits what instancing makes of a small file.
pub(super) fn place(model: &mut Model, room: usize) -> Result<(), Error> {
    // Node, accessor, influences -> block.
    type Key<'a> = (usize, usize, &'a [(usize, usize)]);
    let mut known: HashMap<Key<'_>, usize> = HashMap::new();
    let (mut total, mut visits) = (0usize, 0usize);
    for (node, mesh) in
        model.nodes.iter().enumerate().filter(|(_, n)| n.shown).filter_map(|(i, n)| Some((i, n.mesh?)))
    {
        visits = visits.saturating_add(model.meshes[mesh].len());
        let mut blocks = Vec::new();
        for primitive in &model.meshes[mesh] {
            let Some(accessor) = primitive.position else {
                blocks.push(None);
                continue;
            };
            let skinned = model.nodes[node].skin.is_some();
            let influences = if skinned { &primitive.influences[..] } else { &[] };
            let block = *known.entry((node, accessor, influences)).or_insert_with(|| {
                let first = total;
                total = total.saturating_add(model.accessors[accessor].count);
                model.blocks.push(Block { node, accessor, influences: influences.to_vec(), first });
                model.blocks.len() - 1
            });
            blocks.push(Some(block));
            if total > room || visits > room {
                return Err(Error::unsupported(format!(
                    "the nodes show the meshes so often that there would be {} positions and more, too many for a \
                     file of this size",
                    total.max(visits)
                )));
            }
        }
        model.instances.push(Instance { node, mesh, blocks });
    }
    Ok(())
}

/// Where the vertices of a block go: the one transform of a node, or a blend of joints for each vertex.
pub(super) enum Placement<'a> {
    Node(Affine),
    Skin { joints: &'a [Affine], skin: usize, influences: Vec<[(&'a Accessor, Vec<u8>); 2]> },
}

impl Placement<'_> {
    /// The transform of vertex `i`. A vertex without weights stays where the mesh has it.
    pub fn of(&self, i: usize) -> Result<Affine, Error> {
        let (joints, skin, influences) = match self {
            Placement::Node(world) => return Ok(*world),
            Placement::Skin { joints, skin, influences } => (joints, skin, influences),
        };
        let mut sum = Affine { linear: [0.0; 9], translation: [0.0; 3] };
        let mut all = 0.0;
        for [(of_joints, packed_joints), (of_weights, packed_weights)] in influences {
            for k in 0..4 {
                let weight = of_weights.number(packed_weights, i, k);
                if weight == 0.0 || !weight.is_finite() {
                    continue;
                }
                let joint = of_joints.number(packed_joints, i, k) as usize;
                let matrix = joints.get(joint).ok_or_else(|| {
                    Error::malformed(format!(
                        "skins[{skin}].joints: vertex {i} follows joint {joint}, there are {}",
                        joints.len()
                    ))
                })?;
                all += weight;
                (0..9).for_each(|e| sum.linear[e] += weight * matrix.linear[e]);
                (0..3).for_each(|e| sum.translation[e] += weight * matrix.translation[e]);
            }
        }
        if all.abs() < 1e-9 {
            return Ok(Affine::IDENTITY);
        }
        Ok(Affine { linear: sum.linear.map(|c| c / all), translation: sum.translation.map(|c| c / all) })
    }
}

impl Model {
    pub fn packed(&self, accessor: usize) -> Result<Vec<u8>, Error> {
        self.accessors[accessor].packed(accessor, &self.views, &self.buffers)
    }

    pub fn placement(&self, block: &Block) -> Result<Placement<'_>, Error> {
        let node = &self.nodes[block.node];
        // The transform of a skinned mesh's own node does not count.
        let Some(skin) = node.skin else { return Ok(Placement::Node(node.world)) };
        let both = |&(joints, weights): &(usize, usize)| -> Result<_, Error> {
            let of = |a: usize| Ok((&self.accessors[a], self.packed(a)?));
            Ok([of(joints)?, of(weights)?])
        };
        let influences = block.influences.iter().map(both).collect::<Result<_, Error>>()?;
        Ok(Placement::Skin { joints: &self.skins[skin], skin, influences })
    }

    /// All positions in the world, block after block.
    pub fn positions(&self) -> Result<Vec<f64>, Error> {
        let total = self.blocks.last().map_or(0, |b| b.first + self.accessors[b.accessor].count);
        let mut positions = memory::with_room(3 * total)?;
        for block in &self.blocks {
            let (accessor, placement) = (&self.accessors[block.accessor], self.placement(block)?);
            let packed = self.packed(block.accessor)?;
            for i in 0..accessor.count {
                let world = placement.of(i)?.apply(accessor.vec3(&packed, i));
                if world.iter().any(|c| !c.is_finite()) {
                    return Err(Error::malformed(format!(
                        "accessors[{}]: position {i}, placed by nodes[{}], is not finite",
                        block.accessor, block.node
                    )));
                }
                positions.extend(world);
            }
        }
        Ok(positions)
    }

    /// All triangles, `None` if no primitive is made of triangles.
    pub fn faces(&self, room: usize) -> Result<Option<Vec<[u32; 3]>>, Error> {
        let (mut faces, mut any) = (Vec::new(), false);
        for instance in &self.instances {
            for (primitive, block) in self.meshes[instance.mesh].iter().zip(&instance.blocks) {
                let (Some(block), 4..=6) = (block, primitive.mode) else { continue };
                any = true;
                let block = &self.blocks[*block];
                let corners = self.corners(primitive, self.accessors[block.accessor].count)?;
                let count = corners.len();
                let triangles = if primitive.mode == 4 { count / 3 } else { count.saturating_sub(2) };
                if triangles > room - faces.len() {
                    return Err(Error::unsupported(
                        "the nodes show the meshes so often that there are too many triangles for a file of this size",
                    ));
                }
                let first = block.first as u32;
                memory::reserve(&mut faces, triangles)?;
                faces.extend((0..triangles).map(|t| {
                    let [a, b, c] = match primitive.mode {
                        4 => [3 * t, 3 * t + 1, 3 * t + 2],
                        5 => [t, t + 1 + t % 2, t + 2 - t % 2],
                        _ => [0, t + 1, t + 2],
                    };
                    [a, b, c].map(|corner| first + corners[corner])
                }));
            }
        }
        Ok(any.then_some(faces))
    }

    /// The vertices of a primitive in drawing order.
    fn corners(&self, primitive: &Primitive, vertices: usize) -> Result<Vec<u32>, Error> {
        let Some(index) = primitive.indices else {
            let mut all = memory::with_room(vertices)?;
            all.extend(0..vertices as u32);
            return Ok(all);
        };
        let accessor = &self.accessors[index];
        let whole = matches!(accessor.component, Component::U8 | Component::U16 | Component::U32);
        let wrong =
            |why: String| Error::malformed(format!("{}.indices: accessors[{index}] {why}", primitive.path));
        if accessor.width != 1 || !whole {
            return Err(wrong("does not hold unsigned whole numbers".to_string()));
        }
        let packed = self.packed(index)?;
        let corner = |(i, bytes): (usize, &[u8])| {
            let corner = accessor.component.load(bytes) as u32;
            if (corner as usize) < vertices {
                return Ok(corner);
            }
            Err(wrong(format!("has the index {corner} (number {i}), there are {vertices} positions")))
        };
        let mut corners = memory::with_room(accessor.count)?;
        for element in packed.chunks_exact(accessor.size).enumerate() {
            corners.push(corner(element)?);
        }
        Ok(corners)
    }
}
