//! Every OBJ, OFF, XYZ, TXT, CSV, ASC and PTS file of the data folder: unmoved identical, bent with nothing else changed, or refused.

mod files;

use files::{bent, data_files};
use neuralmls_shapes::{Format, Shape};

/// The words of a line, or the fields of a table's.
fn words(format: Format, line: &str) -> Vec<&str> {
    match format {
        Format::Table => line.split([' ', '\t', ',', ';']).filter(|field| !field.is_empty()).collect(),
        _ => line.split_whitespace().collect(),
    }
}

/// The words of a line that hold the position.
fn coordinates(shape: &Shape) -> Vec<usize> {
    match shape.format() {
        Format::Obj => vec![1, 2, 3],
        Format::Table => {
            let columns = shape.facts().iter().find(|(what, _)| what == "columns of the position").unwrap();
            columns.1.split(", ").map(|column| column.parse::<usize>().unwrap() - 1).collect()
        }
        _ => vec![0, 1, 2],
    }
}

/// Whether a line may change when positions and normals do.
fn is_moving(format: Format, line: &str) -> bool {
    let words = words(format, line);
    match format {
        Format::Obj => matches!(words.first(), Some(&"v" | &"vn")),
        // A vertex has no fewer than three numbers, and one of them almost always has a point or an exponent.
        _ => words.len() >= 3,
    }
}

/// The corner without its normal, which may be renumbered.
fn without_normal(word: &str) -> &str {
    word.match_indices('/').nth(1).map_or(word, |(at, _)| &word[..at])
}

fn check_only_moving_lines_changed(shape: &Shape, name: &str, before: &[u8], after: &[u8]) {
    let format = shape.format();
    let (before, after) = (String::from_utf8_lossy(before), String::from_utf8_lossy(after));
    let still = |text: &str| -> Vec<String> {
        let lines = text.split('\n').filter(|line| !is_moving(format, line));
        lines
            .map(|line| match line.split_whitespace().next() {
                Some("f") => line.split(' ').map(without_normal).collect::<Vec<_>>().join(" "),
                _ => line.to_string(),
            })
            .collect()
    };
    assert!(still(&before) == still(&after), "{name}: a line without positions changed");
    if format != Format::Obj {
        assert_eq!(before.split('\n').count(), after.split('\n').count(), "{name}");
    }
    if before.lines().any(|line| line.starts_with("vn ")) {
        return;
    }
    for (a, b) in before.split('\n').zip(after.split('\n')) {
        let (a, b) = (words(format, a), words(format, b));
        assert_eq!(a.len(), b.len(), "{name}");
        // The keyword, and all that is behind the three coordinates.
        let coordinates = coordinates(shape);
        for at in (0..a.len()).filter(|at| !coordinates.contains(at)) {
            assert_eq!(a[at], b[at], "{name}");
        }
    }
}

fn check(path: &std::path::Path) -> String {
    let bytes = std::fs::read(path).unwrap();
    let name = path.to_string_lossy();
    let extension = path.extension().map(|e| e.to_string_lossy().into_owned());
    let none = |_: &str| Err("no side files here".to_string());
    let shape = match Shape::open(bytes.clone(), extension.as_deref(), &none) {
        Ok(shape) => shape,
        Err(error) => {
            assert!(!error.message.is_empty() && !error.message.contains('\n'));
            return format!("refused: {error}");
        }
    };
    assert!(shape.write(shape.positions(), None).unwrap().bytes == bytes, "{name} unmoved");
    let asked = bent(&shape);
    let written = shape.write(&asked, None).unwrap().bytes;
    let again = Shape::open(written.clone(), extension.as_deref(), &none)
        .unwrap_or_else(|e| panic!("{name} bent: {e}"));
    assert_eq!(again.faces(), shape.faces(), "{name}");
    assert!(
        shape.round(&asked).unwrap() == again.positions(),
        "{name}: what was written is not what is told"
    );
    let size = |k: usize| {
        let axis = || asked.iter().skip(k).step_by(shape.dim());
        axis().fold(f64::MIN, |a, &b| a.max(b)) - axis().fold(f64::MAX, |a, &b| a.min(b))
    };
    let longest = (0..shape.dim()).map(size).fold(0.0, f64::max);
    let largest = asked.iter().fold(0.0, |largest: f64, c| largest.max(c.abs()));
    let longest = if longest > 0.0 { longest } else { largest };
    for (is, asked) in again.positions().iter().zip(&asked) {
        assert!((is - asked).abs() <= 1e-7 * longest, "{name}: {is} {asked}");
    }
    check_only_moving_lines_changed(&shape, &name, &bytes, &written);
    let count = shape.positions().len() / shape.dim();
    let facts: Vec<_> = shape.facts().iter().map(|(what, value)| format!("{what}: {value}")).collect();
    format!("{count} vertices, {} triangles | {}", shape.faces().map_or(0, <[_]>::len), facts.join(" | "))
}

#[test]
fn real_files_are_unmoved_identical_and_bent_nothing_else_changes() {
    for format in [Format::Obj, Format::Off, Format::Table] {
        for extension in format.extensions() {
            for path in data_files(extension) {
                let shown: Vec<_> = path.iter().rev().take(2).map(|part| part.to_string_lossy()).collect();
                println!("{:60} {}", format!("{}/{}", shown[1], shown[0]), check(&path));
            }
        }
    }
}
