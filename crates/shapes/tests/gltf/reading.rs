//! Positions in the world, faces, and what is refused.

use neuralmls_shapes::{Format, Shape};
use serde_json::json;

use crate::builder::{glb, le, no_files, read_glb, Builder};

const TRIANGLE: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

fn triangle() -> Builder {
    let mut b = Builder::new();
    let position = b.floats("VEC3", &TRIANGLE);
    b.mesh(json!({ "attributes": { "POSITION": position } }));
    b
}

fn close(found: &[f64], wanted: &[f64]) {
    assert_eq!(found.len(), wanted.len(), "{found:?}");
    assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?} instead of {wanted:?}");
}

#[test]
fn a_node_scales_then_turns_then_shifts() {
    let mut b = triangle();
    let half = 0.5f64.sqrt();
    // A quarter turn about z takes x to y and y to -x.
    b.node(
        json!({ "mesh": 0, "translation": [10, 0, 0], "rotation": [0, 0, half, half], "scale": [2, 3, 1] }),
    );
    close(b.read().positions(), &[10.0, 0.0, 0.0, 10.0, 2.0, 0.0, 7.0, 0.0, 0.0]);
}

#[test]
fn parents_place_their_children() {
    let mut b = triangle();
    let child = b.push("nodes", json!({ "mesh": 0, "translation": [1, 1, 1] }));
    let matrix = [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 5, 0, 0, 1];
    let middle = b.push("nodes", json!({ "children": [child], "matrix": matrix }));
    b.node(json!({ "children": [middle], "scale": [1, 10, 1] }));
    close(b.read().positions(), &[7.0, 20.0, 2.0, 9.0, 20.0, 2.0, 7.0, 40.0, 2.0]);
}

#[test]
fn each_node_shows_its_own_copy_and_hidden_nodes_none() {
    let mut b = triangle();
    b.node(json!({ "mesh": 0 }));
    b.push("nodes", json!({ "mesh": 0, "translation": [100, 0, 0] }));
    b.node(json!({ "mesh": 0, "translation": [0, 0, 1] }));
    let shape = b.read();
    assert_eq!(shape.positions().len(), 18);
    assert_eq!(shape.faces().unwrap(), [[0, 1, 2], [3, 4, 5]]);
    assert_eq!(shape.positions()[11], 1.0);
    b.json.as_object_mut().unwrap().remove("scenes");
    assert_eq!(b.read().positions().len(), 27);
}

#[test]
fn modes_make_triangles_or_none() {
    for (mode, faces) in [
        (4, Some(vec![[0, 1, 2]])),
        (5, Some(vec![[0, 1, 2], [1, 3, 2], [2, 3, 4]])),
        (6, Some(vec![[0, 1, 2], [0, 2, 3], [0, 3, 4]])),
        (0, None),
        (3, None),
    ] {
        let mut b = Builder::new();
        let position = b.floats("VEC3", &[0.5; 15]);
        b.mesh(json!({ "mode": mode, "attributes": { "POSITION": position } }));
        b.node(json!({ "mesh": 0 }));
        let shape = b.read();
        assert_eq!(shape.positions().len(), 15);
        assert_eq!(shape.faces(), faces.as_deref(), "mode {mode}");
    }
}

#[test]
fn primitives_with_the_same_positions_share_them() {
    let mut b = Builder::new();
    let position = b.floats("VEC3", &[0.25; 12]);
    let (one, two) = (b.shorts(&[0, 1, 2]), b.shorts(&[3, 2, 1]));
    b.push(
        "meshes",
        json!({ "primitives": [
            { "attributes": { "POSITION": position }, "indices": one },
            { "attributes": { "POSITION": position }, "indices": two },
        ] }),
    );
    b.node(json!({ "mesh": 0 }));
    let shape = b.read();
    assert_eq!(shape.positions().len(), 12);
    assert_eq!(shape.faces().unwrap(), [[0, 1, 2], [3, 2, 1]]);
}

