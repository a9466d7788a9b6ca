//! What the viewer of a page is told of a scene.

use glam::DVec3;
use serde::Serialize;

use super::ghosts::ghost_color;
use super::page::{PageError, PageSettings};
use super::pictures::first_view;
use crate::effects::{Doppler, ShaderTable};
use crate::pipeline::PlacedScene;
use crate::render::{HeadLight, PictureOptions, Projection};
use crate::scene::{Object, Observer, Source};
use crate::shape::{Color, Shape};
use crate::spacetime::{Segment, Steering, ViewModel};

/// The vertical field of view, in degrees, in which the viewer shows what a picture shows in more or less: one can fly in it.
const FIELDS_OF_VIEW_DEG: (f64, f64) = (40.0, 80.0);

/// A scene as the viewer reads it; `src/page/data.js` says the same in its own words.
#[derive(Debug, Serialize)]
pub(super) struct PageData {
    version: &'static str,
    title: String,
    input: String,
    observer: ObserverData,
    flight: Vec<SegmentData>,
    steps: Vec<f64>,
    marker: Option<f64>,
    camera: CameraData,
    effects: EffectsData,
    model: ViewModel,
    lamps: usize,
    background: Color,
    objects: Vec<ObjectData>,
    shading: HeadLight,
    ghosts: GhostColors,
    colors: ColorsData,
}

#[derive(Debug, Serialize)]
struct ObserverData {
    time: f64,
    position: DVec3,
    rapidity: f64,
    direction: DVec3,
    orientation: [f64; 4],
}

#[derive(Debug, Serialize)]
struct SegmentData {
    proper_time: f64,
    acceleration: DVec3,
    turn_rate: DVec3,
    steer: &'static str,
}

#[derive(Debug, Serialize)]
struct CameraData {
    fov_deg: f64,
    look: DVec3,
}

#[derive(Debug, Serialize)]
struct EffectsData {
    doppler: &'static str,
    searchlight: bool,
    exposure: f64,
}

#[derive(Debug, Serialize)]
struct ObjectData {
    name: String,
    nodes: Vec<String>,
    position: DVec3,
    rapidity: f64,
    direction: DVec3,
    model: Option<ViewModel>,
    shape: Option<Shape>,
    rotation: [f64; 4],
    scale: DVec3,
    emission: Option<EmissionData>,
}

#[derive(Debug, Serialize)]
struct EmissionData {
    kelvin: f64,
    luminance: f64,
}

#[derive(Debug, Serialize)]
struct GhostColors {
    seen: Color,
    delayed: Color,
    contracted: Color,
    rest: Color,
}

#[derive(Debug, Serialize)]
struct ColorsData {
    side: usize,
    factors: usize,
    log2_from: f64,
    log2_to: f64,
    scale: f64,
    white: WhiteData,
    ramp: RampData,
    daylight_kelvin: f64,
}

#[derive(Debug, Serialize)]
struct WhiteData {
    log2_from: f64,
    log2_to: f64,
    light: Vec<[f32; 4]>,
}

#[derive(Debug, Serialize)]
struct RampData {
    log2_from: f64,
    log2_to: f64,
    colors: Vec<[f32; 3]>,
}

