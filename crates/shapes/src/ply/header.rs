//! The header of a PLY file: which elements follow, how many of each, and what each is made of.

use super::scalar::{ByteOrder, Scalar};
use crate::error::Error;
use crate::text::{self, printable};

/// Longer headers are refused: nobody writes one, and it bounds what a hostile one can make us remember.
const LONGEST: usize = 1 << 20;

/// How the body is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    Binary(ByteOrder),
}

/// One property of an element.
#[derive(Clone)]
pub(super) struct Property {
    pub name: String,
    pub kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Scalar(Scalar),
    /// A number of items, and then the items.
    List {
        count: Scalar,
        item: Scalar,
    },
}

/// A table of the body: `count` rows of the same properties.
#[derive(Clone)]
pub(super) struct Element {
    pub name: String,
    pub count: usize,
    pub properties: Vec<Property>,
}

impl Property {
    /// Its name for an error message.
    pub(super) fn shown(&self) -> String {
        text::quote(self.name.as_bytes())
    }
}

impl Element {
    /// Its name for an error message.
    pub(super) fn shown(&self) -> String {
        text::quote(self.name.as_bytes())
    }

    /// Where the property of this name is among the others.
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        self.properties.iter().position(|p| p.name == name)
    }

    /// The bytes that a row takes at least: all of them, where no property is a list.
    pub(super) fn smallest_row(&self, encoding: Encoding) -> usize {
        self.properties
            .iter()
            .map(|property| match (encoding, property.kind) {
                // A digit and white space after it.
                (Encoding::Ascii, _) => 2,
                (_, Kind::Scalar(scalar)) => scalar.size(),
                (_, Kind::List { count, .. }) => count.size(),
            })
            .sum()
    }

    /// Whether a property is a list, so that rows differ in length.
    pub(super) fn has_lists(&self) -> bool {
        self.properties.iter().any(|p| matches!(p.kind, Kind::List { .. }))
    }
}

pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Number of `comment` and `obj_info` lines, and of those that no keyword starts.
    pub comments: usize,
    /// What `comment TextureFile` names.
    pub texture: Option<String>,
    /// The byte that ends lines: `\n` (after a `\r` or not), or a lone `\r` as some exporters write.
    pub line_end: u8,
    /// Where the body starts: its byte, and its line.
    pub body: usize,
    pub body_line: u64,
}

/// Reads the header.
pub(super) fn read(source: &[u8]) -> Result<Header, Error> {
    let no_magic = || Error::malformed("a PLY file starts with a line 'ply', and this one does not");
    let after_magic = source.strip_prefix(b"ply").ok_or_else(no_magic)?;
    let blanks = after_magic.iter().take_while(|b| matches!(b, b' ' | b'\t')).count();
    let line_end = match &after_magic[blanks..] {
        [b'\n', ..] | [b'\r', b'\n', ..] => b'\n',
        [b'\r', ..] => b'\r',
        _ => return Err(no_magic()),
    };

    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let (mut comments, mut texture) = (0, None);
    let (mut at, mut line_number) = (0, 0);
    loop {
        if at >= source.len() {
            return Err(Error::malformed("the header has no 'end_header'"));
        }
        if at > LONGEST {
            return Err(Error::at_byte(at as u64, "the header has no 'end_header' in its first MiB"));
        }
        let rest = &source[at..];
        let length = rest.iter().take(LONGEST).position(|&b| b == line_end);
        let line = &rest[..length.unwrap_or(rest.len().min(LONGEST))];
        line_number += 1;
        at += line.len() + 1;

        let mut words = text::tokens(line, 0).map(|range| &line[range]);
        let wrong = |message: String| Error::at_line(line_number, message);
        match words.next() {
            None => {}
            Some(b"ply") if line_number == 1 => {}
            Some(b"comment" | b"obj_info") => {
                comments += 1;
                if words.next() == Some(b"TextureFile") {
                    let name = line.windows(11).position(|w| w == b"TextureFile").map_or(0, |n| n + 11);
                    texture = Some(String::from_utf8_lossy(line[name..].trim_ascii()).into_owned());
                }
            }
            Some(b"format") => {
                let word = words.next().unwrap_or(b"");
                if encoding.is_some() {
                    return Err(wrong("there is a second 'format' line".into()));
                }
                encoding = Some(match word {
                    b"ascii" => Encoding::Ascii,
                    b"binary_little_endian" => Encoding::Binary(ByteOrder::Little),
                    b"binary_big_endian" => Encoding::Binary(ByteOrder::Big),
                    _ => {
                        return Err(wrong(format!(
                            "expected format ascii, binary_little_endian or binary_big_endian, found {}",
                            text::quote(word)
                        )))
                    }
                });
                let version = words.next().unwrap_or(b"");
                if version != b"1.0" {
                    return Err(wrong(format!("expected PLY version 1.0, found {}", text::quote(version))));
                }
            }
            Some(b"element") => {
                let (name, count) = (words.next().unwrap_or(b""), words.next().unwrap_or(b""));
                let name = printable(name);
                let Some(count) = std::str::from_utf8(count).ok().and_then(|c| c.parse().ok()) else {
                    let shown = text::quote(count);
                    return Err(wrong(format!("expected 'element name count', found the count {shown}")));
                };
                // Of the others there may be several: all are carried over.
                let read = matches!(name.as_str(), "vertex" | "face" | "tristrips");
                if read && elements.iter().any(|e| e.name == name) {
                    return Err(wrong(format!("there is a second element '{name}'")));
                }
                elements.push(Element { name, count, properties: Vec::new() });
            }
            Some(b"property") => {
                let Some(element) = elements.last_mut() else {
                    return Err(wrong("a property stands before the first element".into()));
                };
                element.properties.push(property(words).map_err(wrong)?);
            }
            Some(b"end_header") => break,
            // A line of another program's own, which the format does not have.
            Some(_) if !may_describe(line) => comments += 1,
            Some(word) => {
                return Err(wrong(format!(
                    "expected format, comment, element, property or end_header, found {}",
                    text::quote(word)
                )))
            }
        }
    }
    let Some(encoding) = encoding else {
        return Err(Error::malformed("the header has no 'format' line"));
    };
    let body = at.min(source.len());
    Ok(Header { encoding, elements, comments, texture, line_end, body, body_line: line_number + 1 })
}

/// Whether a line that starts with no keyword may be a misspelt one that says what the body holds.
fn may_describe(line: &[u8]) -> bool {
    let words: Vec<&[u8]> = text::tokens(line, 0).map(|range| &line[range]).take(8).collect();
    let is_property = words[1..].iter().any(|word| *word == b"list" || Scalar::from_name(word).is_some());
    is_property || matches!(words[..], [_, _, count] if count.iter().all(u8::is_ascii_digit))
}

/// `float x` or `list uchar int vertex_indices`.
fn property<'a>(mut words: impl Iterator<Item = &'a [u8]>) -> Result<Property, String> {
    let mut word = || words.next().unwrap_or(b"");
    let scalar = |name| {
        Scalar::from_name(name).ok_or_else(|| {
            format!("expected a number type of PLY such as float or uchar, found {}", text::quote(name))
        })
    };
    let first = word();
    let kind = if first == b"list" {
        Kind::List { count: scalar(word())?, item: scalar(word())? }
    } else {
        Kind::Scalar(scalar(first)?)
    };
    match word() {
        b"" => Err("the property has no name".into()),
        name => Ok(Property { name: printable(name), kind }),
    }
}
