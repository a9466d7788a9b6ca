//! The two halves of a glTF file in the making: lists of JSON, and the data that they are about.
//!
//! Whatever is added is turned into text and bytes at once, and both go on to files where there is much of them: a file
//! of many steps takes no more memory than one of a few.

use std::collections::HashMap;
use std::io::{self, Write};
use std::marker::PhantomData;
use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use gltf::json::validation::{Checked, USize64};
use gltf::json::{self, Index, accessor, buffer};
use serde::Serialize;
use serde_json::{Value, json};

use super::convert::{write_items, write_pieces};
use super::glb::Json;
use crate::mesh::{Mesh, Triangles, VERTICES_AT_ONCE};
use crate::write::pack::Bounds;
use crate::write::text::LongText;
use crate::write::{GltfOutput, WriteError};

/// A list of a glTF file, as the text between its brackets.
pub(super) struct List<T> {
    text: LongText,
    length: u32,
    /// Of what indices into the list are.
    kind: PhantomData<T>,
}

impl<T> Default for List<T> {
    fn default() -> Self {
        Self {
            text: LongText::default(),
            length: 0,
            kind: PhantomData,
        }
    }
}

impl<T> List<T> {
    fn push(&mut self, item: &impl Serialize, directory: &Path) -> io::Result<Index<T>> {
        let separator: &[u8] = if self.length == 0 { b"\n" } else { b",\n" };
        self.text.add(directory, |text| {
            text.extend_from_slice(separator);
            Ok(serde_json::to_writer(text, item)?)
        })?;
        self.length += 1;
        Ok(Index::new(self.length - 1))
    }

    fn len(&self) -> u32 {
        self.length
    }

    fn put_into(self, key: &str, json: &mut Json) {
        if self.length > 0 {
            json.0.push(format!(",\n\"{key}\":[").into_bytes().into());
            json.0.push(self.text);
            json.0.push(b"]".to_vec().into());
        }
    }
}

/// A glTF file in the making.
pub(super) struct Document<'a> {
    nodes: List<json::Node>,
    meshes: List<json::Mesh>,
    animations: List<json::Animation>,
    accessors: List<json::Accessor>,
    views: List<buffer::View>,
    output: GltfOutput<'a>,
    /// How much data there is.
    bytes: u64,
    /// What has been written already, by the address of the shared original, which is kept from being used again.
    shared: HashMap<usize, (Keep, Index<json::Accessor>)>,
}

/// Keeps something at its address.
type Keep = Box<dyn std::any::Any + Send>;

/// How a reader uses the numbers of an accessor.
#[derive(Clone, Copy)]
pub(super) enum AccessorRole {
    /// One for each vertex.
    VertexAttribute,
    /// Key frames.
    KeyFrames,
}

impl<'a> Document<'a> {
    pub(super) fn new(output: GltfOutput<'a>) -> Self {
        Self {
            nodes: List::default(),
            meshes: List::default(),
            animations: List::default(),
            accessors: List::default(),
            views: List::default(),
            output,
            bytes: 0,
            shared: HashMap::new(),
        }
    }

