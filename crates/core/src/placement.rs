//! Farthest-point placement: control points spread over a shape, so that nobody starts from an empty file.
//!
//! After Gonzalez, "Clustering to minimize the maximum intercluster distance", 1985: each next point is the one farthest from those
//! already there. What differs: the first is the point farthest from the centroid, not any; the candidates are vertices and samples
//! of the surface by area, so that plain parts get their share too.

use rand_chacha::rand_core::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::error::{check_points, Error};
use crate::frame::Frame;

/// Candidates of each kind, as a minimum and for each control point: enough that more of them move no point by more than about a
/// hundredth of the shape.
const LEAST: usize = 20_000;
const EACH: usize = 50;
/// Points at the most: the candidates have to fit into memory.
const MOST: usize = 100_000;

/// `count` places spread evenly over the points `x` (n x dim) and the surface of `faces` (none for a cloud): count x dim, the first
/// the one farthest from the centroid. Faces without area are passed over; if none has any, the vertices are taken as a cloud.
///
/// # Errors
/// Where `count` is not 1 to 100,000 or more than the shape has distinct places, there are no finite points, or a face names none.
pub fn farthest_points(
    x: &[f64],
    dim: usize,
    faces: &[[u32; 3]],
    count: usize,
    seed: u64,
) -> Result<Vec<f64>, Error> {
    let n = check_points("positions", x, dim)?;
    if n == 0 {
        return Err(Error::argument("positions", "expected at least one point, found none"));
    }
    if !(1..=MOST).contains(&count) {
        return Err(Error::argument("count", format!("expected 1 to {MOST}, found {count}")));
    }
    check_faces(faces, n)?;
    let mut random = Random(ChaCha8Rng::seed_from_u64(seed));
    let size = LEAST.max(EACH * count);
    let frame = Frame::around(x, dim);
    let points = entered(x, dim, frame);
    let surface = Surface::new(&points, faces);
    let vertices: Vec<u32> = match &surface {
        Some(surface) => surface.vertices(n),
        None => (0..n as u32).collect(),
    };
    let mut few = vertices.clone();
    random.choose(&mut few, size);
    let vertex = |&index: &u32| Candidate { place: points[index as usize], vertex: Some(index) };
    let mut candidates: Vec<Candidate> = few.iter().map(vertex).collect();
    if let Some(surface) = &surface {
        candidates.extend((0..size).map(|_| Candidate { place: surface.sample(&mut random), vertex: None }));
    }
    let mut chosen = spread(&candidates, count);
    if chosen.len() < count && few.len() < vertices.len() {
        // The choice had too few distinct places.
        candidates = vertices.iter().map(vertex).collect();
        chosen = spread(&candidates, count);
    }
    if chosen.len() < count {
        let most = chosen.len();
        let message =
            format!("expected at most {most}, the number of distinct places of the shape, found {count}");
        return Err(Error::argument("count", message));
    }
    let mut result = Vec::with_capacity(count * dim);
    for index in chosen {
        let Candidate { place, vertex } = candidates[index];
        match vertex {
            Some(vertex) => result.extend_from_slice(&x[dim * vertex as usize..][..dim]), // as it stands in the file
            None => result.extend((0..dim).map(|k| frame.centre[k] + frame.half * place[k])),
        }
    }
    Ok(result)
}

/// `count` places on the surface of `faces`, each as likely as another: count x dim. Without faces that have area, so many of the points, or
/// all of them.
///
/// # Errors
/// Where a size does not fit, or a face names no point.
pub fn sample(x: &[f64], dim: usize, faces: &[[u32; 3]], count: usize, seed: u64) -> Result<Vec<f64>, Error> {
    let n = check_points("positions", x, dim)?;
    check_faces(faces, n)?;
    let mut random = Random(ChaCha8Rng::seed_from_u64(seed));
    let frame = Frame::around(x, dim);
    let points = entered(x, dim, frame);
    if let Some(surface) = Surface::new(&points, faces) {
        let places = (0..count).map(|_| surface.sample(&mut random));
        return Ok(places
            .flat_map(|place| (0..dim).map(move |k| frame.centre[k] + frame.half * place[k]))
            .collect());
    }
    let mut few: Vec<u32> = (0..n as u32).collect();
    random.choose(&mut few, count);
    Ok(few.iter().flat_map(|&index| x[dim * index as usize..][..dim].iter().copied()).collect())
}

fn check_faces(faces: &[[u32; 3]], n: usize) -> Result<(), Error> {
    let strange = faces.iter().find(|face| face.iter().any(|&corner| corner as usize >= n));
    strange.map_or(Ok(()), |face| {
        let message = format!("expected faces to name vertices 0 to {}, found {face:?}", n - 1);
        Err(Error::argument("faces", message))
    })
}