impl PageData {
    /// What is to be said of a scene, whose meshes are those of `at_rest`.
    pub(super) fn new(
        placed: &PlacedScene,
        at_rest: &PlacedScene,
        table: &ShaderTable,
        settings: &PageSettings,
    ) -> Result<Self, PageError> {
        let scene = placed.scene();
        let observer = scene.observer();
        let effects = scene.effects();
        let nodes = at_rest.objects().map(|(_, parts)| parts);
        let objects = scene.objects().iter().zip(nodes).map(|(object, parts)| {
            let nodes = parts.iter().map(|(name, _)| name.clone()).collect();
            ObjectData::new(object, nodes)
        });
        let objects: Vec<_> = objects.collect();
        let first = first_view(placed, &settings.textures)?;
        let names: Vec<&str> = scene.objects().iter().map(|object| &*object.name).collect();
        let title = scene
            .title()
            .map_or_else(|| names.join(", "), str::to_owned);
        Ok(Self {
            version: env!("CARGO_PKG_VERSION"),
            title,
            input: settings.input.clone(),
            observer: ObserverData::new(observer),
            flight: observer.flight.iter().map(SegmentData::new).collect(),
            steps: scene.steps().to_vec(),
            marker: observer.marker.map(|radius| radius.get()),
            camera: CameraData {
                fov_deg: match first.projection {
                    Projection::Perspective { vertical_fov_deg } => {
                        vertical_fov_deg.clamp(FIELDS_OF_VIEW_DEG.0, FIELDS_OF_VIEW_DEG.1)
                    }
                    Projection::Stereographic { .. } | Projection::FullSky => FIELDS_OF_VIEW_DEG.1,
                },
                look: first.look,
            },
            effects: EffectsData {
                doppler: match effects.doppler {
                    Doppler::None => "none",
                    Doppler::Spectrum(_) => "spectrum",
                    Doppler::Ramp => "ramp",
                },
                searchlight: effects.searchlight,
                exposure: first.exposure.get(),
            },
            model: ViewModel::Seen,
            lamps: scene.lamps().len(),
            background: PictureOptions::default().background,
            objects,
            shading: HeadLight::TABLES,
            ghosts: GhostColors {
                seen: ghost_color(ViewModel::Seen),
                delayed: ghost_color(ViewModel::Delayed),
                contracted: ghost_color(ViewModel::Contracted),
                rest: ghost_color(ViewModel::Rest),
            },
            colors: ColorsData::new(table),
        })
    }

    pub(super) fn title(&self) -> &str {
        &self.title
    }

    pub(super) fn to_json(&self) -> String {
        serde_json::to_string(self).expect("numbers and strings are JSON")
    }
}

impl ObserverData {
    fn new(observer: &Observer) -> Self {
        Self {
            time: observer.time.get(),
            position: observer.position.get(),
            rapidity: observer.velocity.rapidity(),
            direction: observer.velocity.direction(),
            orientation: observer.orientation.get().to_array(),
        }
    }
}

impl SegmentData {
    fn new(segment: &Segment) -> Self {
        let (turn_rate, steer) = match segment.steering() {
            Steering::Free { turn_rate } => (turn_rate, "free"),
            Steering::Coordinated => (DVec3::ZERO, "coordinated"),
        };
        Self {
            proper_time: segment.proper_time(),
            acceleration: segment.acceleration(),
            turn_rate,
            steer,
        }
    }
}

impl ObjectData {
    fn new(object: &Object, nodes: Vec<String>) -> Self {
        let shape = match &object.source {
            Source::Shape(shape, _) => is_round(shape).then(|| shape.clone()),
            Source::File(_) | Source::Model(_) => None,
        };
        Self {
            name: object.name.clone(),
            nodes,
            position: object.position.get(),
            rapidity: object.velocity.rapidity(),
            direction: object.velocity.direction(),
            model: object.model,
            shape,
            rotation: object.rotation.get().to_array(),
            scale: object.scale.get(),
            emission: object.emission.map(|emission| EmissionData {
                kelvin: emission.temperature().kelvin(),
                luminance: emission.luminance(),
            }),
        }
    }
}

impl ColorsData {
    fn new(table: &ShaderTable) -> Self {
        let [log2_from, log2_to] = table.octaves;
        let [white_from, white_to] = table.white_octaves;
        let [ramp_from, ramp_to] = table.ramp_octaves;
        Self {
            side: table.side,
            factors: table.factors,
            log2_from,
            log2_to,
            scale: table.scale,
            white: WhiteData {
                log2_from: white_from,
                log2_to: white_to,
                light: table
                    .white
                    .iter()
                    .map(|row| row.map(|part| part as f32))
                    .collect(),
            },
            ramp: RampData {
                log2_from: ramp_from,
                log2_to: ramp_to,
                colors: table
                    .ramp
                    .iter()
                    .map(|row| row.map(|part| part as f32))
                    .collect(),
            },
            daylight_kelvin: table.daylight_kelvin,
        }
    }
}

/// Whether the facets of a shape stand for a curved surface.
fn is_round(shape: &Shape) -> bool {
    match shape {
        Shape::Cuboid(_) | Shape::Grid(_) | Shape::Lattice(_) => false,
        Shape::Sphere(_)
        | Shape::Cylinder(_)
        | Shape::Cone(_)
        | Shape::Rod(_)
        | Shape::Torus(_) => true,
    }
}
