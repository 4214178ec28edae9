//! XYZ, TXT, CSV: what is read, what is carried over, what is refused.

mod files;

use files::{bent, read, refusal};
use neuralmls_shapes::{Format, Shape};
use proptest::prelude::*;

fn table(text: &str) -> Shape {
    read(text.as_bytes(), Format::Table).unwrap_or_else(|error| panic!("{error}"))
}

fn with(shape: &Shape, at: usize, value: f64) -> String {
    let mut positions = shape.positions().to_vec();
    positions[at] = value;
    String::from_utf8(shape.write(&positions, None).unwrap().bytes).unwrap()
}

#[test]
fn tables_of_every_kind() {
    for (text, dim, first) in [
        ("1 2 3\n4 5 6\n", 3, "1 "),
        ("1\t2\t3\t255\t0\t0\r\n4\t5\t6\t0\t0\t0", 3, "1\t"),
        ("  1,  2, 3, oak\n4,5,6,\n", 3, "1, "),
        ("1;2;3;4\n4;5;6;7\n", 3, "1;"),
        ("# made by hand\n//X Y Z R\n1 2 3 0\n# between\n\n4 5 6 7\n", 3, "1 2"),
        ("2\nwater, two atoms\nO 1 2 3\nH 4 5 6\n", 3, "1 2"),
        ("2\n1 2 3\n4 5 6\n", 3, "1 2"),
        ("name,x,y,z\n\"a, b\",1,2,3\nc,\"4\",5,6\n", 3, "1,"),
        ("z,Y,\"X\"\n3,2,1\n6,5,4\n", 3, "1\n"),
        ("1 2\n4 5\n", 2, "1 "),
        ("id,x,y\n7,1,2\n8,4,5\n", 2, "1,"),
        ("1\n4\n7\n", 1, "1\n"),
        ("\u{feff}x y z\n1 2 3\n", 3, "1 "),
    ] {
        let shape = table(text);
        assert_eq!(shape.dim(), dim, "{text}");
        assert_eq!(shape.positions()[..dim], [1.0, 2.0, 3.0][..dim], "{text}");
        assert_eq!(shape.faces(), None);
        assert_eq!(shape.write(shape.positions(), None).unwrap().bytes, text.as_bytes());
        let moved = first.replace('1', "1.5");
        assert_eq!(with(&shape, 0, 1.5), text.replacen(first, &moved, 1), "{text}");
    }
}

#[test]
fn decimal_commas_are_refused_instead_of_taken_for_a_header() {
    for (text, line, found) in [
        ("0,5;1,2;3\n1;2;3\n", 1, "0,5"),
        ("x;y;z\n1;2;-3,25\n", 2, "-3,25"),
        ("id;x;y;z\n1;0,5;2;3\n", 2, "0,5"),
        ("0,5 1,2 3\n1 2 3\n", 1, "0,5"),
        ("x\ty\tz\n1\t2,5e-3\t3\n1\t2\t3\n", 2, "2,5e-3"),
        ("O 0,5 1,5 2,5\nH 1 2 3\n", 1, "0,5"),
        ("1;2;3\n1;2;3,5\n", 2, "3,5"),
        ("1 2 3\n1 2,5 3\n", 2, "2,5"),
        ("\"0,5\",\"1,2\",\"3\"\n1,2,3\n", 1, "0,5"),
    ] {
        let refused = refusal(text.as_bytes(), Format::Table);
        let expected =
            format!("line {line}: decimal commas are not read, expected a decimal point, found '{found}'");
        assert_eq!(refused, expected, "{text}");
    }
    // Commas that separate columns, and a sentence with a number in it.
    for text in ["0,5\n1,2\n", "1, 2,3\n", "2\nat 1,5 bar\nO 1 2 3\nH 4 5 6\n", "\"a,b\",1,2,3\n"] {
        table(text);
    }
}

#[test]
fn quoted_numbers_stay_quoted() {
    assert_eq!(with(&table("\"1\",\"2\",\"3\"\n"), 1, 7.0), "\"1\",\"7\",\"3\"\n");
}

