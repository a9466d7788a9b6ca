//! Meshes refined through the public way, brought back to rest, merged and measured.

use std::collections::HashMap;
use std::sync::Arc;

use photosurface::light_cone::PhotosurfaceMap;
use photosurface::scene::{Measure, Place};
use photosurface::shape::Appearance;
use photosurface::tessellate::Precision;
use photosurface::{
    DMat3, DVec3, Mesh, Model, Object, Observer, Part, PlacedScene, Scene, Shape, Source,
    SurfaceOptions, Tolerance, Velocity, load_models,
};

use super::Random;

/// Who looks, how fast, and how well it is to be shown. Objects rest at the origin of the scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sighting {
    pub(crate) observer: DVec3,
    pub(crate) velocity: Velocity,
    pub(crate) tolerance: Tolerance,
    pub(crate) wanted: SurfaceOptions,
}

/// A photosurface with its vertices at rest.
#[derive(Clone, Debug)]
pub(crate) struct Sighted {
    pub(crate) certificate: photosurface::tessellate::Certificate,
    pub(crate) seen: Mesh,
    /// Brought back by the inverse map: as exact as what is seen allows.
    pub(crate) rest: Vec<DVec3>,
}

/// The least distance of a drawn place from a surface as it is seen; `seen` tells where the place of the surface is seen that is
/// next to one at rest. From `rest` and places beside it along the two `sides`, the steps of Levenberg and Marquardt lead
/// along the surface, whatever the sides are: those of slivers may be parallel, and stand across it.
pub(crate) fn nearest_distance(
    seen: impl Fn(DVec3) -> DVec3,
    rest: DVec3,
    sides: [DVec3; 2],
    drawn: DVec3,
) -> f64 {
    const STARTS: [[f64; 2]; 5] = [
        [0.0, 0.0],
        [0.2, 0.1],
        [-0.2, -0.1],
        [0.1, -0.2],
        [-0.1, 0.2],
    ];
    let at = |place: DVec3| seen(place) - drawn;
    let step = 1e-5 * sides[0].length().max(sides[1].length());
    let mut least = f64::INFINITY;
    for [s, t] in STARTS {
        let mut here = rest + sides[0] * s + sides[1] * t;
        let (mut off, mut damping) = (at(here), 1e-3);
        for _ in 0..60 {
            let difference = |axis: DVec3| {
                let [ahead, behind] = [step, -step].map(|h| at(here + axis * h));
                (ahead - behind) / (2.0 * step)
            };
            let jacobian = DMat3::from_cols(
                difference(DVec3::X),
                difference(DVec3::Y),
                difference(DVec3::Z),
            );
            let square = jacobian.transpose() * jacobian;
            let trace = square.x_axis.x + square.y_axis.y + square.z_axis.z;
            let damped = square + DMat3::from_diagonal(DVec3::splat(damping * trace));
            let next = here - damped.inverse() * (jacobian.transpose() * off);
            let there = at(next);
            if there.length() < off.length() {
                let gain = 1.0 - there.length() / off.length();
                (here, off, damping) = (next, there, damping * 0.2);
                if gain < 1e-9 {
                    break;
                }
            } else {
                damping *= 10.0;
                if !(damping < 1e12) {
                    break;
                }
            }
        }
        least = least.min(off.length());
    }
    least
}

impl Sighting {
    /// With the digits of `f64`, which hide no error.
    pub(crate) fn new(observer: DVec3, velocity: Velocity, tolerance: Tolerance) -> Self {
        let precision = Precision::Double;
        let wanted = SurfaceOptions {
            precision,
            ..SurfaceOptions::default()
        };
        Self {
            observer,
            velocity,
            tolerance,
            wanted,
        }
    }

    /// In the measure of points, which says most about what is made.
    pub(crate) fn placed(&self, source: Source) -> PlacedScene {
        self.placed_in(Measure::Points, source)
    }

    pub(crate) fn placed_in(&self, measure: Measure, source: Source) -> PlacedScene {
        let observer = Observer {
            position: Place::new(self.observer).expect("a finite place"),
            velocity: self.velocity,
            ..Observer::default()
        };
        let scene = Scene::new(observer, vec![Object::new("object", source)])
            .expect("one object with a name")
            .with_tolerance(self.tolerance)
            .with_measure_for_all(measure);
        let (models, _) = load_models(&scene, ".".as_ref()).expect("nothing to be read");
        PlacedScene::new(scene, models).expect("one model an object")
    }

