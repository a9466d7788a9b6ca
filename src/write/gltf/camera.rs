//! The observer's camera in a glTF file: one node for each step, or one that turns as the steps follow each other.

use glam::DQuat;
use gltf::json::{Index, animation};
use serde_json::{Value, json};

use super::file::GltfFile;
use crate::pipeline::step_label;
use crate::write::{ObserverCamera, Playback, WriteError};

impl GltfFile<'_> {
    /// Puts the observer's camera into the file.
    ///
    /// The steps of a file without an animation have a camera each, beside their meshes. An animation has one camera,
    /// whose rotation has a key at the frame of each step where it changes: held until the next step if each step is
    /// shown during its frame, even in between if the steps morph.
    pub fn set_camera(&mut self, camera: ObserverCamera) {
        self.camera = Some(camera);
    }

    /// Adds the nodes of the camera for the steps of everything that was added before.
    ///
    /// # Errors
    ///
    /// The file cannot be written.
    pub(super) fn add_camera(&mut self) -> Result<(), WriteError> {
        let Some(camera) = self.camera.take() else {
            return Ok(());
        };
        let Some(playback) = self.playback() else {
            let steps: Vec<usize> = self.step_nodes.steps().collect();
            let is_one_of_many = self.scene.steps.len() > 1;
            for step in steps {
                let name = match is_one_of_many {
                    true => format!("{}_{}", camera.name, step_label(step)),
                    false => camera.name.clone(),
                };
                let extras = json!({ "step": step, "proper_time": self.scene.steps[step] });
                let rotation = camera.rotations.get(step);
                let node = self.camera_node(&name, rotation, Some(extras))?;
                self.step_nodes.add(Some(step), node);
            }
            self.described_camera = Some(description(&camera));
            return Ok(());
        };
        let node = self.camera_node(&camera.name, camera.rotations.first(), None)?;
        self.step_nodes.add(None, node);
        if !camera.holds() {
            let interpolation = match playback {
                Playback::Frames { .. } => animation::Interpolation::Step,
                Playback::Morph { .. } => animation::Interpolation::Linear,
            };
            let at = |frame| [(frame as f64 / playback.frames_per_second()) as f32];
            let times: Vec<[f32; 1]> = (0..camera.rotations.len()).map(at).collect();
            let rotations = continuous(&camera.rotations);
            let keys = self.own_keys(&times, &rotations)?;
            let property = animation::Property::Rotation;
            self.track(node, property, keys, interpolation);
        }
        self.described_camera = Some(description(&camera));
        Ok(())
    }

    fn camera_node(
        &mut self,
        name: &str,
        rotation: Option<&DQuat>,
        extras: Option<Value>,
    ) -> Result<Index<gltf::json::Node>, WriteError> {
        let mut node = json!({ "name": name, "camera": 0 });
        if let Some(rotation) = rotation.filter(|&&rotation| rotation != DQuat::IDENTITY) {
            node["rotation"] = json!(rotation.to_array());
        }
        if let Some(extras) = extras {
            node["extras"] = extras;
        }
        self.document.node(&node)
    }
}

/// The list of the file's cameras.
fn description(camera: &ObserverCamera) -> Value {
    let [near, far] = camera.depths;
    json!([{
        "name": camera.name,
        "type": "perspective",
        "perspective": {
            "aspectRatio": camera.aspect,
            "yfov": camera.vertical_fov_rad,
            "znear": near,
            "zfar": far,
        },
    }])
}

/// The same rotations as quaternions of which neighbours are near each other: of two that mean the same, a reader that
/// mixes their numbers needs the nearer one.
fn continuous(rotations: &[DQuat]) -> Vec<[f32; 4]> {
    let mut last = DQuat::IDENTITY;
    let near = |rotation: &DQuat| {
        last = match last.dot(*rotation) < 0.0 {
            true => -*rotation,
            false => *rotation,
        };
        last.to_array().map(|number| number as f32)
    };
    rotations.iter().map(near).collect()
}
