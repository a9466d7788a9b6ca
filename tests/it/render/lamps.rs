//! Pictures of scenes with lamps, against closed forms and against a solver that follows light through the scene frame.

use std::sync::Arc;

use glam::DVec2;
use photosurface::material::{Material, Model, Part};
use photosurface::mesh::Mesh;
use photosurface::render::{
    Camera, Picture, PictureEffects, PictureOptions, PictureSize, Projection, Scenery, Viewpoint,
};
use photosurface::scene::{Object, Source};
use photosurface::shape::Color;
use photosurface::{DVec3, PlacedScene, Scene, SurfaceOptions, Tolerance, Velocity, load_models};
use serde_json::{Value, json};

use crate::common::Random;

/// One ray a pixel, before black.
const BARE: PictureOptions = PictureOptions {
    samples: 1,
    background: Color([0; 3]),
    wireframe: None,
};

fn placed(scene: &Value, tolerance: f64) -> PlacedScene {
    let scene = Scene::from_json(&scene.to_string()).expect("a valid scene");
    let scene = scene.with_tolerance_for_all(Tolerance::relative(tolerance).expect("a tolerance"));
    let (models, _) = load_models(&scene, ".".as_ref()).expect("shapes");
    PlacedScene::new(scene, models).expect("one model an object")
}

/// Everything at rest, lit by the scene's lamps.
fn at_rest(placed: &PlacedScene) -> Scenery {
    let mut scenery = Scenery::new();
    scenery.set_effects(PictureEffects::new(placed.scene().effects()));
    scenery.set_lamps(placed.scene());
    for (object, parts) in placed.objects() {
        for (_, part) in parts {
            scenery.add_at_rest(object, part);
        }
    }
    scenery
}

/// The photosurfaces of the first step, lit by the scene's lamps.
fn mapped(placed: &PlacedScene) -> Scenery {
    let moment = placed.scene().moment(0).expect("a step");
    let mut scenery = Scenery::new();
    scenery.set_effects(PictureEffects::new(placed.scene().effects()));
    scenery.set_lamps(placed.scene());
    scenery.set_occluders(&Arc::new(at_rest(placed)));
    let wanted = SurfaceOptions::default();
    for surface in placed.photosurfaces(0, wanted).expect("a step") {
        let mut objects = placed.scene().objects().iter();
        let object = objects
            .find(|object| object.name == surface.facts.object)
            .expect("photosurfaces are of objects");
        scenery.add_photosurface(object, &moment, &surface.mesh, surface.material.as_ref());
    }
    scenery
}

fn take(placed: &PlacedScene, scenery: &Scenery, camera: &Camera) -> Picture {
    let moment = placed.scene().moment(0).expect("a step");
    scenery.picture(camera, Viewpoint::Observer(&moment), BARE)
}

fn camera(width: u32, height: u32, vertical_fov_deg: f64, look: DVec3) -> Camera {
    let size = PictureSize::new(width, height).expect("a fair size");
    Camera::new(size, Projection::Perspective { vertical_fov_deg }, look).expect("a fair camera")
}

fn pixels(camera: &Camera) -> impl Iterator<Item = (u32, u32, DVec3)> + use<'_> {
    let (width, height) = (camera.size().width(), camera.size().height());
    let all = (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)));
    all.map(|(x, y)| {
        let place = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        (x, y, camera.direction(place))
    })
}

/// The linear value of a channel.
fn linear(byte: u8) -> f64 {
    let encoded = f64::from(byte) / 255.0;
    match encoded <= 0.04045 {
        true => encoded / 12.92,
        false => ((encoded + 0.055) / 1.055).powf(2.4),
    }
}

