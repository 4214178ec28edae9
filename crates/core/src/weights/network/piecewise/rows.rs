//! Layer 2 over a box: its rows' affine parts, and bounds on what they can be.

use std::ops::Range;

use super::bounds::{bounds, bounds_at, classify, Domain, MANY};
use super::columns::{Columns, Sorted};
use super::lane_list::LaneList;
use crate::machine::memory::filled;
use crate::machine::simd::{multiversion, Aligned, Lanes, WIDTH};

/// Rows of layer 2, in panels of 16.
#[derive(Default)]
pub(super) struct Rows {
    /// Columns of the matrix.
    columns: usize,
    /// For each row which one of the network's it is.
    pub ids: Vec<u32>,
    /// The affine part of each panel's rows.
    pub affine: Vec<[Aligned; 4]>,
    /// Panel by panel, in it column by column: the weights of that column in the panel's rows. It only grows; lanes beyond the
    /// last row hold anything.
    matrix: Vec<Aligned>,
}

impl Rows {
    /// No rows, of so many columns, with room for so many panels.
    pub(super) fn clear(&mut self, columns: usize, panels: usize) {
        self.columns = columns;
        self.ids.clear();
        self.affine.clear();
        // Room, which costs nothing until it is used, so that nothing is ever moved; more than is needed, so that the next node
        // finds it too.
        let room = (columns * panels).next_power_of_two();
        if self.matrix.capacity() < room {
            self.matrix = Vec::with_capacity(room);
        }
    }

    /// Has the weights of each panel, whose affine parts are there, written by `write(panel, weights)`.
    pub(super) fn fill_panels(&mut self, write: impl Fn(usize, &mut [Aligned]) + Sync + Send) {
        let (memory, columns) = (std::mem::take(&mut self.matrix), self.columns);
        self.matrix = filled(memory, columns * self.panels(), Aligned::ZERO, columns, write);
    }

    pub(super) fn panels(&self) -> usize {
        self.affine.len()
    }

    /// Appends a panel, whose weights are to be written.
    pub(super) fn push(&mut self, affine: [Aligned; 4]) {
        self.affine.push(affine);
        let needed = self.panels() * self.columns;
        if self.matrix.len() < needed {
            self.matrix.resize(needed, Aligned::ZERO);
        }
    }

    /// The weights of the last panel.
    #[inline(always)]
    pub(super) fn last_panel(&mut self) -> &mut [Aligned] {
        let end = self.panels() * self.columns;
        &mut self.matrix[end - self.columns..end]
    }

    /// Some panels.
    pub(super) fn block(&self, panels: Range<usize>) -> Block<'_> {
        Block {
            columns: self.columns,
            ids: &self.ids[WIDTH * panels.start..self.ids.len().min(WIDTH * panels.end)],
            affine: &self.affine[panels.clone()],
            matrix: &self.matrix[panels.start * self.columns..panels.end * self.columns],
        }
    }

    /// All panels.
    pub(super) fn all(&self) -> Block<'_> {
        self.block(0..self.panels())
    }
}

/// Some panels of [`Rows`].
#[derive(Clone, Copy)]
pub(super) struct Block<'a> {
    pub columns: usize,
    ids: &'a [u32],
    affine: &'a [[Aligned; 4]],
    matrix: &'a [Aligned],
}

impl<'a> Block<'a> {
    /// The same rows with other affine parts.
    pub(super) fn with<'b>(self, affine: &'b [[Aligned; 4]]) -> Block<'b>
    where
        'a: 'b,
    {
        Block { affine, ..self }
    }

    /// The weights of one panel.
    #[inline(always)]
    pub(super) fn panel(&self, panel: usize) -> &'a [Aligned] {
        &self.matrix[panel * self.columns..][..self.columns]
    }
}

/// One row of a [`Block`].
#[derive(Clone, Copy)]
pub(super) struct Row {
    pub panel: u32,
    pub lane: u32,
    /// Which one of the network's it is.
    pub id: u32,
}

/// What the rows of a block are in a child's box.
#[derive(Default)]
pub(super) struct Bounded {
    /// The affine parts of all panels, with the columns that are on.
    pub affine: Vec<[Aligned; 4]>,
    /// Which rows are on, and which open; the others are off.
    pub on: Vec<Row>,
    pub open: Vec<Row>,
    /// Panel by panel, the weights of the open columns, side by side: what is done with them next then finds them in the cache.
    /// It only grows.
    weights: Vec<Aligned>,
    /// Columns of it, with those that fill the last few, where anything may be.
    columns: usize,
    /// Of each open row an affine map, how far the row may be from it, and the bits of its place in the block.
    relaxed: LaneList<6>,
    /// The bits of the places of the rows that are on.
    places: LaneList<1>,
}

