//! A plane, and what is on the other side of it.

use crate::mls::eigen;
use crate::weights::shape_graph::Position;

/// `normal . x = offset`, the normal of length 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mirror {
    pub(crate) normal: Position,
    pub(crate) offset: f64,
}

impl Mirror {
    pub(crate) fn height(&self, x: &Position) -> f64 {
        dot(&self.normal, x) - self.offset
    }

    /// `x - 2 (n . x - o) n`.
    pub(crate) fn image(&self, x: &Position) -> Position {
        let height = self.height(x);
        std::array::from_fn(|k| x[k] - 2.0 * height * self.normal[k])
    }

    /// The plane that brings points nearest to those they are matched with: about the centroids, `min_n n . (sum x y^T + y x^T) n`.
    pub(super) fn between(pairs: &[(Position, Position)]) -> Mirror {
        let count = pairs.len().max(1) as f64;
        let mean = |of: fn(&(Position, Position)) -> &Position| -> Position {
            std::array::from_fn(|k| pairs.iter().map(|pair| of(pair)[k]).sum::<f64>() / count)
        };
        let (x, y) = (mean(|pair| &pair.0), mean(|pair| &pair.1));
        let mut both = [[0.0; 3]; 3];
        for (p, q) in pairs {
            for i in 0..3 {
                for k in 0..3 {
                    both[i][k] += (p[i] - x[i]) * (q[k] - y[k]) + (q[i] - y[i]) * (p[k] - x[k]);
                }
            }
        }
        let (values, vectors) = eigen(both);
        let least = (1..3).fold(0, |least, i| if values[i] < values[least] { i } else { least });
        let normal = unit(std::array::from_fn(|k| vectors[k][least]));
        Mirror { normal, offset: 0.5 * (dot(&normal, &x) + dot(&normal, &y)) }
    }
}

pub(crate) fn dot(a: &Position, b: &Position) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

pub(crate) fn cross(a: &Position, b: &Position) -> Position {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn unit(a: Position) -> Position {
    let length = dot(&a, &a).sqrt();
    if length > 0.0 {
        a.map(|c| c / length)
    } else {
        a
    }
}
