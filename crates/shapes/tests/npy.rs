//! NPY: what is read, what is carried over, what is refused.

mod files;

use files::{bent, check_data_files, read, refusal};
use neuralmls_shapes::{Format, Shape};
use proptest::prelude::*;

fn npy(bytes: &[u8]) -> Shape {
    read(bytes, Format::Npy).unwrap_or_else(|error| panic!("{error}"))
}

/// A file of a version with a header of this text, and numbers behind it.
fn file(version: u8, dictionary: &str, numbers: &[u8]) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY".to_vec();
    bytes.extend([version, 0]);
    let length_size = if version == 1 { 2 } else { 4 };
    let length = (dictionary.len() + 1).next_multiple_of(16);
    bytes.extend(&(length as u32).to_le_bytes()[..length_size]);
    bytes.extend(format!("{dictionary:<0$}\n", length - 1).bytes());
    bytes.extend(numbers);
    bytes
}

/// Numbers of a dtype.
fn numbers(descr: &str, values: &[f64]) -> Vec<u8> {
    let one = |value: f64| match descr {
        "<f4" => (value as f32).to_le_bytes().to_vec(),
        ">f4" => (value as f32).to_be_bytes().to_vec(),
        "<f8" => value.to_le_bytes().to_vec(),
        ">f8" => value.to_be_bytes().to_vec(),
        _ => unreachable!(),
    };
    values.iter().flat_map(|&value| one(value)).collect()
}

fn dictionary(descr: &str, fortran: bool, shape: &str) -> String {
    let fortran = if fortran { "True" } else { "False" };
    format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}")
}

#[test]
fn every_version_type_and_order_reads_the_same() {
    let rows = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let columns = [1.0, 4.0, 2.0, 5.0, 3.0, 6.0];
    for version in 1..=3 {
        for descr in ["<f4", ">f4", "<f8", ">f8"] {
            for fortran in [false, true] {
                let stored = numbers(descr, if fortran { &columns } else { &rows });
                let bytes = file(version, &dictionary(descr, fortran, "(2, 3)"), &stored);
                let shape = npy(&bytes);
                assert_eq!((shape.dim(), shape.positions()), (3, &rows[..]));
                assert!(shape.faces().is_none());
                assert_eq!(shape.write(&rows, None).unwrap().bytes, bytes);
                let moved = [1.0, 2.5, 3.0, 4.0, 5.0, 7.0];
                let written = shape.write(&moved, None).unwrap().bytes;
                assert_eq!(npy(&written).positions(), moved);
                let changed = bytes.iter().zip(&written).filter(|(a, b)| a != b).count();
                assert!(bytes.len() == written.len() && (2..=8).contains(&changed), "{changed}");
            }
        }
    }
}

#[test]
fn one_two_and_more_columns() {
    let stored = numbers("<f8", &[1., 2., 3., 4., 5., 6., 7., 8., 9., 10.]);
    let shape = |text: &str| npy(&file(1, &dictionary("<f8", false, text), &stored));
    assert_eq!((shape("(10,)").dim(), shape("(10L,)").positions().len()), (1, 10));
    assert_eq!((shape("(10, 1)").dim(), shape("(5, 2)").dim()), (1, 2));
    let wide = shape("(2,5)");
    assert_eq!((wide.dim(), wide.positions()), (3, &[1., 2., 3., 6., 7., 8.][..]));
    assert!(wide.facts().contains(&("columns behind the third".into(), "2 (carried over)".into())));
    let written = wide.write(&[0.; 6], None).unwrap().bytes;
    assert_eq!(written[written.len() - 80..], numbers("<f8", &[0., 0., 0., 4., 5., 0., 0., 0., 9., 10.]));
    let longer = shape("(2, 3)");
    assert!(longer.facts().contains(&("behind the array".into(), "32 bytes (carried over)".into())));
}

#[test]
fn images_of_points_and_triangles_are_points_in_their_order() {
    let rows: Vec<f64> = (0..24).map(f64::from).collect();
    // NumPy's np.asfortranarray(np.arange(24.0).reshape(2, 4, 3)) holds them so.
    let fortran: Vec<f64> = (0..3)
        .flat_map(|k| (0..4).flat_map(move |j| (0..2).map(move |i| f64::from(12 * i + 3 * j + k))))
        .collect();
    for (stored, is_fortran) in [(&rows, false), (&fortran, true)] {
        let bytes = file(1, &dictionary("<f8", is_fortran, "(2, 4, 3)"), &numbers("<f8", stored));
        let shape = npy(&bytes);
        assert_eq!((shape.dim(), shape.positions()), (3, &rows[..]));
        assert!(shape.facts()[0].1.starts_with("2 x 4 x 3, float64"), "{:?}", shape.facts());
        let mut moved = rows.clone();
        moved[15] = 99.0; // row (1, 1), x
        let written = shape.write(&moved, None).unwrap().bytes;
        assert_eq!(npy(&written).positions(), moved);
        assert_eq!(written[..bytes.len() - 192], bytes[..bytes.len() - 192]);
    }
    let triangles = npy(&file(1, &dictionary("<f4", false, "(1, 3, 3)"), &numbers("<f4", &rows[..9])));
    assert_eq!(triangles.positions().len(), 9);
    let mut nan = rows[..12].to_vec();
    nan[7] = f64::NAN;
    let message =
        refusal(&file(1, &dictionary("<f8", false, "(2, 2, 3)"), &numbers("<f8", &nan)), Format::Npy);
    assert!(message.ends_with("row (1, 0), column 1: expected a finite number, found NaN"), "{message}");
    let huge = "(4294967296, 4294967296, 3)";
    assert!(refusal(&file(1, &dictionary("<f8", false, huge), &[0; 96]), Format::Npy).contains("shape"));
}

