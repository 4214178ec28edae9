//! Telling a file's format by its first bytes.

use super::{unread, Format};
use crate::error::Error;
use crate::number;
use crate::text::{bom_length, quote, tokens, Lines};

/// Statements that a Wavefront OBJ file may begin with.
const OBJ_STATEMENTS: [&[u8]; 14] =
    [b"v", b"vn", b"vt", b"vp", b"f", b"l", b"p", b"o", b"g", b"s", b"mtllib", b"usemtl", b"cstype", b"deg"];

/// See [`Format::sniff`].
pub(super) fn sniff(bytes: &[u8], extension: Option<&str>) -> Result<Format, Error> {
    if bytes.is_empty() {
        return Err(Error::malformed("the file is empty"));
    }
    let extension = extension.map(|e| e.trim_start_matches('.').to_ascii_lowercase());
    let extension = extension.as_deref().filter(|e| !e.is_empty());
    let named = extension.and_then(Format::from_extension);
    if let Some(what) = unread::by_content(bytes) {
        return Err(Error::unsupported(what));
    }
    let found = by_content(bytes, named);
    match (found, named) {
        // Numbers alone may be the content of a format that is not read.
        (Some(Format::Table), None) if unread::by_ending(extension).is_some() => {
            Err(unknown(bytes, extension))
        }
        (Some(found), Some(named)) if found != named => Err(Error::malformed(format!(
            "this is {}, not {}: rename it to .{}",
            with_article(found),
            named.name(),
            found.extensions()[0]
        ))),
        (Some(found), _) => Ok(found),
        (None, Some(named)) => Ok(named),
        (None, None) => Err(unknown(bytes, extension)),
    }
}

fn with_article(format: Format) -> &'static str {
    match format {
        Format::Obj => "an OBJ file",
        Format::Ply => "a PLY file",
        Format::Off => "an OFF file",
        Format::Stl => "an STL file",
        Format::Gltf => "a glTF file",
        Format::Glb => "a GLB file",
        Format::Table => "a table of numbers",
        Format::Npy => "an NPY file",
    }
}

/// The sentence for a file that is nothing that we know.
fn unknown(bytes: &[u8], extension: Option<&str>) -> Error {
    if let Some(what) = unread::by_ending(extension) {
        return Error::unsupported(what);
    }
    let known = Format::ALL.map(Format::name).join(", ");
    Error::unsupported(match extension {
        Some(ending) => {
            format!(
                "expected a shape file ({known}), found an unknown one that ends in .{}",
                ending.escape_debug()
            )
        }
        None => format!(
            "expected a shape file ({known}), found an unknown one that starts with {}",
            quote(&bytes[..bytes.len().min(8)])
        ),
    })
}

/// The format that the content is surely of.
fn by_content(bytes: &[u8], named: Option<Format>) -> Option<Format> {
    if bytes.starts_with(b"glTF") {
        return Some(Format::Glb);
    }
    if bytes.starts_with(b"\x93NUMPY") {
        return Some(Format::Npy);
    }
    if bytes.starts_with(b"ply") && bytes.get(3).is_some_and(u8::is_ascii_whitespace) {
        return Some(Format::Ply);
    }
    if is_binary_stl(bytes) || is_ascii_stl(bytes) {
        return Some(Format::Stl);
    }
    let beginning = &bytes[..bytes.len().min(4096)];
    let text = beginning[bom_length(bytes)..].trim_ascii_start();
    if text.starts_with(b"{") {
        let is_gltf = named == Some(Format::Gltf) || memchr::memmem::find(bytes, b"\"asset\"").is_some();
        return is_gltf.then_some(Format::Gltf);
    }
    if beginning.contains(&0) {
        // Refused by its reader, which knows why.
        return text.starts_with(b"OFF BINARY").then_some(Format::Off);
    }
    by_first_statement(bytes, named)
}

/// The length of a binary STL follows from the number of triangles at byte 80.
fn is_binary_stl(bytes: &[u8]) -> bool {
    let Some(count) = bytes.get(80..84) else { return false };
    let count = u32::from_le_bytes(count.try_into().expect("four bytes"));
    bytes.len() as u64 == 84 + 50 * u64::from(count)
}

fn is_ascii_stl(bytes: &[u8]) -> bool {
    let start = bytes[bom_length(bytes)..bytes.len().min(2048)].trim_ascii_start().to_ascii_lowercase();
    let keyword_ends = start.get(5).is_none_or(u8::is_ascii_whitespace);
    start.starts_with(b"solid")
        && keyword_ends
        && [&b"facet"[..], b"endsolid"].iter().any(|word| memchr::memmem::find(&start, word).is_some())
}

/// Text formats, by the first line that is neither blank nor a comment.
fn by_first_statement(bytes: &[u8], named: Option<Format>) -> Option<Format> {
    let is_comment = |line: &[u8]| line.is_empty() || line.starts_with(b"#") || line.starts_with(b"//");
    let line = Lines::new(bytes).map(|line| line.bytes.trim_ascii()).find(|line| !is_comment(line))?;
    let words = || tokens(line, 0).map(|range| &line[range]);
    let first = words().next()?;
    if crate::off::split_header(line).is_some() {
        return Some(Format::Off);
    }
    let numbers = words().skip(1).take_while(|word| number::parse(word).is_some()).count();
    if OBJ_STATEMENTS.contains(&first) {
        // A table may have a header line such as "v g s"; only OBJ has numbers behind "v", or the ending.
        let surely = numbers > 0 || matches!(first, b"mtllib" | b"usemtl" | b"o" | b"g");
        return (surely && named != Some(Format::Table) || numbers >= 3 && matches!(first, b"v" | b"vn"))
            .then_some(Format::Obj);
    }
    let is_number = |field: &[u8]| number::parse(field.trim_ascii()).is_some();
    let is_row =
        line.split(|&b| matches!(b, b',' | b';' | b' ' | b'\t')).filter(|f| !f.is_empty()).all(is_number);
    // An OFF file may lack its header.
    (is_row && named != Some(Format::Off)).then_some(Format::Table)
}
