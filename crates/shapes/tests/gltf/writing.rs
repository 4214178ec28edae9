//! Moved positions come back from the written file, and nothing else changes.

use neuralmls_shapes::{Format, Shape, SideFile};
use serde_json::{json, Value};

use crate::builder::{bent, glb, le, moved, no_files, parts, read_glb, Builder, Parts};

const QUAD: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.5];
const UP: [f32; 12] = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0];

/// A quad with normals, tangents, UVs and indices, without a node.
fn quad() -> Builder {
    let mut b = Builder::new();
    let uv = b.floats("VEC2", &[0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0]);
    let position = b.floats("VEC3", &QUAD);
    let normal = b.floats("VEC3", &UP);
    let tangent = b.floats("VEC4", &[1.0, 0.0, 0.0, -1.0].repeat(4));
    let indices = b.shorts(&[0, 1, 2, 0, 2, 3]);
    b.mesh(json!({
        "attributes": { "TEXCOORD_0": uv, "POSITION": position, "NORMAL": normal, "TANGENT": tangent },
        "indices": indices,
    }));
    b
}

/// Asserts that two files agree in an attribute of their meshes.
fn same(old: &Parts, new: &Parts, mesh: usize, name: &str) {
    let numbers = |parts: &Parts| parts.numbers(parts.attribute(mesh, name));
    assert_eq!(numbers(old), numbers(new), "{name}");
}

fn len(parts: &Parts, key: &str) -> usize {
    parts.json[key].as_array().unwrap().len()
}

#[test]
fn what_is_told_is_what_is_read_again() {
    for node in [
        json!({ "mesh": 0 }),
        json!({ "mesh": 0, "translation": [5e6, 0, 0] }),
        json!({ "mesh": 0, "matrix": [0, 1000, 0, 0, -1000, 0, 0, 0, 0, 0, 1000, 0, 5e6, 1, 2, 1] }),
    ] {
        let mut b = quad();
        b.node(node);
        let shape = b.read();
        let mut asked = bent(shape.positions());
        asked[..3].copy_from_slice(&shape.positions()[..3]);
        let written = shape.write(&asked, None).unwrap().bytes;
        assert_eq!(shape.round(&asked).unwrap(), read_glb(&written).unwrap().positions());
    }
}

#[test]
fn the_precision_is_that_of_the_nodes_own_space() {
    let mut b = quad();
    b.node(json!({ "mesh": 0, "translation": [5e6, 0, 0] }));
    let near = b.read();
    // Far away in the world, near in its node: nothing is lost.
    assert!(near.step().unwrap() < 2e-7);
    let place = near.round(&[5e6 + 0.05, 0.5, 0.0]).unwrap();
    assert!((place[0] - 5e6 - 0.05).abs() < 2e-9);
    let mut b = quad();
    b.node(json!({ "mesh": 0, "scale": [1e6, 1, 1] }));
    let stretched = b.read();
    assert!((stretched.step().unwrap() - 1e6 * f64::from(f32::EPSILON)).abs() < 1e-9);
    let place = stretched.round(&[1e6 + 0.04, 0.5, 0.0]).unwrap();
    assert!((place[0] - 1e6).abs() < 1e-9, "{place:?}");
}

#[test]
fn an_unmoved_file_is_the_same_file() {
    let mut b = quad();
    b.node(json!({ "mesh": 0, "rotation": [0.1, 0.2, 0.3, 0.9] }));
    let file = b.glb();
    let shape = read_glb(&file).unwrap();
    assert_eq!(shape.write(shape.positions(), None).unwrap().bytes, file);
}

