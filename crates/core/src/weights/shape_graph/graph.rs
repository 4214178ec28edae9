//! The links of a shape, whatever it is made of.
//!
//! Near parts of one component are never linked; components that touch or overlap are joined by short links, and what is left by its
//! nearest pair of nodes, so that every place can be reached from every other. Points of a cloud, and vertices without a face, are linked to
//! their nearest neighbours. At last all nodes of one connected patch in a small cell become one: a fine mesh is then as cheap as a coarse one.

use super::links::{connected, summed, Links};
use super::mesh::{areas, divide, edges, merged};
use super::near::Near;
use super::{squared, Position, CELL};
use crate::machine::parallel::for_each_block;

/// Components nearer than this touch, in halves of the shape's longest side.
const TOUCH: f64 = 0.03;
/// Of a point of a cloud.
const NEIGHBOURS: usize = 8;
/// Nodes of other components to which one that touches is linked.
const NEAREST: usize = 8;
/// What a link that is no edge conducts: about as much as an edge between even triangles.
const EVEN: f64 = 0.5;
/// Of a cell: what cells begin at, so that no wall is where coordinates of furniture are: 0, 1, halves.
const BESIDE: f64 = 0.2718;
/// Nodes of which one thread finds the neighbours.
const BLOCK: usize = 1 << 10;

/// The links of a surface, of a soup, or (without faces) of a cloud of points.
pub(super) fn links_of(x: &[Position], faces: &[[u32; 3]]) -> Links {
    let (mut nodes, mut faces) = merged(x, faces);
    divide(&mut nodes, &mut faces);
    let (ends, conductances) = edges(&nodes, &faces);
    let mut loose = vec![true; nodes.len()];
    faces.iter().flatten().for_each(|&corner| loose[corner as usize] = false);
    let loose: Vec<u32> = (0..nodes.len() as u32).filter(|&node| loose[node as usize]).collect();
    let areas = areas(&nodes, &faces);
    let mut links = Links { nodes, ends, conductances, areas };
    for ends in neighbours(&links.nodes, &loose) {
        links.add(ends, EVEN);
        // Of the strip along the link, what is nearer to either end.
        let quarter = 0.25 * EVEN * squared(&links.nodes[ends[0] as usize], &links.nodes[ends[1] as usize]);
        ends.iter().for_each(|&end| links.areas[end as usize] += quarter);
    }
    let mut components = links.components();
    if components.iter().any(|&component| component > 0) {
        let near = Near::new(&links.nodes);
        let touches = touching(&links.nodes, &near, &components);
        // All of a node conduct as one: where soups lie in each other there are many.
        for of_one in touches.chunk_by(|a, b| a[0] == b[0]) {
            of_one.iter().for_each(|ends| links.add(*ends, EVEN / of_one.len() as f64));
        }
        components = links.components();
        while components.iter().any(|&component| component > 0) {
            nearest_pairs(&links.nodes, &near, &components)
                .into_iter()
                .for_each(|ends| links.add(ends, EVEN));
            components = links.components();
        }
    }
    in_cells(&links)
}

/// How much of the surface the largest connected component has, 0 to 1; 1 without faces.
pub(crate) fn largest_piece(x: &[Position], faces: &[[u32; 3]]) -> f64 {
    let (nodes, faces) = merged(x, faces);
    let (components, count) = connected(faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c]]), nodes.len());
    let mut pieces = vec![0.0; count];
    components
        .iter()
        .zip(areas(&nodes, &faces))
        .for_each(|(&component, area)| pieces[component as usize] += area);
    let (largest, all) =
        pieces.iter().fold((0.0, 0.0), |(largest, all): (f64, f64), area| (largest.max(*area), all + area));
    if all > 0.0 {
        largest / all
    } else {
        1.0
    }
}

