//! Core glTF 2.0: one node, one mesh, one primitive for each photosurface; in a file of several steps, an empty node above
//! those of each step.
//!
//! Plain accessors, u32 indices, translations only: what Blender, MeshLab, trimesh,
//! pyvista and three.js all read alike. Data shared between steps (triangles, texture coordinates,
//! colours, materials, images) is written once.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::io::Write;

use glam::{DVec3, DVec4, Vec2};
use gltf::json::validation::Checked;
use gltf::json::{self, Index, mesh::Semantic};
use serde_json::{Value, json};

use super::document::{AccessorRole, Document};
use super::materials::Materials;
use super::step_nodes::StepNodes;
use crate::material::Part;
use crate::mesh::Mesh;
use crate::pipeline::{Photosurface, PlacedSceneError, SceneFacts, step_label};
use crate::scene::Attributes;
use crate::write::layer::{Layer, Numbers, Scalar};
use crate::write::pack::{Bounds, Packing};
use crate::write::{
    Export, FRAMES_PER_SECOND, GltfOutput, ObserverCamera, Playback, Seal, WriteError,
};

/// Writes one GLB.
///
/// # Errors
///
/// A mesh without triangles, a number that `f32` cannot hold, more than 4 GiB, what [`GltfFile`] refuses, or the writer fails.
pub fn write_glb(export: &Export<'_>, mut writer: impl Write) -> Result<(), WriteError> {
    write(export, GltfOutput::from_memory(&mut writer))
}

/// Writes the two parts of a `.gltf` with its data in a file beside it, called `binary_name`.
///
/// # Errors
///
/// As [`write_glb`].
pub fn write_gltf(
    export: &Export<'_>,
    binary_name: &str,
    mut json_writer: impl Write,
    mut binary_writer: impl Write,
) -> Result<(), WriteError> {
    let output = GltfOutput::gltf(binary_name, &mut json_writer, &mut binary_writer);
    write(export, output)
}

fn write(export: &Export<'_>, output: GltfOutput<'_>) -> Result<(), WriteError> {
    let attributes = export.photosurfaces.first().map(Photosurface::attributes);
    let attributes = attributes.unwrap_or_default();
    let mut file = GltfFile::new(
        output,
        export.scene,
        export.marker,
        attributes,
        export.playback,
    )?;
    match export.playback {
        Some(Playback::Morph { .. }) => {
            let of_one_part = |a: &Photosurface, b: &Photosurface| a.facts.step < b.facts.step;
            for steps in export.photosurfaces.chunk_by(of_one_part) {
                file.add_morphing(steps)?;
            }
        }
        _ => {
            for photosurface in export.photosurfaces {
                file.add(photosurface)?;
            }
        }
    }
    file.finish()
}

/// A glTF file in the making: photosurfaces go in one after the other, and none has to stay in memory.
pub struct GltfFile<'a> {
    pub(super) document: Document<'a>,
    pub(super) scene: SceneFacts,
    pub(super) tracks: super::tracks::Tracks,
    pub(super) step_nodes: StepNodes,
    pub(super) camera: Option<ObserverCamera>,
    /// The list of cameras, once their nodes are there.
    pub(super) described_camera: Option<Value>,
    materials: Materials,
    attributes: Attributes,
    playback: Option<Playback>,
    /// The text of the seal, once it is known.
    seal: Option<String>,
}

impl<'a> GltfFile<'a> {
    /// A file with nothing but the observer's marker; every mesh will have these attributes.
    ///
    /// # Errors
    ///
    /// A frame rate outside 0.001 to 1000, a marker that `f32` cannot hold, or the writer fails.
    pub fn new(
        output: GltfOutput<'a>,
        scene: &SceneFacts,
        marker: Option<&Part>,
        attributes: Attributes,
        playback: Option<Playback>,
    ) -> Result<Self, WriteError> {
        if let Some(rate) = playback.map(Playback::frames_per_second)
            && !FRAMES_PER_SECOND.contains(&rate)
        {
            return Err(WriteError::FramesPerSecond(rate));
        }
        let mut file = Self {
            document: Document::new(output),
            scene: scene.clone(),
            tracks: Default::default(),
            step_nodes: StepNodes::default(),
            camera: None,
            described_camera: None,
            materials: Materials::default(),
            attributes,
            playback,
            seal: None,
        };
        if let Some(marker) = marker {
            let node = file.add_layer(&Layer::from(marker))?;
            file.step_nodes.add(None, node);
        }
        Ok(file)
    }