/// The direction, for one at rest with the scene, of light that an observer in motion sees in the direction `seen`:
/// `tan(theta'/2) = exp(eta) tan(theta/2)`.
fn direction_at_rest(motion: Velocity, seen: DVec3) -> DVec3 {
    let along = motion.direction();
    let across = seen - along * along.dot(seen);
    if motion.rapidity() == 0.0 || across.length() < 1e-12 {
        return seen;
    }
    let half = 0.5 * across.length().atan2(along.dot(seen));
    let angle = 2.0 * (half.tan() * motion.rapidity().exp()).atan();
    along * angle.cos() + across.normalize() * angle.sin()
}

/// Each pixel in which the floor is seen from `eye`: with the direction, for one at rest with the floor, and the place.
fn floor_places(
    camera: &Camera,
    motion: Velocity,
    eye: DVec3,
) -> impl Iterator<Item = (u32, u32, DVec3, DVec3)> + use<'_> {
    pixels(camera).filter_map(move |(x, y, seen)| {
        let way = direction_at_rest(motion, seen);
        let distance = -eye.y / way.y;
        let place = eye + way * distance;
        let is_floor = distance > 0.0 && place.abs().max_element() <= 150.0;
        is_floor.then_some((x, y, way, place))
    })
}

/// A floor whose upper side is `y = 0`, and what else there is.
fn above_a_floor(observer: Value, lamps: Value, mut others: Vec<Value>) -> Value {
    others.push(
        json!({ "name": "floor", "shape": { "box": { "size": [400, 2, 400] } }, "color": "#ffffff",
                        "position": [0, -1, 0] }),
    );
    json!({ "observer": observer, "lamps": lamps, "objects": others })
}

/// A lamp at a height `h` flashes at time 0; an observer at a height `H` beside it, at time `t`, sees the ring where
/// `sqrt(rho^2 + h^2) + sqrt(rho_o^2 + H^2)` is between `t - duration` and `t`: an ellipse, the cut of an ellipsoid whose
/// foci are lamp and observer. For an observer in motion the same places of the floor are bright, in other directions.
#[test]
fn a_flash_is_seen_as_the_rings_of_its_closed_form() {
    let (lamp, eye, duration) = (DVec3::new(0.5, 2.0, -1.0), DVec3::new(0.0, 3.0, 1.0), 0.4);
    for beta in [0.0, 0.8] {
        for time in [5.6, 6.0, 8.0] {
            let motion =
                Velocity::from_beta(beta, DVec3::new(0.0, -0.6, -0.8)).expect("a velocity");
            let observer = json!({ "time": time, "position": eye.to_array(),
                                   "velocity": { "beta": beta, "direction": [0, -0.6, -0.8] } });
            let lamps = json!([{ "point": { "position": lamp.to_array(), "intensity": 8 },
                                 "flash": { "from": 0, "to": duration } }]);
            let placed = placed(&above_a_floor(observer, lamps, vec![]), 1e-3);
            let camera = camera(160, 120, 100.0, DVec3::new(0.0, -1.0, -0.2));
            let picture = take(&placed, &at_rest(&placed), &camera);
            let (mut bright, mut wrong) = (0, 0);
            for (x, y, _, place) in floor_places(&camera, motion, eye) {
                let distance = place.distance(eye);
                let left = time - distance - place.distance(lamp);
                let expected = left >= 0.0 && left < duration;
                let margin = left.abs().min((left - duration).abs());
                let found = picture.pixel(x, y) != [0; 3];
                bright += u32::from(found);
                wrong += u32::from(found != expected && margin > 1e-9);
            }
            assert_eq!(wrong, 0, "beta {beta}, time {time}");
            assert!(bright > 50, "beta {beta}, time {time}: {bright}");
        }
    }
}

