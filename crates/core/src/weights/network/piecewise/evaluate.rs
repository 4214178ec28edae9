//! The walk over the points' tree.

use super::bounds::Domain;
use super::columns::{sort, Columns};
use super::layout::{Prepared, Whole, PACK};
use super::leaf::{self, Neurons};
use super::node::Level;
use super::part::Part;
use super::rows::add_columns;
use super::workspace::Workspace;
use crate::error::Error;
use crate::geometry::{Node, Order, PointTree, LEAF, LEAF_BLOCKS};
use crate::machine::parallel::{for_each_block, for_each_task, SharedRows};
use crate::machine::progress::Progress;
use crate::machine::simd::{Aligned, Simd, WIDTH};
use crate::machine::threads::{briefly, threads};
use crate::weights::network::{dense, parameters::Parameters};

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
    network: &Parameters,
    prepared: &Prepared,
    tree: &PointTree,
    order: Order,
    logits: &mut [f32],
    progress: &mut Progress<'_>,
) -> Result<(), Error> {
    if tree.is_empty() {
        return Ok(());
    }
    let whole = prepared.of(network);
    let logits = SharedRows::new(logits, network.outputs());
    Walk { simd, network, whole: &whole, tree, order, logits, slopes: false }.all(progress)
}

/// Writes the logits of the tree's points, and after those of each point their derivatives by its normalised coordinates: n x (1 + d) x m.
pub(crate) fn write_slopes(
    network: &Parameters,
    prepared: &Prepared,
    tree: &PointTree,
    slopes: &mut [f32],
    progress: &mut Progress<'_>,
) -> Result<(), Error> {
    let (whole, simd) = (prepared.of(network), Simd::detect());
    let logits = SharedRows::new(slopes, network.outputs() * (1 + network.dim));
    Walk { simd, network, whole: &whole, tree, order: Order::Given, logits, slopes: true }.all(progress)
}

struct Walk<'a> {
    simd: Simd,
    network: &'a Parameters,
    whole: &'a Whole,
    tree: &'a PointTree,
    order: Order,
    logits: SharedRows<'a>,
    /// Whether their derivatives come after the logits of each point.
    slopes: bool,
}

/// A node above those that are made from the whole network. It copies no rows: columns that are on in it are added to the rows'
/// affine parts once for all nodes below.
struct Stem {
    above: Option<usize>,
    /// Without rows.
    part: Part,
    /// Columns that are on here, and not above.
    on: Columns,
}

/// A node that is made from the whole network, and what is above it; with an estimate of its bytes.
struct Top {
    node: Node,
    above: Option<usize>,
    bytes: usize,
}

/// Where to begin.
#[derive(Default)]
struct Found {
    stems: Vec<Stem>,
    tops: Vec<Top>,
    /// Leaves over so large a box that a dense pass is better.
    dense: Vec<Node>,
    level: Level,
}

