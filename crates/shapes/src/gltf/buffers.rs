//! The bytes that a glTF file refers to: embedded as `data:` URIs, in files beside it, or in the BIN chunk of a GLB.

use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use base64::Engine;

use super::json::At;
use crate::document::SideFiles;
use crate::error::Error;
use crate::format;
use crate::memory;

/// Base64 as exporters write it: with padding or without.
pub(super) const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// Where bytes come from and go back to.
#[derive(PartialEq, Eq)]
pub(super) enum Origin {
    /// The BIN chunk of a GLB.
    Bin,
    /// A `data:` URI: what it starts with, up to and including the comma, when written as base64.
    Embedded(String),
    /// A file beside this one, by its path.
    File(String),
}

pub(super) struct Storage {
    pub origin: Origin,
    pub bytes: Vec<u8>,
}

/// A buffer of the file: the first `length` bytes of a storage. Buffers that name the same file share one.
pub(super) struct Buffer {
    pub storage: usize,
    pub length: usize,
}

pub(super) struct Buffers {
    pub buffers: Vec<Buffer>,
    pub storages: Vec<Storage>,
}

impl Buffers {
    /// Loads every buffer of the file.
    pub fn load(root: &At<'_>, bin: Option<&[u8]>, side_files: &SideFiles<'_>) -> Result<Buffers, Error> {
        let mut all = Buffers { buffers: Vec::new(), storages: Vec::new() };
        for (i, at) in root.items("buffers")?.iter().enumerate() {
            let length = at.need("byteLength")?;
            let storage = match at.get("uri")? {
                Some(uri) => all.storage_of(&uri, side_files)?,
                None => {
                    let Some(bin) = bin.filter(|_| i == 0) else {
                        return Err(at.error("\"uri\" is missing, and no BIN chunk holds the bytes"));
                    };
                    all.storages.push(Storage { origin: Origin::Bin, bytes: memory::copy(bin)? });
                    all.storages.len() - 1
                }
            };
            let (claimed, found) = (length.uint()?, all.storages[storage].bytes.len());
            if claimed > found {
                return Err(length.error(format!("{claimed} bytes are claimed, there are {found}")));
            }
            all.buffers.push(Buffer { storage, length: claimed });
        }
        Ok(all)
    }

    fn storage_of(&mut self, uri: &At<'_>, side_files: &SideFiles<'_>) -> Result<usize, Error> {
        let text = uri.string()?;
        let new = if text.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:")) {
            let (head, data) =
                text.split_once(',').ok_or_else(|| uri.error("a data: URI without a comma"))?;
            memory::expect(data.len())?;
            if head.to_ascii_lowercase().ends_with(";base64") {
                let bytes = BASE64.decode(data).map_err(|e| uri.error(format!("not base64: {e}")))?;
                Storage { origin: Origin::Embedded(format!("{head},")), bytes }
            } else {
                let bytes = percent_decoded(data);
                Storage { origin: Origin::Embedded(format!("{head};base64,")), bytes }
            }
        } else {
            let path = relative_path(uri)?;
            let origin = Origin::File(path);
            if let Some(known) = self.storages.iter().position(|s| s.origin == origin) {
                return Ok(known);
            }
            let Origin::File(path) = &origin else { unreachable!() };
            let bytes =
                side_files(path).map_err(|why| Error::side_file(format!("{}: {path:?}: {why}", uri.path)))?;
            if let Some(pointer) = format::git_lfs_pointer(&bytes) {
                return Err(Error::side_file(format!("{}: {path:?}: {pointer}", uri.path)));
            }
            Storage { origin, bytes }
        };
        self.storages.push(new);
        Ok(self.storages.len() - 1)
    }
}

/// The path that a URI names, if it stays in the file's own folder.
fn relative_path(uri: &At<'_>) -> Result<String, Error> {
    let text = uri.string()?;
    let refuse = |why: &str| Err(uri.error(format!("{text:?} {why}")));
    let Ok(path) = String::from_utf8(percent_decoded(text)) else { return refuse("is not UTF-8") };
    if path.is_empty() || path.contains('\0') {
        return refuse("is not a path");
    }
    let first = path.split(['/', '\\']).next().unwrap_or_default();
    if first.is_empty() || first.contains(':') {
        return refuse("is not a path relative to the file, others are not read");
    }
    let mut depth = 0i64;
    for part in path.split(['/', '\\']) {
        depth += match part {
            ".." => -1,
            "" | "." => 0,
            _ => 1,
        };
        if depth < 0 {
            return refuse("leaves the folder of the file, that is not read");
        }
    }
    Ok(path)
}

pub(super) fn percent_decoded(text: &str) -> Vec<u8> {
    let bytes = text.as_bytes();
    let hex = |at: usize| bytes.get(at).and_then(|b| (*b as char).to_digit(16)).map(|d| d as u8);
    let (mut out, mut at) = (Vec::with_capacity(bytes.len()), 0);
    while at < bytes.len() {
        match (bytes[at], hex(at + 1), hex(at + 2)) {
            (b'%', Some(high), Some(low)) => {
                out.push(16 * high + low);
                at += 3;
            }
            (byte, ..) => {
                out.push(byte);
                at += 1;
            }
        }
    }
    out
}

/// A file name as a URI: what is not a letter, a digit or one of `-._~` is encoded.
pub(super) fn percent_encoded(name: &str) -> String {
    let plain = |b: &u8| b.is_ascii_alphanumeric() || b"-._~".contains(b);
    name.bytes().map(|b| if plain(&b) { char::from(b).to_string() } else { format!("%{b:02X}") }).collect()
}