/// Matte light of a lamp at rest on a floor at rest: `I cos / R^2`, whatever the observer's motion, where no effect on light is
/// asked for. A gloss of less than 0.04 of it comes on top.
#[test]
fn lamps_at_rest_light_as_at_rest_whatever_the_observer_does() {
    let (lamp, eye) = (DVec3::new(1.0, 2.0, -2.0), DVec3::new(0.0, 3.0, 1.0));
    let lamps = json!([{ "point": { "position": lamp.to_array(), "intensity": 2 } },
                       { "sun": { "direction": [1, -2, 0], "irradiance": 0.1 } },
                       { "ambient": { "irradiance": 0.05 } }]);
    for beta in [0.0, 0.9] {
        let direction = [0.6, 0.0, -0.8];
        let motion = Velocity::from_beta(beta, direction.into()).expect("a velocity");
        let observer = json!({ "position": eye.to_array(), "velocity": { "beta": beta, "direction": direction } });
        let placed = placed(&above_a_floor(observer, lamps.clone(), vec![]), 1e-3);
        let camera = camera(120, 90, 90.0, DVec3::new(0.2, -1.0, -0.6));
        let picture = take(&placed, &at_rest(&placed), &camera);
        let mut seen_places = 0;
        for (x, y, way, place) in floor_places(&camera, motion, eye) {
            let to_lamp = lamp - place;
            let point = 2.0 * to_lamp.y / to_lamp.length().powi(3);
            let matte = point + 0.1 * 2.0 / 5f64.sqrt() + 0.05;
            let found = linear(picture.pixel(x, y)[1]);
            // Of the matte part a gloss takes a little; half a step of 8 bits is 0.0045 at most.
            assert!(found > 0.93 * matte - 0.0045, "{x} {y}: {found} {matte}");
            let grazing = way.y.abs() < 0.3;
            assert!(
                grazing || found < 1.07 * matte + 0.0045,
                "{x} {y}: {found} {matte}"
            );
            seen_places += 1;
        }
        assert!(seen_places > 2000, "{seen_places}");
    }
}

/// The principle of relativity: floor, ball, lamps and observer that move together, by lamps that ride and a lamp that keeps up.
#[test]
fn what_moves_together_is_lit_as_at_rest() {
    let shown = |beta: f64| {
        let motion = json!({ "beta": beta, "direction": [0, 0, -1] });
        let observer = json!({ "time": 0, "position": [0, 2, 0], "velocity": motion });
        let lamps = json!([
            { "point": { "position": [1, 3, -3], "intensity": 4 }, "kelvin": 3000, "object": "floor" },
            { "point": { "position": [-2, 2, 0], "intensity": 2 }, "velocity": motion },
        ]);
        let ball = json!({ "name": "ball", "shape": { "sphere": { "radius": 0.5 } }, "position": [-1, 1, 0],
                           "color": "#c0a080", "velocity": motion });
        let mut scene = above_a_floor(observer, lamps, vec![ball]);
        scene["objects"][1]["velocity"] = motion;
        scene["objects"][1]["position"] = json!([0, -1, 0]);
        scene["effects"] = json!({ "doppler": "spectrum", "searchlight": true });
        let placed = placed(&scene, 1e-3);
        take(
            &placed,
            &at_rest(&placed),
            &camera(80, 60, 100.0, DVec3::new(-0.3, -0.8, -0.4)),
        )
    };
    let (rest, moving) = (shown(0.0), shown(0.97));
    let bright = rest.bytes().iter().filter(|&&byte| byte > 40).count();
    assert!(bright > 2000, "{bright}");
    let off = rest
        .bytes()
        .iter()
        .zip(moving.bytes())
        .filter(|(a, b)| a.abs_diff(**b) > 1);
    // On edges of shadows roundings decide.
    assert!(off.count() < 20);
}

/// A ball in uniform motion, given in the scene frame.
struct Mover {
    center: DVec3,
    motion: Velocity,
    radius: f64,
}

impl Mover {
    /// Whether it is at a place at a time: contracted, where it is then.
    fn is_at(&self, time: f64, place: DVec3) -> f64 {
        let along = self.motion.direction();
        let offset = place - self.center - along * (self.motion.beta() * time);
        let par = along.dot(offset);
        let across = offset - along * par;
        (across.length_squared() + (par * self.motion.gamma()).powi(2)).sqrt() / self.radius
    }
}

