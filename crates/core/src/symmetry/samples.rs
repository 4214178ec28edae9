//! Places all over a shape, and how far such places are from each other anyway.

use super::mirror::{cross, unit};
use crate::error::Error;
use crate::geometry::placement::Surface;
use crate::machine::parallel::for_each_block;
use crate::machine::random::Random;
use crate::mls::eigen;
use crate::weights::shape_graph::{Near, Position};

/// Places that are mirrored.
const MIRRORED: usize = 2_000;
/// Places among which they look for their nearest.
const TARGETS: usize = 12_000;
/// Points of a cloud by which its surface lies.
const AROUND: usize = 8;
const BLOCK: usize = 500;

/// Places of a shape.
pub(super) struct Samples {
    pub(super) mirrored: Vec<Position>,
    pub(super) targets: Vec<Position>,
    /// Of the surface at the targets; zeros where there is none.
    pub(super) normals: Vec<Position>,
    pub(super) near: Near,
    /// Median and 90th percentile of how far what is not mirrored is from the nearest target.
    pub(super) floor: [f64; 2],
}

impl Samples {
    pub(super) fn new(x: &[Position], faces: &[[u32; 3]], dim: usize) -> Result<Samples, Error> {
        let mut random = Random::new(0);
        let (mirrored, targets, normals, own) = match Surface::new(x, faces)? {
            Some(surface) => {
                let mut draw = |count: usize| -> Vec<(Position, Position)> {
                    let place =
                        |(face, place): (usize, Position)| (place, normal(x, surface.faces[face], dim));
                    (0..count).map(|_| place(surface.sample_in(&mut random))).collect()
                };
                let (targets, normals) = draw(TARGETS).into_iter().unzip();
                (draw(MIRRORED).into_iter().map(|(place, _)| place).collect(), targets, normals, false)
            }
            None => {
                let mut some: Vec<u32> = (0..x.len() as u32).collect();
                random.choose(&mut some, TARGETS + MIRRORED);
                let all: Vec<Position> = some.iter().map(|&point| x[point as usize]).collect();
                // Of a small cloud the same points are both.
                let own = all.len() < TARGETS + MIRRORED;
                let (targets, mirrored) =
                    if own { (&all[..], &all[..all.len().min(MIRRORED)]) } else { all.split_at(TARGETS) };
                (mirrored.to_vec(), targets.to_vec(), Vec::new(), own)
            }
        };
        let near = Near::new(&targets);
        let normals = if normals.is_empty() { of_cloud(&targets, &near, dim) } else { normals };
        let mut away = vec![0.0; mirrored.len()];
        for_each_block(&mut away, BLOCK, |block, away| {
            let mut found = Vec::new();
            for (at, away) in away.iter_mut().enumerate() {
                let at = block * BLOCK + at;
                near.nearest(
                    &mirrored[at],
                    1,
                    f64::INFINITY,
                    |other| !own || other as usize != at,
                    &mut found,
                );
                *away = found.first().map_or(0.0, |(square, _)| square.sqrt());
            }
        });
        away.sort_by(f64::total_cmp);
        let part = |part: f64| away[(part * (away.len() - 1) as f64).round() as usize];
        let floor = [part(0.5), part(0.9)];
        Ok(Samples { mirrored, targets, normals, near, floor })
    }
}

/// Of a face; a shape in the plane has none.
fn normal(x: &[Position], face: [u32; 3], dim: usize) -> Position {
    if dim < 3 {
        return [0.0; 3];
    }
    let [a, b, c] = face.map(|corner| x[corner as usize]);
    let to = |p: Position| -> Position { std::array::from_fn(|k| p[k] - a[k]) };
    unit(cross(&to(b), &to(c)))
}

/// Of the points around each point: across them they are thinnest.
fn of_cloud(x: &[Position], near: &Near, dim: usize) -> Vec<Position> {
    let mut normals = vec![[0.0; 3]; x.len()];
    if dim == 3 {
        for_each_block(&mut normals, BLOCK, |block, normals| {
            let mut found = Vec::new();
            for (at, normal) in normals.iter_mut().enumerate() {
                near.nearest(&x[block * BLOCK + at], AROUND + 1, f64::INFINITY, |_| true, &mut found);
                let around: Vec<Position> = found.iter().map(|&(_, other)| x[other as usize]).collect();
                let (values, vectors) = eigen(moments(&around).1);
                let least = (1..3).fold(0, |least, i| if values[i] < values[least] { i } else { least });
                *normal = unit(std::array::from_fn(|k| vectors[k][least]));
            }
        });
    }
    normals
}

/// The centroid, and the second moments about it.
pub(super) fn moments(x: &[Position]) -> (Position, [[f64; 3]; 3]) {
    let count = x.len() as f64;
    let mean: Position = std::array::from_fn(|k| x.iter().map(|x| x[k]).sum::<f64>() / count);
    let moment = |i: usize, k: usize| x.iter().map(|x| (x[i] - mean[i]) * (x[k] - mean[k])).sum::<f64>();
    (mean, std::array::from_fn(|i| std::array::from_fn(|k| moment(i, k))))
}
