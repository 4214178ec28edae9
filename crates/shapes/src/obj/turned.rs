//! The normals of an OBJ file, turned with the surface.
//!
//! One `vn` may serve corners at many vertices, which turn differently. Where they still agree to a degree it gets their
//! mean; else it is split into several, and the corners are given the one that suits their vertex.

use std::collections::HashMap;

use super::corner::{self, Corner};
use super::statements::Statements;
use crate::error::Error;
use crate::memory;
use crate::normals;
use crate::number;

/// The cosine of one degree: normals that agree as well stay one.
const AGREE: f64 = 0.999_847_7;
/// The side of the cells into which directions that do not agree are sorted: less than a degree from corner to corner.
const CELL: f64 = 0.01;

/// A normal's three numbers, `None` for a `vn` that has no three finite ones: that one stays as it is.
type Normal = Option<[f64; 3]>;

/// New normals: the `vn` of index `i` becomes `normals[first[i]..first[i + 1]]`.
pub(super) struct Turned {
    pub normals: Vec<Normal>,
    pub first: Vec<u32>,
    /// For each corner with a normal, in file order, the index into `normals`; `None` where the numbering stays.
    pub corners: Option<Vec<u32>>,
}

/// A corner that names a normal.
struct Use {
    normal: u32,
    vertex: u32,
}

pub(super) fn turn(source: &[u8], maps: &[f64], by_vertex: bool, may_split: bool) -> Result<Turned, Error> {
    let (before, uses) = gather(source)?;
    let turned = |vertex: usize, normal| normals::turn(normals::map_at(maps, vertex), normal);
    if by_vertex {
        let mut normals = memory::with_room(before.len())?;
        normals.extend(before.iter().enumerate().map(|(i, n)| n.map(|n| turned(i, n))));
        let mut first = memory::with_room(before.len() + 1)?;
        first.extend(0..=before.len() as u32);
        return Ok(Turned { normals, first, corners: None });
    }
    let (starts, order) = group(&uses, before.len())?;
    let normals = memory::with_room(before.len())?;
    let mut first = memory::with_room(before.len() + 1)?;
    first.push(0);
    let mut result = Turned { normals, first, corners: None };
    let mut chosen = memory::filled(0u32, uses.len())?;
    for (index, normal) in before.iter().enumerate() {
        let base = result.normals.len() as u32;
        let corners = &order[starts[index] as usize..starts[index + 1] as usize];
        if let Some(was) = *normal {
            let directions = corners.iter().map(|&at| (at, turned(uses[at as usize].vertex as usize, was)));
            split(was, directions, may_split, &mut result.normals, &mut chosen)?;
        } else {
            memory::push(&mut result.normals, None)?;
            corners.iter().for_each(|&at| chosen[at as usize] = base);
        }
        result.first.push(result.normals.len() as u32);
    }
    result.corners = (result.normals.len() > before.len()).then_some(chosen);
    Ok(result)
}

/// Adds what the normal `was` becomes to `normals`, and for each of its corners which one that is to `chosen`.
fn split(
    was: [f64; 3],
    directions: impl Iterator<Item = (u32, [f64; 3])> + Clone,
    may_split: bool,
    normals: &mut Vec<Normal>,
    chosen: &mut [u32],
) -> Result<(), Error> {
    let base = normals.len() as u32;
    let length = normals::length(was);
    let mean = mean(directions.clone().map(|(_, n)| n), was, length);
    let agrees = |n: [f64; 3]| (0..3).map(|k| n[k] * mean[k]).sum::<f64>() >= AGREE * length * length;
    if !may_split || length == 0.0 || directions.clone().all(|(_, n)| agrees(n)) {
        memory::push(normals, Some(mean))?;
        directions.for_each(|(at, _)| chosen[at as usize] = base);
        return Ok(());
    }
    let mut cells: HashMap<[i32; 3], u32> = HashMap::new();
    for (at, n) in directions {
        let cell = n.map(|c| (c / length / CELL).round() as i32);
        let next = normals.len() as u32;
        cells.try_reserve(1).map_err(|_| Error::memory())?;
        let index = *cells.entry(cell).or_insert(next);
        chosen[at as usize] = index;
        if index == next {
            memory::push(normals, Some(n))?;
        } else if let Some(sum) = &mut normals[index as usize] {
            (0..3).for_each(|k| sum[k] += n[k]);
        }
    }
    for sum in normals[base as usize..].iter_mut().flatten() {
        *sum = with_length(*sum, length).unwrap_or(was);
    }
    Ok(())
}

/// The mean direction, as long as `length`; `was` where there is none.
fn mean(directions: impl Iterator<Item = [f64; 3]>, was: [f64; 3], length: f64) -> [f64; 3] {
    let sum = directions.fold([0.0; 3], |sum, n| [sum[0] + n[0], sum[1] + n[1], sum[2] + n[2]]);
    with_length(sum, length).unwrap_or(was)
}

fn with_length(v: [f64; 3], length: f64) -> Option<[f64; 3]> {
    let now = normals::length(v);
    (now > 0.0 && now.is_finite()).then(|| v.map(|c| c * (length / now)))
}

/// All normals of the file, and the corners that name one of them.
fn gather(source: &[u8]) -> Result<(Vec<Normal>, Vec<Use>), Error> {
    let (mut normals, mut uses, mut vertices) = (Vec::new(), Vec::new(), 0);
    for statement in Statements::new(source) {
        let mut words = statement.words();
        let Some(keyword) = words.next() else { continue };
        match &statement.bytes[keyword] {
            b"v" => vertices += 1,
            b"vn" => {
                let mut next = || number::parse(&statement.bytes[words.next()?]);
                memory::push(&mut normals, (|| Some([next()?, next()?, next()?]))())?;
            }
            b"f" | b"fo" => {
                for corner in words.filter_map(|range| Corner::parse(&statement.bytes[range])) {
                    let normal = corner.normal.and_then(|(number, _)| corner::resolve(number, normals.len()));
                    let vertex = corner::resolve(corner.vertex, vertices);
                    if let (Some(normal), Some(vertex)) = (normal, vertex) {
                        memory::push(&mut uses, Use { normal, vertex })?;
                    }
                }
            }
            _ => {}
        }
    }
    Ok((normals, uses))
}

/// The uses sorted by normal: those of normal `i` are `order[starts[i]..starts[i + 1]]`. Uses of normals that the file
/// does not have are left out.
fn group(uses: &[Use], normals: usize) -> Result<(Vec<u32>, Vec<u32>), Error> {
    let mut starts = memory::filled(0u32, normals + 1)?;
    let known = || uses.iter().enumerate().filter(|(_, u)| (u.normal as usize) < normals);
    for (_, u) in known() {
        starts[u.normal as usize + 1] += 1;
    }
    for i in 0..normals {
        starts[i + 1] += starts[i];
    }
    let mut order = memory::filled(0u32, starts[normals] as usize)?;
    let mut free = memory::copy(&starts)?;
    for (at, u) in known() {
        order[free[u.normal as usize] as usize] = at as u32;
        free[u.normal as usize] += 1;
    }
    Ok((starts, order))
}
