//! What the tests of several formats share: reading bytes, bending shapes, and the real files of the data folder.

// Each test uses a part of it.
#![allow(dead_code)]

use neuralmls_shapes::{Error, Format, Shape};
use std::path::{Path, PathBuf};

pub fn read(bytes: &[u8], format: Format) -> Result<Shape, Error> {
    Shape::read(bytes.to_vec(), format, &|_| Err("no side files here".into()))
}

/// The message of a refusal, which must be one.
pub fn refusal(bytes: &[u8], format: Format) -> String {
    match read(bytes, format) {
        Ok(_) => panic!("expected a refusal"),
        Err(error) => error.to_string(),
    }
}

/// A smooth bend of a tenth of the shape's size.
pub fn bent(shape: &Shape) -> Vec<f64> {
    let (x, dim) = (shape.positions(), shape.dim());
    let of_axis = |k: usize| x.iter().skip(k).step_by(dim).copied();
    let low: Vec<f64> = (0..dim).map(|k| of_axis(k).fold(f64::INFINITY, f64::min)).collect();
    let size = (0..dim).map(|k| of_axis(k).fold(f64::NEG_INFINITY, f64::max) - low[k]).fold(0.0, f64::max);
    let size = if size > 0.0 { size } else { 1.0 };
    let bend = |point: &[f64], k: usize| {
        let next = (k + 1) % dim;
        point[k] + size * 0.1 * (0.5 + 2.0 * (point[next] - low[next]) / size).sin()
    };
    x.chunks_exact(dim).flat_map(|point| (0..dim).map(move |k| bend(point, k))).collect()
}

/// The files of the data folder with this ending, in any case; none, and a word about it, where there is no such folder.
pub fn data_files(extension: &str) -> Vec<PathBuf> {
    fn walk(folder: &Path, extension: &str, found: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() {
                walk(&path, extension, found);
            } else if path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension)) {
                found.push(path);
            }
        }
    }
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let folder = std::env::var_os("NEURALMLS_DATA").map_or_else(beside, PathBuf::from);
    let mut found = Vec::new();
    walk(&folder, extension, &mut found);
    if found.is_empty() {
        println!("skipped: no .{extension} file in {} (see NEURALMLS_DATA)", folder.display());
    }
    found.sort();
    found
}

/// Reads every file of the data folder with the ending, and checks each: unmoved it is the same bytes; bent it is again a file
/// whose positions are as asked for to `precision` of the shape's largest coordinate, with the same faces; bent back, it is the file as it was, up to
/// what `same` forgives. Prints a table, and returns the names of the files that were refused.
pub fn check_data_files(
    format: Format,
    precision: f64,
    same: impl Fn(&Shape, &[u8], &[u8]) -> bool,
) -> Vec<String> {
    let mut refused = Vec::new();
    for path in data_files(format.extensions()[0]) {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let bytes = std::fs::read(&path).unwrap();
        let shape = match read(&bytes, format) {
            Ok(shape) => shape,
            Err(error) => {
                println!("{name:45} refused: {error}");
                assert!(!error.message.is_empty());
                refused.push(name);
                continue;
            }
        };
        assert_eq!(shape.write(shape.positions(), None).unwrap().bytes, bytes, "{name} unmoved");

        let asked = bent(&shape);
        let count = shape.positions().len() / shape.dim();
        let bent_file = match shape.write(&asked, None) {
            Ok(written) => written.bytes,
            Err(error) => {
                println!("{name:45} {count:7} positions, unmoved identical, bent refused: {error}");
                continue;
            }
        };
        let again = read(&bent_file, format).unwrap_or_else(|error| panic!("{name} bent: {error}"));
        assert_eq!(again.faces(), shape.faces(), "{name}");
        assert!(
            shape.round(&asked).unwrap() == again.positions(),
            "{name}: what was written is not what is told"
        );
        assert_eq!(again.facts(), shape.facts(), "{name}");
        let largest = asked.iter().fold(0.0, |l: f64, c| l.max(c.abs()));
        let is_whole = shape.facts().iter().any(|(what, _)| what == "positions");
        let allowed = if is_whole { 0.5 } else { precision * largest };
        for (index, (is, asked)) in again.positions().iter().zip(&asked).enumerate() {
            assert!((is - asked).abs() <= allowed, "{name}: coordinate {index} is {is}, asked {asked}");
        }
        // There and back with maps that turn no normals.
        let dim = shape.dim();
        let one_map = (0..dim * dim).map(|at| if at % (dim + 1) == 0 { 1.0 } else { 0.0 });
        let identity = one_map.collect::<Vec<f64>>().repeat(count);
        let there = shape.write(&asked, Some(&identity)).unwrap().bytes;
        let there = read(&there, format).unwrap();
        let back = there.write(shape.positions(), Some(&identity)).unwrap().bytes;
        assert!(same(&shape, &bytes, &back), "{name}: what should be carried over has changed");
        let facts: Vec<_> = shape.facts().iter().map(|(what, value)| format!("{what}: {value}")).collect();
        let faces = shape.faces().map_or(0, <[_]>::len);
        println!("{name:45} {count:7} positions {faces:7} triangles  {}", facts.join(" | "));
    }
    refused
}

/// Whether two text files have the same words, numbers compared as such: to `tolerance` of the larger of 1 and the number.
pub fn same_words(a: &[u8], b: &[u8], tolerance: f64) -> bool {
    let (a, b) = (String::from_utf8_lossy(a), String::from_utf8_lossy(b));
    let close = |a: &str, b: &str| {
        let both = a.parse::<f64>().ok().zip(b.parse::<f64>().ok());
        a == b || both.is_some_and(|(a, b)| (a - b).abs() <= tolerance * a.abs().max(1.0))
    };
    a.lines().count() == b.lines().count()
        && a.split_whitespace().count() == b.split_whitespace().count()
        && a.split_whitespace().zip(b.split_whitespace()).all(|(a, b)| close(a, b))
}
