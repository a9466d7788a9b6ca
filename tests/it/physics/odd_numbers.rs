//! Scenes built from Rust of every kind of odd number: each is refused with an error, or its photosurfaces are made, and
//! are as far from what is seen as their certificates say.

use std::cell::RefCell;
use std::error::Error;
use std::io;
use std::sync::Arc;

use photosurface::light_cone::View;
use photosurface::render::{Camera, PictureOptions, PictureSize, Projection, Scenery, Viewpoint};
use photosurface::scene::{Attribute, MarkerRadius, Measure, Place, Rotation, Scale, Time, Unit};
use photosurface::shape::Appearance;
use photosurface::spacetime::VelocityError;
use photosurface::tessellate::Precision;
use photosurface::write::{Export, Format, write_glb, write_ply};
use photosurface::{
    DQuat, DVec3, Mesh, Object, Observer, Photosurface, PlacedScene, Scene, Shape, Source,
    SurfaceOptions, Tolerance, Velocity, load_models,
};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;

use crate::common::refining::{mix, model, nearest_distance, random_weights};
use crate::common::{Random, cases};

/// Triangles of all photosurfaces of a scene: what a tolerance of 5e-324 would take, no computer has.
const MAX_TRIANGLES: u64 = 100;

/// Places of each photosurface that are held against its certificate.
const SAMPLES: usize = 30;

/// Numbers that no part of a scene should take for granted.
const ODD: [f64; 30] = [
    0.0,
    -0.0,
    5e-324,
    -5e-324,
    1e-310,
    f64::MIN_POSITIVE,
    1e-308,
    1e-160,
    -1e-160,
    1e-60,
    1e-30,
    -1e-9,
    -1.0,
    -5.0,
    0.999_999_999,
    std::f64::consts::SQRT_2,
    91.0,
    350.0,
    1e9,
    -1e20,
    1e75,
    1e160,
    -1e160,
    1e300,
    1e308,
    -1e308,
    f64::MAX,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
];

/// How a speed is given.
#[derive(Clone, Copy, Debug)]
enum Form {
    Beta,
    OneMinusBeta,
    Gamma,
    Rapidity,
    /// As a vector: the number is not used.
    Vector,
}

const FORMS: [Form; 5] = [
    Form::Beta,
    Form::OneMinusBeta,
    Form::Gamma,
    Form::Rapidity,
    Form::Vector,
];

/// A velocity before anyone has checked it.
#[derive(Clone, Copy, Debug)]
struct Speed {
    form: Form,
    number: f64,
    direction: DVec3,
}

impl Speed {
    /// An ordinary one, from a number between 0 and 1.
    fn ordinary(form: Form, part: f64, direction: DVec3) -> Self {
        let (number, direction) = match form {
            Form::Beta => (0.99 * part, direction),
            Form::OneMinusBeta => (1.0 - 0.99 * part, direction),
            Form::Gamma => (1.0 + 9.0 * part, direction),
            Form::Rapidity => (3.0 * part, direction),
            Form::Vector => (0.0, direction.clamp_length_max(1.0) * part),
        };
        Self {
            form,
            number,
            direction,
        }
    }

    fn velocity(self) -> Result<Velocity, VelocityError> {
        match self.form {
            Form::Beta => Velocity::from_beta(self.number, self.direction),
            Form::OneMinusBeta => Velocity::from_one_minus_beta(self.number, self.direction),
            Form::Gamma => Velocity::from_gamma(self.number, self.direction),
            Form::Rapidity => Velocity::from_rapidity(self.number, self.direction),
            Form::Vector => Velocity::from_vector(self.direction),
        }
    }
}

/// What the geometry of the one object is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Sphere,
    Cuboid,
    Cylinder,
    Cone,
    Torus,
    Rod,
    Grid,
    Lattice,
    /// Two triangles of a mesh: the lengths are not used.
    Mesh,
}

const KINDS: [Kind; 9] = [
    Kind::Sphere,
    Kind::Mesh,
    Kind::Cuboid,
    Kind::Cylinder,
    Kind::Cone,
    Kind::Torus,
    Kind::Rod,
    Kind::Grid,
    Kind::Lattice,
];

