//! Which extensions of glTF can be ignored, and which make a file unreadable.
//!
//! Names from the registry at <https://github.com/KhronosGroup/glTF/tree/main/extensions>.

use gltf::json::Root;
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;

use super::material_lists::MaterialLists;
use crate::read::ReadError;
use crate::read::note::Note;
use crate::read::notes::add_note;

/// Vertex data in integers, which is read.
const QUANTIZATION: &str = "KHR_mesh_quantization";
/// Copies of a node, which are made.
pub(super) const INSTANCING: &str = "EXT_mesh_gpu_instancing";
/// Nodes that are switched off, which is heeded.
pub(super) const VISIBILITY: &str = "KHR_node_visibility";
/// Compressed primitives.
const DRACO: &str = "KHR_draco_mesh_compression";
/// Compressed buffer views, by both of its names.
const MESHOPT: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Lights, which are counted and left behind.
pub(super) const LIGHTS: &str = "KHR_lights_punctual";

/// Those that change how a surface looks or what a file tells, but not where its points are.
const HARMLESS: [&str; 14] = [
    "ADOBE_materials_clearcoat_specular",
    "EXT_lights_ies",
    "EXT_lights_image_based",
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_audio_emitter",
    "KHR_lights_punctual",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_xmp_json_ld",
    "MSFT_texture_dds",
];

/// Refuses a file that cannot be read without an extension that is not known here; notes those that are
/// not copied with how surfaces look.
pub(super) fn check(
    root: &Root,
    material_lists: &MaterialLists,
    notes: &mut Vec<Note>,
) -> Result<(), ReadError> {
    let heeded = [QUANTIZATION, INSTANCING, VISIBILITY];
    for name in &material_lists.required {
        let known = heeded.contains(&name.as_str()) || HARMLESS.contains(&name.as_str());
        if !known && !name.starts_with("KHR_materials_") {
            return Err(ReadError::Extension { name: name.clone() });
        }
    }
    let carried = material_lists.extensions();
    for name in root.extensions_used.iter().chain(&material_lists.required) {
        let dealt_with = heeded.iter().chain(&MESHOPT).chain([&DRACO, &LIGHTS]);
        if !carried.contains(name) && !dealt_with.into_iter().any(|known| known == name) {
            let name = name.clone();
            add_note(notes, Note::Extension { name });
        }
    }
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    for primitive in primitives {
        if is_draco_only(root, primitive) {
            return Err(ReadError::Extension { name: DRACO.into() });
        }
    }
    Ok(())
}

/// The compression behind which the data of a buffer view hides, where it has one.
pub(super) fn compression_of_view(root: &Root, view: usize) -> Option<&'static str> {
    let extensions = root.buffer_views[view].extensions.as_ref()?;
    let used = |name: &&str| extensions.others.contains_key(*name);
    MESHOPT.into_iter().find(used)
}

/// Whether a primitive is compressed and its positions are not given uncompressed as well.
fn is_draco_only(root: &Root, primitive: &Primitive) -> bool {
    let position = Checked::Valid(Semantic::Positions);
    let compressed = primitive
        .extensions
        .as_ref()
        .is_some_and(|extensions| extensions.others.contains_key(DRACO));
    let plain = primitive.attributes.get(&position).is_some_and(|index| {
        let accessor = root.accessors.get(index.value());
        accessor.is_some_and(|a| a.buffer_view.is_some() || a.sparse.is_some())
    });
    compressed && !plain
}
