//! What surfaces look like goes through the program unchanged: whole glTF in, whole glTF out.
//!
//! Seen from rest, a file comes out as it went in. Both files are read here from their bytes, with every
//! reference replaced by what it refers to, and compared.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::common::glb::{Glb, index};
use photosurface::read::{Note, read_model};
use photosurface::write::{Export, write_glb};
use photosurface::{Object, Observer, Photosurface, PlacedScene, Scene, Source, SurfaceOptions};
use serde_json::{Value, json};

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("fixtures/meshes")
        .join(name)
}

impl Glb {
    fn image(&self, image: &Value) -> Value {
        let mut image = self.json["images"][index(image)].clone();
        image["bufferView"] = self.view(&image["bufferView"]).into();
        image
    }

    fn texture(&self, texture: &Value) -> Value {
        let mut texture = self.json["textures"][index(texture)].clone();
        if let Some(sampler) = texture.get_mut("sampler") {
            *sampler = self.json["samplers"][index(sampler)].clone();
        }
        if let Some(source) = texture.get_mut("source") {
            *source = self.image(source);
        }
        if let Some(source) = texture.pointer_mut("/extensions/EXT_texture_webp/source") {
            *source = self.image(source);
        }
        texture
    }

    /// The material of a primitive with its textures in place of their indices.
    fn material(&self, primitive: &Value) -> Value {
        let mut material = self.json["materials"][index(&primitive["material"])].clone();
        for slot in [
            "/pbrMetallicRoughness/baseColorTexture",
            "/pbrMetallicRoughness/metallicRoughnessTexture",
            "/normalTexture",
            "/occlusionTexture",
            "/emissiveTexture",
            "/extensions/KHR_materials_clearcoat/clearcoatTexture",
            "/extensions/KHR_materials_clearcoat/clearcoatNormalTexture",
            "/extensions/KHR_materials_transmission/transmissionTexture",
            "/extensions/ACME_glitter/layers/0/glitterTexture",
        ] {
            if let Some(info) = material.pointer_mut(slot) {
                info["index"] = self.texture(&info["index"]);
            }
        }
        material
    }

    /// The bytes of an attribute.
    fn attribute(&self, primitive: &Value, name: &str) -> &[u8] {
        let accessor = &self.json["accessors"][index(&primitive["attributes"][name])];
        assert_eq!(accessor.get("byteOffset"), None, "{name}");
        self.view(&accessor["bufferView"])
    }
}

/// A fixture as the program writes it, seen from rest, at two steps; and the notes.
fn pass_through(name: &str) -> (Glb, Vec<String>) {
    let (model, findings) = read_model(&fixture(name)).expect(name);
    let object = Object::new("it", Source::Model(Arc::new(model.clone())));
    let scene = Scene::new(Observer::default(), vec![object]).expect("one object");
    let scene = scene.with_steps(vec![0.0, 1.0]).expect("two steps");
    let placed = PlacedScene::new(scene, vec![model]).expect("one model an object");
    let wanted = SurfaceOptions {
        subdivide: false,
        ..SurfaceOptions::default()
    };
    let steps = 0..2;
    let photosurfaces: Vec<Photosurface> = steps
        .flat_map(|step| placed.photosurfaces(step, wanted).expect("a step"))
        .collect();
    let export = Export {
        scene: &placed.facts(),
        marker: None,
        photosurfaces: &photosurfaces,
        playback: None,
    };
    let mut bytes = vec![];
    write_glb(&export, &mut bytes).expect(name);
    let notes = findings.notes.iter().map(Note::to_string).collect();
    (Glb::new(&bytes), notes)
}

/// The primitives of both files, those of the second for both steps.
fn pairs<'a>(before: &'a Glb, after: &'a Glb) -> Vec<(&'a Value, &'a Value)> {
    let before = before.json["meshes"][0]["primitives"].as_array();
    let before = before.expect("primitives");
    let after = after.json["meshes"].as_array().expect("meshes");
    assert_eq!(after.len(), 2 * before.len());
    let after = after.iter().map(|mesh| &mesh["primitives"][0]);
    before.iter().cycle().zip(after).collect()
}

