//! The whole network, laid out as a node that has everything open.

use std::sync::{Arc, Mutex};

use super::columns::Columns;
use super::part::{Heads, Part};
use super::rows::{Block, Rows};
use super::workspace::Workspace;
use crate::machine::simd::{Aligned, WIDTH};
use crate::machine::threads::briefly;
use crate::weights::network::parameters::Parameters;

/// Panels of layer 2 that are gone through at a time: so few that they stay in the cache.
pub(super) const PACK: usize = 4;
/// Bytes of layer 2 up to which it is laid out once for all evaluations.
const MOST_KEPT: usize = 16 << 20;

/// A network without Fourier features.
pub(super) struct Whole {
    /// Layer 1 and the biases of the output; of layer 2 all rows if it is small, else they are [packed](Whole::panels) as they are
    /// needed.
    pub part: Part,
    pub heads: Heads,
    /// What evaluations work with; the next one finds it.
    pub workspaces: Mutex<Vec<Workspace>>,
}

/// What the first evaluation of a network lays out for all later ones. It is no part of what the network is.
#[derive(Default)]
pub(in crate::weights::network) struct Prepared(Mutex<Option<Arc<Whole>>>);

impl Prepared {
    pub(super) fn of(&self, network: &Parameters) -> Arc<Whole> {
        if let Some(whole) = briefly(&self.0).and_then(|kept| kept.clone()) {
            return whole;
        }
        // Made outside of the lock: while this thread waits for others, it may take up another evaluation of the same network.
        let whole = Arc::new(Whole::new(network));
        match briefly(&self.0) {
            Some(mut kept) => kept.get_or_insert(whole).clone(),
            None => whole,
        }
    }
}

impl Clone for Prepared {
    fn clone(&self) -> Prepared {
        Prepared::default()
    }
}

impl PartialEq for Prepared {
    fn eq(&self, _: &Prepared) -> bool {
        true
    }
}

impl std::fmt::Debug for Prepared {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Prepared")
    }
}

impl Whole {
    pub(super) fn new(network: &Parameters) -> Whole {
        let [layer1, layer2, layer3] = &network.layers;
        let dim = network.dim;
        let mut columns = Columns::default();
        columns.clear(layer1.outputs());
        columns.len = layer1.outputs();
        for (j, (row, b)) in layer1.weight.chunks_exact(dim).zip(&layer1.bias).enumerate() {
            for (k, w) in row.iter().enumerate() {
                columns.plane_mut(k)[j] = *w;
            }
            columns.plane_mut(3)[j] = *b;
            columns.plane_mut(4)[j] = f32::from_bits(j as u32);
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
        let mut whole = Whole { part, heads: Heads { groups, weights }, workspaces: Mutex::default() };
        if size_of_val(&layer2.weight[..]) <= MOST_KEPT {
            let mut packed = Rows::default();
            pack(network, 0, rows.div_ceil(WIDTH), &mut packed);
            whole.part.rows = packed;
        }
        whole
    }

    /// Rows of layer 2.
    pub(super) fn rows(&self) -> usize {
        self.heads.weights.len() / self.heads.groups
    }

    /// Rows of layer 2 from panel `first` on, [`PACK`] panels of them or what is left: laid out already, or now, in `scratch`.
    pub(super) fn panels<'a>(
        &'a self,
        network: &Parameters,
        first: usize,
        scratch: &'a mut Rows,
    ) -> Block<'a> {
        let count = PACK.min(self.rows().div_ceil(WIDTH) - first);
        if self.part.rows.panels() > 0 {
            return self.part.rows.block(first..first + count);
        }
        pack(network, first, count, scratch);
        scratch.all()
    }
}

/// Lays out `count` panels of layer 2 from panel `first` on.
fn pack(network: &Parameters, first: usize, count: usize, rows: &mut Rows) {
    let layer = &network.layers[1];
    let (columns, first) = (layer.inputs(), WIDTH * first);
    let last = (first + WIDTH * count).min(layer.outputs());
    rows.clear(columns, 0);
    rows.ids.extend(first as u32..last as u32);
    for bias in layer.bias[first..last].chunks(WIDTH) {
        let mut affine = [Aligned::ZERO; 4];
        affine[3].0[..bias.len()].copy_from_slice(bias);
        rows.affine.push(affine);
    }
    let weight = &layer.weight[first * columns..last * columns];
    rows.fill_panels(|panel, to| {
        let start = WIDTH * columns * panel;
        transpose(&weight[start..weight.len().min(start + WIDTH * columns)], columns, to);
    });
}

/// At most 16 rows of `weight`, column by column.
fn transpose(weight: &[f32], columns: usize, panel: &mut [Aligned]) {
    for (chunk, panel) in panel.chunks_mut(WIDTH).enumerate() {
        let mut tile = [Aligned::ZERO; WIDTH];
        for (tile, row) in tile.iter_mut().zip(weight.chunks_exact(columns)) {
            let row = &row[chunk * WIDTH..];
            match row.first_chunk() {
                Some(row) => tile.0 = *row,
                None => tile.0[..row.len()].copy_from_slice(row),
            }
        }
        for (j, column) in panel.iter_mut().enumerate() {
            for t in 0..WIDTH {
                column.0[t] = tile[t].0[j];
            }
        }
    }
}
