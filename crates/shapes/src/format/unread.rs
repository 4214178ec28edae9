//! Files of formats that are known but not read: what to call them.

use crate::text::bom_length;

/// What they begin with.
const BEGINNINGS: [(&[u8], &str); 33] = [
    (b"DRACO", "a Draco file"),
    (b"OMT", "an OpenMesh OM file"),
    (b"OMQ", "an OpenMesh OM file"),
    (b"OMP", "an OpenMesh OM file"),
    (b"OCTM", "an OpenCTM file"),
    (b"LASF", "a LAS or LAZ point cloud"),
    (b"ASTM-E57", "an E57 point cloud"),
    (b"# .PCD", "a PCD point cloud"),
    (b"VERSION .7\n", "a PCD point cloud"),
    (b"VERSION 0.7\n", "a PCD point cloud"),
    (b"Kaydara FBX Binary", "an FBX file"),
    (b"; FBX", "an FBX file"),
    (b"# vtk DataFile", "a VTK file"),
    (b"$MeshFormat", "a Gmsh file"),
    (b"MeshVersionFormatted", "a Medit .mesh file"),
    (b"BLENDER", "a Blender file"),
    (b"ISO-10303-21", "a STEP file"),
    (b"DBRep_DrawableShape", "an OpenCASCADE BREP file"),
    (b"3D Geometry File Format", "a Rhino 3DM file"),
    (b"#VRML", "a VRML file"),
    (b"PXR-USDC", "a USD file"),
    (b"#usda", "a USD file"),
    (b"Ogawa", "an Alembic file"),
    (b"\x89HDF", "an HDF5 file"),
    (b"CDF\x01", "a NetCDF file"),
    (b"CDF\x02", "a NetCDF file"),
    (b"//Maya ASCII", "a Maya file"),
    (b"FOR4", "a Maya file"),
    (b"\xff\xff\xfe", "a FreeSurfer surface"),
    (b"MM\0", "a 3DS file"),
    (b"\x89PNG", "a PNG image, not a shape"),
    (b"\xff\xd8\xff", "a JPEG image, not a shape"),
    (b"%PDF", "a PDF file, not a shape"),
];

/// The endings of those whose content does not tell.
const ENDINGS: [(&str, &str); 9] = [
    ("spz", "an .spz file of Gaussian splats (their PLY files are read)"),
    ("splat", "a .splat file of Gaussian splats (their PLY files are read)"),
    ("ksplat", "a .ksplat file of Gaussian splats (their PLY files are read)"),
    ("pcd", "a PCD point cloud"),
    ("drc", "a Draco file"),
    ("om", "an OpenMesh OM file"),
    ("igs", "an IGES file"),
    ("iges", "an IGES file"),
    ("npz", "an NPZ archive"),
];

/// The root elements of XML formats, in lower case.
const ROOTS: [(&[u8], &str); 10] = [
    (b"collada", "a COLLADA (.dae) file"),
    (b"x3d", "an X3D file"),
    (b"amf", "an AMF file"),
    (b"vtkfile", "a VTK file (XML)"),
    (b"gifti", "a GIFTI surface"),
    (b"model", "the inside of a 3MF file"),
    (b"svg", "an SVG drawing, not a shape"),
    (b"kml", "a KML file"),
    (b"html", "an HTML page, not a shape"),
    (b"pickedpoints", "a list of points picked in MeshLab, not a shape"),
];

/// What zip archives hold, by the name of a member.
const MEMBERS: [(&[u8], &str); 4] = [
    (b"3D/", "a 3MF file"),
    (b".npy", "an NPZ archive"),
    (b".usd", "a USDZ file"),
    (b"word/", "a Word document, not a shape"),
];

fn not_yet(what: &str) -> String {
    let is_none = what.ends_with("not a shape");
    if is_none {
        format!("this is {what}")
    } else {
        format!("this is {what}, which is not read yet")
    }
}

