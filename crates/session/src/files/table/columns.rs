//! Which column of a table holds what.

use std::collections::HashSet;

use super::header::{known, Known, NAMES};
use super::number;
use super::rows::Row;
use crate::error::Error;
use crate::files::csv_text::AXES;
use crate::files::landmarks::is_mark;
use crate::text::{quoted, shown};

/// The columns of a table.
pub struct Columns {
    /// What each is called.
    pub titles: Vec<String>,
    /// What tells of their number, for sentences.
    pub whose: &'static str,
    /// The column of the names.
    pub name: Option<usize>,
    /// BigWarp's word for whether a landmark counts.
    pub active: Option<usize>,
    /// The columns of the position's coordinates.
    pub source: Vec<usize>,
    /// Those of the target's, as many or none.
    pub target: Vec<usize>,
}

impl Columns {
    /// As a header line says.
    pub fn of_header(row: &Row) -> Result<Columns, Error> {
        let titles: Vec<String> = row.cells.iter().map(|title| title.to_lowercase()).collect();
        let (line, found) = (row.line, shown(&row.cells.join(",")));
        let known: Vec<Known> = titles.iter().map(|title| known(title)).collect();
        let (mut seen, mut meant) = (HashSet::new(), HashSet::new());
        for (title, known) in titles.iter().zip(&known) {
            let new = title.is_empty() || seen.insert(title);
            if !new || *known != Known::Other && !meant.insert(known) {
                return Err(Error::file(format!("line {line}: the column {} is there twice", quoted(title))));
            }
        }
        let sources = groups(&known, false);
        let complete: Vec<&Group> = sources.iter().filter(|group| group.is_complete()).collect();
        let [source] = complete[..] else {
            return Err(Error::file(format!(
                "line {line}: expected the header name,x,y,z or name,x,y,z,target_x,target_y,target_z, found {found}"
            )));
        };
        let targets = groups(&known, true);
        let promised = !targets.is_empty() || titles.iter().any(|title| title.starts_with("target_"));
        let dim = source.columns().len();
        let target = match &targets[..] {
            [target] if target.is_complete() && target.columns().len() == dim => target.columns(),
            _ if promised => {
                let prefix = targets.first().map_or("target", |group| group.prefix);
                let whole: Vec<String> = AXES[..dim].iter().map(|axis| format!("{prefix}_{axis}")).collect();
                let whole = whole.join(",");
                let message =
                    format!("line {line}: expected all of the columns {whole} or none, found {found}");
                return Err(Error::file(message));
            }
            _ => Vec::new(),
        };
        let named = |name: &str| {
            known.iter().position(|column| matches!(column, Known::Name(known) if **known == *name))
        };
        let name = NAMES.iter().find_map(|name| named(name)).or((titles[0].is_empty()).then_some(0));
        Ok(Columns { titles, whose: "header", name, active: None, source: source.columns(), target })
    }

    /// Whether a row is no header: numbers, perhaps after a name.
    pub fn is_data(row: &Row) -> bool {
        let start = if is_bigwarp(row) { 2 } else { usize::from(row.cells.len() > 1) };
        row.cells[0] != "#" && row.cells[start..].iter().all(|cell| is_number(cell))
    }

    /// As many as the first row has, where there is no header.
    pub fn of_data(rows: &[Row], notes: &mut Vec<String>) -> Result<Columns, Error> {
        let first = &rows[0];
        let count = first.cells.len();
        let bigwarp = is_bigwarp(first);
        let named = bigwarp || !is_number(&first.cells[0]);
        // Four numbers are a number and a place in space, or two places in the plane.
        let indexed = !named && (count == 5 || count == 7 || count == 4 && is_index(rows));
        let start = if bigwarp { 2 } else { usize::from(named || indexed) };
        let (dim, target) = match count - start {
            numbers @ 1..=3 if !bigwarp => (numbers, false),
            4 => (2, true),
            6 => (3, true),
            found => {
                let (line, expected) = (first.line, if bigwarp { "4 or 6" } else { "1, 2, 3, 4 or 6" });
                let message =
                    format!("line {line}: expected {expected} numbers, or a header line, found {found}");
                return Err(Error::file(message));
            }
        };
        let mut titles = vec!["name".to_string(); start];
        titles.extend(AXES[..dim].iter().map(|axis| axis.to_string()));
        if target {
            titles.extend(AXES[..dim].iter().map(|axis| format!("target_{axis}")));
        }
        if !bigwarp {
            notes.push(format!("there is no header line: the columns are taken for {}", titles.join(",")));
        }
        Ok(Columns {
            titles,
            whose: "first line",
            name: (start > 0).then_some(0),
            active: bigwarp.then_some(1),
            source: (start..start + dim).collect(),
            target: if target { (start + dim..start + 2 * dim).collect() } else { Vec::new() },
        })
    }

    /// Whether numbers have decimal commas.
    pub fn has_decimal_commas(&self, rows: &[Row]) -> bool {
        let columns = || self.source.iter().chain(&self.target);
        let mut cells = rows.iter().flat_map(|row| columns().filter_map(|at| row.cells.get(*at)));
        cells.any(|cell| cell.contains(',') && number(cell, true).is_some())
    }
}

/// Columns that begin alike, by axis.
struct Group {
    prefix: &'static str,
    axes: [Option<usize>; 3],
}

impl Group {
    fn columns(&self) -> Vec<usize> {
        self.axes.iter().map_while(|column| *column).collect()
    }

    /// Whether it is x, x and y, or all three.
    fn is_complete(&self) -> bool {
        let count = self.columns().len();
        count > 0 && self.axes[count..].iter().all(Option::is_none)
    }
}

fn groups(known: &[Known], target: bool) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (at, column) in known.iter().enumerate() {
        let Known::Axis { target: of_target, prefix, axis } = *column else { continue };
        if of_target != target {
            continue;
        }
        let place = groups.iter().position(|group| group.prefix == prefix).unwrap_or_else(|| {
            groups.push(Group { prefix, axes: [None; 3] });
            groups.len() - 1
        });
        groups[place].axes[axis] = Some(at);
    }
    groups
}

fn is_number(cell: &str) -> bool {
    is_mark(cell) || number(cell, cell.contains(',')).is_some()
}

fn is_bigwarp(row: &Row) -> bool {
    row.cells.get(1).is_some_and(|cell| ["true", "false"].iter().any(|word| cell.eq_ignore_ascii_case(word)))
}

/// Whether the first column counts the rows, from 0 or from 1, in whole numbers.
fn is_index(rows: &[Row]) -> bool {
    let index = |row: &Row| row.cells[0].parse::<usize>().ok();
    let first = index(&rows[0]).filter(|first| *first < 2);
    first.is_some_and(|first| rows.iter().enumerate().all(|(i, row)| index(row) == Some(first + i)))
}
