//! PLY: what is read, what is carried over, what is refused.

mod files;

use files::{bent, check_data_files, read, refusal, same_words};
use neuralmls_shapes::{Format, Shape};
use proptest::prelude::*;

fn ply(bytes: &[u8]) -> Shape {
    read(bytes, Format::Ply).unwrap_or_else(|error| panic!("{error}"))
}

fn refused(bytes: &[u8]) -> String {
    refusal(bytes, Format::Ply)
}

fn fact(shape: &Shape, what: &str) -> String {
    let found = shape.facts().iter().find(|(name, _)| name == what);
    found.unwrap_or_else(|| panic!("no fact {what} in {:?}", shape.facts())).1.clone()
}

/// The shape's file with coordinate `at` set.
fn with(shape: &Shape, at: usize, value: f64) -> Vec<u8> {
    let mut positions = shape.positions().to_vec();
    positions[at] = value;
    shape.write(&positions, None).unwrap().bytes
}

#[test]
fn lines_of_the_header_that_no_keyword_starts_are_carried_over() {
    let text = |line: &str| {
        format!("ply\nformat ascii 1.0\n{line}\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n{line}\nend_header\n0 0 0\n")
    };
    for line in [
        "Created by Blender3D 247 - www.blender.org, source file: ",
        "vcg 1",
        "  author",
        "made 7 times over",
    ] {
        let shape = ply(text(line).as_bytes());
        assert_eq!(fact(&shape, "comments"), "2");
        assert_eq!(with(&shape, 0, 1.5), text(line).replace("0 0 0", "1.5 0 0").as_bytes());
    }
    // What may be a misspelt element or property says what follows.
    for line in ["elemnt face 12", "propery float nx", "prop list uchar int vertex_indices"] {
        assert!(
            refused(text(line).as_bytes()).starts_with("line 3: expected format, comment, element,"),
            "{line}"
        );
    }
}

#[test]
fn the_texture_is_a_file_that_goes_along() {
    assert_eq!(ply(ODD).named_files(), ["wood.png"]);
    assert_eq!(ply(ODD).missing_files(&|_| false), ["wood.png"]);
}

const ODD: &[u8] = b"ply\r\n\
format ascii 1.0\r\n\
comment a square, and more than a square\r\n\
comment TextureFile wood.png\r\n\
obj_info from nowhere\r\n\
element face 2\r\n\
property uchar red\r\n\
property list uchar int vertex_indices\r\n\
property list uchar float texcoord\r\n\
element vertex 5\r\n\
property list uchar int tags\r\n\
property float z\r\n\
property uchar red\r\n\
property double x\r\n\
property float y\r\n\
element edge 1\r\n\
property int vertex1\r\n\
property int vertex2\r\n\
end_header\r\n\
255 4 0 1 2 3 2 0.5 0.5\r\n\
  0 3 0 1 4 0\r\n\
0 0.0 10 0.00 0.0\r\n\
2 7 8 0 20 1 0\r\n\
\r\n\
1 9\t0 30 1.0   1\r\n\
0 0 40 0 +1\r\n\
0 1e0 50 .5 5e-1\r\n\
0 4\r\n\
something behind";

#[test]
fn reads_elements_in_any_order_with_lists_anywhere() {
    let shape = ply(ODD);
    assert_eq!(shape.positions(), [0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0., 0.5, 0.5, 1.]);
    assert_eq!(shape.faces().unwrap(), [[0, 1, 2], [0, 2, 3], [0, 1, 4]]);
    assert_eq!(fact(&shape, "faces"), "2 (1 triangles, 1 quads)");
    assert_eq!(fact(&shape, "texture"), "wood.png");
    assert_eq!(fact(&shape, "element"), "1 edge: vertex1, vertex2 (carried over)");
    assert!(fact(&shape, "vertex properties").contains("tags"));
}

#[test]
fn an_unmoved_file_is_the_same_bytes() {
    let shape = ply(ODD);
    assert_eq!(shape.write(shape.positions(), None).unwrap().bytes, ODD);
}