/// What is wrong with content that is surely of a format that we do not read.
pub(super) fn by_content(bytes: &[u8]) -> Option<String> {
    if let Some(pointer) = git_lfs_pointer(bytes) {
        return Some(pointer);
    }
    if bytes.starts_with(b"\x1f\x8b") {
        return Some(
            "this is compressed with gzip (as .gz and .spz files are), which is not read: unpack it first"
                .into(),
        );
    }
    if is_utf16(bytes) {
        return Some("this is UTF-16 text, which is not read: save it as UTF-8".into());
    }
    if let Some((_, what)) = BEGINNINGS.iter().find(|(start, _)| bytes.starts_with(start)) {
        return Some(not_yet(what));
    }
    if bytes.starts_with(b"PK\x03\x04") {
        let beginning = &bytes[..bytes.len().min(4096)];
        let has = |name: &[u8]| memchr::memmem::find(beginning, name).is_some();
        let what = MEMBERS.iter().find(|(name, _)| has(name)).map_or("a zip archive", |(_, what)| what);
        return Some(not_yet(what));
    }
    xml(&bytes[bom_length(bytes)..])
}

/// What is wrong with files of an ending that we know and do not read.
pub(super) fn by_ending(extension: Option<&str>) -> Option<String> {
    if extension == Some("mtl") {
        return Some("this is a material library of an OBJ file, not a shape".into());
    }
    ENDINGS.iter().find(|(ending, _)| extension == Some(ending)).map(|(_, what)| not_yet(what))
}

/// What is wrong with the few lines that Git LFS leaves in the place of a file that was not fetched.
pub(crate) fn git_lfs_pointer(bytes: &[u8]) -> Option<String> {
    let is_one = bytes[bom_length(bytes)..].starts_with(b"version https://git-lfs.github.com/spec/");
    is_one.then(|| "this is a Git LFS pointer, not the file itself: get that by 'git lfs pull'".into())
}

/// XML, by its first element.
fn xml(text: &[u8]) -> Option<String> {
    let mut rest = text[..text.len().min(1 << 16)].trim_ascii_start();
    let starts = |rest: &[u8]| {
        rest.first() == Some(&b'<')
            && rest.get(1).is_some_and(|&b| b.is_ascii_alphabetic() || b == b'?' || b == b'!')
    };
    if !starts(rest) {
        return None;
    }
    if rest.get(..14).is_some_and(|start| start.eq_ignore_ascii_case(b"<!DOCTYPE html")) {
        return Some(not_yet("an HTML page, not a shape"));
    }
    // Behind declarations and comments.
    while let Some(end) = [(&b"<?"[..], &b"?>"[..]), (b"<!--", b"-->"), (b"<!", b">")]
        .iter()
        .find(|(start, _)| rest.starts_with(start))
        .and_then(|(_, end)| Some(memchr::memmem::find(rest, end)? + end.len()))
    {
        rest = rest[end..].trim_ascii_start();
    }
    let name: Vec<u8> = rest
        .strip_prefix(b"<")
        .unwrap_or_default()
        .iter()
        .take_while(|b| b.is_ascii_alphanumeric() || matches!(b, b'_' | b':'))
        .map(u8::to_ascii_lowercase)
        .collect();
    let what = ROOTS.iter().find(|(root, _)| *root == name).map_or("an XML file", |(_, what)| what);
    Some(not_yet(what))
}

/// A byte order mark of UTF-16, or text with a zero at every second byte.
fn is_utf16(bytes: &[u8]) -> bool {
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return true;
    }
    let start = &bytes[..bytes.len().min(32)];
    let half_is_text = |zeros: usize| {
        start.iter().enumerate().all(|(i, &b)| if i % 2 == zeros { b == 0 } else { b.is_ascii() && b != 0 })
    };
    start.len() >= 8 && (half_is_text(0) || half_is_text(1))
}
