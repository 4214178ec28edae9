//! Coordinates relative to a box: centred on it, and divided by half of its longest side.
//!
//! Computed in double precision before anything is rounded to single, so that a shape half a million metres from the origin
//! keeps its millimetres.

use crate::check::check_points;
use crate::error::Error;
use crate::machine::parallel::of_blocks;

/// `x_normalised = (x - centre) / half`: the box's longest side becomes [-1, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The box's centre; zeros beyond the dimension.
    pub centre: [f64; 3],
    /// Half of the box's longest side; > 0.
    pub half: f64,
}

impl Frame {
    /// Coordinates as they are.
    pub const IDENTITY: Frame = Frame { centre: [0.0; 3], half: 1.0 };

    /// The frame of the box from `min` to `max`.
    ///
    /// # Errors
    /// Where the box is not finite, upside down, or a single place.
    pub fn of_box(min: &[f64], max: &[f64]) -> Result<Frame, Error> {
        let dim = min.len();
        check_points("bounds", min, dim)?;
        check_points("bounds", max, dim)?;
        if max.len() != dim || min.iter().zip(max).any(|(lo, hi)| lo > hi) {
            return Err(Error::argument("bounds", "expected a smallest and a largest corner"));
        }
        let mut frame = Frame { centre: [0.0; 3], half: 0.0 };
        for k in 0..dim {
            frame.centre[k] = min[k] + 0.5 * (max[k] - min[k]);
            frame.half = frame.half.max(0.5 * (max[k] - min[k]));
        }
        if frame.half > 0.0 && frame.half.is_finite() && (1.0 / frame.half).is_finite() {
            Ok(frame)
        } else {
            Err(Error::argument(
                "bounds",
                "all points are in one place, so that there is no size to measure by",
            ))
        }
    }

    /// The frame of the box around `points`; around one place, a frame of half a side of 1 there.
    pub fn around(points: &[f64], dim: usize) -> Frame {
        /// Whole points of any dimension, at all of whose coordinates the processor looks at once.
        const SEVERAL: usize = 12;
        type Ends = ([f64; SEVERAL], [f64; SEVERAL]);
        let both = |(mut least, mut most): Ends, (l, m): Ends| {
            for k in 0..SEVERAL {
                least[k] = if l[k] < least[k] { l[k] } else { least[k] };
                most[k] = if m[k] > most[k] { m[k] } else { most[k] };
            }
            (least, most)
        };
        let ends = of_blocks(
            points,
            SEVERAL << 10,
            |block| {
                let several = block.chunks_exact(SEVERAL);
                let mut ends = ([f64::INFINITY; SEVERAL], [f64::NEG_INFINITY; SEVERAL]);
                for (k, &c) in several.remainder().iter().enumerate() {
                    (ends.0[k], ends.1[k]) = (c, c);
                }
                several.fold(ends, |ends, points| {
                    let points = points.try_into().expect("chunks of this size");
                    both(ends, (points, points))
                })
            },
            both,
        );
        let Some((least, most)) = ends else {
            return Frame::IDENTITY;
        };
        let mut min = [f64::INFINITY; 3];
        let mut max = [f64::NEG_INFINITY; 3];
        for (k, (least, most)) in least.into_iter().zip(most).enumerate() {
            min[k % dim] = min[k % dim].min(least);
            max[k % dim] = max[k % dim].max(most);
        }
        Frame::of_box(&min[..dim], &max[..dim]).unwrap_or_else(|_| {
            let mut centre = [0.0; 3];
            centre[..dim].copy_from_slice(&min[..dim]);
            Frame { centre, half: 1.0 }
        })
    }

    /// A point of the world in this frame.
    pub fn enter<const D: usize>(&self, x: &[f64]) -> [f64; D] {
        std::array::from_fn(|k| (x[k] - self.centre[k]) / self.half)
    }

    /// The same in single precision, with zeros beyond the point's dimension. Coordinates of more than 1e30 are cut off there, so
    /// that nothing that is computed from them overflows.
    pub(crate) fn enter_single(&self, x: &[f64]) -> [f32; 3] {
        let mut out = [0.0; 3];
        for (k, x) in x.iter().enumerate() {
            out[k] = ((x - self.centre[k]) / self.half).clamp(-1e30, 1e30) as f32;
        }
        out
    }

    /// Points of the world in this frame.
    pub fn enter_all(&self, points: &[f64], dim: usize) -> Vec<f64> {
        points.iter().enumerate().map(|(at, c)| (c - self.centre[at % dim]) / self.half).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_side_becomes_two() {
        let frame = Frame::of_box(&[500_000.0, 0.0], &[500_004.0, 2.0]).unwrap();
        assert_eq!(frame.enter::<2>(&[500_004.0, 2.0]), [1.0, 0.5]);
        assert_eq!(frame.enter_all(&[500_000.0, 1.0], 2), [-1.0, 0.0]);
    }

    #[test]
    fn is_around_all_points_however_many() {
        for dim in 1..4 {
            for n in [5, 4096, 30_001] {
                let mut points = vec![0.5; n * dim];
                points[0] = -3.0;
                *points.last_mut().unwrap() = 7.0;
                let (mut min, mut max) = (vec![0.5f64; dim], vec![0.5f64; dim]);
                for (at, c) in points.iter().enumerate() {
                    min[at % dim] = if at < dim { *c } else { min[at % dim].min(*c) };
                    max[at % dim] = if at < dim { *c } else { max[at % dim].max(*c) };
                }
                let expected = Frame::of_box(&min, &max).unwrap();
                assert_eq!(Frame::around(&points, dim), expected, "{n} points in {dim}D");
            }
        }
        assert_eq!(Frame::around(&[], 3), Frame::IDENTITY);
    }

    #[test]
    fn a_box_without_size_is_refused_by_name() {
        let error = Frame::of_box(&[1.0; 3], &[1.0; 3]).unwrap_err();
        assert!(error.to_string().contains("one place"), "{error}");
        assert_eq!(Frame::around(&[7.0, 7.0], 1), Frame { centre: [7.0, 0.0, 0.0], half: 1.0 });
    }
}
