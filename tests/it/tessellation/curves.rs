//! Certified subdivision of curved shapes, against closed forms of their surfaces.

use crate::common::Random;
use crate::common::refining::{
    Sighted, Sighting, distance_to_mesh, mix, nearest_distance, random_weights,
};
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
    for corners in sighted.seen.triangles() {
        for _ in 0..per_triangle {
            let weights = random_weights(random);
            let flat = mix(
                corners.map(|c| sighted.seen.positions()[c as usize]),
                weights,
            );
            let at_rest = corners.map(|c| sighted.rest[c as usize]);
            let seen = |place: DVec3| sighting.seen(to_curve(shape, place));
            let rest = mix(at_rest, weights);
            let mut distance = seen(rest).distance(flat);
            if distance > room {
                let [a, b, c] = at_rest;
                distance = nearest_distance(seen, rest, [b - a, c - a], flat);
            }
            assert!(distance <= room, "{shape:?}: {distance:e} {certificate:?}");
        }
    }
}

/// The certificate of a curved shape is against the curve itself: from it to the mesh and back.
#[test]
fn curved_shapes_are_certified_against_the_curve() {
    let mut random = Random::new(8);
    for shape in shapes() {
        for (observer, tolerance) in [
            (
                DVec3::new(0.3, 0.2, 4.0),
                Tolerance::relative(2e-3).unwrap(),
            ),
            (
                DVec3::new(0.1, 0.2, 0.3),
                Tolerance::absolute(1e-2).unwrap(),
            ),
        ] {
            let mut sighting = Sighting::new(observer, moving(0.9), tolerance);
            sighting.wanted.precision = Precision::Single;
            let source = Source::Shape(shape.clone(), Appearance::default());
            let sighted = &sighting.sighted(&sighting.placed_in(Measure::Surface, source))[0];
            let certificate = &sighted.certificate;
            assert!(certificate.complete, "{shape:?}: {certificate:?}");
            assert!(certificate.surface_gap > 0.0 && certificate.curvature == 0.0);
            assert!(certificate.gap >= certificate.surface_gap);
            assert_certified(&sighting, &shape, sighted, &mut random);
        }
    }
}

/// The same where the observer is fast, near, inside, or touches the shape, for surfaces and for points.
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

/// The corners of the generating outline in the half plane of distance from and height along the axis.
fn outline(shape: &Shape) -> &'static [[f64; 2]] {
    match shape {
        Shape::Cylinder(_) => &[[0.0, 1.0], [0.5, 1.0], [0.5, -1.0], [0.0, -1.0]],
        Shape::Rod(_) => &[[0.0, 1.0], [0.5, 1.0], [0.5, -1.0], [0.0, -1.0]],
        Shape::Cone(_) => &[[0.0, 0.75], [0.7, -0.75], [0.0, -0.75]],
        _ => unreachable!("round"),
    }
}

fn turned([radius, height]: [f64; 2], direction: DVec3) -> DVec3 {
    let aside = DVec3::new(direction.x, 0.0, direction.z).normalize();
    aside * radius + DVec3::Y * height
}

fn on_curve(shape: &Shape, random: &mut Random) -> DVec3 {
    let direction = random.direction();
    match shape {
        Shape::Sphere(_) => direction,
        Shape::Torus(_) => {
            let angle = random.between(0.0, std::f64::consts::TAU);
            turned([1.0 + 0.3 * angle.cos(), 0.3 * angle.sin()], direction)
        }
        _ => {
            let corners = outline(shape);
            let side = random.between(0.0, corners.len() as f64 - 1.0);
            let (a, b) = (corners[side as usize], corners[side as usize + 1]);
            turned(
                [0, 1].map(|i| a[i] + (b[i] - a[i]) * side.fract()),
                direction,
            )
        }
    }
}

/// The place of the curved surface nearest to one near to it.
fn to_curve(shape: &Shape, place: DVec3) -> DVec3 {
    let radius = place.x.hypot(place.z);
    match shape {
        Shape::Sphere(_) => place.normalize(),
        Shape::Torus(_) => {
            let middle = turned([1.0, 0.0], place);
            middle + (place - middle).normalize() * 0.3
        }
        _ => {
            let to_side = |ends: &[[f64; 2]]| {
                let [a, b] = [
                    DVec3::new(ends[0][0], ends[0][1], 0.0),
                    DVec3::new(ends[1][0], ends[1][1], 0.0),
                ];
                let here = DVec3::new(radius, place.y, 0.0);
                let part = (here - a).dot(b - a) / (b - a).length_squared();
                let on = a + (b - a) * part.clamp(0.0, 1.0);
                (here.distance(on), [on.x, on.y])
            };
            let sides = outline(shape).windows(2).map(to_side);
            let nearest = sides.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap().1;
            if radius == 0.0 {
                place
            } else {
                turned(nearest, place)
            }
        }
    }
}
