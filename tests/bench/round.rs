//! How many triangles round shapes take under both measures, from rest to 0.999 c, against the fewest that theory allows, how
//! long they take, and how many were predicted.
//!
//! `cargo bench --bench round` prints the table; a tolerance as an argument, such as `cargo bench --bench round -- 1e-3`, is
//! used instead of 1e-4 of the diagonal.

#![allow(clippy::print_stdout, reason = "a table is what it is for")]

#[allow(dead_code, reason = "the tests use the rest")]
#[path = "../it/common/mod.rs"]
mod common;

use std::time::Instant;

use common::refining::Sighting;
use photosurface::scene::Measure;
use photosurface::shape::Appearance;
use photosurface::{DVec3, Shape, Source, Tolerance, Velocity};

const SPEEDS: [f64; 5] = [0.0, 0.5, 0.9, 0.99, 0.999];

/// Where the observer is: on its line of motion through the shape, having passed it, and abeam of it.
const PLACES: [(&str, DVec3); 2] = [
    ("passed", DVec3::new(2.0, 0.0, 0.0)),
    ("abeam", DVec3::new(0.0, -3.0, 0.0)),
];

fn main() {
    let mut tolerance = std::env::args().filter_map(|argument| argument.parse().ok());
    let tolerance =
        Tolerance::relative(tolerance.next_back().unwrap_or(1e-4)).expect("a tolerance");
    let shapes = [
        ("sphere", Shape::sphere(1.0)),
        ("torus", Shape::torus(1.0, 0.25)),
        ("cylinder", Shape::cylinder(1.0, 2.0)),
        ("cone", Shape::cone(1.0, 2.0)),
        ("rod", Shape::rod(10.0, 0.1)),
    ];
    println!(
        "shape      place  measure   speed  triangles  predicted      least  ratio     time  prediction"
    );
    let shapes = shapes.map(|(name, shape)| (name, shape.expect("lengths above zero")));
    let rows = shapes
        .iter()
        .flat_map(|shape| PLACES.map(|place| (shape, place)));
    for ((name, shape), (place, observer)) in rows {
        for measure in Measure::ALL {
            for beta in SPEEDS {
                let velocity = Velocity::from_beta(beta, DVec3::X).expect("slower than light");
                let sighting = Sighting::new(observer, velocity, tolerance);
                let source = Source::Shape(shape.clone(), Appearance::default());
                let placed = sighting.placed_in(measure, source);
                let start = Instant::now();
                let predicted = placed.predictions(sighting.wanted)[0].triangles;
                let predicting = start.elapsed().as_secs_f64();
                let start = Instant::now();
                let sighted = sighting.sighted(&placed).remove(0);
                let making = start.elapsed().as_secs_f64();
                let certificate = &sighted.certificate;
                let note = match (certificate.complete, certificate.curvature > 0.0) {
                    (false, _) => "  not within the tolerance",
                    (true, true) => "  facets of one resolution",
                    (true, false) => "",
                };
                println!(
                    "{name:<10} {place:<6} {:<8} {beta:6} {:10} {predicted:10.0} {:10.0} {:6.2} {:6.0} ms {:8.1} ms{note}",
                    measure.name(),
                    certificate.triangles_out,
                    certificate.minimum_triangles,
                    certificate.ratio,
                    1e3 * making,
                    1e3 * predicting,
                );
            }
        }
    }
}