    /// Writes what `make` makes of `original` once for all who share it.
    ///
    /// # Errors
    ///
    /// Those of `make`.
    pub(super) fn shared<T: Send + Sync + 'static>(
        &mut self,
        original: &Arc<T>,
        make: impl FnOnce(&mut Self) -> Result<Index<json::Accessor>, WriteError>,
    ) -> Result<Index<json::Accessor>, WriteError> {
        // What is not shared now never will be, and need not be kept in memory.
        if Arc::strong_count(original) == 1 {
            return make(self);
        }
        let address = Arc::as_ptr(original) as usize;
        if let Some((_, accessor)) = self.shared.get(&address) {
            return Ok(*accessor);
        }
        let accessor = make(self)?;
        let keep = Box::new(original.clone());
        self.shared.insert(address, (keep, accessor));
        Ok(accessor)
    }

    pub(super) fn node(&mut self, node: &impl Serialize) -> Result<Index<json::Node>, WriteError> {
        Ok(self.nodes.push(node, self.output.directory())?)
    }

    pub(super) fn mesh(&mut self, mesh: &impl Serialize) -> Result<Index<json::Mesh>, WriteError> {
        Ok(self.meshes.push(mesh, self.output.directory())?)
    }

    pub(super) fn animation(&mut self, animation: &json::Animation) -> Result<(), WriteError> {
        self.animations.push(animation, self.output.directory())?;
        Ok(())
    }

    /// Small vectors, one for each of `values`, which are told by their numbers too.
    ///
    /// # Errors
    ///
    /// The file cannot be written.
    pub(super) fn vectors<T: Sync, const N: usize>(
        &mut self,
        values: &[T],
        vector: impl Fn(usize, &T) -> [f32; N] + Sync,
        bounds: Option<Bounds<N>>,
        of_what: AccessorRole,
    ) -> Result<Index<json::Accessor>, WriteError> {
        let number = |index: usize| vector(index, &values[index]);
        self.numbers(values.len(), number, bounds, of_what)
    }

    /// So many small vectors.
    ///
    /// # Errors
    ///
    /// The file cannot be written.
    pub(super) fn numbers<const N: usize>(
        &mut self,
        count: usize,
        vector: impl Fn(usize) -> [f32; N] + Sync,
        bounds: Option<Bounds<N>>,
        of_what: AccessorRole,
    ) -> Result<Index<json::Accessor>, WriteError> {
        let target = match of_what {
            AccessorRole::VertexAttribute => Some(buffer::Target::ArrayBuffer),
            AccessorRole::KeyFrames => None,
        };
        let shape = match N {
            1 => accessor::Type::Scalar,
            2 => accessor::Type::Vec2,
            3 => accessor::Type::Vec3,
            _ => accessor::Type::Vec4,
        };
        let view = self.view(4 * N * count, target, |output| {
            write_items(output, count, |index| vector(index).map(f32::to_le_bytes))
        })?;
        let kind = (accessor::ComponentType::F32, shape);
        self.accessor(view, count, kind, bounds)
    }

    /// Three numbers made of the position of each vertex of a mesh.
    ///
    /// # Errors
    ///
    /// The file cannot be written.
    pub(super) fn positions(
        &mut self,
        mesh: &Mesh,
        numbers: impl Fn(DVec3) -> [f32; 3] + Sync,
        bounds: Bounds<3>,
    ) -> Result<Index<json::Accessor>, WriteError> {
        self.of_vertices(mesh, Some(bounds), |first, items| {
            let mut positions = [DVec3::ZERO; VERTICES_AT_ONCE];
            let positions = &mut positions[..items.len()];
            mesh.read_vertices(first, positions, None);
            for (item, &position) in items.iter_mut().zip(&*positions) {
                *item = numbers(position).map(f32::to_le_bytes);
            }
        })
    }

    /// Three numbers made of the normal of each vertex of a mesh, which has some.
    ///
    /// # Errors
    ///
    /// The file cannot be written.
    pub(super) fn normals(
        &mut self,
        mesh: &Mesh,
        numbers: impl Fn(DVec3) -> [f32; 3] + Sync,
    ) -> Result<Index<json::Accessor>, WriteError> {
        self.of_vertices(mesh, None, |first, items| {
            let mut positions = [DVec3::ZERO; VERTICES_AT_ONCE];
            let mut normals = [DVec3::ZERO; VERTICES_AT_ONCE];
            let (positions, normals) = (&mut positions[..items.len()], &mut normals[..items.len()]);
            mesh.read_vertices(first, positions, Some(&mut *normals));
            for (item, &normal) in items.iter_mut().zip(&*normals) {
                *item = numbers(normal).map(f32::to_le_bytes);
            }
        })
    }

    fn of_vertices(
        &mut self,
        mesh: &Mesh,
        bounds: Option<Bounds<3>>,
        make: impl Fn(usize, &mut [[[u8; 4]; 3]]) + Sync,
    ) -> Result<Index<json::Accessor>, WriteError> {
        let count = mesh.vertex_count();
        let target = Some(buffer::Target::ArrayBuffer);
        let view = self.view(12 * count, target, |output| {
            write_pieces(output, count, |first, items: &mut [_]| {
                let firsts = (first..).step_by(VERTICES_AT_ONCE);
                for (first, items) in firsts.zip(items.chunks_mut(VERTICES_AT_ONCE)) {
                    make(first, items);
                }
            })
        })?;
        let kind = (accessor::ComponentType::F32, accessor::Type::Vec3);
        self.accessor(view, count, kind, bounds)
    }

    /// Four bytes for each vertex, from 0 to 1.
    ///
    /// # Errors
    ///
    /// The file cannot be written.
    pub(super) fn colors<T: Sync>(
        &mut self,
        values: &[T],
        color: impl Fn(&T) -> [u8; 4] + Sync,
    ) -> Result<Index<json::Accessor>, WriteError> {
        let target = Some(buffer::Target::ArrayBuffer);
        let view = self.view(4 * values.len(), target, |output| {
            write_items(output, values.len(), |index| [color(&values[index])])
        })?;
        let kind = (accessor::ComponentType::U8, accessor::Type::Vec4);
        self.accessor::<1>(view, values.len(), kind, None)
    }

    /// The corners of triangles.
    ///
    /// # Errors
    ///
    /// The file cannot be written.
    pub(super) fn indices(
        &mut self,
        triangles: &Triangles,
    ) -> Result<Index<json::Accessor>, WriteError> {
        let target = Some(buffer::Target::ElementArrayBuffer);
        let view = self.view(12 * triangles.len(), target, |output| {
            let item = |index: usize| triangles.at(index).map(u32::to_le_bytes);
            write_items(output, triangles.len(), item)
        })?;
        let kind = (accessor::ComponentType::U32, accessor::Type::Scalar);
        self.accessor::<1>(view, 3 * triangles.len(), kind, None)
    }

    /// An image as it is.
    ///
    /// # Errors
    ///
    /// The file cannot be written.
    pub(super) fn image(&mut self, bytes: &[u8]) -> Result<Index<buffer::View>, WriteError> {
        self.view(bytes.len(), None, |output| output.write_all(bytes))
    }

    fn accessor<const N: usize>(
        &mut self,
        view: Index<buffer::View>,
        count: usize,
        (component, shape): (accessor::ComponentType, accessor::Type),
        bounds: Option<Bounds<N>>,
    ) -> Result<Index<json::Accessor>, WriteError> {
        let accessor = json::Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: USize64::from(count),
            component_type: Checked::Valid(accessor::GenericComponentType(component)),
            extensions: None,
            extras: None,
            type_: Checked::Valid(shape),
            // f32 as f64 prints every digit that tells it apart, so that bounds read back exactly.
            min: bounds.map(|bounds| json!(bounds.min.as_slice())),
            max: bounds.map(|bounds| json!(bounds.max.as_slice())),
            name: None,
            normalized: component == accessor::ComponentType::U8,
            sparse: None,
        };
        Ok(self.accessors.push(&accessor, self.output.directory())?)
    }

    fn view(
        &mut self,
        length: usize,
        target: Option<buffer::Target>,
        write: impl FnOnce(&mut GltfOutput<'a>) -> io::Result<()>,
    ) -> Result<Index<buffer::View>, WriteError> {
        let lists = [
            self.nodes.text.len(),
            self.meshes.text.len(),
            self.accessors.text.len(),
            self.views.text.len(),
        ];
        let meshes = self.meshes.len() as usize;
        self.output.describe(meshes, lists.iter().sum());
        // Every view starts at a multiple of four, whatever an image's length.
        let padding = self.bytes.next_multiple_of(4) - self.bytes;
        self.output.write_all(&[0; 4][..padding as usize])?;
        write(&mut self.output)?;
        let offset = self.bytes + padding;
        self.bytes = offset + length as u64;
        // What comes after this is in vain.
        self.output.check_size(self.bytes)?;
        let view = buffer::View {
            buffer: Index::new(0),
            byte_length: USize64::from(length),
            byte_offset: Some(USize64(offset)),
            byte_stride: None,
            name: None,
            target: target.map(Checked::Valid),
            extensions: None,
            extras: None,
        };
        Ok(self.views.push(&view, self.output.directory())?)
    }

    /// Writes the JSON, in which `others` come before the lists of this document.
    ///
    /// # Errors
    ///
    /// More than 4 GiB in a GLB, or the file cannot be written.
    pub(super) fn finish(self, others: &Value) -> Result<(), WriteError> {
        let mut buffers = List::<json::Buffer>::default();
        let buffer = json::Buffer {
            byte_length: USize64(self.bytes),
            name: None,
            uri: self.output.binary_name(),
            extensions: None,
            extras: None,
        };
        buffers.push(&buffer, self.output.directory())?;
        let mut root = b"{".to_vec();
        for (index, (key, value)) in others.as_object().into_iter().flatten().enumerate() {
            let separator = if index == 0 { "" } else { "," };
            write!(root, "{separator}\n{}:{value}", json!(key))?;
        }
        let mut json = Json(vec![root.into()]);
        self.nodes.put_into("nodes", &mut json);
        self.meshes.put_into("meshes", &mut json);
        self.animations.put_into("animations", &mut json);
        self.accessors.put_into("accessors", &mut json);
        self.views.put_into("bufferViews", &mut json);
        buffers.put_into("buffers", &mut json);
        json.0.push(b"\n}".to_vec().into());
        self.output.finish(json, self.bytes)
    }
}
