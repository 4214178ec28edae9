//! What moved positions mean for one block in its node's own space: new positions, normals and tangents.

use super::accessor::{Accessor, Component};
use super::affine::{self, Affine};
use super::mesh::{Block, Placement};
use super::Model;
use crate::document::Moved;
use crate::error::Error;
use crate::memory;
use crate::normals::{apply, length, map_at, turn};

/// How far a position may be rounded to stay quantised, as a part of the mesh's longest side. Shorts are far below it.
const COARSEST_ROUNDING: f64 = 1e-3;

/// The elements of an accessor, one after another.
#[derive(PartialEq, Eq, Hash)]
pub(super) struct Content {
    pub component: Component,
    pub bytes: Vec<u8>,
}

/// The linear parts of the vertices' transforms with their inverses; computed once where all have the same.
struct Frames<'a> {
    placement: Placement<'a>,
    whole: Option<Frame>,
}

type Frame = ([f64; 9], [f64; 9], bool);

impl Frames<'_> {
    fn of(&self, i: usize) -> Result<Frame, Error> {
        self.whole.map_or_else(|| Ok(frame(&self.placement.of(i)?)), Ok)
    }
}

fn frame(affine: &Affine) -> Frame {
    let (inverse, regular) = affine::inverse(&affine.linear);
    (affine.linear, inverse, regular)
}

impl Model {
    fn frames(&self, block: &Block) -> Result<Frames<'_>, Error> {
        let placement = self.placement(block)?;
        let whole = match &placement {
            Placement::Node(world) => Some(frame(world)),
            Placement::Skin { .. } => None,
        };
        Ok(Frames { placement, whole })
    }

    /// The positions of a block in its node's space, `None` if they are as they were. A vertex moves by its displacement
    /// taken back into that space, so that one that did not move keeps its very bytes.
    pub fn new_positions(&self, block: &Block, moved: &Moved<'_>) -> Result<Option<Content>, Error> {
        let accessor = &self.accessors[block.accessor];
        let range = 3 * block.first..3 * (block.first + accessor.count);
        let (before, after) = (&moved.before[range.clone()], &moved.after[range]);
        if before == after {
            return Ok(None);
        }
        let frames = self.frames(block)?;
        let mut packed = self.packed(block.accessor)?;
        let mut now = memory::with_room(accessor.count)?;
        for i in 0..accessor.count {
            let mut position = accessor.vec3(&packed, i);
            let by: [f64; 3] = std::array::from_fn(|k| after[3 * i + k] - before[3 * i + k]);
            if by != [0.0; 3] {
                let (_, inverse, _) = frames.of(i)?;
                let by = apply(&inverse, by);
                position = std::array::from_fn(|k| position[k] + by[k]);
            }
            if position.iter().any(|c| !(*c as f32).is_finite()) {
                let position = block.first + i;
                return Err(Error::argument(format!(
                    "position {position} is too far out for glTF's 32-bit floats"
                )));
            }
            now.push(position);
        }
        if stays_precise(accessor, &now) {
            let size = accessor.component.size();
            for (element, position) in packed.chunks_exact_mut(accessor.size).zip(&now) {
                for (bytes, c) in element.chunks_exact_mut(size).zip(position) {
                    accessor.component.store(accessor.stored(*c), bytes);
                }
            }
            return self.changed(block.accessor, packed);
        }
        let mut bytes = memory::with_room(12 * now.len())?;
        now.iter().flatten().for_each(|c| bytes.extend((*c as f32).to_le_bytes()));
        Ok(Some(Content { component: Component::F32, bytes }))
    }

    /// The normals of a block, turned by the local maps; `None` if they are as they were.
    pub fn new_normals(
        &self,
        block: &Block,
        normals: usize,
        moved: &Moved<'_>,
    ) -> Result<Option<Content>, Error> {
        self.turned(block, normals, moved, |map, n, _| turn(map, n))
    }

    /// The tangents of a block, which move with the surface and stay across the new normals (an accessor and its new
    /// elements) if there are any; `None` if they are as they were. Their fourth number, a sign, stays: normals turn by
    /// the cofactors, which keeps the handedness even in a reflection.
    pub fn new_tangents(
        &self,
        block: &Block,
        tangents: usize,
        normals: Option<(usize, &[u8])>,
        moved: &Moved<'_>,
    ) -> Result<Option<Content>, Error> {
        self.turned(block, tangents, moved, |map, t, i| {
            let mut along = apply(map, t);
            if let Some((accessor, packed)) = normals {
                let n = self.accessors[accessor].vec3(packed, i);
                let square: f64 = n.iter().map(|c| c * c).sum();
                if square > 0.0 {
                    let part = (0..3).map(|k| n[k] * along[k]).sum::<f64>() / square;
                    let across: [f64; 3] = std::array::from_fn(|k| along[k] - part * n[k]);
                    // A tangent along the normal (some exporters write such) has no direction across it.
                    if length(across) > 1e-3 * length(along) {
                        along = across;
                    }
                }
            }
            let scale = length(t) / length(along);
            if scale.is_finite() {
                along.map(|c| c * scale)
            } else {
                t
            }
        })
    }

    /// An attribute whose first three numbers `turn` changes by each vertex's local map in its node's space.
    fn turned(
        &self,
        block: &Block,
        index: usize,
        moved: &Moved<'_>,
        turn: impl Fn(&[f64; 9], [f64; 3], usize) -> [f64; 3],
    ) -> Result<Option<Content>, Error> {
        let Some(maps) = moved.maps else { return Ok(None) };
        let accessor = &self.accessors[index];
        let frames = self.frames(block)?;
        let mut packed = self.packed(index)?;
        for i in 0..accessor.count {
            let map = map_at(maps, block.first + i);
            if *map == Affine::IDENTITY.linear {
                continue;
            }
            let (linear, inverse, regular) = frames.of(i)?;
            let was = accessor.vec3(&packed, i);
            let now = turn(&affine::product(&inverse, &affine::product(map, &linear)), was, i);
            if !regular || now.iter().chain(&was).any(|c| !c.is_finite()) {
                continue;
            }
            let (low, high) = accessor.component.range();
            let size = accessor.component.size();
            for k in 0..3 {
                let stored = accessor.stored(now[k]).clamp(low, high);
                accessor.component.store(stored, &mut packed[i * accessor.size + k * size..]);
            }
        }
        self.changed(index, packed)
    }

    /// `bytes` as new content of an accessor, if they are not what it has.
    fn changed(&self, accessor: usize, bytes: Vec<u8>) -> Result<Option<Content>, Error> {
        let component = self.accessors[accessor].component;
        Ok((self.packed(accessor)? != bytes).then_some(Content { component, bytes }))
    }
}

/// Whether the positions fit the accessor's type: within its range, and not rounded noticeably.
fn stays_precise(accessor: &Accessor, positions: &[[f64; 3]]) -> bool {
    if accessor.component == Component::F32 {
        return true;
    }
    let (least, most) = accessor.component.range();
    let (mut low, mut high, mut error) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3], 0.0f64);
    for position in positions {
        for k in 0..3 {
            let stored = accessor.stored(position[k]);
            low[k] = low[k].min(stored);
            high[k] = high[k].max(stored);
            error = error.max((stored - stored.round()).abs());
        }
    }
    let longest = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
    let within = (0..3).all(|k| low[k].round() >= least && high[k].round() <= most);
    within && error <= COARSEST_ROUNDING * longest
}
