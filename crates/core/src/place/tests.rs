use super::*;
use crate::weights::shape_graph::squared;

type Mesh = (Vec<f64>, Vec<[u32; 3]>);

/// Boxes from corner to corner.
fn boxes(all: &[[Position; 2]]) -> Mesh {
    let (mut x, mut faces) = (Vec::new(), Vec::new());
    for corners in all {
        let first = x.len() as u32 / 3;
        for corner in 0..8 {
            x.extend((0..3).map(|k| corners[corner >> k & 1][k]));
        }
        for [a, b, c, d] in
            [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]]
        {
            faces.extend([[a, b, c], [a, c, d]].map(|face: [u32; 3]| face.map(|corner| first + corner)));
        }
    }
    (x, faces)
}

/// Four arms of different lengths in a plane: the ends are at these places.
const ENDS: [Position; 4] = [[2.0, 0.0, 0.0], [-1.6, 0.0, 0.0], [0.0, 1.8, 0.0], [0.0, -1.4, 0.0]];

fn cross() -> Mesh {
    boxes(&[[[-1.6, -0.1, -0.1], [2.0, 0.1, 0.1]], [[-0.1, -1.4, -0.1], [0.1, 1.8, 0.1]]])
}

fn wish(count: usize) -> Wish {
    Wish { count: Count::Of(count), symmetric: false, seed: 0 }
}

fn placed((x, faces): &Mesh, wish: &Wish) -> Placed {
    place(x, 3, faces, wish, &mut |_| true).unwrap()
}

fn rows(placed: &Placed) -> Vec<Position> {
    placed.points.chunks_exact(3).map(|x| [x[0], x[1], x[2]]).collect()
}

fn nearest(to: &Position, points: &[Position]) -> f64 {
    points.iter().map(|x| squared(x, to)).fold(f64::INFINITY, f64::min).sqrt()
}

/// The shape as the parts of this module see it.
fn along((x, faces): &Mesh) -> (Vec<Position>, Along) {
    let frame = Frame::around(x, 3);
    let entered: Vec<Position> = x.chunks_exact(3).map(|x| frame.enter(x)).collect();
    let along = Along::new(&entered, faces, 12);
    (entered, along)
}

#[test]
fn the_ends_of_a_shape_come_first_wherever_it_is() {
    let (x, faces) = cross();
    for (cos, sin, by) in [(1.0, 0.0, 0.0), (0.6, 0.8, 5e5)] {
        let turn =
            |p: &[f64]| -> Position { [cos * p[0] - sin * p[1] + by, sin * p[0] + cos * p[1] - by, p[2]] };
        let turned: Vec<f64> = x.chunks_exact(3).flat_map(turn).collect();
        let found = rows(&placed(&(turned, faces.clone()), &wish(8)));
        for end in ENDS {
            let off = nearest(&turn(&end), &found[..4]);
            assert!(off < 0.08 * 3.6, "{off} from {end:?}: {found:?}");
        }
    }
}

#[test]
fn the_order_of_vertices_changes_nothing_and_the_seed_gives_the_same() {
    let (x, faces) = cross();
    let n = x.len() as u32 / 3;
    let back: Vec<f64> = x.chunks_exact(3).rev().flatten().copied().collect();
    let of_back: Vec<[u32; 3]> = faces.iter().map(|face| face.map(|corner| n - 1 - corner)).collect();
    let found = placed(&(x, faces), &wish(10));
    assert_eq!(found, placed(&(back, of_back), &wish(10)));
    assert_eq!(found, placed(&cross(), &wish(10)));
}

#[test]
fn distances_are_those_of_all_ways() {
    let (_, along) = along(&cross());
    let n = along.len();
    // Floyd, "Algorithm 97: shortest path", 1962.
    let mut naive = vec![f64::INFINITY; n * n];
    for (a, links) in along.links.iter().enumerate() {
        naive[a * n + a] = 0.0;
        links.iter().for_each(|&(b, length)| naive[a * n + b as usize] = length);
    }
    for by in 0..n {
        for a in 0..n {
            for b in 0..n {
                naive[a * n + b] = naive[a * n + b].min(naive[a * n + by] + naive[by * n + b]);
            }
        }
    }
    assert!(along.far.iter().zip(&naive).all(|(far, naive)| (far - naive).abs() < 1e-9));
}

