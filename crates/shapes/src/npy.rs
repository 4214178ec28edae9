//! NPY, NumPy's file of one array: float32 or float64, either byte order, C or Fortran order, of the shape (n,), (n, k) or, as images of
//! points and triangles are, (h, w, k): the points in their order.

use crate::document::{Document, Moved, Parsed, Written};
use crate::error::Error;
use crate::memory;
use crate::precision::Precision;
use crate::text;

/// Where the coordinates are in the file.
struct Array {
    /// Offset of the first number.
    start: usize,
    double: bool,
    big_endian: bool,
    /// The lengths of all axes but the last.
    leading: Vec<usize>,
    rows: usize,
    columns: usize,
    fortran_order: bool,
}

pub(crate) fn read(source: &[u8]) -> Result<Parsed, Error> {
    let (header, start) = header(source)?;
    let array = Array::new(&header, start)?;
    let (rows, columns, size) = (array.rows, array.columns, array.size());
    let left = source.len() - start;
    let needed = (rows as u128 * columns as u128).saturating_mul(size as u128);
    if needed > left as u128 {
        return Err(Error::at_byte(
            start as u64,
            format!(
                "the array of {} numbers takes {needed} bytes, but the file has only {left} left",
                array.shown()
            ),
        ));
    }
    let dim = columns.min(3);
    let mut positions = memory::with_room(rows * dim)?;
    for row in 0..rows {
        for column in 0..dim {
            let at = array.place(row, column);
            let value = array.get(source, at);
            if !value.is_finite() {
                let place = array.name_of(row);
                let message = format!("{place}, column {column}: expected a finite number, found {value}");
                return Err(Error::at_byte(at as u64, message));
            }
            positions.push(value);
        }
    }

    let mut facts = Vec::new();
    let mut say = |what: &str, value: String| facts.push((what.to_string(), value));
    let endian = if array.big_endian { "big endian" } else { "little endian" };
    let order = if array.fortran_order { "Fortran order" } else { "C order" };
    say("array", format!("{}, float{}, {endian}, {order}", array.shown(), 8 * size));
    if columns > 3 {
        say("columns behind the third", format!("{} (carried over)", columns - 3));
    }
    let extra = left - needed as usize;
    if extra > 0 {
        say("behind the array", format!("{extra} bytes (carried over)"));
    }
    Ok(Parsed { dim, positions, faces: None, facts, document: Box::new(array) })
}

/// The text of the header, and where the numbers start.
fn header(source: &[u8]) -> Result<(Header, usize), Error> {
    let Some(rest) = source.strip_prefix(b"\x93NUMPY") else {
        return Err(Error::malformed("an NPY file starts with the bytes 93 'NUMPY', and this one does not"));
    };
    let ended = || Error::at_byte(source.len() as u64, "the file ends within its header");
    let (length, start) = match rest {
        [1, _, a, b, ..] => (u16::from_le_bytes([*a, *b]) as usize, 10),
        [2 | 3, _, a, b, c, d, ..] => (u32::from_le_bytes([*a, *b, *c, *d]) as usize, 12),
        [1..=3, ..] | [] => return Err(ended()),
        [version, ..] => {
            return Err(Error::unsupported(format!("expected NPY version 1, 2 or 3, found {version}")));
        }
    };
    let text = source[start..].get(..length).ok_or_else(ended)?;
    Ok((Header::parse(text, start)?, start + length))
}

/// The header's Python dictionary.
struct Header {
    descr: String,
    fortran_order: bool,
    shape: Vec<usize>,
}

