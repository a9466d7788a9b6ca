//! The two halves of a glTF file in the making: lists of JSON, and the data that they are about.
//!
//! Whatever is added is turned into text and bytes at once, so that a file of many steps takes no more memory than its
//! JSON; the data goes on to a stream.

use std::collections::HashMap;
use std::io::Write;
use std::marker::PhantomData;
use std::sync::Arc;

use gltf::json::validation::{Checked, USize64};
use gltf::json::{self, Index, accessor, buffer};
use serde::Serialize;
use serde_json::{Value, json};

use super::WriteError;
use super::pack::Local;

/// A list of a glTF file, as the text between its brackets.
pub(super) struct List<T> {
    text: Vec<u8>,
    length: u32,
    /// Of what indices into the list are.
    kind: PhantomData<T>,
}

impl<T> Default for List<T> {
    fn default() -> Self {
        Self {
            text: vec![],
            length: 0,
            kind: PhantomData,
        }
    }
}

impl<T> List<T> {
    pub(super) fn push(&mut self, item: &impl Serialize) -> Index<T> {
        let separator: &[u8] = if self.length == 0 { b"\n" } else { b",\n" };
        self.text.extend_from_slice(separator);
        serde_json::to_writer(&mut self.text, item).expect("glTF is JSON");
        self.length += 1;
        Index::new(self.length - 1)
    }

    pub(super) fn len(&self) -> u32 {
        self.length
    }

    fn write(self, key: &str, root: &mut Vec<u8>) {
        if self.length > 0 {
            root.extend_from_slice(format!(",\n\"{key}\":[").as_bytes());
            root.extend_from_slice(&self.text);
            root.push(b']');
        }
    }
}

/// A glTF file in the making whose data goes to `W`.
pub(super) struct Document<W> {
    pub(super) nodes: List<json::Node>,
    pub(super) meshes: List<json::Mesh>,
    pub(super) animations: List<json::Animation>,
    accessors: List<json::Accessor>,
    views: List<buffer::View>,
    data: W,
    /// How much data there is.
    bytes: u64,
    /// What has been written already, by the address of the shared original, which is kept from being used again.
    shared: HashMap<usize, (Keep, Index<json::Accessor>)>,
}

/// Keeps something at its address.
type Keep = Box<dyn std::any::Any + Send>;

