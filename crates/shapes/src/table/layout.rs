//! Where the rows of a table start, and what its columns are.

use std::ops::Range;

use crate::error::Error;
use crate::number::{self, has_decimal_comma};
use crate::text::{printable, quote, tokens, Line, Lines};

/// What stands between two columns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Separator {
    Byte(u8),
    WhiteSpace,
}

impl Separator {
    fn of(line: &[u8]) -> Separator {
        [b';', b',']
            .into_iter()
            .find(|byte| line.contains(byte))
            .map_or(Separator::WhiteSpace, Separator::Byte)
    }

    /// The places of a line's fields, without white space and quotation marks around them, written over `fields`.
    pub(super) fn split(self, line: &[u8], fields: &mut Vec<Range<usize>>) {
        fields.clear();
        let Separator::Byte(separator) = self else {
            fields.extend(tokens(line, 0));
            return;
        };
        let (mut from, mut quoted) = (0, false);
        for at in 0..=line.len() {
            match line.get(at) {
                Some(b'"') => quoted = !quoted,
                Some(&byte) if quoted || byte != separator => {}
                _ => {
                    fields.push(trimmed(line, from..at));
                    from = at + 1;
                }
            }
        }
    }
}

fn trimmed(line: &[u8], field: Range<usize>) -> Range<usize> {
    let text = line[field.clone()].trim_ascii_start();
    let start = field.end - text.len();
    let text = text.trim_ascii_end();
    match text {
        [b'"', inner @ .., b'"'] => start + 1..start + 1 + inner.len(),
        _ => start..start + text.len(),
    }
}

/// Where a table's rows start and what their columns are.
#[derive(Debug)]
pub(super) struct Layout {
    pub separator: Separator,
    /// Offset of the first row.
    pub start: usize,
    pub columns: usize,
    pub position: Vec<usize>,
    pub normal: Option<[usize; 3]>,
    /// The number of rows that a line before them promises, and that line.
    pub promised: Option<(u64, u64)>,
    /// The columns' names, where they have any.
    pub names: Option<String>,
    /// The line of the first row.
    pub line: u64,
}

fn is_comment(line: &[u8]) -> bool {
    line.starts_with(b"#") || line.starts_with(b"//")
}

/// Rows: lines that are neither blank nor comments.
pub(super) fn rows(source: &[u8]) -> impl Iterator<Item = Line<'_>> {
    Lines::new(source).filter(|line| {
        let text = line.bytes.trim_ascii();
        !text.is_empty() && !is_comment(text)
    })
}

impl Layout {
    /// From the first row and what stands before it.
    pub(super) fn find(source: &[u8]) -> Result<Layout, Error> {
        let mut header = None;
        let mut promised: Option<(u64, u64)> = None;
        let mut first_line = None;
        let mut fields = Vec::new();
        for line in Lines::new(source) {
            let text = line.bytes.trim_ascii();
            if text.is_empty() {
                continue;
            }
            if is_comment(text) {
                header = text.strip_prefix(b"//").or(text.strip_prefix(b"#"));
                continue;
            }
            first_line.get_or_insert(line);
            let separator = Separator::of(text);
            separator.split(line.bytes, &mut fields);
            let numeric: Vec<usize> = (0..fields.len())
                .filter(|&column| number::parse(&line.bytes[fields[column].clone()]).is_some())
                .collect();
            if promised.is_none() && fields.len() == 1 {
                promised = promise(source, &line).map(|count| (count, line.number));
                if promised.is_some() {
                    continue;
                }
            }
            let row = is_row(numeric.len(), fields.len());
            if let Some(found) = decimal_comma(line.bytes, separator, row) {
                return Err(Error::at_line(line.number, number::wrong(found, String::new)));
            }
            if row {
                let layout = Layout {
                    separator,
                    start: line.start,
                    line: line.number,
                    columns: fields.len(),
                    position: Vec::new(),
                    normal: None,
                    promised,
                    names: None,
                };
                return layout.with_columns(&numeric, header);
            }
            header = Some(text);
        }
        Err(first_line.map_or_else(
            || Error::malformed("the table has no rows, expected numbers"),
            |line| {
                Error::at_line(
                    line.number,
                    format!("expected a row of numbers, found {}", quote(line.bytes.trim_ascii())),
                )
            },
        ))
    }

