//! What every fuzz target checks: a file is refused in one sentence, or it is read, and then written unmoved it is the same
//! bytes, and moved it is a file again, with the positions that were told before and the same faces. Never a panic, never much memory.
//! Sessions: what is read is written, and read again says the same.

use std::alloc::{GlobalAlloc, Layout, System};

use neuralmls_shapes::{Error, Format, Shape};

/// The most that one allocation may take: the files are of a few kilobytes.
const LARGEST: usize = 4 << 20;

/// The system's allocator, which gives up on an allocation that no small file is worth: libFuzzer's own limit needs a
/// sanitizer, and a large block that is never touched does not show in the resident memory.
struct Limited;

#[global_allocator]
static ALLOCATOR: Limited = Limited;

fn limit(size: usize) {
    if size > LARGEST {
        eprintln!("an allocation of {size} bytes");
        std::process::abort();
    }
}

// SAFETY: passes everything on to the system's allocator.
unsafe impl GlobalAlloc for Limited {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        limit(layout.size());
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        limit(layout.size());
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        limit(size);
        unsafe { System.realloc(block, layout, size) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        unsafe { System.dealloc(block, layout) }
    }
}

/// Reads the bytes as a file of the format and writes it, unmoved and moved.
pub fn check(bytes: &[u8], format: Format) {
    check_sniff(bytes, format);
    let none = |_: &str| Err("no side files here".to_string());
    let shape = match Shape::read(bytes.to_vec(), format, &none) {
        Ok(shape) => shape,
        Err(error) => return check_sentence(&error),
    };
    let (positions, dim) = (shape.positions(), shape.dim());
    assert!(!positions.is_empty() && positions.iter().all(|c| c.is_finite()));
    let count = positions.len() / dim;
    let in_range = |face: &[u32; 3]| face.iter().all(|&index| (index as usize) < count);
    assert!(shape.faces().unwrap_or_default().iter().all(in_range));

    let unmoved = shape.write(positions, None).expect("an unmoved shape is always written");
    assert!(unmoved.bytes == bytes && unmoved.side_files.is_empty());

    let moved: Vec<f64> =
        positions.iter().enumerate().map(|(i, c)| 0.75 * c + (i % 7) as f64 * 0.125).collect();
    if moved.iter().any(|c| !c.is_finite()) {
        return;
    }
    let maps: Vec<f64> = (0..positions.len() * dim).map(|i| ((i % 11) as f64).sin()).collect();
    for maps in [None, Some(&maps[..])] {
        let written = match shape.write(&moved, maps) {
            Ok(written) => written,
            // Positions that the file's number type cannot hold.
            Err(error) => return check_sentence(&error),
        };
        let again = Shape::read(written.bytes, format, &none)
            .unwrap_or_else(|error| panic!("what was written: {error}"));
        assert_eq!(again.positions().len(), positions.len());
        assert_eq!(again.faces(), shape.faces());
        let told = shape.round(&moved).expect("what was written can be told");
        assert_eq!(again.positions(), told);
    }
}

fn check_sniff(bytes: &[u8], format: Format) {
    for extension in [None, Some(format.extensions()[0]), Some("obj")] {
        if let Err(error) = Format::sniff(bytes, extension) {
            check_sentence(&error);
        }
    }
}

/// Reads the bytes as a session or landmark file of any kind, and what is written of it.
pub fn check_session(bytes: &[u8]) {
    // What the ending decides, content does not: JSON, fiducials, a list with a count, and all else.
    for name in ["a.json", "a.fcsv", "a.land", "a"] {
        match neuralmls_session::read(bytes, name) {
            Ok(read) => {
                let text = read.session.to_json();
                let again =
                    neuralmls_session::read(text.as_bytes(), "a.json").expect("what was written is read");
                assert!(again.session == read.session && again.notes.is_empty());
                read.notes.iter().for_each(|note| check_words(note));
            }
            Err(error) => check_words(&error.message),
        }
    }
}

fn check_sentence(error: &Error) {
    check_words(&error.to_string());
}

fn check_words(sentence: &str) {
    assert!(!sentence.is_empty() && sentence.len() < 1000 && !sentence.contains('\n'), "{sentence}");
}

/// Reads the bytes as a saved map, which is then the same map when it is saved again, and moves points.
pub fn check_map(bytes: &[u8]) {
    match neuralmls_session::Map::from_bytes(bytes) {
        Ok(map) => {
            let again = neuralmls_session::Map::from_bytes(&map.to_bytes()).expect("what was saved is read");
            assert!(again.session() == map.session() && again.weights() == map.weights());
            let p = map.session().points.sources();
            // Absurd numbers may be refused, in words.
            if let Ok(moved) = map.at(&p, &mut |_| true) {
                assert_eq!(moved.len(), p.len());
            }
        }
        Err(error) => assert!(!error.message.is_empty() && !error.message.contains('\n')),
    }
}
