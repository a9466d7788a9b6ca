//! Throughput of whole stages: mapping and proving without subdivision, refinement of plates, both by threads.
//!
//! `cargo bench --bench stages`; with `-- --quick` in a fraction of the time. The table of how many triangles the
//! plates take, against theory, is that of `cargo bench --bench plates`.

#[allow(dead_code, reason = "the tests use the rest")]
#[path = "../it/common/mod.rs"]
mod common;
mod settings;

use std::sync::Arc;

use common::refining::{Sighting, frozen, model, plate};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use photosurface::{DVec3, Mesh, PlacedScene, Shape, Source, Tolerance, Velocity};
use rayon::{ThreadPool, ThreadPoolBuilder};
use settings::settings;

const THREADS: [usize; 2] = [1, 2];

fn sighting(tolerance: f64) -> Sighting {
    let velocity = Velocity::from_beta(0.6, DVec3::NEG_Z).expect("slower than light");
    let tolerance = Tolerance::absolute(tolerance * velocity.gamma_beta()).expect("a length");
    Sighting::new(DVec3::ZERO, velocity, tolerance)
}

fn placed(sighting: &Sighting, mesh: Mesh) -> PlacedScene {
    sighting.placed(Source::Model(Arc::new(model(&[mesh]))))
}

fn pool(threads: usize) -> ThreadPool {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("threads can be had")
}

/// Every vertex mapped with its normal, every triangle proven, none added.
fn without_subdivision(criterion: &mut Criterion) {
    let mut sighting = sighting(1.0);
    sighting.observer = DVec3::new(0.0, 0.0, 3.0);
    sighting.wanted.subdivide = false;
    let mut group = criterion.benchmark_group("without subdivision, vertices");
    for cells in [16, 50, 160, 500, 1600] {
        let grid = Shape::grid(2.0, cells).expect("a size and a count");
        let mesh = frozen(grid, 1);
        let vertices = mesh.positions().len() as u64;
        let placed = placed(&sighting, mesh);
        group.throughput(Throughput::Elements(vertices));
        for threads in THREADS {
            let pool = pool(threads);
            let id = BenchmarkId::new(format!("threads {threads}"), vertices);
            group.bench_function(id, |bencher| {
                bencher.iter(|| {
                    pool.install(|| {
                        placed
                            .photosurfaces(0, sighting.wanted)
                            .expect("a step")
                            .count()
                    })
                });
            });
        }
    }
    group.finish();
}

/// Triangles that are made of two.
fn plates(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("plates, triangles made");
    for h in [1.0, 0.1, 0.01, 0.001] {
        for e in [1e-3, 1e-4, 1e-5] {
            let sighting = sighting(e);
            let placed = placed(&sighting, plate(h));
            let made = placed.photosurfaces(0, sighting.wanted).expect("a step");
            let triangles: usize = made.map(|photosurface| photosurface.facts.triangles).sum();
            group.throughput(Throughput::Elements(triangles as u64));
            for threads in THREADS {
                let pool = pool(threads);
                let id = BenchmarkId::new(format!("threads {threads}, h {h}"), format!("{e:e}"));
                group.bench_function(id, |bencher| {
                    bencher.iter(|| {
                        pool.install(|| {
                            placed
                                .photosurfaces(0, sighting.wanted)
                                .expect("a step")
                                .count()
                        })
                    });
                });
            }
        }
    }
    group.finish();
}

criterion_group! {
    name = stages;
    config = settings();
    targets = without_subdivision, plates
}
criterion_main!(stages);