/// Light that leaves a moving lamp is followed to the floor in the scene frame, in small steps; balls that move with velocities
/// of their own are in its way, or not.
#[test]
fn shadows_are_where_light_meets_something_on_its_way() {
    let mut random = Random::new(21);
    let (mut dark, mut lit, mut wrong) = (0, 0, 0);
    for case in 0..6 {
        let lamp_motion = match case {
            0 => Velocity::ZERO,
            _ => Velocity::from_beta(random.between(0.0, 0.9), random.direction()).expect("fine"),
        };
        let lamp = DVec3::new(random.between(-1.0, 1.0), 6.0, random.between(-1.0, 1.0));
        let movers: Vec<_> = (0..5)
            .map(|_| Mover {
                center: DVec3::new(
                    random.between(-3.0, 3.0),
                    random.between(1.5, 3.5),
                    random.between(-3.0, 3.0),
                ),
                motion: Velocity::from_beta(random.between(0.0, 0.95), random.direction())
                    .expect("fine"),
                radius: random.between(0.3, 0.9),
            })
            .collect();
        let balls = movers.iter().enumerate().map(|(number, mover)| {
            json!({ "name": format!("ball{number}"), "shape": { "sphere": { "radius": mover.radius } },
                    "color": "#ff0000", "position": mover.center.to_array(),
                    "velocity": { "beta": mover.motion.beta(), "direction": mover.motion.direction().to_array() } })
        });
        let eye = DVec3::new(0.0, 9.0, 0.0);
        let time = 12.0;
        let observer = json!({ "time": time, "position": eye.to_array() });
        let lamps = json!([{ "point": { "position": lamp.to_array(), "intensity": 60 },
            "velocity": { "beta": lamp_motion.beta(), "direction": lamp_motion.direction().to_array() } }]);
        let mut scene = above_a_floor(observer, lamps, balls.collect());
        let lit_scene = placed(&scene, 1e-3);
        let camera = camera(60, 60, 70.0, DVec3::NEG_Y);
        let picture = take(&lit_scene, &at_rest(&lit_scene), &camera);
        scene["lamps"] = json!([]);
        let bare = placed(&scene, 1e-3);
        let bare = take(&bare, &at_rest(&bare), &camera);
        for (x, y, seen) in pixels(&camera) {
            // White where the floor is seen.
            let [red, green, _] = bare.pixel(x, y);
            let place = eye + seen * (-eye.y / seen.y);
            if green.abs_diff(red) > 20 || place.length() > 20.0 {
                continue;
            }
            let arrives = time - place.distance(eye);
            let beta = lamp_motion.direction() * lamp_motion.beta();
            let (mut early, mut after) = (arrives - 1e3, arrives);
            for _ in 0..100 {
                let middle = 0.5 * (early + after);
                match place.distance(lamp + beta * middle) > arrives - middle {
                    true => after = middle,
                    false => early = middle,
                }
            }
            let (from, leaves) = (lamp + beta * early, early);
            if from.y < 0.05 {
                continue;
            }
            let closest = (0..=3000)
                .map(|step| {
                    let part = f64::from(step) / 3000.0;
                    let (on_way, then) =
                        (from.lerp(place, part), leaves + (arrives - leaves) * part);
                    let all = movers.iter().map(|mover| mover.is_at(then, on_way));
                    all.fold(f64::INFINITY, f64::min)
                })
                .fold(f64::INFINITY, f64::min);
            // Next to an edge a step is too long to tell.
            if (closest - 1.0).abs() < 0.02 {
                continue;
            }
            let expected = closest > 1.0;
            let found = picture.pixel(x, y) != [0; 3];
            // Very oblique and very far light is black to 8 bits.
            let to_lamp = from - place;
            if 60.0 * to_lamp.y / to_lamp.length().powi(3) < 0.01 {
                continue;
            }
            wrong += u32::from(found != expected);
            match expected {
                true => lit += 1,
                false => dark += 1,
            }
        }
    }
    println!("{lit} lit, {dark} dark, {wrong} wrong");
    assert_eq!(wrong, 0);
    assert!(lit > 5000 && dark > 500, "{lit} lit, {dark} dark");
}

