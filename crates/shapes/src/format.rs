//! Which format is a file? By its content first, by its ending where the content does not say.

mod sniff;
mod unread;

use crate::error::Error;

pub(crate) use unread::git_lfs_pointer;

/// The formats that this crate reads and writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// Wavefront OBJ.
    Obj,
    /// Stanford PLY, ascii and binary.
    Ply,
    /// Geomview OFF and its relatives COFF, NOFF, STOFF.
    Off,
    /// STL, ascii and binary.
    Stl,
    /// glTF 2 as JSON with its buffers beside it or embedded.
    Gltf,
    /// glTF 2 as one binary file.
    Glb,
    /// A table of numbers as text: XYZ, TXT, CSV, ASC, PTS.
    Table,
    /// A NumPy array.
    Npy,
}

impl Format {
    /// All of them.
    pub const ALL: [Format; 8] = [
        Format::Obj,
        Format::Ply,
        Format::Off,
        Format::Stl,
        Format::Gltf,
        Format::Glb,
        Format::Table,
        Format::Npy,
    ];

    /// The endings that stand for it, without the dot, in lower case.
    pub fn extensions(self) -> &'static [&'static str] {
        match self {
            Format::Obj => &["obj"],
            Format::Ply => &["ply"],
            Format::Off => &["off"],
            Format::Stl => &["stl"],
            Format::Gltf => &["gltf"],
            Format::Glb => &["glb"],
            Format::Table => &["xyz", "txt", "csv", "asc", "pts"],
            Format::Npy => &["npy"],
        }
    }

    /// Its name for a person.
    pub fn name(self) -> &'static str {
        match self {
            Format::Obj => "OBJ",
            Format::Ply => "PLY",
            Format::Off => "OFF",
            Format::Stl => "STL",
            Format::Gltf => "glTF",
            Format::Glb => "GLB",
            Format::Table => "XYZ/CSV",
            Format::Npy => "NPY",
        }
    }

    /// The format of an ending such as `"obj"` or `"PLY"` (no dot).
    pub fn from_extension(extension: &str) -> Option<Format> {
        let extension = extension.to_ascii_lowercase();
        Format::ALL.into_iter().find(|f| f.extensions().contains(&extension.as_str()))
    }

    /// The format of a file by its first bytes, and by its ending (no dot) where they do not say.
    ///
    /// ```
    /// use neuralmls_shapes::Format;
    /// assert_eq!(Format::sniff(b"v 0 0 0\n", None), Ok(Format::Obj));
    /// let error = Format::sniff(b"ply\nformat ascii 1.0\n", Some("obj")).unwrap_err();
    /// assert_eq!(error.to_string(), "this is a PLY file, not OBJ: rename it to .ply");
    /// ```
    ///
    /// # Errors
    /// For an empty file, for one whose content is surely of another format than its ending says, for formats that this crate
    /// knows but does not read, and where neither content nor ending tells.
    pub fn sniff(bytes: &[u8], extension: Option<&str>) -> Result<Format, Error> {
        sniff::sniff(bytes, extension)
    }
}