#[test]
fn a_skin_places_vertices_by_their_joints_and_ignores_the_own_node() {
    let mut b = triangle();
    let joints = b.view(&[0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0]);
    let joints = b.push(
        "accessors",
        json!({ "bufferView": joints, "componentType": 5121, "count": 3, "type": "VEC4" }),
    );
    let weights = b.floats("VEC4", &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0]);
    for (name, accessor) in [("JOINTS_0", joints), ("WEIGHTS_0", weights)] {
        b.json["meshes"][0]["primitives"][0]["attributes"][name] = accessor.into();
    }
    let mut bind = [0.0f32; 32];
    (0..4).for_each(|k| (bind[5 * k], bind[16 + 5 * k]) = (1.0, 1.0));
    bind[16 + 12] = -1.0;
    let bind = b.floats("MAT4", &bind);
    b.node(json!({ "mesh": 0, "skin": 0, "translation": [1000, 0, 0] }));
    let still = b.node(json!({ "translation": [0, 0, 3] }));
    // Bound at x = 1, now at x = 1 and twice as large: (1, 0, 0) stays, (0, 1, 0) goes to (-1, 2, 0).
    let large = b.node(json!({ "translation": [1, 0, 0], "scale": [2, 2, 2] }));
    b.push("skins", json!({ "joints": [still, large], "inverseBindMatrices": bind }));
    close(b.read().positions(), &[0.0, 0.0, 3.0, 1.0, 0.0, 0.0, -0.5, 1.5, 1.5]);
}

#[test]
fn a_sparse_accessor_without_a_view_starts_from_zeros() {
    let mut b = Builder::new();
    let (indices, values) = (b.view(&[2]), b.view(&le(&[7.0, 8.0, 9.0])));
    let position = b.push(
        "accessors",
        json!({ "componentType": 5126, "count": 3, "type": "VEC3", "sparse": {
            "count": 1,
            "indices": { "bufferView": indices, "componentType": 5121 },
            "values": { "bufferView": values },
        } }),
    );
    b.mesh(json!({ "attributes": { "POSITION": position } }));
    b.node(json!({ "mesh": 0 }));
    assert_eq!(b.read().positions(), [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 7.0, 8.0, 9.0]);
}

#[test]
fn quantised_positions_are_fractions_if_normalised() {
    for (normalized, unit) in [(true, 1.0 / 127.0), (false, 1.0)] {
        let mut b = Builder::new();
        let view = b.view(&[127, 0, 129, 0, 128, 64, 1, 0]);
        b.json["bufferViews"][view]["byteStride"] = 4.into();
        let position = b.push(
            "accessors",
            json!({ "bufferView": view, "componentType": 5120, "count": 2, "type": "VEC3", "normalized": normalized }),
        );
        b.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
        b.mesh(json!({ "mode": 0, "attributes": { "POSITION": position } }));
        b.node(json!({ "mesh": 0 }));
        let least = if normalized { -1.0 } else { -128.0 };
        close(b.read().positions(), &[127.0 * unit, 0.0, -127.0 * unit, least, 64.0 * unit, unit]);
    }
}

#[test]
fn buffers_come_from_beside_the_file_by_their_decoded_path_or_from_within_it() {
    let mut b = triangle();
    b.node(json!({ "mesh": 0 }));
    let beside = |name: &str| match name {
        "my shape/ä.bin" => Ok(b.bin.clone()),
        other => Err(format!("asked for {other:?}")),
    };
    let read = |uri: &str| {
        let text = b.text().replace("shape.bin", uri);
        Shape::read(text.into_bytes(), Format::Gltf, &beside).map(|s| s.positions().to_vec())
    };
    let wanted: Vec<f64> = TRIANGLE.map(f64::from).to_vec();
    assert_eq!(read("my%20shape/%C3%A4.bin").unwrap(), wanted);
    let plain = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    assert_eq!(read(&format!("data:application/octet-stream;base64,{plain}")).unwrap(), wanted);
    for (uri, why) in [
        ("/etc/passwd", "not a path relative"),
        ("C:\\\\x.bin", "not a path relative"),
        ("https://example.org/x.bin", "not a path relative"),
        ("a/../../x.bin", "leaves the folder"),
        ("%2e%2e/x.bin", "leaves the folder"),
        ("..\\\\x.bin", "leaves the folder"),
        ("data:;base64,AA", "36 bytes are claimed, there are 1"),
        ("data:;base64,A", "not base64"),
        ("missing.bin", "asked for \"missing.bin\""),
    ] {
        let error = read(uri).unwrap_err().to_string();
        assert!(error.starts_with("buffers[0]") && error.contains(why), "{uri}: {error}");
    }
}

#[test]
fn a_glb_may_have_its_buffer_beside_it() {
    let mut b = triangle();
    b.node(json!({ "mesh": 0 }));
    let file = glb(b.text().as_bytes(), None, &[]);
    let shape = Shape::read(file, Format::Glb, &|_| Ok(b.bin.clone())).unwrap();
    assert_eq!(shape.positions().len(), 9);
}