impl Header {
    /// Reads `{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2), }`, which starts at byte `start`.
    fn parse(text: &[u8], start: usize) -> Result<Header, Error> {
        let (mut descr, mut fortran_order, mut shape) = (None, None, None);
        let mut literal = Literal { text, at: 0, start };
        literal.expect(b'{')?;
        while !literal.accept(b'}') {
            let key = literal.string()?;
            literal.expect(b':')?;
            match key {
                b"descr" => {
                    if literal.peek() == Some(b'[') {
                        return Err(Error::unsupported(
                            "the array is structured (its rows have named fields): expected plain float32 or float64",
                        ));
                    }
                    descr = Some(String::from_utf8_lossy(literal.string()?).into_owned());
                }
                b"fortran_order" => fortran_order = Some(literal.truth()?),
                b"shape" => shape = Some(literal.integers()?),
                _ => return Err(literal.wrong("'descr', 'fortran_order' or 'shape'")),
            }
            if !literal.accept(b',') {
                literal.expect(b'}')?;
                break;
            }
        }
        match (descr, fortran_order, shape) {
            (Some(descr), Some(fortran_order), Some(shape)) => Ok(Header { descr, fortran_order, shape }),
            _ => Err(Error::malformed("the header lacks 'descr', 'fortran_order' or 'shape'")),
        }
    }
}

/// Reads the few sorts of Python literals that a header has.
struct Literal<'a> {
    text: &'a [u8],
    at: usize,
    /// Where `text` is in the file.
    start: usize,
}

impl<'a> Literal<'a> {
    /// The next byte behind white space.
    fn peek(&mut self) -> Option<u8> {
        self.at += self.text[self.at..].iter().take_while(|b| b.is_ascii_whitespace()).count();
        self.text.get(self.at).copied()
    }

    fn accept(&mut self, byte: u8) -> bool {
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    fn expect(&mut self, byte: u8) -> Result<(), Error> {
        if self.accept(byte) {
            Ok(())
        } else {
            Err(self.wrong(&format!("'{}'", byte as char)))
        }
    }

    fn string(&mut self) -> Result<&'a [u8], Error> {
        let quote =
            self.peek().filter(|b| matches!(b, b'\'' | b'"')).ok_or_else(|| self.wrong("a string"))?;
        let rest = &self.text[self.at + 1..];
        let length = rest.iter().position(|&b| b == quote).ok_or_else(|| self.wrong("a string that ends"))?;
        self.at += length + 2;
        Ok(&rest[..length])
    }

    fn truth(&mut self) -> Result<bool, Error> {
        self.peek();
        for (word, value) in [("True", true), ("False", false)] {
            if self.text[self.at..].starts_with(word.as_bytes()) {
                self.at += word.len();
                return Ok(value);
            }
        }
        Err(self.wrong("True or False"))
    }

    /// `(3, 2)`, `(3,)`, `()`.
    fn integers(&mut self) -> Result<Vec<usize>, Error> {
        let mut values = Vec::new();
        self.expect(b'(')?;
        while !self.accept(b')') {
            self.peek();
            let digits = self.text[self.at..].iter().take_while(|b| b.is_ascii_digit()).count();
            let word = std::str::from_utf8(&self.text[self.at..self.at + digits]).expect("digits are text");
            values.push(word.parse().map_err(|_| self.wrong("a length"))?);
            self.at += digits;
            // Python 2 wrote 3L.
            if self.text.get(self.at) == Some(&b'L') {
                self.at += 1;
            }
            if !self.accept(b',') {
                self.expect(b')')?;
                break;
            }
        }
        Ok(values)
    }

    fn wrong(&self, expected: &str) -> Error {
        let rest = &self.text[self.at..];
        let word = text::tokens(rest, 0).next().map_or(&b""[..], |range| &rest[range]);
        let message = format!("the header has {} where {expected} was expected", text::quote(word));
        Error::at_byte((self.start + self.at) as u64, message)
    }
}