/// The points relative to the box, so that samples keep their digits far from the origin and squares neither over- nor underflow.
fn entered(x: &[f64], dim: usize, frame: Frame) -> Vec<[f64; 3]> {
    let enter = |x: &[f64]| -> [f64; 3] {
        std::array::from_fn(|k| x.get(k).map_or(0.0, |x| (x - frame.centre[k]) / frame.half))
    };
    x.chunks_exact(dim).map(enter).collect()
}

/// A place where a control point may be put, relative to the box; the vertex that it is, if any.
#[derive(Clone, Copy)]
struct Candidate {
    place: [f64; 3],
    vertex: Option<u32>,
}

/// The candidates that are farthest from each other, at most `count`: fewer if fewer are in distinct places.
fn spread(candidates: &[Candidate], count: usize) -> Vec<usize> {
    let mut mean = [0.0; 3];
    for candidate in candidates {
        for (mean, c) in mean.iter_mut().zip(candidate.place) {
            *mean += c / candidates.len() as f64;
        }
    }
    let mut away = vec![f64::INFINITY; candidates.len()];
    let mut chosen = Vec::with_capacity(count);
    // The farthest from the centroid; from then on the farthest from those that are chosen. The first of equals.
    let farthest = |away: &mut dyn Iterator<Item = f64>| {
        away.enumerate().fold((0, f64::NEG_INFINITY), |best, (i, d)| if d > best.1 { (i, d) } else { best })
    };
    let (mut next, _) = farthest(&mut candidates.iter().map(|c| squared_distance(&c.place, &mean)));
    let mut distance = f64::INFINITY;
    while chosen.len() < count && distance > 0.0 {
        chosen.push(next);
        let from = candidates[next].place;
        for (away, candidate) in away.iter_mut().zip(candidates) {
            *away = away.min(squared_distance(&candidate.place, &from));
        }
        (next, distance) = farthest(&mut away.iter().copied());
    }
    chosen
}

fn squared_distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// The faces that have area.
struct Surface<'a> {
    points: &'a [[f64; 3]],
    faces: Vec<[u32; 3]>,
    /// The area of each face and those before it.
    sums: Vec<f64>,
}

impl<'a> Surface<'a> {
    fn new(points: &'a [[f64; 3]], all: &[[u32; 3]]) -> Option<Surface<'a>> {
        let (mut faces, mut sums, mut sum) = (Vec::new(), Vec::new(), 0.0);
        for &face in all {
            let [a, b, c] = face.map(|corner| points[corner as usize]);
            let edge = |p: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| p[k] - a[k]) };
            let (u, v) = (edge(b), edge(c));
            let dot = |a: &[f64; 3], b: &[f64; 3]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
            let area = (dot(&u, &u) * dot(&v, &v) - dot(&u, &v).powi(2)).max(0.0).sqrt();
            if area > 0.0 {
                sum += area;
                faces.push(face);
                sums.push(sum);
            }
        }
        (sum > 0.0).then_some(Surface { points, faces, sums })
    }

    /// The vertices of the faces, each once.
    fn vertices(&self, n: usize) -> Vec<u32> {
        let mut named = vec![false; n];
        self.faces.iter().flatten().for_each(|&corner| named[corner as usize] = true);
        (0..n as u32).filter(|&index| named[index as usize]).collect()
    }

    /// A place on the surface, each as likely as another.
    fn sample(&self, random: &mut Random) -> [f64; 3] {
        let at = random.unit() * self.sums[self.sums.len() - 1];
        let face = self.sums.partition_point(|&sum| sum <= at).min(self.faces.len() - 1);
        let [a, b, c] = self.faces[face].map(|corner| self.points[corner as usize]);
        let (mut s, mut t) = (random.unit(), random.unit());
        if s + t > 1.0 {
            (s, t) = (1.0 - s, 1.0 - t);
        }
        std::array::from_fn(|k| a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]))
    }
}

/// The generator that one seed means on every machine.
struct Random(ChaCha8Rng);

