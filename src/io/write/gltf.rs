//! Core glTF 2.0: one node, one mesh, one primitive for each photosurface.
//!
//! Plain accessors, u32 indices, flat node tree, translations only: what Blender, MeshLab, trimesh,
//! pyvista and three.js all read alike. Data shared between steps (triangles, texture coordinates,
//! colours, materials, images) is written once.

use std::collections::HashMap;
use std::io::Write;
use std::sync::Arc;

use glam::{DVec3, DVec4};
use gltf::binary::{Glb, Header};
use gltf::json::validation::{Checked, USize64};
use gltf::json::{self, Index, accessor, buffer, extras::RawValue, mesh::Semantic};
use percent_encoding::{AsciiSet, CONTROLS, utf8_percent_encode};
use serde::Serialize;
use serde_json::{Value, json};

use super::layer::{Scalar, asked_for, layers};
use super::materials::Materials;
use super::pack::{Local, Packed, pack};
use super::{Export, Playback, WriteError};
use crate::mesh::{Material, Mesh};

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
    let (json, binary) = document(export, None)?;
    let json = serde_json::to_vec(&json).expect("glTF is JSON");
    let padded = |chunk: &[u8]| chunk.len().next_multiple_of(4) as u64;
    let bytes = 12 + 8 + padded(&json) + 8 + padded(&binary);
    if bytes > u64::from(u32::MAX) {
        return Err(WriteError::TooLarge {
            format: "GLB",
            bytes,
            limit: u64::from(u32::MAX),
        });
    }
    let glb = Glb {
        // Made anew by `to_writer`.
        header: Header {
            magic: *b"glTF",
            version: 2,
            length: 0,
        },
        json: json.into(),
        bin: Some(binary.into()),
    };
    glb.to_writer(writer).map_err(|error| match error {
        gltf::Error::Io(error) => WriteError::Stream(error),
        other => unreachable!("writing only fails with the writer: {other}"),
    })
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
    let (json, binary) = document(export, Some(binary_name))?;
    binary_writer.write_all(&binary)?;
    let json = serde_json::to_vec_pretty(&json).expect("glTF is JSON");
    json_writer.write_all(&json)?;
    json_writer.write_all(b"\n")?;
    Ok(())
}

/// The JSON part and the data of a file.
fn document(
    export: &Export<'_>,
    binary_name: Option<&str>,
) -> Result<(Value, Vec<u8>), WriteError> {
    let mut document = Document::default();
    match export.playback {
        Some(Playback::Morph { frames_per_second }) => {
            document.add_morphing(export, frames_per_second)?;
        }
        playback => {
            let asked_for = asked_for(export);
            for layer in layers(export) {
                let scalars = layer.scalars(asked_for)?;
                let extras = layer.facts.map(raw);
                document.add(layer.name, &[layer.mesh], layer.material, &scalars, extras)?;
            }
            if let Some(Playback::Frames { frames_per_second }) = playback {
                document.animate_frames(export, frames_per_second);
            }
        }
    }
    Ok(document.finish(export, binary_name))
}

/// A glTF document in the making.
#[derive(Default)]
pub(super) struct Document {
    pub(super) root: json::Root,
    binary: Vec<u8>,
    /// The `f64` translation of each node; glTF's JSON holds it, `gltf::json` does not.
    translations: Vec<DVec3>,
    /// What has been written already, by the address of the shared original.
    shared: HashMap<usize, Index<json::Accessor>>,
    materials: Materials,
    /// Of the one animation, as long as it is being made.
    pub(super) tracks: (Vec<json::animation::Channel>, Vec<json::animation::Sampler>),
}

