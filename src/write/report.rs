//! The report: what was made, in words and numbers, for programs that read no `extras`.

use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema};
use serde::{Serialize, Serializer};

use super::Seal;
use crate::pipeline::{Facts, SceneFacts};

/// What was made, of what, and how long it took.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Report {
    /// The scene.
    pub scene: SceneFacts,
    /// Every photosurface written, in the order of steps and scene.
    pub objects: Vec<Facts>,
    /// The stages that ran, in their order; what is not named was not done. Empty in a report without times.
    pub stages: Vec<StageTime>,
    /// What the photosurfaces were made of, and by which command.
    #[serde(flatten)]
    pub provenance: Provenance,
    /// The files written, in their order; the data of a `.gltf` comes after it.
    pub outputs: Vec<OutputFile>,
    /// The files that were finished before, and were not made anew; `objects` has none of their photosurfaces.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub resumed: Vec<String>,
    /// By what a later run knows that the report and its file are finished, where they may be resumed.
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "as_text")]
    #[schemars(with = "Option<String>")]
    pub seal: Option<Seal>,
}

fn as_text<S: Serializer>(seal: &Option<Seal>, serializer: S) -> Result<S::Ok, S::Error> {
    let text = seal.as_ref().map(Seal::text);
    text.serialize(serializer)
}

/// What something was made of, and how.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Provenance {
    /// The version of the program.
    pub version: &'static str,
    /// The command line: the program, then each argument; empty where the library was called.
    pub command: Vec<String>,
    /// The files that were read, as they were named: scene, meshes, and the files that those refer to; "-" for stdin.
    pub inputs: Vec<String>,
}

impl Default for Provenance {
    /// This version of the library, without a command and files.
    fn default() -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            command: vec![],
            inputs: vec![],
        }
    }
}

/// A file that was written.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct OutputFile {
    /// Its path, as it was named; "-" for stdout.
    pub file: String,
    /// Its length.
    pub bytes: u64,
}

/// How long a stage took.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct StageTime {
    /// Which stage.
    pub name: &'static str,
    /// Wall clock. Where stages overlap, that of the one which the others waited for: together they are what the
    /// whole took.
    pub seconds: f64,
}

impl Report {
    /// The report as JSON text.
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("a report is names and numbers")
    }

    /// The JSON Schema of [`Report::to_json`].
    pub fn json_schema() -> Schema {
        schema_of::<Self>()
    }
}

/// The JSON Schema of what the program writes.
pub(crate) fn schema_of<T: JsonSchema>() -> Schema {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    settings.into_generator().into_root_schema_for::<T>()
}
