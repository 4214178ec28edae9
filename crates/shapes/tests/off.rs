//! OFF: what is read, what is carried over, what is refused.

mod files;

use files::{bent, read, refusal};
use neuralmls_shapes::{Format, Shape};
use proptest::prelude::*;

fn off(text: &str) -> Shape {
    read(text.as_bytes(), Format::Off).unwrap_or_else(|error| panic!("{error}"))
}

fn with(shape: &Shape, at: usize, value: f64) -> String {
    let mut positions = shape.positions().to_vec();
    positions[at] = value;
    String::from_utf8(shape.write(&positions, None).unwrap().bytes).unwrap()
}

const TRIANGLE: &str = "0 0 0\n1 0 0 # second\n\n0 1 0\n3 0 1 2 255 0 0\n";

#[test]
fn headers_of_every_kind() {
    for header in [
        "OFF\n3 1 0\n",
        "OFF 3 1 0\n",
        "  OFF3 1\n",
        "3 1 0\n",
        "# c\n\nOFF # h\n# c\n3 1 3\n",
        "\u{feff}OFF\r\n3 1 0\r\n",
    ] {
        let text = format!("{header}{TRIANGLE}");
        let shape = off(&text);
        assert_eq!(shape.positions(), [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0], "{header}");
        assert_eq!(shape.faces().unwrap(), [[0, 1, 2]]);
        assert_eq!(shape.write(shape.positions(), None).unwrap().bytes, text.as_bytes());
        assert_eq!(with(&shape, 3, 2.5), text.replace("1 0 0 #", "2.5 0 0 #"));
    }
}

#[test]
fn n_gons_become_fans_and_are_told() {
    let shape =
        off("OFF\n5 3 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 2 0\n5 0 1 2 4 3\n4 0 1 2 3 0.5 0.5 0.5\n2 0 1\n");
    assert_eq!(shape.faces().unwrap().len(), 5);
    assert_eq!(shape.facts()[0].1, "3 (1 quads, 1 n-gons, 1 with fewer than three corners)");
    assert_eq!(shape.facts()[1], ("face colours".to_string(), "1 (carried over)".to_string()));
}

#[test]
fn normals_turn_and_colours_and_texture_coordinates_stay() {
    let text = "STCNOFF\n1 0 0\n0 0 0 1 0 0.0 255 0 0 255 0.25 0.75\n";
    let shape = off(text);
    assert!(shape.has_normals());
    let (s, c) = 0.5f64.sin_cos();
    let map = [c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0];
    let result = shape.write(&[2.0, 0.0, 0.0], Some(&map)).unwrap().bytes;
    assert_eq!(
        String::from_utf8(result).unwrap(),
        "STCNOFF\n1 0 0\n2 0 0 0.877583 0.479426 0.0 255 0 0 255 0.25 0.75\n"
    );
    assert!(!off("COFF\n1 0 0\n0 0 0 1 0 0 1\n").has_normals());
}

#[test]
fn broken_files_are_refused_with_their_line() {
    for (text, sentence) in [
        ("OFF\n", "the file ends before the numbers of vertices and faces"),
        ("OFF\nx 1 0\n", "line 2: expected a number of vertices or faces, found 'x'"),
        ("OFF\n3\n", "line 2: expected the numbers of vertices, faces and edges, found '3'"),
        ("OFF\n0 0 0\n", "the OFF file has no vertices, expected at least one"),
        ("OFF\n1 0 0\n1 2\n", "line 3: expected a position of three numbers, found '1 2'"),
        ("OFF\n1 0 0\n1 2 nan\n", "line 3: expected a position, found 'nan', which is not a finite number"),
        ("NOFF\n1 0 0\n1 2 3 0 0\n", "line 3: expected a normal of three numbers, found '1 2 3 0 0'"),
        ("OFF\n2 0 0\n1 2 3 # a b c d\n", "the file ends after 1 of 2 vertices"),
        ("OFF\n1 2 0\n1 2 3\n1 0\n\n# c\n", "the file ends after 1 of 2 faces"),
        ("OFF\n1 1 0\n1 2 3\n3 0 0 1\n", "line 4: a face's corner is vertex 1, but the file has 1 vertices (counted from 0)"),
        (
            "OFF\n1 1 0\n1 2 3\n3 0 -1 0\n",
            "line 4: expected a face as its number of corners and their indices, found '-1'",
        ),
        (
            "OFF\n1 1 0\n1 2 3\n4000000000 0 0\n",
            "line 4: expected a face as its number of corners and their indices, found the end of the line after '4000000000 0 0'",
        ),
        (
            "OFF\n2147483648 1 0\n1 2 3\n",
            "line 2: the file promises 2147483648 vertices and 1 faces, which 25 bytes cannot hold",
        ),
        (
            "OFF\n99999999999999999999999 1 0\n1 2 3\n",
            "line 2: the file promises 18446744073709551615 vertices and 1 faces, which 38 bytes cannot hold",
        ),
        ("OFF BINARY\n", "this is a binary OFF file, which is not read: save it as text"),
        ("4OFF\n", "this OFF file has positions of four or any dimensions (4OFF, nOFF), which is not read"),
    ] {
        assert_eq!(refusal(text.as_bytes(), Format::Off), sentence);
    }
}

#[test]
fn vertices_and_faces_may_go_on_in_the_lines_below() {
    let text = "OFF\n4 2 0\n0 0\n0\n1 0 0\n1\n1\n0\n0 1 0 # last\n4 0\n1\n\n2 # c\n3\n3\n0 1 2\n";
    let shape = off(text);
    assert_eq!(shape.positions(), [0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.]);
    assert_eq!(shape.faces().unwrap(), [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
    assert_eq!(with(&shape, 7, 2.5), text.replacen("1\n1\n0", "1\n2.5\n0", 1));
    let normals = off("NOFF\n1 0 0\n0 0 0\n0 0 1\n");
    assert!(normals.has_normals());
}

#[test]
fn a_row_that_lacks_a_number_does_not_swallow_the_next() {
    for (text, sentence) in [
        ("OFF\n2 0 0\n0 0\n1 2 3\n4 5 6\n", "line 3: expected a position of three numbers, found '0 0'"),
        ("NOFF\n2 0 0\n0 0 0 0 1\n1 2 3 0 0 1\n", "line 3: expected a normal of three numbers, found '0 0 0 0 1'"),
        (
            "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2\n3 0 1 2\n",
            "line 7: expected a face as its number of corners and their indices, found the end of the line after '4 0 1 2'",
        ),
    ] {
        assert_eq!(refusal(text.as_bytes(), Format::Off), sentence);
    }
}

proptest! {
    #[test]
    fn arbitrary_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let _ = read(&bytes, Format::Off);
    }

    #[test]
    fn arbitrary_numbers_never_panic(numbers in prop::collection::vec(-1i64..6, 0..60), width in 1usize..6) {
        let lines: Vec<String> = numbers.chunks(width).map(|line| line.iter().map(|n| format!("{n} ")).collect()).collect();
        let text = format!("NOFF\n3 2 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n{}", lines.join("\n"));
        if let Ok(shape) = read(text.as_bytes(), Format::Off) {
            let again = read(&shape.write(&bent(&shape), None).unwrap().bytes, Format::Off).unwrap();
            prop_assert_eq!(again.faces(), shape.faces());
        }
    }
}