#[test]
fn a_moved_coordinate_changes_its_token_and_nothing_else() {
    let text = String::from_utf8(ODD.to_vec()).unwrap();
    let expected = text.replace("1 9\t0 30 1.0   1\r\n", "1 9\t0.125 30 1.0   1\r\n");
    assert_ne!(expected, text);
    assert_eq!(String::from_utf8(with(&ply(ODD), 8, 0.125)).unwrap(), expected);
}

/// A quad with a list in each vertex, normals, and bytes behind the end, in both byte orders.
fn binary(big_endian: bool) -> Vec<u8> {
    let order = if big_endian { "big" } else { "little" };
    let mut bytes = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement vertex 4\nproperty double x\nproperty list ushort char tags\n\
         property float32 y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty uint id\n\
         element face 1\nproperty list uint16 uint32 vertex_index\nproperty uchar red\nend_header\n"
    )
    .into_bytes();
    let mut put = |number: &[u8]| {
        // Numbers come as little endian.
        if big_endian {
            bytes.extend(number.iter().rev());
        } else {
            bytes.extend(number);
        }
    };
    for (k, [x, y]) in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].into_iter().enumerate() {
        put(&f64::to_le_bytes(x));
        put(&(k as u16).to_le_bytes());
        for _ in 0..k {
            put(&[200]);
        }
        for value in [y, 0.25, 0.0, 0.0, 1.0] {
            put(&f32::to_le_bytes(value as f32));
        }
        put(&(1000 + k as u32).to_le_bytes());
    }
    put(&4u16.to_le_bytes());
    for k in 0..4u32 {
        put(&k.to_le_bytes());
    }
    put(&[77]);
    bytes.extend(b"tail");
    bytes
}