#[test]
fn positions_move_in_place_and_nothing_but_the_bounds_changes_in_the_json() {
    let mut b = quad();
    let parent = b.node(json!({ "scale": [1, 3, 0.5], "translation": [0, 0, 7] }));
    let child = b.push("nodes", json!({ "mesh": 0, "rotation": [0.1, 0.7, 0.3, 0.6] }));
    b.json["nodes"][parent]["children"] = json!([child]);
    let shape = b.read();
    let (written, new) = moved(&shape, &bent(shape.positions()), None, 1e-5);
    let old = parts(&b.glb());
    assert_eq!(new.bin.len(), old.bin.len());
    same(&old, &new, 0, "TEXCOORD_0");
    assert_eq!(old.numbers(4), new.numbers(4));
    assert!(written.side_files.is_empty());

    let mut expected = old.json.clone();
    for accessor in [1, 2] {
        let numbers = new.numbers(accessor);
        for (key, pick) in [("min", f64::min as fn(f64, f64) -> f64), ("max", f64::max)] {
            for k in 0..3 {
                let bound = numbers.iter().skip(k).step_by(3).copied().reduce(pick);
                assert_eq!(new.json["accessors"][accessor][key][k].as_f64(), bound);
            }
            expected["accessors"][accessor][key] = new.json["accessors"][accessor][key].clone();
        }
    }
    assert_eq!(new.json, expected);
}

#[test]
fn vertices_that_stay_keep_their_bytes() {
    let mut b = quad();
    b.node(json!({ "mesh": 0, "rotation": [0.1, 0.7, 0.3, 0.6], "scale": [3, 7, 0.3] }));
    let shape = b.read();
    let mut after = shape.positions().to_vec();
    after[9] += 0.25;
    let (_, new) = moved(&shape, &after, None, 1e-6);
    let (was, is) = (parts(&b.glb()).numbers(1), new.numbers(1));
    assert_eq!(was[..9], is[..9]);
    assert_ne!(was[9..], is[9..]);
}

#[test]
fn normals_and_tangents_turn_in_the_space_of_their_node() {
    let mut b = quad();
    // The node takes z to x, and is not uniform.
    let half = 0.5f64.sqrt();
    b.node(json!({ "mesh": 0, "rotation": [0, half, 0, half], "scale": [2, 1, 4] }));
    let shape = b.read();
    assert!(shape.has_normals());
    // A quarter turn about y in the world: x to -z, z to x.
    let turn = [0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0];
    let rotate = |p: &[f64]| [p[2], p[1], -p[0]];
    let after: Vec<f64> = shape.positions().chunks_exact(3).flat_map(rotate).collect();
    let (_, new) = moved(&shape, &after, Some(&turn.repeat(4)), 1e-6);
    // The world normal was x, so it is -z now. A normal n of the node's space is in the world R S^-1 n: with R taking z to x
    // and x to -z, -z comes from x.
    for n in new.numbers(2).chunks_exact(3) {
        assert!((n[0] - 1.0).abs() < 1e-6 && n[1].abs() < 1e-6 && n[2].abs() < 1e-6, "{n:?}");
    }
    // The world tangent was -z, so it is -x now, which comes from -z.
    for t in new.numbers(3).chunks_exact(4) {
        assert!(t[0].abs() < 1e-6 && t[1].abs() < 1e-6 && (t[2] + 1.0).abs() < 1e-6 && t[3] == -1.0, "{t:?}");
    }
}

#[test]
fn a_shear_keeps_normals_across_the_surface_and_tangents_across_the_normals() {
    let mut b = quad();
    b.node(json!({ "mesh": 0, "rotation": [0.3, -0.2, 0.5, 0.7], "scale": [1, -2, 3] }));
    let shape = b.read();
    let map = [1.0, 0.4, 0.0, 0.0, 1.0, 0.3, 0.2, 0.0, 0.8];
    let shear =
        |p: &[f64]| -> [f64; 3] { std::array::from_fn(|r| (0..3).map(|c| map[3 * r + c] * p[c]).sum()) };
    let after: Vec<f64> = shape.positions().chunks_exact(3).flat_map(shear).collect();
    let (_, new) = moved(&shape, &after, Some(&map.repeat(4)), 1e-5);
    let (p, n, t) = (new.numbers(1), new.numbers(2), new.numbers(3));
    let dot = |a: &[f64], b: &[f64]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    for corner in 0..4 {
        let (n, t) = (&n[3 * corner..][..3], &t[4 * corner..][..3]);
        for edge in [1, 2] {
            // The old normal, z, is across the edges to corners 1 and 2, which lie in the plane z = 0.
            let e: Vec<f64> = (0..3).map(|k| p[3 * edge + k] - p[k]).collect();
            assert!(dot(n, &e).abs() < 1e-5, "{n:?} {e:?}");
        }
        assert!((dot(n, n) - 1.0).abs() < 1e-6 && (dot(t, t) - 1.0).abs() < 1e-6 && dot(n, t).abs() < 1e-6);
    }
}

