//! Certified subdivision of curved shapes, against closed forms of their surfaces.

use crate::common::Random;
use crate::common::curve::{on_curve, pieces, to_piece};
use crate::common::refining::{Sighted, Sighting, distance_to_mesh, mix, random_weights};
use photosurface::scene::Measure;
use photosurface::shape::Appearance;
use photosurface::tessellate::Precision;
use photosurface::{DVec3, Shape, Source, Tolerance, Velocity};

fn moving(beta: f64) -> Velocity {
    Velocity::from_beta(beta, DVec3::new(0.3, -0.2, -1.0)).unwrap()
}

fn shapes() -> [Shape; 5] {
    let shapes = [
        Shape::sphere(1.0),
        Shape::cylinder(0.5, 2.0),
        Shape::cone(0.7, 1.5),
        Shape::torus(1.0, 0.3),
        Shape::rod(2.0, 0.5),
    ];
    shapes.map(Result::unwrap)
}

/// Holds random places of the curve against the mesh, and random places of the mesh against the curve.
#[track_caller]
fn assert_certified(sighting: &Sighting, shape: &Shape, sighted: &Sighted, random: &mut Random) {
    let certificate = &sighted.certificate;
    let room = certificate.total * (1.0 + 1e-9);
    for _ in 0..200 {
        let truth = sighting.seen(on_curve(shape, random));
        let distance = distance_to_mesh(truth, &sighted.seen);
        assert!(distance <= room, "{shape:?}: {distance:e} {certificate:?}");
    }
    let per_triangle = 2000usize.div_ceil(sighted.triangle_count());
    let seen = |piece, place| sighting.seen(to_piece(shape, piece, place));
    sighting.assert_near_curve(sighted, per_triangle, pieces(shape), seen, random);
}

/// The certificate of a curved shape is against the curve itself: from it to the mesh and back.
#[test]
fn curved_shapes_are_certified_against_the_curve() {
    let mut random = Random::new(8);
    for shape in shapes() {
        for (observer, tolerance) in [
            (
                DVec3::new(0.3, 0.2, 4.0),
                Tolerance::relative(5e-4).unwrap(),
            ),
            (
                DVec3::new(0.1, 0.2, 0.3),
                Tolerance::absolute(3e-3).unwrap(),
            ),
        ] {
            let mut sighting = Sighting::new(observer, moving(0.9), tolerance);
            sighting.wanted.precision = Precision::Single;
            let source = Source::Shape(shape.clone(), Appearance::default());
            let sighted = &sighting.sighted(&sighting.placed_in(Measure::Surface, source))[0];
            let certificate = &sighted.certificate;
            assert!(certificate.complete, "{shape:?}: {certificate:?}");
            let is_exact = certificate.surface_gap > 0.0 && certificate.curvature == 0.0;
            assert!(is_exact, "{shape:?}: {certificate:?}");
            assert!(certificate.gap >= certificate.surface_gap);
            assert_certified(&sighting, &shape, sighted, &mut random);
        }
    }
}

/// As points, what is drawn on a sphere or a torus is where it is seen: each place of a triangle near that with the same
/// texture coordinates.
#[test]
fn pictures_lie_where_they_are_seen() {
    use std::f64::consts::{PI, TAU};
    let turned = |u: f64, [out, up]: [f64; 2]| {
        let (sin, cos) = (TAU * u).sin_cos();
        DVec3::new(-out * sin, up, -out * cos)
    };
    let on_sphere = |u: f64, v: f64| turned(u, [(PI * v).sin(), (PI * v).cos()]);
    let on_torus = |u: f64, v: f64| {
        let (sin, cos) = (TAU * v).sin_cos();
        turned(u, [1.0 - 0.3 * cos, 0.3 * sin])
    };
    type PlaceOf<'a> = &'a dyn Fn(f64, f64) -> DVec3;
    let pictures: [(Shape, PlaceOf); 2] = [
        (Shape::sphere(1.0).unwrap(), &on_sphere),
        (Shape::torus(1.0, 0.3).unwrap(), &on_torus),
    ];
    let mut random = Random::new(10);
    let ahead = DVec3::new(0.3, -0.2, -1.0).normalize();
    for (shape, place_of) in pictures {
        for (beta, observer) in [
            (0.0, ahead * 4.0),
            (0.5, ahead * -2.0),
            (0.9, ahead * 2.0),
            (0.9, ahead * -2.0),
            (0.95, ahead * -4.0),
            (0.99, ahead * 1.5),
            (0.99, ahead * -1.5),
            (0.999, ahead * -3.0),
            (0.99, DVec3::new(0.1, 0.2, 0.3)),
        ] {
            let tolerance = Tolerance::relative(2e-3).unwrap();
            let sighting = Sighting::new(observer, moving(beta), tolerance);
            let source = Source::Shape(shape.clone(), Appearance::default());
            let sighted = &sighting.sighted(&sighting.placed_in(Measure::Points, source))[0];
            let certificate = &sighted.certificate;
            assert!(
                certificate.complete && certificate.curvature == 0.0,
                "{certificate:?}"
            );
            let textures = &sighted.seen.texture_coordinates()[0];
            // The coordinates of the file are singles.
            let room = certificate.total + 1e-6 * sighting.velocity.rapidity().exp();
            let mut largest: f64 = 0.0;
            for corners in sighted.seen.triangles() {
                let corners = corners.map(|corner| corner as usize);
                let at = corners.map(|corner| textures[corner].as_dvec2().extend(0.0));
                for _ in 0..5 {
                    let weights = random_weights(&mut random);
                    let at = mix(at, weights);
                    let drawn = mix(corners.map(|c| sighted.seen.positions()[c]), weights);
                    let distance = sighting.seen(place_of(at.x, at.y)).distance(drawn);
                    assert!(
                        distance <= room,
                        "{shape:?} {beta}: {distance:e} {certificate:?}"
                    );
                    largest = largest.max(distance);
                }
            }
            assert!(
                largest > 0.7 * certificate.total,
                "{shape:?} {beta}: {largest:e} {certificate:?}"
            );
        }
    }
}

/// Certificates against the curve where the observer is fast, near, inside, or touches the shape, for surfaces and for points.
#[test]
fn hard_sights_of_curved_shapes_keep_their_certificates() {
    let mut random = Random::new(9);
    let observers = [
        DVec3::new(0.2, 0.1, 4.0),
        DVec3::new(0.05, 0.1, 0.2),
        DVec3::new(0.0, 0.3, 1.001),
        // In a lid of the cylinder and of the rod.
        DVec3::new(0.1, 1.0, 0.2),
    ];
    let velocities = [
        moving(0.0),
        moving(0.99),
        moving(0.9999),
        Velocity::from_gamma(1e4, DVec3::new(0.3, -0.2, -1.0)).unwrap(),
    ];
    for shape in shapes() {
        for observer in observers {
            for velocity in velocities {
                for measure in Measure::ALL {
                    let tolerance = Tolerance::relative(1e-2).unwrap();
                    let sighting = Sighting::new(observer, velocity, tolerance);
                    let source = Source::Shape(shape.clone(), Appearance::default());
                    let sighted = &sighting.sighted(&sighting.placed_in(measure, source))[0];
                    assert_eq!(sighted.certificate.measure, measure);
                    assert_certified(&sighting, &shape, sighted, &mut random);
                }
            }
        }
    }
}
