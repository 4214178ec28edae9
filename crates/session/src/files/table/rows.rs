//! Text -> rows of cells, with quotation marks as in RFC 4180.

use crate::error::Error;

/// A line of a table that is not blank; a quoted cell may make it several lines of the file.
pub struct Row {
    /// The number of its first line, from 1.
    pub line: usize,
    /// Its cells, without blanks around them.
    pub cells: Vec<String>,
}

impl Row {
    /// Whether it is no part of the table.
    pub fn is_comment(&self) -> bool {
        self.cells[0].starts_with('#') || self.cells[0].starts_with("//")
    }

    /// What it says without the sign that it is a comment.
    pub fn uncommented(&self) -> Row {
        let mut cells = self.cells.clone();
        cells[0] = cells[0].trim_start_matches(['#', '/']).trim().to_string();
        if cells[0].is_empty() {
            cells.remove(0);
        }
        Row { line: self.line, cells }
    }
}

/// What stands between the cells, judged by the first line that is no comment: a tab, `;` or `,`, otherwise blanks.
pub fn separator(text: &str) -> char {
    let mut lines = text.split(['\n', '\r']).map(str::trim_start).filter(|line| !line.is_empty());
    let first = lines.clone().next().unwrap_or_default();
    let first = lines.find(|line| !line.starts_with('#') && !line.starts_with("//")).unwrap_or(first);
    let mut in_quotes = false;
    let plain: String = first
        .chars()
        .filter(|letter| {
            in_quotes ^= *letter == '"';
            !in_quotes
        })
        .collect();
    ['\t', ';', ','].into_iter().find(|separator| plain.contains(*separator)).unwrap_or(' ')
}

/// The rows that have text in them.
pub fn cells(text: &str, separator: char) -> Result<Vec<Row>, Error> {
    let mut rows = Vec::new();
    let mut cells: Vec<String> = Vec::new();
    let mut cell = String::new();
    let (mut line, mut start) = (1, 1);
    // Whether the cell is quoted, and whether its quotation is over.
    let (mut in_quotes, mut was_quoted) = (false, false);
    let mut letters = text.chars().peekable();
    loop {
        let letter = letters.next();
        if in_quotes {
            match letter {
                None => return Err(Error::file(format!("line {start}: not CSV: unexpected end of data"))),
                Some('"') if letters.next_if_eq(&'"').is_some() => cell.push('"'),
                Some('"') => in_quotes = false,
                Some(letter) => {
                    line += usize::from(letter == '\n');
                    cell.push(letter);
                }
            }
            continue;
        }
        let blanks = separator == ' ';
        match letter {
            Some('"') if !was_quoted && cell.trim().is_empty() => {
                cell.clear();
                (in_quotes, was_quoted) = (true, true);
            }
            None | Some('\n' | '\r') => {
                if letter == Some('\r') {
                    letters.next_if_eq(&'\n');
                }
                end(&mut cells, &mut cell, blanks && !was_quoted);
                let row = Row { line: start, cells: std::mem::take(&mut cells) };
                if row.cells.iter().any(|cell| !cell.is_empty()) {
                    rows.push(row);
                }
                if letter.is_none() {
                    return Ok(rows);
                }
                was_quoted = false;
                line += 1;
                start = line;
            }
            Some(letter) if letter == separator || blanks && letter.is_whitespace() => {
                end(&mut cells, &mut cell, blanks && !was_quoted);
                was_quoted = false;
            }
            Some(letter) if was_quoted && !letter.is_whitespace() => {
                let message = format!("line {start}: not CSV: '{separator}' expected after '\"'");
                return Err(Error::file(message));
            }
            Some(letter) if was_quoted && letter.is_whitespace() => {}
            Some(letter) => cell.push(letter),
        }
    }
}

/// Ends a cell; where blanks separate, there are none that are empty.
fn end(cells: &mut Vec<String>, cell: &mut String, skip_empty: bool) {
    let text = cell.trim();
    if !(skip_empty && text.is_empty()) {
        cells.push(text.to_string());
    }
    cell.clear();
}
