//! Farthest-point placement: control points spread over a shape, so that nobody starts from an empty file.
//!
//! After Gonzalez, "Clustering to minimize the maximum intercluster distance", 1985: each next point is the one farthest from those
//! already there. What differs: the first is the point farthest from the centroid, not any; the candidates are vertices and samples
//! of the surface by area, so that plain parts get their share too.

use crate::check::check_points;
use crate::error::Error;
use crate::geometry::Frame;
use crate::machine::memory::room;
use crate::machine::progress::{report, Progress};
use crate::machine::random::Random;

/// Candidates of each kind, as a minimum and for each control point: enough that more of them move no point by more than about a
/// hundredth of the shape.
const LEAST: usize = 20_000;
const EACH: usize = 50;
/// Points at the most: the candidates have to fit into memory.
const MOST: usize = 100_000;
/// Distances computed between two reports of progress.
const STRETCH: usize = 1 << 22;

/// `count` places spread evenly over the points `x` (n x dim) and the surface of `faces` (none for a cloud): count x dim, the first
/// the one farthest from the centroid. Faces without area are passed over; if none has any, the vertices are taken as a cloud.
///
/// # Errors
/// Where `count` is not 1 to 100,000 or more than the shape has distinct places, there are no finite points, or a face names none;
/// [`Error::Cancelled`].
pub fn farthest_points(
    x: &[f64],
    dim: usize,
    faces: &[[u32; 3]],
    count: usize,
    seed: u64,
    progress: &mut Progress<'_>,
) -> Result<Vec<f64>, Error> {
    let (frame, points) = places(x, dim)?;
    let n = points.len();
    if n == 0 {
        return Err(Error::argument("positions", "expected at least one point, found none"));
    }
    if !(1..=MOST).contains(&count) {
        return Err(Error::argument("count", format!("expected 1 to {MOST}, found {count}")));
    }
    let mut random = Random::new(seed);
    let size = LEAST.max(EACH * count);
    let surface = Surface::new(&points, faces)?;
    let vertices: Vec<u32> = match &surface {
        Some(surface) => surface.vertices(n),
        None => (0..n as u32).collect(),
    };
    let mut few = vertices.clone();
    random.choose(&mut few, size);
    // The vertices first, then places of the surface between them.
    let mut candidates: Vec<Position> = few.iter().map(|&vertex| points[vertex as usize]).collect();
    if let Some(surface) = &surface {
        candidates.extend((0..size).map(|_| surface.sample(&mut random)));
    }
    let mut chosen = spread(&candidates, count, progress)?;
    if chosen.len() < count && few.len() < vertices.len() {
        // The choice had too few distinct places.
        few = vertices;
        candidates = few.iter().map(|&vertex| points[vertex as usize]).collect();
        chosen = spread(&candidates, count, progress)?;
    }
    if chosen.len() < count {
        let most = chosen.len();
        let message =
            format!("expected at most {most}, the number of distinct places of the shape, found {count}");
        return Err(Error::argument("count", message));
    }
    let mut result = Vec::with_capacity(count * dim);
    for index in chosen {
        match few.get(index) {
            Some(&vertex) => result.extend_from_slice(&x[dim * vertex as usize..][..dim]), // as it stands in the file
            None => leave(&frame, &candidates[index], dim, &mut result),
        }
    }
    Ok(result)
}

/// The indices of at most `count` of the points `x` (n x dim) spread evenly, the first the one farthest from their centroid; fewer
/// if fewer of them are in distinct places.
///
/// # Errors
/// Where the points are not finite; [`Error::Cancelled`].
pub fn farthest_of(
    x: &[f64],
    dim: usize,
    count: usize,
    progress: &mut Progress<'_>,
) -> Result<Vec<usize>, Error> {
    check_points("candidates", x, dim)?;
    let place = |x: &[f64]| -> Position { std::array::from_fn(|k| x.get(k).copied().unwrap_or(0.0)) };
    spread(&x.chunks_exact(dim).map(place).collect::<Vec<_>>(), count, progress)
}

