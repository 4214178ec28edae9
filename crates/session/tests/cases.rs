//! Landmark files as other tools wrote them, where they are there ($NEURALMLS_DATA or ../shared/data).

use std::fs;
use std::path::{Path, PathBuf};

use neuralmls_session::read;

fn data() -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let folder = std::env::var_os("NEURALMLS_DATA").map_or_else(beside, PathBuf::from).join("cases");
    if !folder.is_dir() {
        println!("skipped: there is no {} (see NEURALMLS_DATA)", folder.display());
        return None;
    }
    Some(folder)
}

#[test]
fn every_tool_says_the_same_three_landmarks() {
    let Some(folder) = data().map(|cases| cases.join("22-landmark-files")) else { return };
    let (foot, mid, tip, raised) = ([0.0, 0.5, 0.5], [3.0, 0.5, 0.5], [6.0, 0.5, 0.5], [5.0, 2.5, 0.5]);
    let mut count = 0;
    for entry in fs::read_dir(folder).expect("the folder is there") {
        let path = entry.expect("its entries too").path();
        let name = path.file_name().and_then(|name| name.to_str()).expect("plain names");
        if name == "README" {
            continue;
        }
        let bytes = fs::read(&path).expect("the file can be read");
        let points = read(&bytes, name).unwrap_or_else(|error| panic!("{name}: {error}")).session.points;
        // The targets alone, or two of the three landmarks, are in some.
        let end = if name.starts_with("dst") { raised } else { tip };
        let expected = match name {
            "label_header.csv" | "missing_target.csv" => [foot, end].concat(),
            _ => [foot, mid, end].concat(),
        };
        assert_eq!(points.sources(), expected, "{name}");
        let moved = points.last().map(|point| &*point.target);
        assert!(moved == Some(&end[..]) || moved == Some(&raised[..]), "{name}");
        count += 1;
    }
    assert_eq!(count, 22);
}

#[test]
fn mirrored_and_flipped_control_points_are_told() {
    let Some(folder) = data().map(|cases| cases.join("20-mirrored-and-flipped")) else { return };
    for (name, words) in
        [("mirror.csv", "the mirror image"), ("ras.csv", "x and y negated, as between LPS and RAS")]
    {
        let bytes = fs::read(folder.join(name)).expect("the file is there");
        let points = read(&bytes, name).expect("it is read").session.points;
        // The box of 02-starccm-space-solid/bar.stl.
        let warnings = points.check((&[0.0; 3], &[6.0, 1.0, 1.0])).expect("it is of the same dimension");
        assert!(warnings.iter().any(|warning| warning.contains(words)), "{name}: {warnings:?}");
    }
}
