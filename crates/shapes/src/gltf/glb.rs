//! The container of binary glTF: a header of 12 bytes, then chunks (length, type, data), JSON first and BIN second.

use std::ops::Range;

use crate::error::Error;
use crate::memory;

const JSON: u32 = 0x4E4F_534A;
const BIN: u32 = 0x004E_4942;

/// Where things are in a GLB file.
pub(super) struct Glb {
    /// The data of the JSON chunk.
    json: Range<usize>,
    /// The data of the BIN chunk.
    pub bin: Option<Range<usize>>,
    /// Where the file ends by its header; what follows is carried over.
    end: usize,
    /// All chunks in file order, each with its 8 bytes of header.
    chunks: Vec<Range<usize>>,
}

impl Glb {
    /// The JSON without what fills up the chunk; some writers fill with zeros instead of spaces.
    pub fn text<'a>(&self, source: &'a [u8]) -> &'a [u8] {
        let text = &source[self.json.clone()];
        let end = text.iter().rposition(|b| *b != 0 && !b.is_ascii_whitespace()).map_or(0, |last| last + 1);
        &text[..end]
    }
}

fn u32_at(source: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(source.get(at..at.checked_add(4)?)?.try_into().ok()?))
}

/// Finds the chunks of a GLB file.
pub(super) fn split(source: &[u8]) -> Result<Glb, Error> {
    if !source.starts_with(b"glTF") {
        return Err(Error::at_byte(0, "a GLB file starts with \"glTF\", this one does not"));
    }
    let (Some(version), Some(length)) = (u32_at(source, 4), u32_at(source, 8)) else {
        return Err(Error::at_byte(source.len() as u64, "the GLB header of 12 bytes is cut off"));
    };
    if version != 2 {
        return Err(Error::unsupported(format!("this is GLB version {version}, only version 2 is read")));
    }
    let end = length as usize;
    if end > source.len() {
        let found = source.len();
        return Err(Error::at_byte(8, format!("the header claims {end} bytes, the file has {found}")));
    }
    let mut glb = Glb { json: 0..0, bin: None, end, chunks: Vec::new() };
    let mut at = 12;
    while at < end {
        let cut = || Error::at_byte(at as u64, "a chunk goes beyond the end of the file");
        let data = at + 8;
        let size = u32_at(&source[..end], at).ok_or_else(cut)? as usize;
        let kind = u32_at(&source[..end], at + 4).ok_or_else(cut)?;
        if size > end.saturating_sub(data) {
            return Err(cut());
        }
        match kind {
            JSON if glb.chunks.is_empty() => glb.json = data..data + size,
            _ if glb.chunks.is_empty() => {
                return Err(Error::at_byte(at as u64, "the first chunk is not JSON"))
            }
            BIN if glb.bin.is_none() => glb.bin = Some(data..data + size),
            _ => {}
        }
        glb.chunks.push(at..data + size);
        at = data + size;
    }
    if glb.chunks.is_empty() {
        return Err(Error::at_byte(12, "the JSON chunk is missing"));
    }
    Ok(glb)
}

/// The file with another JSON text or other BIN data; `None` stays as it was.
pub(super) fn join(
    glb: &Glb,
    source: &[u8],
    json: Option<&[u8]>,
    bin: Option<&[u8]>,
) -> Result<Vec<u8>, Error> {
    let new = [json, bin].into_iter().flatten().map(|bytes| bytes.len() + 8).sum::<usize>();
    let mut out = memory::with_room(source.len() + new)?;
    out.extend_from_slice(&source[..12]);
    for chunk in &glb.chunks {
        let data = chunk.start + 8..chunk.end;
        let (kind, new, filler) = if data == glb.json {
            (JSON, json, b' ')
        } else if Some(&data) == glb.bin.as_ref() {
            (BIN, bin, 0)
        } else {
            (0, None, 0)
        };
        let Some(new) = new else {
            out.extend_from_slice(&source[chunk.clone()]);
            continue;
        };
        let padded = new.len().next_multiple_of(4);
        out.extend_from_slice(&length(padded)?);
        out.extend_from_slice(&kind.to_le_bytes());
        out.extend_from_slice(new);
        out.resize(out.len() + padded - new.len(), filler);
    }
    let total = length(out.len())?;
    out[8..12].copy_from_slice(&total);
    out.extend_from_slice(&source[glb.end..]);
    Ok(out)
}

fn length(n: usize) -> Result<[u8; 4], Error> {
    let n =
        u32::try_from(n).map_err(|_| Error::unsupported("the result does not fit the 4 GB of a GLB file"))?;
    Ok(n.to_le_bytes())
}
