//! A scene with a small mesh and the flags of a command, out of any bytes.
//!
//! The scene is JSON and the mesh is OBJ, as a user would have them: what goes wrong here goes wrong with the command,
//! and `cargo run -p photosurface-fuzz --example show` writes the files that show it.

use std::fmt::Write;
use std::path::Path;

use photosurface::pipeline::PlacedSceneError;
use photosurface::write::Format;
use photosurface::{PlacedScene, Scene, load_models};
use serde_json::{Value, json};

use super::given::Given;

/// The name of the mesh in the folder of the scene.
const MESH: &str = "mesh.obj";

/// What a command is given.
pub struct Case {
    /// The scene, as its file has it.
    pub scene: Value,
    /// The mesh that its objects name, as OBJ.
    pub mesh: String,
    /// What is written.
    pub format: Format,
    /// How steps follow each other: "frames" or "morph".
    pub animate: Option<&'static str>,
    /// Whether meshes are refined.
    pub subdivide: bool,
    /// Most triangles of all photosurfaces.
    pub budget: u64,
    /// The picture that is taken.
    pub picture: Picture,
}

/// The picture of a scene that is taken.
pub struct Picture {
    /// Pixels in a row, and rows.
    pub size: [u32; 2],
    /// Rays a pixel along each side.
    pub samples: u32,
    /// Field of view in degrees; the full sky without it.
    pub fov: Option<f64>,
    /// Where the camera looks.
    pub look: [f64; 3],
    /// Where the camera is, if it is outside; the observer's place without it.
    pub from: Option<[f64; 3]>,
    /// Whether photosurfaces are looked at where light could be followed.
    pub by_mesh: bool,
    /// Whether edges are drawn.
    pub wireframe: bool,
}

impl Case {
    /// The case that `bytes` stand for: there is one for any.
    pub fn new(bytes: &[u8]) -> Self {
        let given = &mut Given::new(bytes);
        let format = [Format::Glb, Format::Gltf, Format::Ply][usize::from(given.choice(3))];
        let animate = [None, Some("frames"), Some("morph")][usize::from(given.choice(3))];
        let subdivide = given.choice(8) != 7;
        let budget = u64::from(given.byte()) * 8;
        let picture = Picture::new(given);
        let attributes = given.choice(8);
        let names = ["doppler", "emission_time", "rest_position"];
        let attributes: Vec<_> = (0..3)
            .filter(|bit| attributes & (1 << bit) != 0)
            .map(|bit| names[bit])
            .collect();
        let mut observer = json!({
            "time": given.number(), "position": given.vector(), "velocity": velocity(given),
        });
        let marker = given.byte();
        if marker % 4 == 3 {
            observer["marker"] = given.length().into();
        }
        // Coarser than where nothing is said: most cases are done in a few milliseconds.
        let asked = tolerance(given).unwrap_or_else(|| json!({ "relative": 0.05 }));
        let steps: Vec<f64> = (0..=given.choice(3)).map(|_| given.number()).collect();
        let objects = 0..=given.choice(3);
        let objects: Vec<_> = objects
            .map(|index| object(given, index, &observer))
            .collect();
        let mut scene = json!({
            "observer": observer, "steps": steps, "tolerance": asked, "objects": objects,
        });
        if !attributes.is_empty() {
            scene["attributes"] = json!(attributes);
        }
        let mesh = mesh(given);
        // Last, so that what bytes stand for stays as it was before there were flights.
        let flight: Vec<_> = (0..given.choice(4)).map(|_| segment(given)).collect();
        if !flight.is_empty() {
            scene["observer"]["flight"] = flight.into();
            scene["observer"]["integrator"] = match given.choice(4) {
                0 => json!({ "euler": given.length() }),
                1 => json!({ "rk4": given.length() }),
                _ => json!("exact"),
            };
        }
        // After flights for the same reason.
        light(given, &mut scene);
        Self {
            scene,
            mesh,
            format,
            animate,
            subdivide,
            budget,
            picture,
        }
    }