#[test]
fn instances_that_move_apart_get_meshes_of_their_own() {
    let mut b = quad();
    b.json["meshes"][0]["name"] = "leaf".into();
    b.node(json!({ "mesh": 0 }));
    b.node(json!({ "mesh": 0, "translation": [3, 0, 0], "scale": [1, 2, 1] }));
    let shape = b.read();
    let (_, new) = moved(&shape, &bent(shape.positions()), None, 1e-5);
    assert_eq!(len(&new, "meshes"), 2);
    assert_eq!(new.json["meshes"][1]["name"], "leaf");
    assert_eq!((&new.json["nodes"][0]["mesh"], &new.json["nodes"][1]["mesh"]), (&json!(0), &json!(1)));
    assert_eq!(new.attribute(0, "TEXCOORD_0"), new.attribute(1, "TEXCOORD_0"));
    assert_ne!(new.attribute(0, "POSITION"), new.attribute(1, "POSITION"));
    same(&parts(&b.glb()), &new, 0, "TEXCOORD_0");
}

#[test]
fn instances_that_move_alike_stay_one_mesh() {
    let mut b = quad();
    b.node(json!({ "mesh": 0 }));
    b.node(json!({ "mesh": 0, "translation": [4, 0, 0] }));
    let shape = b.read();
    let mut after = shape.positions().to_vec();
    after.iter_mut().skip(2).step_by(3).for_each(|z| *z += 0.5);
    let (_, new) = moved(&shape, &after, None, 1e-6);
    assert_eq!((len(&new, "meshes"), len(&new, "accessors")), (1, 5));
}

#[test]
fn an_instance_that_stays_keeps_the_mesh_as_it_was() {
    let mut b = quad();
    b.node(json!({ "mesh": 0 }));
    b.node(json!({ "mesh": 0, "translation": [4, 0, 0] }));
    // A mesh that nothing shows, with the same positions.
    let unseen = b.json["meshes"][0].clone();
    b.push("meshes", unseen);
    let shape = b.read();
    let mut after = shape.positions().to_vec();
    after[..12].iter_mut().for_each(|c| *c += 0.5);
    let old = parts(&b.glb());
    let (_, new) = moved(&shape, &after, None, 1e-6);
    same(&old, &new, 1, "POSITION");
    assert_eq!(new.numbers(1), old.numbers(1));
}

#[test]
fn a_normal_accessor_that_other_primitives_share_is_not_spoilt() {
    let mut b = quad();
    let other = b.floats("VEC3", &QUAD.map(|c| c + 5.0));
    let mut primitive = b.json["meshes"][0]["primitives"][0].clone();
    primitive["attributes"]["POSITION"] = other.into();
    b.mesh(primitive);
    b.node(json!({ "mesh": 0 }));
    b.node(json!({ "mesh": 1 }));
    let shape = b.read();
    let mut maps = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0].repeat(8);
    // Only the first quad turns: a quarter turn about x, z to -y.
    for map in maps.chunks_exact_mut(9).take(4) {
        map.copy_from_slice(&[1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0]);
    }
    let mut after = shape.positions().to_vec();
    after[..12].chunks_exact_mut(3).for_each(|p| (p[1], p[2]) = (-p[2], p[1]));
    let (_, new) = moved(&shape, &after, Some(&maps), 1e-6);
    assert_eq!(new.numbers(new.attribute(1, "NORMAL")), UP.map(f64::from));
    assert_eq!(new.numbers(new.attribute(0, "NORMAL")), [0.0, -1.0, 0.0].repeat(4));
}

