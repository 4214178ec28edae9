//! The whole network, laid out as a node that has everything open.

use super::columns::Columns;
use super::node::{Heads, Part};
use super::rows::Rows;
use crate::logits::neural::network::Network;
use crate::simd::{Aligned, WIDTH};

/// Rows of layer 2 that are laid out at a time: so few that they stay in the cache.
pub(super) const PACK: usize = 4 * WIDTH;

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
            planes: vec![[Aligned::ZERO; 4]; layer1.outputs().div_ceil(WIDTH)],
        };
        for (j, (row, b)) in layer1.weight.chunks_exact(dim).zip(&layer1.bias).enumerate() {
            let planes = &mut columns.planes[j / WIDTH];
            for (plane, w) in planes.iter_mut().zip(row) {
                plane.0[j % WIDTH] = *w;
            }
            planes[3].0[j % WIDTH] = *b;
        }
        let (outputs, rows) = (layer3.outputs(), layer2.outputs());
        let groups = outputs.div_ceil(WIDTH);
        let mut output = vec![[Aligned::ZERO; 4]; groups];
        let mut weights = vec![Aligned::ZERO; rows * groups];
        for (k, (row, b)) in layer3.weight.chunks_exact(rows).zip(&layer3.bias).enumerate() {
            let (group, lane) = (k / WIDTH, k % WIDTH);
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

    /// Lays out rows of layer 2 from `first` on, as many as there are, or as `rows` is to hold.
    pub(super) fn pack(&self, network: &Network, first: usize, rows: &mut Rows) {
        let layer = &network.layers()[1];
        let columns = layer.inputs();
        let last = (first + PACK).min(self.rows());
        rows.clear(columns, PACK / WIDTH);
        rows.ids.extend(first as u32..last as u32);
        let weight = layer.weight[first * columns..last * columns].chunks(WIDTH * columns);
        for (weight, bias) in weight.zip(layer.bias[first..last].chunks(WIDTH)) {
            let mut affine = [Aligned::ZERO; 4];
            affine[3].0[..bias.len()].copy_from_slice(bias);
            rows.push(affine);
            transpose(weight, columns, rows.last_panel());
        }
    }
}

/// At most 16 rows of `weight`, column by column.
fn transpose(weight: &[f32], columns: usize, panel: &mut [Aligned]) {
    for (chunk, panel) in panel.chunks_mut(WIDTH).enumerate() {
        let mut tile = [Aligned::ZERO; WIDTH];
        for (tile, row) in tile.iter_mut().zip(weight.chunks_exact(columns)) {
            let row = &row[chunk * WIDTH..][..panel.len()];
            tile.0[..row.len()].copy_from_slice(row);
        }
        for (j, column) in panel.iter_mut().enumerate() {
            for t in 0..WIDTH {
                column.0[t] = tile[t].0[j];
            }
        }
    }
}