#[test]
fn what_is_not_plain_floats_is_refused() {
    let stored = [0; 96];
    for descr in ["|O", "<i4", "|u1", "<f2", "<f16", "<c16", "|b1", "<U3", "", "é", "f4"] {
        let message = refusal(&file(1, &dictionary(descr, false, "(2, 3)"), &stored), Format::Npy);
        assert!(message.contains("expected float32 or float64") && message.contains(descr), "{message}");
    }
    let structured = "{'descr': [('x', '<f4'), ('y', '<f4')], 'fortran_order': False, 'shape': (2,)}";
    assert!(refusal(&file(1, structured, &stored), Format::Npy).contains("structured"));
    for shape in ["()", "(2, 3, 1)", "(2, 0)"] {
        let message = refusal(&file(1, &dictionary("<f8", false, shape), &stored), Format::Npy);
        assert!(message.contains("shape"), "{message}");
    }
    let not_finite = numbers("<f8", &[0., 1., 2., 3., f64::NAN, 5.]);
    let message = refusal(&file(1, &dictionary("<f8", false, "(2, 3)"), &not_finite), Format::Npy);
    assert!(message.contains("row 1, column 1") && message.contains("byte"), "{message}");
}

#[test]
fn broken_and_hostile_headers_are_refused() {
    let huge = "18446744073709551615";
    for shape in ["(2147483648, 3)".to_string(), format!("({huge}, {huge})"), "(1, 13)".into()] {
        let message = refusal(&file(1, &dictionary("<f8", false, &shape), &[0; 96]), Format::Npy);
        assert!(message.contains("only 96 left"), "{message}");
    }
    for (dictionary, words) in [
        ("", "'{'"),
        ("{'descr': '<f8', 'shape': (2, 3)}", "lacks"),
        ("{'descr': '<f8', 'fortran_order': 1, 'shape': (2, 3)}", "True or False"),
        ("{'descr': '<f8', 'fortran_order': False, 'shape': (-2, 3)}", "a length"),
        ("{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999999999999, 3)}", "a length"),
        ("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3}", "')'"),
        ("{'descr: 1", "a string that ends"),
        ("{'magic': 1}", "'descr'"),
    ] {
        let message = refusal(&file(2, dictionary, &[0; 96]), Format::Npy);
        assert!(message.contains(words), "{message} lacks {words}");
    }
    let mut endless = file(2, &dictionary("<f8", false, "(2, 3)"), &[0; 48]);
    endless[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(refusal(&endless, Format::Npy).contains("ends within its header"));
    assert!(refusal(b"\x93NUMPY\x09\0", Format::Npy).contains("version"));
    assert!(refusal(b"PK\x03\x04", Format::Npy).contains("NUMPY"));
    let whole = file(1, &dictionary("<f4", false, "(2, 3)"), &[0; 24]);
    for length in 0..whole.len() {
        assert!(read(&whole[..length], Format::Npy).is_err(), "{length}");
    }
}

#[test]
fn a_position_beyond_float32_is_refused() {
    let shape = npy(&file(1, &dictionary("<f4", false, "(1, 2)"), &[0; 8]));
    assert!(shape.write(&[0.0, 1e39], None).unwrap_err().to_string().contains("position 0 "));
}

#[test]
fn real_files_keep_everything() {
    let refused = check_data_files(Format::Npy, 2e-7, |_, before, after| before == after);
    // Points that a depth camera did not see.
    let known = ["organised.npy", "organised_hw3.npy"];
    assert!(refused.iter().all(|name| known.contains(&name.as_str())), "{refused:?}");
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused(body in prop::collection::vec(any::<u8>(), 0..200), magic in any::<bool>()) {
        let head: &[u8] = if magic { b"\x93NUMPY\x01\0" } else { b"" };
        let _ = read(&[head, &body].concat(), Format::Npy);
    }

    #[test]
    fn a_damaged_file_is_read_or_refused(damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
        let mut bytes = file(1, &dictionary("<f4", true, "(2, 4)"), &[0; 32]);
        for (at, byte) in damage {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Ok(shape) = read(&bytes, Format::Npy) {
            let _ = shape.write(&bent(&shape), None);
        }
    }

    #[test]
    fn generated_files_round_trip(
        descr in prop::sample::select(vec!["<f4", ">f4", "<f8", ">f8"]), fortran in any::<bool>(),
        rows in 1usize..9, columns in 1usize..6, version in 1u8..=3, shift in -9i8..9
    ) {
        let values: Vec<f64> = (0..rows * columns).map(|k| k as f64 * 0.5).collect();
        let bytes = file(version, &dictionary(descr, fortran, &format!("({rows}, {columns})")), &numbers(descr, &values));
        let shape = npy(&bytes);
        prop_assert_eq!(shape.dim(), columns.min(3));
        for row in 0..rows {
            let at = if fortran { row } else { row * columns };
            prop_assert_eq!(shape.positions()[row * shape.dim()], values[at]);
        }
        let moved: Vec<f64> = shape.positions().iter().map(|c| c + f64::from(shift)).collect();
        let again = npy(&shape.write(&moved, None).unwrap().bytes);
        prop_assert_eq!(again.positions(), &moved[..]);
        prop_assert_eq!(again.write(shape.positions(), None).unwrap().bytes, bytes);
    }
}