/// `count` places of the surface of `faces`, each as likely as another: count x dim, or none if no face has area.
///
/// # Errors
/// Where there are no finite points, or a face names none.
pub fn sample_surface(
    x: &[f64],
    dim: usize,
    faces: &[[u32; 3]],
    count: usize,
    seed: u64,
) -> Result<Vec<f64>, Error> {
    let (frame, points) = places(x, dim)?;
    let Some(surface) = Surface::new(&points, faces)? else { return Ok(Vec::new()) };
    let mut random = Random::new(seed);
    let mut result = Vec::with_capacity(count * dim);
    for _ in 0..count {
        leave(&frame, &surface.sample(&mut random), dim, &mut result);
    }
    Ok(result)
}

/// A place relative to the box of the shape, so that samples keep their digits far from the origin and squares neither over- nor
/// underflow.
type Position = [f64; 3];

fn places(x: &[f64], dim: usize) -> Result<(Frame, Vec<Position>), Error> {
    check_points("positions", x, dim)?;
    let frame = Frame::around(x, dim);
    let enter = |x: &[f64]| -> Position {
        std::array::from_fn(|k| x.get(k).map_or(0.0, |x| (x - frame.centre[k]) / frame.half))
    };
    let mut places: Vec<Position> = room(x.len() / dim)?;
    places.extend(x.chunks_exact(dim).map(enter));
    Ok((frame, places))
}

/// Appends a place in the coordinates of the points.
fn leave(frame: &Frame, place: &Position, dim: usize, to: &mut Vec<f64>) {
    to.extend((0..dim).map(|k| frame.centre[k] + frame.half * place[k]));
}

/// Places around their centroid, so large that squares neither over- nor underflow.
fn centred(places: &[Position]) -> Result<Vec<Position>, Error> {
    let count = places.len() as f64;
    let mean: Position = std::array::from_fn(|k| places.iter().map(|place| place[k]).sum::<f64>() / count);
    let mut centred: Vec<Position> = room(places.len())?;
    centred.extend(places.iter().map(|place| -> Position { std::array::from_fn(|k| place[k] - mean[k]) }));
    let size = centred.iter().flatten().fold(0.0, |size: f64, c| size.max(c.abs()));
    if size > 0.0 {
        centred.iter_mut().flatten().for_each(|c| *c /= size);
    }
    if size.is_finite() && centred.iter().flatten().all(|c| c.is_finite()) {
        Ok(centred)
    } else {
        Err(Error::argument("positions", "they are too far apart to be measured"))
    }
}

/// The candidates that are farthest from each other, at most `count`: fewer if fewer are in distinct places.
fn spread(candidates: &[Position], count: usize, progress: &mut Progress<'_>) -> Result<Vec<usize>, Error> {
    let candidates = centred(candidates)?;
    let mut away = room(candidates.len())?;
    away.resize(candidates.len(), f64::INFINITY);
    let mut chosen = Vec::with_capacity(count.min(candidates.len()));
    // The farthest from the centroid; from then on the farthest from those that are chosen. The first of equals.
    let farther =
        |best: (usize, f64), i: usize, distance: f64| if distance > best.1 { (i, distance) } else { best };
    let mut next = (0, f64::NEG_INFINITY);
    for (i, candidate) in candidates.iter().enumerate() {
        next = farther(next, i, squared_distance(candidate, &[0.0; 3]));
    }
    let mut distance = f64::INFINITY;
    let often = (STRETCH / candidates.len().max(1)).max(1);
    while chosen.len() < count.min(candidates.len()) && distance > 0.0 {
        if chosen.len() % often == 0 {
            report(progress, chosen.len() as f64 / count as f64)?;
        }
        chosen.push(next.0);
        let from = candidates[next.0];
        next = (0, f64::NEG_INFINITY);
        for (i, (away, candidate)) in away.iter_mut().zip(&candidates).enumerate() {
            *away = away.min(squared_distance(candidate, &from));
            next = farther(next, i, *away);
        }
        distance = next.1;
    }
    Ok(chosen)
}

