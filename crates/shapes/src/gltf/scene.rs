//! Nodes with their places in the world, and skins.

use super::accessor::{Accessor, View};
use super::affine::Affine;
use super::buffers::Buffers;
use super::json::At;
use crate::error::Error;

pub(super) struct Node {
    pub mesh: Option<usize>,
    pub skin: Option<usize>,
    pub world: Affine,
    /// Whether some scene shows it.
    pub shown: bool,
}

/// Reads the nodes and sets their world transforms from the roots down.
pub(super) fn read_nodes(root: &At<'_>, meshes: usize, skins: usize) -> Result<Vec<Node>, Error> {
    let items = root.items("nodes")?;
    let mut nodes = Vec::with_capacity(items.len());
    let mut parents: Vec<Option<usize>> = vec![None; items.len()];
    let mut children = Vec::with_capacity(items.len());
    for (i, at) in items.iter().enumerate() {
        nodes.push(Node {
            mesh: at.index_of("mesh", meshes, "meshes")?,
            skin: at.index_of("skin", skins, "skins")?,
            world: local_transform(at)?,
            shown: false,
        });
        let mut own = Vec::new();
        for child_at in at.items("children")? {
            let child = child_at.index(items.len(), "nodes")?;
            if let Some(other) = parents[child].replace(i) {
                return Err(child_at.error(format!("nodes[{child}] is also a child of nodes[{other}]")));
            }
            own.push(child);
        }
        children.push(own);
    }
    let mut stack: Vec<usize> = (0..nodes.len()).filter(|&i| parents[i].is_none()).collect();
    let mut placed = vec![false; nodes.len()];
    while let Some(i) = stack.pop() {
        placed[i] = true;
        for &child in &children[i] {
            nodes[child].world = nodes[i].world.after(&nodes[child].world);
            stack.push(child);
        }
    }
    if let Some(i) = placed.iter().position(|placed| !placed) {
        return Err(Error::malformed(format!("nodes[{i}].children: the node is its own descendant")));
    }
    let scenes = root.items("scenes")?;
    if scenes.is_empty() {
        nodes.iter_mut().for_each(|node| node.shown = true);
    }
    for scene in &scenes {
        for node in scene.items("nodes")? {
            stack.push(node.index(nodes.len(), "nodes")?);
        }
        while let Some(i) = stack.pop() {
            if !std::mem::replace(&mut nodes[i].shown, true) {
                stack.extend(&children[i]);
            }
        }
    }
    Ok(nodes)
}

fn local_transform(at: &At<'_>) -> Result<Affine, Error> {
    if let Some(matrix) = at.numbers::<16>("matrix")? {
        return Affine::from_columns(&matrix)
            .ok_or_else(|| at.error("the last row of \"matrix\" is not 0 0 0 1"));
    }
    let translation = at.numbers("translation")?.unwrap_or([0.0; 3]);
    let rotation = at.numbers("rotation")?.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let scale = at.numbers("scale")?.unwrap_or([1.0; 3]);
    Ok(Affine::from_parts(translation, rotation, scale))
}

/// For each joint, the map from the mesh's coordinates at bind time to the world at rest.
pub(super) type Skin = Vec<Affine>;

pub(super) fn read_skins(
    root: &At<'_>,
    nodes: &[Node],
    accessors: &[Accessor],
    views: &[View],
    buffers: &Buffers,
    room: usize,
) -> Result<Vec<Skin>, Error> {
    let (mut skins, mut matrices) = (Vec::new(), 0usize);
    for at in root.items("skins")? {
        let joints = at.items("joints")?;
        let bind = match at.index_of("inverseBindMatrices", accessors.len(), "accessors")? {
            None => None,
            Some(a) => {
                let (accessor, wrong) = (&accessors[a], |what: &str| {
                    Err(at.error(format!("inverseBindMatrices: accessors[{a}] {what}")))
                });
                if accessor.width != 16 || accessor.size != 64 {
                    return wrong("does not hold MAT4 of floats");
                }
                if accessor.count < joints.len() {
                    return wrong(&format!("holds {} matrices for {} joints", accessor.count, joints.len()));
                }
                matrices = matrices.saturating_add(accessor.count);
                if matrices > room {
                    return Err(Error::unsupported(
                        "the skins have too many matrices for a file of this size",
                    ));
                }
                Some((accessor, accessor.packed(a, views, buffers)?))
            }
        };
        let mut skin = Vec::with_capacity(joints.len());
        for (j, joint) in joints.iter().enumerate() {
            let world = nodes[joint.index(nodes.len(), "nodes")?].world;
            skin.push(match &bind {
                None => world,
                Some((accessor, packed)) => {
                    let matrix: [f64; 16] = std::array::from_fn(|k| accessor.number(packed, j, k));
                    let Some(bind) = Affine::from_columns(&matrix) else {
                        return Err(at.error(format!(
                            "inverseBindMatrices: the last row of matrix {j} is not 0 0 0 1"
                        )));
                    };
                    world.after(&bind)
                }
            });
        }
        skins.push(skin);
    }
    Ok(skins)
}
