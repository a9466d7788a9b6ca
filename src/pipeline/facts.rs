//! What is said of scenes and photosurfaces in files and in the report.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use serde::{Serialize, Serializer};
use serde_json::{Value, json};

use crate::scene::Scene;
use crate::tessellate::Certificate;

/// What a photosurface is, in words and numbers: the same in files and in the report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Facts {
    /// Names it in files: unique there, without characters that a reader breaks.
    pub name: String,
    /// The object in the scene.
    pub object: String,
    /// The part of the object's model; empty where there is only one and it has no name.
    pub part: String,
    /// What else the source says of the part, as it says it.
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "as_it_is")]
    pub source: Option<Arc<Value>>,
    /// Which step, from 0.
    pub step: usize,
    /// Proper time of the observer at this step, from the observation event.
    pub proper_time: f64,
    /// Lorentz factor between object and observer.
    pub relative_gamma: f64,
    /// Rapidity between object and observer.
    pub relative_rapidity: f64,
    /// How many vertices it has.
    pub vertices: usize,
    /// How many triangles it has.
    pub triangles: usize,
    /// How many times an error of the source's coordinates, taken at rest, is magnified at most: the largest stretch
    /// at a vertex, from 1 to `exp(rapidity)`. A source with `f32` coordinates 1 in size is known to `6e-8`; with a
    /// condition of 2000 its photosurface is to `1.2e-4`, whatever the certificate says.
    pub condition: f64,
    /// How far it is from the true photosurface.
    pub certificate: Certificate,
}

fn as_it_is<S: Serializer>(source: &Option<Arc<Value>>, serializer: S) -> Result<S::Ok, S::Error> {
    source.as_deref().serialize(serializer)
}

/// What the scene is, in words and numbers: the same in files and in the report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneFacts {
    /// The scene's title.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// The program that made the file.
    pub generator: &'static str,
    /// Scene time of the observation event.
    pub observer_time: f64,
    /// Place of the observation event in the scene frame.
    pub observer_position: [f64; 3],
    /// Direction of the observer's motion in the scene frame, at the observation event.
    pub observer_direction: [f64; 3],
    /// The observer's speed in the scene frame, at the observation event.
    pub observer_beta: f64,
    /// The observer's Lorentz factor in the scene frame, at the observation event.
    pub observer_gamma: f64,
    /// The observer's rapidity in the scene frame, at the observation event.
    pub observer_rapidity: f64,
    /// Proper times of the steps, from the observation event.
    pub steps: Vec<f64>,
    /// What the sources say of themselves as a whole, as they say it: for each that does, the names of its `objects` and
    /// its `copyright` and `extras`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sources: Vec<Value>,
}

impl SceneFacts {
    /// `origins` say of each object what its source says of itself.
    pub(super) fn new(scene: &Scene, origins: &[Option<Arc<Value>>]) -> Self {
        let observer = scene.observer();
        Self {
            title: scene.title().map(str::to_owned),
            generator: concat!("photosurface ", env!("CARGO_PKG_VERSION")),
            observer_time: observer.time.get(),
            observer_position: observer.position.get().to_array(),
            observer_direction: observer.velocity.direction().to_array(),
            observer_beta: observer.velocity.beta(),
            observer_gamma: observer.velocity.gamma(),
            observer_rapidity: observer.velocity.rapidity(),
            steps: scene.steps().to_vec(),
            sources: sources(scene, origins),
        }
    }

    /// To whom the sources belong, each once; `None` where none says it.
    pub fn copyright(&self) -> Option<String> {
        let named = |source: &Value| Some(source.get("copyright")?.as_str()?.to_owned());
        let mut known = HashSet::new();
        let all = self.sources.iter().filter_map(named);
        let all: Vec<String> = all.filter(|text| known.insert(text.clone())).collect();
        (!all.is_empty()).then(|| all.join("; "))
    }
}

/// What sources say of themselves, once for all objects of a source.
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
