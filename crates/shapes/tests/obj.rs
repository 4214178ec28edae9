//! OBJ: what is read, what is carried over, what is refused.

mod files;

use files::{bent, read, refusal};
use neuralmls_shapes::{Format, Shape};
use proptest::prelude::*;

fn obj(bytes: &[u8]) -> Shape {
    read(bytes, Format::Obj).unwrap_or_else(|error| panic!("{error}"))
}

fn refused(text: &str) -> String {
    refusal(text.as_bytes(), Format::Obj)
}

fn fact(shape: &Shape, what: &str) -> String {
    let found = shape.facts().iter().find(|(name, _)| name == what);
    found.unwrap_or_else(|| panic!("no fact {what} in {:?}", shape.facts())).1.clone()
}

fn written(shape: &Shape, positions: &[f64], maps: Option<&[f64]>) -> String {
    String::from_utf8(shape.write(positions, maps).unwrap().bytes).unwrap()
}

/// The shape's file with coordinate `at` set.
fn with(shape: &Shape, at: usize, value: f64) -> String {
    let mut positions = shape.positions().to_vec();
    positions[at] = value;
    written(shape, &positions, None)
}

/// A rotation by `angle` about z, row by row.
fn about_z(angle: f64) -> [f64; 9] {
    let (s, c) = angle.sin_cos();
    [c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0]
}

const ODD: &str = "\u{feff}# odd\r\nmtllib a b.mtl\r\no thing\r\ng one two\r\n\
  v\t0 0   0.000 1 # first\r\nv 1e0 +0. -0 0.5 0.25 1\r\nv 1 1 \\\r\n 0\r\nv 0 1 0 1 0.5 0.5 0.5\r\nvp 0.5\r\n\
usemtl oak # brown\r\ns off\r\nf 1/1 2/2/ 3// -1\r\nf -4 -3 \\\r\n-2\r\nl 1 2 3\r\np 4\r\ncstype bspline\r\nvc 1 0 0\r\n";

#[test]
fn an_unmoved_file_is_the_same_bytes() {
    for text in [ODD, "v 1 2 3", "v 1 2 3\rv 4 5 6\r"] {
        let shape = obj(text.as_bytes());
        assert_eq!(written(&shape, shape.positions(), None), text);
    }
}

