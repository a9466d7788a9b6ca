//! How many triangles a plate takes under both measures, head-on and abeam, against the fewest that theory allows, and how
//! long they take.
//!
//! `cargo bench --bench plates` prints the table; `cargo bench --bench plates -- --samples 5000000` also holds the
//! certificates against that many random places.

#![allow(clippy::print_stdout, reason = "a table is what it is for")]

#[allow(dead_code, reason = "the tests use the rest")]
#[path = "../it/common/mod.rs"]
mod common;

use std::sync::Arc;
use std::time::{Duration, Instant};

use common::Random;
use common::refining::{Sighting, model, plate};
use photosurface::scene::Measure;
use photosurface::{DVec3, Source, Tolerance, Velocity};

const REPEATS: usize = 3;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let samples = arguments
        .iter()
        .position(|argument| argument == "--samples")
        .map_or(0usize, |at| {
            let number = arguments.get(at + 1).and_then(|number| number.parse().ok());
            number.expect("--samples takes a number of places")
        });
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.expect("a thread");
    let mut random = Random::new(1);

    for (name, measure, direction) in [
        ("points", Measure::Points, DVec3::NEG_Z),
        ("surface", Measure::Surface, DVec3::NEG_Z),
        ("points, abeam", Measure::Points, DVec3::X),
        ("surface, abeam", Measure::Surface, DVec3::X),
        (
            "surface, aslant",
            Measure::Surface,
            DVec3::new(1.0, 0.0, -0.3),
        ),
    ] {
        println!("{name}");
        println!("     h   e_tol   triangles      N_min  with source   ratio   triangles/s");
        for h in [1.0, 0.1, 0.01, 0.001] {
            for e in [1e-3, 1e-4, 1e-5] {
                let velocity = Velocity::from_beta(0.6, direction).expect("slower than light");
                let tolerance = Tolerance::absolute(e * velocity.gamma_beta()).expect("a length");
                let sighting = Sighting::new(DVec3::ZERO, velocity, tolerance);
                print_row(&pool, &sighting, measure, [h, e], samples, &mut random);
            }
        }
    }
}

fn print_row(
    pool: &rayon::ThreadPool,
    sighting: &Sighting,
    measure: Measure,
    [h, e]: [f64; 2],
    samples: usize,
    random: &mut Random,
) {
    let source = Source::Model(Arc::new(model(&[plate(h)])));
    let placed = sighting.placed_in(measure, source);
    let mut times: Vec<Duration> = (0..REPEATS)
        .map(|_| {
            let start = Instant::now();
            let made = pool.install(|| {
                placed
                    .photosurfaces(0, sighting.wanted)
                    .expect("a step")
                    .count()
            });
            assert_eq!(made, 1);
            start.elapsed()
        })
        .collect();
    times.sort();
    let sighted = sighting.sighted(&placed).pop().expect("one part");
    let certificate = &sighted.certificate;
    let rate = sighted.triangle_count() as f64 / times[REPEATS / 2].as_secs_f64();
    println!(
        "{h:6} {e:7.0e} {:11} {:10.0} {:12.0} {:7.3} {rate:13.0}{}",
        sighted.triangle_count(),
        certificate.minimum_triangles,
        certificate.minimum_with_source,
        certificate.ratio,
        if certificate.complete {
            ""
        } else {
            "  incomplete"
        },
    );
    if samples > 0 && measure == Measure::Points {
        let each = samples.div_ceil(12 * sighted.triangle_count());
        let largest = sighting.assert_contained(&sighted, each, random);
        println!(
            "       {} places: largest gap {largest:.9e}, bound {:.9e}, tolerance {:.9e}",
            each * sighted.triangle_count(),
            certificate.gap,
            certificate.tolerance,
        );
    }
}