    /// Adds a photosurface, which must have the attributes of the file and be of a step of the scene.
    ///
    /// # Errors
    ///
    /// A mesh without triangles, an attribute that does not have one value a vertex, a step that the scene does not have, a
    /// number that `f32` cannot hold, or the writer fails.
    pub fn add(&mut self, photosurface: &Photosurface) -> Result<(), WriteError> {
        self.check_step(photosurface)?;
        let node = self.add_layer(&Layer::from(photosurface))?;
        self.step_nodes.add(Some(photosurface.facts.step), node);
        Ok(())
    }

    /// Gives the file a seal, which is to be closed when the file is written.
    pub(crate) fn set_seal(&mut self, seal: &Seal) {
        self.seal = Some(seal.text());
    }

    /// Whether the scene has the step of a photosurface.
    pub(super) fn check_step(&self, photosurface: &Photosurface) -> Result<(), WriteError> {
        let (step, steps) = (photosurface.facts.step, self.scene.steps.len());
        match step < steps {
            true => Ok(()),
            false => Err(PlacedSceneError::Step { step, steps }.into()),
        }
    }

    pub(super) fn playback(&self) -> Option<Playback> {
        self.playback
    }

    fn add_layer(&mut self, layer: &Layer<'_>) -> Result<Index<json::Node>, WriteError> {
        let scalars = layer.scalars(self.attributes, Numbers::Single)?;
        let extras = layer.facts.map(|facts| json!(facts));
        self.add_node(layer, &[layer.mesh], &scalars, extras)
    }

