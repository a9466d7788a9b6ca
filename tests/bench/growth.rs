//! How time grows with what there is: from 1e2 to 1e5 nodes, materials, parts, slivers, objects and steps.
//!
//! `cargo bench --bench growth`; with `-- --quick` up to 1e3 alone. Each row is N, the time and the time for each
//! of N: what grows like N, or N log N, keeps nearly the same in the last column, and what is quadratic has ten times more
//! in each row. A kind that takes longer than [`ENOUGH`] is not tried with more.

#![allow(clippy::print_stdout, reason = "a benchmark prints what it measures")]

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use photosurface::read::{read_gltf_bytes, read_model};
use photosurface::render::{Camera, PictureOptions, PictureSize, Projection, Scenery, Viewpoint};
use photosurface::scene::Place;
use photosurface::{
    DVec3, Mesh, Model, Object, Observer, Part, PlacedScene, Scene, Source, SurfaceOptions,
    Velocity,
};
use serde_json::{Value, json};

/// With ten times as many, a kind that grows like N takes up to ten times as long.
const ENOUGH: Duration = Duration::from_secs(6);

/// A row: what is timed of so many.
type Timed = fn(u32, &Path) -> Duration;

fn main() {
    let is_quick = std::env::args().any(|argument| argument == "--quick");
    let counts: &[u32] = match is_quick {
        true => &[100, 1000],
        false => &[100, 1000, 10_000, 100_000],
    };
    let kinds: [(&str, Timed); 9] = [
        ("reading nodes of one name, and a placed of them", |n, _| {
            nodes(n, |_| "bolt".to_owned())
        }),
        (
            "reading nodes of own names, and a placed of them",
            |n, _| nodes(n, |k| format!("n{k}")),
        ),
        ("reading materials of a glTF", |n, _| gltf_materials(n)),
        ("reading usemtl and newmtl of an OBJ", obj_materials),
        ("a picture of parts of one object", |n, _| parts(n)),
        ("a picture of objects of all velocities", |n, _| objects(n)),
        ("a picture of a fan of slivers", |n, _| slivers(n)),
        ("photosurfaces of objects of a scene", |n, _| scene(n)),
        ("photosurfaces of one object at steps", |n, _| steps(n)),
    ];
    let folder = tempfile::tempdir().expect("a temporary directory can be made");
    for (name, timed) in kinds {
        println!("{name}\n{:>10} {:>12} {:>12}", "N", "seconds", "us / N");
        for &count in counts {
            let time = timed(count, folder.path());
            let (seconds, each) = (time.as_secs_f64(), time.as_secs_f64() * 1e6);
            println!(
                "{count:>10} {seconds:>12.4} {:>12.3}",
                each / f64::from(count)
            );
            if time > ENOUGH {
                println!("{:>10} not tried with more", "");
                break;
            }
        }
    }
}

fn timed<T>(work: impl FnOnce() -> T) -> Duration {
    let start = Instant::now();
    std::hint::black_box(work());
    start.elapsed()
}

/// A grid of places far enough from each other, 6 below and ahead.
fn place(index: u32, count: u32) -> DVec3 {
    let side = f64::from(count).sqrt().ceil();
    let (x, z) = (f64::from(index) % side, (f64::from(index) / side).floor());
    DVec3::new(3.0 * (x - side / 2.0), -6.0, -3.0 * z - 6.0)
}

fn cube(size: f64, middle: DVec3) -> Mesh {
    let corner = |k: u32| {
        let sign = |bit: u32| if k >> bit & 1 == 1 { size } else { -size };
        middle + DVec3::new(sign(0), sign(1), sign(2))
    };
    let quads = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    Mesh::new((0..8).map(corner).collect(), triangles.collect()).expect("eight corners")
}

fn model(meshes: impl Iterator<Item = Mesh>) -> Arc<Model> {
    let parts = meshes.enumerate().map(|(number, mesh)| {
        Part::new(format!("part{number}"), mesh, None).expect("no texture to miss")
    });
    Arc::new(Model {
        parts: parts.collect(),
        origin: None,
    })
}

fn observer() -> Observer {
    Observer {
        velocity: Velocity::from_beta(0.8, DVec3::NEG_Z).expect("slower than light"),
        ..Observer::default()
    }
}

fn placed(objects: Vec<(Object, Arc<Model>)>) -> PlacedScene {
    let (objects, models): (Vec<_>, Vec<_>) = objects.into_iter().unzip();
    let scene = Scene::new(observer(), objects).expect("names of their own");
    let models = models.iter().map(|model| Model::clone(model)).collect();
    PlacedScene::new(scene, models).expect("one model an object")
}

fn object(name: &str, model: Arc<Model>) -> (Object, Arc<Model>) {
    (Object::new(name, Source::Model(model.clone())), model)
}

/// A picture of a hundred by a hundred rays, the search trees included.
fn picture(placed: &PlacedScene) -> Duration {
    timed(|| {
        let mut scenery = Scenery::new();
        for (object, parts) in placed.objects() {
            for (_, part) in parts {
                scenery.add_at_rest(object, part);
            }
        }
        let size = PictureSize::new(100, 100).expect("a fair size");
        let projection = Projection::Perspective {
            vertical_fov_deg: 60.0,
        };
        let camera = Camera::new(size, projection, DVec3::NEG_Z).expect("a fair camera");
        let moment = placed.scene().moment(0).expect("a step");
        let options = PictureOptions {
            samples: 1,
            ..PictureOptions::default()
        };
        scenery.picture(&camera, Viewpoint::Observer(&moment), options)
    })
}

