//! The one motion that best takes a few points, as one piece, to where each of them was to go.
//!
//! `y_i = s R (p_i - p*) + q*` with the centroids `p*`, `q*` and the rotation `R` of [`Global`]: the best in the least-squares sense
//! (Kabsch 1976; with the scale, Umeyama 1991), never a reflection, and of those that fit as well, as two points or points on a line leave
//! many, the one nearest to no rotation.

use super::global::Global;

/// Where a piece goes.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// The moved points, m x dim.
    pub places: Vec<f64>,
    /// `s R`, dim x dim, row-major.
    pub linear: Vec<f64>,
}

/// The best rigid motion of the points `p` (m x dim) to `q`, or with `scaled` the best similarity: there the scale stays 1 where the targets
/// leave none above 0. What is not moved stays, bit for bit.
///
/// # Panics
/// Where `p` and `q` are not as many points, at least one, of `dim` = 1, 2 or 3 coordinates.
///
/// ```
/// use neuralmls_core::piece;
/// let moved = piece(&[0.0, 0.0, 1.0, 0.0], &[0.0, 0.0, 0.0, 3.0], 2, false); // a quarter turn, and pulled apart
/// let expected = [0.0, 1.0, 0.0, 2.0];
/// assert!(moved.places.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-8));
/// ```
pub fn piece(p: &[f64], q: &[f64], dim: usize, scaled: bool) -> Piece {
    assert!((1..=3).contains(&dim) && !p.is_empty() && p.len() == q.len() && p.len().is_multiple_of(dim));
    match dim {
        1 => of::<1>(p, q, scaled),
        2 => of::<2>(p, q, scaled),
        _ => of::<3>(p, q, scaled),
    }
}

fn of<const D: usize>(p: &[f64], q: &[f64], scaled: bool) -> Piece {
    let (sources, targets) = (p.as_chunks::<D>().0, q.as_chunks::<D>().0);
    if p == q {
        let identity = (0..D * D).map(|at| f64::from(u8::from(at % (D + 1) == 0))).collect();
        return Piece { places: q.to_vec(), linear: identity };
    }
    let best = Global::new(sources, targets, &[]);
    let scale = if scaled && best.scale > 0.0 { best.scale } else { 1.0 };
    let linear = best.rotation.map(|row| row.map(|e| scale * e));
    let (from, to) = (centre(sources), centre(targets));
    let place = |point: &[f64; D]| -> [f64; D] {
        std::array::from_fn(|r| to[r] + (0..D).map(|c| linear[r][c] * (point[c] - from[c])).sum::<f64>())
    };
    Piece { places: sources.iter().flat_map(place).collect(), linear: linear.as_flattened().to_vec() }
}

/// The mean, relative to the first one, so that what is far from the origin keeps its digits.
fn centre<const D: usize>(points: &[[f64; D]]) -> [f64; D] {
    let first = points[0];
    let count = points.len() as f64;
    std::array::from_fn(|k| first[k] + points.iter().map(|point| (point[k] - first[k]) / count).sum::<f64>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn apply(linear: &[f64], x: &[f64], dim: usize) -> Vec<f64> {
        (0..dim).map(|r| (0..dim).map(|c| linear[dim * r + c] * x[c]).sum()).collect()
    }

    /// A rotation of space by the angles about x and z.
    fn turn(a: f64, b: f64) -> [f64; 9] {
        let ((s, c), (t, d)) = (a.sin_cos(), b.sin_cos());
        [d, -t * c, t * s, t, d * c, -d * s, 0.0, s, c]
    }

    fn squares(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
    }

    proptest! {
        #[test]
        fn a_similarity_is_found_and_a_rigid_motion_is_what_is_left_of_it(
            p in prop::collection::vec(-1.0..1.0f64, 15), (a, b) in (-3.0..3.0f64, -3.0..3.0f64), s in 0.2..4.0f64,
        ) {
            let q: Vec<f64> = p.chunks(3).flat_map(|x| apply(&turn(a, b), x, 3)).map(|c| s * c + 7.0).collect();
            let found = piece(&p, &q, 3, true);
            prop_assert!(squares(&found.places, &q) < 1e-18);
            let rigid = piece(&p, &q, 3, false);
            let error: f64 = rigid.linear.iter().zip(turn(a, b)).map(|(x, y)| (x - y).abs()).sum();
            prop_assert!(error < 1e-7, "{error}");
        }

        /// Distances stay, and no rotation and shift nearby comes nearer to the targets.
        #[test]
        fn no_other_motion_fits_better(
            p in prop::collection::vec(-1.0..1.0f64, 12), q in prop::collection::vec(-1.0..1.0f64, 12),
            (a, b) in (-0.1..0.1f64, -0.1..0.1f64), by in prop::collection::vec(-0.1..0.1f64, 3),
        ) {
            let found = piece(&p, &q, 3, false);
            for i in 1..4 {
                let length = |x: &[f64]| squares(&x[..3], &x[3 * i..][..3]);
                prop_assert!((length(&found.places) - length(&p)).abs() < 1e-9);
            }
            let other: Vec<f64> = found.places.chunks(3)
                .flat_map(|x| apply(&turn(a, b), x, 3).into_iter().zip(by.clone()).map(|(c, by)| c + by).collect::<Vec<_>>()).collect();
            prop_assert!(squares(&found.places, &q) <= squares(&other, &q) + 1e-9);
        }
    }

    #[test]
    fn two_points_turn_the_least() {
        // From x to y, about z and by a quarter: not about themselves.
        let found = piece(&[0.0, 0.0, 0.0, 2.0, 0.0, 0.0], &[1.0, 0.0, 0.0, 1.0, 2.0, 0.0], 3, false);
        let quarter = [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        assert!(squares(&found.linear, &quarter) < 1e-15, "{:?}", found.linear);
    }

    #[test]
    fn one_point_moves_and_does_not_turn() {
        let found = piece(&[1.0, 2.0], &[3.0, 5.0], 2, true);
        assert_eq!(found, Piece { places: vec![3.0, 5.0], linear: vec![1.0, 0.0, 0.0, 1.0] });
    }

    #[test]
    fn what_is_not_moved_stays_bit_for_bit() {
        let p = [0.1, 0.2, 0.3, 1e6 + 0.1, 0.7, -0.2];
        assert_eq!(
            piece(&p, &p, 3, true),
            Piece { places: p.to_vec(), linear: vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0] }
        );
    }

    #[test]
    fn targets_in_one_place_leave_the_size() {
        let found = piece(&[0.0, 0.0, 1.0, 0.0], &[5.0, 5.0, 5.0, 5.0], 2, true);
        assert_eq!(found.places, [4.5, 5.0, 5.5, 5.0]);
    }

    #[test]
    fn mirrored_targets_do_not_mirror() {
        let found = piece(&[0.0, 1.0], &[0.0, -1.0], 1, true);
        assert_eq!((found.places, found.linear), (vec![-1.0, 0.0], vec![1.0]));
    }
}
