//! CSV and its kin: control points a line, under a header line or without one.

mod columns;
mod header;
mod rows;

use columns::Columns;
pub use rows::cells;
use rows::{separator, Row};

use super::landmarks::{is_mark, name_of, Landmarks};
use crate::error::Error;
use crate::session::Read;
use crate::text::{quoted, shown};

/// Reads a table. Unknown columns are passed over.
pub fn read(text: &str) -> Result<Read, Error> {
    let mut rows = cells(text, separator(text))?;
    // Excel's own word for what separates the cells.
    if rows.first().is_some_and(|row| row.cells[0].eq_ignore_ascii_case("sep=")) {
        rows.remove(0);
    }
    // CloudCompare and NumPy write what the columns are as a comment.
    let comments = rows.iter().take_while(|row| row.is_comment() && !Columns::is_data(row)).count();
    let mut header = None;
    for row in rows.drain(..comments) {
        header = Columns::of_header(&row.uncommented()).ok().or(header);
    }
    let Some(first) = rows.first() else {
        return Err(Error::file("there are no control points; at least one is needed"));
    };
    let mut notes = Vec::new();
    let columns = match header {
        Some(columns) => columns,
        None if Columns::is_data(first) => Columns::of_data(&rows, &mut notes)?,
        None => Columns::of_header(&rows.remove(0))?,
    };
    if rows.is_empty() {
        return Err(Error::file("there are no control points below the header line; at least one is needed"));
    }
    let comma = columns.has_decimal_commas(&rows);
    if comma {
        notes.push("the commas in numbers are read as decimal points".into());
    }
    let mut landmarks = Landmarks::new(columns.source.len());
    for row in &rows {
        push(&mut landmarks, row, &columns, comma)?;
    }
    landmarks.notes = notes;
    landmarks.finish()
}

fn push(landmarks: &mut Landmarks, row: &Row, columns: &Columns, comma: bool) -> Result<(), Error> {
    let (line, width) = (row.line, columns.titles.len());
    let s = if width == 1 { "" } else { "s" };
    if row.cells.len() > width {
        let (as_in, found) = (columns.whose, row.cells.len());
        return Err(Error::file(format!(
            "line {line}: expected {width} column{s} as in the {as_in}, found {found}"
        )));
    }
    let cell = |at: usize| row.cells.get(at).map_or("", |cell| &**cell);
    let name = match columns.name.map(cell) {
        None => name_of(landmarks.count()),
        Some("") => return Err(Error::file(format!("line {line}: the control point has no name"))),
        Some(name) => name.to_string(),
    };
    if columns.active.is_some_and(|at| cell(at).eq_ignore_ascii_case("false")) {
        landmarks.leave_out(name, "it is not active");
        return Ok(());
    }
    let mut places = Vec::new();
    for (what, of) in [("position", &columns.source), ("target", &columns.target)] {
        let cells: Vec<&str> = of.iter().map(|at| cell(*at)).collect();
        let stays = what == "target" && cells.iter().all(|cell| cell.is_empty());
        let mark = cells.iter().find(|cell| is_mark(cell) || columns.active.is_some() && is_endless(cell));
        if stays {
            break;
        } else if let Some(mark) = mark {
            landmarks.leave_out(name, &format!("its {what} is {}", shown(mark)));
            return Ok(());
        } else if cells.iter().all(|cell| cell.is_empty()) {
            landmarks.leave_out(name, &format!("its {what} is empty"));
            return Ok(());
        }
        let mut place = Vec::with_capacity(cells.len());
        for (at, cell) in of.iter().zip(cells) {
            place.push(number(cell, comma).ok_or_else(|| {
                let found = if cell.is_empty() { "nothing".into() } else { shown(cell) };
                let (title, name) = (shown(&columns.titles[*at]), quoted(&name));
                let but = if comma { ": other numbers have decimal commas" } else { "" };
                Error::file(format!(
                    "line {line}: expected a number for {title} of {name}, found {found}{but}"
                ))
            })?);
        }
        places.push(place);
    }
    let target = if places.len() == 2 { places.pop() } else { None };
    landmarks.push(name, places.pop().unwrap_or_default(), target);
    Ok(())
}

/// BigWarp's word for a place that was not set.
fn is_endless(cell: &str) -> bool {
    cell.parse::<f64>().is_ok_and(f64::is_infinite)
}

/// A number, with a decimal comma if others have one.
fn number(cell: &str, comma: bool) -> Option<f64> {
    match comma {
        true if cell.contains('.') => None,
        true => cell.replace(',', ".").parse().ok(),
        false => cell.parse().ok(),
    }
}