#[test]
fn ends_are_as_prominent_as_looking_at_every_level_finds() {
    let (_, along) = along(&cross());
    let seen = vec![true; along.len()];
    let height = extremities::mean_distances(&along, &seen);
    let mut found = extremities::prominences(&along, &seen, &height);
    found.sort_by(|a, b| b.partial_cmp(a).unwrap());
    assert!(found.len() >= 4);
    for (prominence, end) in found {
        // From the end, over what is no lower than a level, to anything higher; the level goes down until there is a way.
        let mut levels: Vec<f64> = height.iter().copied().filter(|level| *level <= height[end]).collect();
        levels.sort_by(|a, b| b.total_cmp(a));
        let reaches = |level: f64| {
            let (mut reached, mut queue) = (vec![false; along.len()], vec![end]);
            while let Some(node) = queue.pop() {
                if height[node] >= level && !std::mem::replace(&mut reached[node], true) {
                    queue.extend(along.links[node].iter().map(|(other, _)| *other as usize));
                }
            }
            (0..along.len()).any(|node| reached[node] && height[node] > height[end])
        };
        let level = levels.iter().copied().find(|level| reaches(*level)).unwrap_or(*levels.last().unwrap());
        assert!(
            (height[end] - level - prominence).abs() < 1e-12,
            "{end}: {prominence}, {}",
            height[end] - level
        );
    }
}

#[test]
fn medoids_of_few_places_are_the_best_of_all_choices() {
    let mut random = Random::new(4);
    for _ in 0..10 {
        let n = 12;
        let x: Vec<Position> = (0..n).map(|_| std::array::from_fn(|_| random.unit())).collect();
        let cost: Vec<f64> = x.iter().flat_map(|a| x.iter().map(|b| squared(a, b).sqrt())).collect();
        let areas: Vec<f64> = (0..n).map(|_| 0.5 + random.unit()).collect();
        let choice = Choice { cost: &cost, areas: &areas, fixed: &[0] };
        let kinds = [Kind { candidates: (0..n).collect(), count: 2 }];
        let (chosen, found) = medoids(&choice, &kinds, &mut random);
        assert!(chosen.len() == 3 && chosen[0] == 0);
        let price = |chosen: &[usize]| {
            let of =
                |i: usize| areas[i] * chosen.iter().map(|&j| cost[j * n + i]).fold(f64::INFINITY, f64::min);
            (0..n).map(of).sum::<f64>() / areas.iter().sum::<f64>()
        };
        assert!((price(&chosen) - found).abs() < 1e-12);
        let best = (0..n * n).map(|at| price(&[0, at / n, at % n])).fold(f64::INFINITY, f64::min);
        assert!(found <= 1.06 * best, "{found}, best {best}");
    }
}

#[test]
fn what_is_within_other_parts_is_not_seen_and_is_no_end() {
    let hollow = boxes(&[
        [[-1.0; 3], [1.0; 3]],
        [[-0.4, -0.1, -0.1], [0.5, 0.1, 0.1]],
        [[0.9, -0.1, -0.1], [2.0, 0.1, 0.1]],
    ]);
    let (entered, along) = along(&hollow);
    let seen = hidden::seen(&entered, &hollow.1, &along.nodes, 3);
    let frame = Frame::around(&hollow.0, 3);
    for (node, seen) in along.nodes.iter().zip(&seen) {
        let x: Position = std::array::from_fn(|k| frame.centre[k] + frame.half * node[k]);
        if x.iter().all(|c| c.abs() < 0.6) {
            assert!(!seen, "{x:?}");
        } else if x.iter().any(|c| c.abs() > 0.95) {
            assert!(seen, "{x:?}");
        }
    }
    let found = rows(&placed(&hollow, &wish(12)));
    assert!(found.iter().all(|x| x.iter().any(|c| c.abs() > 0.8)), "{found:?}");
}

#[test]
fn pairs_are_exact_images_and_a_third_at_most_are_on_the_plane() {
    let beast = boxes(&[
        [[-0.3, 0.5, -0.8], [0.3, 0.9, 0.8]],
        [[-0.1, 0.8, 0.8], [0.1, 1.2, 1.3]],
        [[-0.3, 0.0, -0.8], [-0.2, 0.5, -0.6]],
        [[0.2, 0.0, -0.8], [0.3, 0.5, -0.6]],
        [[-0.3, 0.0, 0.6], [-0.2, 0.5, 0.8]],
        [[0.2, 0.0, 0.6], [0.3, 0.5, 0.8]],
    ]);
    for count in [12, 13, 16] {
        let found = placed(&beast, &Wish { symmetric: true, ..wish(count) });
        let plane = found.plane.unwrap();
        let points = rows(&found);
        assert_eq!(points.len(), count);
        let mut single = 0;
        for (at, image_of) in found.mirror_of.iter().enumerate() {
            match image_of {
                Some(first) => assert_eq!(points[at].to_vec(), plane.image(&points[*first])),
                None if found.mirror_of.get(at + 1) == Some(&Some(at)) => {
                    assert!(points[at][0] > 0.0, "the first of a pair is on the positive side");
                }
                None => {
                    single += 1;
                    let height = (0..3).map(|k| plane.normal[k] * points[at][k]).sum::<f64>() - plane.offset;
                    assert!(height.abs() < 1e-12, "{height}");
                }
            }
        }
        assert!(single <= count / 3, "{single} of {count}");
        for foot in [[0.25, 0.0, -0.7], [-0.25, 0.0, -0.7], [0.25, 0.0, 0.7], [-0.25, 0.0, 0.7]] {
            assert!(nearest(&foot, &points) < 0.08 * 2.1, "{foot:?}: {points:?}");
        }
    }
    let uneven = (
        vec![0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.4, 1.9, 0.0, 0.9, 0.3, 1.1],
        vec![[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3]],
    );
    let refused = place(&uneven.0, 3, &uneven.1, &Wish { symmetric: true, ..wish(6) }, &mut |_| true);
    assert!(refused.unwrap_err().to_string().contains("not its own mirror image"));
}

