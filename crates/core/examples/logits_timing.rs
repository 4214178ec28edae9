//! How long the logits of a chair's points take: `cargo run --release --example logits_timing [points...]`.
//!
//! Prints the least of several runs in milliseconds, and the largest error of some points against double precision.

use std::time::Instant;

use neuralmls_core::{logits::neural, Frame, Network, PointTree, Training};

/// The parts of a chair: seat, back, four legs, each a box from a corner to another.
const PARTS: [[f64; 6]; 6] = [
    [-0.5, -0.05, -0.5, 0.5, 0.05, 0.5],
    [-0.5, 0.05, -0.5, 0.5, 1.0, -0.42],
    [-0.5, -1.0, -0.5, -0.42, -0.05, -0.42],
    [0.42, -1.0, -0.5, 0.5, -0.05, -0.42],
    [-0.5, -1.0, 0.42, -0.42, -0.05, 0.5],
    [0.42, -1.0, 0.42, 0.5, -0.05, 0.5],
];
const CONTROL_POINTS: [f64; 30] = [
    -0.46, -1.0, -0.46, 0.46, -1.0, -0.46, -0.46, -1.0, 0.46, 0.46, -1.0, 0.46, -0.5, 0.0, 0.5, 0.5, 0.0,
    0.5, -0.5, 0.0, -0.5, 0.5, 0.0, -0.5, -0.5, 1.0, -0.46, 0.5, 1.0, -0.46,
];

/// Points on the surface, from a small generator of random numbers.
fn sample(n: usize) -> Vec<f64> {
    let mut state = 1u64;
    let mut random = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let sizes: Vec<[f64; 3]> = PARTS.iter().map(|p| std::array::from_fn(|k| p[k + 3] - p[k])).collect();
    let areas: Vec<f64> =
        (0..18).map(|f| sizes[f / 3].iter().product::<f64>() / sizes[f / 3][f % 3]).collect();
    let total: f64 = areas.iter().sum();
    let mut points = Vec::with_capacity(3 * n);
    for _ in 0..n {
        let mut at = random() * total;
        let face = areas.iter().position(|a| {
            at -= a;
            at < 0.0
        });
        let (part, axis) = (face.unwrap_or(17) / 3, face.unwrap_or(17) % 3);
        for k in 0..3 {
            let t = if k == axis { random().round() } else { random() };
            points.push(PARTS[part][k] + t * sizes[part][k]);
        }
    }
    points
}

fn naive(network: &Network, x: &[f64]) -> Vec<f64> {
    let frame = network.frame();
    let mut values: Vec<f64> = (0..3).map(|k| (x[k] - frame.centre[k]) / frame.half).collect();
    for (index, layer) in network.layers().iter().enumerate() {
        let rows = layer.weight.chunks_exact(layer.inputs()).zip(&layer.bias);
        let row = |(w, b): (&[f32], &f32)| {
            f64::from(*b) + w.iter().zip(&values).map(|(w, x)| f64::from(*w) * x).sum::<f64>()
        };
        values = rows.map(row).map(|v| if index < 2 { v.max(0.0) } else { v }).collect();
    }
    values
}

fn least<R>(runs: usize, mut run: impl FnMut() -> R) -> (f64, R) {
    let mut best = f64::INFINITY;
    for _ in 1..runs {
        let start = Instant::now();
        drop(run());
        best = best.min(start.elapsed().as_secs_f64() * 1e3);
    }
    (best, run())
}

fn main() {
    let mut sizes: Vec<usize> =
        std::env::args().skip(1).map(|a| a.parse().expect("a number of points")).collect();
    if sizes.is_empty() {
        sizes = vec![10_000, 100_000, 1_000_000];
    }
    let frame = Frame::of_box(&[-0.5, -1.0, -0.5], &[0.5, 1.0, 0.5]).expect("a box");
    let fit = neural::fit(&CONTROL_POINTS, 3, frame, &Training::default(), &mut |_| true).expect("a fit");
    let network = fit.network;
    println!("{:>10} {:>9} {:>9} {:>9} {:>10}", "points", "tree", "warm", "cold", "error");
    for n in sizes {
        let x = sample(n);
        let runs = (5_000_000 / n).clamp(5, 100);
        let (build, tree) = least(runs, || PointTree::new(&x, 3, frame, &mut |_| true).expect("a tree"));
        let (warm, logits) = least(runs, || network.logits_of_tree(&tree, &mut |_| true).expect("logits"));
        let (cold, _) = least(runs, || network.logits(&x, &mut |_| true).expect("logits"));
        let step = n.div_ceil(500).max(1);
        let error = (0..n).step_by(step).flat_map(|i| {
            let row = &logits[10 * i..10 * i + 10];
            naive(&network, &x[3 * i..3 * i + 3]).into_iter().zip(row).map(|(a, b)| (a - f64::from(*b)).abs())
        });
        let error = error.fold(0.0, f64::max);
        println!("{n:>10} {build:>9.2} {warm:>9.2} {cold:>9.2} {error:>10.1e}");
    }
}
