//! Small faults of glTF files that every program reads over, mended in their JSON.

use gltf::json::Value;
use serde_json::Map;

/// Properties that are whole numbers, or lists or tables of them.
const WHOLE: [&str; 34] = [
    "NORMAL",
    "POSITION",
    "TANGENT",
    "attributes",
    "buffer",
    "bufferView",
    "byteLength",
    "byteOffset",
    "byteStride",
    "camera",
    "children",
    "componentType",
    "count",
    "index",
    "indices",
    "inverseBindMatrices",
    "joints",
    "magFilter",
    "material",
    "mesh",
    "minFilter",
    "mode",
    "node",
    "nodes",
    "sampler",
    "scene",
    "skeleton",
    "skin",
    "source",
    "target",
    "texCoord",
    "values",
    "wrapS",
    "wrapT",
];

/// Those of extensions that are read here; what others mean nobody knows.
const WHOLE_IN_EXTENSIONS: [&str; 5] = ["attributes", "index", "sampler", "source", "texCoord"];

/// Makes harmless things palatable to the `gltf` crate: a scene without nodes gets an empty list of them, a primitive
/// without attributes an empty table; attributes that glTF does not define get the underscore that marks them as custom;
/// whole numbers written `8.0` become such.
pub(super) fn mend(value: &mut Value) {
    make_whole_numbers(value, &WHOLE);
    for scene in items(value.get_mut("scenes")) {
        if let Value::Object(scene) = scene {
            scene.entry("nodes").or_insert_with(|| Value::Array(vec![]));
        }
    }
    for mesh in items(value.get_mut("meshes")) {
        for primitive in items(mesh.get_mut("primitives")) {
            let Value::Object(primitive) = primitive else {
                continue;
            };
            let attributes = primitive
                .entry("attributes")
                .or_insert_with(|| Value::Object(Map::new()));
            if let Value::Object(attributes) = attributes {
                let named = std::mem::take(attributes).into_iter();
                attributes.extend(named.map(|(name, accessor)| match is_semantic(&name) {
                    true => (name, accessor),
                    false => (format!("_{name}"), accessor),
                }));
            }
        }
    }
}

/// Makes whole numbers of those that are written as others, such as `8.0`, in properties of these names.
fn make_whole_numbers(value: &mut Value, names: &[&str]) {
    match value {
        Value::Object(object) => {
            for (name, value) in object {
                match name.as_str() {
                    "extras" => continue,
                    "extensions" => make_whole_numbers(value, &WHOLE_IN_EXTENSIONS),
                    _ => make_whole_numbers(value, names),
                }
                if names.contains(&name.as_str()) {
                    match value {
                        Value::Object(table) => table.values_mut().for_each(make_whole),
                        Value::Array(list) => list.iter_mut().for_each(make_whole),
                        number => make_whole(number),
                    }
                }
            }
        }
        Value::Array(list) => {
            for item in list {
                make_whole_numbers(item, names);
            }
        }
        _ => {}
    }
}

fn make_whole(value: &mut Value) {
    // Beyond this not every whole number is an `f64`.
    const MAX: f64 = (1u64 << 53) as f64;
    if !value.is_f64() {
        return;
    }
    if let Some(number) = value.as_f64()
        && number.fract() == 0.0
        && (0.0..=MAX).contains(&number)
    {
        *value = Value::from(number as u64);
    }
}

/// Takes out the properties that are null, which some programs write for those that are not there.
pub(super) fn drop_nulls(value: &mut Value) {
    match value {
        Value::Object(object) => object.retain(|name, value| {
            if name != "extras" && name != "extensions" {
                drop_nulls(value);
            }
            !value.is_null()
        }),
        Value::Array(items) => items.iter_mut().for_each(drop_nulls),
        _ => {}
    }
}

fn items(value: Option<&mut Value>) -> impl Iterator<Item = &mut Value> {
    value.and_then(Value::as_array_mut).into_iter().flatten()
}

fn is_semantic(name: &str) -> bool {
    let is_set = |(kind, set): (&str, &str)| {
        ["TEXCOORD", "COLOR", "JOINTS", "WEIGHTS"].contains(&kind) && set.parse::<u32>().is_ok()
    };
    name.starts_with('_')
        || ["POSITION", "NORMAL", "TANGENT"].contains(&name)
        || name.split_once('_').is_some_and(is_set)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn whole_numbers_become_such_where_gltf_has_them_and_nowhere_else() {
        let mut value = json!({
            "scene": 0.0,
            "scenes": [{"nodes": [1.0, 0]}],
            "nodes": [{"mesh": 2.0, "scale": [1.0, 2.0, 3.0], "extras": {"mesh": 4.0}}],
            "accessors": [{"count": 8.0, "max": [1.0], "sparse": {"indices": {"bufferView": 1e1}}}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 3.0}, "targets": [{"NORMAL": 1.0}], "indices": 0.5}]}],
            "materials": [{"normalTexture": {"index": 5.0, "scale": 1.0}, "extensions": {"ACME": {"count": 1.0}}}],
            "buffers": [{"byteLength": -8.0}, {"byteLength": 1e300}],
        });
        mend(&mut value);
        let expected = json!({
            "scene": 0,
            "scenes": [{"nodes": [1, 0]}],
            "nodes": [{"mesh": 2, "scale": [1.0, 2.0, 3.0], "extras": {"mesh": 4.0}}],
            "accessors": [{"count": 8, "max": [1.0], "sparse": {"indices": {"bufferView": 10}}}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 3}, "targets": [{"NORMAL": 1}], "indices": 0.5}]}],
            "materials": [{"normalTexture": {"index": 5, "scale": 1.0}, "extensions": {"ACME": {"count": 1.0}}}],
            "buffers": [{"byteLength": -8.0}, {"byteLength": 1e300}],
        });
        assert_eq!(value, expected);
    }
}
