//! Sources that fit the shape's box only with other axes, or in another unit: which flip or scale that is.

use crate::session::longest;
use crate::text::number;

/// How far outside of the box the sources must lie as they are, in longest sides of it.
const OUTSIDE: f64 = 0.1;
/// How far outside they may lie when they fit.
const SLACK: f64 = 0.02;
/// How much of the box's longest side they must take up in another unit.
const FILLED: f64 = 0.5;
/// So few sources fit many things.
const FEWEST: usize = 3;

/// Where each new axis comes from, with its sign, and what a person calls that.
type Flip = ([(usize, f64); 3], &'static str);

const IN_SPACE: [Flip; 7] = [
    ([(0, -1.0), (1, -1.0), (2, 1.0)], "with x and y negated, as between LPS and RAS"),
    ([(0, 1.0), (2, 1.0), (1, -1.0)], "as (x, z, -y), from Z up to Y up"),
    ([(0, 1.0), (2, -1.0), (1, 1.0)], "as (x, -z, y), from Y up to Z up"),
    ([(0, 1.0), (2, 1.0), (1, 1.0)], "with y and z swapped"),
    ([(0, -1.0), (1, 1.0), (2, 1.0)], "with x negated"),
    ([(0, 1.0), (1, -1.0), (2, 1.0)], "with y negated"),
    ([(0, 1.0), (1, 1.0), (2, -1.0)], "with z negated"),
];

const IN_THE_PLANE: [Flip; 3] = [
    ([(0, 1.0), (1, -1.0), (2, 1.0)], "with y negated, as in images"),
    ([(0, -1.0), (1, 1.0), (2, 1.0)], "with x negated"),
    ([(1, 1.0), (0, 1.0), (2, 1.0)], "with x and y swapped"),
];

/// The largest first: of several that fit, the one that fills the box best is meant.
const UNITS: [(f64, &str); 4] = [
    (1000.0, "metres and millimetres"),
    (100.0, "metres and centimetres"),
    (25.4, "inches and millimetres"),
    (10.0, "centimetres and millimetres"),
];

/// A sentence, if there is such a flip or scale. `low`, `high`: the shape's box, of the sources' dimension.
pub fn other_axes_or_unit(sources: &[f64], low: &[f64], high: &[f64]) -> Option<String> {
    let dim = low.len();
    let side = longest(low, high);
    if sources.len() / dim < FEWEST || side <= 0.0 {
        return None;
    }
    let outside = |points: &[f64]| {
        let each = points.iter().enumerate();
        each.map(|(i, c)| (low[i % dim] - c).max(c - high[i % dim])).fold(0.0, f64::max) / side
    };
    let is_outside = outside(sources) > OUTSIDE;
    if is_outside {
        let flips: &[Flip] = match dim {
            2 => &IN_THE_PLANE,
            3 => &IN_SPACE,
            _ => &[],
        };
        for (from, how) in flips {
            let flipped =
                sources.chunks_exact(dim).flat_map(|p| from[..dim].iter().map(|(k, sign)| sign * p[*k]));
            if outside(&flipped.collect::<Vec<f64>>()) <= SLACK {
                return Some(format!("the positions lie outside of the shape, but would fit it {how}"));
            }
        }
    }
    let extent = (0..dim).map(|k| extent(sources, dim, k)).fold(0.0, f64::max) / side;
    for (factor, units) in UNITS {
        // The unit of the sources is too small for the shape, or too large.
        for (times, wrong) in [(factor, extent * factor <= 1.0 + SLACK), (1.0 / factor, is_outside)] {
            let scaled: Vec<f64> = sources.iter().map(|c| c * times).collect();
            if wrong && extent * times >= FILLED && outside(&scaled) <= SLACK {
                let how = if times > 1.0 { number(times) } else { format!("1/{}", number(factor)) };
                return Some(format!(
                    "the positions are of another size than the shape, but would fit it times {how}, as between {units}"
                ));
            }
        }
    }
    None
}

fn extent(points: &[f64], dim: usize, axis: usize) -> f64 {
    let along = || points.iter().skip(axis).step_by(dim).copied();
    along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOW: [f64; 3] = [0.0, 0.0, 0.0];
    const HIGH: [f64; 3] = [6.0, 1.0, 2.0];

    fn says(sources: &[f64]) -> String {
        other_axes_or_unit(sources, &LOW, &HIGH).unwrap_or_default()
    }

    /// Corners of the box, and its middle.
    fn corners(place: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<f64> {
        [[0.0, 0.0, 0.0], [6.0, 1.0, 0.0], [0.0, 1.0, 2.0], [3.0, 0.5, 1.0]]
            .into_iter()
            .flat_map(place)
            .collect()
    }

    #[test]
    fn sources_that_fit_are_not_spoken_of() {
        assert_eq!(says(&corners(|p| p)), "");
        // Nor are those that fit nothing, or handles of a small part.
        assert_eq!(says(&corners(|[x, y, z]| [x + 20.0, y, z])), "");
        assert_eq!(says(&[3.0, 0.5, 1.0, 3.01, 0.5, 1.0, 3.0, 0.51, 1.0]), "");
    }

    #[test]
    fn flips_are_named() {
        assert!(
            says(&corners(|[x, y, z]| [-x, -y, z])).ends_with("with x and y negated, as between LPS and RAS")
        );
        assert!(says(&corners(|[x, y, z]| [x, -z, y])).ends_with("as (x, z, -y), from Z up to Y up"));
        assert!(says(&corners(|[x, y, z]| [x, z, -y])).ends_with("as (x, -z, y), from Y up to Z up"));
        assert!(says(&corners(|[x, y, z]| [x, z, y])).ends_with("with y and z swapped"));
        let flat = other_axes_or_unit(&[1.0, -1.0, 2.0, -3.0, 3.0, -2.0], &[0.0, 0.0], &[4.0, 4.0]);
        assert!(flat.unwrap().ends_with("with y negated, as in images"));
    }

    #[test]
    fn units_are_named() {
        let scaled = |by: f64| says(&corners(|p| p.map(|c| by * c)));
        assert!(scaled(1000.0).ends_with("times 1/1000, as between metres and millimetres"));
        assert!(scaled(0.001).ends_with("times 1000, as between metres and millimetres"));
        assert!(scaled(25.4).ends_with("times 1/25.4, as between inches and millimetres"));
        assert!(scaled(0.1).ends_with("times 10, as between centimetres and millimetres"));
    }
}
