//! STL: what is read, what is carried over, what is refused.

mod files;

use files::{bent, check_data_files, read, refusal, same_words};
use neuralmls_shapes::{Format, Shape};
use proptest::prelude::*;

fn stl(bytes: &[u8]) -> Shape {
    read(bytes, Format::Stl).unwrap_or_else(|error| panic!("{error}"))
}

fn fact(shape: &Shape, what: &str) -> String {
    let found = shape.facts().iter().find(|(name, _)| name == what);
    found.unwrap_or_else(|| panic!("no fact {what} in {:?}", shape.facts())).1.clone()
}

const TWO_SOLIDS: &str = "solid facet of a thing\r\n\
  FACET Normal 0 0 1\r\n\
\x20   outer LOOP\r\n\
\x20     vertex 0 0 0\r\n\
\tvertex 1.0e0   0.00 0\r\n\
\x20     vertex 0 1 0.000\r\n\
\x20   endloop\r\n\
\x20 endfacet\r\n\
endsolid facet of a thing\r\n\
\r\n\
solid\r\n\
\x20 facet normal 0 0 0\r\n\
\x20   outer loop\r\n\
\x20     vertex 0 0 2\r\n\
\x20     vertex 1 0 2\r\n\
\x20     vertex 0 -1 2\r\n\
\x20   endloop\r\n\
\x20 endfacet\r\n\
endsolid";

#[test]
fn several_solids_are_one_shape_in_file_order() {
    let shape = stl(TWO_SOLIDS.as_bytes());
    assert_eq!(shape.positions(), [0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 2., 1., 0., 2., 0., -1., 2.]);
    assert_eq!(shape.faces().unwrap(), [[0, 1, 2], [3, 4, 5]]);
    assert_eq!(fact(&shape, "solids"), "2: facet of a thing, (no name)");
    assert_eq!(shape.write(shape.positions(), None).unwrap().bytes, TWO_SOLIDS.as_bytes());
}

#[test]
fn a_moved_ascii_triangle_changes_its_corner_and_its_normal() {
    let shape = stl(TWO_SOLIDS.as_bytes());
    let mut positions = shape.positions().to_vec();
    positions[5] = 1.0; // z of the second corner
    positions[17] = 3.0; // z of the last corner, whose facet never had a normal
    let written = String::from_utf8(shape.write(&positions, None).unwrap().bytes).unwrap();
    let expected = TWO_SOLIDS
        .replace("Normal 0 0 1\r\n", "Normal -0.707107 0 0.707107\r\n")
        .replace("1.0e0   0.00 0\r\n", "1.0e0   0.00 1\r\n")
        .replace("0 -1 2", "0 -1 3");
    assert_eq!(written, expected);
}

/// Normal, corners and attribute.
type Triangle = ([f32; 3], [[f32; 3]; 3], u16);

/// Triangles as a binary file.
fn binary(header: &str, triangles: &[Triangle]) -> Vec<u8> {
    let mut bytes = header.as_bytes().to_vec();
    bytes.resize(80, 0);
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for (normal, corners, attribute) in triangles {
        bytes.extend(normal.iter().chain(corners.iter().flatten()).flat_map(|c| c.to_le_bytes()));
        bytes.extend(attribute.to_le_bytes());
    }
    bytes
}

const CORNERS: [[f32; 3]; 3] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]];

fn floats(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect()
}

#[test]
fn binary_keeps_header_colours_and_what_is_behind() {
    let mut bytes = binary("solid COLOR=red", &[([0., 0., 1.], CORNERS, 0x801f), ([0., 0., 1.], CORNERS, 7)]);
    bytes.extend(b"tail");
    let shape = stl(&bytes);
    assert_eq!(shape.positions().len(), 18);
    assert_eq!(fact(&shape, "header"), "solid COLOR=red");
    assert_eq!(fact(&shape, "colours"), "attribute bytes of 2 triangles (carried over)");
    assert_eq!(fact(&shape, "behind the last triangle"), "4 bytes (carried over)");
    let mut positions = shape.positions().to_vec();
    positions[2] = 1.0; // z of the first corner
    let written = shape.write(&positions, None).unwrap().bytes;
    assert_eq!(stl(&written).positions(), positions);
    let normal = floats(&written[84..96]);
    assert!(normal.iter().all(|c| (c - 3f32.sqrt().recip()).abs() < 1e-6), "{normal:?}");
    let changed: Vec<_> = (0..bytes.len()).filter(|&i| bytes[i] != written[i]).collect();
    assert!(changed.iter().all(|at| (84..96).contains(at) || (104..108).contains(at)), "{changed:?}");
}

