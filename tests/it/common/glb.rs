//! GLB files taken apart and made in a test.

use serde_json::{Value, json};

/// A GLB file, taken apart.
pub(crate) struct Glb {
    /// The JSON as it is in the file, without the spaces behind it.
    pub(crate) text: String,
    pub(crate) json: Value,
    pub(crate) binary: Vec<u8>,
}

impl Glb {
    /// Panics unless the file is whole: each length in it is as said.
    #[track_caller]
    pub(crate) fn new(bytes: &[u8]) -> Self {
        let word = |at: usize| {
            let word = bytes[at..at + 4].try_into().expect("four bytes");
            u32::from_le_bytes(word) as usize
        };
        assert_eq!((&bytes[..4], word(4)), (&b"glTF"[..], 2));
        assert_eq!(word(8), bytes.len(), "the file is whole");
        assert_eq!(&bytes[16..20], b"JSON");
        let end = 20 + word(12);
        let text = std::str::from_utf8(&bytes[20..end]).expect("text");
        let binary = if end == bytes.len() {
            vec![]
        } else {
            assert_eq!(&bytes[end + 4..end + 8], b"BIN\0");
            assert_eq!(word(end), bytes.len() - end - 8, "nothing follows");
            bytes[end + 8..].to_vec()
        };
        Self {
            text: text.trim_end().to_owned(),
            json: serde_json::from_str(text).expect("JSON"),
            binary,
        }
    }

    /// The bytes of a view, given its index.
    pub(crate) fn view(&self, view: &Value) -> &[u8] {
        let view = &self.json["bufferViews"][index(view)];
        let start = view["byteOffset"].as_u64().unwrap_or(0) as usize;
        &self.binary[start..start + index(&view["byteLength"])]
    }

    /// The numbers of an accessor, given its index, which all are `f32` one after the other.
    pub(crate) fn numbers(&self, accessor: &Value) -> Vec<f32> {
        let accessor = &self.json["accessors"][index(accessor)];
        assert_eq!(accessor["componentType"], 5126);
        let start = accessor["byteOffset"].as_u64().unwrap_or(0) as usize;
        let count = index(&accessor["count"]) * width(accessor["type"].as_str().expect("a type"));
        let words = self.view(&accessor["bufferView"])[start..].as_chunks().0;
        assert!(words.len() >= count, "{accessor}");
        words[..count]
            .iter()
            .map(|&word| f32::from_le_bytes(word))
            .collect()
    }
}

/// An index or a number of something in the JSON.
pub(crate) fn index(value: &Value) -> usize {
    value.as_u64().expect("an index") as usize
}

/// How many numbers an element has.
fn width(kind: &str) -> usize {
    match kind {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" => 4,
        "MAT4" => 16,
        other => panic!("{other}"),
    }
}

/// A GLB file of this JSON, which says how long its buffer is, and this data.
pub(crate) fn pack(json: &Value, data: &[u8]) -> Vec<u8> {
    let mut json = json.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut data = data.to_vec();
    data.resize(data.len().next_multiple_of(4), 0);
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend((28 + json.len() as u32 + data.len() as u32).to_le_bytes());
    for (name, content) in [(b"JSON", &json), (b"BIN\0", &data)] {
        glb.extend((content.len() as u32).to_le_bytes());
        glb.extend(name);
        glb.extend(content);
    }
    glb
}

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
        let bytes: Vec<u8> = values.iter().copied().flat_map(f32::to_le_bytes).collect();
        self.accessor(kind, 5126, values.len() / width(kind), &bytes)
    }

    /// Adds an accessor without a view: all zeros.
    pub(crate) fn zeros(&mut self, kind: &str, count: usize) -> usize {
        let accessor = json!({ "type": kind, "componentType": 5126, "count": count });
        push(&mut self.json["accessors"], accessor)
    }

    pub(crate) fn bytes(&self) -> Vec<u8> {
        let mut all = self.json.clone();
        all["buffers"] = json!([{ "byteLength": self.data.len() }]);
        pack(&all, &self.data)
    }
}

/// Adds to a list; returns the index.
pub(crate) fn push(list: &mut Value, item: Value) -> usize {
    let list = list.as_array_mut().expect("a list");
    list.push(item);
    list.len() - 1
}
