//! The whole network, laid out as a node that has everything open.

use super::columns::Columns;
use super::node::{Heads, Part};
use super::rows::Rows;
use crate::logits::neural::network::Network;
use crate::parallel::for_each_block;
use crate::simd::{Lanes, LANES};

/// Bytes of layer 2 that are laid out at a time.
const SLAB: usize = 4 << 20;

/// A network without Fourier features.
pub(super) struct Whole {
    /// Layer 1 and the biases of the output; its rows are [packed](Whole::pack) as they are needed.
    pub part: Part,
    pub heads: Heads,
}

impl Whole {
    pub(super) fn new(network: &Network) -> Whole {
        let [layer1, layer2, layer3] = network.layers();
        let dim = network.dim();
        let mut columns = Columns {
            len: layer1.outputs(),
            planes: vec![[Lanes::ZERO; 4]; layer1.outputs().div_ceil(LANES)],
        };
        for (j, (row, b)) in layer1.weight.chunks_exact(dim).zip(&layer1.bias).enumerate() {
            let planes = &mut columns.planes[j / LANES];
            for (plane, w) in planes.iter_mut().zip(row) {
                plane.0[j % LANES] = *w;
            }
            planes[3].0[j % LANES] = *b;
        }
        let (outputs, rows) = (layer3.outputs(), layer2.outputs());
        let groups = outputs.div_ceil(LANES);
        let mut output = vec![[Lanes::ZERO; 4]; groups];
        let mut weights = vec![Lanes::ZERO; rows * groups];
        for (k, (row, b)) in layer3.weight.chunks_exact(rows).zip(&layer3.bias).enumerate() {
            let (group, lane) = (k / LANES, k % LANES);
            output[group][3].0[lane] = *b;
            for (weights, w) in weights.chunks_exact_mut(groups).zip(row) {
                weights[group].0[lane] = *w;
            }
        }
        let part = Part { columns, output, ..Part::default() };
        Whole { part, heads: Heads { outputs, groups, weights } }
    }

    /// Rows of layer 2.
    pub(super) fn rows(&self) -> usize {
        self.heads.weights.len() / self.heads.groups
    }

    /// Lays out rows of layer 2 from `first` on, as many as there are, or as a slab holds.
    pub(super) fn pack(&self, network: &Network, first: usize, slab: &mut Rows) {
        let layer = &network.layers()[1];
        let columns = layer.inputs();
        let most = (SLAB / size_of::<Lanes>() / columns).max(2) * LANES;
        let rows = (self.rows() - first).min(most);
        let panels = rows.div_ceil(LANES);
        slab.len = rows;
        slab.ids = (first as u32..(first + rows) as u32).collect();
        slab.affine.clear();
        slab.affine.resize(panels, [Lanes::ZERO; 4]);
        for (at, b) in layer.bias[first..first + rows].iter().enumerate() {
            slab.affine[at / LANES][3].0[at % LANES] = *b;
        }
        slab.matrix.resize(panels * columns, Lanes::ZERO);
        let weight = &layer.weight[first * columns..(first + rows) * columns];
        for_each_block(&mut slab.matrix, columns, |panel, matrix| {
            transpose(&weight[panel * LANES * columns..], columns, matrix);
        });
    }
}

/// At most 16 rows of `weight`, column by column.
fn transpose(weight: &[f32], columns: usize, panel: &mut [Lanes]) {
    for (chunk, panel) in panel.chunks_mut(LANES).enumerate() {
        let mut tile = [Lanes::ZERO; LANES];
        for (tile, row) in tile.iter_mut().zip(weight.chunks_exact(columns)) {
            let row = &row[chunk * LANES..][..panel.len()];
            tile.0[..row.len()].copy_from_slice(row);
        }
        for (j, column) in panel.iter_mut().enumerate() {
            for t in 0..LANES {
                column.0[t] = tile[t].0[j];
            }
        }
    }
}
