//! Which points go into lanes together: those with the same dominant and the same second control point.

use super::super::Matrix;
use crate::parallel::for_each_block;
use crate::softmax::LANES;
use std::ops::Range;

/// Points that are sorted among themselves: what is read and written for them stays in the second cache.
pub(crate) const CHUNK: usize = 4096;
/// So many points are worth a pair's table, which each frame makes anew.
const ENOUGH: usize = LANES;
/// So many points of one pair in a chunk are worth a block of their own.
const FEW: usize = 2;
/// With more control points than this hardly any points share a pair.
const MANY: usize = 256;
/// Control points nearer to each other than this, in the frame, are not told apart in single precision.
const CLOSE: f64 = 1e-4;

/// Instead of a pair's number: there is no such pair.
const NONE: u32 = u32::MAX;

/// 16 points of one pair; if there are fewer, the first one again and again.
#[derive(Clone)]
pub(super) struct Block {
    pub pair: u32,
    pub points: [u32; LANES],
}

/// A dominant control point and the second one.
pub(super) struct Pair {
    pub dominant: usize,
    pub second: usize,
    /// Orthonormal rows; the first points from the dominant control point to the second.
    pub axes: Matrix<3>,
    /// How far they are apart.
    pub length: f64,
}

/// The points of a shape by pairs. It depends on the order of their logits alone: neither on the temperature nor on the targets.
pub(crate) struct Order {
    pub(super) pairs: Vec<Pair>,
    pub(super) blocks: Vec<Block>,
    /// Where the blocks of each chunk begin, and where the last one's end.
    first: Vec<usize>,
    /// For each chunk, its points that are in no block.
    pub(super) loose: Vec<Vec<u32>>,
}

impl Order {
    /// `None` where too few points share pairs for it to be worth while.
    pub(crate) fn new(logits: &[f32], p: &[[f64; 3]]) -> Option<Order> {
        let m = p.len();
        let n = logits.len() / m;
        if !(2..=MANY).contains(&m) || n > u32::MAX as usize {
            return None;
        }
        let mut keys = vec![0u32; n];
        for_each_block(&mut keys, CHUNK, |chunk, keys| {
            for (key, logits) in keys.iter_mut().zip(logits[chunk * CHUNK * m..].chunks_exact(m)) {
                let (dominant, second) = largest_two(logits);
                *key = (dominant * m + second) as u32;
            }
        });
        let mut counts = vec![0u32; m * m];
        keys.iter().for_each(|key| counts[*key as usize] += 1);
        let mut pairs = Vec::new();
        // The number of each key's pair, where it has one.
        let mut numbers = counts;
        for (key, number) in numbers.iter_mut().enumerate() {
            let pair = (*number as usize >= ENOUGH).then(|| Pair::new(key / m, key % m, p)).flatten();
            *number = if pair.is_some() { pairs.len() as u32 } else { NONE };
            pairs.extend(pair);
        }
        let mut chunks = vec![(Vec::new(), Vec::new()); n.div_ceil(CHUNK)];
        for_each_block(&mut chunks, 1, |chunk, out| {
            let keys = &keys[chunk * CHUNK..n.min((chunk + 1) * CHUNK)];
            out[0] = blocks(chunk * CHUNK, keys, &numbers);
        });
        let loose: usize = chunks.iter().map(|(_, loose)| loose.len()).sum();
        let lanes: usize = chunks.iter().map(|(blocks, _)| LANES * blocks.len()).sum();
        if 4 * loose > n || 2 * lanes > 3 * n {
            return None;
        }
        let mut order = Order { pairs, blocks: Vec::new(), first: vec![0], loose: Vec::new() };
        for (blocks, loose) in chunks {
            order.blocks.extend(blocks);
            order.first.push(order.blocks.len());
            order.loose.push(loose);
        }
        Some(order)
    }

    /// Which blocks are those of a chunk.
    pub(super) fn range(&self, chunk: usize) -> Range<usize> {
        self.first[chunk]..self.first[chunk + 1]
    }
}

impl Pair {
    fn new(dominant: usize, second: usize, p: &[[f64; 3]]) -> Option<Pair> {
        let a: [f64; 3] = std::array::from_fn(|c| p[second][c] - p[dominant][c]);
        let (x, length) = direction(a);
        (length > CLOSE).then(|| {
            let (y, z) = across(&x);
            Pair { dominant, second, axes: [x, y, z], length }
        })
    }

    /// The control points but the two, of `m`.
    pub(super) fn others(&self, m: usize) -> impl Iterator<Item = usize> + '_ {
        (0..m).filter(|i| *i != self.dominant && *i != self.second)
    }
}

/// The largest logit and the largest other one; of equal ones the first. (At least two.)
fn largest_two(logits: &[f32]) -> (usize, usize) {
    let (mut first, mut second) = (0, 1);
    let (mut largest, mut next) = (logits[0], logits[1]);
    for (i, logit) in logits.iter().copied().enumerate().skip(1) {
        // Choices, not branches, which nobody could predict.
        let (above, between) = (logit > largest, logit > next);
        second = if above {
            first
        } else if between {
            i
        } else {
            second
        };
        next = if above {
            largest
        } else if between {
            logit
        } else {
            next
        };
        first = if above { i } else { first };
        largest = if above { logit } else { largest };
    }
    (first, second)
}

/// The blocks of a chunk whose points begin with `first`, and the points that are in none.
fn blocks(first: usize, keys: &[u32], numbers: &[u32]) -> (Vec<Block>, Vec<u32>) {
    // The pair's number in the upper half, the point's in the lower one.
    let (pair, point) = (|both: u64| (both >> 32) as u32, |both: u64| both as u32);
    let both = |(key, point): (&u32, u64)| u64::from(numbers[*key as usize]) << 32 | point;
    let mut sorted: Vec<u64> = keys.iter().zip(first as u64..).map(both).collect();
    sorted.sort_unstable();
    let (mut blocks, mut loose) = (Vec::with_capacity(keys.len() / 8), Vec::new());
    for run in sorted.chunk_by(|a, b| pair(*a) == pair(*b)) {
        let pair = pair(run[0]);
        for lanes in run.chunks(LANES) {
            if pair != NONE && lanes.len() >= FEW {
                let points = std::array::from_fn(|lane| point(*lanes.get(lane).unwrap_or(&lanes[0])));
                blocks.push(Block { pair, points });
            } else {
                loose.extend(lanes.iter().map(|both| point(*both)));
            }
        }
    }
    (blocks, loose)
}

/// A vector's direction and length.
pub(super) fn direction(v: [f64; 3]) -> ([f64; 3], f64) {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    (v.map(|c| c / length), length)
}

pub(super) fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Two directions that make an orthonormal right-handed system with `x`.
fn across(x: &[f64; 3]) -> ([f64; 3], [f64; 3]) {
    let mut other = [0.0; 3];
    let least = (0..3).min_by(|a, b| x[*a].abs().total_cmp(&x[*b].abs())).unwrap_or(0);
    other[least] = 1.0;
    let (y, _) = direction(cross(x, &other));
    (y, cross(x, &y))
}