fn parts(count: u32) -> Duration {
    let cubes = model((0..count).map(|k| cube(1.0, place(k, count))));
    picture(&placed(vec![object("cubes", cubes)]))
}

fn objects(count: u32) -> Duration {
    let cube = model(std::iter::once(cube(1.0, DVec3::ZERO)));
    let objects = (0..count).map(|k| {
        let (mut object, cube) = object(&format!("cube{k}"), cube.clone());
        object.position = Place::new(place(k, count)).expect("finite");
        let speed = f64::from(k % 97) / 100.0;
        object.velocity = Velocity::from_beta(speed, DVec3::X).expect("slower than light");
        (object, cube)
    });
    picture(&placed(objects.collect()))
}

/// A tilted disc that is cut from one point of its rim.
fn slivers(count: u32) -> Duration {
    let rim = (0..count + 2).map(|k| {
        let angle = f64::from(k) * std::f64::consts::TAU / f64::from(count + 2);
        let (sin, cos) = angle.sin_cos();
        DVec3::new(3.0 * cos, 3.0 * sin, -12.0 + 2.0 * cos)
    });
    let fan = (1..=count).map(|k| [0, k, k + 1]).collect();
    let fan = Mesh::new(rim.collect(), fan).expect("a fan");
    picture(&placed(vec![object("fan", model(std::iter::once(fan)))]))
}

fn scene(count: u32) -> Duration {
    let cube = model(std::iter::once(cube(1.0, DVec3::ZERO)));
    timed(|| {
        let objects = (0..count).map(|k| {
            let (mut object, cube) = object(&format!("cube{k}"), cube.clone());
            object.position = Place::new(place(k, count)).expect("finite");
            (object, cube)
        });
        let placed = placed(objects.collect());
        unrefined(&placed, 1)
    })
}

fn steps(count: u32) -> Duration {
    let cube = model(std::iter::once(cube(1.0, DVec3::Y * 3.0)));
    timed(|| {
        let objects = vec![Object::new("cube", Source::Model(cube.clone()))];
        let scene = Scene::new(observer(), objects).expect("one name");
        let times = (0..count)
            .map(|k| f64::from(k) / f64::from(count))
            .collect();
        let scene = scene.with_steps(times).expect("finite times");
        unrefined(
            &PlacedScene::new(scene, vec![Model::clone(&cube)]).expect("one model"),
            count,
        )
    })
}

fn unrefined(placed: &PlacedScene, steps: u32) -> usize {
    let wanted = SurfaceOptions {
        subdivide: false,
        ..SurfaceOptions::default()
    };
    let surfaces =
        (0..steps as usize).flat_map(|step| placed.photosurfaces(step, wanted).expect("a step"));
    surfaces.map(|surface| surface.mesh.positions().len()).sum()
}

/// A triangle that every node draws, each with a name, or every primitive with a material.
fn gltf(nodes: Value, primitives: Value, materials: usize) -> Vec<u8> {
    // (0, 0, 0), (1, 0, 0), (0, 1, 0) in little-endian f32.
    let uri =
        "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    let count = nodes.as_array().map_or(0, Vec::len);
    let materials: Vec<_> = (0..materials)
        .map(|k| json!({ "name": format!("m{k}") }))
        .collect();
    let mut root = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": (0..count).collect::<Vec<_>>() }],
        "nodes": nodes,
        "meshes": [{ "primitives": primitives }],
        "buffers": [{ "byteLength": 36, "uri": uri }],
        "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
            "min": [0, 0, 0], "max": [1, 1, 0] }],
    });
    if !materials.is_empty() {
        root["materials"] = materials.into();
    }
    root.to_string().into_bytes()
}

fn read(bytes: &[u8]) -> Duration {
    timed(|| {
        let (model, _) = read_gltf_bytes(bytes, "".as_ref()).expect("a glTF");
        placed(vec![object("read", Arc::new(model))])
    })
}

fn nodes(count: u32, name: impl Fn(u32) -> String) -> Duration {
    let nodes: Vec<_> = (0..count)
        .map(|k| json!({ "name": name(k), "mesh": 0, "translation": [k, 0, 0] }))
        .collect();
    let primitives = json!([{ "attributes": { "POSITION": 0 } }]);
    read(&gltf(nodes.into(), primitives, 0))
}

fn gltf_materials(count: u32) -> Duration {
    let primitive = |k| json!({ "attributes": { "POSITION": 0 }, "material": k });
    let primitives: Vec<_> = (0..count).map(primitive).collect();
    read(&gltf(
        json!([{ "mesh": 0 }]),
        primitives.into(),
        count as usize,
    ))
}

fn obj_materials(count: u32, folder: &Path) -> Duration {
    let mut obj = "mtllib growth.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n".to_owned();
    let mut library = String::new();
    for k in 0..count {
        writeln!(obj, "g p{k}\nusemtl m{k}\nf 1 2 3").expect("a string takes everything");
        writeln!(library, "newmtl m{k}\nKd 1 0 0").expect("a string takes everything");
    }
    fs::write(folder.join("growth.mtl"), library).expect("a temporary file can be written");
    let path = folder.join("growth.obj");
    fs::write(&path, obj).expect("a temporary file can be written");
    timed(|| read_model(&path).expect("an OBJ"))
}
