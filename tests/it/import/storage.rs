//! However the numbers of a glTF file are stored, the same model is read, bit for bit, and the same is wrong with it.
//!
//! What is stored in the ordinary way is decoded by several threads straight from the file. Sparse accessors go
//! another way, number by number; with substitutes that change nothing they are the reference here.

use std::path::Path;

use crate::common::glb::pack;
use photosurface::Model;
use photosurface::read::{read_gltf_bytes, read_model};
use serde_json::{Value, json};

const FLOAT: usize = 5126;
const VERTICES: usize = 5000;
/// Few enough for an index of one byte, so that it can be stored in all sizes.
const USED: usize = 250;

/// A mesh large enough for several jobs.
struct Content {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    texture_coordinates: Vec<[f32; 2]>,
    indices: Vec<u32>,
}

/// Of many ways to write it.
#[derive(Clone, Copy, Debug)]
struct Storage {
    interleaved: bool,
    sparse: bool,
    /// Bytes of an index.
    index_size: usize,
}

const REFERENCE: Storage = Storage {
    interleaved: false,
    sparse: true,
    index_size: 4,
};

impl Content {
    fn new() -> Self {
        let wave = |i: usize, k: usize| ((i * (2 * k + 3)) as f32 * 0.37).sin();
        Self {
            positions: (0..VERTICES)
                .map(|i| [wave(i, 0), 10.0 * wave(i, 1), 1e-3 * wave(i, 2)])
                .collect(),
            normals: (0..VERTICES)
                .map(|i| [wave(i, 3), wave(i, 4), 1.5 + wave(i, 5)])
                .collect(),
            texture_coordinates: (0..VERTICES).map(|i| [wave(i, 6), wave(i, 7)]).collect(),
            indices: (0..3 * 4000).map(|i| (i * 7 % USED) as u32).collect(),
        }
    }