    /// The scene with its geometry, if it is one that the program takes; its files go to `folder`.
    pub fn placed(&self, folder: &Path) -> Option<PlacedScene> {
        let scene = Scene::from_json(&self.scene.to_string()).ok()?;
        if self.scene.to_string().contains(MESH) {
            std::fs::write(folder.join(MESH), &self.mesh).expect("a temporary folder takes a file");
        }
        let (models, _) = load_models(&scene, folder).ok()?;
        match PlacedScene::new(scene, models) {
            // Without contraction an object may be too fast, or longer than any number.
            Err(PlacedSceneError::Delayed { .. } | PlacedSceneError::Reach { .. }) => None,
            placed => Some(placed.expect("one model an object")),
        }
    }

    /// The flags of `photosurface export` that do the same.
    pub fn export_flags(&self) -> String {
        let extension = match self.format {
            Format::Glb => "glb",
            Format::Gltf => "gltf",
            Format::Ply => "ply",
        };
        let mut flags = format!("-o out.{extension} --max-triangles {}", self.budget);
        if !self.subdivide {
            flags += " --no-subdivide";
        }
        if let Some(animate) = self.animate.filter(|_| self.format != Format::Ply) {
            flags = flags + " --animate=" + animate;
        }
        flags
    }

    /// The flags of `photosurface render` that do the same.
    pub fn render_flags(&self) -> String {
        let Picture {
            size: [mut width, height],
            samples,
            look: [x, y, z],
            ..
        } = self.picture;
        if self.picture.fov.is_none() {
            // The command has the whole sky in this shape alone.
            width = 2 * height;
        }
        let mut flags =
            format!("--size {width}x{height} --samples {samples} --look={x:?},{y:?},{z:?}");
        flags += &match self.picture.fov {
            Some(fov) => format!(" --fov {fov:?}"),
            None => " --full-sky".to_owned(),
        };
        match self.picture.from {
            Some([x, y, z]) => flags += &format!(" --view outside --from={x:?},{y:?},{z:?}"),
            None if self.picture.by_mesh => flags += " --method mesh",
            None => return flags,
        }
        flags + &format!(" --max-triangles {}", self.budget)
    }
}

impl Picture {
    fn new(given: &mut Given<'_>) -> Self {
        let kind = given.byte();
        Self {
            size: [0, 4].map(|shift| u32::from((kind >> shift) % 12) + 1),
            samples: u32::from(given.choice(2)) + 1,
            fov: Some(given.number()).filter(|&fov| fov != 0.0).map(f64::abs),
            look: given.vector(),
            from: (given.choice(3) == 2).then(|| given.vector()),
            by_mesh: given.choice(2) == 1,
            wireframe: given.choice(2) == 1,
        }
    }
}

/// A velocity in one of its forms, most often one that there is.
fn velocity(given: &mut Given<'_>) -> Value {
    let form = given.choice(6);
    if form == 0 {
        return json!([0, 0, 0]);
    }
    if form == 1 {
        return json!(given.vector());
    }
    let name = ["beta", "rapidity", "gamma", "one_minus_beta"][usize::from(form) - 2];
    let number = given.number().abs();
    json!({ name: number, "direction": given.vector() })
}

fn tolerance(given: &mut Given<'_>) -> Option<Value> {
    let unit = ["relative", "absolute", "angle_deg"];
    match given.choice(4) {
        0 => None,
        kind => Some(json!({ unit[usize::from(kind) - 1]: given.length() })),
    }
}

/// Models, effects on light, black bodies and lamps.
fn light(given: &mut Given<'_>, scene: &mut Value) {
    let models = [None, Some("delayed"), Some("contracted"), Some("rest")];
    if let Some(model) = models[usize::from(given.choice(4))] {
        scene["model"] = model.into();
    }
    let doppler = [None, Some(json!("spectrum")), Some(json!("ramp"))];
    let doppler = doppler.into_iter().nth(given.choice(3).into()).flatten();
    if let Some(doppler) = doppler {
        scene["effects"] = json!({ "doppler": doppler });
    }
    if given.choice(2) == 1 {
        scene["effects"]["searchlight"] = true.into();
    }
    if given.choice(4) == 1 {
        scene["objects"][0]["emission"] = json!({ "kelvin": given.length() });
    }
    let lamps: Vec<_> = (0..given.choice(3)).map(|_| lamp(given)).collect();
    if !lamps.is_empty() {
        scene["lamps"] = lamps.into();
    }
}