#[test]
fn what_is_wrong_is_named_with_its_path() {
    type Break = fn(&mut Builder);
    let cases: [(Break, &str); 22] = [
        (
            |b| b.json["accessors"][0]["bufferView"] = 17.into(),
            "accessors[0].bufferView: 17 is not among the 1 bufferViews",
        ),
        (|b| b.json["accessors"][0]["count"] = 4.into(), "accessors[0]: 4 elements of 12 bytes"),
        (
            |b| b.json["accessors"][0]["count"] = 4_000_000_000_u64.into(),
            "go beyond the 36 bytes of bufferViews[0]",
        ),
        (
            |b| b.json["accessors"][0]["byteOffset"] = u64::MAX.into(),
            "go beyond the 36 bytes of bufferViews[0]",
        ),
        (|b| b.json["accessors"][0]["type"] = "VEC2".into(), "accessors[0] is not VEC3"),
        (|b| b.json["accessors"][0]["count"] = json!("x"), "accessors[0].count: expected a whole number"),
        (
            |b| b.json["bufferViews"][0]["byteLength"] = 37.into(),
            "bufferViews[0]: 37 bytes from byte 0 on go beyond the 36",
        ),
        (|b| b.json["bufferViews"][0]["byteStride"] = 8.into(), "do not fit a byteStride of 8"),
        (|b| b.json["nodes"][0]["mesh"] = 1.into(), "nodes[0].mesh: 1 is not among the 1 meshes"),
        (
            |b| b.json["nodes"][0]["children"] = json!([0]),
            "nodes[0].children: the node is its own descendant",
        ),
        (|b| b.json["nodes"][0]["scale"] = json!([1, 2]), "nodes[0].scale: expected an array of 3"),
        (
            |b| b.json["nodes"][0]["matrix"] = json!([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]),
            "last row",
        ),
        (
            |b| b.json["nodes"] = json!([{ "children": [2] }, { "children": [2] }, { "mesh": 0 }]),
            "nodes[1].children[0]: nodes[2] is also a child of nodes[0]",
        ),
        (|b| b.json["scenes"][0]["nodes"] = json!([9]), "scenes[0].nodes[0]: 9 is not among the 1 nodes"),
        (|b| b.json["meshes"][0]["primitives"][0]["mode"] = 7.into(), "mode 7"),
        (|b| b.json["asset"]["version"] = "1.0".into(), "this is glTF 1.0, only glTF 2 is read"),
        (|b| b.json["extensionsRequired"] = json!(["ACME_warp"]), "requires the extension ACME_warp"),
        (
            |b| b.json["extensionsRequired"] = json!(["KHR_meshopt_compression"]),
            "the extension KHR_meshopt_compression",
        ),
        (
            |b| b.json["bufferViews"][0]["extensions"] = json!({ "EXT_meshopt_compression": {} }),
            "the extension EXT_meshopt_compression",
        ),
        (
            |b| {
                b.json["meshes"][0]["primitives"][0]["extensions"] =
                    json!({ "KHR_draco_mesh_compression": {} })
            },
            "the extension KHR_draco_mesh_compression",
        ),
        (
            |b| b.json["nodes"][0]["extensions"] = json!({ "EXT_mesh_gpu_instancing": {} }),
            "the extension EXT_mesh_gpu_instancing",
        ),
        (
            |b| b.bin[2..4].copy_from_slice(&[0x80, 0x7f]),
            "accessors[0]: position 0, placed by nodes[0], is not finite",
        ),
    ];
    for (break_it, sentence) in cases {
        let mut b = triangle();
        b.node(json!({ "mesh": 0 }));
        b.read();
        break_it(&mut b);
        let refusal = b.refusal();
        assert!(refusal.contains(sentence), "{refusal}\n    instead of\n{sentence}");
    }
}

#[test]
fn an_index_beyond_the_positions_is_refused() {
    let mut b = triangle();
    let indices = b.shorts(&[0, 1, 3]);
    b.json["meshes"][0]["primitives"][0]["indices"] = indices.into();
    b.node(json!({ "mesh": 0 }));
    let sentence =
        "meshes[0].primitives[0].indices: accessors[1] has the index 3 (number 2), there are 3 positions";
    assert_eq!(b.refusal(), sentence);
}