    /// Chooses the columns of the position and of the normal.
    fn with_columns(mut self, numeric: &[usize], header: Option<&[u8]>) -> Result<Layout, Error> {
        let names = header.and_then(|line| column_names(line, self.columns));
        let find = |name: &str| names.as_ref().and_then(|names| names.iter().position(|n| n == name));
        self.position = match (find("x"), find("y"), find("z")) {
            (Some(x), Some(y), Some(z)) => vec![x, y, z],
            (Some(x), Some(y), None) => vec![x, y],
            _ => numeric.iter().copied().take(3).collect(),
        };
        if let (Some(x), Some(y), Some(z)) = (find("nx"), find("ny"), find("nz")) {
            // Without names for the position, these may be among the columns taken for it.
            let apart = [x, y, z].iter().all(|column| !self.position.contains(column));
            self.normal = Some([x, y, z]).filter(|_| apart && self.position.len() == 3);
        }
        if let Some(column) = self.position.iter().find(|column| !numeric.contains(column)) {
            return Err(Error::at_line(self.line, format!("expected a number in column {}", column + 1)));
        }
        self.names = names.map(|names| printable(names.join(", ").as_bytes()));
        Ok(self)
    }

    /// The numbers of some columns of a row and their places in it.
    pub(super) fn numbers<'a>(
        &'a self,
        line: &'a Line<'_>,
        fields: &'a [Range<usize>],
        columns: &'a [usize],
    ) -> impl Iterator<Item = Result<(Range<usize>, f64), Error>> + 'a {
        columns.iter().map(|&column| {
            let field = fields[column].clone();
            let text = &line.bytes[field.clone()];
            let value = number::parse(text).ok_or_else(|| {
                let otherwise =
                    || format!("expected a finite number in column {}, found {}", column + 1, quote(text));
                Error::at_line(line.number, number::wrong(text, otherwise))
            })?;
            Ok((field, value))
        })
    }
}

/// Labels are columns too, but a sentence with a number in it is no row.
fn is_row(numbers: usize, fields: usize) -> bool {
    numbers == fields || numbers >= 3
}

/// A number with a decimal comma in a line that would be a row if commas were points: it must not pass for a header.
/// Where the commas of an unquoted `0,5 1,5` do not make a row of it, white space is what separates its columns.
fn decimal_comma(line: &[u8], separator: Separator, row: bool) -> Option<&[u8]> {
    let mut fields = Vec::new();
    let separators = [Some(separator), (!row).then_some(Separator::WhiteSpace)];
    separators.into_iter().flatten().find_map(|separator| {
        separator.split(line, &mut fields);
        let found = || fields.iter().map(|field| &line[field.clone()]);
        let numbers = found().filter(|text| number::parse(text).is_some() || has_decimal_comma(text)).count();
        found().find(|text| is_row(numbers, fields.len()) && has_decimal_comma(text))
    })
}

/// The number of rows that a line with nothing else promises: one with more columns must follow.
fn promise(source: &[u8], line: &Line<'_>) -> Option<u64> {
    let count = std::str::from_utf8(line.bytes.trim_ascii()).ok()?.parse().ok()?;
    let next = rows(&source[line.start + line.bytes.len()..]).next()?;
    let mut fields = Vec::new();
    Separator::of(next.bytes.trim_ascii()).split(next.bytes, &mut fields);
    (fields.len() > 1).then_some(count)
}

/// What programs call columns that are no scalar field.
const USUAL: [&str; 13] = ["x", "y", "z", "r", "g", "b", "a", "rf", "gf", "bf", "nx", "ny", "nz"];

/// The names in a header line, in lower case, if it has one for each column.
fn column_names(line: &[u8], columns: usize) -> Option<Vec<String>> {
    let mut fields = Vec::new();
    let separator = Separator::of(line.trim_ascii());
    separator.split(line, &mut fields);
    let name = |field: &Range<usize>| String::from_utf8_lossy(&line[field.clone()]).to_ascii_lowercase();
    let mut names: Vec<String> = fields.iter().map(name).collect();
    let more = names.len().checked_sub(columns)?;
    if more > 0 {
        // CloudCompare puts white space into names too ("Scalar field"): these words are one name.
        let is_unusual = |name: &String| !USUAL.contains(&name.as_str());
        let from = names.iter().position(is_unusual)?;
        let words = names.get(from..=from + more)?;
        if separator != Separator::WhiteSpace
            || !names.iter().take(3).eq(["x", "y", "z"])
            || !words.iter().all(is_unusual)
        {
            return None;
        }
        let one = words.join(" ");
        names.splice(from..=from + more, [one]);
    }
    Some(names)
}
