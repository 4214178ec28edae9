//! Every glTF file of the data folder: read, written unmoved and moved, read again; or refused in a sentence.

use std::path::{Path, PathBuf};

use neuralmls_shapes::{Format, Shape};

use crate::builder::bent;

fn data() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let named = std::env::var_os("NEURALMLS_DATA").map(PathBuf::from);
    named.or(Some(beside)).filter(|path| path.is_dir())
}

fn gltf_files(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            gltf_files(&path, found);
        } else if path.extension().is_some_and(|e| e == "gltf" || e == "glb") {
            found.push(path);
        }
    }
}

/// What became of one file, in a line.
fn outcome(path: &Path) -> String {
    let source = std::fs::read(path).unwrap();
    let format = if path.extension().is_some_and(|e| e == "glb") { Format::Glb } else { Format::Gltf };
    let folder = path.parent().unwrap();
    let beside = |name: &str| std::fs::read(folder.join(name)).map_err(|e| e.to_string());
    let shape = match Shape::read(source.clone(), format, &beside) {
        Ok(shape) => shape,
        Err(error) => {
            let sentence = error.to_string();
            assert!(
                sentence.len() > 10 && !sentence.contains('\n') && !sentence.ends_with('.'),
                "{sentence}"
            );
            return format!("refused: {sentence}");
        }
    };
    let before = shape.positions();
    assert_eq!(shape.write(before, None).unwrap().bytes, source);

    let after = bent(before);
    let written = shape.write(&after, None).unwrap();
    let changed = |name: &str| match written.side_files.iter().find(|file| file.was == name) {
        Some(file) => Ok(file.bytes.clone()),
        None => beside(name),
    };
    let again = Shape::read(written.bytes.clone(), format, &changed).unwrap();
    assert_eq!(again.faces(), shape.faces());
    let size = after.iter().fold(0.0f64, |m, c| m.max(c.abs()));
    let worst = after.iter().zip(again.positions()).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
    let tolerance = if shape.facts().iter().any(|(_, what)| what == "quantised") { 1e-3 } else { 1e-5 };
    assert!(worst <= tolerance * size, "{}: wrong by {worst} of {size}", path.display());
    format!(
        "{} positions, {} triangles, off by {:.1e} of the size, {} -> {} bytes; {}",
        before.len() / 3,
        shape.faces().map_or(0, <[_]>::len),
        worst / size,
        source.len(),
        written.bytes.len(),
        shape.facts().iter().map(|(k, v)| format!("{k}: {v}")).collect::<Vec<_>>().join("; ")
    )
}

#[test]
fn every_real_file_is_read_and_written_or_refused_in_a_sentence() {
    let Some(folder) = data() else {
        println!("skipped: neither $NEURALMLS_DATA nor ../shared/data is there");
        return;
    };
    let mut files = Vec::new();
    gltf_files(&folder, &mut files);
    assert!(files.len() > 50, "only {} files in {}", files.len(), folder.display());
    let mut refused = 0;
    for path in &files {
        let outcome = outcome(path);
        refused += usize::from(outcome.starts_with("refused"));
        println!("{}\n    {outcome}", path.strip_prefix(&folder).unwrap().display());
    }
    println!("{} files, {refused} refused", files.len());
    assert!(refused < files.len() / 2);
}
