//! The surface measure: certificates against dense sampling both ways, and how few triangles suffice.

use std::sync::Arc;

use crate::common::Random;
use crate::common::refining::{
    Sighted, Sighting, Welded, distance_to_mesh, frozen, mesh, mix, model, nearest_distance, plate,
    random_weights,
};
use photosurface::scene::Measure;
use photosurface::{DVec3, Mesh, Shape, Source, Tolerance, Velocity};

fn seen_in(sighting: &Sighting, measure: Measure, meshes: &[Mesh]) -> Vec<Sighted> {
    let source = Source::Model(Arc::new(model(meshes)));
    sighting.sighted(&sighting.placed_in(measure, source))
}

/// A plate of side 2, in three rows of triangles that share planes, tilted about the x axis and at a distance.
fn sheet(tilt: f64, h: f64) -> Mesh {
    let corners = [
        [-1.0, -1.0],
        [1.0, -1.0],
        [1.0, 0.2],
        [-1.0, 0.2],
        [1.0, 1.0],
        [-1.0, 1.0],
    ];
    let tilted = corners.map(|[x, y]: [f64; 2]| [x, y * tilt.cos(), -h + y * tilt.sin()]);
    mesh(&tilted, &[[0, 1, 2], [0, 2, 3], [3, 2, 4], [3, 4, 5]])
}

/// The distance of a place from the photosurface of flat triangles at rest, or somewhat more: from the nearest of many
/// places of each triangle on, and of `near`; and along each side.
fn distance_to_photosurface(
    sighting: &Sighting,
    place: DVec3,
    rest: &[[DVec3; 3]],
    near: DVec3,
) -> f64 {
    const GRID: i32 = 24;
    const STARTS: usize = 4;
    let mut nearest = f64::INFINITY;
    for &corners in rest {
        let [a, b, c] = corners;
        let (u, v) = (b - a, c - a);
        let inside = |[s, t]: [f64; 2]| {
            let (s, t) = (s.max(0.0), t.max(0.0));
            let over = (s + t).max(1.0);
            a + u * (s / over) + v * (t / over)
        };
        let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
        let determinant = uu * vv - uv * uv;
        // The place of the triangle that has the coordinates of a place, or next to it.
        let onto = |at: DVec3| {
            let (of_u, of_v) = (u.dot(at - a), v.dot(at - a));
            inside([
                (vv * of_u - uv * of_v) / determinant,
                (uu * of_v - uv * of_u) / determinant,
            ])
        };
        let of = |k: i32| f64::from(k) / f64::from(GRID);
        let grid = (0..=GRID).flat_map(|i| (0..=GRID - i).map(move |j| [i, j]));
        let distance = |at: &DVec3| sighting.seen(*at).distance(place);
        let starts = grid.map(|[i, j]| inside([of(i), of(j)]));
        let mut starts: Vec<(f64, DVec3)> = starts.map(|start| (distance(&start), start)).collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        starts.truncate(STARTS);
        starts.push((0.0, onto(near)));
        for (_, start) in starts {
            let seen = |at: DVec3| sighting.seen(onto(at));
            nearest = nearest.min(nearest_distance(seen, start, [u, v], place));
        }
        for (from, to) in [(a, b), (b, c), (c, a)] {
            nearest = nearest.min(along(&|part| distance(&from.lerp(to, part))));
        }
    }
    nearest
}

/// The least value of a function between 0 and 1: from the least of some values on, by thirds.
fn along(value: &dyn Fn(f64) -> f64) -> f64 {
    const PARTS: i32 = 32;
    let at = |k: i32| f64::from(k) / f64::from(PARTS);
    let least = (0..=PARTS).min_by(|&a, &b| value(at(a)).total_cmp(&value(at(b))));
    let least = least.expect("some parts");
    let (mut low, mut high) = (at((least - 1).max(0)), at((least + 1).min(PARTS)));
    for _ in 0..80 {
        let [a, b] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
        match value(a) < value(b) {
            true => high = b,
            false => low = a,
        }
    }
    value(0.5 * (low + high)).min(value(at(least)))
}