/// Balls, boxes and a lattice in several motions, a lamp that rides, one that moves, a sun and a sky, with all effects.
fn busy(beta: f64) -> Value {
    let mut scene = above_a_floor(
        json!({ "time": 4, "position": [0, 2.5, 6], "velocity": { "beta": beta, "direction": [0.3, 0, -1] } }),
        json!([
            { "point": { "position": [0, 0, 0], "intensity": 5 }, "kelvin": 3000, "object": "lantern" },
            { "point": { "position": [-4, 3, -2], "intensity": 4 }, "color": "#80ff80", "velocity": [0.5, 0, 0] },
            { "sun": { "direction": [1, -1, -0.5], "irradiance": 0.2 } },
            { "ambient": { "irradiance": 0.1 }, "kelvin": 9000 }
        ]),
        vec![
            json!({ "name": "lantern", "shape": { "sphere": { "radius": 0.2 } }, "position": [1.5, 2.5, 0],
                    "velocity": [0.1, 0, 0.3] }),
            json!({ "name": "ball", "shape": { "sphere": { "radius": 0.8 } }, "color": "#ff8080", "position": [-1, 1, 0],
                    "velocity": [0.2, 0, 0] }),
            json!({ "name": "cube", "shape": { "box": { "size": [1, 1, 1] } }, "color": "#8080ff",
                    "position": [3, 0.5, -3], "velocity": [-0.3, 0, 0] }),
            json!({ "name": "ring", "shape": { "torus": { "major_radius": 0.8, "minor_radius": 0.25 } },
                    "color": "#ffff80", "position": [0, 1.2, -4] }),
        ],
    );
    scene["effects"] = json!({ "doppler": "spectrum", "searchlight": true, "exposure": -1 });
    scene
}

/// Both methods show the same light: where they do not, an edge of a thing or a shadow is within a pixel or two.
#[test]
fn rays_and_photosurfaces_are_lit_alike() {
    for beta in [0.0, 0.6] {
        let placed = placed(&busy(beta), 2e-4);
        let camera = camera(200, 150, 75.0, DVec3::new(0.1, -0.25, -1.0));
        let rays = take(&placed, &at_rest(&placed), &camera);
        let meshes = take(&placed, &mapped(&placed), &camera);
        let differs =
            |a: [u8; 3], b: [u8; 3], limit: u8| (0..3).any(|k| a[k].abs_diff(b[k]) > limit);
        let (mut compared, mut differ, mut shaded) = (0, 0, 0);
        for x in 1..199 {
            for y in 1..149 {
                let here = rays.pixel(x, y);
                let around = [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)];
                // Neither an edge nor a steep slope.
                if around
                    .iter()
                    .any(|&(x, y)| differs(rays.pixel(x, y), here, 6))
                {
                    continue;
                }
                compared += 1;
                shaded += u32::from(here != [0; 3]);
                differ += u32::from(differs(meshes.pixel(x, y), here, 4));
            }
        }
        println!("beta {beta}: {differ} of {compared} differ");
        assert!(compared > 15_000 && shaded > 5000, "{compared} {shaded}");
        assert!(
            differ * 500 < compared,
            "beta {beta}: {differ} of {compared}"
        );
    }
}

/// From the observer's own place, a picture from outside shows photosurfaces in the light that the observer sees.
#[test]
fn from_outside_photosurfaces_are_lit_as_the_observer_sees_them() {
    let placed = placed(&busy(0.6), 1e-3);
    let camera = camera(160, 120, 75.0, DVec3::new(0.1, -0.25, -1.0));
    let scenery = mapped(&placed);
    let observer = take(&placed, &scenery, &camera);
    let outside = scenery.picture(&camera, Viewpoint::Outside(DVec3::ZERO), BARE);
    assert_eq!(observer, outside);
}

