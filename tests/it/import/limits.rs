//! How much is made of a glTF file: as much as it stores many times over, never gigabytes of a kilobyte.

use std::path::Path;
use std::time::{Duration, Instant};

use photosurface::Model;
use photosurface::read::read_gltf_bytes;
use serde_json::{Value, json};

use crate::common::glb::{MadeGlb, push};

/// The limit of zeros in a small file, as `Quota` in `src/io/read/quota.rs` has it.
const LIMIT: usize = 1 << 24;

fn read(glb: &MadeGlb) -> Result<Model, String> {
    let read = read_gltf_bytes(&glb.bytes(), Path::new(""));
    read.map(|(model, _)| model)
        .map_err(|error| error.to_string())
}

/// That a file is refused for its size; what the error says.
fn refused(glb: &MadeGlb) -> String {
    let error = read(glb).expect_err("too much");
    assert!(error.contains(" numbers"), "{error}");
    assert!(error.contains("of a file of this size"), "{error}");
    error
}

#[test]
fn zeros_are_counted_for_all_accessors_together() {
    let sets = |vertices: usize, count: u32, shared: bool| {
        let mut glb = MadeGlb::triangle(vertices - 3);
        let mut accessor = glb.zeros("VEC2", vertices);
        for set in 0..count {
            if !shared {
                accessor = glb.zeros("VEC2", vertices);
            }
            glb.primitive()["attributes"][format!("TEXCOORD_{set}")] = accessor.into();
        }
        glb
    };
    let model = read(&sets(10_000, 60, false)).expect("60 sets of 10,000");
    assert_eq!(model.parts[0].mesh().texture_coordinates().len(), 60);
    // 12 bytes a vertex, of which 16 numbers each may be made, hold 95 sets of two and their positions and no more.
    let error = refused(&sets(200_000, 200, false));
    assert!(error.contains("TEXCOORD_"), "{error}");
    refused(&sets(200_000, 200, true));
}

#[test]
fn sixty_sets_of_sixteen_million_zeros_are_refused() {
    let mut glb = MadeGlb::new();
    let vertices = 16_000_000;
    let substitute = glb.floats("VEC3", &[1.0, 2.0, 3.0]);
    let index = glb.accessor("SCALAR", 5125, 1, &1u32.to_le_bytes());
    let positions = glb.zeros("VEC3", vertices);
    let view = |accessor: usize| glb.json["accessors"][accessor]["bufferView"].clone();
    let sparse = json!({ "count": 1, "indices": { "bufferView": view(index), "componentType": 5125 },
        "values": { "bufferView": view(substitute) } });
    glb.json["accessors"][positions]["sparse"] = sparse;
    glb.primitive()["attributes"]["POSITION"] = positions.into();
    for set in 0..60 {
        let zeros = glb.zeros("VEC2", vertices);
        glb.primitive()["attributes"][format!("TEXCOORD_{set}")] = zeros.into();
    }
    let error = refused(&glb);
    assert_eq!(
        error,
        format!(
            "meshes[0].primitives[0] (mesh \"made\"), POSITION, accessors[{positions}]: needs 48000000 numbers, \
             expected at most {LIMIT} of a file of this size"
        )
    );
}

/// Matrices have 16 numbers for each element.
#[test]
fn matrices_of_zeros_are_counted_by_their_numbers() {
    let mut glb = MadeGlb::triangle(0);
    let joints = glb.accessor("VEC4", 5121, 3, &[0; 12]);
    let weights = glb.floats("VEC4", &[0.25; 12]);
    let binds = glb.zeros("MAT4", LIMIT / 8);
    let attributes = &mut glb.primitive()["attributes"];
    attributes["JOINTS_0"] = joints.into();
    attributes["WEIGHTS_0"] = weights.into();
    glb.json["nodes"][0]["skin"] = json!(0);
    glb.json["skins"] = json!([{ "joints": [0], "inverseBindMatrices": binds }]);
    let error = refused(&glb);
    assert!(error.starts_with("skins[0].inverseBindMatrices"), "{error}");
}

/// A triangle at so many nodes.
fn at_nodes(mut glb: MadeGlb, count: usize) -> MadeGlb {
    for _ in 1..count {
        let node = push(&mut glb.json["nodes"], json!({ "mesh": 0 }));
        push(&mut glb.json["scenes"][0]["nodes"], node.into());
    }
    glb
}