impl Array {
    fn new(header: &Header, start: usize) -> Result<Array, Error> {
        let (order, kind) = header.descr.split_at_checked(1).unwrap_or(("", ""));
        let double = match (order, kind) {
            ("<" | ">" | "=", "f4") => false,
            ("<" | ">" | "=", "f8") => true,
            _ => {
                return Err(Error::unsupported(format!(
                    "the array's dtype is {}, expected float32 or float64 ('<f4' or '<f8'; array.astype converts)",
                    text::quote(header.descr.as_bytes())
                )))
            }
        };
        let (leading, columns) = match header.shape[..] {
            [rows] => (vec![rows], 1),
            [rows, columns] if columns > 0 => (vec![rows], columns),
            [ref leading @ .., columns] if columns > 1 => (leading.to_vec(), columns),
            _ => (Vec::new(), 0),
        };
        let rows = leading.iter().try_fold(1usize, |rows, &length| rows.checked_mul(length));
        let Some(rows) = rows.filter(|_| columns > 0) else {
            return Err(Error::malformed(format!(
                "expected an array of the shape (n,), (n, 1), (n, 2), (n, 3), (h, w, 3) or more columns, found {:?}",
                header.shape
            )));
        };
        Ok(Array {
            start,
            double,
            big_endian: order == ">",
            leading,
            rows,
            columns,
            fortran_order: header.fortran_order,
        })
    }

    /// Bytes a number.
    fn size(&self) -> usize {
        if self.double {
            8
        } else {
            4
        }
    }

    /// Where in the file the number is.
    fn place(&self, row: usize, column: usize) -> usize {
        let index = if self.fortran_order {
            let (mut index, mut stride) = (0, 1);
            for (&length, at) in self.leading.iter().zip(self.indices(row)) {
                index += at * stride;
                stride *= length;
            }
            index + column * self.rows
        } else {
            row * self.columns + column
        };
        self.start + index * self.size()
    }

    /// The indices of a row along the leading axes; rows are counted with the last of them fastest, as NumPy does.
    fn indices(&self, row: usize) -> impl Iterator<Item = usize> + '_ {
        let mut below = self.rows;
        self.leading.iter().map(move |&length| {
            below /= length;
            row / below % length
        })
    }

    /// `120 x 3`.
    fn shown(&self) -> String {
        let lengths = self.leading.iter().chain([&self.columns]);
        lengths.map(usize::to_string).collect::<Vec<_>>().join(" x ")
    }

    /// A row for a person: `row 4`, or `row (4, 0)` where there are several leading axes.
    fn name_of(&self, row: usize) -> String {
        let indices: Vec<_> = self.indices(row).map(|index| index.to_string()).collect();
        match &indices[..] {
            [row] => format!("row {row}"),
            several => format!("row ({})", several.join(", ")),
        }
    }

    fn get(&self, source: &[u8], at: usize) -> f64 {
        if self.double {
            let bytes = source[at..at + 8].try_into().expect("eight bytes");
            if self.big_endian {
                f64::from_be_bytes(bytes)
            } else {
                f64::from_le_bytes(bytes)
            }
        } else {
            let bytes = source[at..at + 4].try_into().expect("four bytes");
            f64::from(if self.big_endian { f32::from_be_bytes(bytes) } else { f32::from_le_bytes(bytes) })
        }
    }

    fn put(&self, out: &mut [u8], at: usize, value: f64) {
        if self.double {
            let bytes = if self.big_endian { value.to_be_bytes() } else { value.to_le_bytes() };
            out[at..at + 8].copy_from_slice(&bytes);
        } else {
            let value = value as f32;
            let bytes = if self.big_endian { value.to_be_bytes() } else { value.to_le_bytes() };
            out[at..at + 4].copy_from_slice(&bytes);
        }
    }
}

impl Document for Array {
    fn has_normals(&self) -> bool {
        false
    }

    fn precision(&self, _axis: usize) -> Precision {
        if self.double {
            Precision::Double
        } else {
            Precision::Single
        }
    }

    fn write(&self, source: &[u8], moved: &Moved<'_>) -> Result<Written, Error> {
        let mut bytes = memory::copy(source)?;
        let dim = self.columns.min(3);
        for (index, (&before, &after)) in moved.before.iter().zip(moved.after).enumerate() {
            let (row, column) = (index / dim, index % dim);
            if before == after {
                continue;
            }
            if !self.double && !(after as f32).is_finite() {
                return Err(Error::argument(format!(
                    "position {row} cannot be written: {after} is beyond the range of the file's float32"
                )));
            }
            self.put(&mut bytes, self.place(row, column), after);
        }
        Ok(Written { bytes, side_files: Vec::new() })
    }
}
