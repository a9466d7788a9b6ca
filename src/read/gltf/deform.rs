//! The default pose: morph targets with their default weights, skins with their joints where they stand.
//!
//! glTF 2.0, sections 3.7.2.2 (morph targets) and 3.7.3 (skins). A photosurface is that of a body at
//! rest, so that one pose is read and animations are not.

use glam::{DAffine3, DMat3, DMat4, DVec3};
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::mesh::Semantic;
use gltf::json::{Accessor, Index};

use super::accessor::Expected;
use super::document::Document;
use super::nodes::{self, Rounded, Tree};
use super::primitive::{Shape, Source};
use crate::mesh::Vectors;
use crate::read::note::Note;
use crate::read::notes::add_note;
use crate::read::{AccessorProblem, NodeProblem, ReadError};

const BIND_MATRIX: Expected = Expected {
    types: &[Type::Mat4],
    components: &[ComponentType::F32],
    words: "MAT4 of floats",
};
const JOINT: Expected = Expected {
    types: &[Type::Vec4],
    components: &[ComponentType::U8, ComponentType::U16],
    words: "VEC4 of unsigned bytes or shorts",
};
const WEIGHT: Expected = Expected {
    types: &[Type::Vec4],
    components: &[ComponentType::F32, ComponentType::U8, ComponentType::U16],
    words: "VEC4 of floats, unsigned bytes or unsigned shorts",
};

/// How far each morph target of the mesh at `node` is taken: as the node says, else as the mesh says,
/// else not at all.
pub(super) fn morph_weights(document: &Document, node: usize) -> Result<Vec<f32>, ReadError> {
    let root = &document.root;
    let this = &root.nodes[node];
    let Some(mesh) = this.mesh.map(|mesh| &root.meshes[mesh.value()]) else {
        return Ok(vec![]);
    };
    let targets = |p: &gltf::json::mesh::Primitive| p.targets.as_ref().map_or(0, Vec::len);
    let expected = mesh.primitives.iter().map(targets).max().unwrap_or(0);
    match this.weights.as_ref().or(mesh.weights.as_ref()) {
        Some(weights) if expected > 0 && weights.len() != expected => {
            let found = weights.len();
            let problem = NodeProblem::MorphWeights { found, expected };
            Err(nodes::error(root, node, problem))
        }
        Some(weights) if expected > 0 => Ok(weights.clone()),
        _ => Ok(vec![0.0; expected]),
    }
}

/// Adds the displacements of the morph targets.
pub(super) fn apply_morph(
    shape: &mut Shape,
    source: &Source,
    weights: &[f32],
    notes: &mut Vec<Note>,
) -> Result<(), ReadError> {
    let vertices = shape.positions.len();
    let targets = source.primitive.targets.as_deref().unwrap_or_default();
    if !targets.is_empty() && !weights.is_empty() {
        let note = Note::Morph {
            mesh: source.mesh.clone(),
            weights: weights.to_vec(),
        };
        add_note(notes, note);
    }
    for (i, (target, &weight)) in targets.iter().zip(weights).enumerate() {
        if weight == 0.0 {
            continue;
        }
        let weight = f64::from(weight);
        let displacements = |accessor, attribute| {
            source.vectors(accessor, &format!("targets[{i}] {attribute}"), vertices)
        };
        if let Some(accessor) = target.positions {
            let displacements = displacements(accessor, "POSITION")?;
            for (position, displacement) in shape.positions.as_mut().iter_mut().zip(displacements) {
                *position += weight * displacement;
            }
        }
        if let (Some(accessor), Some(normals)) = (target.normals, &mut shape.normals) {
            let displacements = displacements(accessor, "NORMAL")?;
            for (normal, displacement) in normals.as_mut().iter_mut().zip(displacements) {
                *normal += weight * displacement;
            }
        }
        if let (Some(accessor), Some(tangents)) = (target.tangents, &mut shape.tangents) {
            let displacements = displacements(accessor, "TANGENT")?;
            for (tangent, displacement) in tangents.iter_mut().zip(displacements) {
                *tangent += (weight * displacement).extend(0.0);
            }
        }
    }
    Ok(())
}

/// The transformation of a joint from the mesh as stored to the scene, or the bottom row of the matrix that makes it
/// none: some programs leave anything at joints that no vertex follows.
pub(super) type Joint = Result<DAffine3, [f64; 4]>;

/// The joints of the skin of `node`.
pub(super) fn joint_transforms(
    document: &Document,
    tree: &Tree,
    node: usize,
    skin: usize,
    notes: &mut Vec<Note>,
) -> Result<Vec<Joint>, ReadError> {
    let root = &document.root;
    let joints = &root.skins[skin].joints;
    let stands = joints.iter().map(|joint| tree.node_to_scene[joint.value()]);
    let Some(accessor) = root.skins[skin].inverse_bind_matrices else {
        return Ok(stands.map(Ok).collect());
    };
    let place = format!("skins[{skin}].inverseBindMatrices");
    let numbers = document.numbers(accessor, &BIND_MATRIX, &place)?;
    let matrices = numbers.elements().len();
    let joints = joints.len();
    if matrices < joints {
        let problem = NodeProblem::BindMatrices {
            skin,
            matrices,
            joints,
        };
        return Err(nodes::error(root, node, problem));
    }
    let mut rounded = Rounded::default();
    let transforms = stands
        .zip(numbers.elements())
        .map(|(joint_to_scene, bind)| {
            let bind = rounded.affine(&DMat4::from_cols_slice(bind))?;
            Ok(joint_to_scene * bind)
        })
        .collect();
    rounded.note(&place, notes);
    Ok(transforms)
}