/// Columns of a [`Bounded`] are a multiple of this.
pub(super) const COLUMNS: usize = 16;

impl Bounded {
    /// The weights of one panel.
    #[inline(always)]
    pub(super) fn panel(&self, panel: usize) -> &[Aligned] {
        &self.weights[panel * self.columns..][..self.columns]
    }
}

multiversion! {
    /// The affine parts of the block's rows with columns that are on.
    pub(super) fn add_columns(block: Block<'_>, on: &Columns, affine: &mut Vec<[Aligned; 4]>) = add_columns_body
}

#[inline(always)]
fn add_columns_body<L: Lanes>(block: Block<'_>, on: &Columns, affine: &mut Vec<[Aligned; 4]>) {
    affine.clear();
    let panels = block.affine.len();
    while affine.len() < panels {
        match panels - affine.len() {
            2.. => add_to_panels::<L, 2>(block, on, affine),
            _ => add_to_panels::<L, 1>(block, on, affine),
        }
    }
}

#[inline(always)]
fn add_to_panels<L: Lanes, const P: usize>(block: Block<'_>, on: &Columns, affine: &mut Vec<[Aligned; 4]>) {
    let (matrix, mut maps) = panels::<L, P>(block, affine.len());
    add_on(&matrix, on, &mut maps);
    for p in 0..P {
        affine.push(stores(maps[p]));
    }
}

/// The weights and the affine parts of the `P` panels from `first` on.
#[inline(always)]
fn panels<'a, L: Lanes, const P: usize>(block: Block<'a>, first: usize) -> ([&'a [Aligned]; P], [[L; 4]; P]) {
    let mut matrix = [block.panel(first); P];
    let mut maps = [[L::splat(0.0); 4]; P];
    for p in 0..P {
        matrix[p] = block.panel(first + p);
        maps[p] = loads(&block.affine[first + p]);
    }
    (matrix, maps)
}

/// Adds columns that are on to affine parts of `P` panels.
#[inline(always)]
fn add_on<L: Lanes, const P: usize>(matrix: &[&[Aligned]; P], on: &Columns, maps: &mut [[L; 4]; P]) {
    let [w0, w1, w2, bias, columns] = [on.plane(0), on.plane(1), on.plane(2), on.plane(3), on.plane(4)];
    for t in 0..columns.len() {
        let map = splats::<L>(&[w0[t], w1[t], w2[t], bias[t]]);
        for p in 0..P {
            let weights = L::load(&matrix[p][columns[t].to_bits() as usize].0);
            for k in 0..4 {
                maps[p][k] = weights.mul_add(map[k], maps[p][k]);
            }
        }
    }
}

multiversion! {
    /// Folds the columns that are on into the affine parts of the block's rows, and bounds the rows over the box.
    pub(super) fn bound(
        block: Block<'_>,
        sorted: &Sorted,
        domain: Domain<'_>,
        bounded: &mut Bounded,
    ) = bound_body
}

#[inline(always)]
fn bound_body<L: Lanes>(block: Block<'_>, sorted: &Sorted, domain: Domain<'_>, bounded: &mut Bounded) {
    bounded.affine.clear();
    bounded.on.clear();
    bounded.open.clear();
    bounded.relaxed.clear(WIDTH * block.affine.len());
    bounded.places.clear(WIDTH * block.affine.len());
    bounded.columns = sorted.open.len.next_multiple_of(COLUMNS);
    let needed = bounded.columns * block.affine.len();
    bounded.weights.resize(needed.max(bounded.weights.len()), Aligned::ZERO);
    let (mut p, panels) = (0, block.affine.len());
    // Several panels at a time, so that there are more sums than an addition takes cycles: as many as there are registers for.
    while p < panels {
        p += match panels - p {
            3 | 5.. if L::REGISTERS >= 32 => bound_panels::<L, 3>(block, p, sorted, domain, bounded),
            1 => bound_panels::<L, 1>(block, p, sorted, domain, bounded),
            _ => bound_panels::<L, 2>(block, p, sorted, domain, bounded),
        };
    }
    if !domain.points.is_empty() && sorted.open.len >= MANY {
        bound_at::<L>(domain, bounded);
    }
    let Bounded { on, open, relaxed, places, .. } = bounded;
    for (rows, places) in [(on, places.plane(0)), (open, relaxed.plane(5))] {
        rows.extend(places.iter().map(|domain| {
            let domain = domain.to_bits();
            Row { panel: domain / WIDTH as u32, lane: domain % WIDTH as u32, id: block.ids[domain as usize] }
        }));
    }
}

/// Of the rows that the box leaves open, those that the points leave open stay so.
#[inline(always)]
fn bound_at<L: Lanes>(here: Domain<'_>, bounded: &mut Bounded) {
    let Bounded { relaxed, places, .. } = bounded;
    let left = std::mem::take(&mut relaxed.len);
    for first in (0..left).step_by(WIDTH) {
        let row = relaxed.load::<L>(first);
        let [a, b, c, d, spread, domain] = row;
        let (lower, upper) = bounds_at([a, b, c, d], spread, here);
        let [on, open] = classify(lower, upper);
        let rows = u32::MAX >> (32 - WIDTH.min(left - first));
        places.append(on & rows, [domain]);
        // What is written is not beyond what was loaded.
        relaxed.append(open & rows, row);
    }
}

/// The panels from `first` on, `P` of them, which it returns.
#[inline(always)]
fn bound_panels<L: Lanes, const P: usize>(
    block: Block<'_>,
    first: usize,
    sorted: &Sorted,
    domain: Domain<'_>,
    bounded: &mut Bounded,
) -> usize {
    let (matrix, mut maps) = panels::<L, P>(block, first);
    add_on(&matrix, &sorted.on, &mut maps);
    for p in 0..P {
        bounded.affine.push(stores(maps[p]));
    }
    let mut spreads = [L::splat(0.0); P];
    let columns = bounded.columns;
    let kept = &mut bounded.weights[columns * first..][..columns * P];
    let open = &sorted.open;
    let [w0, w1, w2, bias] = [open.plane(0), open.plane(1), open.plane(2), open.plane(3)];
    let [spread, numbers] = [open.plane(4), open.plane(5)];
    for t in 0..numbers.len() {
        let (map, spread) = (splats::<L>(&[w0[t], w1[t], w2[t], bias[t]]), L::splat(spread[t]));
        let column = numbers[t].to_bits() as usize;
        for p in 0..P {
            let weights = L::load(&matrix[p][column].0);
            for k in 0..4 {
                maps[p][k] = weights.mul_add(map[k], maps[p][k]);
            }
            spreads[p] = weights.abs().mul_add(spread, spreads[p]);
            kept[columns * p + t] = Aligned(weights.store());
        }
    }
    for p in 0..P {
        let (lower, upper) = bounds(maps[p], spreads[p], domain.region);
        let [on, open] = classify(lower, upper);
        // The last panel may have lanes without rows.
        let before = WIDTH * (first + p);
        let rows = u32::MAX >> (32 - WIDTH.min(block.ids.len() - before));
        let mut places = [0.0; WIDTH];
        for lane in 0..WIDTH {
            places[lane] = f32::from_bits((before + lane) as u32);
        }
        let places = L::load(&places);
        bounded.places.append(on & rows, [places]);
        let [a, b, c, d] = maps[p];
        bounded.relaxed.append(open & rows, [a, b, c, d, spreads[p], places]);
    }
    P
}

/// Four registers from memory. (An `array::map` would be a call, outside of the instruction set.)
#[inline(always)]
pub(super) fn loads<L: Lanes>(from: &[Aligned; 4]) -> [L; 4] {
    [L::load(&from[0].0), L::load(&from[1].0), L::load(&from[2].0), L::load(&from[3].0)]
}

/// Four registers to memory.
#[inline(always)]
pub(super) fn stores<L: Lanes>(from: [L; 4]) -> [Aligned; 4] {
    [Aligned(from[0].store()), Aligned(from[1].store()), Aligned(from[2].store()), Aligned(from[3].store())]
}

/// Four numbers, each in all lanes.
#[inline(always)]
pub(super) fn splats<L: Lanes>(values: &[f32; 4]) -> [L; 4] {
    [L::splat(values[0]), L::splat(values[1]), L::splat(values[2]), L::splat(values[3])]
}