/// A lamp of one of its kinds.
fn lamp(given: &mut Given<'_>) -> Value {
    let mut lamp = match given.choice(4) {
        0 => json!({ "sun": { "direction": given.vector(), "irradiance": given.length() } }),
        1 => json!({ "ambient": { "irradiance": given.length() } }),
        kind => {
            let mut lamp =
                json!({ "point": { "position": given.vector(), "intensity": given.length() } });
            match kind {
                2 => lamp["object"] = "object0".into(),
                _ => lamp["velocity"] = velocity(given),
            }
            if given.choice(3) == 1 {
                lamp["flash"] = json!({ "from": given.number(), "to": given.number() });
            }
            lamp
        }
    };
    if given.choice(2) == 1 {
        lamp["kelvin"] = given.length().into();
    }
    lamp
}

/// A segment of a flight.
fn segment(given: &mut Given<'_>) -> Value {
    let mut segment = json!({ "proper_time": given.length(), "acceleration": given.vector() });
    match given.choice(4) {
        0 => segment["turn_rate"] = json!(given.vector()),
        1 => segment["steer"] = "coordinated".into(),
        _ => {}
    }
    segment
}

fn object(given: &mut Given<'_>, index: u8, observer: &Value) -> Value {
    let kind = given.choice(12);
    let mut object = json!({
        "name": format!("object{index}"),
        "position": given.vector(),
        "velocity": match given.choice(3) {
            0 => json!([0, 0, 0]),
            1 => observer["velocity"].clone(),
            _ => velocity(given),
        },
    });
    match given.choice(4) {
        0 | 1 => {}
        2 => object["scale"] = given.length().into(),
        _ => object["scale"] = json!([given.length(), given.length(), given.length()]),
    }
    if given.choice(2) == 1 {
        let turn = [
            given.number(),
            given.number(),
            given.number(),
            given.number(),
        ];
        let length = turn.iter().fold(0.0, |sum: f64, part| sum.hypot(*part));
        object["rotation"] = json!(turn.map(|part| part / length));
    }
    if let Some(tolerance) = tolerance(given) {
        object["tolerance"] = tolerance;
    }
    let shape = match kind {
        0 => json!({ "sphere": { "radius": given.length() } }),
        1 => json!({ "box": { "size": [given.length(), given.length(), given.length()] } }),
        2 => json!({ "cylinder": { "radius": given.length(), "height": given.length() } }),
        3 => json!({ "cone": { "radius": given.length(), "height": given.length() } }),
        4 => json!({ "torus": { "major_radius": given.length(), "minor_radius": given.length() } }),
        5 => json!({ "rod": { "length": given.length(), "radius": given.length() } }),
        6 => json!({ "grid": { "size": given.length(), "cells": given.choice(6) } }),
        7 => json!({ "lattice": {
            "cells": given.choice(4), "spacing": given.length(), "thickness": given.length(),
        } }),
        _ => {
            object["file"] = MESH.into();
            return object;
        }
    };
    object["shape"] = shape;
    if given.choice(4) == 3 {
        object["checker"] = "#336699".into();
    }
    object
}

/// A few triangles between a few corners.
fn mesh(given: &mut Given<'_>) -> String {
    let corners = 3 + given.choice(8);
    let mut text = String::new();
    let mut line = |arguments: std::fmt::Arguments<'_>| {
        text.write_fmt(arguments).expect("a string takes any text");
    };
    for _ in 0..corners {
        let [x, y, z] = given.vector();
        line(format_args!("v {x:?} {y:?} {z:?}\n"));
    }
    for face in 0..=given.choice(12) {
        let mut corner = || given.byte() % corners + 1;
        // Where nothing is said, each corner has a face.
        let [a, b, c] = [face, face + 1, face + 2].map(|place| (place + corner()) % corners + 1);
        line(format_args!("f {a} {b} {c}\n"));
    }
    text
}
