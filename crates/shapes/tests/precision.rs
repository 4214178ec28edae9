//! What is told of a file's precision is what arrives in it; what is told of side files is what the shape names.

mod files;

use files::{bent, read};
use neuralmls_shapes::{Format, Shape};
use proptest::prelude::*;

const FAR: f64 = 5e6;

fn ply(kind: &str, far: f64) -> Shape {
    let mut bytes = format!("ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty {kind} x\nproperty {kind} y\nproperty {kind} z\nend_header\n").into_bytes();
    for value in [0.0, 0.0, 0.0, far, 1.0, 2.0] {
        match kind {
            "float" => bytes.extend((value as f32).to_le_bytes()),
            "double" => bytes.extend(value.to_le_bytes()),
            _ => bytes.extend((value as i32).to_le_bytes()),
        }
    }
    read(&bytes, Format::Ply).unwrap()
}

fn obj(text: &str) -> Shape {
    read(text.as_bytes(), Format::Obj).unwrap()
}

#[test]
fn the_step_is_the_distance_between_neighbouring_numbers() {
    assert_eq!(ply("float", FAR).step().unwrap(), 0.5);
    assert_eq!(ply("double", FAR).step().unwrap(), 0.0);
    assert_eq!(ply("int", FAR).step().unwrap(), 1.0);
    assert_eq!(obj("v 5000000 0 0\nv 0 0 0\n").step().unwrap(), 0.0);
}

#[test]
fn a_motion_below_the_step_does_not_arrive() {
    let shape = ply("float", FAR);
    let asked = [0.0, 0.0, 0.0, FAR + 0.05, 1.25, 2.0];
    assert_eq!(shape.round(&asked).unwrap(), [0.0, 0.0, 0.0, FAR, 1.25, 2.0]);
    // Places that are no vertices too.
    assert_eq!(shape.round(&[FAR + 0.3, 0.1, 0.0]).unwrap(), [FAR + 0.5, f64::from(0.1f32), 0.0]);
    assert_eq!(ply("double", FAR).round(&asked).unwrap(), asked);
    assert_eq!(ply("int", FAR).round(&asked).unwrap()[3..], [FAR, 1.0, 2.0]);
}

#[test]
fn text_holds_the_digits_that_are_written() {
    let shape = obj("v 0 0 0\nv 1 0.123456789012 0\n");
    let asked = [0.1 + 1e-14, 0.0, 0.0, 1.0, 0.123456789012, 1.0 / 3.0];
    let rounded = shape.round(&asked).unwrap();
    assert_eq!(rounded, [0.1, 0.0, 0.0, 1.0, 0.123456789012, 0.333333333333]);
    assert_eq!(rounded, read(&shape.write(&asked, None).unwrap().bytes, Format::Obj).unwrap().positions());
}

#[test]
fn what_does_not_fit_is_refused() {
    let shape = ply("float", 1.0);
    let message = |points: &[f64]| shape.round(points).unwrap_err().to_string();
    assert_eq!(message(&[0.0; 4]), "expected points of 3 coordinates, found 4 numbers");
    assert_eq!(message(&[0.0, 0.0, f64::NAN]), "position 0 is not finite");
}

#[test]
fn the_box_is_told_column_by_column() {
    assert_eq!(ply("float", 4.0).bounds(), (&[0.0, 0.0, 0.0][..], &[4.0, 1.0, 2.0][..]));
}

#[test]
fn libraries_that_are_missing_are_named_as_the_statement_does() {
    let shape = obj("mtllib red paint.mtl\nmtllib a.mtl b.mtl\nmtllib\nv 0 0 0\nv 1 0 0\n");
    let missing = |there: &[&str]| shape.missing_files(&|name| there.contains(&name));
    assert_eq!(missing(&[]), ["red paint.mtl", "a.mtl b.mtl"]);
    assert_eq!(missing(&["red paint.mtl", "a.mtl"]), ["b.mtl"]);
    assert!(missing(&["red paint.mtl", "a.mtl", "b.mtl"]).is_empty());
}

proptest! {
    #[test]
    fn what_is_told_is_what_is_read_again(
        values in prop::collection::vec(-1e6f64..1e6, 6), scale in -8i32..8, kind in 0usize..5,
    ) {
        let shape = match kind {
            0 => ply("float", FAR),
            1 => ply("double", FAR),
            2 => obj("v 0 0 0\nv 1.25 0.5 7\n"),
            3 => read(b"0.5 1e-3\n7 8\n2 3\n", Format::Table).unwrap(),
            _ => read(b"OFF\n2 0 0\n0 0 0\n1000000 5 1\n", Format::Off).unwrap(),
        };
        let asked: Vec<f64> =
            bent(&shape).iter().zip(&values).map(|(was, by)| was + by * 10f64.powi(scale)).collect();
        let written = shape.write(&asked, None).unwrap().bytes;
        let again = read(&written, shape.format()).unwrap();
        prop_assert_eq!(shape.round(&asked).unwrap(), again.positions());
    }
}
