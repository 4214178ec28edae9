//! The walk over the points' tree.

use std::sync::Mutex;

use super::columns::{sort, Sorted};
use super::leaf::{self, Activations};
use super::node::Part;
use super::rows::Rows;
use super::whole::Whole;
use crate::error::Error;
use crate::logits::neural::{dense, network::Network};
use crate::parallel::{for_each_task, SharedRows};
use crate::progress::Progress;
use crate::simd::{Simd, WIDTH};
use crate::tree::{Node, PointTree, LEAF, LEAF_BLOCKS};

/// Nodes of this depth are made from the whole network.
const DEPTH: usize = 5;
/// Bytes of one such node; where it would be more, its halves are made instead.
const MOST_PART: usize = 8 << 20;
/// Bytes of all such nodes that exist at a time.
const MOST_PARTS: usize = 24 << 20;
/// Nodes that read a panel of layer 2 one after the other, while it is in the cache.
const GROUP: usize = 4;

/// The logits of the tree's points in their own order, row by row: n x m. The network has no Fourier features.
pub(crate) fn logits(
    network: &Network,
    tree: &PointTree,
    progress: &mut Progress<'_>,
) -> Result<Vec<f32>, Error> {
    let mut logits = vec![0.0; tree.len() * network.outputs()];
    if !tree.is_empty() {
        let walk = Walk {
            simd: Simd::detect(),
            network,
            whole: Whole::new(network),
            tree,
            logits: SharedRows::new(&mut logits, network.outputs()),
            workspaces: Mutex::default(),
        };
        walk.all(progress)?;
    }
    Ok(logits)
}

struct Walk<'a> {
    simd: Simd,
    network: &'a Network,
    whole: Whole,
    tree: &'a PointTree,
    logits: SharedRows<'a>,
    workspaces: Mutex<Vec<Workspace>>,
}

/// What one thread works with.
#[derive(Default)]
struct Workspace {
    /// One a level of the tree.
    levels: Vec<Level>,
    activations: Activations,
}

#[derive(Default)]
struct Level {
    part: Part,
    sorted: Sorted,
}

/// A node that is made from the whole network.
struct Top {
    node: Node,
    level: Level,
}