#[test]
fn both_byte_orders_read_the_same() {
    let (little, big) = (ply(&binary(false)), ply(&binary(true)));
    assert_eq!(little.positions(), [0., 0., 0.25, 1., 0., 0.25, 1., 1., 0.25, 0., 1., 0.25]);
    assert_eq!(little.faces().unwrap(), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(big.positions(), little.positions());
    assert_eq!(big.faces(), little.faces());
    assert!(little.has_normals());
    assert_eq!(fact(&big, "encoding"), "binary, big endian");
    assert_eq!(fact(&big, "behind the last element"), "4 bytes (carried over)");
}

#[test]
fn a_moved_binary_vertex_changes_its_fields_and_nothing_else() {
    for big_endian in [false, true] {
        let bytes = binary(big_endian);
        let shape = ply(&bytes);
        let identity: Vec<f64> = [1., 0., 0., 0., 1., 0., 0., 0., 1.].repeat(4);
        let mut positions = shape.positions().to_vec();
        positions[7] = 3.5; // y of vertex 2
        let written = shape.write(&positions, Some(&identity)).unwrap().bytes;
        let changed: Vec<usize> = (0..bytes.len()).filter(|&i| bytes[i] != written[i]).collect();
        // Rows are 8 + 2 + k + 5 * 4 + 4 bytes; y stands behind x and the list.
        let body = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
        let y = body + 34 + 35 + 8 + 2 + 2;
        assert!(!changed.is_empty() && changed.iter().all(|at| (y..y + 4).contains(at)), "{changed:?} {y}");
        assert_eq!(ply(&written).positions(), positions);
    }
}

#[test]
fn normals_turn_with_the_surface_and_other_fields_stay() {
    let quarter_about_x = [1., 0., 0., 0., 0., -1., 0., 1., 0.];
    for bytes in [binary(false), binary(true)] {
        let shape = ply(&bytes);
        let rotated: Vec<f64> = shape.positions().chunks(3).flat_map(|p| [p[0], -p[2], p[1]]).collect();
        for maps in [Some(quarter_about_x.repeat(4)), None] {
            let written = shape.write(&rotated, maps.as_deref()).unwrap().bytes;
            assert_eq!(ply(&written).positions(), rotated);
            let big_endian = bytes.windows(3).any(|w| w == b"big");
            let body = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
            let normal: Vec<f32> = (0..3)
                .map(|k| written[body + 18 + 4 * k..][..4].try_into().unwrap())
                .map(|b| if big_endian { f32::from_be_bytes(b) } else { f32::from_le_bytes(b) })
                .collect();
            let off: f32 = normal.iter().zip([0.0, -1.0, 0.0]).map(|(a, b)| (a - b).abs()).sum();
            assert!(off < 1e-6, "{normal:?}");
        }
    }
    let text =
        b"ply\nformat ascii 1.0\nelement vertex 2\nproperty float nx\nproperty float ny\nproperty float nz\n\
        property float x\nproperty float y\nproperty float z\nend_header\n0 0 1 0 0 0\nnan 0 1 0 1 0\n";
    let written = ply(text).write(&[0., 0., 0., 0., 0., 1.], Some(&quarter_about_x.repeat(2))).unwrap().bytes;
    assert!(
        written.ends_with(b"end_header\n0 -1 0 0 0 0\nnan 0 1 0 0 1\n"),
        "{}",
        String::from_utf8_lossy(&written)
    );
}

#[test]
fn incomplete_normals_are_carried_over() {
    let shape = ply(
        b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
        property float nx\nproperty float ny\nend_header\n0 0 0 1 0\n",
    );
    assert!(!shape.has_normals());
    assert_eq!(fact(&shape, "vertex properties"), "nx, ny (carried over)");
    assert!(with(&shape, 0, 2.0).ends_with(b"\n2 0 0 1 0\n"));
}

#[test]
fn whole_number_positions_are_rounded_and_refused_beyond_their_range() {
    let head = "element vertex 2\nproperty uchar x\nproperty char y\nproperty short z\nend_header\n";
    let binary =
        [b"ply\nformat binary_little_endian 1.0\n", head.as_bytes(), &[1, 255, 3, 1, 0, 0, 0, 0]].concat();
    let shape = ply(&binary);
    assert_eq!(shape.positions(), [1., -1., 259., 0., 0., 0.]);
    assert!(fact(&shape, "positions").contains("rounded"));
    assert_eq!(ply(&with(&shape, 0, 6.6)).positions()[0], 7.0);
    let mut positions = shape.positions().to_vec();
    positions[3] = 256.0;
    let error = shape.write(&positions, None).unwrap_err().to_string();
    assert!(error.contains("vertex 1") && error.contains("uint8"), "{error}");

    let text = ["ply\nformat ascii 1.0\n", head, "1 -1 259\n0 0 0\n"].concat();
    assert!(with(&ply(text.as_bytes()), 2, 4.6).ends_with(b"1 -1 5\n0 0 0\n"));
}

#[test]
fn strips_are_faces() {
    let shape = ply(b"ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
        element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 2\n\
        8 0 1 2 3 -1 2 3 4\n");
    assert_eq!(shape.faces().unwrap(), [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
}

#[test]
fn line_ends_of_every_system_are_read() {
    let unix = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n";
    for text in
        [unix.to_string(), unix.replace('\n', "\r\n"), unix.replace('\n', "\r"), unix.replace('\n', " \n")]
    {
        let shape = ply(text.as_bytes());
        assert_eq!(shape.positions(), [1., 2., 3.], "{text:?}");
        assert_eq!(with(&shape, 0, 5.0), text.replace("1 2 3", "5 2 3").as_bytes());
    }
    // The first byte of the body is a line feed, and belongs to the first number.
    let head = b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty char x\nproperty char y\nproperty char z\nend_header";
    for end in [&b"\n"[..], b"\r\n"] {
        assert_eq!(ply(&[head, end, b"\n\r\n"].concat()).positions(), [10., 13., 10.]);
    }
}

#[test]
fn splats_are_points_and_compressed_ones_are_named() {
    let names = ["x", "y", "z", "f_dc_0", "f_rest_0", "f_rest_1", "f_rest_2", "opacity", "scale_0", "rot_0"];
    let properties: String = names.iter().map(|name| format!("property float {name}\n")).collect();
    let splat =
        format!("ply\nformat ascii 1.0\nelement vertex 1\n{properties}end_header\n1 2 3 4 5 6 7 8 9 10\n");
    let shape = ply(splat.as_bytes());
    assert!(fact(&shape, "splats").contains("stay as they are"));
    assert!(fact(&shape, "vertex properties").contains("f_rest_0 to f_rest_2, opacity"));
    assert!(shape.faces().is_none());

    let packed = b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty uint packed_position\nend_header\n1234";
    assert!(refused(packed).contains("SuperSplat"));
}

fn ascii(vertex: &str, face: &str) -> Vec<u8> {
    format!(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n{vertex}\n1 0 0\n0 1 0\n{face}\n"
    )
    .into_bytes()
}

#[test]
fn refusals_name_the_place() {
    for (bytes, words) in [
        (ascii("0 0 0", "3 0 1 3"), ["line 13", "face 0", "index 3"]),
        (ascii("0 0 0", "3 0 1 -1"), ["line 13", "face 0", "index -1"]),
        (ascii("0 0 0", "3 0 1 1.5"), ["line 13", "face 0", "index 1.5"]),
        (ascii("0 0 0", "3 0 1"), ["line 13", "'face'", "ends before"]),
        (ascii("0 0 0", "-3 0 1"), ["line 13", "length of the list", "'-3'"]),
        (ascii("0 0 0", "4000000000 0 1"), ["line 13", "ends before", "vertex_indices"]),
        (ascii("0 0 0", ""), ["line 13", "row 0", "'face'"]),
        (ascii("0 inf 0", "3 0 1 2"), ["line 10", "vertex 0", "'inf'"]),
        (ascii("0 0", "3 0 1 2"), ["line 10", "'vertex'", "'z'"]),
        (ascii("0 zero 0", "3 0 1 2"), ["line 10", "finite number for y", "'zero'"]),
    ] {
        let message = refused(&bytes);
        assert!(words.iter().all(|word| message.contains(word)), "{message} lacks one of {words:?}");
    }
}

#[test]
fn long_names_are_shown_by_their_beginning() {
    let tag = "tag".repeat(1000);
    let properties =
        format!("property list int int {tag}\nproperty float x\nproperty float y\nproperty float z\n");
    let file = |format: &str, body: &str| {
        format!("ply\nformat {format} 1.0\nelement vertex 1\n{properties}end_header\n{body}")
    };
    for (format, body) in [
        ("ascii", "-1 0 0 0\n"),
        ("ascii", "4 0 0 0\n"),
        ("binary_little_endian", "\u{7f}\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0"),
        ("binary_big_endian", "\u{7f}\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0"),
    ] {
        let message = refused(file(format, body).as_bytes());
        assert!(message.contains("'tagtag") && message.len() < 200, "{message}");
    }
}

#[test]
fn what_a_line_has_beyond_its_row_is_carried_over() {
    let shape = ply(&ascii("0 0 0 9 8", "3 0 1 2 7"));
    assert_eq!(fact(&shape, "more than the header says"), "on 2 lines (carried over)");
    assert_eq!(with(&shape, 1, 0.5), ascii("0 0.5 0 9 8", "3 0 1 2 7"));
}

#[test]
fn wrong_headers_are_refused() {
    for (header, words) in [
        ("", "no element 'vertex'"),
        ("element vertex 1\nproperty float x\nproperty float y\n", "no property 'z'"),
        ("element vertex 1\nproperty float64x x\n", "number type"),
        ("element vertex 1\nproperty list float x\n", "number type"),
        ("element vertex 1\nproperty float\n", "no name"),
        ("element vertex 1\nproperty float x\nproperty int x\n", "two properties 'x'"),
        ("element vertex 1\nproperty list uchar float x\n", "is a list"),
        ("element vertex -1\n", "'-1'"),
        ("element vertex\n", "count"),
        ("property float x\n", "before the first element"),
        ("element vertex 1\nelement vertex 1\n", "second element"),
        ("format ascii 1.0\n", "second 'format'"),
        ("elements vertex 1\n", "'elements'"),
    ] {
        let message = refused(format!("ply\nformat ascii 1.0\n{header}end_header\n").as_bytes());
        assert!(message.contains(words), "{message} lacks {words}");
    }
    assert!(refused(b"ply\nformat ascii 1.0\nelement vertex 1\n").contains("end_header"));
    assert!(refused(b"ply\nelement vertex 1\nend_header\n").contains("no 'format' line"));
    assert!(refused(b"ply\nformat ascii 2.0\n").contains("version"));
    assert!(refused(b"plywood").contains("starts with a line 'ply'"));
    assert!(refused(b"").contains("ply") || refused(b"").contains("empty"));
}

#[test]
fn counts_beyond_the_file_are_refused_before_memory_is_taken() {
    let xyz = "property float x\nproperty float y\nproperty float z\n";
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        for count in ["2147483648", "18446744073709551615", "3"] {
            let file = format!("ply\nformat {format} 1.0\nelement vertex {count}\n{xyz}end_header\n1 2 3");
            assert!(refused(file.as_bytes()).contains(count), "{format} {count}");
        }
        let file = format!(
            "ply\nformat {format} 1.0\nelement nothing 18446744073709551615\nelement vertex 1\n{xyz}end_header\n1.0 2.0 3.0 4.0"
        );
        read(file.as_bytes(), Format::Ply).unwrap();
    }
    let head = "ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list int int vertex_indices\n\
                element vertex 0\nproperty char x\nproperty char y\nproperty char z\nend_header\n";
    for length in [i32::MAX, -1, 2] {
        let file = [head.as_bytes(), &length.to_le_bytes(), &[0; 7]].concat();
        assert!(refused(&file).starts_with(&format!("byte {}", head.len())), "{}", refused(&file));
    }
    let endless = [&b"ply\nformat ascii 1.0\n"[..], &b"comment again and again\n".repeat(100_000)].concat();
    assert!(refused(&endless).contains("MiB"));
    assert!(refused(&[&b"ply\n"[..], &vec![b'x'; 3 << 20]].concat()).len() < 200);
}

#[test]
fn a_truncated_binary_file_is_refused_at_every_length() {
    let bytes = binary(true);
    let whole = bytes.len() - b"tail".len();
    for length in 0..whole {
        assert!(read(&bytes[..length], Format::Ply).is_err(), "{length}");
    }
    read(&bytes[..whole], Format::Ply).unwrap();
}

#[test]
fn real_files_keep_everything() {
    // Compressed; rows without the list that the header promises; infinite; without x, y and z; without vertices.
    let known = [
        "biker.compressed.ply",
        "issue623.ply",
        "float_inf_point_cloud.ply",
        "organised.ply",
        "sized_dims.ply",
        "unsized_dims.ply",
        "no_vertex.ply",
        "empty.ply",
        "ply_empty_ascii.ply",
        "ply_empty_bin.ply",
        "ply_empty_header.ply",
    ];
    let refused =
        check_data_files(Format::Ply, 2e-7, |shape, before, after| match fact(shape, "encoding").as_str() {
            // Printed anew, a number keeps its value.
            "ascii" => same_words(before, after, 1e-6),
            _ => before == after,
        });
    assert!(refused.iter().all(|name| known.contains(&name.as_str())), "{refused:?}");
}

/// A file of random properties, elements and encoding; and the positions in it.
fn any_file() -> impl Strategy<Value = (Vec<u8>, Vec<f64>)> {
    let names = ["a", "b", "c", "x", "y", "z", "list"];
    let order = Just(names.to_vec()).prop_shuffle();
    let vertices = prop::collection::vec(prop::array::uniform3(-100i8..100), 1..20);
    (order, vertices, 0..3usize, any::<bool>()).prop_map(|(order, vertices, encoding, faces_first)| {
        let format = ["ascii", "binary_little_endian", "binary_big_endian"][encoding];
        let vertex: String = order
            .iter()
            .map(|&name| match name {
                "list" => "property list uchar short list\n".to_string(),
                "a" => "property double a\n".to_string(),
                "y" => "property short y\n".to_string(),
                name => format!("property float {name}\n"),
            })
            .collect();
        let vertex = format!("element vertex {}\n{vertex}", vertices.len());
        let face = "element face 1\nproperty list uchar int vertex_indices\n";
        let headers = if faces_first { [face, &vertex] } else { [&vertex, face] };
        let mut bytes =
            format!("ply\nformat {format} 1.0\n{}{}end_header\n", headers[0], headers[1]).into_bytes();
        let put = |bytes: &mut Vec<u8>, value: i8, little: &[u8]| match encoding {
            0 => bytes.extend(format!("{value} ").bytes()),
            1 => bytes.extend(little),
            _ => bytes.extend(little.iter().rev()),
        };
        let end_row = |bytes: &mut Vec<u8>| {
            if encoding == 0 {
                bytes.push(b'\n');
            }
        };
        for faces in [faces_first, !faces_first] {
            if faces {
                put(&mut bytes, 3, &[3]);
                for _ in 0..3 {
                    put(&mut bytes, 0, &0i32.to_le_bytes());
                }
                end_row(&mut bytes);
                continue;
            }
            for (row, vertex) in vertices.iter().enumerate() {
                for &name in &order {
                    let float = |value: i8| f32::from(value).to_le_bytes();
                    match name {
                        "x" => put(&mut bytes, vertex[0], &float(vertex[0])),
                        "y" => put(&mut bytes, vertex[1], &i16::from(vertex[1]).to_le_bytes()),
                        "z" => put(&mut bytes, vertex[2], &float(vertex[2])),
                        "a" => put(&mut bytes, 7, &7f64.to_le_bytes()),
                        "list" => {
                            let length = (row % 3) as i8;
                            put(&mut bytes, length, &[length as u8]);
                            for _ in 0..length {
                                put(&mut bytes, -9, &(-9i16).to_le_bytes());
                            }
                        }
                        _ => put(&mut bytes, 1, &float(1)),
                    }
                }
                end_row(&mut bytes);
            }
        }
        (bytes, vertices.concat().into_iter().map(f64::from).collect())
    })
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused(body in prop::collection::vec(any::<u8>(), 0..300), header in any::<bool>()) {
        let head: &[u8] = if header { &binary(false)[..330] } else { b"ply\n" };
        let _ = read(&[head, &body].concat(), Format::Ply);
    }

    #[test]
    fn a_damaged_file_is_read_or_refused(
        big_endian in any::<bool>(), text in any::<bool>(), damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)
    ) {
        let mut bytes = if text { ODD.to_vec() } else { binary(big_endian) };
        for (at, byte) in damage {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Ok(shape) = read(&bytes, Format::Ply) {
            let _ = shape.write(&bent(&shape), None);
        }
    }

    #[test]
    fn generated_files_round_trip((bytes, positions) in any_file(), shift in -20i8..20) {
        let shape = ply(&bytes);
        prop_assert_eq!(shape.positions(), &positions[..]);
        let moved: Vec<f64> = positions.iter().map(|c| c + f64::from(shift)).collect();
        let written = shape.write(&moved, None).unwrap().bytes;
        let again = ply(&written);
        prop_assert_eq!(again.positions(), &moved[..]);
        prop_assert_eq!(again.facts(), shape.facts());
        prop_assert_eq!(again.write(&positions, None).unwrap().bytes, bytes);
    }
}
