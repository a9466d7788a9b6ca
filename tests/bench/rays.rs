//! Throughput of pictures by rays of light, in rays a second: meshes of all sizes, even and clustered, and built-in scenes
//! with more and more rays a pixel, by threads.
//!
//! `cargo bench --bench rays`; with `-- --quick` in a fraction of the time.

#[allow(dead_code, reason = "the tests use the rest")]
#[path = "../it/common/mod.rs"]
mod common;
mod settings;

use std::sync::Arc;

use common::Random;
use common::refining::model;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use photosurface::render::{Camera, PictureOptions, PictureSize, Projection, Scenery, Viewpoint};
use photosurface::scene::{BuiltInScene, Place};
use photosurface::{
    DVec3, Mesh, Object, Observer, PlacedScene, Scene, Source, Velocity, load_models,
};
use rayon::{ThreadPool, ThreadPoolBuilder};
use settings::settings;

const THREADS: [usize; 2] = [1, 2];

const CLUSTERS: usize = 8;

/// How triangles lie in the ball that the observer looks at.
#[derive(Clone, Copy, Debug)]
enum Cloud {
    Even,
    Clustered,
}

impl Cloud {
    /// Triangles of one size for one count, so that all together have the area of the ball's outline.
    fn mesh(self, count: usize) -> Mesh {
        let mut random = Random::new(count as u64);
        let side = (4.0 / count as f64).sqrt();
        let middles: Vec<DVec3> = (0..CLUSTERS).map(|_| random.direction() * 0.7).collect();
        let corners = (0..count).flat_map(|index| {
            let middle = match self {
                Self::Even => random.direction() * random.between(0.0, 1.0).cbrt(),
                Self::Clustered => {
                    middles[index % CLUSTERS] + random.direction() * random.between(0.0, 0.1)
                }
            };
            [(); 3].map(|()| middle + random.direction() * side)
        });
        let corners: Vec<DVec3> = corners.collect();
        let triangle = |index: usize| [0, 1, 2].map(|corner| (3 * index + corner) as u32);
        Mesh::new(corners, (0..count).map(triangle).collect()).expect("triangles of their own")
    }
}

fn camera(look: DVec3, vertical_fov_deg: f64) -> Camera {
    let size = PictureSize::new(160, 90).expect("a fair size");
    Camera::new(size, Projection::Perspective { vertical_fov_deg }, look).expect("a fair camera")
}

fn pools() -> [(usize, ThreadPool); 2] {
    THREADS.map(|threads| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        (threads, pool.expect("threads can be had"))
    })
}

/// A placed scene, ready to be seen at its first step.
struct Sight {
    placed: PlacedScene,
    scenery: Scenery,
    camera: Camera,
}

impl Sight {
    fn new(scene: Scene, camera: Camera) -> Self {
        let (models, _) = load_models(&scene, ".".as_ref()).expect("nothing to be read");
        let placed = PlacedScene::new(scene, models).expect("one model an object");
        let mut scenery = Scenery::new();
        for (object, parts) in placed.objects() {
            for (_, part) in parts {
                scenery.add_at_rest(object, part);
            }
        }
        Self {
            placed,
            scenery,
            camera,
        }
    }

    fn take(&self, samples: u32) {
        let scene = self.placed.scene();
        let moment = scene.moment(0).expect("a step");
        let viewpoint = Viewpoint::Observer(&moment);
        let options = PictureOptions {
            samples,
            ..PictureOptions::default()
        };
        let picture = self.scenery.picture(&self.camera, viewpoint, options);
        std::hint::black_box(picture);
    }

    fn rays(&self, samples: u32) -> u64 {
        let size = self.camera.size();
        u64::from(size.width()) * u64::from(size.height()) * u64::from(samples).pow(2)
    }
}

/// One ray a pixel against meshes, their search trees made before.
fn meshes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("rays, triangles of a mesh");
    for count in [100, 10_000, 1_000_000] {
        for cloud in [Cloud::Even, Cloud::Clustered] {
            let observer = Observer {
                velocity: Velocity::from_beta(0.6, DVec3::NEG_Z).expect("slower than light"),
                position: Place::new(DVec3::new(0.0, 0.0, 3.0)).expect("finite"),
                ..Observer::default()
            };
            let source = Source::Model(Arc::new(model(&[cloud.mesh(count)])));
            let scene = Scene::new(observer, vec![Object::new("cloud", source)]);
            // The ball, of 19 degrees at rest, is half as wide for this observer.
            let camera = camera(DVec3::NEG_Z, 20.0);
            let sight = Sight::new(scene.expect("one object with a name"), camera);
            group.throughput(Throughput::Elements(sight.rays(1)));
            for (threads, pool) in pools() {
                let id = BenchmarkId::new(format!("threads {threads}, {cloud:?}"), count);
                group.bench_function(id, |bencher| {
                    bencher.iter(|| pool.install(|| sight.take(1)));
                });
            }
        }
    }
    group.finish();
}

/// Built-in scenes at their first step, with 1 to 64 rays a pixel.
fn scenes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("rays, samples a pixel along each side");
    for (name, look, fov) in [
        ("sphere", DVec3::new(-0.95, 0.1, 0.0), 20.0),
        ("lattice", DVec3::NEG_Z, 60.0),
        ("street", DVec3::NEG_Z, 60.0),
    ] {
        let built_in = BuiltInScene::named(name).expect("built in");
        let scene = Scene::from_json(built_in.json).expect("a scene");
        let sight = Sight::new(scene, camera(look, fov));
        for samples in [1, 2, 4, 8] {
            group.throughput(Throughput::Elements(sight.rays(samples)));
            for (threads, pool) in pools() {
                let id = BenchmarkId::new(format!("threads {threads}, {name}"), samples);
                group.bench_function(id, |bencher| {
                    bencher.iter(|| pool.install(|| sight.take(samples)));
                });
            }
        }
    }
    group.finish();
}

criterion_group! {
    name = rays;
    config = settings();
    targets = meshes, scenes
}
criterion_main!(rays);
