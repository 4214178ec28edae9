//! Every point is in the tree once, in its node and its box, whatever the threads.

use super::*;

fn check(x: &[f64], dim: usize) {
    let tree = PointTree::new(x, dim, Frame::IDENTITY, &mut |_| true).unwrap();
    let n = x.len() / dim;
    let mut seen: Vec<usize> = tree.order().collect();
    seen.sort_unstable();
    assert_eq!(seen, (0..n).collect::<Vec<_>>());
    if n == 0 {
        return;
    }
    let mut nodes = vec![tree.root()];
    while let Some(node) = nodes.pop() {
        let region = tree.region(node);
        for place in node.first * LEAF..((node.first + node.count) * LEAF).min(n) {
            for k in 0..dim {
                let coordinate = tree.point(place)[k];
                assert_eq!(coordinate, tree.block(place - place % WIDTH)[k].0[place % WIDTH]);
                assert_eq!(coordinate, x[dim * tree.index(place) + k] as f32);
                let distance = f64::from(coordinate) - f64::from(region.centre[k]);
                assert!(distance.abs() <= f64::from(region.half[k]), "{distance} {region:?}");
            }
        }
        nodes.extend(node.halves().into_iter().flatten());
    }
}

#[test]
fn every_point_is_once_in_the_tree_and_inside_of_its_boxes() {
    for n in [0, 1, 15, 16, 17, 63, 64, 65, 128, 129, 1000, 10_000] {
        for dim in 1..4 {
            let x: Vec<f64> = (0..n * dim).map(|i| (i as f64 * 0.7).sin() * 3.0).collect();
            check(&x, dim);
        }
    }
}

#[test]
fn duplicate_and_far_away_points_are_no_exception() {
    check(&[2.0; 3000], 3);
    let x: Vec<f64> = (0..3000).map(|i| if i % 100 == 0 { 1e20 } else { f64::from(i % 7) }).collect();
    check(&x, 3);
}

#[test]
fn is_the_same_for_any_number_of_threads() {
    let x: Vec<f64> = (0..60_000).map(|i| (f64::from(i) * 0.7).sin()).collect();
    let build = || {
        let tree = PointTree::new(&x, 3, Frame::IDENTITY, &mut |_| true).unwrap();
        tree.order().collect::<Vec<_>>()
    };
    #[cfg(feature = "threads")]
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(build), build());
    }
}

#[test]
fn stops_when_asked() {
    let mut calls = 0;
    let result = PointTree::new(&[0.5; 3000], 3, Frame::IDENTITY, &mut |_| {
        calls += 1;
        calls < 3
    });
    assert_eq!(result.err(), Some(Error::Cancelled));
}
