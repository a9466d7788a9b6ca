//! The facts about scenes and photosurfaces that files and the report contain.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Serialize, Serializer};
use serde_json::{Value, json};

use super::{Bounds, MomentFacts};
use crate::scene::Scene;
use crate::spacetime::{Integrator, Rotation, Segment, Steering, ViewModel};
use crate::tessellate::Certificate;

/// The facts about a photosurface, the same in files and in the report.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Facts {
    /// The name of the photosurface in files: unique there, and without characters that a reading program replaces.
    pub name: String,
    /// The object in the scene.
    pub object: String,
    /// Which effects of special relativity the shape is shown with; absent for a photosurface, which has them all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<ViewModel>,
    /// How far files move the photosurface in the observer's frame, in scene units, so that it stands beside others; absent
    /// where it stays.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beside: Option<[f64; 3]>,
    /// The part of the object's model; empty where there is only one and it has no name.
    pub part: String,
    /// The `extras` of the part in the source, unchanged.
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "as_it_is")]
    #[schemars(with = "Option<Value>")]
    pub source: Option<Arc<Value>>,
    /// The light of the object if it is a black body, as scenes write it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub emission: Option<Value>,
    /// The step, counted from 0.
    pub step: usize,
    /// Proper time of the observer at this step, counted from the observation event, in scene units.
    pub proper_time: f64,
    /// The observer at this step, if it flies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub observer: Option<MomentFacts>,
    /// Lorentz factor of the observer's velocity in the object's rest frame, at this step.
    pub relative_gamma: f64,
    /// Rapidity of the observer's velocity in the object's rest frame, at this step.
    pub relative_rapidity: f64,
    /// Number of vertices.
    pub vertices: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// The box around the vertices, in the observer's frame, before files move the photosurface beside others.
    pub bounds: Bounds,
    /// The tolerance that was asked for, as flags write it: `0.001`, `abs:0.01`, `deg:0.02`. The certificate has its
    /// length or angle.
    pub tolerance: String,
    /// How many times, at most, the photosurface map magnifies an error of the source's coordinates in the rest frame:
    /// the largest stretch at a vertex, from 1 to `exp(rapidity)`. For example, the `f32` coordinates of a source of
    /// size 1 are known to `6e-8`; with a condition of 2000 its photosurface is known to `1.2e-4`. The certificate does
    /// not include this error.
    pub condition: f64,
    /// The proven bounds on the distance from the true photosurface.
    pub certificate: Certificate,
}

fn as_it_is<S: Serializer>(source: &Option<Arc<Value>>, serializer: S) -> Result<S::Ok, S::Error> {
    source.as_deref().serialize(serializer)
}

/// The facts about the scene, the same in files and in the report.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SceneFacts {
    /// The scene's title.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// The unit of length in metres, if the scene says what its units are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit_length_m: Option<f64>,
    /// The program that made the file.
    pub generator: &'static str,
    /// Scene time of the observation event.
    pub observer_time: f64,
    /// Position of the observation event in the scene frame.
    pub observer_position: [f64; 3],
    /// Direction of the observer's motion in the scene frame, at the observation event.
    pub observer_direction: [f64; 3],
    /// The observer's speed in the scene frame, at the observation event.
    pub observer_beta: f64,
    /// The observer's Lorentz factor in the scene frame, at the observation event.
    pub observer_gamma: f64,
    /// The observer's rapidity in the scene frame, at the observation event.
    pub observer_rapidity: f64,
    /// Rotation of the observer's own axes after the boost, at the observation event: a unit quaternion; the
    /// identity if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub observer_orientation: Option<[f64; 4]>,
    /// The segments of the observer's flight, counted from the observation event; none if the observer coasts.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub observer_flight: Vec<SegmentFacts>,
    /// How the flight is computed, as scenes write it; "exact" if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub observer_integrator: Option<Value>,
    /// The effects that the scene calls for beside shapes, as scenes write them; none if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub effects: Option<Value>,
    /// Proper times of the observer at the steps, counted from the observation event, in scene units.
    pub steps: Vec<f64>,
    /// For each source that has a copyright or `extras` of its own: the names of the `objects` that use it, its
    /// `copyright` and its `extras`, unchanged.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sources: Vec<Value>,
}

