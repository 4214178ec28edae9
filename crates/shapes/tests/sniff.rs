//! Which format a file is taken for.

use neuralmls_shapes::{Format, Shape};

fn sniffed(bytes: &[u8], extension: &str) -> Result<Format, String> {
    Format::sniff(bytes, Some(extension).filter(|e| !e.is_empty())).map_err(|error| error.to_string())
}

fn binary_stl(triangles: u32) -> Vec<u8> {
    let mut bytes = b"solid that is binary".to_vec();
    bytes.resize(80, 0);
    bytes.extend(triangles.to_le_bytes());
    bytes.resize(84 + 50 * triangles as usize, 7);
    bytes
}

#[test]
fn content_tells_with_its_own_ending_another_case_or_none() {
    for (bytes, format) in [
        (&b"# c\nmtllib a.mtl\nv 0 0 0\n"[..], Format::Obj),
        (b"v 0 0 0", Format::Obj),
        (b"ply\r\nformat ascii 1.0\r\n", Format::Ply),
        (b"# c\nSTCNOFF\n", Format::Off),
        (b"OFF8 6 12\n", Format::Off),
        (b"OFF BINARY\n\0\0\0\x01", Format::Off),
        (b" solid a\nfacet normal 0 0 1\n", Format::Stl),
        (b"\xef\xbb\xbfsolid a\nfacet normal 0 0 1\n", Format::Stl),
        (&binary_stl(2), Format::Stl),
        (b"\n{ \"asset\": {\"version\": \"2.0\"} }", Format::Gltf),
        (b"glTF\x02\0\0\0", Format::Glb),
        (b"\x93NUMPY\x01\0", Format::Npy),
        (b"1 2 3\n", Format::Table),
        (b"# c\n// c\n1,2,3\n", Format::Table),
    ] {
        let own = format.extensions()[0];
        for extension in ["", own, &own.to_uppercase(), "bak"] {
            assert_eq!(sniffed(bytes, extension), Ok(format), "{extension} {}", bytes.escape_ascii());
        }
    }
}

#[test]
fn the_ending_tells_where_the_content_does_not() {
    assert_eq!(sniffed(b"# only a comment\n", "obj"), Ok(Format::Obj));
    assert_eq!(sniffed(b"# only a comment\n", "csv"), Ok(Format::Table));
    assert_eq!(sniffed(b"x,y,z\n1,2,3\n", "csv"), Ok(Format::Table));
    assert_eq!(sniffed(b"v g s\n1 2 3\n", "txt"), Ok(Format::Table));
    assert_eq!(sniffed(b"3 1 0\n0 0 0\n", "off"), Ok(Format::Off));
    assert_eq!(sniffed(b"solid\n", "stl"), Ok(Format::Stl));
    assert_eq!(sniffed(&[0; 90], "stl"), Ok(Format::Stl));
}

#[test]
fn another_content_than_the_ending_says_is_refused() {
    for (bytes, extension, sentence) in [
        (
            &b"ply\nformat binary_little_endian 1.0\n"[..],
            "obj",
            "this is a PLY file, not OBJ: rename it to .ply",
        ),
        (b"v 0 0 0\n", "ply", "this is an OBJ file, not PLY: rename it to .obj"),
        (b"v 0 0 0\n", "txt", "this is an OBJ file, not XYZ/CSV: rename it to .obj"),
        (b"0 0 0\n", "obj", "this is a table of numbers, not OBJ: rename it to .xyz"),
        (b"OFF\n", "stl", "this is an OFF file, not STL: rename it to .off"),
        (b"glTF\x02\0\0\0", "gltf", "this is a GLB file, not glTF: rename it to .glb"),
    ] {
        assert_eq!(sniffed(bytes, extension), Err(sentence.into()));
    }
}

