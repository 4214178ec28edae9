//! A plane brought to where the mirrored shape lies best on the shape.
//!
//! First by matched points (Besl, McKay, "A method for registration of 3-D shapes", 1992; trimmed as by Chetverikov et al., 2002), which come
//! from far; then by how far they are from the surface (Chen, Medioni, "Object modelling by registration of multiple range images",
//! 1992), which ends exactly.

use super::mirror::{cross, dot, unit, Mirror};
use super::samples::Samples;
use crate::machine::parallel::for_each_block;
use crate::weights::shape_graph::{Found, Position};

const MATCHED: usize = 8;
/// Of the pairs, the nearest.
const TRIM: f64 = 0.8;
const STEPS: usize = 15;
/// A plane with which the mirrored places are half as many floors (of the 90th percentile) off, none counted for more, is not brought nearer.
const HOPELESS: f64 = 4.0;
/// Of the mirrored places, so many take part in matching, and in steps.
const FEW: usize = 500;
const MORE: usize = 1_000;
/// How much it counts along the surface that points are not in the same place: nothing else holds a flat shape.
const ALONG: f64 = 0.02;
const BLOCK: usize = 125;
/// A step below this, in halves of the longest side or radians, is the last.
const STILL: f64 = 1e-6;

/// Each of the first `count` mirrored places: where it goes, and the number of the nearest target and the square of how far that is.
fn matches(samples: &Samples, mirror: &Mirror, count: usize) -> Vec<(Position, u32, f64)> {
    of_each(samples, mirror, count, f64::INFINITY, |image, found| (*image, found[0].1, found[0].0))
}

/// How far each of the first `count` mirrored places is from the shape, at most `most`.
pub(super) fn away(samples: &Samples, mirror: &Mirror, count: usize, most: f64) -> Vec<f64> {
    of_each(samples, mirror, count, most * most, |_, found| {
        found.first().map_or(most, |(square, _)| square.sqrt())
    })
}

fn of_each<T: Send + Clone + Default>(
    samples: &Samples,
    mirror: &Mirror,
    count: usize,
    bound: f64,
    tell: impl Fn(&Position, &[Found]) -> T + Sync + Send,
) -> Vec<T> {
    let mirrored = &samples.mirrored[..count.min(samples.mirrored.len())];
    let mut told = vec![T::default(); mirrored.len()];
    for_each_block(&mut told, BLOCK, |block, told| {
        let mut found = Vec::new();
        for (at, one) in told.iter_mut().enumerate() {
            let image = mirror.image(&mirrored[block * BLOCK + at]);
            samples.near.nearest(&image, 1, bound, |_| true, &mut found);
            *one = tell(&image, &found);
        }
    });
    told
}

pub(super) fn refined(samples: &Samples, mut mirror: Mirror) -> Mirror {
    for _ in 0..MATCHED {
        let mut pairs: Vec<(f64, Position, Position)> = matches(samples, &mirror, FEW)
            .into_iter()
            .zip(&samples.mirrored)
            .map(|((_, target, square), x)| (square, *x, samples.targets[target as usize]))
            .collect();
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        pairs.truncate((TRIM * pairs.len() as f64).ceil() as usize);
        let next = Mirror::between(&pairs.into_iter().map(|(_, x, y)| (x, y)).collect::<Vec<_>>());
        let side = dot(&next.normal, &mirror.normal).signum();
        mirror = Mirror { normal: next.normal.map(|c| side * c), offset: side * next.offset };
    }
    let most = HOPELESS * samples.floor[1];
    let off: f64 = away(samples, &mirror, FEW, most).iter().sum();
    if off > 0.5 * most * FEW.min(samples.mirrored.len()) as f64 {
        return mirror;
    }
    for _ in 0..STEPS {
        let (next, size) = stepped(samples, &mirror);
        mirror = next;
        if size < STILL {
            break;
        }
    }
    mirror
}

/// One step of Gauss and Newton for `sum c(r) r^2`, `r` of the distance from the surface, `c` Cauchy's weights.
fn stepped(samples: &Samples, mirror: &Mirror) -> (Mirror, f64) {
    let n = mirror.normal;
    let least = (1..3).fold(0, |least, k| if n[k].abs() < n[least].abs() { k } else { least });
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let a = unit(cross(&n, &axis));
    let b = cross(&n, &a);
    let (mut matrix, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
    for ((image, target, square), x) in matches(samples, mirror, MORE).into_iter().zip(&samples.mirrored) {
        let (y, normal) = (&samples.targets[target as usize], &samples.normals[target as usize]);
        let off: Position = std::array::from_fn(|k| image[k] - y[k]);
        let height = mirror.height(x);
        // How the image moves as the plane is shifted, and turned towards a and b.
        let turned = |towards: &Position| -> Position {
            std::array::from_fn(|k| -2.0 * (dot(towards, x) * n[k] + height * towards[k]))
        };
        let moves = [n.map(|c| 2.0 * c), turned(&a), turned(&b)];
        let out = dot(&off, normal);
        let flat = if *normal == [0.0; 3] { 1.0 } else { ALONG };
        let distance = (out * out + flat * (square - out * out).max(0.0)).sqrt();
        let counts = 1.0 / (1.0 + (distance / samples.floor[1]).powi(2));
        for i in 0..3 {
            let (own, over) = (dot(&moves[i], normal), dot(&moves[i], &off));
            right[i] -= counts * (own * out * (1.0 - flat) + flat * over);
            for k in 0..3 {
                let other = dot(&moves[k], normal);
                matrix[i][k] += counts * (own * other * (1.0 - flat) + flat * dot(&moves[i], &moves[k]));
            }
        }
    }
    let trace: f64 = (0..3).map(|k| matrix[k][k]).sum();
    (0..3).for_each(|k| matrix[k][k] += 1e-9 * trace);
    let [shift, to_a, to_b] = solved(&matrix, &right);
    let normal = unit(std::array::from_fn(|k| n[k] + to_a * a[k] + to_b * b[k]));
    (Mirror { normal, offset: mirror.offset + shift }, shift.abs().max(to_a.abs()).max(to_b.abs()))
}

/// Cramer's rule; no step where there is no one solution.
fn solved(m: &[[f64; 3]; 3], right: &[f64; 3]) -> [f64; 3] {
    let whole = dot(&m[0], &cross(&m[1], &m[2]));
    let of = |k: usize| {
        // The matrix is symmetric: its rows are its columns.
        let mut rows = *m;
        rows[k] = *right;
        dot(&rows[0], &cross(&rows[1], &rows[2])) / whole
    };
    let step = [of(0), of(1), of(2)];
    if step.iter().all(|c| c.is_finite()) {
        step
    } else {
        [0.0; 3]
    }
}
