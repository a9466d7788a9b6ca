//! Copies of a node's mesh, as `EXT_mesh_gpu_instancing` makes them.

use glam::{DAffine3, DQuat, DVec3};
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::{Index, Value};

use super::accessor::{Expected, Numbers};
use super::document::Document;
use super::extensions;
use crate::read::{AccessorProblem, DocumentProblem, ReadError};

const VECTOR: Expected = Expected {
    types: &[Type::Vec3],
    components: &[ComponentType::F32],
    words: "VEC3 of floats",
};
const ROTATION: Expected = Expected {
    types: &[Type::Vec4],
    components: &[ComponentType::F32, ComponentType::I8, ComponentType::I16],
    words: "VEC4 of floats, bytes or shorts",
};

/// Where the copies stand in the coordinates of their node; one copy at the node itself without the
/// extension.
pub(super) fn read_instances(document: &Document, node: usize) -> Result<Vec<DAffine3>, ReadError> {
    let extension = document.root.nodes[node]
        .extensions
        .as_ref()
        .and_then(|extensions| extensions.others.get(extensions::INSTANCING));
    let Some(extension) = extension else {
        return Ok(vec![DAffine3::IDENTITY]);
    };
    let mut count = None;
    let mut numbers = |name, expected| {
        let place = format!("nodes[{node}], instances, {name}");
        let pointer = format!("/attributes/{name}");
        match extension.pointer(&pointer) {
            None => Ok(None),
            Some(index) => attribute(document, index, expected, &place, &mut count).map(Some),
        }
    };
    let translations = numbers("TRANSLATION", &VECTOR)?;
    let rotations = numbers("ROTATION", &ROTATION)?;
    let scales = numbers("SCALE", &VECTOR)?;

    let vector = |numbers: &Option<Numbers>, i, default| {
        let numbers = numbers.as_ref();
        numbers.map_or(default, |n| DVec3::from_slice(&n.values[3 * i..]))
    };
    let instance = |i| {
        let rotation = rotations.as_ref();
        let rotation = rotation.map(|n| DQuat::from_slice(&n.values[4 * i..]));
        DAffine3::from_scale_rotation_translation(
            vector(&scales, i, DVec3::ONE),
            rotation.map_or(DQuat::IDENTITY, |q| q / q.length()),
            vector(&translations, i, DVec3::ZERO),
        )
    };
    Ok((0..count.unwrap_or(1)).map(instance).collect())
}

/// The numbers of one attribute, as many as those of the others.
fn attribute(
    document: &Document,
    index: &Value,
    expected: &Expected,
    place: &str,
    count: &mut Option<usize>,
) -> Result<Numbers, ReadError> {
    let accessors = document.root.accessors.len() as u64;
    let Some(index) = index.as_u64().filter(|&index| index < accessors) else {
        return Err(ReadError::Document {
            place: place.to_owned(),
            problem: DocumentProblem::OutOfRange,
        });
    };
    // Zeros without end would be copies without end.
    if document.root.accessors[index as usize]
        .buffer_view
        .is_none()
    {
        return Err(ReadError::Document {
            place: format!("accessors[{index}].bufferView"),
            problem: DocumentProblem::Missing,
        });
    }
    let numbers = document.numbers(Index::new(index as u32), expected, place)?;
    let found = numbers.elements().len();
    match *count.get_or_insert(found) {
        expected if expected == found => Ok(numbers),
        expected => Err(ReadError::Accessor {
            place: place.to_owned(),
            accessor: index as usize,
            problem: AccessorProblem::Count { found, expected },
        }),
    }
}