impl Walk<'_> {
    fn all(&self, progress: &mut Progress<'_>) -> Result<(), Error> {
        let (mut tops, mut dense) = (Vec::new(), Vec::new());
        self.find_tops(self.tree.root(), 0, &mut Level::default(), &mut tops, &mut dense);
        let total = (tops.len() + dense.len()) as f64;
        let mut done = 0;
        let mut rest = &tops[..];
        while !rest.is_empty() {
            let mut bytes = 0;
            let fits = rest.iter().take_while(|(_, more)| {
                bytes += more;
                bytes <= MOST_PARTS
            });
            let (batch, later) = rest.split_at(fits.count().max(1));
            let span = done as f64 / total..(done + batch.len()) as f64 / total;
            self.batch(batch, span, progress)?;
            (rest, done) = (later, done + batch.len());
        }
        for_each_task(dense.len(), done as f64 / total..1.0, progress, |task, _| self.dense(dense[task]))
    }

    /// The nodes to make from the whole network, with an estimate of their bytes; and the leaves over so large a box that a
    /// dense pass is better.
    fn find_tops(
        &self,
        node: Node,
        depth: usize,
        level: &mut Level,
        tops: &mut Vec<(Node, usize)>,
        dense: &mut Vec<Node>,
    ) {
        let halves = node.halves();
        if let (Some(halves), true) = (halves, depth < DEPTH) {
            return halves.into_iter().for_each(|half| self.find_tops(half, depth + 1, level, tops, dense));
        }
        let whole = &self.whole;
        sort(
            self.simd,
            &whole.part.columns,
            self.tree.region(node),
            &mut level.part.columns,
            &mut level.sorted,
        );
        let columns = level.part.columns.len;
        // As many rows are usually open as columns.
        let rows = (2 * columns + WIDTH).min(whole.rows()) + WIDTH * whole.heads.groups;
        let bytes = columns * rows * size_of::<f32>();
        match halves {
            _ if bytes <= MOST_PART => tops.push((node, bytes)),
            Some(halves) => {
                halves.into_iter().for_each(|half| self.find_tops(half, depth + 1, level, tops, dense))
            }
            None => dense.push(node),
        }
    }

    fn batch(
        &self,
        nodes: &[(Node, usize)],
        span: std::ops::Range<f64>,
        progress: &mut Progress<'_>,
    ) -> Result<(), Error> {
        let whole = &self.whole;
        let mut tops: Vec<Top> =
            nodes.iter().map(|(node, _)| Top { node: *node, level: Level::default() }).collect();
        let groups: Vec<_> = tops.chunks_mut(GROUP).map(Mutex::new).collect();
        let start = span.start..span.start;
        for_each_task(groups.len(), start.clone(), progress, |task, _| {
            for top in groups[task].lock().expect("no task panics").iter_mut() {
                let Level { part, sorted } = &mut top.level;
                part.begin(self.simd, &whole.part, self.tree.region(top.node), sorted);
            }
        })?;
        let mut slab = Rows::default();
        let mut first = 0;
        while first < whole.rows() {
            whole.pack(self.network, first, &mut slab);
            first += slab.len;
            for_each_task(groups.len(), start.clone(), progress, |task, stop| {
                let mut group = groups[task].lock().expect("no task panics");
                let panels = slab.affine.len();
                for panel in (0..panels).step_by(2).take_while(|_| !stop()) {
                    for top in group.iter_mut() {
                        let region = self.tree.region(top.node);
                        let Level { part, sorted } = &mut top.level;
                        let pair = panel..(panel + 2).min(panels);
                        part.absorb(self.simd, &whole.heads, &slab, pair, region, sorted);
                    }
                }
            })?;
        }
        drop(groups);
        for_each_task(tops.len(), span, progress, |task, stop| {
            let pooled = self.workspaces.lock().expect("no task panics").pop();
            let mut workspace = pooled.unwrap_or_default();
            let Workspace { levels, activations } = &mut workspace;
            levels.resize_with(usize::BITS as usize, Level::default);
            self.descend(tops[task].node, &tops[task].level.part, levels, activations, stop);
            self.workspaces.lock().expect("no task panics").push(workspace);
        })
    }

    fn descend(
        &self,
        node: Node,
        part: &Part,
        levels: &mut [Level],
        activations: &mut Activations,
        stop: &dyn Fn() -> bool,
    ) {
        let Some(halves) = node.halves() else {
            return self.leaf(node, part, activations);
        };
        if stop() {
            return;
        }
        let (Level { part: child, sorted }, levels) =
            levels.split_first_mut().expect("a tree has fewer levels than a number has bits");
        for half in halves {
            let region = self.tree.region(half);
            child.begin(self.simd, part, region, sorted);
            let panels = 0..part.rows.affine.len();
            child.absorb(self.simd, &self.whole.heads, &part.rows, panels, region, sorted);
            self.descend(half, child, levels, activations, stop);
        }
    }

    fn leaf(&self, node: Node, part: &Part, activations: &mut Activations) {
        let first = node.first * LEAF_BLOCKS;
        let blocks = &self.tree.blocks()[first..];
        let order = &self.tree.order()[first * WIDTH..];
        for (x, order) in blocks.iter().zip(order.chunks(WIDTH)).take(LEAF_BLOCKS) {
            leaf::evaluate(self.simd, part, &self.whole.heads, x, activations);
            for (lane, &index) in order.iter().enumerate() {
                // SAFETY: the tree holds each index once, and each leaf belongs to one task.
                let row = unsafe { self.logits.row(index as usize) };
                for (logit, output) in row.iter_mut().zip(&activations.outputs) {
                    *logit = output.0[lane];
                }
            }
        }
    }

    fn dense(&self, node: Node) {
        let first = node.first * LEAF_BLOCKS * WIDTH;
        // SAFETY: the tree holds each index once, and each leaf belongs to one task.
        unsafe { dense::evaluate_places(self.network, self.tree, first, LEAF, &self.logits) }
    }
}
