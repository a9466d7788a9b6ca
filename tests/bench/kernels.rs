//! Throughput of the two kernels, in points and triangles a second: the photosurface map and the gap.
//!
//! `cargo bench --bench kernels`; with `-- --quick` in a fraction of the time. Points are even in a ball around the
//! observer, or in clusters next to it, some ahead and some behind, where other branches are taken.

#[allow(dead_code, reason = "the tests use the rest")]
#[path = "../it/common/mod.rs"]
mod common;
mod settings;

use std::hint::black_box;

use common::Random;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use photosurface::light_cone::PhotosurfaceMap;
use photosurface::tessellate::{edge_gap, triangle_gap};
use photosurface::{DVec3, Velocity};
use settings::settings;

const CLUSTERS: usize = 8;

/// How the points lie around the observer.
#[derive(Clone, Copy, Debug)]
enum Cloud {
    Even,
    Clustered,
}

impl Cloud {
    fn points(self, count: usize) -> Vec<DVec3> {
        let mut random = Random::new(count as u64);
        let middles: Vec<DVec3> = (0..CLUSTERS)
            .map(|_| random.direction() * random.between(0.01, 1.0))
            .collect();
        let point = |index: usize| match self {
            Self::Even => random.direction() * random.between(0.0, 1.0).cbrt(),
            Self::Clustered => {
                middles[index % CLUSTERS] + random.direction() * random.between(0.0, 0.01)
            }
        };
        (0..count).map(point).collect()
    }
}

fn map(criterion: &mut Criterion) {
    let velocity = Velocity::from_beta(0.9, DVec3::new(1.0, 2.0, -3.0)).expect("slower than light");
    let map = PhotosurfaceMap::new(&velocity);
    let mut group = criterion.benchmark_group("seen_position");
    for count in [1_000, 10_000, 100_000, 1_000_000, 10_000_000] {
        group.throughput(Throughput::Elements(count as u64));
        for cloud in [Cloud::Even, Cloud::Clustered] {
            let points = cloud.points(count);
            let mut seen = vec![DVec3::ZERO; count];
            let id = BenchmarkId::new(format!("{cloud:?}"), count);
            group.bench_function(id, |bencher| {
                bencher.iter(|| {
                    for (seen, &point) in seen.iter_mut().zip(&points) {
                        *seen = map.seen_position(point);
                    }
                    black_box(&seen);
                });
            });
        }
    }
    group.finish();
}

fn gap(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("gap");
    for count in [1_000, 10_000, 100_000, 1_000_000] {
        group.throughput(Throughput::Elements(count as u64));
        for cloud in [Cloud::Even, Cloud::Clustered] {
            let points = cloud.points(count + 2);
            group.bench_function(
                BenchmarkId::new(format!("edge, {cloud:?}"), count),
                |bencher| {
                    bencher.iter(|| {
                        let gaps = points[1..]
                            .windows(2)
                            .map(|ends| edge_gap(ends[0], ends[1]));
                        black_box(gaps.fold(0.0, f64::max))
                    });
                },
            );
            let id = BenchmarkId::new(format!("triangle, {cloud:?}"), count);
            group.bench_function(id, |bencher| {
                bencher.iter(|| {
                    let corners = points.windows(3);
                    let gaps =
                        corners.map(|corners| triangle_gap(corners[0], corners[1], corners[2]));
                    black_box(gaps.fold(0.0, f64::max))
                });
            });
        }
    }
    group.finish();
}

criterion_group! {
    name = kernels;
    config = settings();
    targets = map, gap
}
criterion_main!(kernels);
