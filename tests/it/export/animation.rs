//! Steps that follow each other in one file: frames by scales, morph targets, and what is known of vertices.

use std::collections::BTreeSet;

use crate::common::Random;
use crate::common::command::{Workplace, glb_json};
use crate::common::glb::Glb;
use crate::common::refining::nearest_distance;
use photosurface::light_cone::View;
use photosurface::scene::{Attribute, Attributes};
use photosurface::{DVec3, Photosurface, PlacedScene, Scene, SurfaceOptions, load_models};
use serde_json::Value;

/// A round shape, a flat one near the observer, and one that moves too.
const SCENE: &str = r#"{
  "observer": { "velocity": { "beta": 0.9, "direction": [-1, 0, 0] }, "marker": 0.1 },
  "objects": [
    { "name": "ball", "shape": { "sphere": { "radius": 1 } }, "position": [0, 3, 0] },
    { "name": "wall", "shape": { "box": { "size": [4, 0.2, 2] } }, "position": [0, -0.4, 0], "rotation": [0.1, 0, 0.1, 0.99] },
    { "name": "rod", "shape": { "rod": { "length": 3, "radius": 0.1 } }, "position": [1, 0, -2],
      "velocity": { "gamma": 3, "direction": [1, 2, 0] } } ],
  "steps": { "from": -3, "to": 3, "count": 5 },
  "tolerance": { "relative": 3e-3 } }"#;

fn placed() -> PlacedScene {
    placed_scene(SCENE)
}

fn placed_scene(json: &str) -> PlacedScene {
    let scene = Scene::from_json(json).expect("a scene");
    let (models, _) = load_models(&scene, "".as_ref()).expect("nothing to read");
    PlacedScene::new(scene, models).expect("one model an object")
}

/// The places at rest are those of the first step, wherever they are asked for.
fn morphing(placed: &PlacedScene) -> Vec<Vec<Photosurface>> {
    let wanted = SurfaceOptions {
        attributes: Attributes::default().with(Attribute::RestPosition),
        ..SurfaceOptions::default()
    };
    placed.morphing(wanted).collect()
}

/// The place of a round object of the scene that is next to a place at rest, both relative to the object's origin.
fn on_surface(name: &str, place: DVec3) -> DVec3 {
    match name {
        "ball" => place.normalize(),
        "rod" => {
            let (radius, half) = (0.1, 1.5);
            let (level, height) = (place.with_y(0.0), place.y);
            let side = level.normalize() * radius + DVec3::Y * height.clamp(-half, half);
            let lid = level.clamp_length_max(radius) + DVec3::Y * half.copysign(height);
            match place.distance(side) <= place.distance(lid) {
                true => side,
                false => lid,
            }
        }
        _ => unreachable!("flat"),
    }
}