#[test]
fn harmless_required_extensions_are_no_hindrance() {
    let mut b = triangle();
    b.json["extensionsRequired"] = json!(["KHR_texture_basisu", "EXT_texture_webp", "KHR_materials_unlit"]);
    b.node(json!({ "mesh": 0 }));
    assert_eq!(b.read().positions().len(), 9);
}

#[test]
fn a_damaged_container_is_refused() {
    let mut b = triangle();
    b.node(json!({ "mesh": 0 }));
    let good = b.glb();
    let refusal = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = good.clone();
        change(&mut bytes);
        read_glb(&bytes).err().unwrap().to_string()
    };
    assert!(refusal(&|f| f.truncate(f.len() - 1)).contains("the header claims"));
    assert!(refusal(&|f| f.truncate(7)).contains("header of 12 bytes is cut off"));
    assert!(refusal(&|f| f[4] = 1).contains("GLB version 1"));
    assert!(refusal(&|f| f[12..16].fill(255)).contains("byte 12: a chunk goes beyond the end"));
    assert!(refusal(&|f| f[16] = b'X').contains("byte 12: the first chunk is not JSON"));
    assert!(refusal(&|f| f[20] = b'[').contains("the JSON chunk: not JSON"));
    let text = Shape::read(b"{\n\"asset\": nonsense}".to_vec(), Format::Gltf, &no_files).err().unwrap();
    assert!(text.to_string().starts_with("line 2: not JSON"), "{text}");
}

#[test]
fn facts_tell_what_is_carried_over() {
    let mut b = triangle();
    b.push("materials", json!({ "name": "oak" }));
    b.push("animations", json!({ "name": "rock", "channels": [], "samplers": [] }));
    b.node(json!({ "mesh": 0 }));
    let shape = b.read();
    let fact = |name: &str| shape.facts().iter().find(|(n, _)| n == name).map(|(_, what)| what.as_str());
    assert_eq!(fact("materials"), Some("1 (oak)"));
    assert_eq!(fact("animations (kept)"), Some("1 (rock)"));
    assert_eq!(fact("instances"), Some("1"));
    assert_eq!(fact("images"), None);
}

#[test]
fn gaussian_splats_are_called_so_and_packed_ones_refused() {
    let splats = |inner: serde_json::Value| {
        let mut b = Builder::new();
        let position = b.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
        let scale = b.floats("VEC3", &[0.1; 6]);
        b.mesh(json!({
            "mode": 0,
            "attributes": { "POSITION": position, "KHR_gaussian_splatting:SCALE": scale },
            "extensions": { "KHR_gaussian_splatting": inner },
        }));
        b.node(json!({ "mesh": 0 }));
        b.json["extensionsUsed"] = json!(["KHR_gaussian_splatting"]);
        b.json["extensionsRequired"] = json!(["KHR_gaussian_splatting"]);
        b
    };
    let shape = splats(json!({ "kernel": "ellipse" })).read();
    let fact = shape.facts().iter().find(|(name, _)| name == "splats").unwrap();
    assert!(fact.1.starts_with("3D Gaussian splats"));
    let packed = splats(json!({ "extensions": { "KHR_gaussian_splatting_compression_spz_2": {} } }));
    assert!(packed.refusal().contains("uses the extension KHR_gaussian_splatting_compression_spz_2"));
}

#[test]
fn numbers_beyond_all_measure_are_refused_in_one_sentence() {
    for (key, value) in [("translation", "[1e400, 0, 0]"), ("scale", "[1, 1, -1e999]"), ("mesh", "1e400")] {
        let mut b = Builder::new();
        let position = b.floats("VEC3", &[0.0, 0.0, 0.0]);
        b.mesh(json!({ "attributes": { "POSITION": position } }));
        b.node(json!({ "mesh": 0 }));
        let huge: serde_json::Value = serde_json::from_str(value).unwrap();
        b.json["nodes"][0][key] = huge;
        assert!(b.refusal().starts_with(&format!("nodes[0].{key}: ")), "{}", b.refusal());
    }
}

#[test]
fn a_buffer_that_is_a_git_lfs_pointer_is_called_so() {
    let pointer =
        |_: &str| Ok(b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 7\n".to_vec());
    let text = br#"{"asset": {"version": "2.0"}, "buffers": [{"uri": "a.bin", "byteLength": 36}]}"#;
    let error = Shape::read(text.to_vec(), Format::Gltf, &pointer).err().unwrap();
    assert!(error.to_string().contains("a.bin\": this is a Git LFS pointer"), "{error}");
}