/// A segment of a flight, as scenes write it, in scene units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SegmentFacts {
    /// Duration in the observer's proper time.
    pub proper_time: f64,
    /// Proper acceleration in the observer's own axes.
    pub acceleration: [f64; 3],
    /// Turn rate in the observer's own axes, in radians; none for coordinated steering, where it follows from the
    /// acceleration.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turn_rate: Option<[f64; 3]>,
    /// "free" or "coordinated".
    pub steer: &'static str,
}

impl SegmentFacts {
    fn new(segment: &Segment) -> Self {
        let (turn_rate, steer) = match segment.steering() {
            Steering::Free { turn_rate } => (Some(turn_rate.to_array()), "free"),
            Steering::Coordinated => (None, "coordinated"),
        };
        Self {
            proper_time: segment.proper_time(),
            acceleration: segment.acceleration().to_array(),
            turn_rate,
            steer,
        }
    }
}

impl SceneFacts {
    /// The facts about `scene`; `origins` has the copyright and `extras` of each object's source.
    pub(super) fn new(scene: &Scene, origins: &[Option<Arc<Value>>]) -> Self {
        let observer = scene.observer();
        Self {
            title: scene.title().map(str::to_owned),
            unit_length_m: scene.units().map(|units| units.length_m()),
            generator: concat!("photosurface ", env!("CARGO_PKG_VERSION")),
            observer_time: observer.time.get(),
            observer_position: observer.position.get().to_array(),
            observer_direction: observer.velocity.direction().to_array(),
            observer_beta: observer.velocity.beta(),
            observer_gamma: observer.velocity.gamma(),
            observer_rapidity: observer.velocity.rapidity(),
            observer_orientation: (observer.orientation != Rotation::IDENTITY)
                .then(|| observer.orientation.get().to_array()),
            observer_flight: observer.flight.iter().map(SegmentFacts::new).collect(),
            observer_integrator: match observer.integrator {
                Integrator::Exact => None,
                Integrator::Euler(step) => Some(json!({ "euler": step.get() })),
                Integrator::RungeKutta4(step) => Some(json!({ "rk4": step.get() })),
            },
            effects: scene
                .effects()
                .is_some()
                .then(|| scene.effects().to_value()),
            steps: scene.steps().to_vec(),
            sources: sources(scene, origins),
        }
    }

    /// The copyright notices of all sources, each once; `None` if no source has one.
    pub fn copyright(&self) -> Option<String> {
        let named = |source: &Value| Some(source.get("copyright")?.as_str()?.to_owned());
        let mut known = HashSet::new();
        let all = self.sources.iter().filter_map(named);
        let all: Vec<String> = all.filter(|text| known.insert(text.clone())).collect();
        (!all.is_empty()).then(|| all.join("; "))
    }
}

/// The copyright and `extras` of each source, once for all objects that use it.
fn sources(scene: &Scene, origins: &[Option<Arc<Value>>]) -> Vec<Value> {
    let mut places: HashMap<*const Value, usize> = HashMap::new();
    let mut sources: Vec<(Vec<&str>, &Arc<Value>)> = vec![];
    for (object, origin) in scene.objects().iter().zip(origins) {
        let Some(origin) = origin else {
            continue;
        };
        let place = *places.entry(Arc::as_ptr(origin)).or_insert(sources.len());
        if place == sources.len() {
            sources.push((vec![], origin));
        }
        sources[place].0.push(&object.name);
    }
    let said = |(objects, origin): (Vec<&str>, &Arc<Value>)| {
        let mut source = json!({ "objects": objects });
        for (name, value) in origin.as_object().into_iter().flatten() {
            source[name.as_str()] = value.clone();
        }
        source
    };
    sources.into_iter().map(said).collect()
}