#[test]
fn normals_that_the_header_names_turn() {
    let shape = table("nx,ny,nz,x,y,z\n1,0,0,5,6,7\n");
    assert!(shape.has_normals());
    let (s, c) = 0.5f64.sin_cos();
    let map = [c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0];
    let result = shape.write(&[5.5, 6.0, 7.0], Some(&map)).unwrap().bytes;
    assert_eq!(String::from_utf8(result).unwrap(), "nx,ny,nz,x,y,z\n0.877583,0.479426,0,5.5,6,7\n");
    assert!(!table("5 6 7 1 0 0\n").has_normals());
    // The first of them is taken for a coordinate.
    assert!(!table("name,length,width,nx,ny,nz\na,5,6,7,1,0\n").has_normals());
}

#[test]
fn tables_of_cloudcompare_and_of_scanners() {
    let shape =
        table("//X Y Z R G B Scalar field Nx Ny Nz\n2\n0 0 0 1 2 3 0.5 1 0 0\n1 1 1 1 2 3 0.5 1 0 0\n");
    assert!(shape.has_normals());
    let names = &shape.facts().iter().find(|(what, _)| what == "column names").unwrap().1;
    assert_eq!(names, "x, y, z, r, g, b, scalar field, nx, ny, nz");
    // Without the names of the position, or with an unusual word among the usual ones, nobody knows.
    assert!(!table("//a scalar field Nx Ny Nz\n0 0 0 1 0\n").has_normals());
    assert!(!table("//X Y Z some Nx field Ny Nz\n0 0 0 1 0 0 1\n").has_normals());
    for (text, first) in [
        ("//X;Y;Z;Intensity\n0.5;0;0;nan\n1;1;1;nan\n", "0.5"),
        ("//X,Y,Z\n2\n0.5,0,0\n1,1,1\n", "0.5"),
        ("2\n0.5 0 0 -1200 10 20 30\n1 1 1 -1200 10 20 30\n", "0.5"),
        ("PointID,X,Y,Z,Class\nP0,0.5,0,0,ground\nP1,1,1,1,ground\n", "0.5"),
    ] {
        let shape = table(text);
        assert_eq!(shape.positions(), [0.5, 0.0, 0.0, 1.0, 1.0, 1.0], "{text}");
        assert_eq!(with(&shape, 0, 7.25), text.replacen(first, "7.25", 1));
    }
}

#[test]
fn broken_files_are_refused_with_their_line() {
    for (text, sentence) in [
        ("\n# only comments\n", "the table has no rows, expected numbers"),
        (
            "Terms and conditions 2\napply.\n",
            "line 1: expected a row of numbers, found 'Terms and conditions 2'",
        ),
        ("1 2 3\n4 5\n", "line 2: expected 3 columns as in line 1, found 2"),
        ("x,y,z\n1,2,3\n4,,6\n", "line 3: expected a finite number in column 2, found ''"),
        ("1 2 3\n4 nan 6\n", "line 2: expected a finite number in column 2, found 'nan'"),
        ("1 2 3\n4 5 1e999\n", "line 2: expected a finite number in column 3, found '1e999'"),
        ("1 m;2 m;3 m\n", "line 1: expected a row of numbers, found '1 m;2 m;3 m'"),
        ("3\n1 2 3\n4 5 6\n", "line 1: 3 rows are promised, but 2 follow"),
        ("x,y,z,name\n1,2,a,4\n", "line 2: expected a number in column 3"),
        ("x y z nx ny nz\n1 2 3 0 0 a\n", "line 2: expected a finite number in column 6, found 'a'"),
    ] {
        assert_eq!(refusal(text.as_bytes(), Format::Table), sentence);
    }
}

proptest! {
    #[test]
    fn arbitrary_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let _ = read(&bytes, Format::Table);
    }

    #[test]
    fn arbitrary_rows_never_panic(words in prop::collection::vec(
        prop::sample::select(vec!["1", "-2.5", "a", "x", "y", "z", "nx", ",", ";", "\"", " ", "\n", "#", "//", "\r"]), 0..60,
    )) {
        let text = words.concat();
        if let Ok(shape) = read(text.as_bytes(), Format::Table) {
            let again = read(&shape.write(&bent(&shape), None).unwrap().bytes, Format::Table).unwrap();
            prop_assert_eq!(again.positions().len(), shape.positions().len());
        }
    }
}