#[test]
fn interleaved_attributes_move_in_place_between_the_others() {
    let mut b = Builder::new();
    let vertex = |i: usize| [QUAD[3 * i], QUAD[3 * i + 1], QUAD[3 * i + 2], 0.1 + i as f32, 0.9];
    let view = b.view(&le(&(0..4).flat_map(vertex).collect::<Vec<_>>()));
    b.json["bufferViews"][view]["byteStride"] = 20.into();
    let mut accessor = |offset: usize, kind: &str| {
        let a = json!({ "bufferView": view, "byteOffset": offset, "componentType": 5126, "count": 4, "type": kind });
        b.push("accessors", a)
    };
    let (uv, position) = (accessor(12, "VEC2"), accessor(0, "VEC3"));
    b.mesh(json!({ "mode": 5, "attributes": { "POSITION": position, "TEXCOORD_0": uv } }));
    b.node(json!({ "mesh": 0 }));
    let shape = b.read();
    let (_, new) = moved(&shape, &bent(shape.positions()), None, 1e-6);
    let old = parts(&b.glb());
    assert_eq!(new.json, old.json);
    same(&old, &new, 0, "TEXCOORD_0");
}

#[test]
fn bytes_that_another_accessor_reads_stay_as_they_are() {
    let mut b = quad();
    // Colours over the bytes of the positions, from the second vertex on.
    let mut colour = b.json["accessors"][1].clone();
    colour["byteOffset"] = 12.into();
    colour["count"] = 3.into();
    let colour = b.push("accessors", colour);
    let position = b.floats("VEC3", &[0.5; 9]);
    b.mesh(json!({ "attributes": { "POSITION": position, "COLOR_0": colour } }));
    b.node(json!({ "mesh": 0 }));
    b.node(json!({ "mesh": 1 }));
    let shape = b.read();
    let (_, new) = moved(&shape, &bent(shape.positions()), None, 1e-5);
    let old = parts(&b.glb());
    same(&old, &new, 1, "COLOR_0");
    assert_eq!(len(&new, "bufferViews"), len(&old, "bufferViews") + 1);
}

#[test]
fn positions_that_are_also_morph_deltas_get_an_accessor_of_their_own() {
    let mut b = quad();
    b.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": 1 }]);
    b.node(json!({ "mesh": 0 }));
    let shape = b.read();
    let (_, new) = moved(&shape, &bent(shape.positions()), None, 1e-5);
    assert_eq!(new.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"], 1);
    assert_eq!(new.numbers(1), QUAD.map(f64::from));
    assert_eq!(new.attribute(0, "POSITION"), 5);
}

#[test]
fn sparse_positions_become_dense_ones_at_the_end_of_the_buffer() {
    let mut b = quad();
    let (indices, values) = (b.view(&[2, 3]), b.view(&le(&[9.0, 9.0, 9.0, 8.0, 8.0, 8.0])));
    b.json["accessors"][1]["sparse"] = json!({
        "count": 2,
        "indices": { "bufferView": indices, "componentType": 5121 },
        "values": { "bufferView": values },
    });
    b.node(json!({ "mesh": 0 }));
    let shape = b.read();
    assert_eq!(shape.positions()[6..12], [9.0, 9.0, 9.0, 8.0, 8.0, 8.0]);
    let still = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0].repeat(4);
    let (_, new) = moved(&shape, &bent(shape.positions()), Some(&still), 1e-5);
    assert_eq!(new.bin[..b.bin.len()], b.bin);
    assert!(new.json["accessors"][1].get("sparse").is_none());
    same(&parts(&b.glb()), &new, 0, "TEXCOORD_0");
}

