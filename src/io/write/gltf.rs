//! Core glTF 2.0: one node, one mesh, one primitive for each photosurface.
//!
//! Plain accessors, u32 indices, flat node tree, translations only: what Blender, MeshLab, trimesh,
//! pyvista and three.js all read alike. Data shared between steps (triangles, texture coordinates,
//! colours, materials, images) is written once.

use std::io::{Read, Seek, Write};
use std::sync::Arc;

use glam::{DVec3, DVec4};
use gltf::json::validation::Checked;
use gltf::json::{self, Index, accessor, mesh::Semantic};
use percent_encoding::{AsciiSet, CONTROLS, utf8_percent_encode};
use serde_json::{Value, json};

use super::document::Document;
use super::layer::{Layer, Scalar};
use super::materials::Materials;
use super::pack::{Local, Packed, pack};
use super::{Export, Playback, WriteError};
use crate::mesh::{Material, Mesh, Part};
use crate::photosurface::{Photosurface, SceneFacts, step_label};
use crate::scene::Attributes;

/// What may not stand in a relative reference as it is.
const IN_REFERENCE: &AsciiSet = &CONTROLS
    .add(b' ')
    .add(b'"')
    .add(b'#')
    .add(b'%')
    .add(b':')
    .add(b'<')
    .add(b'>')
    .add(b'?')
    .add(b'\\');

/// Writes one GLB.
///
/// # Errors
///
/// A mesh without triangles, a number that `f32` cannot hold, more than 4 GiB, or the writer fails.
pub fn write_glb(export: &Export<'_>, writer: impl Write) -> Result<(), WriteError> {
    let data = std::io::Cursor::new(vec![]);
    file_of(export, data)?.finish_glb(writer)
}

/// Writes the two parts of a `.gltf` with its data in a file beside it, called `binary_name`.
///
/// # Errors
///
/// As [`write_glb`].
pub fn write_gltf(
    export: &Export<'_>,
    binary_name: &str,
    json_writer: impl Write,
    binary_writer: impl Write,
) -> Result<(), WriteError> {
    file_of(export, binary_writer)?.finish_gltf(binary_name, json_writer)
}

fn file_of<'a, W: Write>(export: &Export<'a>, data: W) -> Result<GltfFile<'a, W>, WriteError> {
    let attributes = export.photosurfaces.first().map(Photosurface::attributes);
    let attributes = attributes.unwrap_or_default();
    let mut file = GltfFile::new(
        data,
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
    Ok(file)
}

/// A glTF file in the making: photosurfaces go in one after the other, their data goes on to `W`, and none has to stay
/// in memory.
pub struct GltfFile<'a, W> {
    pub(super) document: Document<W>,
    pub(super) scene: &'a SceneFacts,
    pub(super) tracks: super::animation::Tracks,
    materials: Materials,
    attributes: Attributes,
    playback: Option<Playback>,
}

impl<'a, W: Write> GltfFile<'a, W> {
    /// A file with nothing but the observer's marker; every mesh will have these attributes.
    ///
    /// # Errors
    ///
    /// The writer fails.
    pub fn new(
        data: W,
        scene: &'a SceneFacts,
        marker: Option<&Part>,
        attributes: Attributes,
        playback: Option<Playback>,
    ) -> Result<Self, WriteError> {
        let mut file = Self {
            document: Document::new(data),
            scene,
            tracks: Default::default(),
            materials: Materials::default(),
            attributes,
            playback,
        };
        if let Some(marker) = marker {
            file.add_layer(&Layer::from(marker))?;
        }
        Ok(file)
    }

    /// Adds a photosurface, which must have the attributes of the file.
    ///
    /// # Errors
    ///
    /// A mesh without triangles, a number that `f32` cannot hold, or the writer fails.
    pub fn add(&mut self, photosurface: &Photosurface) -> Result<(), WriteError> {
        let node = self.add_layer(&Layer::from(photosurface))?;
        if let Some(Playback::Frames { frames_per_second }) = self.playback {
            self.show_during_its_frame(node, photosurface.facts.step, frames_per_second)?;
        }
        Ok(())
    }

