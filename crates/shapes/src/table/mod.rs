//! Tables of numbers: XYZ, TXT, CSV; one position a line, with any further columns.
//!
//! Columns are separated by semicolons, commas or white space, whichever the first row has. Before the first row there may
//! be header lines and comments (`#`, `//`), one of which may name the columns, and a line with nothing but the number of
//! rows. The positions are the columns named x, y and z, or else the first three that hold numbers.

mod layout;

use std::ops::Range;

use crate::document::{Document, Fact, Moved, Parsed, Written};
use crate::error::Error;
use crate::memory;
use crate::normals;
use crate::number::{self, Style};
use crate::precision::Precision;
use crate::text::{Line, Patcher};
use layout::{rows, Layout};

pub(crate) fn read(source: &[u8]) -> Result<Parsed, Error> {
    let layout = Layout::find(source)?;
    let dim = layout.position.len();
    let (mut positions, mut decimals) = (Vec::new(), 0);
    let mut fields = Vec::new();
    for line in data(source, &layout) {
        layout.separator.split(line.bytes, &mut fields);
        if fields.len() != layout.columns {
            return Err(Error::at_line(
                line.number,
                format!(
                    "expected {} columns as in line {}, found {}",
                    layout.columns,
                    layout.line,
                    fields.len()
                ),
            ));
        }
        memory::reserve(&mut positions, dim)?;
        for number in layout.numbers(&line, &fields, &layout.position) {
            let (field, value) = number?;
            decimals = decimals.max(number::decimals(&line.bytes[field]));
            positions.push(value);
        }
        for number in layout.numbers(&line, &fields, layout.normal.as_ref().map_or(&[], |n| n)) {
            number?;
        }
    }
    let count = positions.len() / dim;
    if let Some((promised, line)) = layout.promised.filter(|&(promised, _)| promised != count as u64) {
        return Err(Error::at_line(line, format!("{promised} rows are promised, but {count} follow")));
    }
    let facts = facts(&layout);
    Ok(Parsed { dim, positions, faces: None, facts, document: Box::new(Table { layout, decimals }) })
}

/// The rows from the first one on.
fn data<'a>(source: &'a [u8], layout: &Layout) -> impl Iterator<Item = Line<'a>> {
    let start = layout.start;
    rows(source).skip_while(move |line| line.start < start)
}

fn facts(layout: &Layout) -> Vec<Fact> {
    let one_based = |columns: &[usize]| {
        let columns: Vec<_> = columns.iter().map(|column| (column + 1).to_string()).collect();
        columns.join(", ")
    };
    let mut facts = vec![
        ("columns".into(), layout.columns.to_string()),
        ("columns of the position".into(), one_based(&layout.position)),
    ];
    if let Some(names) = &layout.names {
        facts.push(("column names".into(), names.clone()));
    }
    let mut further = layout.columns - layout.position.len();
    if let Some(normal) = layout.normal {
        facts.push(("normals".into(), format!("columns {} (turned with the surface)", one_based(&normal))));
        further -= 3;
    }
    if further > 0 {
        facts.push(("further columns, carried over".into(), further.to_string()));
    }
    facts
}

/// How to write it: the rows are found again.
struct Table {
    layout: Layout,
    decimals: usize,
}

impl Document for Table {
    fn has_normals(&self) -> bool {
        self.layout.normal.is_some()
    }

    fn precision(&self, _axis: usize) -> Precision {
        Precision::Digits(self.decimals)
    }

    fn write(&self, source: &[u8], moved: &Moved<'_>) -> Result<Written, Error> {
        let layout = &self.layout;
        let dim = layout.position.len();
        let style = Style::new(self.decimals, moved.after, dim);
        let mut patcher = Patcher::new(source)?;
        let (mut fields, mut changes) = (Vec::new(), Vec::new());
        for (index, line) in data(source, layout).enumerate() {
            layout.separator.split(line.bytes, &mut fields);
            changes.clear();
            for (k, &column) in layout.position.iter().enumerate() {
                let at = dim * index + k;
                changes.push((fields[column].clone(), moved.before[at], moved.after[at], style));
            }
            if let (Some(columns), Some(maps)) = (&layout.normal, moved.maps) {
                let normal = layout.numbers(&line, &fields, columns).collect::<Result<Vec<_>, _>>()?;
                turn(&line, &normal, normals::map_at(maps, index), &mut changes);
            }
            // Columns may come in any order.
            changes.sort_by_key(|(field, ..)| field.start);
            for (field, was, is, style) in &changes {
                if style.differs(*was, *is) {
                    style.print(*is, patcher.replace(line.start + field.start..line.start + field.end)?);
                }
            }
        }
        Ok(Written { bytes: patcher.finish()?, side_files: Vec::new() })
    }
}

/// A field, its number before and after, and how to print it.
type Change = (Range<usize>, f64, f64, Style);

fn turn(line: &Line<'_>, normal: &[(Range<usize>, f64)], map: &[f64; 9], changes: &mut Vec<Change>) {
    let was = std::array::from_fn(|k| normal[k].1);
    let is = normals::turn(map, was);
    let style = Style::for_normal(std::array::from_fn(|k| &line.bytes[normal[k].0.clone()]));
    for k in 0..3 {
        changes.push((normal[k].0.clone(), was[k], is[k], style));
    }
}