impl Walk<'_> {
    fn all(&self, progress: &mut Progress<'_>) -> Result<(), Error> {
        let mut found = Found::default();
        self.find(self.tree.root(), 0, None, &mut found);
        let Found { stems, tops, dense, .. } = found;
        let groups = groups(&tops);
        let tasks = groups.len() + dense.len();
        for_each_task(tasks, 0.0..1.0, progress, |task, stop| match groups.get(task) {
            Some(group) => self.group(group, &stems, stop),
            None => self.dense(dense[task - groups.len()]),
        })
    }

    /// Finds what is at the top of the tree.
    fn find(&self, node: Node, depth: usize, above: Option<usize>, found: &mut Found) {
        let Found { stems, tops, dense, level } = found;
        let whole = self.whole;
        let parent = above.map_or(&whole.part, |stem| &stems[stem].part);
        let (columns, sorted) = (&mut level.part.columns, &mut level.sorted);
        let domain = Domain { region: self.tree.region(node), points: &[] };
        sort(self.simd, &parent.columns, domain, columns, sorted);
        // In the worst case all rows stay open.
        let rows = whole.rows() + WIDTH * whole.heads.groups;
        let bytes = columns.len * rows * size_of::<f32>();
        match node.halves() {
            Some(halves) if depth < DEPTH || bytes > MOST_PART => {
                let mut below = above;
                // Further down they would be many.
                if depth < DEPTH {
                    let part = Part {
                        columns: columns.clone(),
                        output: whole.part.output.clone(),
                        ..Part::default()
                    };
                    below = Some(stems.len());
                    stems.push(Stem { above, part, on: sorted.on.clone() });
                }
                halves.into_iter().for_each(|half| self.find(half, depth + 1, below, found));
            }
            _ if bytes <= MOST_PART => tops.push(Top { node, above, bytes }),
            _ => dense.push(node),
        }
    }

    /// Makes nodes from the whole network, panel after panel of it, and evaluates them.
    fn group(&self, nodes: &[Top], stems: &[Stem], stop: &(dyn Fn() -> bool + Sync)) {
        let mut workspace = self.workspace();
        let Workspace { tops, rows, affines, .. } = &mut workspace;
        tops.resize_with(nodes.len().max(tops.len()), Level::default);
        affines.resize_with(stems.len().max(affines.len()), Vec::new);
        let all_rows = self.whole.rows();
        let panels = all_rows.div_ceil(WIDTH);
        let mut needed = vec![false; stems.len()];
        for (Top { node, above, .. }, level) in nodes.iter().zip(&mut tops[..]) {
            let parent = above.map_or(&self.whole.part, |stem| &stems[stem].part);
            level.begin(self.simd, parent, self.domain(*node, all_rows), panels);
            let mut stem = *above;
            while let Some(at) = stem {
                needed[at] = true;
                stem = stems[at].above;
            }
        }
        for first in (0..panels).step_by(PACK) {
            if stop() {
                return;
            }
            let rows = self.whole.panels(self.network, first, rows);
            for (at, stem) in stems.iter().enumerate().filter(|(at, _)| needed[*at]) {
                let (before, here) = affines.split_at_mut(at);
                let rows = stem.above.map_or(rows, |above| rows.with(&before[above]));
                add_columns(self.simd, rows, &stem.on, &mut here[0]);
            }
            for (Top { node, above, .. }, level) in nodes.iter().zip(&mut tops[..]) {
                let rows = above.map_or(rows, |above| rows.with(&affines[above]));
                level.absorb(self.simd, &self.whole.heads, rows, self.domain(*node, all_rows));
            }
        }
        let mut tasks = Vec::new();
        for (Top { node, .. }, Level { part, .. }) in nodes.iter().zip(&tops[..]) {
            below(*node, |child| tasks.push((child, part)));
        }
        for_each_block(&mut tasks, 1, |_, task| {
            let mut workspace = self.workspace();
            let Workspace { levels, neurons, .. } = &mut workspace;
            levels.resize_with(usize::BITS as usize, Level::default);
            let (node, part) = task[0];
            self.descend(node, part, levels, neurons, stop);
            self.keep(workspace);
        });
        self.keep(workspace);
    }

    /// Where the points of a node are, which is made from so many rows: the more, the sooner it is worth looking at each point.
    fn domain(&self, node: Node, rows: usize) -> Domain<'_> {
        let points = self.tree.points(node);
        let worth = node.count == 1 || points.len() <= rows / 2;
        Domain { region: self.tree.region(node), points: if worth { points } else { &[] } }
    }

    fn workspace(&self) -> Workspace {
        briefly(&self.whole.workspaces).and_then(|mut kept| kept.pop()).unwrap_or_default()
    }

    fn keep(&self, workspace: Workspace) {
        if let Some(mut kept) = briefly(&self.whole.workspaces) {
            kept.push(workspace);
        }
    }

    /// Makes a node from the one above it, `parent`, and evaluates its points.
    fn descend(
        &self,
        node: Node,
        parent: &Part,
        levels: &mut [Level],
        neurons: &mut Neurons,
        stop: &(dyn Fn() -> bool + Sync),
    ) {
        let (level, levels) =
            levels.split_first_mut().expect("a tree has fewer levels than a number has bits");
        if node.count == 1 {
            return self.leaf(node, parent, level, neurons);
        }
        if stop() {
            return;
        }
        let domain = self.domain(node, parent.rows.ids.len());
        level.begin(self.simd, parent, domain, parent.rows.panels());
        level.absorb(self.simd, &self.whole.heads, parent.rows.all(), domain);
        below(node, |child| self.descend(child, &level.part, levels, neurons, stop));
    }

    fn leaf(&self, node: Node, parent: &Part, level: &mut Level, neurons: &mut Neurons) {
        let first = node.first * LEAF;
        let rows = self.order.rows(self.tree, first..(first + LEAF).min(self.tree.len()));
        let mut ahead = rows.clone();
        let mut prefetch = || ahead.by_ref().take(AHEAD).for_each(|row| self.logits.prefetch(row));
        let domain = self.domain(node, parent.rows.ids.len());
        prefetch();
        level.begin(self.simd, parent, domain, 0);
        prefetch();
        level.resolve(self.simd, &self.whole.heads, parent.rows.all(), domain);
        prefetch();
        prefetch();
        // SAFETY: no two places of the tree have the same row, and each leaf belongs to one task.
        let mut rows = rows.map(|row| unsafe { self.logits.row(row) });
        let mut logits: [&mut [f32]; LEAF] = std::array::from_fn(|_| rows.next().unwrap_or_default());
        let mut slopes: [&mut [f32]; LEAF] = std::array::from_fn(|_| Default::default());
        if self.slopes {
            for (logits, slopes) in logits.iter_mut().zip(&mut slopes) {
                let whole = std::mem::take(logits);
                (*logits, *slopes) = whole.split_at_mut(self.network.outputs().min(whole.len()));
            }
        }
        let count = LEAF.min(self.tree.len() - first);
        let mut x = [[Aligned::ZERO; 3]; LEAF_BLOCKS];
        let x = &mut x[..count.div_ceil(WIDTH)];
        for (block, x) in x.iter_mut().enumerate() {
            *x = self.tree.block(first + WIDTH * block);
        }
        leaf::evaluate(self.simd, level, &self.whole.heads, x, neurons, &mut logits[..count]);
        if self.slopes {
            let mut change = Neurons::default();
            for axis in 0..self.network.dim {
                let mut along: [&mut [f32]; LEAF] = std::array::from_fn(|_| Default::default());
                for (slopes, along) in slopes.iter_mut().zip(&mut along).take(count) {
                    (*along, *slopes) = std::mem::take(slopes).split_at_mut(self.network.outputs());
                }
                let heads = &self.whole.heads;
                leaf::differentiate(self.simd, level, heads, axis, neurons, &mut change, &mut along[..count]);
            }
        }
    }

    fn dense(&self, node: Node) {
        let first = node.first * LEAF;
        let places = first..(first + LEAF).min(self.tree.len());
        // SAFETY: no two places of the tree have the same row, and each leaf belongs to one task.
        unsafe {
            match self.slopes {
                true => dense::differentiate_places(self.network, self.tree, places, &self.logits),
                false => dense::evaluate_places(self.network, self.tree, self.order, places, &self.logits),
            }
        }
    }
}