#[test]
fn normals_keep_their_side_and_degenerate_or_missing_ones_stay() {
    let down = [0., 0., -1.];
    let triangles = [(down, CORNERS, 0), ([0.; 3], CORNERS, 0), ([0., 0., 1.], CORNERS, 0)];
    let shape = stl(&binary("", &triangles));
    let mut positions: Vec<f64> = shape.positions().iter().map(|c| 2.0 * c).collect();
    positions[18..].copy_from_slice(&[0., 0., 0., 1., 1., 1., 2., 2., 2.]);
    let written = shape.write(&positions, None).unwrap().bytes;
    assert_eq!(floats(&written[84..96]), down);
    assert_eq!(floats(&written[134..146]), [0.; 3]);
    assert_eq!(floats(&written[184..196]), [0., 0., 1.]);
    assert_eq!(fact(&shape, "triangles without a normal"), "1 (they keep 0 0 0)");
}

#[test]
fn binary_is_told_from_ascii_by_more_than_its_first_word() {
    for header in ["solid", "solid facet normal 0 0 1 outer loop vertex 0 0 0", "mesh", ""] {
        let bytes = binary(header, &[([0., 0., 1.], CORNERS, 0)]);
        assert_eq!(fact(&stl(&bytes), "encoding"), "binary");
        assert!(refusal(&bytes[..bytes.len() - 1], Format::Stl).contains("promises 1 triangles"));
    }
    assert_eq!(fact(&stl(format!("\n {}", TWO_SOLIDS.to_uppercase()).as_bytes()), "encoding"), "ascii");
}

#[test]
fn zero_bytes_behind_a_text_make_no_binary_file_of_it_however_short_it_becomes() {
    let long = "7".repeat(600);
    for normal in ["0 0 1", &format!("0 x{long} 1")] {
        let text = format!(
            "solid a\n facet normal {normal}\n outer loop\n vertex 0 0 0\n vertex 1 0 0\n vertex 0 1 0\n endloop\n endfacet\n\
             endsolid a\0\0\0\n"
        );
        let shape = stl(text.as_bytes());
        let written = shape.write(&[0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0], None).unwrap();
        assert_eq!(stl(&written.bytes).positions(), [0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0]);
    }
}