fn corners_of(mesh: &Mesh) -> Vec<[DVec3; 3]> {
    let corners = mesh.triangles().iter();
    corners
        .map(|corners| corners.map(|corner| mesh.positions()[corner as usize]))
        .collect()
}

/// Holds a surface bound against random places, both ways; the largest error over the bound.
#[track_caller]
fn assert_within(
    sighting: &Sighting,
    before: &Mesh,
    sighted: &Sighted,
    random: &mut Random,
) -> f64 {
    const PLACES: usize = 150;
    let certificate = &sighted.certificate;
    let room = certificate.rounding + sighting.return_error(sighted);
    let bound = certificate.surface_gap + room;
    let rest = corners_of(before);
    let (positions, triangles) = (sighted.seen.positions(), sighted.seen.triangles());
    let mut largest = 0.0f64;
    for _ in 0..PLACES {
        let corners = triangles[random.below(triangles.len())].map(|corner| corner as usize);
        let weights = random_weights(random);
        let place = mix(corners.map(|corner| positions[corner]), weights);
        let near = mix(corners.map(|corner| sighted.rest[corner]), weights);
        let direct = sighting.seen(near).distance(place);
        let error = match direct <= bound {
            true => 0.0,
            false => distance_to_photosurface(sighting, place, &rest, near),
        };
        assert!(
            error <= bound * (1.0 + 1e-6),
            "mesh to surface: {error:e} > {bound:e}, {direct:e} as points at {place} from {near}: {sighting:?} {certificate:?}"
        );
        largest = largest.max(error);

        let corners = rest[random.below(rest.len())];
        let place = sighting.seen(mix(corners, random_weights(random)));
        let error = distance_to_mesh(place, &sighted.seen);
        assert!(
            error <= bound,
            "surface to mesh: {error:e} > {bound:e}: {sighting:?} {certificate:?}"
        );
        largest = largest.max(error);
    }
    largest / bound
}

/// The plate of the design's section 6.2: it stays flat, and only its rim bends.
#[test]
fn a_plate_that_holds_the_motion_takes_few_triangles() {
    let velocity = Velocity::from_beta(0.6, DVec3::X).unwrap();
    let sighting = Sighting::new(DVec3::ZERO, velocity, Tolerance::absolute(2e-4).unwrap());
    let before = plate(1.0);
    let points = seen_in(&sighting, Measure::Points, std::slice::from_ref(&before));
    let surface = seen_in(&sighting, Measure::Surface, std::slice::from_ref(&before));
    let (points, surface) = (&points[0], &surface[0]);
    let certificate = &surface.certificate;
    println!(
        "points {} surface {} {certificate:?}",
        points.triangle_count(),
        surface.triangle_count()
    );
    assert!(
        certificate.complete && certificate.total <= 2e-4,
        "{certificate:?}"
    );
    assert!(
        surface.triangle_count() <= 300,
        "{}",
        surface.triangle_count()
    );
    assert!(points.triangle_count() > 2000);
    assert_eq!(certificate.minimum_triangles, 0.0);
    assert!(
        certificate.ratio >= 1.0 && certificate.ratio <= 2.0,
        "{certificate:?}"
    );
    assert_within(&sighting, &before, surface, &mut Random::new(1));
    // The rim is nearly as far off as it may be.
    let mut worst = 0.0f64;
    for [a, b, c] in corners_of(&before) {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            for k in 0..500 {
                let place = sighting.seen(from.lerp(to, f64::from(k) / 500.0));
                worst = worst.max(distance_to_mesh(place, &surface.seen));
            }
        }
    }
    assert!(
        worst > 0.3 * certificate.total && worst <= certificate.total,
        "{worst}"
    );
}

