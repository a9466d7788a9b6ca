//! Throughput of files, in bytes a second: GLB and OBJ in, GLB and PLY out.
//!
//! `cargo bench --bench files`; with `-- --quick` in a fraction of the time. Both are read from files and written to
//! memory.

#[allow(dead_code, reason = "the tests use the rest")]
#[path = "../it/common/mod.rs"]
mod common;
mod settings;

use std::fmt::Write as _;
use std::sync::Arc;

use common::refining::{Sighting, frozen, model};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use photosurface::read::read_model;
use photosurface::scene::{Attribute, Attributes};
use photosurface::write::{Export, write_glb, write_ply};
use photosurface::{
    DVec3, Mesh, Photosurface, PlacedScene, Shape, Source, SurfaceOptions, Tolerance, Velocity,
};
use settings::settings;

/// Of a thousand to ten million triangles.
const CELLS: [u32; 5] = [22, 71, 224, 707, 2236];

/// Of larger ones no OBJ is read: their text alone takes too long.
const MAX_CELLS_OF_OBJ: u32 = 1000;

type Writer = fn(&PlacedScene, &[Photosurface]) -> Vec<u8>;

fn grid(cells: u32) -> Mesh {
    frozen(Shape::grid(2.0, cells).expect("a size and a count"), 1)
}

/// The photosurface of a mesh, all of its vertices and no other.
fn photosurfaces(mesh: Mesh) -> (PlacedScene, Vec<Photosurface>) {
    let velocity = Velocity::from_beta(0.6, DVec3::NEG_Z).expect("slower than light");
    let mut sighting = Sighting::new(DVec3::new(0.0, 0.0, 3.0), velocity, Tolerance::default());
    sighting.wanted = SurfaceOptions {
        subdivide: false,
        ..SurfaceOptions::default()
    };
    sighting.wanted.attributes = Attributes::default().with(Attribute::Doppler);
    let placed = sighting.placed(Source::Model(Arc::new(model(&[mesh]))));
    let made = placed
        .photosurfaces(0, sighting.wanted)
        .expect("a step")
        .collect();
    (placed, made)
}

fn with_export<R>(
    placed: &PlacedScene,
    made: &[Photosurface],
    write: impl FnOnce(&Export<'_>) -> R,
) -> R {
    write(&Export {
        scene: &placed.facts(),
        marker: None,
        photosurfaces: made,
        playback: None,
    })
}

fn glb(placed: &PlacedScene, made: &[Photosurface]) -> Vec<u8> {
    let mut bytes = vec![];
    with_export(placed, made, |export| write_glb(export, &mut bytes)).expect("memory takes it all");
    bytes
}

fn ply(placed: &PlacedScene, made: &[Photosurface]) -> Vec<u8> {
    let mut bytes = vec![];
    with_export(placed, made, |export| write_ply(export, &mut bytes)).expect("memory takes it all");
    bytes
}

fn obj(mesh: &Mesh) -> String {
    let mut text = String::new();
    let mut line = |line: std::fmt::Arguments<'_>| writeln!(text, "{line}").expect("a string");
    for position in mesh.positions() {
        line(format_args!(
            "v {} {} {}",
            position.x, position.y, position.z
        ));
    }
    for [a, b, c] in mesh
        .triangles()
        .iter()
        .map(|corners| corners.map(|corner| corner + 1))
    {
        line(format_args!("f {a} {b} {c}"));
    }
    text
}

fn import(criterion: &mut Criterion) {
    let directory = tempfile::tempdir().expect("a temporary directory can be made");
    let mut group = criterion.benchmark_group("import, bytes");
    for cells in CELLS {
        let mesh = grid(cells);
        let triangles = mesh.triangles().len();
        let path = |name: &str| directory.path().join(name);
        if cells <= MAX_CELLS_OF_OBJ {
            let (path, text) = (path("grid.obj"), obj(&mesh));
            std::fs::write(&path, &text).expect("a temporary file can be written");
            group.throughput(Throughput::Bytes(text.len() as u64));
            group.bench_function(BenchmarkId::new("OBJ, triangles", triangles), |bencher| {
                bencher.iter(|| read_model(&path).expect("it was just written"));
            });
        }
        let (placed, made) = photosurfaces(mesh);
        let (path, bytes) = (path("grid.glb"), glb(&placed, &made));
        std::fs::write(&path, &bytes).expect("a temporary file can be written");
        group.throughput(Throughput::Bytes(bytes.len() as u64));
        group.bench_function(BenchmarkId::new("GLB, triangles", triangles), |bencher| {
            bencher.iter(|| read_model(&path).expect("it was just written"));
        });
    }
    group.finish();
}

fn export(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("export, bytes");
    for cells in CELLS {
        let (placed, made) = photosurfaces(grid(cells));
        let triangles = made[0].facts.triangles;
        for (name, write) in [("GLB", glb as Writer), ("PLY", ply)] {
            group.throughput(Throughput::Bytes(write(&placed, &made).len() as u64));
            let id = BenchmarkId::new(format!("{name}, triangles"), triangles);
            group.bench_function(id, |bencher| bencher.iter(|| write(&placed, &made)));
        }
    }
    group.finish();
}

criterion_group! {
    name = files;
    config = settings();
    targets = import, export
}
criterion_main!(files);
