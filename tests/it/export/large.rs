//! Large meshes, whose facets and images are computed where they are wanted and not held: the same numbers as one by one, on
//! any number of threads, in little memory.

use std::fs;
use std::path::Path;

use photosurface::material::{Crease, Normals};
use photosurface::read::{read_gltf_bytes, with_normals};
use photosurface::{
    DVec3, ExportSettings, Model, Object, Observer, PlacedScene, Scene, Source, Velocity, export,
};
use serde_json::json;

use crate::common::glb::{Glb, pack};

/// A wavy sheet ahead, of positions and triangles alone: a file with `rows` by `rows` vertices.
fn sheet(rows: u32) -> Vec<u8> {
    let place = |k: u32| {
        let [x, z] = [k % rows, k / rows].map(|i| 4.0 * i as f32 / rows as f32 - 2.0);
        [x, 0.1 * (3.0 * x).sin() * z.cos() - 0.5, z - 6.0]
    };
    let places = || (0..rows * rows).map(place);
    let quads = (0..rows * (rows - 1)).filter(|k| k % rows < rows - 1);
    let quad = |k: u32| [k, k + rows, k + 1, k + 1, k + rows, k + rows + 1];
    let mut data: Vec<u8> = places().flatten().flat_map(f32::to_le_bytes).collect();
    let length = data.len();
    data.extend(quads.flat_map(quad).flat_map(u32::to_le_bytes));
    let end = |of: fn(f32, f32) -> f32| {
        let ends = places().reduce(|a, b| [of(a[0], b[0]), of(a[1], b[1]), of(a[2], b[2])]);
        ends.unwrap()
    };
    let json = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "name": "sheet", "mesh": 0, "translation": [0.25, 0, -1] }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "buffers": [{ "byteLength": data.len() }],
        "bufferViews": [
            { "buffer": 0, "byteLength": length },
            { "buffer": 0, "byteOffset": length, "byteLength": data.len() - length }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": rows * rows, "type": "VEC3",
              "min": end(f32::min), "max": end(f32::max) },
            { "bufferView": 1, "componentType": 5125, "count": (data.len() - length) / 4, "type": "SCALAR" }],
    });
    pack(&json, &data)
}

fn placed(bytes: &[u8], normals: Normals) -> PlacedScene {
    let read = read_gltf_bytes(bytes, Path::new("")).unwrap();
    let (model, _) = with_normals(read, normals).unwrap();
    let observer = Observer {
        velocity: Velocity::from_beta(0.9, DVec3::NEG_Z).unwrap(),
        ..Observer::default()
    };
    let object = Object::new("sheet", Source::Model(Model::clone(&model).into()));
    let scene = Scene::new(observer, vec![object]).unwrap();
    PlacedScene::new(scene, vec![model]).unwrap()
}

/// The file that an export writes.
fn exported(placed: &PlacedScene, folder: &Path) -> Vec<u8> {
    let settings = ExportSettings {
        subdivide: false,
        ..ExportSettings::default()
    };
    let path = folder.join("out.glb");
    export(placed, &settings, &path, &()).unwrap();
    fs::read(path).unwrap()
}

#[test]
fn every_vertex_is_seen_as_it_is_by_itself() {
    let bytes = sheet(530);
    let folder = tempfile::tempdir().unwrap();
    let smooth = Normals::Smooth(Crease::default());
    for normals in [Normals::Source, smooth, Normals::None] {
        let placed = placed(&bytes, normals);
        let glb = Glb::new(&exported(&placed, folder.path()));
        let node = (glb.json["nodes"].as_array().unwrap().iter())
            .find(|node| node["name"] == "sheet")
            .unwrap();
        let offset: Vec<f64> = serde_json::from_value(node["translation"].clone()).unwrap();
        let mesh = node["mesh"].as_u64().unwrap() as usize;
        let attributes = &glb.json["meshes"][mesh]["primitives"][0]["attributes"];
        let positions = glb.numbers(&attributes["POSITION"]);
        let (object, parts) = placed.objects().next().unwrap();
        let (view, rest) = (placed.view(object, 0).unwrap(), parts[0].1.mesh());
        assert!(rest.vertex_count() > 1 << 18, "large");
        assert_eq!(positions.len(), 3 * rest.vertex_count());
        for (&place, found) in rest.positions().iter().zip(positions.as_chunks().0) {
            let seen = view.seen_position(place) - DVec3::from_slice(&offset);
            assert_eq!(*found, seen.as_vec3().to_array(), "{place}");
        }
        assert_eq!(rest.has_normals(), normals != Normals::None);
        let Some(directions) = rest.normals() else {
            continue;
        };
        let found = glb.numbers(&attributes["NORMAL"]);
        let vertices = rest.positions().iter().zip(directions);
        for ((&place, &normal), found) in vertices.zip(found.as_chunks().0) {
            let seen = view.seen_normal(place, normal);
            assert_eq!(*found, seen.as_vec3().to_array(), "{place}");
        }
    }
}

#[test]
fn threads_make_no_difference() {
    let bytes = sheet(530);
    let with = |threads: usize, normals: Normals| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let folder = tempfile::tempdir().unwrap();
        pool.unwrap()
            .install(|| exported(&placed(&bytes, normals), folder.path()))
    };
    for normals in [Normals::Source, Normals::Smooth(Crease::default())] {
        let [one, five] = [1, 5].map(|threads| with(threads, normals));
        assert!(one == five, "{normals}");
    }
}

/// The file of a million triangles with flat facets has 84 MB; 12 MB are those of the source.
#[cfg(target_os = "linux")]
#[test]
fn facets_of_a_large_mesh_take_no_memory() {
    use crate::common::alone::{alone, peak_memory};
    alone(
        "export::large::facets_of_a_large_mesh_take_no_memory",
        || {
            let bytes = sheet(708);
            let folder = tempfile::tempdir().unwrap();
            let before = peak_memory();
            for normals in [Normals::Source, Normals::None] {
                let placed = placed(&bytes, normals);
                let settings = ExportSettings {
                    subdivide: false,
                    ..ExportSettings::default()
                };
                export(&placed, &settings, &folder.path().join("out.glb"), &()).unwrap();
            }
            let more = peak_memory() - before;
            assert!(more < 50_000_000, "{more} bytes");
        },
    );
}
