//! Normals turn with the surface: by the inverse transpose of the local map.

use crate::error::Error;
use crate::memory;

/// The cofactor matrix of a row-major 3 x 3 matrix: `det(M) M^-T`, defined for singular maps too. A face's normal
/// `a x b` becomes `(M a) x (M b) = cof(M) (a x b)`, so that normals stay on the side of the winding even under a reflection.
pub(crate) fn cofactor(m: &[f64; 9]) -> [f64; 9] {
    let [a, b, c, d, e, f, g, h, i] = *m;
    [
        e * i - f * h,
        f * g - d * i,
        d * h - e * g,
        c * h - b * i,
        a * i - c * g,
        b * g - a * h,
        b * f - c * e,
        c * d - a * f,
        a * e - b * d,
    ]
}

/// `m v` for a row-major 3 x 3 matrix.
pub(crate) fn apply(m: &[f64; 9], v: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|r| m[3 * r] * v[0] + m[3 * r + 1] * v[1] + m[3 * r + 2] * v[2])
}

/// The normal `n` turned by the inverse transpose of `map`, as long as it was. A map that crushes it leaves it as it was.
pub(crate) fn turn(map: &[f64; 9], n: [f64; 3]) -> [f64; 3] {
    let turned = apply(&cofactor(map), n);
    let (was, is) = (length(n), length(turned));
    if is > 0.0 && is.is_finite() {
        turned.map(|c| c * (was / is))
    } else {
        n
    }
}

/// The map of position `index` among row-major 3 x 3 maps.
pub(crate) fn map_at(maps: &[f64], index: usize) -> &[f64; 9] {
    maps[9 * index..9 * index + 9].try_into().expect("nine numbers a map")
}

pub(crate) fn length(v: [f64; 3]) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The area normal (twice the area long) of a triangle of `positions`.
pub(crate) fn face_normal(positions: &[f64], face: [u32; 3]) -> [f64; 3] {
    let at = |i: u32| -> [f64; 3] { std::array::from_fn(|k| positions[3 * i as usize + k]) };
    let [a, b, c] = face.map(at);
    let edge = |p: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| p[k] - a[k]) };
    cross(edge(b), edge(c))
}

/// The smallest rotation a position that takes the mean normal of the faces around it to what that became. What a caller
/// who has no local maps gets.
pub(crate) fn maps_from_faces(before: &[f64], after: &[f64], faces: &[[u32; 3]]) -> Result<Vec<f64>, Error> {
    let vertex_normals = |positions: &[f64]| -> Result<_, Error> {
        let mut sums = memory::filled([0.0; 3], positions.len() / 3)?;
        for &face in faces {
            let normal = face_normal(positions, face);
            for index in face {
                for k in 0..3 {
                    sums[index as usize][k] += normal[k];
                }
            }
        }
        Ok(sums)
    };
    let mut maps = memory::with_room(3 * before.len())?;
    for (a, b) in vertex_normals(before)?.into_iter().zip(vertex_normals(after)?) {
        maps.extend(rotation_between(a, b));
    }
    Ok(maps)
}

/// The smallest rotation that takes the direction of `a` to that of `b` (Rodrigues); the identity where one has no length.
fn rotation_between(a: [f64; 3], b: [f64; 3]) -> [f64; 9] {
    const IDENTITY: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let (la, lb) = (length(a), length(b));
    if !(la > 0.0 && lb > 0.0 && la.is_finite() && lb.is_finite()) {
        return IDENTITY;
    }
    let (a, b) = (a.map(|c| c / la), b.map(|c| c / lb));
    let [x, y, z] = cross(a, b);
    let cos = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    if cos < -0.999_999 {
        // Half a turn about any axis across `a`.
        let helper = if a[0].abs() < 0.5 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let axis = cross(a, helper);
        let l = length(axis);
        let [x, y, z] = axis.map(|c| c / l);
        return [
            2.0 * x * x - 1.0,
            2.0 * x * y,
            2.0 * x * z,
            2.0 * x * y,
            2.0 * y * y - 1.0,
            2.0 * y * z,
            2.0 * x * z,
            2.0 * y * z,
            2.0 * z * z - 1.0,
        ];
    }
    let k = 1.0 / (1.0 + cos);
    [
        cos + k * x * x,
        k * x * y - z,
        k * x * z + y,
        k * x * y + z,
        cos + k * y * y,
        k * y * z - x,
        k * x * z - y,
        k * y * z + x,
        cos + k * z * z,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_normal_turns_by_the_inverse_transpose() {
        let squeeze = [2.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let s = 0.5f64.sqrt();
        let n = turn(&squeeze, [s, s, 0.0]);
        assert!((n[1] / n[0] - 2.0).abs() < 1e-12 && (length(n) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_map_that_crushes_a_normal_leaves_it() {
        assert_eq!(turn(&[0.0; 9], [0.0, 1.0, 0.0]), [0.0, 1.0, 0.0]);
    }

    #[test]
    fn the_rotation_between_two_directions_takes_one_to_the_other() {
        for (a, b) in [
            ([1.0, 0.0, 0.0], [0.0, 2.0, 0.0]),
            ([1.0, 2.0, 3.0], [-1.0, -2.0, -3.0]),
            ([0.0, 0.0, 1.0], [0.1, 0.0, 1.0]),
        ] {
            let r = apply(&rotation_between(a, b), a);
            for k in 0..3 {
                assert!((r[k] / length(a) - b[k] / length(b)).abs() < 1e-9, "{a:?} {b:?} {r:?}");
            }
        }
    }
}
