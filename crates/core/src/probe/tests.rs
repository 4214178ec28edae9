//! The places that are looked at, and the small linear algebra of what is seen there.

use super::*;
use crate::geometry::Frame;
use crate::weights::inverse_distance::InverseDistance;
use nalgebra::Matrix3;
use proptest::prelude::*;

proptest! {
    #[test]
    fn stretch_and_determinant_are_those_of_nalgebra(entries in prop::array::uniform9(-3.0f64..3.0)) {
        let j: [[f64; 3]; 3] = std::array::from_fn(|r| std::array::from_fn(|c| entries[3 * r + c]));
        let matrix = Matrix3::from_fn(|r, c| j[r][c]);
        prop_assert!((stretch(&j) - matrix.singular_values().max()).abs() < 1e-6);
        prop_assert!((determinant(&j, 3) - matrix.determinant()).abs() < 1e-9);
    }
}

#[test]
fn no_place_is_refused() {
    let weights = InverseDistance::new(&[0.0], 1, Frame::IDENTITY, 1.0, 0.0).unwrap();
    assert!(Probe::new(&Weights::InverseDistance(weights), &[], 1.0, Transform::Rigid, true).is_err());
}

#[test]
fn places_lie_on_the_surface_or_are_points_of_the_cloud() {
    let x = [0.0, 0.0, 1e6, 1.0, 0.0, 1e6, 0.0, 1.0, 1e6, 3.0, 0.0, 1e6, 0.0, 5.0, 1e6];
    let on = places(&x, 3, &[[0, 1, 2]], 500).unwrap();
    assert_eq!(on.len(), 1500);
    assert!(on
        .chunks_exact(3)
        .all(|p| p[2] == 1e6 && p[0] >= -1e-9 && p[1] >= -1e-9 && p[0] + p[1] < 1.0 + 1e-9));
    assert_eq!(places(&x, 3, &[], 10).unwrap(), x);
    assert_eq!(places(&x, 3, &[], 2).unwrap(), [0.0, 0.0, 1e6, 3.0, 0.0, 1e6]);
    assert!(places(&x, 3, &[[0, 1, 9]], 2).is_err());
}