#[test]
fn positions_without_any_buffer_get_one() {
    let mut b = Builder::new();
    let position = b.push("accessors", json!({ "componentType": 5126, "count": 3, "type": "VEC3" }));
    b.mesh(json!({ "attributes": { "POSITION": position } }));
    b.node(json!({ "mesh": 0 }));
    let shape = b.read();
    let after = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let written = shape.write(&after, None).unwrap();
    assert_eq!(read_glb(&written.bytes).unwrap().positions(), after);
}

/// A quad of normalised shorts with byte normals, four bytes apart.
fn quantised() -> Builder {
    let mut b = Builder::new();
    let shorts: Vec<u8> = [0i16, 0, 0, 0, 20000, 0, 0, 0, 20000, 20000, 0, 0, 0, 20000, 5000, 0]
        .iter()
        .flat_map(|s| s.to_le_bytes())
        .collect();
    let (positions, normals) = (b.view(&shorts), b.view(&[0, 0, 127, 55].repeat(4)));
    b.json["bufferViews"][positions]["byteStride"] = 8.into();
    b.json["bufferViews"][normals]["byteStride"] = 4.into();
    for (view, component) in [(positions, 5122), (normals, 5120)] {
        let accessor = json!({
            "bufferView": view, "componentType": component, "normalized": true, "count": 4, "type": "VEC3",
            "min": [0, 0, 0], "max": [0, 0, 0],
        });
        b.push("accessors", accessor);
    }
    b.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    b.mesh(json!({ "mode": 5, "attributes": { "POSITION": 0, "NORMAL": 1 } }));
    b.node(json!({ "mesh": 0, "scale": [10, 10, 10], "translation": [1, 2, 3] }));
    b
}

#[test]
fn quantised_positions_and_normals_stay_quantised_while_they_fit() {
    let b = quantised();
    let shape = b.read();
    let centre = [1.0, 2.0, 3.0];
    // A quarter turn about z around the node's place.
    let rotate = |p: &[f64]| [centre[0] - (p[1] - centre[1]), centre[1] + (p[0] - centre[0]), p[2]];
    let after: Vec<f64> = shape.positions().chunks_exact(3).flat_map(rotate).collect();
    // Normals turn about x by a quarter here, so that something is to be seen: z to -y.
    let maps = [1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0].repeat(4);
    let (_, new) = moved(&shape, &after, Some(&maps), 10.0 / 65000.0);
    assert_eq!(new.json["accessors"][0]["min"], json!([-20000, 0, 0]));
    assert_eq!(new.json["accessors"][0]["max"], json!([0, 20000, 5000]));
    assert_eq!(new.numbers(1), [0.0, -127.0, 0.0].repeat(4));
    assert_eq!(new.bin.len(), b.bin.len());
    // What lies between the elements stays.
    assert_eq!(new.bin[32 + 3], 55);
}

#[test]
fn quantised_positions_that_leave_their_range_become_floats() {
    let b = quantised();
    let shape = b.read();
    let after: Vec<f64> = shape.positions().iter().map(|c| 3.0 * c).collect();
    let (_, new) = moved(&shape, &after, None, 1e-5);
    let position = &new.json["accessors"][new.attribute(0, "POSITION")];
    assert_eq!(position["componentType"], 5126);
    assert!(position.get("normalized").is_none());
    assert_eq!(new.json["accessors"][1]["componentType"], 5120);
    assert_eq!(new.json["extensionsRequired"], json!(["KHR_mesh_quantization"]));
}