#[test]
fn the_nearest_place_of_a_triangle_is_no_farther_than_any_sample_of_it() {
    let mut random = Random::new(8);
    for _ in 0..200 {
        let mut draw = || -> Position { std::array::from_fn(|_| 2.0 * random.unit() - 1.0) };
        let (corners, p) = ([draw(), draw(), draw()], draw());
        let found = snap::closest(corners, &p);
        let steps = 60;
        let mut best = f64::INFINITY;
        for s in 0..=steps {
            for t in 0..=steps - s {
                let [s, t] = [s, t].map(|c| f64::from(c) / f64::from(steps));
                let x: Position = std::array::from_fn(|k| {
                    corners[0][k] * (1.0 - s - t) + corners[1][k] * s + corners[2][k] * t
                });
                best = best.min(squared(&x, &p).sqrt());
            }
        }
        let off = squared(&found, &p).sqrt();
        assert!(off <= best + 1e-12 && off > best - 0.05, "{off}, {best}");
    }
}

#[test]
fn auto_stops_where_one_more_changes_little_and_shows_the_curve() {
    let found = placed(&cross(), &Wish { count: Count::Auto, ..wish(0) });
    let count = found.points.len() / 3;
    assert!((6..=32).contains(&count), "{count}");
    assert!(found.curve.iter().any(|(of, _)| *of == count));
    assert!(found.curve.first().unwrap().1 > found.curve.last().unwrap().1);
    assert_eq!(found.points, placed(&cross(), &wish(count)).points);
}

#[test]
fn whatever_the_shape_there_are_as_many_points_or_a_word() {
    let place = |x: &[f64], dim: usize, faces: &[[u32; 3]], count: usize| {
        place(x, dim, faces, &wish(count), &mut |_| true)
    };
    assert_eq!(place(&[1.0, 2.0, 3.0], 3, &[], 1).unwrap().points, [1.0, 2.0, 3.0]);
    let error = place(&[5.0; 30], 3, &[], 2).unwrap_err().to_string();
    assert_eq!(error, "count: expected at most 1, the number of distinct places of the shape, found 2");
    assert!(place(&[], 3, &[], 1).is_err());
    assert!(place(&[0.0; 9], 3, &[[0, 1, 3]], 1).is_err());
    assert!(place(&[0.0, 0.0, 1.0, 0.0], 2, &[], 0).is_err());
    // One face, in the plane and in space; a line; a cloud of as many points as are asked for.
    for (x, dim) in
        [(vec![0.0, 0.0, 4.0, 0.0, 0.0, 3.0], 2), (vec![0.0, 0.0, 9.0, 4.0, 0.0, 9.0, 0.0, 3.0, 9.0], 3)]
    {
        assert_eq!(place(&x, dim, &[[0, 1, 2]], 10).unwrap().points.len(), 10 * dim);
    }
    let line: Vec<f64> = (0..40).map(f64::from).collect();
    let mut ends = place(&line, 1, &[], 9).unwrap().points;
    ends.sort_by(f64::total_cmp);
    assert_eq!([ends[0], ends[8]], [0.0, 39.0]);
    let cloud: Vec<f64> = (0..9).map(f64::from).collect();
    assert_eq!(place(&cloud, 1, &[], 9).unwrap().points.len(), 9);
    // Parts that are far from each other all get some.
    let two = boxes(&[[[0.0; 3], [1.0; 3]], [[20.0, 0.0, 0.0], [21.0, 1.0, 1.0]]]);
    let found = place(&two.0, 3, &two.1, 12).unwrap().points;
    assert!(found.chunks_exact(3).any(|x| x[0] < 2.0) && found.chunks_exact(3).any(|x| x[0] > 19.0));
    // More than there is a choice for are spread.
    let (x, faces) = cross();
    let many = place(&x, 3, &faces, 200).unwrap().points;
    assert_eq!(many, placement::farthest_points(&x, 3, &faces, 200, 0, &mut |_| true).unwrap());
}

#[test]
fn a_wish_to_stop_is_heard() {
    let (x, faces) = cross();
    assert!(matches!(place(&x, 3, &faces, &wish(6), &mut |_| false), Err(Error::Cancelled)));
}