#[test]
fn everything_that_materials_say_comes_out_as_it_went_in() {
    for name in ["looks.glb", "webp.glb"] {
        let before = Glb::new(&std::fs::read(fixture(name)).expect(name));
        let (after, _) = pass_through(name);
        for (old, new) in pairs(&before, &after) {
            let (old, new) = (before.material(old), after.material(new));
            // As text too: equal numbers need not be the same digits.
            assert_eq!(old, new, "{name}");
            assert_eq!(sorted(&old).to_string(), sorted(&new).to_string(), "{name}");
        }
    }
}

/// The same with keys in order, at all depths.
fn sorted(value: &Value) -> Value {
    match value {
        Value::Object(object) => {
            let mut keys: Vec<&String> = object.keys().collect();
            keys.sort();
            let entries = keys
                .into_iter()
                .map(|key| (key.clone(), sorted(&object[key])));
            Value::Object(entries.collect())
        }
        Value::Array(items) => items.iter().map(sorted).collect(),
        other => other.clone(),
    }
}

#[test]
fn vertices_at_rest_are_what_they_were_bit_for_bit() {
    let before = Glb::new(&std::fs::read(fixture("looks.glb")).expect("a fixture"));
    let (after, _) = pass_through("looks.glb");
    for (old, new) in pairs(&before, &after) {
        for name in ["NORMAL", "TANGENT", "TEXCOORD_0", "TEXCOORD_1", "COLOR_0"] {
            let (old, new) = (before.attribute(old, name), after.attribute(new, name));
            assert_eq!(old, new, "{name}");
        }
    }
    let node = &after.json["nodes"][0];
    let offset: [f64; 3] = serde_json::from_value(node["translation"].clone()).expect("numbers");
    let floats = |bytes: &[u8]| -> Vec<f64> {
        let words = bytes.as_chunks().0.iter();
        words
            .map(|&word| f64::from(f32::from_le_bytes(word)))
            .collect()
    };
    let [(old, new), ..] = pairs(&before, &after)[..] else {
        panic!("no primitives");
    };
    let old = floats(before.attribute(old, "POSITION"));
    let new = floats(after.attribute(new, "POSITION"));
    let new: Vec<f64> = new
        .iter()
        .zip(offset.iter().cycle())
        .map(|(x, o)| x + o)
        .collect();
    assert_eq!(old, new);
}

#[test]
fn everything_is_written_once_and_nothing_that_is_not_used() {
    let (after, notes) = pass_through("looks.glb");
    let count = |key: &str| after.json[key].as_array().map_or(0, Vec::len);
    // Four for each step, the same; the texture that none uses stays behind.
    assert_eq!(count("materials"), 4);
    assert_eq!(
        (count("textures"), count("samplers"), count("images")),
        (4, 2, 2)
    );
    assert_eq!(
        after.json["extensionsUsed"],
        json!([
            "ACME_glitter",
            "KHR_materials_clearcoat",
            "KHR_materials_emissive_strength",
            "KHR_materials_ior",
            "KHR_materials_transmission",
            "KHR_materials_unlit",
            "KHR_texture_transform",
        ])
    );
    assert_eq!(
        after.json["extensionsRequired"],
        json!(["KHR_texture_transform"])
    );
    assert_eq!(notes, ["extension ACME_fog: not copied"]);

    let (after, notes) = pass_through("webp.glb");
    assert_eq!(after.json["images"].as_array().map_or(0, Vec::len), 2);
    assert_eq!(
        after.json["extensionsRequired"],
        json!(["EXT_texture_webp"])
    );
    assert_eq!(notes, [""; 0]);
    let (after, _) = pass_through("strip.glb");
    for key in ["extensionsUsed", "textures", "samplers", "images"] {
        assert_eq!(after.json.get(key), None, "{key}");
    }
}

#[test]
fn a_texture_that_a_mesh_cannot_place_is_dropped_by_name() {
    let (after, notes) = pass_through("unplaced_textures.glb");
    assert_eq!(
        notes,
        [
            "mesh \"painted\": no texture coordinates for the normalTexture, emissiveTexture, \
         metallicRoughnessTexture of material \"far\", dropped"
        ]
    );
    assert_eq!(
        after.json["materials"],
        json!([{
            "name": "far",
            "occlusionTexture": {"index": 0},
            "pbrMetallicRoughness": {"metallicFactor": 0.0},
        }])
    );
    assert_eq!(after.json.get("extensionsUsed"), None);
}