    fn glb(&self, storage: Storage) -> Vec<u8> {
        let floats = |values: &[f32]| -> Vec<u8> {
            values.iter().copied().flat_map(f32::to_le_bytes).collect()
        };
        let attributes = [
            ("POSITION", self.positions.as_flattened(), 3),
            ("NORMAL", self.normals.as_flattened(), 3),
            ("TEXCOORD_0", self.texture_coordinates.as_flattened(), 2),
        ];
        let (mut data, mut views, mut accessors) = (vec![], vec![], vec![]);
        let mut view = |bytes: &[u8], stride: Option<usize>| -> usize {
            let mut view =
                json!({ "buffer": 0, "byteOffset": data.len(), "byteLength": bytes.len() });
            if let Some(stride) = stride {
                view["byteStride"] = stride.into();
            }
            data.extend_from_slice(bytes);
            data.resize(data.len().next_multiple_of(4), 0);
            views.push(view);
            views.len() - 1
        };
        let mut together = vec![];
        for vertex in 0..VERTICES {
            for (_, values, width) in attributes {
                together.extend(floats(&values[vertex * width..][..width]));
            }
        }
        let together = view(&together, Some(32));
        let mut offset = 0;
        for (_, values, width) in attributes {
            let (view_index, byte_offset) = match storage.interleaved {
                true => (together, offset),
                false => (view(&floats(values), None), 0),
            };
            offset += 4 * width;
            let kind = format!("VEC{width}");
            let mut accessor = json!({ "bufferView": view_index, "byteOffset": byte_offset,
                "componentType": FLOAT, "type": kind, "count": VERTICES });
            if storage.sparse {
                let same = view(&floats(&values[..width]), None);
                accessor["sparse"] = substitute(view(&[0], None), same);
            }
            accessors.push(accessor);
        }
        let bytes = |indices: &[u32]| -> Vec<u8> {
            let bytes = indices.iter().map(|index| index.to_le_bytes());
            bytes
                .flat_map(|b| b[..storage.index_size].to_vec())
                .collect()
        };
        let component = [5121, 5123, 0, 5125][storage.index_size - 1];
        let mut accessor = json!({ "bufferView": view(&bytes(&self.indices), None),
            "componentType": component, "type": "SCALAR", "count": self.indices.len() });
        if storage.sparse {
            let same = view(&bytes(&self.indices[..1]), None);
            accessor["sparse"] = substitute(view(&[0], None), same);
        }
        accessors.push(accessor);
        let primitive =
            json!({ "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2 }, "indices": 3 });
        pack(
            &json!({ "asset": { "version": "2.0" }, "nodes": [{ "mesh": 0, "translation": [0.1, 0, 0] }],
                "meshes": [{ "primitives": [primitive] }], "accessors": accessors, "bufferViews": views,
                "buffers": [{ "byteLength": data.len() }] }),
            &data,
        )
    }

    /// The model and its notes, or what is wrong with it.
    fn read(&self, storage: Storage) -> Result<(Model, Vec<String>), String> {
        let bytes = self.glb(storage);
        let file = tempfile::Builder::new().suffix(".glb").tempfile();
        let file = file.expect("a temporary file");
        std::fs::write(file.path(), &bytes).expect("written");
        let from_file = read_model(file.path()).map_err(|error| error.to_string());
        let from_bytes = read_gltf_bytes(&bytes, Path::new("")).map_err(|error| error.to_string());
        let with_notes = |(model, findings): (Model, photosurface::read::Findings)| {
            let notes = findings.notes.iter().map(ToString::to_string);
            (model, notes.collect())
        };
        let from_file = from_file.map(with_notes);
        assert!(from_file == from_bytes.map(with_notes), "{storage:?}");
        from_file
    }
}

/// A sparse accessor's way to say that its first element is what it is.
fn substitute(first: usize, same: usize) -> Value {
    json!({ "count": 1, "indices": { "bufferView": first, "componentType": 5121 },
        "values": { "bufferView": same } })
}

/// All but the reference.
fn storages() -> Vec<Storage> {
    let mut storages = vec![];
    for interleaved in [false, true] {
        for sparse in [false, true] {
            for index_size in [1, 2, 4] {
                storages.push(Storage {
                    interleaved,
                    sparse,
                    index_size,
                });
            }
        }
    }
    storages
}

#[test]
fn one_model_from_every_storage() {
    let content = Content::new();
    let expected = content.read(REFERENCE).expect("nothing is wrong with it");
    assert_eq!(expected.0.vertex_count(), VERTICES);
    assert_eq!(expected.0.triangle_count(), 4000);
    let mesh = expected.0.parts[0].mesh();
    // What the file says, not only what the other way makes of it.
    let last = content.positions[VERTICES - 1].map(f64::from);
    assert_eq!(
        mesh.positions()[VERTICES - 1].to_array(),
        [last[0] + 0.1, last[1], last[2]]
    );
    assert_eq!(mesh.triangles()[3999].as_slice(), &content.indices[11997..]);
    for storage in storages() {
        assert!(
            content.read(storage).as_ref() == Ok(&expected),
            "{storage:?}"
        );
    }
}

#[test]
fn the_same_is_wrong_in_every_storage() {
    type Change = fn(&mut Content);
    let faults: [(Change, &str); 5] = [
        (
            |content| content.positions[4321][1] = f32::NAN,
            "POSITION of vertex 4321 is [",
        ),
        (
            |content| content.normals[1234][2] = f32::INFINITY,
            "NORMAL of vertex 1234 is [",
        ),
        (
            |content| content.texture_coordinates[4999][0] = f32::NAN,
            "TEXCOORD of vertex 4999 is [",
        ),
        (
            |content| content.indices[6001] = VERTICES as u32,
            "triangle 2000 uses vertex 5000, expected an index below 5000",
        ),
        (
            |content| content.indices[6001] = u32::MAX,
            "index 6001 is 4294967295, which glTF reserves for primitive restart",
        ),
    ];
    for (change, expected) in faults {
        let mut content = Content::new();
        change(&mut content);
        let reference = content.read(REFERENCE).expect_err(expected);
        assert!(reference.contains(expected), "{reference}");
        for storage in storages() {
            if storage.index_size == 4 {
                assert_eq!(
                    content.read(storage).err().as_ref(),
                    Some(&reference),
                    "{storage:?}"
                );
            }
        }
    }
}

#[test]
fn a_normal_of_no_length_is_replaced_in_every_storage() {
    let mut content = Content::new();
    content.normals[content.indices[0] as usize] = [0.0; 3];
    let expected = content.read(REFERENCE).expect("a note and no error");
    let noted = expected.1.iter().any(|note| note.contains("1 zero normal"));
    assert!(noted, "{:?}", expected.1);
    for storage in storages() {
        assert!(
            content.read(storage).as_ref() == Ok(&expected),
            "{storage:?}"
        );
    }
}