const UNITS: [Unit; 3] = [Unit::Absolute, Unit::Relative, Unit::Degrees];

/// Everything that a scene is made of, before anyone has checked it.
#[derive(Clone, Debug)]
struct Numbers {
    kind: Kind,
    lengths: [f64; 3],
    corners: [DVec3; 4],
    scale: DVec3,
    rotation: [f64; 4],
    place: DVec3,
    tolerance: f64,
    unit: Unit,
    /// Of the object and of the observer.
    speeds: [Speed; 2],
    observer: DVec3,
    time: f64,
    step: f64,
    marker: f64,
}

impl Numbers {
    /// Ordinary numbers, the same for the same seed.
    fn ordinary(seed: usize) -> Self {
        let mut random = Random::new(seed as u64);
        let mut vector =
            |low: f64, high: f64| DVec3::from(std::array::from_fn(|_| random.between(low, high)));
        let lengths = vector(0.3, 1.0);
        let corners = std::array::from_fn(|_| vector(-2.0, 2.0));
        let turn = vector(-1.0, 1.0);
        let parts = vector(0.1, 1.0);
        let speed = |step: usize, part: f64, direction: DVec3| {
            Speed::ordinary(FORMS[(seed + step) % FORMS.len()], part, direction)
        };
        Self {
            kind: KINDS[seed % KINDS.len()],
            // A torus is to be thinner than wide.
            lengths: (lengths + DVec3::new(1.0, 0.0, 0.0)).to_array(),
            corners,
            scale: vector(0.5, 2.0),
            rotation: DQuat::from_scaled_axis(turn).to_array(),
            place: vector(-5.0, 5.0),
            tolerance: [0.05, 0.01, 1.0][seed % 3],
            unit: UNITS[seed % 3],
            speeds: [
                speed(0, parts.x, vector(-1.0, 1.0)),
                speed(1, parts.y, vector(-1.0, 1.0)),
            ],
            observer: vector(-5.0, 5.0),
            time: parts.z,
            step: parts.x - parts.y,
            marker: parts.z,
        }
    }

    /// Numbers that mean another thing in another scene: sizes of shapes, speeds, tolerances.
    fn particular(&mut self) -> Vec<&mut f64> {
        let mut numbers: Vec<&mut f64> = self.lengths.iter_mut().collect();
        for speed in &mut self.speeds {
            numbers.push(&mut speed.number);
        }
        numbers.push(&mut self.tolerance);
        numbers
    }

    /// All the others.
    fn common(&mut self) -> Vec<&mut f64> {
        let mut numbers: Vec<&mut f64> = self.rotation.iter_mut().collect();
        let [object, observer] = &mut self.speeds;
        let vectors = [
            &mut self.scale,
            &mut self.place,
            &mut object.direction,
            &mut observer.direction,
            &mut self.observer,
        ];
        for vector in vectors.into_iter().chain(&mut self.corners) {
            numbers.extend([&mut vector.x, &mut vector.y, &mut vector.z]);
        }
        numbers.extend([&mut self.time, &mut self.step, &mut self.marker]);
        numbers
    }

    fn source(&self) -> Result<Source, Box<dyn Error>> {
        let [a, b, c] = self.lengths;
        let shape = match self.kind {
            Kind::Sphere => Shape::sphere(a)?,
            Kind::Cuboid => Shape::cuboid([a, b, c])?,
            Kind::Cylinder => Shape::cylinder(a, b)?,
            Kind::Cone => Shape::cone(a, b)?,
            Kind::Torus => Shape::torus(a, b)?,
            Kind::Rod => Shape::rod(a, b)?,
            Kind::Grid => Shape::grid(a, 2)?,
            Kind::Lattice => Shape::lattice([1, 1, 1], a, 0.2 * b)?,
            Kind::Mesh => {
                let triangles = vec![[0, 1, 2], [0, 2, 3]];
                let mesh = Mesh::new(self.corners.to_vec(), triangles)?;
                return Ok(Source::Model(Arc::new(model(&[mesh]))));
            }
        };
        Ok(Source::Shape(shape, Appearance::default()))
    }