impl Random {
    /// Uniform in [0, 1), with the 53 bits that a number has.
    fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Leaves `count` of the items, each as likely as another (Fisher and Yates); all if there are no more.
    fn choose(&mut self, items: &mut Vec<u32>, count: usize) {
        if items.len() <= count {
            return;
        }
        for i in 0..count {
            let j = i + (self.unit() * (items.len() - i) as f64) as usize;
            items.swap(i, j);
        }
        items.truncate(count);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [f64; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
    const TWO_FACES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

    /// Each next point by the definition, with nothing kept.
    fn naive(candidates: &[Candidate], count: usize) -> Vec<usize> {
        let n = candidates.len() as f64;
        let mean = std::array::from_fn(|k| candidates.iter().map(|c| c.place[k]).sum::<f64>() / n);
        let mut chosen: Vec<usize> = Vec::new();
        for _ in 0..count {
            let score = |i: usize| {
                let to = |place: &[f64; 3]| squared_distance(&candidates[i].place, place);
                chosen.iter().map(|&j| to(&candidates[j].place)).reduce(f64::min).unwrap_or_else(|| to(&mean))
            };
            let best = (0..candidates.len()).max_by(|&i, &j| score(i).total_cmp(&score(j)).then(j.cmp(&i)));
            chosen.push(best.unwrap());
        }
        chosen
    }

    #[test]
    fn each_point_is_the_farthest_from_those_before_it() {
        let mut random = Random(ChaCha8Rng::seed_from_u64(5));
        let place = |random: &mut Random| std::array::from_fn(|_| random.unit());
        let candidates: Vec<_> =
            (0..300).map(|_| Candidate { place: place(&mut random), vertex: None }).collect();
        assert_eq!(spread(&candidates, 20), naive(&candidates, 20));
    }

    #[test]
    fn samples_lie_on_the_surface_by_area_or_are_points_of_the_cloud() {
        // The second face has three times the area of the first.
        let x = [0.0, 0.0, 1e6, 1.0, 0.0, 1e6, 0.0, 1.0, 1e6, 3.0, 0.0, 1e6, 0.0, 1.0, 1e6];
        let places = sample(&x, 3, &[[0, 1, 2], [0, 3, 4]], 4000, 0).unwrap();
        assert_eq!(places.len(), 12_000);
        assert!(places
            .chunks_exact(3)
            .all(|p| p[2] == 1e6 && p[0] >= -1e-9 && p[1] >= -1e-9 && p[0] / 3.0 + p[1] <= 1.0 + 1e-9));
        let small = places.chunks_exact(3).filter(|p| p[0] + p[1] <= 1.0).count() as f64 / 4000.0;
        assert!((small - 0.5).abs() < 0.03, "{small}"); // a quarter on the first, and a third of the others on its place
        assert_eq!(sample(&x, 3, &[], 10, 0).unwrap(), x);
        let few = sample(&x, 3, &[], 2, 0).unwrap();
        assert_eq!(few.len(), 6);
        assert!(few.chunks_exact(3).all(|place| x.chunks_exact(3).any(|vertex| vertex == place)));
        assert!(sample(&x, 3, &[[0, 1, 9]], 2, 0).is_err());
    }

    #[test]
    fn four_points_on_a_square_are_its_corners_to_the_bit() {
        let offset = 5.6e6;
        let square = SQUARE.map(|c| c + offset);
        let mut found = farthest_points(&square, 3, &TWO_FACES, 4, 0).unwrap();
        let corner = |a: &[f64], b: &[f64]| a.partial_cmp(b).unwrap();
        let mut rows: Vec<_> = found.chunks_exact_mut(3).map(|c| c.to_vec()).collect();
        rows.sort_by(|a, b| corner(a, b));
        let mut expected: Vec<_> = square.chunks_exact(3).map(|c| c.to_vec()).collect();
        expected.sort_by(|a, b| corner(a, b));
        assert_eq!(rows, expected);
    }

    #[test]
    fn samples_of_the_surface_are_as_dense_in_a_large_face_as_in_small_ones() {
        let points = [[0.0; 3], [3.0, 0.0, 0.0], [0.0, 1.0, 0.0], [4.0, 0.0, 0.0], [3.0, 1.0, 0.0]];
        let surface = Surface::new(&points, &[[0, 1, 2], [1, 3, 4], [0, 0, 1]]).unwrap();
        let mut random = Random(ChaCha8Rng::seed_from_u64(1));
        let beyond = (0..4000).filter(|_| surface.sample(&mut random)[0] > 3.0).count();
        assert!((900..1100).contains(&beyond), "{beyond}"); // a quarter of the area
    }

    #[test]
    fn a_cloud_whose_few_places_a_choice_would_miss_is_searched_whole() {
        let mut cloud = vec![0.0; 300_000];
        (cloud[7], cloud[8]) = (1.0, 2.0);
        let mut found = farthest_points(&cloud, 1, &[], 3, 0).unwrap();
        found.sort_by(f64::total_cmp);
        assert_eq!(found, [0.0, 1.0, 2.0]);
        let error = farthest_points(&cloud, 1, &[], 4, 0).unwrap_err().to_string();
        assert_eq!(error, "count: expected at most 3, the number of distinct places of the shape, found 4");
    }

    #[test]
    fn the_same_seed_gives_the_same_points() {
        let points = |seed| farthest_points(&SQUARE, 3, &TWO_FACES, 30, seed).unwrap();
        assert_eq!(points(3), points(3));
        assert_ne!(points(3), points(4));
    }

    #[test]
    fn refuses_what_has_no_points_and_faces_of_none() {
        assert!(farthest_points(&[], 3, &[], 1, 0).is_err());
        assert!(farthest_points(&SQUARE, 3, &[[0, 1, 4]], 1, 0).is_err());
        assert!(farthest_points(&SQUARE, 3, &TWO_FACES, 0, 0).is_err());
        assert!(farthest_points(&[f64::NAN, 0.0], 2, &[], 1, 0).is_err());
    }
}