    pub(crate) fn of_source(&self, source: Source) -> Vec<Sighted> {
        self.sighted(&self.placed(source))
    }

    /// The photosurfaces of a placed scene of this sighting.
    pub(crate) fn sighted(&self, placed: &PlacedScene) -> Vec<Sighted> {
        let map = PhotosurfaceMap::new(&self.velocity);
        let surfaces = placed.photosurfaces(0, self.wanted).expect("a step");
        let sighted = surfaces.map(|surface| Sighted {
            certificate: surface.facts.certificate,
            rest: (surface.mesh.positions().iter())
                .map(|&seen| map.rest_offset(seen) + self.observer)
                .collect(),
            seen: surface.mesh,
        });
        sighted.collect()
    }

    pub(crate) fn of(&self, meshes: &[Mesh]) -> Vec<Sighted> {
        self.of_source(Source::Model(Arc::new(model(meshes))))
    }

    pub(crate) fn of_one(&self, mesh: &Mesh) -> Sighted {
        let mut all = self.of(std::slice::from_ref(mesh));
        all.pop().expect("one part, one photosurface")
    }

    /// Where a point at rest is seen.
    pub(crate) fn seen(&self, rest: DVec3) -> DVec3 {
        PhotosurfaceMap::new(&self.velocity).seen_position(rest - self.observer)
    }

    /// What going there and back may move a point that is seen at `seen`, and what it is then seen moved by.
    ///
    /// A few units in the last place each way, stretched by `exp(eta)` each way.
    pub(crate) fn return_error(&self, sighted: &Sighted) -> f64 {
        let largest = |points: &[DVec3]| points.iter().fold(0.0f64, |l, p| l.max(p.length()));
        let stretch = self.velocity.rapidity().exp();
        let place = largest(&sighted.rest) + self.observer.length();
        let seen = largest(sighted.seen.positions());
        16.0 * f64::EPSILON * stretch * (stretch * place + seen)
    }

    /// Checks the certificate of one photosurface against the definition, at `samples` places of each triangle.
    ///
    /// Returns the largest gap found.
    #[track_caller]
    pub(crate) fn assert_contained(
        &self,
        sighted: &Sighted,
        samples: usize,
        random: &mut Random,
    ) -> f64 {
        let Sighted {
            certificate,
            seen,
            rest,
        } = sighted;
        let room = certificate.rounding + self.return_error(sighted);
        let mut largest: f64 = 0.0;
        for corners in seen.triangles() {
            let rest = corners.map(|corner| rest[corner as usize]);
            let flat = corners.map(|corner| seen.positions()[corner as usize]);
            for _ in 0..samples {
                let weights = random_weights(random);
                let truth = self.seen(mix(rest, weights));
                let error = truth.distance(mix(flat, weights));
                assert!(
                    error <= certificate.gap + room,
                    "{self:?}: {error:e} > {certificate:?} at {weights:?} of {rest:?}"
                );
                largest = largest.max(error);
            }
        }
        largest
    }

    /// Checks the certificate of an exact surface at `samples` places of each triangle; `seen` tells where the place of one of
    /// so many `pieces` of the true surface is seen that is next to one at rest.
    ///
    /// Returns the largest distance found.
    #[track_caller]
    pub(crate) fn assert_near_curve(
        &self,
        sighted: &Sighted,
        samples: usize,
        pieces: usize,
        seen: impl Fn(usize, DVec3) -> DVec3,
        random: &mut Random,
    ) -> f64 {
        let Sighted {
            certificate, rest, ..
        } = sighted;
        let room = certificate.total * (1.0 + 1e-9) + self.return_error(sighted);
        let mut largest: f64 = 0.0;
        for corners in sighted.seen.triangles() {
            let at_rest = corners.map(|corner| rest[corner as usize]);
            let flat = corners.map(|corner| sighted.seen.positions()[corner as usize]);
            for _ in 0..samples {
                let weights = random_weights(random);
                let (rest, flat) = (mix(at_rest, weights), mix(flat, weights));
                let to_each = (0..pieces).map(|piece| seen(piece, rest).distance(flat));
                let mut distance = to_each.fold(f64::INFINITY, f64::min);
                if distance > room {
                    let [a, b, c] = at_rest;
                    let to_each = (0..pieces).map(|piece| {
                        let seen = |place| seen(piece, place);
                        nearest_distance(seen, rest, [b - a, c - a], flat)
                    });
                    distance = to_each.fold(distance, f64::min);
                }
                assert!(
                    distance <= room,
                    "{self:?}: {distance:e} > {certificate:?} at {weights:?} of {at_rest:?}"
                );
                largest = largest.max(distance);
            }
        }
        largest
    }
}

