//! A glTF file as a model: every primitive that its scene draws becomes a part.

use std::sync::Arc;

use glam::DAffine3;
use gltf::json::mesh::{Mode, Semantic};
use gltf::json::{Extras, Root};
use serde_json::{Map, Value};

use super::bytes::Bytes;
use super::deform::{apply_morph, apply_skin, joint_transforms, morph_weights};
use super::document::{Document, read_document};
use super::instances::read_instances;
use super::materials::Materials;
use super::names::tell_apart;
use super::nodes::{self, Tree, node_name, read_tree};
use super::note::{Note, add_note, plural};
use super::primitive::{Source, read_primitive};
use super::uri::Folder;
use super::{Findings, NodeProblem, ReadError, checked, extensions};
use crate::mesh::{Material, Mesh, Model, Part};

/// A mesh in the coordinates of the scene.
struct Piece {
    mesh: Mesh,
    material: Option<Arc<Material>>,
    /// Which primitive it comes from, and which copy it is.
    place: String,
}

/// Reads a GLB or glTF file.
pub(super) fn read_gltf(bytes: Bytes, folder: Folder) -> Result<(Model, Findings), ReadError> {
    let mut notes = vec![];
    let document = read_document(bytes, &folder, &mut notes)?;
    let tree = read_tree(&document, &mut notes)?;
    note_other_content(&document, &mut notes);
    let mut materials = Materials::new(&document, &folder);
    let mut parts = vec![];
    for &node in &tree.drawn {
        let pieces = read_node(&document, &tree, node, &mut materials, &mut notes)?;
        let material = |piece: &Piece| piece.material.as_ref()?.name().map(str::to_owned);
        let made_of: Vec<Option<String>> = pieces.iter().map(material).collect();
        let names = tell_apart(&node_name(&document.root, node), &made_of);
        let extras = extras(&document.root, node);
        for (piece, name) in pieces.into_iter().zip(names) {
            let part = Part::new(name, piece.mesh, piece.material);
            let mut part = part.map_err(|problem| ReadError::Mesh {
                place: piece.place,
                problem,
            })?;
            part.extras.clone_from(&extras);
            parts.push(part);
        }
    }
    if parts.is_empty() {
        let instead = content(&document.root, &notes);
        return Err(ReadError::NoTriangles { instead });
    }
    for uri in document.root.images.iter().filter_map(|i| i.uri.as_ref()) {
        folder.mention(uri);
    }
    let files = folder.into_opened();
    Ok((checked(Model { parts })?, Findings { notes, files }))
}

/// Notes what a file has that is no surface.
fn note_other_content(document: &Document, notes: &mut Vec<Note>) {
    let root = &document.root;
    if let Some(generator) = own_generator(root) {
        let generator = generator.to_owned();
        add_note(notes, Note::Photosurface { generator });
    }
    let lights = root
        .extensions
        .as_ref()
        .and_then(|extensions| extensions.others.get(extensions::LIGHTS))
        .and_then(|lights| lights.get("lights")?.as_array())
        .map_or(0, Vec::len);
    let counts = [
        (root.cameras.len(), "camera"),
        (lights, "light"),
        (document.animations, "animation"),
    ];
    for (count, singular) in counts {
        if count > 0 {
            let what = plural(count, singular);
            add_note(notes, Note::NotCarried { what });
        }
    }
    let empty = root.nodes.iter().filter(|node| node.mesh.is_none());
    let count = empty.filter(|node| node.extras.is_some()).count();
    if count > 0 {
        let what = format!("extras of {} without a mesh", plural(count, "node"));
        add_note(notes, Note::NotCarried { what });
    }
}

/// What wrote the file, if that is this program.
fn own_generator(root: &Root) -> Option<&str> {
    let generator = root.asset.generator.as_deref()?;
    let ours = generator.starts_with(concat!(env!("CARGO_PKG_NAME"), " "));
    ours.then_some(generator)
}

/// What the file says of a node and its mesh beyond glTF.
fn extras(root: &Root, node: usize) -> Option<Arc<Value>> {
    let node = &root.nodes[node];
    let value = |extras: &Extras| -> Option<Value> {
        let text = extras.as_ref()?.get();
        Some(serde_json::from_str(text).expect("it was read as a part of the file"))
    };
    let of_node = value(&node.extras);
    // What this program writes there it makes anew; what it had from elsewhere goes on.
    if own_generator(root).is_some() {
        return of_node?.get("source").cloned().map(Arc::new);
    }
    let of_mesh = node
        .mesh
        .and_then(|mesh| value(&root.meshes[mesh.value()].extras));
    let both = [("node", of_node), ("mesh", of_mesh)].into_iter();
    let both: Map<_, _> = both
        .filter_map(|(name, extras)| Some((name.to_owned(), extras?)))
        // Some programs write what says nothing.
        .filter(|(_, extras)| *extras != serde_json::json!({}))
        .collect();
    (!both.is_empty()).then(|| Arc::new(Value::Object(both)))
}