/// Nodes in groups of about as many bytes each: so many groups that none is too large, and that each thread has as many to do.
fn groups(nodes: &[Top]) -> Vec<&[Top]> {
    let all: u64 = nodes.iter().map(|top| top.bytes as u64).sum();
    let count = all.div_ceil(MOST_GROUP).max(nodes.len().div_ceil(GROUP) as u64).max(1);
    let share = all.div_ceil(count.next_multiple_of(threads() as u64)).max(1);
    let (mut groups, mut first, mut before) = (Vec::new(), 0, 0);
    for (at, Top { bytes, .. }) in nodes.iter().enumerate() {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Frame;

    #[test]
    fn groups_have_every_node_once_in_order_and_about_their_share_each() {
        let tree = PointTree::new(&[0.5; 3], 3, Frame::IDENTITY, &mut |_| true).unwrap();
        let node = tree.root();
        let sizes: [fn(usize) -> usize; 4] =
            [|_| 1000, |i| 1 + 999 * (i % 7), |i| if i == 3 { 8 << 20 } else { 10 }, |_| 4 << 20];
        for count in [0, 1, 2, 7, 32, 100] {
            for size in sizes {
                let tops: Vec<Top> = (0..count).map(|i| Top { node, above: None, bytes: size(i) }).collect();
                let groups = groups(&tops);
                let together: Vec<*const Top> =
                    groups.iter().flat_map(|group| group.iter()).map(std::ptr::from_ref).collect();
                assert_eq!(together, tops.iter().map(std::ptr::from_ref).collect::<Vec<_>>());
                let bytes = |tops: &[Top]| tops.iter().map(|top| top.bytes as u64).sum::<u64>();
                let largest = tops.iter().map(|top| top.bytes as u64).max().unwrap_or(0);
                for group in &groups {
                    assert!(!group.is_empty() && bytes(group) <= MOST_GROUP + largest, "{}", bytes(group));
                }
                assert!(count < 2 * GROUP || groups.len() >= 2, "{} of {count}", groups.len());
            }
        }
    }
}