    fn placed(&self) -> Result<PlacedScene, Box<dyn Error>> {
        let [object, observer] = self.speeds;
        let object = Object {
            position: Place::new(self.place)?,
            rotation: Rotation::new(DQuat::from_array(self.rotation))?,
            scale: Scale::new(self.scale)?,
            velocity: object.velocity()?,
            measure: Some(Measure::Points),
            ..Object::new("thing", self.source()?)
        };
        let observer = Observer {
            time: Time::new(self.time)?,
            position: Place::new(self.observer)?,
            velocity: observer.velocity()?,
            marker: Some(MarkerRadius::new(self.marker)?),
            ..Observer::default()
        };
        let scene = Scene::new(observer, vec![object])?
            .with_steps(vec![self.step])?
            .with_tolerance(Tolerance::new(self.tolerance, self.unit)?);
        let (models, _) = load_models(&scene, ".".as_ref())?;
        Ok(PlacedScene::new(scene, models)?)
    }

    /// The point of the true surface that is nearest to a place of a facet, both in the coordinates of the model; the
    /// place itself where the facet is flat, or where it is not known so well.
    fn on_surface(&self, facet: [DVec3; 3], place: DVec3) -> DVec3 {
        let [a, b, _] = self.lengths;
        let around = |radius: f64| {
            let outward = DVec3::new(place.x, 0.0, place.z).normalize_or_zero();
            outward * radius
        };
        let turned = |radius: f64, height: f64| {
            let is_lid = |corner: DVec3| corner.y.abs() >= 0.5 * height * (1.0 - 1e-9);
            let same_side = facet.iter().all(|corner| corner.y > 0.0)
                || facet.iter().all(|corner| corner.y < 0.0);
            match same_side && facet.into_iter().all(is_lid) {
                true => place,
                false => around(radius).with_y(place.y),
            }
        };
        match self.kind {
            Kind::Sphere => place.normalize_or_zero() * a,
            Kind::Cylinder => turned(a, b),
            Kind::Rod => turned(b, a),
            Kind::Torus => {
                let middle = around(a);
                middle + (place - middle).normalize_or_zero() * b
            }
            _ => place,
        }
    }

    /// Whether places of a curved surface can be told in the coordinates of the model: there, what rounding moves
    /// them by grows with the ratio of the scales.
    fn is_curved(&self) -> bool {
        let scale = self.scale;
        let ordinary = |number: f64| (1e-100..1e100).contains(&number);
        let round = [Kind::Sphere, Kind::Cylinder, Kind::Rod, Kind::Torus];
        round.contains(&self.kind)
            && scale.max_element() / scale.min_element() <= 1e3
            && scale.to_array().into_iter().all(ordinary)
            && self.lengths[..2].iter().copied().all(ordinary)
    }
}

/// How many cases went which way.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    /// Scenes that are refused, and scenes of which photosurfaces are made.
    refused: usize,
    made: usize,
    /// Photosurfaces with a vertex beyond `f64`.
    beyond: usize,
    /// Photosurfaces within their tolerance, by certificate.
    complete: usize,
    /// Places held against a certificate, and those of them where it says less than a tenth of what is seen.
    places: usize,
    telling: usize,
    /// Places of curved surfaces.
    curved: usize,
}

impl Tally {
    /// Panics where hardly anything was looked at.
    fn check(&self) {
        assert!(self.complete * 3 > self.made, "{self:?}");
        assert!(self.places > 20 * self.made, "{self:?}");
        assert!(self.telling * 2 > self.places, "{self:?}");
        assert!(self.curved * 5 > self.places, "{self:?}");
        assert!(self.beyond > 0, "{self:?}");
    }
}

/// A length whose square may be beyond `f64`.
fn length(vector: DVec3) -> f64 {
    let largest = vector.abs().max_element();
    match largest > 0.0 && largest.is_finite() {
        // Twice, for the inverse of a number below 1e-308 overflows.
        true => {
            let root = largest.sqrt();
            (vector / root / root).length() * largest
        }
        false => largest,
    }
}