#[test]
fn refusals_name_the_place() {
    let text = |from: &str, to: &str| refusal(TWO_SOLIDS.replacen(from, to, 1).as_bytes(), Format::Stl);
    for (message, words) in [
        (text("vertex 0 0 0", "vertex 0 nan 0"), ["line 4", "finite number", "'nan'"]),
        (text("vertex 0 0 0", "vertex 0 0"), ["line 5", "finite number", "'vertex'"]),
        (text("outer LOOP\r\n", ""), ["line 3", "'outer'", "'vertex'"]),
        (text("vertex 0 0 0\r\n", ""), ["line 6", "'vertex'", "'endloop'"]),
        (text("endloop", "vertex 1 2 3\r\nendloop"), ["line 7", "'endloop'", "'vertex'"]),
        (text("endsolid facet", "endsold facet"), ["line 9", "'endsolid'", "'endsold'"]),
        (
            refusal(TWO_SOLIDS.strip_suffix("endsolid").unwrap().as_bytes(), Format::Stl),
            ["line 19", "endsolid", "ends"],
        ),
        (refusal(&TWO_SOLIDS.as_bytes()[..100], Format::Stl), ["line 5", "expected", "ends"]),
        (refusal(b"hello", Format::Stl), ["'solid'", "84 bytes", "5 bytes"]),
        (
            refusal(&binary("", &[([0.; 3], [[f32::NAN; 3]; 3], 0)]), Format::Stl),
            ["byte 96", "triangle 0", "NaN"],
        ),
    ] {
        assert!(words.iter().all(|word| message.contains(word)), "{message} lacks one of {words:?}");
    }
    let mut bytes = binary("", &[([0.; 3], CORNERS, 0)]);
    bytes[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(refusal(&bytes, Format::Stl).contains("promises 4294967295 triangles"));
}

#[test]
fn a_byte_order_mark_and_white_space_before_solid_are_carried_over() {
    for start in ["\u{feff}", " ", "\t", "\u{feff}\r\n "] {
        let text = format!("{start}{TWO_SOLIDS}");
        let shape = stl(text.as_bytes());
        assert_eq!(shape.positions(), stl(TWO_SOLIDS.as_bytes()).positions());
        let mut moved = shape.positions().to_vec();
        moved[0] = 0.5;
        let expected = text.replacen("vertex 0 0 0", "vertex 0.5 0 0", 1);
        assert_eq!(shape.write(&moved, None).unwrap().bytes, expected.as_bytes());
    }
}

#[test]
fn a_number_of_triangles_that_was_never_filled_in_follows_from_the_length() {
    let mut bytes = binary("", &[([0.; 3], CORNERS, 0), ([0.; 3], CORNERS, 7)]);
    bytes[80..84].fill(0);
    let shape = stl(&bytes);
    assert_eq!((shape.positions().len(), shape.faces().unwrap().len()), (18, 2));
    assert_eq!(fact(&shape, "number of triangles"), "0 in the header, 2 behind it (read; the header stays)");
    let written = shape.write(&bent(&shape), None).unwrap().bytes;
    assert_eq!((written.len(), &written[80..84]), (bytes.len(), &[0; 4][..]));
    // Neither nothing behind it nor half of a triangle.
    for length in [84, 100] {
        assert!(refusal(&bytes[..length], Format::Stl).contains("no vertices"));
    }
}

#[test]
fn decimal_commas_are_named() {
    let refused = refusal(TWO_SOLIDS.replacen("vertex 0 0 0", "vertex 0,5 0 0", 1).as_bytes(), Format::Stl);
    assert_eq!(refused, "line 4: decimal commas are not read, expected a decimal point, found '0,5'");
}

#[test]
fn a_position_beyond_float32_is_refused() {
    let shape = stl(&binary("", &[([0.; 3], CORNERS, 0)]));
    let mut positions = shape.positions().to_vec();
    positions[4] = 1e39;
    assert!(shape.write(&positions, None).unwrap_err().to_string().contains("position 1 "));
}

#[test]
fn real_files_keep_everything() {
    let refused = check_data_files(Format::Stl, 2e-7, |shape, before, after| {
        if fact(shape, "encoding") == "ascii" {
            // All but the normals, which turned there and back.
            let numbers =
                |line: &str| if line.contains("normal") { String::new() } else { format!("{line}\n") };
            let words =
                |file| String::from_utf8_lossy(file).to_lowercase().lines().map(numbers).collect::<String>();
            return same_words(words(before).as_bytes(), words(after).as_bytes(), 1e-6);
        }
        let end = 84 + 50 * shape.faces().unwrap().len();
        let facets =
            |file: &[u8]| file[84..end].chunks_exact(50).flat_map(|f| f[12..].to_vec()).collect::<Vec<_>>();
        before[..84] == after[..84] && before[end..] == after[end..] && facets(before) == facets(after)
    });
    // Without triangles.
    let known = ["empty.stl", "stl_empty_ascii.stl", "stl_empty_bin.stl"];
    assert!(refused.iter().all(|name| known.contains(&name.as_str())), "{refused:?}");
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused(body in prop::collection::vec(any::<u8>(), 0..300), solid in any::<bool>()) {
        let head: &[u8] = if solid { b"solid " } else { b"" };
        let _ = read(&[head, &body].concat(), Format::Stl);
    }

    #[test]
    fn a_damaged_file_is_read_or_refused(
        text in any::<bool>(), damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)
    ) {
        let one = ([0., 0., 1.], CORNERS, 0);
        let mut bytes = if text { TWO_SOLIDS.as_bytes().to_vec() } else { binary("solid", &[one, one]) };
        for (at, byte) in damage {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Ok(shape) = read(&bytes, Format::Stl) {
            let _ = shape.write(&bent(&shape), None);
        }
    }

    #[test]
    fn generated_files_round_trip(
        corners in prop::collection::vec(prop::array::uniform3(prop::array::uniform3(-1e3f32..1e3)), 1..9),
        attribute in any::<u16>(), shift in -9i8..9
    ) {
        let triangles: Vec<_> = corners.iter().map(|&c| ([0.; 3], c, attribute)).collect();
        let bytes = binary("generated", &triangles);
        let shape = stl(&bytes);
        prop_assert_eq!(shape.positions().len(), 9 * corners.len());
        let moved: Vec<f64> = shape.positions().iter().map(|&c| f64::from((c + f64::from(shift)) as f32)).collect();
        let again = stl(&shape.write(&moved, None).unwrap().bytes);
        prop_assert_eq!(again.positions(), &moved[..]);
        prop_assert_eq!(again.write(shape.positions(), None).unwrap().bytes, bytes);
    }
}