/// How far the weights of a vertex may be from 1 together without a note: those in bytes are rounded by up to a
/// 510th each.
const ROUNDING_OF_WEIGHTS: f64 = 0.02;

/// Moves every vertex of the mesh at `node` by the weighted mean of its joints' transformations. A vertex without any
/// weight follows the first joint that it names, as in three.js and Blender.
pub(super) fn apply_skin(
    shape: &mut Shape,
    source: &Source,
    node: usize,
    joints: &[Joint],
    notes: &mut Vec<Note>,
) -> Result<(), ReadError> {
    let mut blends = vec![Blend::NONE; shape.positions.len()];
    let root = &source.document.root;
    let joint =
        |set, accessor: Index<Accessor>, vertex, joint: f64| match joints.get(joint as usize) {
            Some(Ok(transform)) => Ok(transform),
            Some(&Err(row)) => Err(nodes::error(root, node, NodeProblem::Projective { row })),
            None => Err(ReadError::Accessor {
                place: format!("{}, JOINTS_{set}", source.place),
                accessor: accessor.value(),
                problem: AccessorProblem::Joint {
                    vertex,
                    joint: joint as usize,
                    joints: joints.len(),
                },
            }),
        };
    let set_of = |set| {
        let joints = source.attribute(&Semantic::Joints(set))?;
        Some((set, joints, source.attribute(&Semantic::Weights(set))?))
    };
    let mut firsts = vec![];
    for (set, joint_accessor, weight_accessor) in (0..).map_while(set_of) {
        let (name, vertices) = (format!("JOINTS_{set}"), blends.len());
        let followed = source.numbers(joint_accessor, &JOINT, &name, vertices)?;
        let name = format!("WEIGHTS_{set}");
        let weights = source.numbers(weight_accessor, &WEIGHT, &name, vertices)?;
        let pairs = followed.elements().zip(weights.elements());
        for (vertex, (followed, weights)) in pairs.enumerate() {
            if set == 0 {
                firsts.push((joint_accessor, followed[0]));
            }
            for (&number, &weight) in followed.iter().zip(weights) {
                // Joints of no weight may be anything.
                if weight != 0.0 {
                    blends[vertex].add(joint(set, joint_accessor, vertex, number)?, weight);
                }
            }
        }
    }
    let (mut without, mut off) = (0, 0);
    for (vertex, blend) in blends.iter_mut().enumerate() {
        if blend.is_none() {
            let (accessor, number) = firsts[vertex];
            blend.add(joint(0, accessor, vertex, number)?, 1.0);
            without += 1;
        }
        if !(blend.weight > 0.0 && blend.weight.is_finite()) {
            let accessor = source.attribute(&Semantic::Weights(0));
            return Err(ReadError::Accessor {
                place: format!("{}, WEIGHTS_0", source.place),
                accessor: accessor.map_or(0, |accessor| accessor.value()),
                problem: AccessorProblem::Weights {
                    vertex,
                    sum: blend.weight,
                },
            });
        }
        off += usize::from((blend.weight - 1.0).abs() > ROUNDING_OF_WEIGHTS);
    }
    let mesh = source.mesh.clone();
    if without > 0 {
        let mesh = mesh.clone();
        let count = without;
        add_note(notes, Note::NoWeights { mesh, count });
    }
    if off > 0 {
        let count = off;
        add_note(notes, Note::Weights { mesh, count });
    }
    pose(shape, &blends);
    Ok(())
}

/// A sum of weighted transformations.
#[derive(Clone, Copy)]
struct Blend {
    linear: DMat3,
    translation: DVec3,
    weight: f64,
}

impl Blend {
    const NONE: Self = Self {
        linear: DMat3::ZERO,
        translation: DVec3::ZERO,
        weight: 0.0,
    };

    /// Whether nothing has been added.
    fn is_none(&self) -> bool {
        self.linear == DMat3::ZERO && self.translation == DVec3::ZERO && self.weight == 0.0
    }

    fn add(&mut self, transform: &DAffine3, weight: f64) {
        self.linear += transform.matrix3 * weight;
        self.translation += transform.translation * weight;
        self.weight += weight;
    }
}

fn pose(shape: &mut Shape, blends: &[Blend]) {
    let mut mirrored = 0;
    let positions = shape.positions.as_mut();
    let mut normals = shape.normals.as_mut().map(Vectors::as_mut);
    for (vertex, blend) in blends.iter().enumerate() {
        // Weights stored in bytes do not add up to 1 exactly.
        let linear = blend.linear * blend.weight.recip();
        let sign = if linear.determinant() < 0.0 {
            -1.0
        } else {
            1.0
        };
        mirrored += usize::from(sign < 0.0);
        let position = &mut positions[vertex];
        *position = linear * *position + blend.translation / blend.weight;
        if let Some(normals) = &mut normals {
            let cofactor = DMat3::from_cols(
                linear.y_axis.cross(linear.z_axis),
                linear.z_axis.cross(linear.x_axis),
                linear.x_axis.cross(linear.y_axis),
            );
            normals[vertex] = cofactor * normals[vertex] * sign;
        }
        if let Some(tangents) = &mut shape.tangents {
            let tangent = &mut tangents[vertex];
            *tangent = (linear * tangent.truncate()).extend(tangent.w * sign);
        }
    }
    // One triangle has three vertices but only one outside.
    shape.mirrored = 2 * mirrored > blends.len();
}
