//! The files of tests/sessions, read as tests/sessions/table.json says (its README has the table's form).

use std::fs;
use std::path::PathBuf;

use neuralmls_session::{join, read, ControlPoint, Error, ErrorKind, Read};
use serde_json::{json, Map, Value};

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/sessions")
}

fn table() -> Vec<Value> {
    let text = fs::read_to_string(folder().join("table.json")).expect("the table is there");
    serde_json::from_str(&text).expect("the table is a list")
}

/// What one entry's files give.
fn outcome(entry: &Value) -> Result<Read, Error> {
    let files: Vec<&str> =
        entry["files"].as_array().expect("files").iter().filter_map(Value::as_str).collect();
    let one = |name: &str| read(&fs::read(folder().join(name)).expect("the file is there"), name);
    match files[..] {
        [file] => one(file),
        [source, target] => join(one(source)?, one(target)?, entry["by_order"] == true),
        _ => panic!("one or two files"),
    }
}

/// The outcome in the table's form.
fn told(outcome: &Result<Read, Error>) -> Value {
    match outcome {
        Ok(Read { session, notes, .. }) => {
            // Settings, frame and unknown keys as a session file has them.
            let Ok(Value::Object(mut keys)) = serde_json::from_str(&session.to_json()) else {
                panic!("an object")
            };
            for key in ["format", "version", "control_points"] {
                keys.shift_remove(key);
            }
            let points: Vec<Value> = session.points.iter().map(point).collect();
            json!({"points": points, "keys": keys, "notes": notes})
        }
        Err(Error { kind, message }) => {
            let kind = match kind {
                ErrorKind::File => "file",
                ErrorKind::ControlPoint => "control point",
                ErrorKind::Argument => "argument",
                ErrorKind::Memory => "memory",
                ErrorKind::Cancelled => "cancelled",
            };
            json!({"kind": kind, "sentence": message})
        }
    }
}

fn point(point: &ControlPoint) -> Value {
    let mut told = Map::new();
    let mut put = |key: &str, value: Value| told.insert(key.into(), value);
    put("name", point.name.clone().into());
    put("position", point.position.clone().into());
    put("target", point.target.clone().into());
    if let Some(orientation) = &point.orientation {
        let axis = orientation.axis.to_vec();
        put("orientation", json!({"axis": axis, "degrees": orientation.degrees, "scale": orientation.scale}));
    }
    if point.weight != 1.0 {
        put("weight", point.weight.into());
    }
    if point.locked {
        put("locked", true.into());
    }
    for (key, text) in [("mirror_of", &point.mirror_of), ("group", &point.group)] {
        if let Some(text) = text {
            put(key, text.clone().into());
        }
    }
    if !point.others.is_empty() {
        put("others", point.others.clone().into());
    }
    told.into()
}

/// Whether two values say the same, numbers bit for bit, however they are written.
fn same(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => {
            a == b || a.as_f64().is_some_and(|a| b.as_f64().is_some_and(|b| a.to_bits() == b.to_bits()))
        }
        (Value::Array(a), Value::Array(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b)),
        (Value::Object(a), Value::Object(b)) => {
            a.len() == b.len() && a.iter().all(|(key, a)| b.get(key).is_some_and(|b| same(a, b)))
        }
        _ => a == b,
    }
}

#[test]
fn every_file_is_read_as_the_table_says() {
    let mut wrong = Vec::new();
    for entry in table() {
        let outcome = outcome(&entry);
        let key = if outcome.is_ok() { "read" } else { "error" };
        let told = told(&outcome);
        if !entry.get(key).is_some_and(|expected| same(expected, &told)) {
            wrong.push(format!("{}\n  {key}: {told}", entry["files"]));
        }
    }
    assert!(wrong.is_empty(), "{} differ:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn what_is_written_says_the_same_again() {
    for entry in table() {
        let Ok(Read { session, .. }) = outcome(&entry) else { continue };
        let again = read(session.to_json().as_bytes(), "again.json").expect("what was written is read");
        assert_eq!(again.session, session, "{}", entry["files"]);
        assert_eq!(again.notes, [""; 0], "{}", entry["files"]);
    }
}

#[test]
fn sentences_are_one_short_line_each() {
    for entry in table() {
        let sentences = match outcome(&entry) {
            Ok(read) => read.notes,
            Err(error) => vec![error.message],
        };
        for sentence in sentences {
            assert!(!sentence.is_empty() && sentence.chars().count() < 300, "{sentence}");
            assert!(
                !sentence.contains(|letter: char| letter.is_control() || letter == '\u{202e}'),
                "{sentence:?}"
            );
        }
    }
}

#[test]
fn every_file_is_in_the_table() {
    let table = table();
    let mut named: Vec<&str> =
        table.iter().flat_map(|entry| entry["files"].as_array().unwrap()).filter_map(Value::as_str).collect();
    named.sort_unstable();
    named.dedup();
    let mut there = 0;
    for kind in ["json", "table", "landmarks", "pairs", "broken"] {
        for file in fs::read_dir(folder().join(kind)).unwrap() {
            let file = format!("{kind}/{}", file.unwrap().file_name().to_str().unwrap());
            assert!(named.binary_search(&&*file).is_ok(), "{file}");
            there += 1;
        }
    }
    assert!(there >= 70);
}
