//! GLB files made in a test.

use serde_json::{Value, json};

/// A GLB file in the making: one scene of one node with one mesh, to be changed as a test likes.
pub(crate) struct MadeGlb {
    pub(crate) json: Value,
    data: Vec<u8>,
}

impl MadeGlb {
    /// A node `it` with a mesh of one primitive, without any data.
    pub(crate) fn new() -> Self {
        Self {
            json: json!({
                "asset": { "version": "2.0" },
                "scene": 0,
                "scenes": [{ "nodes": [0] }],
                "nodes": [{ "name": "it", "mesh": 0 }],
                "meshes": [{ "name": "made", "primitives": [{ "attributes": {} }] }],
                "accessors": [],
                "bufferViews": [],
            }),
            data: vec![],
        }
    }

    /// The same with a triangle in the plane z = 0 that faces up, and so many vertices that nothing uses.
    pub(crate) fn triangle(unused: usize) -> Self {
        let mut glb = Self::new();
        let mut corners = vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        corners.resize(9 + 3 * unused, 0.5);
        let positions = glb.floats("VEC3", &corners);
        let indices = glb.accessor("SCALAR", 5121, 3, &[0, 1, 2]);
        let primitive = glb.primitive();
        primitive["attributes"]["POSITION"] = positions.into();
        primitive["indices"] = indices.into();
        glb
    }

    pub(crate) fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    /// Adds an accessor of `count` elements with a view of its own; returns its index.
    pub(crate) fn accessor(
        &mut self,
        kind: &str,
        component: u32,
        count: usize,
        bytes: &[u8],
    ) -> usize {
        self.data.resize(self.data.len().next_multiple_of(4), 0);
        let view = json!({ "buffer": 0, "byteOffset": self.data.len(), "byteLength": bytes.len() });
        self.data.extend_from_slice(bytes);
        let view = push(&mut self.json["bufferViews"], view);
        let accessor =
            json!({ "type": kind, "componentType": component, "count": count, "bufferView": view });
        push(&mut self.json["accessors"], accessor)
    }

    /// Adds an accessor of floats.
    pub(crate) fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let width = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let bytes: Vec<u8> = values.iter().copied().flat_map(f32::to_le_bytes).collect();
        self.accessor(kind, 5126, values.len() / width, &bytes)
    }

    /// Adds an accessor without a view: all zeros.
    pub(crate) fn zeros(&mut self, kind: &str, count: usize) -> usize {
        let accessor = json!({ "type": kind, "componentType": 5126, "count": count });
        push(&mut self.json["accessors"], accessor)
    }

    pub(crate) fn bytes(&self) -> Vec<u8> {
        let mut all = self.json.clone();
        all["buffers"] = json!([{ "byteLength": self.data.len() }]);
        let mut json = all.to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut glb = b"glTF\x02\0\0\0".to_vec();
        glb.extend((28 + json.len() as u32 + self.data.len() as u32).to_le_bytes());
        for (name, content) in [(b"JSON", &json), (b"BIN\0", &self.data)] {
            glb.extend((content.len() as u32).to_le_bytes());
            glb.extend(name);
            glb.extend(content);
        }
        glb
    }
}

/// Adds to a list; returns the index.
pub(crate) fn push(list: &mut Value, item: Value) -> usize {
    let list = list.as_array_mut().expect("a list");
    list.push(item);
    list.len() - 1
}