impl<W: Write> Document<W> {
    pub(super) fn new(data: W) -> Self {
        Self {
            nodes: List::default(),
            meshes: List::default(),
            animations: List::default(),
            accessors: List::default(),
            views: List::default(),
            data,
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
        original: &Arc<Vec<T>>,
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

    /// Positions relative to an offset, with their bounds.
    pub(super) fn local(&mut self, local: &Local) -> Result<Index<json::Accessor>, WriteError> {
        let bounds = Some((local.min.to_vec(), local.max.to_vec()));
        let kind = (accessor::ComponentType::F32, accessor::Type::Vec3);
        let target = Some(buffer::Target::ArrayBuffer);
        let view = self.view(&bytes_of(&local.values), target)?;
        Ok(self.accessor(view, local.values.len(), kind, false, bounds))
    }

    /// A vector for each vertex.
    pub(super) fn vectors<const N: usize>(
        &mut self,
        values: &[[f32; N]],
        shape: accessor::Type,
    ) -> Result<Index<json::Accessor>, WriteError> {
        let view = self.view(&bytes_of(values), Some(buffer::Target::ArrayBuffer))?;
        let kind = (accessor::ComponentType::F32, shape);
        Ok(self.accessor(view, values.len(), kind, false, None))
    }

    /// Four bytes for each vertex, from 0 to 1.
    pub(super) fn colors(&mut self, values: &[u8]) -> Result<Index<json::Accessor>, WriteError> {
        let view = self.view(values, Some(buffer::Target::ArrayBuffer))?;
        let kind = (accessor::ComponentType::U8, accessor::Type::Vec4);
        Ok(self.accessor(view, values.len() / 4, kind, true, None))
    }

    /// The corners of triangles.
    pub(super) fn indices(
        &mut self,
        triangles: &[[u32; 3]],
    ) -> Result<Index<json::Accessor>, WriteError> {
        let indices = triangles.as_flattened();
        let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        let view = self.view(&bytes, Some(buffer::Target::ElementArrayBuffer))?;
        let kind = (accessor::ComponentType::U32, accessor::Type::Scalar);
        Ok(self.accessor(view, indices.len(), kind, false, None))
    }

    /// Numbers that are no attributes of vertices: key frames.
    pub(super) fn keys<const N: usize>(
        &mut self,
        values: &[[f32; N]],
        shape: accessor::Type,
    ) -> Result<Index<json::Accessor>, WriteError> {
        let view = self.view(&bytes_of(values), None)?;
        let bounds = |least: fn(f32, f32) -> f32, start: f32| {
            let axis = |axis: usize| values.iter().fold(start, |b, v| least(b, v[axis]));
            (0..N).map(axis).collect()
        };
        let low = bounds(f32::min, f32::INFINITY);
        let high = bounds(f32::max, f32::NEG_INFINITY);
        let kind = (accessor::ComponentType::F32, shape);
        Ok(self.accessor(view, values.len(), kind, false, Some((low, high))))
    }

    fn accessor(
        &mut self,
        view: Index<buffer::View>,
        count: usize,
        (component, shape): (accessor::ComponentType, accessor::Type),
        normalized: bool,
        bounds: Option<(Vec<f32>, Vec<f32>)>,
    ) -> Index<json::Accessor> {
        let (min, max) = bounds.unzip();
        self.accessors.push(&json::Accessor {
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

    pub(super) fn view(
        &mut self,
        bytes: &[u8],
        target: Option<buffer::Target>,
    ) -> Result<Index<buffer::View>, WriteError> {
        // Every view starts at a multiple of four, whatever an image's length.
        let padding = self.bytes.next_multiple_of(4) - self.bytes;
        self.data.write_all(&[0; 4][..padding as usize])?;
        self.data.write_all(bytes)?;
        let offset = self.bytes + padding;
        self.bytes = offset + bytes.len() as u64;
        Ok(self.views.push(&buffer::View {
            buffer: Index::new(0),
            byte_length: USize64::from(bytes.len()),
            byte_offset: Some(USize64(offset)),
            byte_stride: None,
            name: None,
            target: target.map(Checked::Valid),
            extensions: None,
            extras: None,
        }))
    }

    /// How much data there is so far.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The JSON, in which `others` come before the lists of this document, and the stream that the data went to.
    pub(super) fn finish(mut self, others: &Value, uri: Option<String>) -> (Vec<u8>, W) {
        let mut buffers = List::<json::Buffer>::default();
        buffers.push(&json::Buffer {
            byte_length: USize64(self.bytes),
            name: None,
            uri,
            extensions: None,
            extras: None,
        });
        let mut root = b"{".to_vec();
        for (index, (key, value)) in others.as_object().into_iter().flatten().enumerate() {
            let separator = if index == 0 { "" } else { "," };
            root.extend_from_slice(format!("{separator}\n{}:{value}", json!(key)).as_bytes());
        }
        // Each is given back when it has been copied.
        std::mem::take(&mut self.nodes).write("nodes", &mut root);
        std::mem::take(&mut self.meshes).write("meshes", &mut root);
        std::mem::take(&mut self.animations).write("animations", &mut root);
        std::mem::take(&mut self.accessors).write("accessors", &mut root);
        std::mem::take(&mut self.views).write("bufferViews", &mut root);
        buffers.write("buffers", &mut root);
        root.extend_from_slice(b"\n}");
        (root, self.data)
    }
}

fn bytes_of<const N: usize>(values: &[[f32; N]]) -> Vec<u8> {
    let numbers = values.as_flattened().iter();
    numbers.flat_map(|number| number.to_le_bytes()).collect()
}