#[test]
fn formats_that_are_not_read_are_named() {
    for (bytes, extension, sentence) in [
        (&b"PK\x03\x04abc"[..], "obj", "this is a zip archive, which is not read yet"),
        (b"PK\x03\x04..3D/3dmodel.model", "3mf", "this is a 3MF file, which is not read yet"),
        (b"LASF\0\0", "", "this is a LAS or LAZ point cloud, which is not read yet"),
        (b"ASTM-E57", "e57", "this is an E57 point cloud, which is not read yet"),
        (b"DRACO\x02\x02", "drc", "this is a Draco file, which is not read yet"),
        (b"# .PCD v.7\n", "pcd", "this is a PCD point cloud, which is not read yet"),
        (
            b"\x1f\x8b\x08",
            "obj",
            "this is compressed with gzip (as .gz and .spz files are), which is not read: unpack it first",
        ),
        (b"Kaydara FBX Binary  \0", "fbx", "this is an FBX file, which is not read yet"),
        (b"ISO-10303-21;\n", "step", "this is a STEP file, which is not read yet"),
        (b"# vtk DataFile Version 3.0\n", "vtk", "this is a VTK file, which is not read yet"),
        (b"\xff\xfev\0 \0", "obj", "this is UTF-16 text, which is not read: save it as UTF-8"),
        (b"\0v\0 \0\x31\0 \0\x31", "obj", "this is UTF-16 text, which is not read: save it as UTF-8"),
        (b"<?xml version='1.0'?>", "obj", "this is an XML file, which is not read yet"),
        (
            b"\xef\xbb\xbf<?xml version='1.0'?>\n<!-- <X3D> -->\n<COLLADA xmlns=''>",
            "dae",
            "this is a COLLADA (.dae) file, which is not read yet",
        ),
        (b"<X3D version='3.0'>", "x3d", "this is an X3D file, which is not read yet"),
        (b"<?xml version='1.0'?><amf unit='mm'>", "amf", "this is an AMF file, which is not read yet"),
        (b"<VTKFile type='PolyData'>", "vtp", "this is a VTK file (XML), which is not read yet"),
        (b"<!DOCTYPE PickedPoints>\n<PickedPoints>", "pp", "this is a list of points picked in MeshLab, not a shape"),
        (b"<!DOCTYPE html><html>", "obj", "this is an HTML page, not a shape"),
        (
            b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 7\n",
            "ply",
            "this is a Git LFS pointer, not the file itself: get that by 'git lfs pull'",
        ),
        (b"1 2 3\n", "pcd", "this is a PCD point cloud, which is not read yet"),
        (b"newmtl oak\n", "mtl", "this is a material library of an OBJ file, not a shape"),
        (b"", "obj", "the file is empty"),
        (b"{}", "json", "expected a shape file (OBJ, PLY, OFF, STL, glTF, GLB, XYZ/CSV, NPY), found an unknown one that ends in .json"),
        (b"\x7fELF", "", "expected a shape file (OBJ, PLY, OFF, STL, glTF, GLB, XYZ/CSV, NPY), found an unknown one that starts with '\\u{7f}ELF'"),
    ] {
        assert_eq!(sniffed(bytes, extension), Err(sentence.into()));
    }
}

#[test]
fn opening_is_telling_and_reading() {
    let none = |_: &str| Err("no side files here".to_string());
    let shape = Shape::open(b"0 0 0\n1 2 3\n".to_vec(), None, &none).unwrap();
    assert_eq!((shape.format(), shape.positions().len()), (Format::Table, 6));
    assert!(Shape::open(b"0 0 0\n".to_vec(), Some("obj"), &none).is_err());
}

#[test]
fn the_own_ending_of_a_file_is_one_of_those_that_it_may_have() {
    let none = |_: &str| Err("no side files here".to_string());
    let endings = |ending: Option<&str>| {
        let shape = Shape::open(b"0 0 0\n1 2 3\n".to_vec(), ending, &none).unwrap();
        shape.extensions().join(" ")
    };
    assert_eq!(endings(None), "xyz txt csv asc pts");
    assert_eq!(endings(Some("PTS")), "xyz txt csv asc pts");
    assert_eq!(endings(Some("Neu")), "xyz txt csv asc pts neu");
    // A file without an ending may be written as one without.
    assert_eq!(endings(Some("")), "xyz txt csv asc pts ");
}
