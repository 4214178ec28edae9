//! Files that lie about their size, and any bytes at all.

use neuralmls_shapes::{Format, Shape};
use proptest::prelude::*;
use serde_json::{json, Value};

use crate::builder::{bent, glb, moved, no_files, read_glb, Builder};

#[test]
fn counts_without_bytes_behind_them_are_refused() {
    let mut b = Builder::new();
    let position = b.push("accessors", json!({ "componentType": 5126, "count": 1u32 << 31, "type": "VEC3" }));
    b.mesh(json!({ "attributes": { "POSITION": position } }));
    b.node(json!({ "mesh": 0 }));
    let refusal = b.refusal();
    assert!(refusal.starts_with("accessors[0].count: 2147483648 elements without a bufferView"), "{refusal}");
}

#[test]
fn a_mesh_shown_a_million_times_is_refused() {
    let mut b = Builder::new();
    let position = b.floats("VEC3", &vec![0.0; 30_000]);
    b.mesh(json!({ "mode": 0, "attributes": { "POSITION": position } }));
    b.json["nodes"] = vec![json!({ "mesh": 0 }); 2_000].into();
    b.json.as_object_mut().unwrap().remove("scenes");
    assert!(b.refusal().contains("too many for a file of this size"), "{}", b.refusal());
}

#[test]
fn indices_used_again_and_again_are_refused() {
    let mut b = Builder::new();
    let position = b.floats("VEC3", &[0.0; 9]);
    let indices = b.shorts(&vec![0; 30_000]);
    let primitive = json!({ "attributes": { "POSITION": position }, "indices": indices });
    b.push("meshes", json!({ "primitives": vec![primitive; 2_000] }));
    b.node(json!({ "mesh": 0 }));
    assert!(b.refusal().contains("too many triangles for a file of this size"));
}

#[test]
fn very_deep_things_are_read_or_refused_without_recursion() {
    let mut b = Builder::new();
    let position = b.floats("VEC3", &[0.0; 9]);
    b.mesh(json!({ "attributes": { "POSITION": position } }));
    let deep = 50_000;
    let nodes: Vec<Value> =
        (1..=deep).map(|i| json!({ "children": [i] })).chain([json!({ "mesh": 0 })]).collect();
    b.json["nodes"] = nodes.into();
    b.json["scenes"][0]["nodes"] = json!([0]);
    assert_eq!(b.read().positions().len(), 9);
    let brackets = "[".repeat(100_000);
    assert!(Shape::read(brackets.into_bytes(), Format::Gltf, &no_files).is_err());
}

/// A file with much in it, for mutations.
fn rich() -> Builder {
    let mut b = Builder::new();
    let position = b.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    let normal = b.floats("VEC3", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    let tangent = b.floats("VEC4", &[1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0]);
    let weights = b.floats("VEC4", &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0]);
    let joints = b.view(&[0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0]);
    let joints = b.push(
        "accessors",
        json!({ "bufferView": joints, "byteOffset": 0, "componentType": 5121, "count": 3, "type": "VEC4" }),
    );
    let indices = b.shorts(&[0, 1, 2]);
    let sparse = json!({
        "count": 1,
        "indices": { "bufferView": 5, "byteOffset": 0, "componentType": 5123 },
        "values": { "bufferView": 1, "byteOffset": 12 },
    });
    b.json["accessors"][position]["sparse"] = sparse;
    b.mesh(json!({
        "mode": 5, "indices": indices, "targets": [{ "POSITION": normal }],
        "attributes": { "POSITION": position, "NORMAL": normal, "TANGENT": tangent, "JOINTS_0": joints, "WEIGHTS_0": weights },
    }));
    let one = b.node(json!({ "mesh": 0, "translation": [1, 2, 3] }));
    b.node(json!({ "mesh": 0, "skin": 0 }));
    b.push("skins", json!({ "joints": [one, 1] }));
    b
}

/// The number of values in a JSON tree, and the one at a place changed.
fn change(value: &mut Value, place: &mut usize, new: &Value) {
    if *place == 0 {
        *value = new.clone();
    }
    *place = place.wrapping_sub(1);
    match value {
        Value::Array(items) => items.iter_mut().for_each(|item| change(item, place, new)),
        Value::Object(members) => members.values_mut().for_each(|member| change(member, place, new)),
        _ => {}
    }
}

fn never_panics(bytes: &[u8]) {
    for format in [Format::Glb, Format::Gltf] {
        let Ok(shape) = Shape::read(bytes.to_vec(), format, &no_files) else { continue };
        let n = shape.positions().len() / 3;
        assert!(shape.faces().unwrap_or_default().iter().flatten().all(|&i| (i as usize) < n));
        let maps = [1.0, 0.1, 0.0, 0.0, 1.0, 0.2, 0.0, 0.0, 0.5].repeat(n);
        if let Ok(written) = shape.write(&bent(shape.positions()), Some(&maps)) {
            let again = Shape::read(written.bytes, format, &no_files).unwrap();
            assert_eq!(again.positions().len(), shape.positions().len());
        }
    }
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        never_panics(&bytes);
        never_panics(&glb(&bytes, Some(&bytes), &bytes));
    }

    #[test]
    fn damaged_bytes_are_read_or_refused(at in any::<prop::sample::Index>(), byte in any::<u8>(), cut in any::<prop::sample::Index>()) {
        let mut file = rich().glb();
        let at = at.index(file.len());
        file[at] = byte;
        never_panics(&file);
        file.truncate(cut.index(file.len()));
        never_panics(&file);
    }

    #[test]
    fn damaged_json_is_read_or_refused(
        changes in prop::collection::vec((0usize..220, prop_oneof![
            (0u64..12).prop_map(Value::from),
            Just(json!(5120)), Just(json!(5121)), Just(json!(5125)), Just(json!(48)),
            Just(json!(u64::MAX)), Just(json!(-1)), Just(json!(4294967296u64)), Just(json!(1e300)), Just(json!(0.5)),
            Just(json!([])), Just(json!({})), Just(Value::Null), Just(json!("VEC3")), Just(json!([0, 1, 2])),
        ]), 1..4),
    ) {
        let mut b = rich();
        for (place, new) in changes {
            change(&mut b.json, &mut place.clone(), &new);
        }
        if b.json.is_object() {
            never_panics(&b.glb());
        }
    }
}

#[test]
fn the_file_for_mutations_is_itself_read() {
    assert_eq!(read_glb(&rich().glb()).unwrap().positions().len(), 18);
}

#[test]
fn thousands_of_instances_that_move_apart_each_keep_their_place() {
    let mut b = Builder::new();
    let position = b.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    b.mesh(json!({ "attributes": { "POSITION": position } }));
    let nodes: Vec<Value> = (0..5_000).map(|i| json!({ "mesh": 0, "translation": [i, 0, 0] })).collect();
    b.json["nodes"] = nodes.into();
    b.json.as_object_mut().unwrap().remove("scenes");
    let shape = b.read();
    // Instances 10 k and 10 k + 1 move alike.
    let lift = |i: usize| if i / 9 % 10 == 1 { i / 9 - 1 } else { i / 9 } as f64;
    let after: Vec<f64> = shape.positions().iter().enumerate().map(|(i, c)| c + lift(i)).collect();
    let (_, new) = moved(&shape, &after, None, 1e-2);
    assert_eq!(new.json["meshes"].as_array().unwrap().len(), 4_500);
}