    pub(super) fn playback(&self) -> Option<Playback> {
        self.playback
    }

    fn add_layer(&mut self, layer: &Layer<'_>) -> Result<Index<json::Node>, WriteError> {
        let scalars = layer.scalars(self.attributes)?;
        let extras = layer.facts.map(|facts| json!(facts));
        self.add_node(layer.name, &[layer.mesh], layer.material, &scalars, extras)
    }

    /// A node with a mesh; `steps` are its geometry at the first step and at those that morph targets are for.
    pub(super) fn add_node(
        &mut self,
        name: &str,
        steps: &[&Mesh],
        material: Option<&Arc<Material>>,
        scalars: &[Scalar<'_>],
        extras: Option<Value>,
    ) -> Result<Index<json::Node>, WriteError> {
        let mesh = steps[0];
        if mesh.triangles().is_empty() {
            return Err(WriteError::Empty(name.to_owned()));
        }
        let positions: Vec<_> = steps.iter().map(|mesh| mesh.positions()).collect();
        let Packed {
            offset,
            local,
            differences,
        } = pack(name, &positions)?;
        let document = &mut self.document;
        let mut attributes = vec![(Semantic::Positions, document.local(&local)?)];
        if let Some(normals) = mesh.normals() {
            let normals: Vec<[f32; 3]> = normals
                .iter()
                .map(|normal| unit_or_up(*normal).as_vec3().to_array())
                .collect();
            let accessor = document.vectors(&normals, accessor::Type::Vec3)?;
            attributes.push((Semantic::Normals, accessor));
        }
        if let Some(tangents) = mesh.tangents() {
            let tangents: Vec<[f32; 4]> = tangents
                .iter()
                .map(|tangent| {
                    unit_or_up(tangent.truncate())
                        .extend(tangent.w)
                        .as_vec4()
                        .to_array()
                })
                .collect();
            let accessor = document.vectors(&tangents, accessor::Type::Vec4)?;
            attributes.push((Semantic::Tangents, accessor));
        }
        for (set, coordinates) in (0..).zip(mesh.texture_coordinates()) {
            let accessor = document.shared(coordinates, |document| {
                let values: Vec<[f32; 2]> = coordinates.iter().map(|c| c.to_array()).collect();
                document.vectors(&values, accessor::Type::Vec2)
            })?;
            attributes.push((Semantic::TexCoords(set), accessor));
        }
        if let Some(colors) = mesh.shared_colors() {
            let accessor = document.shared(colors, |document| {
                let bytes = colors.iter().flat_map(|color| color.to_array().map(to_u8));
                document.colors(&bytes.collect::<Vec<u8>>())
            })?;
            attributes.push((Semantic::Colors(0), accessor));
        }
        for scalar in scalars {
            let values: Vec<[f32; 1]> = scalar.values.iter().map(|&v| [v as f32]).collect();
            let accessor = document.vectors(&values, accessor::Type::Scalar)?;
            let name = scalar.name.to_ascii_uppercase();
            attributes.push((Semantic::Extras(name), accessor));
        }
        let targets = steps[1..].iter().zip(&differences);
        let targets =
            targets.map(|(step, difference)| morph_target(document, mesh, step, difference));
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
            material: Some(Index::new(self.materials.add(material) as u32)),
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
        let mesh = self.document.meshes.push(&mesh);
        // `gltf::json` has no room for the offset in f64.
        let mut node = json!({ "name": name, "mesh": mesh });
        if offset != DVec3::ZERO {
            node["translation"] = json!(offset.to_array());
        }
        if let Some(extras) = extras {
            node["extras"] = extras;
        }
        Ok(self.document.nodes.push(&node))
    }

    /// Writes a GLB of everything that was added; the data is read back from where it went.
    ///
    /// # Errors
    ///
    /// More than 4 GiB, the data cannot be read, or the writer fails.
    pub fn finish_glb(self, mut writer: impl Write) -> Result<(), WriteError>
    where
        W: Read + Seek,
    {
        let (mut json, mut data, bytes) = self.finish(None)?;
        json.resize(json.len().next_multiple_of(4), b' ');
        let padded = bytes.next_multiple_of(4);
        let all = 12 + 8 + json.len() as u64 + 8 + padded;
        let limit = u64::from(u32::MAX);
        if all > limit {
            return Err(WriteError::TooLarge {
                format: "GLB",
                bytes: all,
                limit,
            });
        }
        let [magic, json_kind, data_kind] = [*b"glTF", *b"JSON", *b"BIN\0"].map(u32::from_le_bytes);
        for word in [magic, 2, all as u32, json.len() as u32, json_kind] {
            writer.write_all(&word.to_le_bytes())?;
        }
        writer.write_all(&json)?;
        drop(json);
        for word in [padded as u32, data_kind] {
            writer.write_all(&word.to_le_bytes())?;
        }
        data.rewind()?;
        std::io::copy(&mut data, &mut writer)?;
        writer.write_all(&[0; 4][..(padded - bytes) as usize])?;
        Ok(())
    }

    /// Writes a `.gltf` of everything that was added, which refers to the data by the name of its file, and makes sure
    /// that all of that has gone out.
    ///
    /// # Errors
    ///
    /// A writer fails.
    pub fn finish_gltf(
        self,
        binary_name: &str,
        mut json_writer: impl Write,
    ) -> Result<(), WriteError> {
        let (json, mut data, _) = self.finish(Some(binary_name))?;
        data.flush()?;
        json_writer.write_all(&json)?;
        json_writer.write_all(b"\n")?;
        Ok(())
    }

    /// The JSON, the stream of data and how much of that there is.
    fn finish(mut self, binary_name: Option<&str>) -> Result<(Vec<u8>, W, u64), WriteError> {
        let mut scene_extras = json!(self.scene);
        if let Some(playback) = self.playback {
            let frames_per_second = playback.frames_per_second();
            scene_extras["frames_per_second"] = frames_per_second.into();
            self.animate(frames_per_second);
        }
        let images = self.materials.images().to_vec();
        let views = images.iter().map(|image| {
            let view = self.document.view(image.bytes(), None)?;
            Ok(view.value())
        });
        let views: Vec<usize> = views.collect::<Result<_, WriteError>>()?;
        let mut scene = json!({
            "extras": scene_extras,
            "nodes": (0..self.document.nodes.len()).collect::<Vec<_>>(),
        });
        if let Some(title) = &self.scene.title {
            scene["name"] = json!(title);
        }
        let mut others = json!({
            "asset": { "generator": self.scene.generator, "version": "2.0" },
            "scene": 0,
            "scenes": [scene],
        });
        self.materials.write_into(&mut others, &views);
        let uri = binary_name.map(|name| utf8_percent_encode(name, IN_REFERENCE).to_string());
        let bytes = self.document.bytes();
        let (json, data) = self.document.finish(&others, uri);
        Ok((json, data, bytes))
    }
}

/// What is to be added to the first step's geometry to have that of another.
fn morph_target<W: Write>(
    document: &mut Document<W>,
    first: &Mesh,
    step: &Mesh,
    difference: &Local,
) -> Result<json::mesh::MorphTarget, WriteError> {
    let mut differences = |from: Vec<DVec3>, to: Vec<DVec3>| {
        let pairs = from.iter().zip(&to);
        let differences = pairs.map(|(&from, &to)| unit_or_up(to) - unit_or_up(from));
        let differences: Vec<_> = differences.map(|d| d.as_vec3().to_array()).collect();
        document.vectors(&differences, accessor::Type::Vec3)
    };
    let directions = |tangents: &[DVec4]| tangents.iter().map(|t| t.truncate()).collect();
    let normals = first.normals().zip(step.normals());
    let normals = normals.map(|(from, to)| differences(from.to_vec(), to.to_vec()));
    let tangents = first.tangents().zip(step.tangents());
    let tangents = tangents.map(|(from, to)| differences(directions(from), directions(to)));
    let (normals, tangents) = (normals.transpose()?, tangents.transpose()?);
    Ok(json::mesh::MorphTarget {
        positions: Some(document.local(difference)?),
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
