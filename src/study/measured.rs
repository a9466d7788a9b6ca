//! The error, measured: how far what is drawn is from what is seen, at random places.

use glam::DVec3;
use rayon::prelude::*;

use super::random::Random;
use super::true_surface::TrueSurface;
use crate::light_cone::ModelView;
use crate::pipeline::{Photosurface, PlacedScene, SurfaceOptions};
use crate::scene::{Attribute, Attributes, Measure, Unit};

/// Places that a thread takes at a time; each lot has random numbers of its own, so that the result does not depend
/// on how many threads there are.
const LOT: usize = 4096;

/// However many photosurfaces share the places, each gets so many.
const MIN_PLACES: usize = 100;

/// The largest error found on the photosurfaces of a placed scene.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Measured {
    /// A length in the observer's frame.
    pub(super) length: f64,
    /// Over the tolerance of the same photosurface.
    pub(super) of_tolerance: f64,
    /// Over the proven bound of the same photosurface.
    pub(super) of_bound: f64,
}

/// What is seen, and what is drawn instead, of one place.
#[derive(Clone, Copy)]
pub(super) struct Pair {
    pub(super) seen: DVec3,
    pub(super) drawn: DVec3,
}

impl Pair {
    pub(super) fn distance(self) -> f64 {
        self.seen.distance(self.drawn)
    }

    /// The angle between the two for the observer, in degrees.
    fn angle_deg(self) -> f64 {
        let sine = self.seen.cross(self.drawn).length();
        sine.atan2(self.seen.dot(self.drawn)).to_degrees()
    }
}

/// Holds about `samples` random places of all photosurfaces of a placed scene, `triangles` in all, against the truth.
///
/// A place is a point of a facet at rest, on a round shape the point of the true surface nearest to it. Its light
/// comes from where the map says; drawn it is on the flat triangle between the mapped corners, with the same weights of the
/// corners. Under the measure of surfaces the error is the distance of the latter from the photosurface of the facet's
/// plane, and on a round shape, under either measure, from that of the true surface. Neither the closed form of the gap nor anything else of the proof is used.
pub(super) fn measure(
    placed: &PlacedScene,
    wanted: SurfaceOptions,
    triangles: usize,
    samples: usize,
) -> Measured {
    // With places at rest, which no refined mesh holds otherwise.
    let wanted = SurfaceOptions {
        attributes: Attributes::default().with(Attribute::RestPosition),
        ..wanted
    };
    let mut worst = Measured::default();
    for step in 0..placed.scene().steps().len() {
        let owners = placed
            .objects()
            .flat_map(|(object, parts)| parts.iter().map(move |_| object));
        let photosurfaces = placed.photosurfaces(step, wanted);
        let photosurfaces = photosurfaces.expect("a step of the scene");
        for (photosurface, object) in photosurfaces.zip(owners) {
            let shown = placed
                .model_view(object, step)
                .expect("a step of the scene");
            let surface = TrueSurface::of(object);
            let here = photosurface.facts.triangles;
            let places = (samples as f64 * here as f64 / triangles as f64).ceil() as usize;
            // Where there is no triangle there is no place.
            let places = if here == 0 { 0 } else { places.max(MIN_PLACES) };
            let found = of_one(&photosurface, &shown, surface.as_ref(), places);
            worst = Measured {
                length: worst.length.max(found.length),
                of_tolerance: worst.of_tolerance.max(found.of_tolerance),
                of_bound: worst.of_bound.max(found.of_bound),
            };
        }
    }
    worst
}

fn of_one(
    photosurface: &Photosurface,
    shown: &ModelView,
    surface: Option<&TrueSurface>,
    places: usize,
) -> Measured {
    let rest = photosurface.vertex_data.rest_positions();
    let rest = rest.expect("rest positions were asked for");
    let (seen, triangles) = (photosurface.mesh.positions(), photosurface.mesh.triangles());
    let certificate = &photosurface.facts.certificate;
    let in_degrees = certificate.unit == Unit::Degrees;
    let is_of_surface = surface.is_some() || certificate.measure == Measure::Surface && !in_degrees;
    let on_surface = |point: DVec3| surface.map_or(point, |surface| surface.nearest(point));
    let place = |index: usize, random: &mut Random| {
        // Every triangle in turn, if there are enough places for that.
        let triangle = match places >= triangles.len() {
            true => index % triangles.len(),
            false => random.below(triangles.len()),
        };
        let corners = triangles[triangle].map(|corner| corner as usize);
        let weights = random.weights();
        let point = mix(corners.map(|corner| rest[corner]), weights);
        let drawn = mix(corners.map(|corner| seen[corner]), weights);
        let seen = match is_of_surface {
            true => {
                let [a, b, c] = corners.map(|corner| rest[corner]);
                let place = |step: DVec3| shown.shown_position(on_surface(point + step));
                nearest_seen(place, [b - a, c - a], drawn, certificate.total)
            }
            false => shown.shown_position(on_surface(point)),
        };
        Pair { seen, drawn }
    };
    let error = |pair: Pair| match in_degrees {
        true => [pair.distance(), pair.angle_deg()],
        false => [pair.distance(); 2],
    };
    let [length, error] = largest(places, place, error);
    Measured {
        length,
        of_tolerance: error / certificate.tolerance,
        of_bound: error / certificate.total,
    }
}