fn squared_distance(a: &Position, b: &Position) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// The faces that have area.
pub(crate) struct Surface<'a> {
    points: &'a [Position],
    pub(crate) faces: Vec<[u32; 3]>,
    /// The area of each face and those before it.
    sums: Vec<f64>,
}

impl<'a> Surface<'a> {
    pub(crate) fn new(points: &'a [Position], all: &[[u32; 3]]) -> Result<Option<Surface<'a>>, Error> {
        let n = points.len();
        if let Some(face) = all.iter().find(|face| face.iter().any(|&corner| corner as usize >= n)) {
            let found = face.map(|corner| corner.to_string()).join(", ");
            let message =
                format!("expected faces to name vertices 0 to {}, found ({found})", n.saturating_sub(1));
            return Err(Error::argument("faces", message));
        }
        let (mut faces, mut sums, mut sum) = (Vec::new(), Vec::new(), 0.0);
        for &face in all {
            let [a, b, c] = face.map(|corner| points[corner as usize]);
            let edge = |p: Position| -> Position { std::array::from_fn(|k| p[k] - a[k]) };
            let (u, v) = (edge(b), edge(c));
            let dot = |a: &Position, b: &Position| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
            let area = (dot(&u, &u) * dot(&v, &v) - dot(&u, &v).powi(2)).max(0.0).sqrt();
            if area > 0.0 {
                sum += area;
                faces.push(face);
                sums.push(sum);
            }
        }
        Ok((sum > 0.0).then_some(Surface { points, faces, sums }))
    }

    /// The vertices of the faces, each once.
    fn vertices(&self, n: usize) -> Vec<u32> {
        let mut named = vec![false; n];
        self.faces.iter().flatten().for_each(|&corner| named[corner as usize] = true);
        (0..n as u32).filter(|&index| named[index as usize]).collect()
    }

    /// A place on the surface, each as likely as another.
    fn sample(&self, random: &mut Random) -> Position {
        self.sample_in(random).1
    }

    /// The same, with the number of its face.
    pub(crate) fn sample_in(&self, random: &mut Random) -> (usize, Position) {
        let at = random.unit() * self.sums[self.sums.len() - 1];
        let face = self.sums.partition_point(|&sum| sum <= at).min(self.faces.len() - 1);
        let [a, b, c] = self.faces[face].map(|corner| self.points[corner as usize]);
        let (mut s, mut t) = (random.unit(), random.unit());
        if s + t > 1.0 {
            (s, t) = (1.0 - s, 1.0 - t);
        }
        (face, std::array::from_fn(|k| a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [f64; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
    const TWO_FACES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

    /// Each next point by the definition, with nothing kept.
    fn naive(candidates: &[Position], count: usize) -> Vec<usize> {
        let n = candidates.len() as f64;
        let mean = std::array::from_fn(|k| candidates.iter().map(|c| c[k]).sum::<f64>() / n);
        let mut chosen: Vec<usize> = Vec::new();
        for _ in 0..count {
            let score = |i: usize| {
                let to = |place: &Position| squared_distance(&candidates[i], place);
                chosen.iter().map(|&j| to(&candidates[j])).reduce(f64::min).unwrap_or_else(|| to(&mean))
            };
            let best = (0..candidates.len()).max_by(|&i, &j| score(i).total_cmp(&score(j)).then(j.cmp(&i)));
            chosen.push(best.unwrap());
        }
        chosen
    }

    #[test]
    fn each_point_is_the_farthest_from_those_before_it() {
        let mut random = Random::new(5);
        let candidates: Vec<Position> = (0..300).map(|_| std::array::from_fn(|_| random.unit())).collect();
        assert_eq!(spread(&candidates, 20, &mut |_| true).unwrap(), naive(&candidates, 20));
    }

    #[test]
    fn four_points_on_a_square_are_its_corners_to_the_bit() {
        let offset = 5.6e6;
        let square = SQUARE.map(|c| c + offset);
        let mut found = farthest_points(&square, 3, &TWO_FACES, 4, 0, &mut |_| true).unwrap();
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
        let surface = Surface::new(&points, &[[0, 1, 2], [1, 3, 4], [0, 0, 1]]).unwrap().unwrap();
        let mut random = Random::new(1);
        let beyond = (0..4000).filter(|_| surface.sample(&mut random)[0] > 3.0).count();
        assert!((900..1100).contains(&beyond), "{beyond}"); // a quarter of the area
    }

    #[test]
    fn a_cloud_whose_few_places_a_choice_would_miss_is_searched_whole() {
        let mut cloud = vec![0.0; 300_000];
        (cloud[7], cloud[8]) = (1.0, 2.0);
        let mut found = farthest_points(&cloud, 1, &[], 3, 0, &mut |_| true).unwrap();
        found.sort_by(f64::total_cmp);
        assert_eq!(found, [0.0, 1.0, 2.0]);
        let error = farthest_points(&cloud, 1, &[], 4, 0, &mut |_| true).unwrap_err().to_string();
        assert_eq!(error, "count: expected at most 3, the number of distinct places of the shape, found 4");
    }

    #[test]
    fn points_of_any_size_and_dimension_are_chosen_alike() {
        let mut random = Random::new(7);
        let x: Vec<f64> = (0..200).map(|_| random.unit()).collect();
        for dim in 1..=2 {
            let chosen = |x: &[f64]| farthest_of(x, dim, 9, &mut |_| true).unwrap();
            for size in [1e-200, 1e200] {
                assert_eq!(chosen(&x.iter().map(|c| c * size).collect::<Vec<_>>()), chosen(&x), "{size}");
            }
        }
        assert!(farthest_of(&[], 3, 4, &mut |_| true).unwrap().is_empty());
        assert_eq!(farthest_of(&[2.0, 2.0, 2.0], 1, 3, &mut |_| true).unwrap(), [0]);
        for x in [[f64::NAN, 0.0, 1.0], [-1.7e308, 1.7e308, 1.7e308]] {
            assert!(farthest_of(&x, 1, 2, &mut |_| true).is_err());
        }
        assert!(farthest_points(&[-1e308, 1e308], 1, &[], 2, 0, &mut |_| true).is_err());
    }

    #[test]
    fn a_wish_to_stop_is_heard() {
        let x = [0.0, 1.0, 2.0];
        assert!(matches!(farthest_of(&x, 1, 2, &mut |_| false), Err(Error::Cancelled)));
    }

    #[test]
    fn samples_leave_in_the_coordinates_of_the_points_or_not_at_all() {
        let samples = sample_surface(&SQUARE.map(|c| c + 5.6e6), 3, &TWO_FACES, 50, 0).unwrap();
        assert_eq!(samples.len(), 150);
        assert!(samples.chunks_exact(3).all(|p| p[0] > 5.6e6 && p[1] < 5.6e6 + 1.0 && p[2] == 5.6e6));
        assert!(sample_surface(&SQUARE, 3, &[[0, 1, 1]], 50, 0).unwrap().is_empty());
        assert!(sample_surface(&SQUARE, 3, &[[0, 1, 9]], 50, 0).is_err());
    }

    #[test]
    fn the_same_seed_gives_the_same_points() {
        let points = |seed| farthest_points(&SQUARE, 3, &TWO_FACES, 30, seed, &mut |_| true).unwrap();
        assert_eq!(points(3), points(3));
        assert_ne!(points(3), points(4));
    }

    #[test]
    fn refuses_what_has_no_points_and_faces_of_none() {
        assert!(farthest_points(&[], 3, &[], 1, 0, &mut |_| true).is_err());
        assert!(farthest_points(&SQUARE, 3, &[[0, 1, 4]], 1, 0, &mut |_| true).is_err());
        assert!(farthest_points(&SQUARE, 3, &TWO_FACES, 0, 0, &mut |_| true).is_err());
        assert!(farthest_points(&[f64::NAN, 0.0], 2, &[], 1, 0, &mut |_| true).is_err());
    }
}
