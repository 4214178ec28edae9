//! Files of every kind: bytes -> session, session -> text.
//!
//! | module | what |
//! |---|---|
//! | `json` | our own session files, version 2 and 1, and the editor's |
//! | `table` | CSV and its kin: ours, BigWarp's, OpenSim Creator's, CloudCompare's, NumPy's |
//! | `slicer` | 3D Slicer's `.mrk.json` and `.fcsv` |
//! | `picked_points` | MeshLab's `.pp` |
//! | `idav`, `land`, `tag`, `tps`, `morphologika`, `face_points` | morphometrics, neuroimaging, faces |
//! | `landmarks` | what they share: landmarks, some of them missing, become control points |

use crate::error::Error;
use crate::session::{Read, Session};

mod csv_text;
mod face_points;
mod idav;
mod join;
pub(crate) mod json;
mod land;
mod landmarks;
mod morphologika;
mod picked_points;
mod slicer;
mod table;
mod tag;
mod tps;

pub(crate) use csv_text::csv_text;
pub use join::join;
pub(crate) use json::json_text;

/// The one entry of metadata in a saved map.
pub(crate) const MAP_METADATA: &str = "neuralmls-map";

/// Whether bytes begin as those of a saved map do: a length, and a header with its metadata first.
fn is_map(bytes: &[u8]) -> bool {
    let start = format!("{{\"__metadata__\":{{\"{MAP_METADATA}\":");
    bytes.get(size_of::<u64>()..).is_some_and(|header| header.starts_with(start.as_bytes()))
}

/// Reads a control-point file or a landmark file of another tool: by its content, and by the ending of its name where the
/// content leaves it open.
///
/// # Errors
/// A file, where it cannot be read; control points, where they cannot be used.
pub fn read(bytes: &[u8], name: &str) -> Result<Read, Error> {
    if is_map(bytes) {
        return Err(Error::file(
            "this is a saved map, not control points: `neuralmls deform --map` takes it",
        ));
    }
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let at = error.valid_up_to();
        Error::file(format!("byte {at}: expected UTF-8 text, found 0x{:02x}", bytes[at]))
    })?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let start = text.trim_start();
    if start.is_empty() {
        return Err(Error::file("the file is empty"));
    }
    let first = start.lines().next().unwrap_or_default().trim_end();
    let ends = |ending: &str| name.to_ascii_lowercase().ends_with(ending);
    if first.starts_with("version https://git-lfs.github.com/spec/") {
        return Err(Error::file("this is a Git LFS pointer, not the file itself: `git lfs pull` gets it"));
    }
    if morphologika::is(text) && !ends(".json") {
        morphologika::read(text)
    } else if start.starts_with(['{', '[']) || ends(".json") {
        let document = json::parse(text)?;
        if slicer::is_markups(&document.value) {
            slicer::read_markups(document)
        } else {
            json::session_of(document)
        }
    } else if start.starts_with('<') {
        picked_points::read(text)
    } else if tag::is(first) {
        tag::read(text)
    } else if idav::is(first) {
        idav::read(text)
    } else if face_points::is(first) {
        face_points::read(text)
    } else if tps::is(first) {
        tps::read(text)
    } else if slicer::is_fiducials(text) || ends(".fcsv") {
        slicer::read_fiducials(text)
    } else if land::is(text) || ends(".land") {
        land::read(text)
    } else {
        table::read(text)
    }
}

impl Session {
    /// The text of a session file, version 2 (docs/session.schema.json). Reading it gives the same session, bit for bit.
    pub fn to_json(&self) -> String {
        json_text(self)
    }

    /// The text of a landmark file: names, positions, targets. Settings are no part of it.
    ///
    /// # Errors
    /// A file, where there are orientations, which it cannot hold.
    pub fn to_csv(&self) -> Result<String, Error> {
        csv_text(self)
    }
}