#[test]
fn nodes_that_share_a_mesh_are_counted() {
    let model = read(&at_nodes(MadeGlb::triangle(1000), 1000)).expect("a million vertices");
    assert_eq!(model.parts.len(), 1000);
    let error = refused(&at_nodes(MadeGlb::triangle(20_000), 2000));
    assert!(
        error.starts_with("meshes[0]") || error.starts_with("nodes["),
        "{error}"
    );
}

#[test]
fn primitives_that_share_vertices_are_counted() {
    let shared = |primitives: usize| {
        let mut glb = MadeGlb::triangle(10_000);
        let all: Vec<Value> = vec![glb.primitive().clone(); primitives];
        glb.json["meshes"][0]["primitives"] = json!(all);
        glb
    };
    // One buffer of vertices for all materials is common.
    assert_eq!(read(&shared(100)).expect("a hundred").parts.len(), 100);
    refused(&shared(10_000));
}

#[test]
fn instances_are_counted() {
    let instanced = |vertices: usize, instances: usize, nodes: usize| {
        let mut glb = MadeGlb::triangle(vertices - 3);
        let normals = [0.0, 0.0, 1.0].repeat(vertices);
        let normals = glb.floats("VEC3", &normals);
        glb.primitive()["attributes"]["NORMAL"] = normals.into();
        let places: Vec<f32> = (0..3 * instances).map(|i| i as f32).collect();
        let places = glb.floats("VEC3", &places);
        let extension =
            json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": places } } });
        glb.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
        glb.json["nodes"][0]["extensions"] = extension.clone();
        let mut glb = at_nodes(glb, nodes);
        for node in 1..nodes {
            glb.json["nodes"][node]["extensions"] = extension.clone();
        }
        glb
    };
    let meadow = read(&instanced(4, 20_000, 1)).expect("20,000 blades of grass");
    assert_eq!(meadow.parts.len(), 20_000);
    let error = refused(&instanced(10_000, 5000, 1));
    assert!(
        error.starts_with("nodes[0] (\"it\"): with its copies "),
        "{error}"
    );
    // Small meshes count too, for each copy is a part with a name.
    refused(&instanced(3, 5000, 200));
}

#[test]
fn names_and_extras_that_copies_share_are_counted() {
    let mut named = at_nodes(MadeGlb::triangle(0), 500);
    named.json["meshes"][0]["name"] = json!("n".repeat(1_000_000));
    named.json["nodes"][0] = json!({ "mesh": 0 });
    refused(&named);
    let mut told = at_nodes(MadeGlb::triangle(0), 500);
    told.json["meshes"][0]["extras"] = json!("e".repeat(1_000_000));
    refused(&told);
}

/// 100,000 nodes one below the other, a hundred thousand morph targets, the same notes again and again.
#[test]
fn depth_and_number_take_their_time_and_no_more() {
    let start = Instant::now();
    let mut deep = MadeGlb::triangle(0);
    let nodes: Vec<Value> = (1..100_000).map(|i| json!({ "children": [i] })).collect();
    deep.json["nodes"] = nodes.into();
    push(&mut deep.json["nodes"], json!({ "mesh": 0 }));
    assert_eq!(read(&deep).expect("deep").parts.len(), 1);

    let mut morphing = MadeGlb::triangle(0);
    morphing.primitive()["targets"] = json!(vec![json!({}); 100_000]);
    morphing.json["meshes"][0]["weights"] = json!(vec![1.0; 100_000]);
    assert_eq!(read(&morphing).expect("morphing").parts.len(), 1);

    let mut hidden = at_nodes(MadeGlb::triangle(0), 50_000);
    for node in 1..50_000 {
        hidden.json["nodes"][node]["name"] = json!(format!("hidden{node}"));
        hidden.json["nodes"][node]["extensions"] =
            json!({ "KHR_node_visibility": { "visible": false } });
    }
    let read = read_gltf_bytes(&hidden.bytes(), Path::new(""));
    let (model, findings) = read.expect("one of many");
    assert_eq!(model.parts.len(), 1);
    assert_eq!(findings.notes.len(), 49_999);
    let time = start.elapsed();
    assert!(time < Duration::from_secs(60), "{time:?}");
}