#[test]
fn surfaces_are_within_their_bounds_both_ways() {
    let mut random = Random::new(2);
    let mut fewer = 0;
    let shapes = [
        ("plate", plate(0.4)),
        ("sheet", sheet(0.3, 0.5)),
        ("steep", sheet(1.2, 1.5)),
        ("box", frozen(Shape::cuboid([1.0, 2.0, 3.0]).unwrap(), 1)),
        (
            "lattice",
            frozen(Shape::lattice([1, 1, 1], 1.0, 0.2).unwrap(), 1),
        ),
    ];
    let observers = [
        DVec3::new(0.1, 0.2, 0.05),
        DVec3::new(0.5, 0.1, 0.0),
        DVec3::new(-3.0, 0.3, 2.0),
        DVec3::new(0.0, 0.0, -0.4),
    ];
    let directions = [
        DVec3::X,
        DVec3::NEG_Z,
        DVec3::new(1.0, 0.2, 0.0),
        DVec3::new(0.3, -0.2, -1.0),
    ];
    for (name, before) in &shapes {
        for observer in observers {
            for (number, direction) in directions.into_iter().enumerate() {
                // Slow, fast, very fast.
                let gamma = [1.25, 3.0, 10.0, 1e4][(number + name.len()) % 4];
                let velocity = Velocity::from_gamma(gamma, direction).unwrap();
                let tolerance = Tolerance::relative(2e-3).unwrap();
                let sighting = Sighting::new(observer, velocity, tolerance);
                let placed = |measure| {
                    let source = Source::Model(Arc::new(model(std::slice::from_ref(before))));
                    let placed = sighting.placed_in(measure, source);
                    placed.within_budget(sighting.wanted, 60_000).0
                };
                let surface = sighting.sighted(&placed(Measure::Surface)).pop().unwrap();
                let points = sighting.sighted(&placed(Measure::Points)).pop().unwrap();
                let (of_surface, of_points) = (&surface.certificate, &points.certificate);
                assert!(of_surface.surface_gap <= of_surface.gap);
                let (count, most) = (surface.triangle_count(), points.triangle_count());
                println!(
                    "{name:8} {observer} {direction} {gamma}: {count} of {most}, {:.2} {} {}",
                    of_surface.total / of_surface.tolerance,
                    of_surface.complete,
                    of_points.complete
                );
                if of_points.complete {
                    assert!(of_surface.complete, "{name} {sighting:?}: {of_surface:?}");
                    assert!(
                        count <= most + most / 20 + 4,
                        "{name} {sighting:?}: {count} of {most}"
                    );
                    fewer += usize::from(2 * count < most);
                }
                Welded::of_sighted(std::slice::from_ref(&surface)).assert_refines(
                    &Welded::of_meshes(std::slice::from_ref(before)),
                    observer.length(),
                    name,
                );
                if count <= 20_000 {
                    assert_within(&sighting, before, &surface, &mut random);
                }
            }
        }
    }
    assert!(fewer > 10, "{fewer}");
}

/// Parts of one object in the same plane, and beside each other at a crease, agree on every edge.
#[test]
fn parts_agree_on_their_edges() {
    let whole = sheet(0.3, 0.5);
    let corner = |i: u32| whole.positions()[i as usize].to_array();
    let mut faces: Vec<Mesh> = (whole.triangles().iter())
        .map(|corners| mesh(&corners.map(corner), &[[0, 1, 2]]))
        .collect();
    faces.push(mesh(&[corner(5), corner(4), [0.0, 0.5, 0.3]], &[[0, 1, 2]]));
    for (direction, tolerance) in [(DVec3::X, 1e-3), (DVec3::new(0.5, 0.1, -1.0), 1e-4)] {
        let velocity = Velocity::from_beta(0.9, direction).unwrap();
        let tolerance = Tolerance::relative(tolerance).unwrap();
        let sighting = Sighting::new(DVec3::new(0.1, 0.4, 0.2), velocity, tolerance);
        let after = seen_in(&sighting, Measure::Surface, &faces);
        Welded::of_sighted(&after).assert_refines(&Welded::of_meshes(&faces), 1.0, "faces");
        assert!(after.iter().all(|part| part.certificate.complete));
    }
}
