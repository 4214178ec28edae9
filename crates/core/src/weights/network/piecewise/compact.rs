//! Rows that stay open move together, so that no lane is empty.

use super::rows::{Bounded, Row, Rows};
use crate::machine::simd::{multiversion, Aligned, Lanes, WIDTH};

multiversion! {
    /// Appends the open rows of a block to those of a child, with their open columns.
    pub(super) fn compact(bounded: &Bounded, rows: &mut Rows) = compact_body
}

/// Panels that rows are taken from at a time.
const SOURCES: usize = 3;

#[inline(always)]
fn compact_body<L: Lanes>(bounded: &Bounded, rows: &mut Rows) {
    let mut rest = &bounded.open[..];
    while !rest.is_empty() {
        let place = rows.ids.len() % WIDTH;
        if place == 0 {
            rows.push([Aligned::ZERO; 4]);
        }
        let mut sources = Sources::<L>::new();
        let taken = sources.take(rest, place);
        rows.ids.extend(rest[..taken].iter().map(|row| row.id));
        rest = &rest[taken..];
        let last = rows.panels() - 1;
        for k in 0..4 {
            let to = &mut rows.affine[last][k];
            *to = sources.put(to, |panel| &bounded.affine[panel][k]);
        }
        let to = rows.last_panel();
        match (sources.count, place) {
            (1, 0) => sources.put_columns::<1, true>(bounded, to),
            (2, 0) => sources.put_columns::<2, true>(bounded, to),
            (_, 0) => sources.put_columns::<SOURCES, true>(bounded, to),
            (1, _) => sources.put_columns::<1, false>(bounded, to),
            (2, _) => sources.put_columns::<2, false>(bounded, to),
            (_, _) => sources.put_columns::<SOURCES, false>(bounded, to),
        }
    }
}

/// How a panel is put together.
struct Sources<L: Lanes> {
    count: usize,
    /// Which panel each is, which of its lanes go where, and whether they do.
    panels: [usize; SOURCES],
    places: [L::Places; SOURCES],
    wanted: [L::Mask; SOURCES],
}

impl<L: Lanes> Sources<L> {
    #[inline(always)]
    fn new() -> Self {
        let nothing = L::splat(0.0);
        Sources {
            count: 0,
            panels: [0; SOURCES],
            places: [L::places(&[0; WIDTH]); SOURCES],
            wanted: [nothing.less(nothing); SOURCES],
        }
    }

    /// Takes rows for the lanes from `place` on: as many as there is room for, of as many panels as can be. Returns how many.
    #[inline(always)]
    fn take(&mut self, rows: &[Row], place: usize) -> usize {
        let mut taken = 0;
        while self.count < SOURCES && taken < rows.len() && place + taken < WIDTH {
            let panel = rows[taken].panel;
            let (mut places, mut wanted) = ([0; WIDTH], [0.0; WIDTH]);
            while taken < rows.len() && rows[taken].panel == panel && place + taken < WIDTH {
                (places[place + taken], wanted[place + taken]) = (rows[taken].lane, 1.0);
                taken += 1;
            }
            self.panels[self.count] = panel as usize;
            self.places[self.count] = L::places(&places);
            self.wanted[self.count] = L::splat(0.0).less(L::load(&wanted));
            self.count += 1;
        }
        taken
    }

    /// `to` with the lanes that come from somewhere.
    #[inline(always)]
    fn put<'a>(&self, to: &Aligned, from: impl Fn(usize) -> &'a Aligned) -> Aligned {
        let mut value = L::load(&to.0);
        for s in 0..self.count {
            let from = L::load(&from(self.panels[s]).0).permute(self.places[s]);
            value = L::select(self.wanted[s], from, value);
        }
        Aligned(value.store())
    }

    /// The same for each of the open columns; where `NEW`, whatever is there is lost.
    #[inline(always)]
    fn put_columns<const COUNT: usize, const NEW: bool>(&self, bounded: &Bounded, to: &mut [Aligned]) {
        let mut from = [bounded.panel(self.panels[0]); COUNT];
        for s in 0..COUNT {
            from[s] = &bounded.panel(self.panels[s])[..to.len()];
        }
        for (c, to) in to.iter_mut().enumerate() {
            let mut value = if NEW { L::splat(0.0) } else { L::load(&to.0) };
            for s in 0..COUNT {
                let from = L::load(&from[s][c].0).permute(self.places[s]);
                value = L::select(self.wanted[s], from, value);
            }
            *to = Aligned(value.store());
        }
    }
}
