//! Steps that follow each other in time: key frames of scales, or morph targets and their weights.
//!
//! What Blender, three.js and VTK play, found by trying: `KHR_node_visibility` and several scenes are read by
//! next to no one, while a scale of 0 hides and morph targets morph in all three.

use gltf::json::validation::Checked;
use gltf::json::{self, Index, accessor, animation};
use serde_json::{Value, json};

use super::gltf::{Document, raw};
use super::layer::{Layer, layers};
use super::{Export, WriteError};
use crate::photosurface::{Facts, Photosurface, step_label};

impl Document {
    /// Shows each photosurface during the frame of its step alone. The nodes are all that there are so far, in the
    /// order of [`layers`].
    pub(super) fn animate_frames(&mut self, export: &Export<'_>, frames_per_second: f64) {
        let frames = steps(export);
        let at = |frame: usize| frame as f64 / frames_per_second;
        let hidden = [0.0; 3];
        let shown = [1.0; 3];
        let mut tracks: Vec<Option<Keys>> = vec![None; frames];
        for (node, layer) in layers(export).enumerate() {
            let Some(facts) = layer.facts else {
                continue;
            };
            let frame = facts.step;
            let keys = *tracks[frame].get_or_insert_with(|| {
                let mut keys = vec![(at(frame), shown)];
                if frame > 0 {
                    keys.insert(0, (0.0, hidden));
                }
                if frame + 1 < frames {
                    keys.push((at(frame + 1), hidden));
                }
                let times: Vec<[f32; 1]> = keys.iter().map(|(time, _)| [*time as f32]).collect();
                let scales: Vec<[f32; 3]> = keys.iter().map(|(_, scale)| *scale).collect();
                Keys {
                    times: self.keys(&times, accessor::Type::Scalar),
                    values: self.keys(&scales, accessor::Type::Vec3),
                }
            });
            let interpolation = animation::Interpolation::Step;
            self.track(node, animation::Property::Scale, keys, interpolation);
        }
        self.animate(export, frames_per_second);
    }

    /// One node for each part, with a morph target for each step after the first, between which it moves evenly: at
    /// the frame of a step it is that step's photosurface.
    pub(super) fn add_morphing(
        &mut self,
        export: &Export<'_>,
        frames_per_second: f64,
    ) -> Result<(), WriteError> {
        if let Some(marker) = layers(export).find(|layer| layer.facts.is_none()) {
            self.add(marker.name, &[marker.mesh], marker.material, &[], None)?;
        }
        let mut weights: Option<Keys> = None;
        let part = |a: &Photosurface, b: &Photosurface| a.facts.step < b.facts.step;
        for steps in export.photosurfaces.chunk_by(part) {
            let first = Layer::from(&steps[0]);
            let name = name_of_part(&steps[0]);
            let meshes: Vec<_> = steps.iter().map(|step| &step.mesh).collect();
            let facts: Vec<_> = steps.iter().map(|step| &step.facts).collect();
            // What the source says is that of all frames.
            let frame = |facts: &&Facts| Facts {
                source: None,
                ..Facts::clone(facts)
            };
            let mut extras = json!({
                "name": name,
                "object": facts[0].object,
                "part": facts[0].part,
                "frames": facts.iter().map(frame).collect::<Vec<_>>(),
            });
            if let Some(source) = &facts[0].source {
                extras["source"] = Value::clone(source);
            }
            let node = self.add(name, &meshes, first.material, &[], Some(raw(&extras)))?;
            let targets = steps.len() - 1;
            let names: Vec<_> = facts[1..]
                .iter()
                .map(|facts| step_label(facts.step))
                .collect();
            let mesh = self.root.meshes.last_mut().expect("it was just added");
            mesh.extras = Some(raw(&json!({ "targetNames": names })));
            mesh.weights = Some(vec![0.0; targets]);
            let keys = *weights.get_or_insert_with(|| {
                let times: Vec<[f32; 1]> = (0..=targets)
                    .map(|frame| [(frame as f64 / frames_per_second) as f32])
                    .collect();
                let weight = |frame| (1..=targets).map(move |target| [f32::from(target == frame)]);
                let weights: Vec<[f32; 1]> = (0..=targets).flat_map(weight).collect();
                Keys {
                    times: self.keys(&times, accessor::Type::Scalar),
                    values: self.keys(&weights, accessor::Type::Scalar),
                }
            });
            let property = animation::Property::MorphTargetWeights;
            self.track(
                node.value(),
                property,
                keys,
                animation::Interpolation::Linear,
            );
        }
        self.animate(export, frames_per_second);
        Ok(())
    }

    /// A track of the one animation.
    fn track(
        &mut self,
        node: usize,
        property: animation::Property,
        keys: Keys,
        interpolation: animation::Interpolation,
    ) {
        let (channels, samplers) = &mut self.tracks;
        let sampler = animation::Sampler {
            input: keys.times,
            interpolation: Checked::Valid(interpolation),
            output: keys.values,
            extensions: None,
            extras: None,
        };
        channels.push(animation::Channel {
            sampler: Index::new(samplers.len() as u32),
            target: animation::Target {
                node: Index::new(node as u32),
                path: Checked::Valid(property),
                extensions: None,
                extras: None,
            },
            extensions: None,
            extras: None,
        });
        samplers.push(sampler);
    }

    /// Makes the animation of the tracks.
    fn animate(&mut self, export: &Export<'_>, frames_per_second: f64) {
        let (channels, samplers) = std::mem::take(&mut self.tracks);
        self.root.push(json::Animation {
            channels,
            samplers,
            name: Some("proper time".to_owned()),
            extras: Some(raw(&json!({
                "frames_per_second": frames_per_second,
                "proper_times": export.scene.steps,
            }))),
            extensions: None,
        });
    }
}

/// Times and what holds there.
#[derive(Clone, Copy)]
struct Keys {
    times: Index<json::Accessor>,
    values: Index<json::Accessor>,
}

/// How many steps there are.
fn steps(export: &Export<'_>) -> usize {
    let steps = export.photosurfaces.iter().map(|p| p.facts.step + 1);
    steps.max().unwrap_or(0)
}

/// The name without its step.
fn name_of_part(photosurface: &Photosurface) -> &str {
    let facts = &photosurface.facts;
    let step = format!("_{}", step_label(facts.step));
    facts.name.strip_suffix(&step).unwrap_or(&facts.name)
}
