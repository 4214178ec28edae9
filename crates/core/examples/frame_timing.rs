//! How long a frame of a drag takes: `cargo run --release --example frame_timing -- shape.obj [points] [temperature ...]`.
//!
//! Points spread over the surface of a triangulated OBJ file, 10 of them control points, the paper's network (width 1024) trained on them.
//! Prints the least and the median time of many frames for each temperature.

use neuralmls_core::logits::neural::fit;
use neuralmls_core::{Deformer, Frame, Training, Transform};
use std::time::Instant;

const CONTROL_POINTS: usize = 10;

/// Numbers in [0, 1) that only look random.
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1u64 << 53) as f64
}

/// `count` points on the triangles of an OBJ file, each triangle by its area.
fn surface(text: &str, count: usize) -> Vec<f64> {
    let (mut vertices, mut triangles) = (Vec::<[f64; 3]>::new(), Vec::new());
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let v: Vec<f64> = words.filter_map(|w| w.parse().ok()).collect();
                vertices.push([v[0], v[1], v[2]]);
            }
            Some("f") => {
                let f: Vec<usize> =
                    words.filter_map(|w| w.split('/').next()?.parse::<usize>().ok()).map(|i| i - 1).collect();
                for k in 1..f.len() - 1 {
                    triangles.push([vertices[f[0]], vertices[f[k]], vertices[f[k + 1]]]);
                }
            }
            _ => {}
        }
    }
    let mut ends = Vec::new();
    let mut total = 0.0;
    for [a, b, c] in &triangles {
        let (u, v): ([f64; 3], [f64; 3]) =
            (std::array::from_fn(|k| b[k] - a[k]), std::array::from_fn(|k| c[k] - a[k]));
        let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        total += cross.iter().map(|c| c * c).sum::<f64>().sqrt();
        ends.push(total);
    }
    let mut state = 1;
    let mut x = Vec::with_capacity(3 * count);
    for _ in 0..count {
        let at = random(&mut state) * total;
        let [a, b, c] = triangles[ends.partition_point(|end| *end < at).min(triangles.len() - 1)];
        let (r, t) = (random(&mut state).sqrt(), random(&mut state));
        x.extend((0..3).map(|k| (1.0 - r) * a[k] + r * (1.0 - t) * b[k] + r * t * c[k]));
    }
    x
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().expect("the path of an OBJ file");
    let count: usize = arguments.next().map_or(100_000, |n| n.parse().expect("a number of points"));
    let mut temperatures: Vec<f64> = arguments.map(|t| t.parse().expect("a temperature")).collect();
    if temperatures.is_empty() {
        temperatures = vec![1.0, 0.3, 0.1, 0.02];
    }
    let x = surface(&std::fs::read_to_string(path).expect("a readable file"), count);
    let frame = Frame::around(&x, 3);
    let mut state = 7;
    // Of a few tries the one farthest from the control points before: spread, but not regular.
    let mut p: Vec<f64> = Vec::new();
    while p.len() < 3 * CONTROL_POINTS {
        let distance = |v: &&[f64]| -> f64 {
            p.chunks(3)
                .map(|p| p.iter().zip(*v).map(|(a, b)| (a - b) * (a - b)).sum())
                .fold(f64::INFINITY, f64::min)
        };
        let tries: Vec<&[f64]> =
            (0..20).map(|_| &x[(random(&mut state) * count as f64) as usize * 3..][..3]).collect();
        let best = *tries.iter().max_by(|a, b| distance(a).total_cmp(&distance(b))).expect("tries");
        p.extend(best);
    }
    let q: Vec<f64> = p.iter().map(|c| c + (random(&mut state) - 0.5) * 0.6 * frame.half).collect();
    let network = fit(&p, 3, frame, &Training::default(), &mut |_| true).expect("a network").network;
    let logits = network.logits(&x, &mut |_| true).expect("logits");
    for transform in [Transform::Rigid, Transform::Similarity, Transform::Affine] {
        let deformer = Deformer::new(x.clone(), 3, &p, logits.clone(), transform).expect("a deformer");
        let mut y = vec![0.0; x.len()];
        for &t in &temperatures {
            let mut frame = |t: f64| {
                let start = Instant::now();
                deformer.deform_into(&q, t, &mut y, None, &mut |_| true).expect("a frame");
                start.elapsed().as_secs_f64() * 1e3
            };
            frame(1.1 * t);
            let first = frame(t);
            let mut times: Vec<f64> = (0..60).map(|_| frame(t)).collect();
            times.sort_by(f64::total_cmp);
            println!(
                "{transform:?} T = {t}: first {first:.2} ms, then {:.3} ms (median {:.3})",
                times[0], times[30]
            );
        }
    }
}
