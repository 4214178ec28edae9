use super::*;
use proptest::prelude::*;

fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn axes() -> impl Strategy<Value = [f64; 3]> {
    prop_oneof![
        Just([1.0, 0.0, 0.0]),
        Just([0.0, -1.0, 0.0]),
        Just([0.0, 0.0, 1e-200]),
        Just([1e200, 1e200, 0.0]),
        prop::array::uniform3(-1.0..1.0f64).prop_filter("an axis", |axis| axis != &[0.0; 3]),
    ]
}

fn angles() -> impl Strategy<Value = f64> {
    prop_oneof![
        prop::sample::select(vec![0.0, 1e-13, 1e-6, 30.0, 90.0, 179.999_999, 180.0, -180.0, 720.0]),
        -360.0..360.0
    ]
}

proptest! {
    #[test]
    fn any_rotation_is_an_orientation(axis in axes(), degrees in angles()) {
        let r = Orientation::new(axis, degrees, 2.0).unwrap().matrix();
        check_rotation(&r, 3).unwrap();
        let again = Orientation::of_matrix(&r, 3, 2.0).unwrap();
        prop_assert!(difference(&again.matrix(), &r) < 1e-14);
    }

    #[test]
    fn in_the_plane_too(degrees in angles()) {
        let r = Orientation::new(AXIS, degrees, 1.0).unwrap().rotation(2);
        prop_assert!(difference(&Orientation::of_matrix(&r, 2, 1.0).unwrap().rotation(2), &r) < 1e-14);
    }

    #[test]
    fn orientations_add_up_and_stay_in_the_plane(a in angles(), b in angles()) {
        let both = Orientation::new(AXIS, a, 2.0).unwrap().then(&Orientation::new(AXIS, b, 3.0).unwrap());
        prop_assert!(both.fits(2));
        prop_assert_eq!(both.scale, 6.0);
        let sum = Orientation::new(AXIS, a + b, 1.0).unwrap();
        prop_assert!(difference(&both.rotation(2), &sum.rotation(2)) < 1e-13);
    }
}

#[test]
fn a_quarter_about_z_takes_x_to_y() {
    let r = Orientation::new([0.0, 0.0, 2.0], 90.0, 1.0).unwrap().matrix();
    assert!(difference(&r, &[0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]) < 1e-15);
}

#[test]
fn what_is_no_rotation_is_refused() {
    let says = |matrix: &[f64], dim| Orientation::of_matrix(matrix, dim, 1.0).unwrap_err().message;
    let mirror = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0];
    assert!(says(&mirror, 3).ends_with("determinant is -1, as a reflection's"));
    assert!(says(&[2.0, 0.0, 0.0, 2.0], 2).ends_with("not orthonormal, off by 3"));
    assert!(says(&[f64::NAN; 4], 2).contains("not finite"));
    assert!(says(&[1.0; 6], 2).contains("found 6 numbers"));
}

#[test]
fn numbers_out_of_range_are_named() {
    let says = |axis, degrees, scale| Orientation::new(axis, degrees, scale).unwrap_err().message;
    assert_eq!(
        says([0.0; 3], 1.0, 1.0),
        "axis: expected three finite numbers that are not all 0, found [0.0, 0.0, 0.0]"
    );
    assert_eq!(says(AXIS, f64::NAN, 1.0), "degrees: expected a finite number, found nan");
    assert_eq!(says(AXIS, 1.0, -2.0), "scale: expected a number above 0, found -2.0");
}