/// Holds a photosurface against what is seen, at random places of its triangles.
fn assert_as_certified(
    numbers: &Numbers,
    placed: &PlacedScene,
    surface: &Photosurface,
    tally: &mut Tally,
) {
    let certificate = &surface.facts.certificate;
    let case = || format!("{numbers:?}: {certificate:?}");
    for number in [
        certificate.tolerance,
        certificate.gap,
        certificate.curvature,
        certificate.rounding,
        certificate.total,
        certificate.minimum_triangles,
        certificate.ratio,
    ] {
        assert!(number >= 0.0 && number.is_finite(), "{}", case());
    }
    let fits = certificate.total <= certificate.tolerance;
    assert!(!certificate.complete || fits, "{}", case());
    tally.complete += usize::from(certificate.complete);

    let rest = surface.vertex_data.rest_positions();
    let rest = rest.expect("rest positions were asked for");
    let (seen, triangles) = (surface.mesh.positions(), surface.mesh.triangles());
    assert_eq!(rest.len(), seen.len(), "{}", case());
    assert!(!triangles.is_empty(), "{}", case());
    if !rest.iter().chain(seen).all(|place| place.is_finite()) {
        assert!(!certificate.complete, "{}", case());
        tally.beyond += 1;
        return;
    }
    let object = &placed.scene().objects()[0];
    let view = placed.view(object, surface.facts.step).expect("its step");
    let (scale, rotation) = (object.scale.get(), object.rotation.get());
    let to_model = |place: DVec3| (rotation.inverse() * place) / scale;
    let random = &mut Random::new(triangles.len() as u64);
    let curved = numbers.is_curved();
    for _ in 0..SAMPLES {
        let corners = triangles[random.below(triangles.len())].map(|corner| corner as usize);
        let weights = random_weights(random);
        let at_rest = corners.map(|corner| rest[corner]);
        let facet = mix(at_rest, weights);
        let on_surface = |place: DVec3| match curved {
            true => {
                let on_surface = numbers.on_surface(at_rest.map(to_model), to_model(place));
                rotation * (scale * on_surface)
            }
            false => place,
        };
        let flat = corners.map(|corner| seen[corner]);
        let drawn = mix(flat, weights);
        let place = on_surface(facet);
        let truth = view.seen_position(place);
        if !truth.is_finite() {
            assert!(!certificate.complete, "{}", case());
            continue;
        }
        let size = |places: [DVec3; 3]| places.map(length).into_iter().fold(0.0, f64::max);
        let room = room(
            &view,
            place,
            size(at_rest),
            size(flat).max(length(truth)),
            curved,
        );
        let (mut error, allowed) = match certificate.unit {
            Unit::Degrees => (
                angle_deg(truth, drawn),
                certificate.total + angle_of(room / length(truth)),
            ),
            _ => (
                length(0.5 * truth - 0.5 * drawn),
                0.5 * certificate.total + 0.5 * room,
            ),
        };
        if curved && error > allowed {
            // Another place of the surface may be nearer.
            let [a, b, c] = at_rest;
            let seen = |place: DVec3| view.seen_position(on_surface(place));
            let distance = nearest_distance(seen, facet, [b - a, c - a], drawn);
            error = match certificate.unit {
                Unit::Degrees => angle_of(distance / length(drawn)),
                _ => 0.5 * distance,
            };
        }
        assert!(
            error <= allowed,
            "{error:e} > {allowed:e} at {place} ({truth} instead of {drawn}): {}",
            case()
        );
        tally.places += 1;
        tally.curved += usize::from(curved);
        tally.telling += usize::from(match certificate.unit {
            Unit::Degrees => allowed < 5.0,
            _ => allowed < 0.1 * length(truth),
        });
    }
}

/// How far rounding in this test may move a sample: its place at rest, where that is seen, and where it is drawn.
///
/// # Derivation
///
/// In epsilons: a mixture of three corners of weights whose sum is 1 but for rounding is off by 3 of the largest corner,
/// its offset from the observer by half of either; on a curved surface the way to the coordinates of the model and
/// back, and the nearest point there, take 16 each way, times the ratio of scales of at most 1000. The map stretches that
/// as it does the ball around the place, and adds 8 of what is seen; the mixture of what is drawn, 3, and the difference of
/// the two, 1. Where epsilons vanish, each of ten results is off by the smallest number.
fn room(view: &View, place: DVec3, size_rest: f64, size_seen: f64, curved: bool) -> f64 {
    let of_size = if curved { 32e3 } else { 4.0 };
    let observer = length(view.observer_rest());
    let moved = f64::EPSILON * (of_size * size_rest + observer) + 10.0 * 5e-324;
    moved * view.stretch_bound(place, moved) + 16.0 * f64::EPSILON * size_seen + 10.0 * 5e-324
}

