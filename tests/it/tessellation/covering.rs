//! Refined triangles cover their source once: the same area at rest, and every edge inside between two triangles, at any
//! rapidity and from any distance.
//!
//! The certificate speaks of the triangles that were made; it says nothing of one that is missing.

use std::sync::Arc;

use crate::common::Random;
use crate::common::refining::{Welded, mesh, model};
use photosurface::scene::{Attribute, Attributes, BUILT_IN_SCENES, Place};
use photosurface::tessellate::Precision;
use photosurface::{
    DVec3, Mesh, Object, Observer, Photosurface, PlacedScene, Scene, Source, SurfaceOptions,
    Tolerance, Velocity, load_models,
};

/// Rapidities where a chart of the sky holds a facet, where it begins to collapse, and the largest.
const RAPIDITIES: [f64; 11] = [
    0.1, 2.0, 10.0, 15.0, 17.5, 18.5, 20.0, 25.0, 60.0, 200.0, 350.0,
];
const MAX_TRIANGLES: u64 = 20_000;

fn wanted() -> SurfaceOptions {
    SurfaceOptions {
        attributes: Attributes::default().with(Attribute::RestPosition),
        precision: Precision::Double,
        ..SurfaceOptions::default()
    }
}

fn placed(scene: Scene) -> PlacedScene {
    let (models, _) = load_models(&scene, ".".as_ref()).unwrap();
    PlacedScene::new(scene, models).expect("one model an object")
}

fn rest_positions(surface: &Photosurface) -> &[DVec3] {
    surface.vertex_data.rest_positions().unwrap()
}

/// The sum of areas, and the length of all edges that one triangle has and none goes back along.
#[derive(Clone, Copy, Debug)]
struct Extent {
    area: f64,
    rim: f64,
    triangles: usize,
    size: f64,
}

impl Extent {
    fn of<'a>(parts: impl Iterator<Item = (&'a [DVec3], &'a [[u32; 3]])>) -> Self {
        let parts: Vec<_> = parts.collect();
        let (mut area, mut triangles, mut size) = (0.0, 0, 0.0f64);
        for (places, corners) in &parts {
            triangles += corners.len();
            for corners in *corners {
                let [a, b, c] = corners.map(|corner| places[corner as usize]);
                area += 0.5 * (b - a).cross(c - a).length();
                size = size.max((b - a).length()).max((c - a).length());
            }
        }
        let welded = Welded::new(
            parts
                .iter()
                .map(|&(places, corners)| (places, places, corners)),
        );
        Self {
            area,
            rim: welded.boundary(),
            triangles,
            size,
        }
    }

    /// What rounding may add up to: a corner is at its place to a few units in the last place of the mesh's size.
    fn rounding(&self) -> f64 {
        self.triangles as f64 * 64.0 * f64::EPSILON
    }
}

/// Checks all photosurfaces of all steps against the parts that they are made of; how many triangles were added.
#[track_caller]
fn assert_covering(placed: PlacedScene, case: &str) -> usize {
    let (placed, _) = placed.within_budget(wanted(), MAX_TRIANGLES);
    let mut added = 0;
    for step in 0..placed.scene().steps().len() {
        let surfaces: Vec<_> = placed.photosurfaces(step, wanted()).unwrap().collect();
        for (object, parts) in placed.objects() {
            let before = Extent::of(
                parts
                    .iter()
                    .map(|(_, part)| (part.mesh().positions(), part.mesh().triangles())),
            );
            let of_object = surfaces.iter().filter(|s| s.facts.object == object.name);
            let after = Extent::of(of_object.map(|s| (rest_positions(s), s.mesh.triangles())));
            let limit = before.rounding() + after.rounding();
            let area = (after.area - before.area).abs();
            let rim = (after.rim - before.rim).abs();
            assert!(
                area <= limit * before.size * before.size && rim <= limit * before.size,
                "{case}, step {step}, {}: {before:?} became {after:?}",
                object.name
            );
            let certificates = surfaces.iter().map(|s| &s.facts.certificate);
            added += certificates
                .map(|c| c.triangles_out - c.triangles_in)
                .sum::<usize>();
        }
    }
    added
}

#[test]
fn flat_built_in_scenes_are_covered_at_any_rapidity() {
    for name in ["cube", "lattice", "street"] {
        let scene = BUILT_IN_SCENES.iter().find(|scene| scene.name == name);
        let scene = Scene::from_json(scene.unwrap().json).unwrap();
        let mut added = 0;
        for rapidity in RAPIDITIES {
            let observer = Observer {
                velocity: Velocity::from_rapidity(rapidity, DVec3::NEG_X).unwrap(),
                marker: None,
                ..scene.observer().clone()
            };
            let scene = scene.clone().with_observer(observer).unwrap();
            let scene = scene.with_steps(vec![-5.0, 0.0, 5.0]).unwrap();
            added += assert_covering(placed(scene), &format!("{name} at rapidity {rapidity}"));
        }
        assert!(added > 1000, "{name}: only {added} triangles were added");
    }
}

/// Facets in the plane of motion, across it and oblique, from next to the observer to as far as the observer gets.
#[test]
fn lone_triangles_are_covered_from_any_distance() {
    let mut random = Random::new(31);
    let mut added = 0;
    for rapidity in RAPIDITIES {
        for exponent in [-3, 0, 3, 6, 9, 12] {
            for kind in 0..4 {
                let direction = match kind {
                    0 => DVec3::X,
                    1 => DVec3::NEG_Z,
                    _ => random.direction(),
                };
                let mut corner = || DVec3::from(std::array::from_fn(|_| random.between(-1.0, 1.0)));
                let mut corners: [DVec3; 3] = std::array::from_fn(|_| corner());
                if kind != 3 {
                    // In a plane that holds a direction of motion.
                    corners = corners.map(|corner| DVec3::new(corner.x, 0.0, corner.z));
                }
                let velocity = Velocity::from_rapidity(rapidity, direction).unwrap();
                let lone = mesh(&corners.map(|corner| corner.to_array()), &[[0, 1, 2]]);
                for sense in [-1.0, 1.0] {
                    let place = direction * (sense * 10f64.powi(exponent)) + DVec3::Y * 0.3;
                    let observer = Observer {
                        position: Place::new(place).unwrap(),
                        velocity,
                        ..Observer::default()
                    };
                    let case = format!("{lone:?} from {place} at {velocity:?}");
                    added += assert_covering(placed(scene_of(&lone, observer)), &case);
                }
            }
        }
    }
    assert!(added > 1000, "only {added} triangles were added");
}

fn scene_of(mesh: &Mesh, observer: Observer) -> Scene {
    let model = model(std::slice::from_ref(mesh));
    let object = Object::new("lone", Source::Model(Arc::new(model)));
    Scene::new(observer, vec![object])
        .unwrap()
        .with_tolerance(Tolerance::relative(1e-3).unwrap())
}