/// How bright the middle of a floor is below a lamp of intensity 4 at height 2, with something in between.
fn below(object: &str, lamp: Value) -> u8 {
    let shade: Value = serde_json::from_str(object).expect("JSON");
    let observer = json!({ "time": 20, "position": [0, 0.5, 3] });
    let placed = placed(&above_a_floor(observer, json!([lamp]), vec![shade]), 1e-3);
    let camera = camera(1, 1, 1.0, DVec3::new(0.0, -0.5, -3.0));
    take(&placed, &at_rest(&placed), &camera).pixel(0, 0)[1]
}

/// An object is no shade for a lamp that rides on it, and one for every other.
#[test]
fn a_lamp_shines_out_of_the_object_on_which_it_rides() {
    let shade =
        r#"{ "name": "shade", "shape": { "sphere": { "radius": 0.3 } }, "position": [0, 2, 0] }"#;
    let fixed = json!({ "point": { "position": [0, 2, 0], "intensity": 4 } });
    let riding = json!({ "point": { "position": [0, 0, 0], "intensity": 4 }, "object": "shade" });
    let beside = shade.replace("[0, 2, 0]", "[9, 2, 0]");
    let bright = below(&beside, fixed.clone());
    assert!(bright > 100, "{bright}");
    assert_eq!(below(shade, riding), bright);
    assert_eq!(below(shade, fixed), 0);
}

/// Panes above a floor: absent and opaque ones by their mask, and a clear one.
#[test]
fn shadows_are_cast_where_surfaces_are_opaque() {
    let lamp = json!([{ "point": { "position": [0, 3, 0], "intensity": 4 } }]);
    let scene = above_a_floor(json!({ "time": 20, "position": [0, 0.5, 3] }), lamp, vec![]);
    let placed = placed(&scene, 1e-3);
    let shown = |material: Option<Value>| {
        let mut scenery = at_rest(&placed);
        if let Some(material) = material {
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            let corners = corners.map(|(x, z)| DVec3::new(x, 1.5, z));
            let mesh = Mesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).expect("a mesh");
            let material = Arc::new(Material::new(material, vec![]).expect("a material"));
            let pane = Part::new("pane", mesh, Some(material)).expect("a part");
            let model = Model {
                parts: vec![pane.clone()],
                ..Model::default()
            };
            scenery.add_at_rest(&Object::new("pane", Source::Model(Arc::new(model))), &pane);
        }
        let camera = camera(1, 1, 1.0, DVec3::new(0.0, -0.5, -3.0));
        take(&placed, &scenery, &camera).pixel(0, 0)[1]
    };
    let pane = |mode: &str, alpha: f64| {
        let color = json!({ "baseColorFactor": [1.0, 1.0, 1.0, alpha] });
        shown(Some(
            json!({ "alphaMode": mode, "pbrMetallicRoughness": color }),
        ))
    };
    let bright = shown(None);
    assert!(bright > 80, "{bright}");
    // Sides do not matter.
    assert_eq!(pane("OPAQUE", 0.2), 0);
    assert_eq!(
        [pane("MASK", 0.6), pane("MASK", 0.4), pane("BLEND", 0.9)],
        [0, bright, bright]
    );
}

/// Speeds at which nothing but the light-cone form of aberration has digits left.
#[test]
fn no_speed_is_too_much_for_lamps() {
    for rapidity in [20.0, 349.0] {
        let observer =
            json!({ "time": 4, "position": [0, 2.5, 6], "velocity": { "rapidity": rapidity } });
        let mut scene = busy(0.0);
        scene["observer"] = observer;
        scene["lamps"][1]["velocity"] = json!({ "rapidity": rapidity, "direction": [0, 0, 1] });
        let placed = placed(&scene, 1e-2);
        let size = PictureSize::new(48, 24).expect("a fair size");
        let sky = Camera::new(size, Projection::FullSky, DVec3::NEG_Z).expect("a fair camera");
        take(&placed, &at_rest(&placed), &sky);
    }
}