/// The angle between two directions, in degrees; 180 where there is none.
fn angle_deg(a: DVec3, b: DVec3) -> f64 {
    let (a, b) = (direction(a), direction(b));
    if a == DVec3::ZERO || b == DVec3::ZERO {
        return if a == b { 0.0 } else { 180.0 };
    }
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

/// The angle of this sine, in degrees, and what the computation of angles adds.
fn angle_of(sine: f64) -> f64 {
    match sine < 1.0 {
        true => sine.asin().to_degrees() + 180.0 * 8.0 * f64::EPSILON,
        false => 180.0,
    }
}

fn direction(vector: DVec3) -> DVec3 {
    let largest = vector.abs().max_element();
    match largest > 0.0 {
        true => {
            let root = largest.sqrt();
            (vector / root / root).normalize()
        }
        false => DVec3::ZERO,
    }
}

/// Takes the numbers all the way: to photosurfaces, and to files and pictures where `all` is asked for.
fn examine(numbers: &Numbers, all: bool, tally: &mut Tally) {
    let Ok(placed) = numbers.placed() else {
        tally.refused += 1;
        return;
    };
    tally.made += 1;
    let wanted = SurfaceOptions {
        precision: Precision::Double,
        attributes: [
            Attribute::Doppler,
            Attribute::EmissionTime,
            Attribute::RestPosition,
        ]
        .into_iter()
        .collect(),
        ..SurfaceOptions::default()
    };
    let (placed, loosening) = placed.within_budget(wanted, MAX_TRIANGLES);
    assert!(loosening.iter().all(|&times| times >= 1.0), "{numbers:?}");
    let surfaces: Vec<_> = placed.photosurfaces(0, wanted).expect("a step").collect();
    for surface in &surfaces {
        assert_as_certified(numbers, &placed, surface, tally);
    }
    assert!(placed.photosurfaces(1, wanted).is_err());
    assert!(placed.view(&placed.scene().objects()[0], 1).is_none());
    if all {
        write_and_draw(&placed, &surfaces);
    }
}

/// Files and pictures are made or refused: no number ends the program.
fn write_and_draw(placed: &PlacedScene, surfaces: &[Photosurface]) {
    let export = Export {
        scene: &placed.facts(),
        marker: placed.marker(),
        photosurfaces: surfaces,
        playback: None,
    };
    for format in [Format::Glb, Format::Gltf, Format::Ply] {
        let (_, _) = (
            format.check_range(placed),
            format.min_size(placed, usize::MAX),
        );
    }
    let finite = |surface: &Photosurface| {
        let mut positions = surface.mesh.positions().iter();
        positions.all(|place| place.is_finite())
    };
    let written = write_ply(&export, io::sink());
    assert!(written.is_err() || surfaces.iter().all(finite));
    let written = write_glb(&export, io::sink());
    assert!(written.is_err() || surfaces.iter().all(finite));

    let object = &placed.scene().objects()[0];
    let (mut rays, mut meshes) = (Scenery::new(), Scenery::new());
    for (object, parts) in placed.objects() {
        for (_, part) in parts {
            rays.add_at_rest(object, part);
        }
    }
    let moment = placed.scene().moment(0).expect("a step");
    for surface in surfaces {
        meshes.add_photosurface(object, &moment, &surface.mesh, surface.material.as_ref());
    }
    let size = PictureSize::new(6, 4).expect("pixels");
    let camera = Camera::new(size, Projection::FullSky, DVec3::NEG_Z).expect("a camera");
    for scenery in [&rays, &meshes] {
        let viewpoints = [
            Viewpoint::Observer(&moment),
            Viewpoint::Outside(surfaces[0].around.1),
        ];
        for viewpoint in viewpoints {
            scenery.picture(&camera, viewpoint, PictureOptions::default());
        }
    }
}

/// Each number of a scene odd in each way, the others ordinary.
#[test]
fn one_odd_number_is_refused_or_certified_and_right() {
    let mut tally = Tally::default();
    for seed in 0..KINDS.len() {
        let plain = Numbers::ordinary(seed);
        let (particular, common) = {
            let mut numbers = plain.clone();
            (numbers.particular().len(), numbers.common().len())
        };
        for (index, odd) in ODD.into_iter().enumerate() {
            for number in 0..particular {
                let mut numbers = plain.clone();
                *numbers.particular()[number] = odd;
                examine(&numbers, false, &mut tally);
            }
            // These mean the same in all scenes: each is odd in each way in one of them.
            for number in (0..common).filter(|number| (number + index + seed) % KINDS.len() == 0) {
                let mut numbers = plain.clone();
                *numbers.common()[number] = odd;
                examine(&numbers, false, &mut tally);
            }
        }
    }
    println!("{tally:?}");
    assert!(tally.refused > 500 && tally.made > 500, "{tally:?}");
    tally.check();
}

/// A number of some range or, once in so many times, an odd one or one of any size.
fn number(low: f64, high: f64) -> impl Strategy<Value = f64> {
    prop_oneof![
        60 => low..high,
        1 => prop::sample::select(ODD.to_vec()),
        1 => (-170.0..170.0, prop::bool::ANY).prop_map(|(exponent, negative): (f64, bool)| {
            let size = 10f64.powf(exponent);
            if negative { -size } else { size }
        }),
    ]
}

fn vector(low: f64, high: f64) -> impl Strategy<Value = DVec3> {
    let number = || number(low, high);
    [number(), number(), number()].prop_map(DVec3::from)
}

fn speed() -> impl Strategy<Value = Speed> {
    let ordinary = (0.0..1.0, vector(-1.0, 1.0));
    (
        prop::sample::select(FORMS.to_vec()),
        ordinary,
        number(0.0, 1.0),
    )
        .prop_map(|(form, (part, direction), odd)| {
            let speed = Speed::ordinary(form, part, direction);
            match (0.0..1.0).contains(&odd) {
                true => speed,
                false => Speed {
                    number: odd,
                    ..speed
                },
            }
        })
}

fn numbers() -> impl Strategy<Value = Numbers> {
    let seen = (vector(-5.0, 5.0), number(-2.0, 2.0), number(-2.0, 2.0));
    let thing = (
        prop::sample::select(KINDS.to_vec()),
        [number(0.3, 1.0), number(0.3, 1.0), number(0.3, 1.0)],
        prop::array::uniform4(vector(-2.0, 2.0)),
        (vector(0.5, 2.0), vector(-1.0, 1.0), number(0.9995, 1.0005)),
        vector(-5.0, 5.0),
    );
    let tolerance = (number(0.01, 0.3), prop::sample::select(UNITS.to_vec()));
    (thing, tolerance, [speed(), speed()], seen, number(0.1, 1.0)).prop_map(
        |(thing, (tolerance, unit), speeds, (observer, time, step), marker)| {
            let (kind, [a, b, c], corners, (scale, turn, length), place) = thing;
            let turned = match turn.is_finite() {
                true => DQuat::from_scaled_axis(turn.clamp(DVec3::NEG_ONE, DVec3::ONE)),
                false => DQuat::from_xyzw(turn.x, turn.y, turn.z, 1.0),
            };
            Numbers {
                kind,
                lengths: [if kind == Kind::Torus { a + 1.0 } else { a }, b, c],
                corners,
                scale,
                rotation: (turned * length).to_array(),
                place,
                tolerance,
                unit,
                speeds,
                observer,
                time,
                step,
                marker,
            }
        },
    )
}

/// Several odd numbers at once.
#[test]
fn odd_numbers_are_refused_or_certified_and_right() {
    let tally = RefCell::new(Tally::default());
    let tried = TestRunner::new(cases(250)).run(&numbers(), |numbers| {
        examine(&numbers, true, &mut tally.borrow_mut());
        Ok(())
    });
    tried.unwrap_or_else(|error| panic!("{error}"));
    let tally = tally.into_inner();
    println!("{tally:?}");
    assert!(tally.refused > 50 && tally.made > 100, "{tally:?}");
    tally.check();
}