/// One mesh at rest is within the tolerance at every step: random points of it, mapped, are within the certificate
/// of where the flat triangles between mapped corners have them; those of an exact surface are next to it.
#[test]
fn one_mesh_is_within_the_tolerance_at_every_step() {
    assert_within_at_every_step(&placed());
    let surfaces = SCENE.replacen('{', r#"{ "measure": "surface","#, 1);
    assert_within_at_every_step(&placed_scene(&surfaces));
}

fn assert_within_at_every_step(placed: &PlacedScene) {
    let mut random = Random::new(11);
    let parts = morphing(placed);
    assert_eq!(parts.len(), 3);
    for (object, steps) in placed.scene().objects().iter().zip(&parts) {
        assert_eq!(steps.len(), 5);
        let mut largest: f64 = 0.0;
        for (step, surface) in steps.iter().enumerate() {
            let certificate = &surface.facts.certificate;
            assert!(
                certificate.complete,
                "{} {certificate:?}",
                surface.facts.name
            );
            assert_eq!(surface.mesh.triangles(), steps[0].mesh.triangles());
            let view = View::new(&placed.scene().moment(step).unwrap(), &object.world_line());
            let rest = surface.vertex_data.rest_positions().expect("asked for");
            let is_exact = object.name != "wall" && certificate.curvature == 0.0;
            let bound = certificate.measured_gap() + certificate.rounding;
            for corners in surface.mesh.triangles() {
                let weights = [0; 3].map(|_| random.between(0.0, 1.0));
                let weights = weights.map(|weight| weight / weights.iter().sum::<f64>());
                let mix = |points: &[DVec3]| {
                    let points = corners.map(|corner| points[corner as usize]);
                    points[0] * weights[0] + points[1] * weights[1] + points[2] * weights[2]
                };
                let drawn = mix(surface.mesh.positions());
                let [a, b, c] = corners.map(|corner| rest[corner as usize]);
                let seen = |place: DVec3| view.seen_position(on_surface(&object.name, place));
                let error = match is_exact {
                    true => nearest_distance(seen, mix(rest), [b - a, c - a], drawn),
                    false => view.seen_position(mix(rest)).distance(drawn),
                };
                assert!(
                    error <= bound,
                    "{} {corners:?} {weights:?}: {error} {certificate:?}",
                    surface.facts.name
                );
                largest = largest.max(error / bound);
            }
        }
        assert!(
            largest > 0.5,
            "{}: the bound is far from what happens: {largest}",
            object.name
        );
    }
}

/// As many triangles as the step that needs most has on its own at least, and not many more than all steps together:
/// where the observer passes close by, each step needs them in another place.
#[test]
fn one_mesh_for_all_steps_is_no_finer_than_it_has_to_be() {
    // Alone, flat objects are surfaces unless something else is asked for; as morphs they are points.
    let placed = placed_scene(&SCENE.replacen('{', r#"{ "measure": "points","#, 1));
    for (index, steps) in morphing(&placed).iter().enumerate() {
        let is_exact = |surface: &Photosurface| surface.facts.certificate.curvature == 0.0;
        let alone = |step| {
            let mut surfaces = placed
                .photosurfaces(step, SurfaceOptions::default())
                .unwrap();
            surfaces.nth(index).expect("one part an object")
        };
        let alone: Vec<Photosurface> = (0..5).map(alone).collect();
        let counts: Vec<usize> = alone.iter().map(|one| one.facts.triangles).collect();
        let together = &steps[0];
        // Some steps of a round object may take facets, of which there are more; and all steps together it is triangulated
        // anew, which may take a little less than one of them alone.
        let alike = alone
            .iter()
            .filter(|one| is_exact(one) == is_exact(together));
        let finest = alike.map(|one| one.facts.triangles).max().unwrap_or(0);
        let least = match placed.scene().objects()[index].name.as_str() {
            "wall" => finest,
            _ => finest * 9 / 10,
        };
        let (together, all) = (together.facts.triangles, counts.iter().sum::<usize>());
        assert!(
            finest > 0 && together >= least && 10 * together <= 11 * all,
            "{together} {counts:?}"
        );
    }
}

/// What one channel of the animation says.
struct Track {
    node: usize,
    path: String,
    interpolation: String,
    times: Vec<f32>,
    values: Vec<f32>,
}

fn export(workplace: &Workplace, flags: &str) -> Glb {
    workplace.write("scene.json", SCENE);
    workplace
        .run(&format!(
            "export scene.json -o out.glb --report report.json {flags}"
        ))
        .success();
    Glb::new(&workplace.read("out.glb"))
}

impl Glb {
    fn tracks(&self) -> Vec<Track> {
        let animation = &self.json["animations"][0];
        let channels = animation["channels"].as_array().expect("channels").iter();
        let track = |channel: &Value| {
            let sampler = &animation["samplers"]
                [channel["sampler"].as_u64().expect("as glTF has it") as usize];
            let word = |word: &Value| word.as_str().map(str::to_owned);
            Track {
                node: channel["target"]["node"].as_u64().expect("an index") as usize,
                path: word(&channel["target"]["path"]).expect("a path"),
                interpolation: word(&sampler["interpolation"]).unwrap_or("LINEAR".to_owned()),
                times: self.numbers(&sampler["input"]),
                values: self.numbers(&sampler["output"]),
            }
        };
        channels.map(track).collect()
    }
}

#[test]
fn each_frame_shows_its_step_alone() {
    let workplace = Workplace::new();
    let file = export(&workplace, "--animate --fps 10");
    let nodes = file.json["nodes"].as_array().unwrap();
    assert_eq!(nodes.len(), 1 + 3 * 5 + 5);
    // One channel for each step, not for each object at each step.
    let tracks = file.tracks();
    assert_eq!(tracks.len(), 5);
    for frame in 0..5 {
        // A little after the beginning of the frame, for times are rounded.
        let now = frame as f32 / 10.0 + 0.01;
        let shown: BTreeSet<&str> = tracks
            .iter()
            .filter(|track| {
                let (path, how) = (track.path.as_str(), track.interpolation.as_str());
                assert_eq!((path, how), ("scale", "STEP"));
                let key = track.times.iter().rposition(|time| *time <= now);
                let scale = &track.values[3 * key.unwrap_or(0)..][..3];
                assert!(scale == [0.0; 3] || scale == [1.0; 3]);
                scale[0] == 1.0
            })
            .flat_map(|track| nodes[track.node]["children"].as_array().unwrap())
            .map(|child| {
                nodes[child.as_u64().unwrap() as usize]["name"]
                    .as_str()
                    .unwrap()
            })
            .collect();
        let expected = ["ball", "wall", "rod"].map(|name| format!("{name}_step00{frame}"));
        assert_eq!(
            shown,
            expected.iter().map(String::as_str).collect(),
            "{frame}"
        );
    }
    let extras = &file.json["animations"][0]["extras"];
    assert_eq!(extras["frames_per_second"], 10.0);
    assert_eq!(
        extras["proper_times"],
        serde_json::json!([-3.0, -1.5, 0.0, 1.5, 3.0])
    );
    // Without time there is none, and the rest is the same.
    let still = export(&workplace, "");
    assert!(still.json.get("animations").is_none());
    assert_eq!(still.json["nodes"], file.json["nodes"]);
}

/// Base and target add up to the step's photosurface, to within the rounding of its certificate.
#[test]
fn morph_targets_add_up_to_each_step() {
    let workplace = Workplace::new();
    let file = export(&workplace, "--animate=morph");
    let nodes = file.json["nodes"].as_array().unwrap();
    let names: Vec<_> = nodes
        .iter()
        .map(|node| node["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["observer", "ball", "wall", "rod"]);
    for (part, steps) in morphing(&placed()).iter().enumerate() {
        let node = &nodes[part + 1];
        let frames = node["extras"]["frames"].as_array().unwrap();
        let mesh = &file.json["meshes"][node["mesh"].as_u64().unwrap() as usize];
        assert_eq!(
            mesh["extras"]["targetNames"],
            serde_json::json!(["step001", "step002", "step003", "step004"])
        );
        let primitive = &mesh["primitives"][0];
        let targets = primitive["targets"].as_array().unwrap();
        assert_eq!((targets.len(), frames.len()), (4, 5));
        let offset = node["translation"].as_array().unwrap().iter();
        let offset = DVec3::from_slice(&offset.map(|x| x.as_f64().unwrap()).collect::<Vec<_>>());
        let base = [
            file.numbers(&primitive["attributes"]["POSITION"]),
            file.numbers(&primitive["attributes"]["NORMAL"]),
        ];
        for (step, surface) in steps.iter().enumerate() {
            assert_eq!(frames[step]["name"], surface.facts.name.as_str());
            assert_eq!(frames[step]["proper_time"], surface.facts.proper_time);
            let sum = |attribute: usize, name: &str| -> Vec<DVec3> {
                let mut sum = base[attribute].clone();
                if step > 0 {
                    let more = file.numbers(&targets[step - 1][name]);
                    sum.iter_mut()
                        .zip(more)
                        .for_each(|(sum, more)| *sum += more);
                }
                let triples = sum.chunks_exact(3);
                triples
                    .map(|v| DVec3::new(v[0].into(), v[1].into(), v[2].into()))
                    .collect()
            };
            let rounding = surface.facts.certificate.rounding;
            for (place, expected) in sum(0, "POSITION").into_iter().zip(surface.mesh.positions()) {
                let error = (offset + place).distance(*expected);
                assert!(
                    error <= rounding,
                    "{}: {error} {rounding}",
                    surface.facts.name
                );
            }
            let normals = surface.mesh.normals().expect("always there");
            for (normal, expected) in sum(1, "NORMAL").into_iter().zip(normals) {
                assert!(normal.distance(*expected) < 1e-6);
            }
        }
    }
    for track in file.tracks() {
        let (path, how) = (track.path.as_str(), track.interpolation.as_str());
        assert_eq!((path, how), ("weights", "LINEAR"));
        let frames: Vec<f32> = (0..5)
            .map(|frame| (f64::from(frame) / 24.0) as f32)
            .collect();
        assert_eq!(track.times, frames);
        for (frame, weights) in track.values.chunks_exact(4).enumerate() {
            let expected = [1, 2, 3, 4].map(|target| f32::from(u8::from(target == frame)));
            assert_eq!(weights, expected);
        }
    }
}

/// Every mesh has what was asked for, the marker too, and nothing else; it is what the library says.
#[test]
fn attributes_are_there_when_asked_for() {
    let workplace = Workplace::new();
    let attributes = |file: &Glb| -> Vec<BTreeSet<String>> {
        let meshes = file.json["meshes"].as_array().unwrap().iter();
        let names = |mesh: &Value| {
            let attributes = mesh["primitives"][0]["attributes"].as_object().unwrap();
            attributes
                .keys()
                .filter(|name| name.starts_with('_'))
                .cloned()
                .collect()
        };
        meshes.map(names).collect()
    };
    let none = export(&workplace, "");
    assert!(attributes(&none).iter().all(BTreeSet::is_empty));
    let file = export(
        &workplace,
        "--attributes radiance,doppler,rest_position,emission_time",
    );
    let all = [
        "_DOPPLER",
        "_EMISSION_TIME",
        "_RADIANCE",
        "_REST_X",
        "_REST_Y",
        "_REST_Z",
    ];
    for names in attributes(&file) {
        assert_eq!(names, all.map(str::to_owned).into());
    }
    // Vertices with attributes are measured by points.
    let placed = placed_scene(&SCENE.replacen('{', r#"{ "attributes": ["radiance"],"#, 1));
    let mut meshes = file.json["meshes"].as_array().unwrap().iter();
    let marker = &meshes.next().unwrap()["primitives"][0]["attributes"];
    for name in ["_DOPPLER", "_RADIANCE"] {
        assert!(
            file.numbers(&marker[name])
                .iter()
                .all(|factor| *factor == 1.0)
        );
    }
    let surfaces = (0..5).flat_map(|step| {
        placed
            .photosurfaces(step, SurfaceOptions::default())
            .unwrap()
    });
    for (mesh, surface) in meshes.zip(surfaces) {
        let attributes = &mesh["primitives"][0]["attributes"];
        let numbers = |name: &str| file.numbers(&attributes[name]);
        let object = placed
            .scene()
            .objects()
            .iter()
            .find(|object| object.name == surface.facts.object);
        let moment = placed.scene().moment(surface.facts.step).unwrap();
        let view = View::new(&moment, &object.unwrap().world_line());
        let [x, y, z] = ["_REST_X", "_REST_Y", "_REST_Z"].map(numbers);
        let (factors, times) = (numbers("_DOPPLER"), numbers("_EMISSION_TIME"));
        let radiances = numbers("_RADIANCE");
        for (vertex, seen) in surface.mesh.positions().iter().enumerate() {
            let rest = DVec3::new(x[vertex].into(), y[vertex].into(), z[vertex].into());
            let case = format!("{} vertex {vertex}", surface.facts.name);
            // The rest place in f32 is as good as f32, and stretched by at most the Doppler factor ahead.
            let reach = f64::from(f32::EPSILON) * view.relative_velocity().rapidity().exp();
            assert!(
                view.seen_position(rest).distance(*seen) <= reach * rest.length(),
                "{case}"
            );
            assert!(
                (f64::from(times[vertex]) + seen.length()).abs() <= 1e-6 * seen.length(),
                "{case}"
            );
            let factor = seen.length() / (rest - view.observer_rest()).length();
            assert!(
                (f64::from(factors[vertex]) / factor - 1.0).abs() < 1e-5,
                "{case}"
            );
            assert!(
                (f64::from(radiances[vertex]) / factor.powi(4) - 1.0).abs() < 4e-5,
                "{case}"
            );
        }
    }
    // A radiance that no number of the file can say is an error before any work, and fits into doubles.
    let flags = "--example sphere --steps 0 --rapidity 25 --attributes radiance";
    workplace
        .run(&format!("export {flags} -o out.glb"))
        .error(&["the radiance of vertex"]);
    let run = workplace.run(&format!("export {flags} -o out.ply --max-triangles 5000"));
    assert!(run.status < 2, "{run}");
    // The scene may ask for it, and the flag has the last word.
    workplace.write(
        "asks.json",
        SCENE.replacen('{', r#"{ "attributes": ["emission_time"],"#, 1),
    );
    for (flags, expected) in [("", "_EMISSION_TIME"), ("--attributes doppler", "_DOPPLER")] {
        workplace
            .run(&format!("export asks.json -o asks.glb {flags}"))
            .success();
        let json = glb_json(&workplace.read("asks.glb"));
        let attributes = json["meshes"][3]["primitives"][0]["attributes"]
            .as_object()
            .unwrap();
        let names: Vec<_> = attributes
            .keys()
            .filter(|name| name.starts_with('_'))
            .collect();
        assert_eq!(names, [expected]);
    }
    workplace
        .run("export asks.json -o asks.ply --attributes rest_position")
        .success();
    let ply = workplace.read("asks.ply");
    let header = String::from_utf8_lossy(&ply[..600]).into_owned();
    for property in [
        "float quality",
        "float rest_x",
        "float rest_y",
        "float rest_z",
    ] {
        assert!(header.contains(property), "{header}");
    }
}

#[test]
fn what_cannot_be_shown_is_refused() {
    let workplace = Workplace::new();
    for (flags, words) in [
        ("-o out.ply --animate", "a .ply has no time"),
        ("-o out.glb --steps 0 --animate", "one step"),
        ("-o out.glb --animate --fps 0", "--fps is 0"),
        ("-o out.glb --animate --fps -1", "--fps is -1"),
        ("-o out.glb --animate=loop", "frames, morph"),
        ("-o out.glb --animate --split", "--split"),
        ("-o out.glb --fps 12", "--animate"),
        ("-o out.glb --attributes colour", "rest_position, radiance"),
        (
            "-o out.glb --animate=morph --attributes doppler",
            "--animate=frames",
        ),
    ] {
        workplace.run(&format!("export {flags}")).error(&[words]);
    }
    assert!(workplace.files().is_empty());
}