impl Document {
    /// A node with a mesh; `steps` are its geometry at the first step and at those that morph targets are for.
    pub(super) fn add(
        &mut self,
        name: &str,
        steps: &[&Mesh],
        material: Option<&Arc<Material>>,
        scalars: &[Scalar<'_>],
        extras: json::Extras,
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
        let positions = self.local(&local);
        let mut attributes = vec![(Semantic::Positions, positions)];
        if let Some(normals) = mesh.normals() {
            let normals: Vec<[f32; 3]> = normals
                .iter()
                .map(|normal| unit_or_up(*normal).as_vec3().to_array())
                .collect();
            attributes.push((
                Semantic::Normals,
                self.accessor(&normals, accessor::Type::Vec3, None),
            ));
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
            attributes.push((
                Semantic::Tangents,
                self.accessor(&tangents, accessor::Type::Vec4, None),
            ));
        }
        for (set, coordinates) in (0..).zip(mesh.texture_coordinates()) {
            let accessor = self.shared(address(coordinates), |document| {
                let values: Vec<[f32; 2]> = coordinates.iter().map(|c| c.to_array()).collect();
                document.accessor(&values, accessor::Type::Vec2, None)
            });
            attributes.push((Semantic::TexCoords(set), accessor));
        }
        if let Some(colors) = mesh.colors() {
            let accessor = self.shared(address(colors), |document| {
                let bytes: Vec<u8> = colors
                    .iter()
                    .flat_map(|color| color.to_array().map(to_u8))
                    .collect();
                let view = document.view(&bytes, Some(buffer::Target::ArrayBuffer));
                let kind = (accessor::ComponentType::U8, accessor::Type::Vec4);
                document.push_accessor(view, colors.len(), kind, true, None)
            });
            attributes.push((Semantic::Colors(0), accessor));
        }
        for scalar in scalars {
            let values: Vec<[f32; 1]> = scalar.values.iter().map(|&v| [v as f32]).collect();
            let accessor = self.accessor(&values, accessor::Type::Scalar, None);
            let name = scalar.name.to_ascii_uppercase();
            attributes.push((Semantic::Extras(name), accessor));
        }
        let targets = steps[1..].iter().zip(&differences);
        let targets: Vec<_> = targets
            .map(|(step, difference)| self.morph_target(mesh, step, difference))
            .collect();
        let triangles = mesh.triangles();
        let indices = self.shared(address(triangles), |document| {
            let bytes: Vec<u8> = triangles
                .as_flattened()
                .iter()
                .flat_map(|index| index.to_le_bytes())
                .collect();
            let view = document.view(&bytes, Some(buffer::Target::ElementArrayBuffer));
            let kind = (accessor::ComponentType::U32, accessor::Type::Scalar);
            document.push_accessor(view, 3 * triangles.len(), kind, false, None)
        });
        let material = self.materials.add(material);
        let primitive = json::mesh::Primitive {
            attributes: attributes
                .into_iter()
                .map(|(key, value)| (Checked::Valid(key), value))
                .collect(),
            extensions: None,
            extras: None,
            indices: Some(indices),
            material: Some(Index::new(material as u32)),
            mode: Checked::Valid(json::mesh::Mode::Triangles),
            targets: Some(targets).filter(|targets| !targets.is_empty()),
        };
        let mesh = self.root.push(json::Mesh {
            extensions: None,
            extras: None,
            name: Some(name.to_owned()),
            primitives: vec![primitive],
            weights: None,
        });
        self.translations.push(offset);
        Ok(self.root.push(json::Node {
            mesh: Some(mesh),
            name: Some(name.to_owned()),
            extras,
            ..json::Node::default()
        }))
    }

    /// What is to be added to the first step's geometry to have that of another.
    fn morph_target(
        &mut self,
        first: &Mesh,
        step: &Mesh,
        difference: &Local,
    ) -> json::mesh::MorphTarget {
        let normals = first.normals().zip(step.normals()).map(|(from, to)| {
            let pairs = from.iter().zip(to);
            let differences = pairs.map(|(&from, &to)| unit_or_up(to) - unit_or_up(from));
            let differences: Vec<_> = differences.map(|d| d.as_vec3().to_array()).collect();
            self.accessor(&differences, accessor::Type::Vec3, None)
        });
        let tangents = first.tangents().zip(step.tangents()).map(|(from, to)| {
            let direction = |tangent: &DVec4| unit_or_up(tangent.truncate());
            let pairs = from.iter().zip(to);
            let differences = pairs.map(|(from, to)| direction(to) - direction(from));
            let differences: Vec<_> = differences.map(|d| d.as_vec3().to_array()).collect();
            self.accessor(&differences, accessor::Type::Vec3, None)
        });
        json::mesh::MorphTarget {
            positions: Some(self.local(difference)),
            normals,
            tangents,
        }
    }

    fn finish(mut self, export: &Export<'_>, binary_name: Option<&str>) -> (Value, Vec<u8>) {
        self.root.asset.generator = Some(export.scene.generator.to_owned());
        let images = self.materials.images().to_vec();
        let views: Vec<usize> = images
            .iter()
            .map(|image| self.view(image.bytes(), None).value())
            .collect();
        self.root.push(json::Buffer {
            byte_length: USize64::from(self.binary.len()),
            name: None,
            uri: binary_name.map(|name| utf8_percent_encode(name, IN_REFERENCE).to_string()),
            extensions: None,
            extras: None,
        });
        let scene = self.root.push(json::Scene {
            extensions: None,
            extras: Some(raw(export.scene)),
            name: export.scene.title.clone(),
            nodes: (0..self.root.nodes.len() as u32).map(Index::new).collect(),
        });
        self.root.scene = Some(scene);
        let mut root = serde_json::to_value(&self.root).expect("glTF is JSON");
        for (node, offset) in self.translations.iter().enumerate() {
            if *offset != DVec3::ZERO {
                root["nodes"][node]["translation"] = json!(offset.to_array());
            }
        }
        self.materials.write_into(&mut root, &views);
        (root, self.binary)
    }

    /// Writes what `make` makes once for all who share it.
    fn shared(
        &mut self,
        address: usize,
        make: impl FnOnce(&mut Self) -> Index<json::Accessor>,
    ) -> Index<json::Accessor> {
        if let Some(&accessor) = self.shared.get(&address) {
            return accessor;
        }
        let accessor = make(self);
        self.shared.insert(address, accessor);
        accessor
    }

    fn local(&mut self, local: &Local) -> Index<json::Accessor> {
        let bounds = Some((local.min, local.max));
        self.accessor(&local.values, accessor::Type::Vec3, bounds)
    }

    fn accessor<const N: usize>(
        &mut self,
        values: &[[f32; N]],
        shape: accessor::Type,
        bounds: Option<([f32; N], [f32; N])>,
    ) -> Index<json::Accessor> {
        let bytes: Vec<u8> = values
            .as_flattened()
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect();
        let view = self.view(&bytes, Some(buffer::Target::ArrayBuffer));
        let bounds = bounds.map(|(min, max)| (min.to_vec(), max.to_vec()));
        self.push_accessor(
            view,
            values.len(),
            (accessor::ComponentType::F32, shape),
            false,
            bounds,
        )
    }

    /// Numbers that are no attributes of vertices: key frames.
    pub(super) fn keys<const N: usize>(
        &mut self,
        values: &[[f32; N]],
        shape: accessor::Type,
    ) -> Index<json::Accessor> {
        let bytes: Vec<u8> = (values.as_flattened().iter())
            .flat_map(|value| value.to_le_bytes())
            .collect();
        let view = self.view(&bytes, None);
        let bounds = |least: fn(f32, f32) -> f32, start: f32| {
            let axis = |axis: usize| values.iter().fold(start, |b, v| least(b, v[axis]));
            (0..N).map(axis).collect()
        };
        let bounds = (
            bounds(f32::min, f32::INFINITY),
            bounds(f32::max, f32::NEG_INFINITY),
        );
        let kind = (accessor::ComponentType::F32, shape);
        self.push_accessor(view, values.len(), kind, false, Some(bounds))
    }

    fn push_accessor(
        &mut self,
        view: Index<buffer::View>,
        count: usize,
        (component, shape): (accessor::ComponentType, accessor::Type),
        normalized: bool,
        bounds: Option<(Vec<f32>, Vec<f32>)>,
    ) -> Index<json::Accessor> {
        let (min, max) = bounds.unzip();
        self.root.push(json::Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: USize64::from(count),
            component_type: Checked::Valid(accessor::GenericComponentType(component)),
            extensions: None,
            extras: None,
            type_: Checked::Valid(shape),
            // f32 as f64 prints every digit that tells it apart, so that bounds read back exactly.
            min: min.map(|min| json!(min)),
            max: max.map(|max| json!(max)),
            name: None,
            normalized,
            sparse: None,
        })
    }

    fn view(&mut self, bytes: &[u8], target: Option<buffer::Target>) -> Index<buffer::View> {
        // Every view starts at a multiple of four, whatever an image's length.
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let offset = self.binary.len();
        self.binary.extend_from_slice(bytes);
        self.root.push(buffer::View {
            buffer: Index::new(0),
            byte_length: USize64::from(bytes.len()),
            byte_offset: Some(USize64::from(offset)),
            byte_stride: None,
            name: None,
            target: target.map(Checked::Valid),
            extensions: None,
            extras: None,
        })
    }
}

pub(super) fn raw(facts: &impl Serialize) -> Box<RawValue> {
    serde_json::value::to_raw_value(facts).expect("facts are names and numbers")
}

/// Tells shared data apart: it lives as long as the export, at its own address.
fn address<T>(shared: &[T]) -> usize {
    shared.as_ptr() as usize
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
