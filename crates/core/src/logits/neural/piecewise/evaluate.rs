//! The walk over the points' tree.

use super::columns::sort;
use super::leaf::{self, Activations};
use super::node::{Level, Part};
use super::rows::Rows;
use super::whole::{Prepared, Whole, PACK};
use crate::error::Error;
use crate::logits::neural::{dense, network::Network};
use crate::parallel::{for_each_block, for_each_task, threads, SharedRows};
use crate::progress::Progress;
use crate::simd::{Aligned, Simd, WIDTH};
use crate::tree::{Node, Order, PointTree, LEAF, LEAF_BLOCKS};

/// Nodes of this depth are made from the whole network.
const DEPTH: usize = 5;
/// Levels of the tree from a node to those that are made from it; at the bottom there may be one more. A node in between would cost
/// more than what it saves those below.
const STEP: u32 = 3;
/// Bytes of one such node at most; where it might be more, its halves are made instead.
const MOST_PART: usize = 8 << 20;
/// Bytes of those that one task makes.
const MOST_GROUP: u64 = 8 << 20;
/// Nodes that read rows of layer 2 one after the other, while they are in the cache.
const GROUP: usize = 8;
/// Rows of logits, which may be anywhere in memory, that are asked for at a time while a leaf is made. More would be waited for.
const AHEAD: usize = LEAF / 4;

/// Writes the logits of the tree's points row by row, n x m, in their own order or in the tree's. The network has no Fourier
/// features.
pub(crate) fn write_logits(
    simd: Simd,
    network: &Network,
    tree: &PointTree,
    order: Order,
    logits: &mut [f32],
    progress: &mut Progress<'_>,
) -> Result<(), Error> {
    if tree.is_empty() {
        return Ok(());
    }
    let walk = Walk {
        simd,
        network,
        whole: Prepared::of(network),
        tree,
        order,
        logits: SharedRows::new(logits, network.outputs()),
    };
    walk.all(progress)
}

struct Walk<'a> {
    simd: Simd,
    network: &'a Network,
    whole: &'a Whole,
    tree: &'a PointTree,
    order: Order,
    logits: SharedRows<'a>,
}

/// What one task works with.
#[derive(Default)]
pub(super) struct Workspace {
    /// Nodes that are made from the whole network, and rows of it.
    tops: Vec<Level>,
    rows: Rows,
    /// One a level of the tree.
    levels: Vec<Level>,
    activations: Activations,
}

