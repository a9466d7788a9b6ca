//! How time grows with the number of things in a glTF file: nodes of one name, nodes hidden, materials with textures of
//! their own. Where it grows as their number does, the rate is the same in every line.
//!
//! `cargo bench --bench growth`; with `-- --quick` in a minute or so. Read from memory, seen, written to memory.

#[path = "../common/mod.rs"]
mod common;
mod settings;

use std::path::Path;
use std::sync::Arc;

use common::made_glb::{MadeGlb, push};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use photosurface::{
    Export, Object, Observer, Scene, Source, Stage, Wanted, read_gltf_bytes, write_glb,
};
use serde_json::json;
use settings::settings;

const COUNTS: [usize; 4] = [100, 1000, 10_000, 100_000];

/// A JPEG as far as anybody looks at it here.
const PICTURE: &str = "data:image/jpeg;base64,/9j/";

/// So many nodes with one mesh.
fn nodes(count: usize, change: impl Fn(usize, &mut serde_json::Value)) -> Vec<u8> {
    let mut glb = MadeGlb::triangle(0);
    for index in 1..count {
        let mut node = json!({ "name": "bolt", "mesh": 0 });
        change(index, &mut node);
        let node = push(&mut glb.json["nodes"], node);
        push(&mut glb.json["scenes"][0]["nodes"], node.into());
    }
    glb.bytes()
}

/// So many primitives, each with a material, a texture, a sampler and an image of its own.
fn materials(count: usize) -> Vec<u8> {
    let mut glb = MadeGlb::triangle(0);
    let coordinates = glb.floats("VEC2", &[0.0; 6]);
    glb.primitive()["attributes"]["TEXCOORD_0"] = coordinates.into();
    let primitive = glb.primitive().clone();
    let mut primitives = vec![];
    for list in ["materials", "textures", "samplers", "images"] {
        glb.json[list] = json!([]);
    }
    for index in 0..count {
        let mut one = primitive.clone();
        one["material"] = index.into();
        primitives.push(one);
        let texture = json!({ "baseColorTexture": { "index": index } });
        let material = json!({ "name": format!("m{index}"), "pbrMetallicRoughness": texture });
        push(&mut glb.json["materials"], material);
        let texture = json!({ "source": index, "sampler": index });
        push(&mut glb.json["textures"], texture);
        push(
            &mut glb.json["samplers"],
            json!({ "name": format!("s{index}") }),
        );
        push(&mut glb.json["images"], json!({ "uri": PICTURE }));
    }
    glb.json["meshes"][0]["primitives"] = primitives.into();
    glb.bytes()
}

/// A file through the program; how many bytes come out.
fn pass_through(bytes: &[u8]) -> usize {
    let (model, _) = read_gltf_bytes(bytes, Path::new("")).expect("a model");
    let object = Object::new("it", Source::Model(Arc::new(model.clone())));
    let scene = Scene::new(Observer::default(), vec![object]).expect("one object");
    let stage = Stage::new(scene, vec![model]);
    let photosurfaces: Vec<_> = stage.photosurfaces(0, Wanted::default()).collect();
    let export = Export {
        scene: &stage.facts(),
        marker: None,
        photosurfaces: &photosurfaces,
        playback: None,
    };
    let mut written = vec![];
    write_glb(&export, &mut written).expect("memory takes it all");
    written.len()
}

fn growth(criterion: &mut Criterion) {
    type Make = fn(usize) -> Vec<u8>;
    let of_one_name: Make = |count| nodes(count, |_, _| {});
    let hidden: Make = |count| {
        nodes(count, |index, node| {
            node["name"] = json!(format!("hidden{index}"));
            node["extensions"] = json!({ "KHR_node_visibility": { "visible": false } });
        })
    };
    for (name, make) in [
        ("nodes of one name", of_one_name),
        ("hidden nodes", hidden),
        ("materials", materials),
    ] {
        let mut group = criterion.benchmark_group(name);
        for count in COUNTS {
            let bytes = make(count);
            group.throughput(Throughput::Elements(count as u64));
            group.bench_function(BenchmarkId::from_parameter(count), |bencher| {
                bencher.iter(|| pass_through(&bytes));
            });
        }
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = settings();
    targets = growth
}
criterion_main!(benches);