/// The meshes that one node draws, without its children.
fn read_node(
    document: &Document,
    tree: &Tree,
    node: usize,
    materials: &mut Materials,
    notes: &mut Vec<Note>,
) -> Result<Vec<Piece>, ReadError> {
    let root = &document.root;
    let Some(mesh) = root.nodes[node].mesh.map(|mesh| mesh.value()) else {
        return Ok(vec![]);
    };
    let weights = morph_weights(document, node)?;
    let skin = root.nodes[node].skin.map(|skin| skin.value());
    let joints = match skin {
        Some(skin) => Some(joint_transforms(document, tree, node, skin)?),
        None => None,
    };
    // The joints alone place a mesh with a skin (glTF 2.0, section 3.7.3.3).
    let transforms = match &joints {
        Some(_) => vec![DAffine3::IDENTITY],
        None => copies(document, tree, node, notes)?,
    };
    let mut pieces = vec![];
    let mut points_and_lines = 0;
    for (p, primitive) in root.meshes[mesh].primitives.iter().enumerate() {
        if !is_surface(primitive.mode.unwrap()) {
            points_and_lines += 1;
            continue;
        }
        if transforms.is_empty() {
            continue;
        }
        let named = root.meshes[mesh].name.as_ref();
        let source = Source {
            document,
            primitive,
            place: match named {
                Some(name) => format!("meshes[{mesh}].primitives[{p}] (mesh {name:?})"),
                None => format!("meshes[{mesh}].primitives[{p}]"),
            },
            mesh: named.map_or(format!("meshes[{mesh}]"), |name| format!("mesh {name:?}")),
        };
        if let (Some(skin), None) = (skin, source.attribute(&Semantic::Joints(0))) {
            return Err(nodes::error(root, node, NodeProblem::NoJoints { skin }));
        }
        let mut deform_notes = vec![];
        let read = read_primitive(
            &source,
            |shape| {
                apply_morph(shape, &source, &weights, &mut deform_notes)?;
                let Some(joints) = &joints else {
                    return Ok(());
                };
                let node = node_name(root, node);
                add_note(&mut deform_notes, Note::Skin { node });
                apply_skin(shape, &source, joints)
            },
            notes,
        )?;
        for note in deform_notes {
            add_note(notes, note);
        }
        let Some(mesh) = read else {
            continue;
        };
        let material = primitive.material.map(|index| index.value());
        let sets = mesh.texture_coordinates().len();
        let material = material
            .map(|index| materials.material(index, &source.mesh, sets, notes))
            .transpose()?;
        let meshes = std::iter::repeat_n(mesh, transforms.len());
        for (mesh, transform) in meshes.zip(&transforms) {
            let mesh = mesh.transformed(transform);
            if !mesh.is_finite() {
                return Err(nodes::error(root, node, NodeProblem::NotFinite));
            }
            pieces.push(Piece {
                mesh,
                material: material.clone(),
                place: source.place.clone(),
            });
        }
    }
    if points_and_lines > 0 {
        let note = Note::PointsAndLines {
            place: format!("node {:?}", node_name(root, node)),
            count: points_and_lines,
        };
        add_note(notes, note);
    }
    Ok(pieces)
}

/// Where a node draws its mesh: once, unless it is instanced; not at all where it has no volume left.
fn copies(
    document: &Document,
    tree: &Tree,
    node: usize,
    notes: &mut Vec<Note>,
) -> Result<Vec<DAffine3>, ReadError> {
    let root = &document.root;
    let mut transforms = vec![];
    for instance in read_instances(document, node)? {
        let transform = tree.node_to_scene[node] * instance;
        if !transform.is_finite() {
            return Err(nodes::error(root, node, NodeProblem::NotFinite));
        }
        if transform.matrix3.determinant() == 0.0 {
            let node = node_name(root, node);
            add_note(notes, Note::Flat { node });
        } else {
            transforms.push(transform);
        }
    }
    Ok(transforms)
}

fn is_surface(mode: Mode) -> bool {
    matches!(
        mode,
        Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan
    )
}

/// What a file without triangles has.
fn content(root: &Root, notes: &[Note]) -> String {
    let nodes = plural(root.nodes.len(), "node");
    let meshes = plural(root.meshes.len(), "mesh");
    let skipped = notes.iter().filter(|note| {
        matches!(
            note,
            Note::PointsAndLines { .. }
                | Note::Empty { .. }
                | Note::Hidden { .. }
                | Note::Flat { .. }
        )
    });
    let skipped: String = skipped.map(|note| format!("; {note}")).collect();
    format!("{nodes} and {meshes}{skipped}")
}
