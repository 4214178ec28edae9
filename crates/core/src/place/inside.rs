//! From the surface to the middle of the part that is there.
//!
//! The ball that touches the surface from within at a place and nowhere else crosses it: its centre is on the medial axis. Ma, Bae, Choi, "3D
//! medial axis point approximation using nearest neighbors and the normal field", 2012.

use crate::symmetry::Samples;
use crate::weights::shape_graph::{squared, Position};

/// Radius at the start, in halves of the longest side; a ball that stays so large is not in a part.
const LARGEST: f64 = 0.35;
const ROUNDS: usize = 40;
/// A ball has shrunk enough once it does by no more than this part.
const ENOUGH: f64 = 1e-3;
/// Samples that are nearer to the place than this part of the radius, by the angle at the centre, are of the surface around it, not opposite.
const OPPOSITE: f64 = 0.5;

/// The middle of the part at the place `x`, to whichever side of the surface it is; the place itself if it is on a sheet.
pub(super) fn middle(samples: &Samples, x: &Position) -> Position {
    let mut found = Vec::new();
    samples.near.nearest(x, 1, f64::INFINITY, |_| true, &mut found);
    let normal = samples.normals[found[0].1 as usize];
    if normal == [0.0; 3] {
        return *x;
    }
    let [one, other] = [1.0, -1.0].map(|side| ball(samples, x, &normal.map(|c| side * c)));
    let smaller = if one.1 < other.1 { one } else { other };
    if smaller.1 < LARGEST {
        smaller.0
    } else {
        *x
    }
}

/// Centre and radius.
fn ball(samples: &Samples, x: &Position, n: &Position) -> (Position, f64) {
    let mut radius = LARGEST;
    let centre = |radius: f64| -> Position { std::array::from_fn(|k| x[k] - radius * n[k]) };
    let mut found = Vec::new();
    for _ in 0..ROUNDS {
        let at = centre(radius);
        let touches = |sample: u32| {
            let other = &samples.targets[sample as usize];
            // What is around the place itself touches every ball.
            (0..3).map(|k| (x[k] - other[k]) * n[k]).sum::<f64>() > OPPOSITE * squared(x, other).sqrt()
        };
        samples.near.nearest(&at, 1, radius * radius, touches, &mut found);
        let Some(&(_, sample)) = found.first() else { break };
        let other = &samples.targets[sample as usize];
        let along: f64 = (0..3).map(|k| (x[k] - other[k]) * n[k]).sum();
        let next = squared(x, other) / (2.0 * along);
        if next >= radius * (1.0 - ENOUGH) {
            break;
        }
        radius = next;
    }
    (centre(radius), radius)
}