impl Sighted {
    pub(crate) fn triangle_count(&self) -> usize {
        self.seen.triangles().len()
    }
}

pub(crate) fn model(meshes: &[Mesh]) -> Model {
    let part = |(index, mesh): (usize, &Mesh)| {
        Part::new(format!("part{index}"), mesh.clone(), None).expect("normals can be had")
    };
    Model {
        parts: meshes.iter().enumerate().map(part).collect(),
        ..Model::default()
    }
}

pub(crate) fn mix([a, b, c]: [DVec3; 3], weights: DVec3) -> DVec3 {
    a * weights.x + b * weights.y + c * weights.z
}

/// Even on the triangle; on an edge once in eight times.
pub(crate) fn random_weights(random: &mut Random) -> DVec3 {
    let (mut u, mut v) = (random.between(0.0, 1.0), random.between(0.0, 1.0));
    if random.between(0.0, 8.0) < 1.0 {
        v = 0.0;
    }
    if u + v > 1.0 {
        (u, v) = (1.0 - u, 1.0 - v);
    }
    DVec3::new(1.0 - u - v, u, v)
}

pub(crate) fn mesh(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Mesh {
    let positions: Vec<DVec3> = positions.iter().map(|&p| p.into()).collect();
    // Without normals every triangle would get vertices of its own.
    let normals = vec![DVec3::Z; positions.len()];
    Mesh::new(positions, triangles.to_vec())
        .and_then(|mesh| mesh.with_normals(normals))
        .expect("indices in range, finite numbers")
}

/// The mesh of a shape in this resolution, not to be made finer.
pub(crate) fn frozen(shape: Shape, resolution: u32) -> Mesh {
    let shape = shape.with_resolution(resolution).expect("a resolution");
    let model = shape.model(&Appearance::default()).expect("not too fine");
    model.parts[0].mesh().clone()
}

/// A plate of side 2 across the z axis at `z = -h`, two triangles.
pub(crate) fn plate(h: f64) -> Mesh {
    let corners = [
        [-1.0, -1.0, -h],
        [1.0, -1.0, -h],
        [1.0, 1.0, -h],
        [-1.0, 1.0, -h],
    ];
    mesh(&corners, &[[0, 1, 2], [0, 2, 3]])
}

/// Meshes with vertices at the same place made one.
pub(crate) struct Welded {
    places: Vec<DVec3>,
    /// By their two ends: how many triangles go from the first to the second, and back.
    edges: HashMap<[usize; 2], [u32; 2]>,
    size: f64,
    /// Whether triangles without an inside were left out.
    collapsed: bool,
}

impl Welded {
    /// `place` and `key` of each vertex of several meshes; equal keys are one vertex.
    pub(crate) fn new<'a>(
        parts: impl IntoIterator<Item = (&'a [DVec3], &'a [DVec3], &'a [[u32; 3]])>,
    ) -> Self {
        let mut welded = Self {
            places: vec![],
            edges: HashMap::new(),
            size: 0.0,
            collapsed: false,
        };
        let mut known = HashMap::new();
        for (places, keys, triangles) in parts {
            let ids: Vec<usize> = (places.iter().zip(keys))
                .map(|(&place, key)| {
                    // Adding zero makes one zero of the two.
                    let bits = key.to_array().map(|x| (x + 0.0).to_bits());
                    *known.entry(bits).or_insert_with(|| {
                        welded.places.push(place);
                        welded.places.len() - 1
                    })
                })
                .collect();
            for corners in triangles {
                let [a, b, c] = corners.map(|corner| ids[corner as usize]);
                if a == b || b == c || c == a {
                    // It has no inside: what is on both sides of it meets.
                    welded.collapsed = true;
                    continue;
                }
                for [from, to] in [[a, b], [b, c], [c, a]] {
                    let edge = [from.min(to), from.max(to)];
                    let back = usize::from(from > to);
                    welded.edges.entry(edge).or_default()[back] += 1;
                }
            }
        }
        let size = welded.places.iter().map(|place| place.abs().max_element());
        welded.size = size.fold(0.0, f64::max);
        welded
    }

    pub(crate) fn of_meshes(meshes: &[Mesh]) -> Self {
        let positions = |mesh: &'_ Mesh| mesh.positions().to_vec();
        let places: Vec<_> = meshes.iter().map(positions).collect();
        let parts = places.iter().zip(meshes);
        Self::new(parts.map(|(places, mesh)| (&places[..], &places[..], mesh.triangles())))
    }

    /// By what is seen: the inverse map could throw together, or tear apart.
    pub(crate) fn of_sighted(all: &[Sighted]) -> Self {
        let parts = all.iter();
        Self::new(parts.map(|s| (&s.rest[..], s.seen.positions(), s.seen.triangles())))
    }

    /// Whether every edge is between exactly two triangles that go along it in opposite directions.
    pub(crate) fn is_closed(&self) -> bool {
        self.edges.values().all(|&counts| counts == [1, 1])
    }

    /// Whether every edge has at most one triangle on either side.
    pub(crate) fn is_manifold(&self) -> bool {
        self.edges.values().flatten().all(|&count| count <= 1)
    }

    /// The length of all edges that more triangles go along in one direction than in the other, as often as
    /// they do.
    ///
    /// Refining keeps it; every vertex on an edge that one neighbour has and the other has not adds to it the
    /// length of that edge twice.
    pub(crate) fn boundary(&self) -> f64 {
        let open = |(&[a, b], &[there, back]): (&[usize; 2], &[u32; 2])| {
            self.places[a].distance(self.places[b]) * f64::from(there.abs_diff(back))
        };
        self.edges.iter().map(open).sum()
    }

    /// `away` is the size of numbers that places were computed with, beside their own.
    #[track_caller]
    pub(crate) fn assert_refines(&self, before: &Self, away: f64, case: &str) {
        let (old, new) = (before.boundary(), self.boundary());
        let limit = 1e-9 * (old + before.size + away);
        assert!(
            (new - old).abs() <= limit,
            "{case}: a boundary of length {old} became {new}"
        );
        // The pieces of a triangle without an inside may fold.
        if before.is_manifold() && !before.collapsed {
            assert!(self.is_manifold(), "{case}: an edge of many triangles");
        }
        if before.is_closed() && !before.collapsed {
            assert!(self.is_closed(), "{case}: no longer closed");
        }
    }
}

/// The distance of a point from a triangle.
pub(crate) fn distance_to_triangle(point: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let sides = [(a, b), (b, c), (c, a)];
    let inside = |&(from, to): &(DVec3, DVec3)| (to - from).cross(point - from).dot(normal) >= 0.0;
    let to_side = |(from, to): (DVec3, DVec3)| {
        let along = to - from;
        let part = (point - from).dot(along) / along.length_squared();
        let part = if part.is_nan() {
            0.0
        } else {
            part.clamp(0.0, 1.0)
        };
        point.distance(from + along * part)
    };
    let beside = sides.map(to_side).into_iter().fold(f64::INFINITY, f64::min);
    if normal != DVec3::ZERO && sides.iter().all(inside) {
        // The normal of a needle may be noise.
        return beside.min((point - a).dot(normal).abs() / normal.length());
    }
    beside
}

/// The distance of a point from the nearest triangle of a mesh.
pub(crate) fn distance_to_mesh(point: DVec3, mesh: &Mesh) -> f64 {
    let corner = |index: u32| mesh.positions()[index as usize];
    let triangles = mesh.triangles().iter();
    let mut nearest = f64::INFINITY;
    for corners in triangles.map(|corners| corners.map(corner)) {
        let reach = (corners[1] - corners[0])
            .length()
            .max((corners[2] - corners[0]).length());
        if point.distance(corners[0]) - reach < nearest {
            nearest = nearest.min(distance_to_triangle(point, corners));
        }
    }
    nearest
}