#[test]
fn what_is_wrong_with_a_material_is_mended_and_named() {
    let (after, notes) = pass_through("factors_out_of_range.glb");
    let surface = json!({"baseColorFactor": [1.0, 0.0, 0.5, 1], "metallicFactor": 1.0});
    let expected = json!([{"pbrMetallicRoughness": surface, "emissiveFactor": [1, 1, 1.0]}]);
    assert_eq!(after.json["materials"], expected);
    let named = |factor: &str| {
        format!("materials[0]: {factor} changed to the nearest value that glTF allows")
    };
    assert_eq!(
        notes,
        [
            named("pbrMetallicRoughness.baseColorFactor"),
            named("pbrMetallicRoughness.metallicFactor"),
            named("emissiveFactor"),
        ]
    );
    let (after, notes) = pass_through("texture_out_of_range.glb");
    let coat = json!({"KHR_materials_clearcoat": {"clearcoatFactor": 1}});
    assert_eq!(after.json["materials"], json!([{"extensions": coat}]));
    assert_eq!(
        notes,
        ["image of the clearcoatTexture of materials[0] dropped: there is no textures[5]"]
    );
}

/// What a source says of a node and its mesh goes with every step, beside what is said here.
#[test]
fn extras_of_nodes_and_meshes_travel() {
    let (after, _) = pass_through("lights_and_cameras.glb");
    let nodes = after.json["nodes"].as_array().expect("two steps");
    let nodes: Vec<_> = nodes
        .iter()
        .filter(|node| node.get("mesh").is_some())
        .collect();
    assert_eq!(nodes.len(), 2);
    for node in nodes {
        assert_eq!(
            node["extras"]["source"],
            json!({"node": {"price": 3}, "mesh": {"weight": 2}})
        );
        assert!(node["extras"]["certificate"].is_object());
    }
    let (plain, _) = pass_through("looks.glb");
    assert!(plain.json["nodes"][0]["extras"].get("source").is_none());
}

#[test]
fn what_is_no_surface_is_named() {
    let (_, notes) = pass_through("lights_and_cameras.glb");
    assert_eq!(notes, ["1 camera: not copied", "1 light: not copied",]);
}

#[test]
fn a_material_library_is_translated() {
    let (after, notes) = pass_through("looks.obj");
    assert_eq!(
        notes,
        [
            "vertex colours: taken as sRGB, made linear",
            "material \"lamp\": bump map taken as a normal map",
            "material \"lamp\": map_Ks not copied",
        ]
    );
    // Twice as many pictures across; counted from above, -1 is where 0 was from below.
    let transform = json!({"offset": [0.5, -1.0], "scale": [2.0, 2.0]});
    let moved = json!({"index": 0, "extensions": {"KHR_texture_transform": transform}});
    let lamp = json!({
        "name": "lamp",
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.1, 0.2, 0.3, 0.75],
            "metallicFactor": 0.0,
            "roughnessFactor": 0.9,
            "baseColorTexture": moved,
        },
        "doubleSided": true,
        "alphaMode": "BLEND",
        "normalTexture": {"index": 1, "scale": 0.5},
        "emissiveFactor": [0.5, 1.0, 0.25],
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4.0}},
        "emissiveTexture": {"index": 2},
    });
    let steel = json!({
        "name": "steel",
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.5, 0.5, 0.5, 1.0],
            "metallicFactor": 1.0,
            "roughnessFactor": 0.125,
        },
        "doubleSided": true,
        "normalTexture": {"index": 1},
        "emissiveFactor": [1.0, 1.0, 1.0],
        "emissiveTexture": {"index": 0},
    });
    assert_eq!(after.json["materials"], json!([lamp, steel]));
    assert_eq!(
        after.json["textures"],
        json!([{"source": 0}, {"source": 1}, {"source": 0, "sampler": 0}])
    );
    assert_eq!(
        after.json["samplers"],
        json!([{"wrapS": 33071, "wrapT": 33071}])
    );
    let names = ["red", "two words"];
    for (image, name) in names.into_iter().enumerate() {
        let image = after.image(&json!(image));
        let file = std::fs::read(fixture(&format!("textures/{name}.png"))).expect(name);
        assert_eq!(image["name"], name);
        assert_eq!(image["bufferView"], json!(file));
    }
}