#[test]
fn a_moved_vertex_changes_only_its_own_number() {
    let shape = obj(ODD.as_bytes());
    assert_eq!(shape.positions(), [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
    assert_eq!(shape.faces().unwrap(), [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
    assert_eq!(with(&shape, 2, 0.5), ODD.replace("0.000 1 #", "0.5 1 #"));
    assert_eq!(with(&shape, 3, 1.25), ODD.replace("1e0", "1.25"));
    assert_eq!(with(&shape, 8, -0.125), ODD.replace("\\\r\n 0\r\nv", "\\\r\n -0.125\r\nv"));
}

#[test]
fn what_the_file_holds_is_told() {
    let shape = obj(ODD.as_bytes());
    assert_eq!(fact(&shape, "faces"), "2 (1 triangles, 1 quads)");
    assert_eq!(fact(&shape, "materials"), "1: oak # brown");
    assert_eq!(fact(&shape, "material libraries"), "1: a b.mtl");
    assert_eq!(fact(&shape, "groups"), "1: one two");
    assert_eq!(fact(&shape, "vertex colours"), "2");
    assert_eq!(fact(&shape, "rational weights"), "1");
    assert_eq!(fact(&shape, "lines"), "1");
    assert_eq!(fact(&shape, "free-form statements"), "2 (carried over; their control points move)");
    assert_eq!(fact(&shape, "unknown statements, carried over"), "1: vc");
}

#[test]
fn faces_may_name_vertices_that_follow() {
    let shape = obj(b"f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n");
    assert_eq!(shape.faces().unwrap(), [[0, 1, 2]]);
}

#[test]
fn a_cloud_has_no_faces() {
    assert_eq!(obj(b"v 0 0 0\np 1\n").faces(), None);
}

#[test]
fn broken_files_are_refused_with_their_line() {
    let v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (text, sentence) in [
        ("", "the file is empty"),
        ("# nothing\n", "the OBJ file has no vertices, expected at least one"),
        ("v 0 0\n", "line 1: expected a position of three numbers, found 2"),
        ("v 0 0 # 0\n", "line 1: expected a position of three numbers, found 2"),
        ("\nv 0 nan 0\n", "line 2: expected a coordinate, found 'nan', which is not a finite number"),
        ("v 0 0 -inf\n", "line 1: expected a coordinate, found '-inf', which is not a finite number"),
        ("v 0 0 1e999\n", "line 1: expected a coordinate, found '1e999', which is not a finite number"),
        ("v 0 0 1,5\n", "line 1: decimal commas are not read, expected a decimal point, found '1,5'"),
        (&format!("{v}f 1 2 4\n"), "line 4: a face names vertex 4, but the file has 3"),
        (&format!("{v}f 0 1 2\n"), "line 4: a face names vertex 0, but they are counted from 1"),
        (&format!("{v}f 1 2 -4\n"), "line 4: a face names vertex -4, but 3 are defined up to here"),
        (
            &format!("{v}f 1 2 99999999999\n"),
            "line 4: a face names vertex 99999999999, but 3 are defined up to here",
        ),
        (&format!("{v}f 1 2 x\n"), "line 4: expected a face's corner such as 1, 1/2 or 1/2/3, found 'x'"),
        (
            &format!("{v}\\\nf 1 2 1.5\n"),
            "line 4: expected a face's corner such as 1, 1/2 or 1/2/3, found '1.5'",
        ),
    ] {
        assert_eq!(refused(text), sentence);
    }
}

#[test]
fn a_normal_turns_with_the_map_of_its_vertex() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 0\nvn 0 1.0 0\nvn 0 0 2\nf 1//1 2//2 3//3\n";
    let shape = obj(text.as_bytes());
    assert!(shape.has_normals());
    let maps: Vec<f64> = [0.5f64, 0.0, 1.0].iter().flat_map(|&angle| about_z(angle)).collect();
    let mut moved = shape.positions().to_vec();
    moved[0] = -1.0;
    let expected = text.replacen("v 0 0 0", "v -1 0 0", 1).replace("vn 1 0 0", "vn 0.877583 0.479426 0");
    assert_eq!(written(&shape, &moved, Some(&maps)), expected);
}

#[test]
fn a_normal_turns_by_the_inverse_transpose_and_stays_as_long() {
    let shape = obj(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0.6 0.8 0\nf 1//1 2//1 3//1\n");
    let stretch = [2.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0].repeat(3);
    let moved: Vec<f64> =
        shape.positions().iter().enumerate().map(|(i, x)| if i % 3 == 0 { 2.0 * x } else { *x }).collect();
    // (0.3, 0.8) with length 1.
    assert!(written(&shape, &moved, Some(&stretch)).contains("vn 0.351123 0.936329 0\n"));
}

#[test]
fn without_maps_normals_turn_as_the_faces_do() {
    let shape = obj(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n");
    // Stood up: (x, y, z) -> (x, -z, y).
    let up: Vec<f64> = shape.positions().chunks(3).flat_map(|p| [p[0], -p[2], p[1]]).collect();
    assert!(written(&shape, &up, None).contains("vn 0 -1 0\n"));
}

#[test]
fn a_normal_whose_corners_part_is_split_and_faces_are_renumbered() {
    let text = "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nvn 1 0 0 # shared\r\nvn 0 0 1\r\n\
                f 1//1 2//1 3//1\r\nf 1//-2 2//-2 -1//-1\r\nvn 0 0 -1\r\nf 1//3 2//-1 3//-3\r\n";
    let shape = obj(text.as_bytes());
    let maps: Vec<f64> = [0.0f64, 0.5, 0.501].iter().flat_map(|&angle| about_z(angle)).collect();
    let mut moved = shape.positions().to_vec();
    moved[0] = -1.0;
    // Vertices 2 and 3 agree to a degree, vertex 1 does not.
    let result = written(&shape, &moved, Some(&maps));
    let turned = [[0.0; 2], [0.5f64.cos(), 0.5f64.sin()], [0.501f64.cos(), 0.501f64.sin()]];
    let lines: Vec<&str> = result.split("\r\n").collect();
    assert_eq!(lines.len(), text.split("\r\n").count() + 1);
    assert_eq!(&lines[3], &"vn 1 0 0 # shared");
    assert!(lines[4].starts_with("vn 0.87"), "{}", lines[4]);
    assert_eq!(lines[5], "vn 0 0 1");
    assert_eq!(lines[6], "f 1//1 2//2 3//2");
    assert_eq!(lines[7], "f 1//-3 2//-2 -1//-1");
    assert_eq!(lines[8], "vn 0 0 -1");
    assert_eq!(lines[9], "f 1//4 2//-1 3//-3");
    let normal: Vec<f64> = lines[4].split(' ').skip(1).map(|n| n.parse().unwrap()).collect();
    for k in 0..2 {
        assert!((normal[k] - 0.5 * (turned[1][k] + turned[2][k])).abs() < 1e-5);
    }
}

#[test]
fn a_split_normal_leaves_each_corner_within_a_degree_of_its_turned_normal() {
    let n = 200;
    let mut text = String::new();
    (0..n).for_each(|i| text += &format!("v {} {} 0\n", i, i % 2));
    text += "vn 0 1 0\n";
    (2..n).for_each(|i| text += &format!("f {}//1 {}//1 {}//-1\n", i - 1, i, i + 1));
    let shape = obj(text.as_bytes());
    let angle = |i: usize| i as f64 * 0.005;
    let maps: Vec<f64> = (0..n).flat_map(|i| about_z(angle(i))).collect();
    let mut moved = shape.positions().to_vec();
    moved[2] = 1.0;
    let result = written(&shape, &moved, Some(&maps));
    let normals: Vec<Vec<f64>> = result
        .lines()
        .filter(|l| l.starts_with("vn"))
        .map(|l| l.split(' ').skip(1).map(|n| n.parse().unwrap()).collect())
        .collect();
    assert!(normals.len() > 50 && normals.len() < n, "{}", normals.len());
    for corner in result.lines().filter(|l| l.starts_with('f')).flat_map(|l| l.split(' ').skip(1)) {
        let (vertex, normal) = corner.split_once("//").unwrap();
        let vertex: usize = vertex.parse().unwrap();
        let normal: i64 = normal.parse().unwrap();
        let normal = &normals[if normal > 0 { normal - 1 } else { normal + normals.len() as i64 } as usize];
        let [s, c] = [angle(vertex - 1).sin(), angle(vertex - 1).cos()];
        assert!(normal[1] * c - normal[0] * s > 0.9998, "{corner}");
    }
}

#[test]
fn unused_and_broken_normals_stay_and_a_cloud_has_one_each() {
    let turned = about_z(0.5);
    let text = "v 0 0 0\nvn 1 0 0\nvn nan 0 0\nvn 1\nv 1 0 0\n";
    let shape = obj(text.as_bytes());
    assert_eq!(
        written(&shape, &[0.0, 0.0, 0.0, 2.0, 0.0, 0.0], Some(&turned.repeat(2))),
        text.replace("v 1 0 0", "v 2 0 0")
    );

    let cloud = obj(b"vn 1 0 0\nv 0 0 0\nvn nan 0 0\nv 1 0 0\n");
    assert_eq!(
        written(&cloud, &[0.0, 0.0, 0.0, 2.0, 0.0, 0.0], Some(&turned.repeat(2))),
        "vn 0.877583 0.479426 0\nv 0 0 0\nvn nan 0 0\nv 2 0 0\n"
    );
}

#[test]
fn normals_that_cannot_be_renumbered_are_not_split() {
    // The second face names a normal that does not exist: it must not come to exist.
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 0\nf 1//1 2//1 3//1\nf 1//2 2//2 3//2\n";
    let shape = obj(text.as_bytes());
    let maps: Vec<f64> = [0.0f64, 0.5, 1.0].iter().flat_map(|&angle| about_z(angle)).collect();
    let mut moved = shape.positions().to_vec();
    moved[0] = -1.0;
    let result = written(&shape, &moved, Some(&maps));
    assert_eq!(result.matches("vn ").count(), 1);
    assert!(result.ends_with("f 1//1 2//1 3//1\nf 1//2 2//2 3//2\n"));
}

#[test]
fn coordinates_far_from_the_origin_keep_their_millimetres() {
    let shape = obj(b"v 500000.123 4000000.456 10.5\nv 500100.123 4000100.456 20.5\n");
    assert!(with(&shape, 0, 500_000.124).starts_with("v 500000.124 4000000.456 10.5\n"));
}

proptest! {
    #[test]
    fn arbitrary_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = read(&bytes, Format::Obj);
    }

    #[test]
    fn arbitrary_words_never_panic(words in prop::collection::vec(
        prop::sample::select(vec!["v", "vn", "f", "1", "-1", "2//1", "1/1/-1", "0.5", "\n", "\r\n", "\\", "\\\n", "#", "surf"]),
        0..120,
    )) {
        let text = format!("v 0 0 0\nv 1 0 0\nv 1 2 0\n{}", words.join(" "));
        if let Ok(shape) = read(text.as_bytes(), Format::Obj) {
            let again = read(&shape.write(&bent(&shape), None).unwrap().bytes, Format::Obj).unwrap();
            prop_assert_eq!(again.faces(), shape.faces());
        }
    }

    #[test]
    fn written_positions_read_again_as_precisely_as_they_are_printed(
        points in prop::collection::vec(prop::array::uniform3(-1e3f64..1e3), 3..40),
        moved in prop::collection::vec(prop::array::uniform3(-1e3f64..1e3), 40),
    ) {
        let mut text = String::new();
        points.iter().for_each(|[x, y, z]| text += &format!("v {x:.6} {y} {z:e}\n"));
        text += "f 1 2 3\n";
        let shape = obj(text.as_bytes());
        let moved: Vec<f64> = moved[..points.len()].concat();
        let again = obj(&shape.write(&moved, None).unwrap().bytes);
        for (is, asked) in again.positions().iter().zip(&moved) {
            prop_assert!((is - asked).abs() <= 0.5001e-6);
        }
        prop_assert_eq!(again.faces(), shape.faces());
    }
}