#[test]
fn skinned_positions_go_back_through_the_blend_of_their_joints() {
    let mut b = quad();
    let joints = b.view(&[0, 1, 0, 0].repeat(4));
    let joints = b.push(
        "accessors",
        json!({ "bufferView": joints, "componentType": 5121, "count": 4, "type": "VEC4" }),
    );
    let weights = [1.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0, 0.25, 0.75, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let weights = b.floats("VEC4", &weights);
    for (name, accessor) in [("JOINTS_0", joints), ("WEIGHTS_0", weights)] {
        b.json["meshes"][0]["primitives"][0]["attributes"][name] = accessor.into();
    }
    b.node(json!({ "mesh": 0, "skin": 0, "scale": [0, 0, 0] }));
    let a = b.node(json!({ "translation": [0, 0, 3], "rotation": [0.1, 0.2, 0.3, 0.9] }));
    let c = b.node(json!({ "translation": [1, 0, 0], "scale": [2, 1, 0.5] }));
    b.push("skins", json!({ "joints": [a, c] }));
    let shape = b.read();
    assert_eq!(shape.positions()[9..], [0.0, 1.0, 0.5]);
    let (_, new) = moved(&shape, &bent(shape.positions()), None, 1e-5);
    let old = parts(&b.glb());
    for name in ["TEXCOORD_0", "WEIGHTS_0", "JOINTS_0"] {
        same(&old, &new, 0, name);
    }
}

#[test]
fn a_node_that_flattens_its_mesh_takes_the_motion_within_the_plane() {
    let mut b = quad();
    b.node(json!({ "mesh": 0, "scale": [1, 2, 0] }));
    let shape = b.read();
    let after: Vec<f64> =
        shape.positions().chunks_exact(3).flat_map(|p| [p[0] + 1.0, p[1] + 4.0, p[2] + 9.0]).collect();
    let written = shape.write(&after, None).unwrap();
    let again = read_glb(&written.bytes).unwrap();
    for (a, was) in again.positions().chunks_exact(3).zip(shape.positions().chunks_exact(3)) {
        assert!((a[0] - was[0] - 1.0).abs() < 1e-6 && (a[1] - was[1] - 4.0).abs() < 1e-6 && a[2] == 0.0);
    }
}

#[test]
fn changed_buffers_beside_the_file_are_given_back_by_their_path() {
    let mut b = quad();
    b.node(json!({ "mesh": 0 }));
    let text = b.text().replace("shape.bin", "my%20shape.bin");
    let shape = Shape::read(text.into_bytes(), Format::Gltf, &|_| Ok(b.bin.clone())).unwrap();
    let after = bent(shape.positions());
    let written = shape.write(&after, None).unwrap();
    let [SideFile { name: path, bytes, .. }] = &written.side_files[..] else { panic!("one side file") };
    assert_eq!((path.as_str(), bytes.len()), ("my shape.bin", b.bin.len()));
    let again = Shape::read(written.bytes, Format::Gltf, &|_| Ok(bytes.clone())).unwrap();
    assert!(after.iter().zip(again.positions()).all(|(a, b)| (a - b).abs() < 1e-6));
}

#[test]
fn side_files_are_told_beforehand_and_none_takes_the_name_of_one_that_stays() {
    let mut b = quad();
    b.node(json!({ "mesh": 0 }));
    let mut json: Value = serde_json::from_str(&b.text()).unwrap();
    json["buffers"].as_array_mut().unwrap().push(json!({ "uri": "./bent.bin", "byteLength": 0 }));
    json["images"] = json!([{ "uri": "bent-2.bin" }]);
    let shape = Shape::read(json.to_string().into_bytes(), Format::Gltf, &|_| Ok(b.bin.clone())).unwrap();
    for (stem, name) in [("bent", "bent-3.bin"), ("other", "other.bin"), ("shape", "shape.bin")] {
        let written = shape.write_as(&bent(shape.positions()), None, Some(stem)).unwrap();
        assert_eq!(written.side_files.iter().map(|file| &file.name[..]).collect::<Vec<_>>(), [name]);
        assert_eq!(shape.side_files(stem), [name]);
        let json: Value = serde_json::from_slice(&written.bytes).unwrap();
        assert_eq!([&json["buffers"][0]["uri"], &json["buffers"][1]["uri"]], [name, "./bent.bin"]);
    }
    assert!(read_glb(&b.glb()).unwrap().side_files("bent").is_empty());
}

#[test]
fn embedded_buffers_are_embedded_again() {
    use base64::Engine;
    let mut b = quad();
    b.node(json!({ "mesh": 0 }));
    let data = base64::engine::general_purpose::STANDARD.encode(&b.bin);
    let text = b.text().replace("shape.bin", &format!("data:application/gltf-buffer;base64,{data}"));
    let shape = Shape::read(text.into_bytes(), Format::Gltf, &no_files).unwrap();
    let after = bent(shape.positions());
    let written = shape.write(&after, None).unwrap();
    assert!(written.side_files.is_empty());
    let json: Value = serde_json::from_slice(&written.bytes).unwrap();
    assert!(json["buffers"][0]["uri"].as_str().unwrap().starts_with("data:application/gltf-buffer;base64,"));
    let again = Shape::read(written.bytes, Format::Gltf, &no_files).unwrap();
    assert!(after.iter().zip(again.positions()).all(|(a, b)| (a - b).abs() < 1e-6));
}

#[test]
fn json_keeps_its_indentation_line_ends_key_order_and_number_text() {
    let mut b = quad();
    b.node(json!({ "mesh": 0 }));
    let pretty = serde_json::to_string_pretty(&serde_json::from_str::<Value>(&b.text()).unwrap()).unwrap();
    let before =
        pretty.replacen("{\n", "{\n  \"zoo\": [\n    1.500,\n    1e-7\n  ],\n", 1).replace('\n', "\r\n")
            + "\r\n";
    let shape = Shape::read(before.clone().into_bytes(), Format::Gltf, &|_| Ok(b.bin.clone())).unwrap();
    let after = String::from_utf8(shape.write(&bent(shape.positions()), None).unwrap().bytes).unwrap();
    let old: Vec<&str> = before.split_inclusive('\n').collect();
    let new: Vec<&str> = after.split_inclusive('\n').collect();
    assert_eq!(old.len(), new.len());
    let changed: Vec<_> = old.iter().zip(&new).filter(|(a, b)| a != b).collect();
    assert!((1..=12).contains(&changed.len()), "{changed:?}");
    assert!(changed.iter().all(|(_, new)| new.trim().trim_end_matches(',').parse::<f64>().is_ok()));
}

#[test]
fn other_chunks_of_a_glb_are_carried_over() {
    let mut b = quad();
    b.node(json!({ "mesh": 0 }));
    let plain = parts(&b.glb());
    let extra = b"\x04\0\0\0XTRAabcd";
    let file = glb(plain.json.to_string().as_bytes(), Some(&plain.bin), extra);
    let shape = read_glb(&file).unwrap();
    let written = shape.write(&bent(shape.positions()), None).unwrap();
    assert!(written.bytes.ends_with(extra));
    assert_eq!(written.bytes[8..12], (written.bytes.len() as u32).to_le_bytes());
    assert!(read_glb(&written.bytes).is_ok());
}

#[test]
fn buffers_that_name_the_same_file_change_together() {
    let mut b = quad();
    b.node(json!({ "mesh": 0 }));
    let mut json: Value = serde_json::from_str(&b.text()).unwrap();
    let buffer = json["buffers"][0].clone();
    json["buffers"].as_array_mut().unwrap().push(buffer);
    json["bufferViews"][2]["buffer"] = 1.into();
    let shape = Shape::read(json.to_string().into_bytes(), Format::Gltf, &|_| Ok(b.bin.clone())).unwrap();
    let maps = [1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0].repeat(4);
    let written = shape.write(&bent(shape.positions()), Some(&maps)).unwrap();
    assert_eq!(written.side_files.len(), 1);
}

#[test]
fn a_position_beyond_32_bit_floats_is_refused() {
    let mut b = quad();
    b.node(json!({ "mesh": 0 }));
    let shape = b.read();
    let mut after = shape.positions().to_vec();
    after[3] = 1e39;
    let error = shape.write(&after, None).unwrap_err();
    assert_eq!(error.to_string(), "position 1 is too far out for glTF's 32-bit floats");
}
