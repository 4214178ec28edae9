//! Facts about a shape that several formats tell alike.

use std::collections::HashSet;

use crate::document::Fact;
use crate::error::Error;
use crate::text::printable;

/// What happens to splats.
pub(crate) const SPLATS_MOVE: &str =
    "3D Gaussian splats, moved as points: shape, rotation and colour stay as they are";

/// How many faces of which number of corners a file has.
#[derive(Default)]
pub(crate) struct FaceSizes {
    fewer: usize,
    triangles: usize,
    quads: usize,
    more: usize,
}

impl FaceSizes {
    pub(crate) fn add(&mut self, corners: usize) {
        match corners {
            0..=2 => self.fewer += 1,
            3 => self.triangles += 1,
            4 => self.quads += 1,
            _ => self.more += 1,
        }
    }

    pub(crate) fn tell(&self, facts: &mut Vec<Fact>) {
        let all = self.fewer + self.triangles + self.quads + self.more;
        let kinds = [
            (self.triangles, "triangles"),
            (self.quads, "quads"),
            (self.more, "n-gons"),
            (self.fewer, "with fewer than three corners"),
        ];
        let kinds: Vec<_> = kinds
            .iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, kind)| format!("{count} {kind}"))
            .collect();
        if all > 0 {
            facts.push(("faces".into(), format!("{all} ({})", kinds.join(", "))));
        }
    }
}

/// Distinct names in the order in which they appear.
#[derive(Default)]
pub(crate) struct Names<'a> {
    seen: HashSet<&'a [u8]>,
    first: Vec<&'a [u8]>,
}

impl<'a> Names<'a> {
    /// As many names are told.
    const SHOWN: usize = 8;
    /// As many characters of each.
    const LONGEST: usize = 40;

    pub(crate) fn add(&mut self, name: &'a [u8]) -> Result<(), Error> {
        self.seen.try_reserve(1).map_err(|_| Error::memory())?;
        if self.seen.insert(name) && self.first.len() < Self::SHOWN {
            self.first.push(name);
        }
        Ok(())
    }

    /// `("materials", "3: oak, steel, glass")`.
    pub(crate) fn tell(&self, what: &str, facts: &mut Vec<Fact>) {
        if self.seen.is_empty() {
            return;
        }
        let shown = |name: &&[u8]| -> String {
            let text = String::from_utf8_lossy(name);
            let text: String = text.chars().take(Self::LONGEST).collect();
            if text.is_empty() {
                "(no name)".into()
            } else {
                printable(text.as_bytes())
            }
        };
        let names: Vec<_> = self.first.iter().map(shown).collect();
        let more = if self.seen.len() > self.first.len() { ", ..." } else { "" };
        facts.push((what.into(), format!("{}: {}{more}", self.seen.len(), names.join(", "))));
    }
}
