//! The photosurface map of many points against a copy of the same bytes, on one core: how far it is from what memory
//! allows.
//!
//! `cargo bench --bench bandwidth` prints nanoseconds a point for both, in turn, medians, and the ratio.

#![allow(clippy::print_stdout, reason = "a table is what it is for")]

#[allow(dead_code, reason = "the tests use the rest")]
#[path = "../it/common/mod.rs"]
mod common;

use std::hint::black_box;
use std::time::Instant;

use common::Random;
use photosurface::light_cone::View;
use photosurface::spacetime::{Event, WorldLine};
use photosurface::{DVec3, Velocity};

const REPEATS: usize = 15;

fn main() {
    let velocity = Velocity::from_beta(0.9, DVec3::new(1.0, 2.0, -3.0)).expect("slower than light");
    let observer = WorldLine {
        origin: Event::new(0.0, DVec3::new(0.1, -0.2, 0.3)),
        velocity,
    };
    let object = WorldLine {
        origin: Event::default(),
        velocity: Velocity::ZERO,
    };
    let view = View::new(&observer.moment(0.0), &object);

    println!("    points   copy ns   map ns   copy / map   one by one ns");
    for count in [1_000, 10_000, 100_000, 1_000_000, 10_000_000] {
        let mut random = Random::new(count as u64);
        let points: Vec<DVec3> = (0..count)
            .map(|_| random.direction() * random.between(0.0, 1.0).cbrt())
            .collect();
        let mut seen = vec![DVec3::ZERO; count];
        // Small ones often enough for the clock.
        let runs = (1_000_000 / count).max(1);
        let nanoseconds =
            |start: Instant| start.elapsed().as_secs_f64() * 1e9 / (runs * count) as f64;
        let mut times: [Vec<f64>; 3] = Default::default();
        for _ in 0..REPEATS {
            let start = Instant::now();
            for _ in 0..runs {
                seen.copy_from_slice(black_box(&points));
                black_box(&seen);
            }
            times[0].push(nanoseconds(start));
            let start = Instant::now();
            for _ in 0..runs {
                view.seen_positions(black_box(&points), &mut seen);
                black_box(&seen);
            }
            times[1].push(nanoseconds(start));
            let start = Instant::now();
            for _ in 0..runs {
                for (seen, &point) in seen.iter_mut().zip(black_box(&points)) {
                    *seen = view.seen_position(point);
                }
                black_box(&seen);
            }
            times[2].push(nanoseconds(start));
        }
        let [copy, map, single] = times.map(|mut times| {
            times.sort_by(f64::total_cmp);
            times[REPEATS / 2]
        });
        println!(
            "{count:10} {copy:9.2} {map:8.2} {:12.2} {single:15.2}",
            copy / map
        );
    }
}