/// Links of the points of a cloud to their nearest.
fn neighbours(nodes: &[Position], loose: &[u32]) -> Vec<[u32; 2]> {
    let positions: Vec<Position> = loose.iter().map(|&node| nodes[node as usize]).collect();
    let near = Near::new(&positions);
    let links = of_each(loose.len(), |at, found| {
        near.nearest(&positions[at], NEIGHBOURS, f64::INFINITY, |other| other as usize != at, found);
    });
    links.into_iter().map(|[a, b]| [loose[a as usize], loose[b as usize]]).collect()
}

/// Links between nodes of different components that touch.
fn touching(nodes: &[Position], near: &Near, components: &[u32]) -> Vec<[u32; 2]> {
    of_each(nodes.len(), |at, found| {
        let others = |other: u32| components[other as usize] != components[at];
        near.nearest(&nodes[at], NEAREST, TOUCH * TOUCH, others, found);
    })
}

/// Links of each number to what `find` finds for it.
fn of_each(count: usize, find: impl Fn(usize, &mut Vec<(f64, u32)>) + Sync + Send) -> Vec<[u32; 2]> {
    let mut found: Vec<Vec<u32>> = vec![Vec::new(); count];
    for_each_block(&mut found, BLOCK, |block, of_block| {
        let mut nearest = Vec::new();
        for (i, of_one) in of_block.iter_mut().enumerate() {
            find(block * BLOCK + i, &mut nearest);
            of_one.extend(nearest.iter().map(|(_, other)| *other));
        }
    });
    let links = |(at, others): (usize, &Vec<u32>)| -> Vec<[u32; 2]> {
        others.iter().map(|&other| [at as u32, other]).collect()
    };
    found.iter().enumerate().flat_map(links).collect()
}

/// For each component but the largest, a link to the nearest node that is not of it.
fn nearest_pairs(nodes: &[Position], near: &Near, components: &[u32]) -> Vec<[u32; 2]> {
    let count = 1 + components.iter().max().copied().unwrap_or(0) as usize;
    let mut best = vec![(f64::INFINITY, [0, 0]); count];
    let mut found = Vec::new();
    for (node, (x, &own)) in nodes.iter().zip(components).enumerate().filter(|(_, (_, &own))| own > 0) {
        let (bound, link) = &mut best[own as usize];
        near.nearest(x, 1, *bound, |other| components[other as usize] != own, &mut found);
        if let Some(&(far, other)) = found.first() {
            (*bound, *link) = (far, [node as u32, other]);
        }
    }
    best[1..].iter().map(|(_, link)| *link).collect()
}

/// All nodes that are connected within a cell of a grid as one, in their middle.
///
/// Two patches border on each other along the strips of all links between them, as wide as conductance x length.
fn in_cells(links: &Links) -> Links {
    let cells: Vec<[i64; 3]> =
        links.nodes.iter().map(|x| x.map(|c| (c / CELL + BESIDE).floor() as i64)).collect();
    let within = |[a, b]: [u32; 2]| cells[a as usize] == cells[b as usize];
    let inner = links.ends.iter().copied().filter(|ends| within(*ends));
    let (patches, count) = connected(inner, links.nodes.len());
    let (mut nodes, mut sizes) = (vec![[0.0; 3]; count], vec![0.0; count]);
    for (x, &patch) in links.nodes.iter().zip(&patches) {
        sizes[patch as usize] += 1.0;
        (0..3).for_each(|k| nodes[patch as usize][k] += x[k]);
    }
    nodes.iter_mut().zip(&sizes).for_each(|(x, size)| x.iter_mut().for_each(|c| *c /= size));
    let between = (0..links.ends.len()).filter(|&link| !within(links.ends[link]));
    let (ends, widths) = summed(between.map(|link| {
        (links.ends[link].map(|end| patches[end as usize]), links.conductances[link] * links.length(link))
    }));
    let mut areas = vec![0.0; count];
    patches.iter().zip(&links.areas).for_each(|(&patch, area)| areas[patch as usize] += area);
    let mut merged = Links { nodes, ends, conductances: Vec::new(), areas };
    merged.conductances =
        (0..widths.len()).map(|link| widths[link] / merged.length(link).max(0.1 * CELL)).collect();
    merged
}