/// Where a point of a surface is seen that is seen nearest to `drawn`: found from the first one on, and if that is not
/// `enough`, as where the surface bends far away from its facet, also from the nearest of many around the facet.
///
/// `seen` tells where the point is seen that is next to the first one after a step at rest.
fn nearest_seen(
    seen: impl Fn(DVec3) -> DVec3,
    sides: [DVec3; 2],
    drawn: DVec3,
    enough: f64,
) -> DVec3 {
    /// Around the facet up to so many times its sides, in so many steps each way; then so often around the nearest of these,
    /// each time up to this part of the way before.
    const REACH: f64 = 3.0;
    const STEPS: i32 = 12;
    const ROUNDS: i32 = 24;
    const NEARER: f64 = 0.4;

    let first = nearest_from(&seen, DVec3::ZERO, sides, drawn, enough);
    let distance = |at: DVec3| seen(at).distance(drawn);
    let (mut at, mut nearest) = (first, distance(first));
    for round in 0..ROUNDS {
        if nearest < enough {
            break;
        }
        let middle = if round == 0 { DVec3::ZERO } else { at };
        let step = REACH * NEARER.powi(round) / f64::from(STEPS);
        for (u, v) in (-STEPS..=STEPS).flat_map(|u| (-STEPS..=STEPS).map(move |v| (u, v))) {
            let next = middle + (sides[0] * f64::from(u) + sides[1] * f64::from(v)) * step;
            if distance(next) < nearest {
                (at, nearest) = (next, distance(next));
            }
        }
    }
    seen(at)
}

/// A step at rest to a point that is seen near to `drawn`: by the method of Gauss and Newton, from one step on, as long as
/// that leads nearer. If that is not `enough`, as at a rim, steps along both sides of the facet go on, each half as long as
/// the one before.
fn nearest_from(
    seen: impl Fn(DVec3) -> DVec3,
    mut at: DVec3,
    sides: [DVec3; 2],
    drawn: DVec3,
    enough: f64,
) -> DVec3 {
    /// A few steps are enough: the first leads nearer by the square of the distance.
    const STEPS: usize = 8;
    /// Of the facet's sides: the cube of it, and the rounding over it, are small.
    const DIFFERENCE: f64 = 1e-5;
    const HALVINGS: i32 = 24;

    let mut nearest = seen(at);
    for _ in 0..STEPS {
        let [u, v] = sides.map(|side| {
            let [ahead, behind] = [DIFFERENCE, -DIFFERENCE].map(|part| seen(at + side * part));
            (ahead - behind) / (2.0 * DIFFERENCE)
        });
        let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
        let off = drawn - nearest;
        let (of_u, of_v) = (u.dot(off), v.dot(off));
        let determinant = uu * vv - uv * uv;
        let step = sides[0] * ((vv * of_u - uv * of_v) / determinant)
            + sides[1] * ((uu * of_v - uv * of_u) / determinant);
        let next = seen(at + step);
        if !(next.distance(drawn) < nearest.distance(drawn)) {
            break;
        }
        (at, nearest) = (at + step, next);
    }
    for halving in 0..HALVINGS {
        if nearest.distance(drawn) < enough {
            break;
        }
        for side in [sides[0], sides[1], -sides[0], -sides[1]] {
            let step = side * 0.5f64.powi(halving);
            let next = seen(at + step);
            if next.distance(drawn) < nearest.distance(drawn) {
                (at, nearest) = (at + step, next);
            }
        }
    }
    at
}

/// The largest errors of so many places.
pub(super) fn largest<const N: usize>(
    places: usize,
    place: impl Fn(usize, &mut Random) -> Pair + Sync,
    errors: impl Fn(Pair) -> [f64; N] + Sync,
) -> [f64; N] {
    let larger = |a: [f64; N], b: [f64; N]| std::array::from_fn(|i| a[i].max(b[i]));
    let lots = (0..places.div_ceil(LOT)).into_par_iter().map(|lot| {
        let mut random = Random::new(lot as u64);
        let lot = lot * LOT..places.min((lot + 1) * LOT);
        lot.map(|index| errors(place(index, &mut random)))
            .fold([0.0; N], larger)
    });
    lots.reduce(|| [0.0; N], larger)
}

pub(super) fn mix([a, b, c]: [DVec3; 3], weights: DVec3) -> DVec3 {
    a * weights.x + b * weights.y + c * weights.z
}
