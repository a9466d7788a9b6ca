//! Models: each against a solver of its own definition, its certificate against many places of the true surface.
//!
//! Objects are at rest in the scene with their origin at that of the scene, so that places in the scene are places at
//! rest. Only the observer's place and velocity and two textbook formulas are used here: where things are now, and where
//! they were when their light left, by bisection.

use photosurface::scene::{Attribute, Measure};
use photosurface::shape::Appearance;
use photosurface::spacetime::{Event, ViewModel};
use photosurface::{
    DVec3, Object, Observer, Photosurface, PlacedScene, Scene, Shape, Source, SurfaceOptions,
    Tolerance, Velocity, load_models,
};

use crate::common::Random;
use crate::common::refining::{mix, nearest_distance, random_weights};

const OBSERVER: DVec3 = DVec3::new(1.5, -2.0, 3.0);
const DIRECTION: DVec3 = DVec3::new(-0.6, 0.64, -0.48);

/// The point of a true surface that is nearest to a place at rest.
type Nearest = fn(DVec3) -> DVec3;

struct Case {
    model: ViewModel,
    beta: f64,
    /// The point of the true surface that is nearest to a place on a facet at rest.
    nearest: Nearest,
    is_round: bool,
    placed: PlacedScene,
}

impl Case {
    /// Whether a certificate is about the true surface itself, not about facets.
    fn is_exact(&self, surface: &Photosurface) -> bool {
        self.is_round && surface.facts.certificate.curvature == 0.0
    }
}

fn sphere() -> Shape {
    Shape::sphere(1.0).unwrap()
}

fn cases() -> Vec<Case> {
    let shapes: [(Shape, Nearest); 3] = [
        (sphere(), DVec3::normalize),
        (Shape::cuboid([1.0, 2.0, 3.0]).unwrap(), |place| place),
        (Shape::lattice([1, 1, 2], 1.0, 0.1).unwrap(), |place| place),
    ];
    let mut cases = vec![];
    for (shape, nearest) in shapes {
        for model in ViewModel::ALL {
            for beta in [0.0, 0.5, 0.9, 0.99] {
                cases.push(Case {
                    model,
                    beta,
                    nearest,
                    is_round: shape == sphere(),
                    placed: placed(shape.clone(), model, beta, &[0.0]),
                });
            }
        }
    }
    cases
}

fn placed(shape: Shape, model: ViewModel, beta: f64, steps: &[f64]) -> PlacedScene {
    // As points, flat shapes are certified place by place.
    let measure = Some(Measure::Points).filter(|_| shape != sphere());
    let mut object = Object::new("object", Source::Shape(shape, Appearance::default()));
    (object.model, object.measure) = (Some(model), measure);
    let observer = Observer {
        velocity: Velocity::from_beta(beta, DIRECTION).unwrap(),
        position: photosurface::scene::Place::new(OBSERVER).unwrap(),
        ..Observer::default()
    };
    let scene = Scene::new(observer, vec![object]).unwrap();
    let scene = scene.with_steps(steps.to_vec()).unwrap();
    let scene = scene.with_tolerance(Tolerance::relative(1e-3).unwrap());
    let (models, _) = load_models(&scene, ".".as_ref()).unwrap();
    PlacedScene::new(scene, models).unwrap()
}

/// Where a place at rest is shown, in the observer's frame, by the definition of the model; the observer is at `event`.
fn shown(model: ViewModel, beta: f64, event: Event, place: DVec3) -> DVec3 {
    let n = DIRECTION.normalize();
    let gamma = (1.0 - beta * beta).sqrt().recip();
    let offset = place - event.position;
    let contracted = offset + n * (n.dot(offset) * (1.0 / gamma - 1.0));
    let motion = n * -beta;
    match model {
        ViewModel::Rest => offset,
        ViewModel::Contracted => contracted,
        ViewModel::Seen => delayed(contracted, motion),
        ViewModel::Delayed => delayed(offset, motion),
    }
}