impl Walk<'_> {
    fn all(&self, progress: &mut Progress<'_>) -> Result<(), Error> {
        let (mut tops, mut dense) = (Vec::new(), Vec::new());
        self.find_tops(self.tree.root(), 0, &mut Level::default(), &mut tops, &mut dense);
        let groups = groups(&tops);
        let tasks = groups.len() + dense.len();
        for_each_task(tasks, 0.0..1.0, progress, |task, stop| match groups.get(task) {
            Some(group) => self.group(group, stop),
            None => self.dense(dense[task - groups.len()]),
        })
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
        let whole = self.whole;
        sort(
            self.simd,
            &whole.part.columns,
            self.tree.region(node),
            &mut level.part.columns,
            &mut level.sorted,
        );
        let columns = level.part.columns.len;
        // In the worst case all rows stay open.
        let rows = whole.rows() + WIDTH * whole.heads.groups;
        let bytes = columns * rows * size_of::<f32>();
        match halves {
            _ if bytes <= MOST_PART => tops.push((node, bytes)),
            Some(halves) => {
                halves.into_iter().for_each(|half| self.find_tops(half, depth + 1, level, tops, dense))
            }
            None => dense.push(node),
        }
    }

    /// Makes nodes from the whole network, panel after panel of it, and evaluates them.
    fn group(&self, nodes: &[(Node, usize)], stop: &(dyn Fn() -> bool + Sync)) {
        let mut workspace = self.workspace();
        let Workspace { tops, rows, .. } = &mut workspace;
        tops.resize_with(nodes.len().max(tops.len()), Level::default);
        let region = |at: usize| self.tree.region(nodes[at].0);
        let panels = self.whole.rows().div_ceil(WIDTH);
        for (at, level) in tops[..nodes.len()].iter_mut().enumerate() {
            level.begin(self.simd, &self.whole.part, region(at), panels);
        }
        for first in (0..panels).step_by(PACK) {
            if stop() {
                return;
            }
            let rows = self.whole.panels(self.network, first, rows);
            for (at, level) in tops[..nodes.len()].iter_mut().enumerate() {
                level.absorb(self.simd, &self.whole.heads, rows, region(at));
            }
        }
        let mut tasks = Vec::new();
        for ((node, _), Level { part, .. }) in nodes.iter().zip(&tops[..]) {
            below(*node, |child| tasks.push((child, part)));
        }
        for_each_block(&mut tasks, 1, |_, task| {
            let mut workspace = self.workspace();
            let Workspace { levels, activations, .. } = &mut workspace;
            levels.resize_with(usize::BITS as usize, Level::default);
            let (node, part) = task[0];
            self.descend(node, part, levels, activations, stop);
            self.keep(workspace);
        });
        self.keep(workspace);
    }

    fn workspace(&self) -> Workspace {
        self.whole.workspaces.lock().expect("no task panics").pop().unwrap_or_default()
    }

    fn keep(&self, workspace: Workspace) {
        self.whole.workspaces.lock().expect("no task panics").push(workspace);
    }

    /// Makes a node from the one above it, `parent`, and evaluates its points.
    fn descend(
        &self,
        node: Node,
        parent: &Part,
        levels: &mut [Level],
        activations: &mut Activations,
        stop: &(dyn Fn() -> bool + Sync),
    ) {
        let (level, levels) =
            levels.split_first_mut().expect("a tree has fewer levels than a number has bits");
        if node.count == 1 {
            return self.leaf(node, parent, level, activations);
        }
        if stop() {
            return;
        }
        let region = self.tree.region(node);
        level.begin(self.simd, parent, region, parent.rows.panels());
        level.absorb(self.simd, &self.whole.heads, parent.rows.all(), region);
        below(node, |child| self.descend(child, &level.part, levels, activations, stop));
    }

    fn leaf(&self, node: Node, parent: &Part, level: &mut Level, activations: &mut Activations) {
        let first = node.first * LEAF;
        let rows = self.order.rows(self.tree, first..(first + LEAF).min(self.tree.len()));
        let mut ahead = rows.clone();
        let mut prefetch = || ahead.by_ref().take(AHEAD).for_each(|row| self.logits.prefetch(row));
        let (region, parent_rows) = (self.tree.region(node), parent.rows.all());
        prefetch();
        level.begin(self.simd, parent, region, 0);
        prefetch();
        level.resolve(self.simd, &self.whole.heads, parent_rows, region);
        prefetch();
        prefetch();
        // SAFETY: no two places of the tree have the same row, and each leaf belongs to one task.
        let mut rows = rows.map(|row| unsafe { self.logits.row(row) });
        let mut logits: [&mut [f32]; LEAF] = std::array::from_fn(|_| rows.next().unwrap_or_default());
        let count = LEAF.min(self.tree.len() - first);
        let mut x = [[Aligned::ZERO; 3]; LEAF_BLOCKS];
        let x = &mut x[..count.div_ceil(WIDTH)];
        for (block, x) in x.iter_mut().enumerate() {
            *x = self.tree.block(first + WIDTH * block);
        }
        leaf::evaluate(
            self.simd,
            level,
            parent_rows,
            &self.whole.heads,
            x,
            activations,
            &mut logits[..count],
        );
    }

    fn dense(&self, node: Node) {
        let first = node.first * LEAF;
        let places = first..(first + LEAF).min(self.tree.len());
        // SAFETY: no two places of the tree have the same row, and each leaf belongs to one task.
        unsafe { dense::evaluate_places(self.network, self.tree, self.order, places, &self.logits) }
    }
}

/// Nodes in groups of about as many bytes each: so many groups that none is too large, and that each thread has as many to do.
fn groups(nodes: &[(Node, usize)]) -> Vec<&[(Node, usize)]> {
    let all: u64 = nodes.iter().map(|(_, bytes)| *bytes as u64).sum();
    let count = all.div_ceil(MOST_GROUP).max(nodes.len().div_ceil(GROUP) as u64).max(1);
    let share = all.div_ceil(count.next_multiple_of(threads() as u64)).max(1);
    let (mut groups, mut first, mut before) = (Vec::new(), 0, 0);
    for (at, (_, bytes)) in nodes.iter().enumerate() {
        let now = before + *bytes as u64;
        if now / share > before / share || at + 1 == nodes.len() {
            groups.push(&nodes[first..=at]);
            first = at + 1;
        }
        before = now;
    }
    groups
}

/// The nodes that are made from `node`; a leaf is its own.
fn below(node: Node, mut each: impl FnMut(Node)) {
    fn walk(node: Node, levels: u32, each: &mut dyn FnMut(Node)) {
        match node.halves() {
            Some(halves) if levels > 0 => halves.into_iter().for_each(|half| walk(half, levels - 1, each)),
            _ => each(node),
        }
    }
    let levels = node.count.next_power_of_two().ilog2();
    walk(node, if levels <= STEP + 1 { levels } else { STEP }, &mut each);
}
