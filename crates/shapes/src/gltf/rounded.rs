//! What of a position arrives in the file: it is stored in its node's own space, in the type of its accessor.

use std::collections::hash_map::{Entry, HashMap};

use super::affine::{self, Affine};
use super::mesh::{Block, Placement};
use super::Model;
use crate::bounds::Bounds;
use crate::document::Moved;
use crate::error::Error;
use crate::memory;
use crate::normals::{apply, length};
use crate::precision::single;

impl Model {
    /// The positions that reading the file gives after it was written with those of `after`.
    pub fn positions_written(&self, before: &[f64], after: &[f64]) -> Result<Vec<f64>, Error> {
        let mut written = memory::copy(before)?;
        let moved = Moved { before, after, maps: None, stem: None };
        for block in &self.blocks {
            let Some(content) = self.new_positions(block, &moved)? else { continue };
            let (accessor, placement) = (&self.accessors[block.accessor], self.placement(block)?);
            let size = content.component.size();
            for i in 0..accessor.count {
                let stored = [0, 1, 2].map(|k| content.component.load(&content.bytes[(3 * i + k) * size..]));
                let is_float = content.component != accessor.component;
                let local = if is_float { stored } else { stored.map(|c| accessor.meaning(c)) };
                let at = 3 * (block.first + i);
                written[at..at + 3].copy_from_slice(&placement.of(i)?.apply(local));
            }
        }
        Ok(written)
    }

    /// Places anywhere, each as a vertex of the node that is nearest to it (by its box, as the shape was read) would be stored there.
    pub fn places_written(&self, before: &[f64], places: &[f64]) -> Result<Vec<f64>, Error> {
        let of_block = |block: &Block| &before[3 * block.first..][..3 * self.accessors[block.accessor].count];
        let boxes: Vec<_> = self.blocks.iter().map(|block| Bounds::of(of_block(block), 3)).collect();
        let mut placements: HashMap<usize, Placement<'_>> = HashMap::new();
        let mut written = memory::with_room(places.len())?;
        for place in places.as_chunks::<3>().0 {
            let nearest = (0..boxes.len()).min_by(|&a, &b| {
                let distance = |i: usize| outside(&boxes[i], place);
                distance(a).total_cmp(&distance(b))
            });
            let index = nearest.expect("a file without blocks is refused");
            let block = &self.blocks[index];
            let accessor = &self.accessors[block.accessor];
            let placement = match placements.entry(index) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(free) => free.insert(self.placement(block)?),
            };
            let world = placement.of(match placement {
                Placement::Node(_) => 0,
                Placement::Skin { .. } => nearest_vertex(of_block(block), place),
            })?;
            let local = local(&world, place);
            let stored = local.map(|c| accessor.rounded(c));
            // Beyond the range of a quantised accessor, the file gets floats.
            let fits = (0..3).all(|k| (stored[k] - local[k]).abs() <= accessor.step(local[k]));
            written.extend(world.apply(if fits { stored } else { local.map(single) }));
        }
        Ok(written)
    }

    /// The longest way from a vertex to the next place that its accessor can store, in the world.
    pub fn step(&self) -> Result<f64, Error> {
        let mut longest = 0f64;
        for block in &self.blocks {
            let (accessor, placement) = (&self.accessors[block.accessor], self.placement(block)?);
            let packed = self.packed(block.accessor)?;
            for i in 0..accessor.count {
                let (world, position) = (placement.of(i)?, accessor.vec3(&packed, i));
                for (k, &at) in position.iter().enumerate() {
                    let axis = [world.linear[k], world.linear[3 + k], world.linear[6 + k]];
                    longest = longest.max(accessor.step(at) * length(axis));
                }
            }
        }
        Ok(longest)
    }
}

fn local(world: &Affine, place: &[f64; 3]) -> [f64; 3] {
    let (inverse, _) = affine::inverse(&world.linear);
    apply(&inverse, std::array::from_fn(|k| place[k] - world.translation[k]))
}

/// The square of the distance from a box.
fn outside(bounds: &Bounds, place: &[f64; 3]) -> f64 {
    (0..3).map(|k| (bounds.low[k] - place[k]).max(place[k] - bounds.high[k]).max(0.0).powi(2)).sum()
}

fn nearest_vertex(positions: &[f64], place: &[f64; 3]) -> usize {
    let square = |p: &[f64; 3]| (0..3).map(|k| (p[k] - place[k]).powi(2)).sum::<f64>();
    let all = positions.as_chunks::<3>().0.iter().map(square).enumerate();
    all.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(i, _)| i)
}
