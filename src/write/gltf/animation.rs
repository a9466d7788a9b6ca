//! Steps that follow each other in time: key frames of scales, or morph targets and their weights.
//!
//! What Blender, three.js and VTK play, found by trying: `KHR_node_visibility` and several scenes are read by
//! next to no one, while a scale of 0 hides and morph targets morph in all three.

use gltf::json::validation::Checked;
use gltf::json::{self, Index, animation};
use serde_json::{Value, json};

use super::document::{AccessorRole, Document};
use super::file::GltfFile;
use super::tracks::{Keys, Tracks};
use crate::mesh::Mesh;
use crate::pipeline::{Facts, Photosurface, step_label};
use crate::write::WriteError;
use crate::write::layer::Layer;
use crate::write::pack::Bounds;

impl GltfFile<'_> {
    /// Shows a node during the frame of its step alone.
    pub(super) fn show_during_its_frame(
        &mut self,
        node: Index<json::Node>,
        frame: usize,
        frames_per_second: f64,
    ) -> Result<(), WriteError> {
        let keys = match self.tracks.keys.get(&frame) {
            Some(keys) => *keys,
            None => {
                let at = |frame: usize| [(frame as f64 / frames_per_second) as f32];
                let (hidden, shown) = ([0.0; 3], [1.0; 3]);
                let mut times = vec![at(frame)];
                let mut scales = vec![shown];
                if frame > 0 {
                    times.insert(0, at(0));
                    scales.insert(0, hidden);
                }
                if frame + 1 < self.scene.steps.len() {
                    times.push(at(frame + 1));
                    scales.push(hidden);
                }
                self.keys(frame, &times, &scales)?
            }
        };
        let property = animation::Property::Scale;
        self.track(node, property, keys, animation::Interpolation::Step);
        Ok(())
    }

    /// One node for a part whose photosurfaces, one for each step, have the same triangles: a morph target for each
    /// step after the first, between which it moves evenly; at the frame of a step it is that step's photosurface.
    ///
    /// # Errors
    ///
    /// No photosurfaces, a mesh without triangles, steps of different triangles or kinds of vectors, a number that `f32`
    /// cannot hold, or the writer fails.
    pub fn add_morphing(&mut self, steps: &[Photosurface]) -> Result<(), WriteError> {
        let Some(first) = steps.first() else {
            return Err(WriteError::Empty("of no step".to_owned()));
        };
        let name = name_of_part(first);
        self.check_step(first)?;
        if let Some(other) = steps
            .iter()
            .find(|step| !can_morph(&first.mesh, &step.mesh))
        {
            return Err(WriteError::Morph {
                name: name.to_owned(),
                step: other.facts.step,
            });
        }
        let meshes: Vec<_> = steps.iter().map(|step| &step.mesh).collect();
        // What the source says is that of all frames.
        let frame = |step: &Photosurface| Facts {
            source: None,
            ..step.facts.clone()
        };
        let mut extras = json!({
            "name": name,
            "object": first.facts.object,
            "part": first.facts.part,
            "frames": steps.iter().map(frame).collect::<Vec<_>>(),
        });
        if let Some(source) = &first.facts.source {
            extras["source"] = Value::clone(source);
        }
        let layer = Layer {
            name,
            ..Layer::from(first)
        };
        let node = self.add_node(&layer, &meshes, &[], Some(extras))?;
        self.step_nodes.add(None, node);
        let Some(playback) = self.playback() else {
            return Ok(());
        };
        let targets = steps.len() - 1;
        let keys = match self.tracks.keys.get(&targets) {
            Some(keys) => *keys,
            None => {
                let at = |frame| [(frame as f64 / playback.frames_per_second()) as f32];
                let times: Vec<_> = (0..=targets).map(at).collect();
                let weight = |frame| (1..=targets).map(move |target| [f32::from(target == frame)]);
                let weights: Vec<[f32; 1]> = (0..=targets).flat_map(weight).collect();
                self.keys(targets, &times, &weights)?
            }
        };
        let property = animation::Property::MorphTargetWeights;
        self.track(node, property, keys, animation::Interpolation::Linear);
        Ok(())
    }

    /// Makes the animation of the tracks.
    ///
    /// # Errors
    ///
    /// The file cannot be written.
    pub(super) fn animate(&mut self, frames_per_second: f64) -> Result<(), WriteError> {
        let tracks = std::mem::take(&mut self.tracks);
        self.document.animation(&json::Animation {
            channels: tracks.channels,
            samplers: tracks.samplers,
            name: Some("proper time".to_owned()),
            extras: Some(
                serde_json::value::to_raw_value(&json!({
                    "frames_per_second": frames_per_second,
                    "proper_times": self.scene.steps,
                }))
                .expect("numbers are JSON"),
            ),
            extensions: None,
        })
    }

    fn keys<const N: usize>(
        &mut self,
        name: usize,
        times: &[[f32; 1]],
        values: &[[f32; N]],
    ) -> Result<Keys, WriteError> {
        let keys = self.own_keys(times, values)?;
        self.tracks.keys.insert(name, keys);
        Ok(keys)
    }

    /// Keys that no other channel shares.
    pub(super) fn own_keys<const N: usize>(
        &mut self,
        times: &[[f32; 1]],
        values: &[[f32; N]],
    ) -> Result<Keys, WriteError> {
        Ok(Keys {
            times: key_frames(&mut self.document, times)?,
            values: key_frames(&mut self.document, values)?,
        })
    }

    pub(super) fn track(
        &mut self,
        node: Index<json::Node>,
        property: animation::Property,
        keys: Keys,
        interpolation: animation::Interpolation,
    ) {
        let Tracks {
            channels, samplers, ..
        } = &mut self.tracks;
        channels.push(animation::Channel {
            sampler: Index::new(samplers.len() as u32),
            target: animation::Target {
                node,
                path: Checked::Valid(property),
                extensions: None,
                extras: None,
            },
            extensions: None,
            extras: None,
        });
        samplers.push(animation::Sampler {
            input: keys.times,
            interpolation: Checked::Valid(interpolation),
            output: keys.values,
            extensions: None,
            extras: None,
        });
    }
}

/// Whether one mesh becomes the other by moving its vertices.
fn can_morph(from: &Mesh, to: &Mesh) -> bool {
    from.vertex_count() == to.vertex_count()
        && from.shared_triangles() == to.shared_triangles()
        && from.has_normals() == to.has_normals()
        && from.tangents().is_some() == to.tangents().is_some()
}

fn key_frames<const N: usize>(
    document: &mut Document<'_>,
    values: &[[f32; N]],
) -> Result<Index<json::Accessor>, WriteError> {
    let bounds = Bounds::of_all(values.len(), |index| values[index]);
    document.vectors(
        values,
        |_, value| *value,
        Some(bounds),
        AccessorRole::KeyFrames,
    )
}

/// The name without its step.
fn name_of_part(photosurface: &Photosurface) -> &str {
    let facts = &photosurface.facts;
    let step = format!("_{}", step_label(facts.step));
    facts.name.strip_suffix(&step).unwrap_or(&facts.name)
}
