//! The JSON of a material: what is checked in it, and where its textures and extensions are.

use std::collections::BTreeSet;

use serde_json::{Map, Value};

use super::MaterialError;

/// Factors of the metallic-roughness model: path, how many numbers (0 for one without brackets), the largest
/// that is allowed. None may be negative (glTF 2.0, section 5.19 and following).
const FACTORS: [(&str, usize, f64); 6] = [
    ("/pbrMetallicRoughness/baseColorFactor", 4, 1.0),
    ("/pbrMetallicRoughness/metallicFactor", 0, 1.0),
    ("/pbrMetallicRoughness/roughnessFactor", 0, 1.0),
    ("/emissiveFactor", 3, 1.0),
    ("/occlusionTexture/strength", 0, 1.0),
    ("/alphaCutoff", 0, f64::MAX),
];
/// The texture infos of the metallic-roughness model.
const CORE_TEXTURES: [&str; 5] = [
    "/pbrMetallicRoughness/baseColorTexture",
    "/pbrMetallicRoughness/metallicRoughnessTexture",
    "/normalTexture",
    "/occlusionTexture",
    "/emissiveTexture",
];

/// A test of a value, and what is expected.
type Check = (fn(&Value) -> bool, &'static str);
const OBJECT: Check = (Value::is_object, "an object");
const FLAG: Check = (Value::is_boolean, "true or false");
const TEXT: Check = (Value::is_string, "text");
const NUMBER: Check = (Value::is_number, "a number");
const INDEX: Check = (Value::is_u64, "a whole number from 0");
const ALPHA_MODE: Check = (
    |value| matches!(value.as_str(), Some("OPAQUE" | "MASK" | "BLEND")),
    "OPAQUE, MASK or BLEND",
);

/// Whether a material is one, as far as the metallic-roughness model goes.
pub(super) fn check(properties: &Value) -> Result<(), MaterialError> {
    let wrong = |pointer: &str, found: &Value, expected| MaterialError::Property {
        place: path(pointer),
        found: found.to_string(),
        expected,
    };
    let check = |pointer: &str, (is_right, expected): Check| match properties.pointer(pointer) {
        Some(value) if !is_right(value) => Err(wrong(pointer, value, expected)),
        _ => Ok(()),
    };
    check("", OBJECT)?;
    check("/name", TEXT)?;
    check("/pbrMetallicRoughness", OBJECT)?;
    check("/extensions", OBJECT)?;
    check("/alphaMode", ALPHA_MODE)?;
    check("/doubleSided", FLAG)?;
    check("/normalTexture/scale", NUMBER)?;
    for pointer in CORE_TEXTURES {
        check(pointer, OBJECT)?;
        check(&format!("{pointer}/texCoord"), INDEX)?;
        let index = properties
            .pointer(pointer)
            .map(|info| info.get("index").unwrap_or(&Value::Null));
        if let Some(index) = index.filter(|index| !index.is_u64()) {
            return Err(wrong(&format!("{pointer}/index"), index, INDEX.1));
        }
    }
    for (pointer, count, largest) in FACTORS {
        let Some(value) = properties.pointer(pointer) else {
            continue;
        };
        let in_range = |number: &Value| {
            number
                .as_f64()
                .is_some_and(|n| (0.0..=largest).contains(&n))
        };
        let is_right = match (value, count) {
            (Value::Array(numbers), _) => numbers.len() == count && numbers.iter().all(in_range),
            (number, 0) => in_range(number),
            _ => false,
        };
        if !is_right {
            let expected = match (count, largest) {
                (4, _) => "4 numbers from 0 to 1",
                (3, _) => "3 numbers from 0 to 1",
                (_, 1.0) => "a number from 0 to 1",
                _ => "a number from 0",
            };
            return Err(wrong(pointer, value, expected));
        }
    }
    Ok(())
}

/// Brings factors within what glTF allows; names those that were not.
pub(crate) fn clamp_factors(properties: &mut Value) -> Vec<String> {
    let mut clamped = vec![];
    for (pointer, _, largest) in FACTORS {
        let numbers = match properties.pointer_mut(pointer) {
            Some(Value::Array(numbers)) => numbers.iter_mut().collect(),
            Some(number) => vec![number],
            None => continue,
        };
        let mut outside = false;
        for number in numbers {
            if let Some(value) = number.as_f64()
                && !(0.0..=largest).contains(&value)
            {
                *number = value.clamp(0.0, largest).into();
                outside = true;
            }
        }
        if outside {
            clamped.push(path(pointer));
        }
    }
    clamped
}

/// Visits every texture info, each with the name of its slot, and takes out those that `keep` does not keep.
///
/// A material that loses the texture that says where the metal is loses the metal too: its factor is 1 by
/// default, and all of it would be metal, which is black wherever it has nothing to reflect.
pub(crate) fn retain_textures(
    properties: &mut Value,
    mut keep: impl FnMut(&str, &mut Value) -> bool,
) {
    let gloss = "/pbrMetallicRoughness/metallicRoughnessTexture";
    let had_gloss = properties.pointer(gloss).is_some();
    retain_below(properties, &mut keep);
    if had_gloss && properties.pointer(gloss).is_none() {
        properties["pbrMetallicRoughness"]["metallicFactor"] = 0.0.into();
    }
}

fn retain_below(value: &mut Value, keep: &mut impl FnMut(&str, &mut Value) -> bool) {
    match value {
        Value::Object(object) => object.retain(|name, value| {
            let is_info = name.ends_with("Texture") && value.get("index").is_some_and(INDEX.0);
            match (is_info, name.as_str()) {
                (true, _) => keep(name, value),
                // What an application keeps there has a meaning of its own.
                (false, "extras") => true,
                (false, _) => {
                    retain_below(value, keep);
                    true
                }
            }
        }),
        Value::Array(items) => items.iter_mut().for_each(|item| retain_below(item, keep)),
        _ => {}
    }
}

/// The names of all extensions that a part of glTF's JSON uses, at any depth.
pub(crate) fn extension_names(value: &Value) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    add_extension_names(value, &mut names);
    names
}

pub(super) fn add_extension_names(value: &Value, names: &mut BTreeSet<String>) {
    names.extend(names_of_extensions(value).cloned());
    match value {
        Value::Object(object) => object
            .iter()
            .filter(|(name, _)| *name != "extras")
            .for_each(|(_, value)| add_extension_names(value, names)),
        Value::Array(items) => items
            .iter()
            .for_each(|item| add_extension_names(item, names)),
        _ => {}
    }
}

/// The names of the extensions that an object itself has.
pub(super) fn names_of_extensions(value: &Value) -> impl Iterator<Item = &String> {
    let extensions = value.get("extensions").and_then(Value::as_object);
    extensions.into_iter().flat_map(Map::keys)
}

/// Which texture an info means.
pub(super) fn texture_index(info: &Value) -> u64 {
    number(info, "index")
}

/// Which texture coordinates it names.
pub(super) fn tex_coord(info: &Value) -> u64 {
    number(info, "texCoord")
}

fn number(info: &Value, name: &str) -> u64 {
    info.get(name).and_then(Value::as_u64).unwrap_or_default()
}

fn path(pointer: &str) -> String {
    match pointer.strip_prefix('/') {
        Some(pointer) => pointer.replace('/', "."),
        None => "the material".to_owned(),
    }
}