    /// A node with a mesh; `steps` are its geometry at the first step and at those that morph targets are for.
    pub(super) fn add_node(
        &mut self,
        layer: &Layer<'_>,
        steps: &[&Mesh],
        scalars: &[Scalar<'_>],
        extras: Option<Value>,
    ) -> Result<Index<json::Node>, WriteError> {
        let name = layer.name;
        let mesh = steps[0];
        if mesh.triangle_count() == 0 {
            return Err(WriteError::Empty(name.to_owned()));
        }
        let packing = Packing::new(name, steps, layer.around)?;
        let document = &mut self.document;
        let bounds = packing.local_bounds();
        let places = document.positions(mesh, |place| packing.local(place), bounds)?;
        let mut attributes = vec![(Semantic::Positions, places)];
        if mesh.has_normals() {
            let direction = |normal: DVec3| unit_or_up(normal).as_vec3().to_array();
            let accessor = document.normals(mesh, direction)?;
            attributes.push((Semantic::Normals, accessor));
        }
        if let Some(tangents) = mesh.tangents() {
            let direction = |_: usize, tangent: &DVec4| {
                let unit = unit_or_up(tangent.truncate());
                unit.extend(tangent.w).as_vec4().to_array()
            };
            let accessor =
                document.vectors(tangents, direction, None, AccessorRole::VertexAttribute)?;
            attributes.push((Semantic::Tangents, accessor));
        }
        for (set, coordinates) in (0..).zip(mesh.texture_coordinates()) {
            let accessor = document.shared(coordinates, |document| {
                let values = |_: usize, place: &Vec2| place.to_array();
                document.vectors(coordinates, values, None, AccessorRole::VertexAttribute)
            })?;
            attributes.push((Semantic::TexCoords(set), accessor));
        }
        if let Some(colors) = mesh.shared_colors() {
            let accessor = document.shared(colors, |document| {
                document.colors(colors, |color| color.to_array().map(to_u8))
            })?;
            attributes.push((Semantic::Colors(0), accessor));
        }
        for scalar in scalars {
            let number = |vertex: usize| [scalar.at(vertex) as f32];
            let accessor = document.numbers(
                mesh.vertex_count(),
                number,
                None,
                AccessorRole::VertexAttribute,
            )?;
            let name = scalar.name.to_ascii_uppercase();
            attributes.push((Semantic::Extras(name), accessor));
        }
        let targets = steps[1..].iter();
        let targets = targets.map(|step| morph_target(document, mesh, step, &packing));
        let targets: Vec<_> = targets.collect::<Result<_, _>>()?;
        let triangles = mesh.shared_triangles();
        let indices = document.shared(triangles, |document| document.indices(triangles))?;
        let primitive = json::mesh::Primitive {
            attributes: attributes
                .into_iter()
                .map(|(key, value)| (Checked::Valid(key), value))
                .collect(),
            extensions: None,
            extras: None,
            indices: Some(indices),
            material: Some(Index::new(self.materials.add(layer.material) as u32)),
            mode: Checked::Valid(json::mesh::Mode::Triangles),
            targets: Some(targets).filter(|targets| !targets.is_empty()),
        };
        let mut mesh = json!({ "name": name, "primitives": [primitive] });
        let targets = steps.len() - 1;
        if targets > 0 {
            let names: Vec<_> = (1..=targets).map(step_label).collect();
            mesh["weights"] = json!(vec![0.0; targets]);
            mesh["extras"] = json!({ "targetNames": names });
        }
        let mesh = self.document.mesh(&mesh)?;
        // `gltf::json` has no room for the offset in f64.
        let mut node = json!({ "name": name, "mesh": mesh });
        let translation = layer.moved(packing.offset);
        if translation != DVec3::ZERO {
            node["translation"] = json!(translation.to_array());
        }
        if let Some(extras) = extras {
            node["extras"] = extras;
        }
        self.document.node(&node)
    }

    /// Writes what is left to write of everything that was added, and makes sure that all of it has gone out.
    ///
    /// # Errors
    ///
    /// More than 4 GiB in a GLB, or the file cannot be written.
    pub fn finish(mut self) -> Result<(), WriteError> {
        self.add_camera()?;
        let step_nodes = std::mem::take(&mut self.step_nodes);
        let roots = step_nodes.into_roots(&mut self.document, &self.scene.steps)?;
        if let Some(Playback::Frames { frames_per_second }) = self.playback {
            for (step, node) in roots.of_steps {
                self.show_during_its_frame(node, step, frames_per_second)?;
            }
        }
        let mut scene_extras = json!(self.scene);
        if let Some(playback) = self.playback {
            let frames_per_second = playback.frames_per_second();
            scene_extras["frames_per_second"] = frames_per_second.into();
            self.animate(frames_per_second)?;
        }
        if let Some(seal) = &self.seal {
            scene_extras["seal"] = seal.as_str().into();
        }
        let images = self.materials.images().to_vec();
        // Images that a file made of the same bytes share them here too.
        let mut written = HashMap::new();
        let mut views = Vec::with_capacity(images.len());
        for image in &images {
            let bytes = image.bytes();
            let view = match written.entry((bytes.as_ptr(), bytes.len())) {
                Entry::Occupied(entry) => *entry.get(),
                Entry::Vacant(entry) => *entry.insert(self.document.image(bytes)?.value()),
            };
            views.push(view);
        }
        let mut scene = json!({
            "extras": scene_extras,
            "nodes": roots.all,
        });
        if let Some(title) = &self.scene.title {
            scene["name"] = json!(title);
        }
        let mut others = json!({
            "asset": { "generator": self.scene.generator, "version": "2.0" },
            "scene": 0,
            "scenes": [scene],
        });
        if let Some(copyright) = self.scene.copyright() {
            others["asset"]["copyright"] = copyright.into();
        }
        if let Some(cameras) = self.described_camera {
            others["cameras"] = cameras;
        }
        self.materials.write_into(&mut others, &views);
        self.document.finish(&others)
    }
}

/// What is to be added to the first step's geometry to have that of another.
fn morph_target(
    document: &mut Document<'_>,
    first: &Mesh,
    step: &Mesh,
    packing: &Packing,
) -> Result<json::mesh::MorphTarget, WriteError> {
    let turned = |from: DVec3, to: DVec3| {
        let difference = unit_or_up(to) - unit_or_up(from);
        difference.as_vec3().to_array()
    };
    let normals = first.normals().zip(step.normals());
    let normals = normals.map(|(from, to)| {
        let difference = |vertex: usize, to: &DVec3| turned(from[vertex], *to);
        document.vectors(to, difference, None, AccessorRole::VertexAttribute)
    });
    let normals = normals.transpose()?;
    let tangents = first.tangents().zip(step.tangents());
    let tangents = tangents.map(|(from, to)| {
        let difference = |vertex: usize, to: &DVec4| turned(from[vertex].truncate(), to.truncate());
        document.vectors(to, difference, None, AccessorRole::VertexAttribute)
    });
    let tangents = tangents.transpose()?;
    let (from, to) = (first.positions(), step.positions());
    let difference = |vertex: usize, to: &DVec3| packing.difference(from[vertex], *to);
    let bounds = Bounds::of_all(to.len(), |vertex| difference(vertex, &to[vertex]));
    let positions =
        document.vectors(to, difference, Some(bounds), AccessorRole::VertexAttribute)?;
    Ok(json::mesh::MorphTarget {
        positions: Some(positions),
        normals,
        tangents,
    })
}

/// Files must hold unit vectors; a degenerate triangle has none of its own.
fn unit_or_up(vector: DVec3) -> DVec3 {
    if vector == DVec3::ZERO {
        DVec3::Y
    } else {
        vector
    }
}

fn to_u8(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0).round() as u8
}