/// Where something is seen that is at `now` and moves with the velocity `motion`, by bisection of its light's time.
fn delayed(now: DVec3, motion: DVec3) -> DVec3 {
    let is_early = |time: f64| (now - motion * time).length() > time;
    let (mut low, mut high) = (0.0, 1.0);
    while is_early(high) {
        high *= 2.0;
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if is_early(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    now - motion * high
}

/// The largest distance between a photosurface and the true surface at many places, over the bound of its certificate.
fn worst(case: &Case, event: Event, surface: &Photosurface, rest: &[DVec3]) -> f64 {
    let mut random = Random::new(7);
    let mut worst = 0.0_f64;
    // The nearest place takes hundreds of looks at the surface.
    let samples = if case.is_exact(surface) { 3 } else { 20 };
    for triangle in surface.mesh.triangles() {
        let corners = triangle.map(|corner| corner as usize);
        for _ in 0..samples {
            let weights = random_weights(&mut random);
            let at_rest = corners.map(|corner| rest[corner]);
            let place = mix(at_rest, weights);
            let drawn = mix(
                corners.map(|corner| surface.mesh.positions()[corner]),
                weights,
            );
            let shown = |place| shown(case.model, case.beta, event, (case.nearest)(place));
            let [a, b, c] = at_rest;
            let error = match case.is_exact(surface) {
                true => nearest_distance(shown, place, [b - a, c - a], drawn),
                false => shown(place).distance(drawn),
            };
            worst = worst.max(error / surface.facts.certificate.total);
        }
    }
    worst
}

#[test]
fn each_model_is_within_its_certificate_of_its_definition() {
    let options = SurfaceOptions {
        attributes: [Attribute::RestPosition, Attribute::EmissionTime]
            .into_iter()
            .collect(),
        ..SurfaceOptions::default()
    };
    println!("model       beta   triangles  source  largest error over its bound");
    for case in cases() {
        let made: Vec<_> = case.placed.photosurfaces(0, options).unwrap().collect();
        let [surface] = made.as_slice() else {
            panic!("one part")
        };
        let (facts, certificate) = (&surface.facts, &surface.facts.certificate);
        assert!(certificate.complete, "{} {}", case.model, case.beta);
        let event = Event::new(0.0, OBSERVER);
        let rest = surface.vertex_data.rest_positions().unwrap();
        let worst = worst(&case, event, surface, rest);
        println!(
            "{:10} {:5} {:10} {:8} {worst:.3}",
            case.model.name(),
            case.beta,
            facts.triangles,
            certificate.triangles_in
        );
        assert!(worst <= 1.0, "{} {}: {worst}", case.model, case.beta);
        let is_seen = case.model == ViewModel::Seen;
        assert_eq!(facts.model.is_none(), is_seen);
        // An exact surface is triangulated anew, as it bends.
        if !case.model.has_delay() && !case.is_exact(surface) {
            assert_eq!(
                facts.triangles, certificate.triangles_in,
                "linear models need none more"
            );
        } else if case.beta == 0.9 && certificate.curvature == 0.0 {
            assert!(facts.triangles > certificate.triangles_in, "edges bend");
        }
        // The light has left as long ago as it has come far.
        let times = surface.vertex_data.emission_times().unwrap();
        for (time, place) in times.iter().zip(surface.mesh.positions()) {
            let expected = if case.model.has_delay() {
                -place.length()
            } else {
                0.0
            };
            assert!(
                (time - expected).abs() <= 1e-13 * place.length(),
                "{time} {expected}"
            );
        }
    }
}

/// Normals of a sphere, across two differences of what is shown next to each vertex.
#[test]
fn normals_are_those_of_the_shape_that_is_shown() {
    let options = SurfaceOptions {
        attributes: [Attribute::RestPosition].into_iter().collect(),
        ..SurfaceOptions::default()
    };
    for model in ViewModel::ALL {
        for beta in [0.0, 0.5, 0.9] {
            let placed = placed(sphere(), model, beta, &[0.0]);
            let surface = placed.photosurfaces(0, options).unwrap().next().unwrap();
            let rest = surface.vertex_data.rest_positions().unwrap();
            let shown = |place| shown(model, beta, Event::new(0.0, OBSERVER), place);
            for (&place, &normal) in rest.iter().zip(surface.mesh.normals().unwrap()) {
                let (u, v) = place.normalize().any_orthonormal_pair();
                let slope = |step: DVec3| shown(place + step) - shown(place - step);
                let across = slope(1e-5 * u).cross(slope(1e-5 * v)).normalize();
                // Of second order in 1e-5, and 1e-13 over it, each magnified by stretches of at most 20.
                assert!(
                    normal.distance(across) < 1e-6,
                    "{model} {beta} {place}: {normal} {across}"
                );
            }
        }
    }
}

/// One mesh for all steps keeps every step's certificate, though what stands for the object differs from step to step.
#[test]
fn a_morph_is_within_its_certificates_under_every_model() {
    let steps = [-2.0, 0.5, 3.0];
    for model in ViewModel::ALL {
        let beta = 0.9;
        let cube = Shape::cuboid([1.0, 2.0, 3.0]).unwrap();
        let placed = placed(cube, model, beta, &steps);
        let parts: Vec<_> = placed.morphing(SurfaceOptions::default()).collect();
        let [of_steps] = parts.as_slice() else {
            panic!("one part")
        };
        // The mesh at rest that all steps share: what the model without either effect shows at the first step.
        let gamma = (1.0 - beta * beta).sqrt().recip();
        let n = DIRECTION.normalize();
        let event = |step: f64| Event::new(gamma * step, OBSERVER + n * (beta * gamma * step));
        let case = Case {
            model,
            beta,
            nearest: |place| place,
            is_round: false,
            placed: placed.clone(),
        };
        let rest = rest_of(model, event(steps[0]), &of_steps[0]);
        for (surface, step) in of_steps.iter().zip(steps) {
            assert!(surface.facts.certificate.complete, "{model}");
            assert_eq!(surface.mesh.triangles(), of_steps[0].mesh.triangles());
            let worst = worst(&case, event(step), surface, &rest);
            assert!(worst <= 1.0 + 1e-9, "{model} at {step}: {worst}");
        }
    }
}

/// Predictions and budgets are about what is shown, not about the object: linear models need none more, and no model gets
/// more than it may have.
#[test]
fn predictions_and_budgets_hold_under_every_model() {
    for model in ViewModel::ALL {
        for (shape, most) in [
            (Shape::cuboid([1.0, 2.0, 3.0]).unwrap(), 100),
            (sphere(), 700),
        ] {
            let placed = placed(shape, model, 0.9, &[-1.0, 0.0, 1.0]);
            let options = SurfaceOptions::default();
            let count = |placed: &PlacedScene| -> usize {
                let steps = (0..3).flat_map(|step| placed.photosurfaces(step, options).unwrap());
                steps.map(|surface| surface.facts.triangles).sum()
            };
            let made = count(&placed) as f64;
            let predicted = placed.predictions(options)[0];
            assert!(predicted.reachable, "{model}");
            assert!(
                (predicted.triangles / made - 1.0).abs() < 0.4,
                "{model}: {} {made}",
                predicted.triangles
            );
            let (fitted, loosening) = placed.within_budget(options, most);
            let fitted = count(&fitted);
            assert!(fitted as u64 <= most, "{model}: {fitted}");
            assert_eq!(loosening[0] > 1.0, made > most as f64, "{model}: {made}");
        }
    }
}

/// The places at rest of the vertices of a photosurface at 0.9 c, by the inverse of the textbook formulas.
fn rest_of(model: ViewModel, event: Event, surface: &Photosurface) -> Vec<DVec3> {
    let (n, beta) = (DIRECTION.normalize(), 0.9_f64);
    let gamma = (1.0 - beta * beta).sqrt().recip();
    let places = surface.mesh.positions().iter().map(|&place| {
        // What is seen at a distance moved on, while its light came, to where it is now.
        let now = match model.has_delay() {
            true => place - n * (beta * place.length()),
            false => place,
        };
        let longer = if model.has_contraction() { gamma } else { 1.0 };
        event.position + now + n * ((longer - 1.0) * n.dot(now))
    });
    places.collect()
}

/// The positions at rest that files have are those of the object itself, also where nothing of them is left in what stands
/// for it: at rapidity 30 its length along the motion is 5e12 times shorter than its width.
#[test]
fn positions_at_rest_are_those_of_the_object_under_every_model() {
    let objects = |model: &str| {
        format!(
            r#""objects": [
            {{ "name": "ring", "file": "looks.obj", "position": [-32, -26, 0.5], "model": "{model}", "measure": "points" }},
            {{ "name": "ball", "shape": {{ "sphere": {{ "radius": 1 }} }}, "position": [3, 2, 1], "model": "{model}" }},
            {{ "name": "facets", "shape": {{ "sphere": {{ "radius": 1, "resolution": 12 }} }}, "model": "{model}" }},
            {{ "name": "box", "shape": {{ "box": {{ "size": [1, 2, 3] }} }}, "position": [5, 0, 9], "model": "{model}" }} ]"#
        )
    };
    let wanted = SurfaceOptions {
        attributes: [Attribute::RestPosition].into_iter().collect(),
        ..SurfaceOptions::default()
    };
    for (model, rapidity) in [("contracted", 30.0), ("delayed", 3.0)] {
        let placed = |model: &str| {
            let scene = Scene::from_json(&format!(
                r#"{{ "observer": {{ "velocity": {{ "rapidity": {rapidity}, "direction": [-0.6, 0.64, -0.48] }} }},
                "steps": [0, 1], "tolerance": {{ "relative": 0.01 }}, {} }}"#,
                objects(model)
            ));
            let scene = scene.unwrap();
            let (models, _) = load_models(&scene, "fixtures/meshes".as_ref()).unwrap();
            PlacedScene::new(scene, models).unwrap()
        };
        let of_rest: Vec<Photosurface> = placed("rest").photosurfaces(0, wanted).unwrap().collect();
        let placed = placed(model);
        let mut made: Vec<Photosurface> = placed.photosurfaces(0, wanted).unwrap().collect();
        made.extend(placed.morphing(wanted).flatten());
        for surface in &made {
            let places = surface.vertex_data.rest_positions().unwrap();
            let facts = &surface.facts;
            assert_eq!(places.len(), surface.mesh.vertex_count(), "{facts:?}");
            if facts.object == "ball" {
                let off = |place: &DVec3| (place.length() - 1.0).abs();
                assert!(places.iter().all(|place| off(place) < 1e-14), "{facts:?}");
                continue;
            }
            let of_rest = of_rest.iter().find(|of_rest| {
                (&of_rest.facts.object, &of_rest.facts.part) == (&facts.object, &facts.part)
            });
            let known = of_rest.unwrap().vertex_data.rest_positions().unwrap();
            // First come the vertices of the source; those that refinement adds are rounded in the stand-in.
            assert_eq!(&places[..known.len()], known, "{facts:?}");
        }
    }
}
