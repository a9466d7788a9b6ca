//! A glTF file as a model: every primitive that its scene draws becomes a part.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};
use gltf::json::Root;
use gltf::json::mesh::{Mode, Semantic};

use super::deform::{apply_morph, apply_skin, joint_transforms, morph_weights};
use super::document::{Document, read_document};
use super::extensions;
use super::extras::{PartExtras, note_lost_extras, origin, own_generator};
use super::instances::read_instances;
use super::materials::Materials;
use super::nodes::{self, Tree, node_name, read_tree};
use super::primitive::{Source, read_primitive};
use crate::material::{Material, Model, Part};
use crate::mesh::Mesh;
use crate::read::bytes::Bytes;
use crate::read::far::checked;
use crate::read::names::tell_apart;
use crate::read::normals::replace_zero_normals;
use crate::read::note::{Note, plural};
use crate::read::notes::{add_note, lines, unique};
use crate::read::uri::Folder;
use crate::read::{AccessorProblem, Findings, NodeProblem, ReadError};

/// A mesh in the coordinates of the scene.
struct Piece {
    mesh: Mesh,
    material: Option<Arc<Material>>,
    /// Which primitive of its mesh it comes from.
    primitive: usize,
    /// The same in words.
    place: Arc<str>,
}

/// What a part takes beside its vertices, in the measure of a [`Quota`](super::quota::Quota).
const OF_A_PART: u64 = 64;

/// Reads a GLB or glTF file.
pub(in crate::read) fn read_gltf(
    bytes: Bytes,
    folder: Folder,
) -> Result<(Model, Findings), ReadError> {
    let mut notes = vec![];
    let document = read_document(bytes, &folder, &mut notes)?;
    let tree = read_tree(&document, &mut notes)?;
    note_other_content(&document, &mut notes);
    let mut materials = Materials::new(&document, &folder);
    let mut extras = PartExtras::new(&document.root);
    let mut parts = vec![];
    for &node in &tree.drawn {
        let pieces = read_node(&document, &tree, node, &mut materials, &mut notes)?;
        let name = node_name(&document.root, node);
        let letters = |piece: &Piece| {
            let material = piece.material.as_ref().and_then(|material| material.name());
            let names = name.len() + material.map_or(0, str::len);
            names as u64 + extras.letters(node, piece.primitive)
        };
        take(&document, node, pieces.iter().map(letters).sum())?;
        let material = |piece: &Piece| piece.material.as_ref()?.name().map(str::to_owned);
        let made_of: Vec<Option<String>> = pieces.iter().map(material).collect();
        let names = tell_apart(&name, &made_of);
        for (piece, name) in pieces.into_iter().zip(names) {
            let part = Part::new(name, piece.mesh, piece.material);
            let mut part = part.map_err(|problem| ReadError::Mesh {
                place: piece.place.to_string(),
                problem,
            })?;
            part.extras = extras.get(node, piece.primitive);
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
    let model = Model {
        parts,
        origin: origin(&document.root),
    };
    let notes = unique(notes);
    Ok((checked(model)?, Findings { notes, files }))
}

/// Takes room for what is made of a node.
fn take(document: &Document, node: usize, numbers: u64) -> Result<(), ReadError> {
    document.quota.take(numbers).map_err(|problem| {
        let problem = match problem {
            AccessorProblem::TooMuch { found, limit } => NodeProblem::TooMuch { found, limit },
            problem => unreachable!("a quota has no other problem than {problem}"),
        };
        nodes::error(&document.root, node, problem)
    })
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
    note_lost_extras(root, notes);
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
        Some(skin) => Some(joint_transforms(document, tree, node, skin, notes)?),
        None => None,
    };
    // The joints alone place a mesh with a skin (glTF 2.0, section 3.7.3.3).
    let transforms = match &joints {
        Some(_) => vec![DAffine3::IDENTITY],
        None => copies(document, tree, node, notes)?,
    };
    let mut pieces = vec![];
    let mut points_and_lines = 0;
    let named = root.meshes[mesh].name.as_ref();
    if root.meshes[mesh].primitives.is_empty() {
        let place = match named {
            Some(name) => format!("meshes[{mesh}] (mesh {name:?})"),
            None => format!("meshes[{mesh}]"),
        };
        add_note(notes, Note::Empty { place });
    }
    for (p, primitive) in root.meshes[mesh].primitives.iter().enumerate() {
        if !is_surface(primitive.mode.unwrap()) {
            points_and_lines += 1;
            continue;
        }
        if transforms.is_empty() {
            continue;
        }
        let source = Source {
            document,
            primitive,
            place: match named {
                Some(name) => format!("meshes[{mesh}].primitives[{p}] (mesh {name:?})"),
                None => format!("meshes[{mesh}].primitives[{p}]"),
            },
            mesh: named.map_or(format!("meshes[{mesh}]"), |name| format!("mesh {name:?}")),
        };
        let followed = [Semantic::Joints(0), Semantic::Weights(0)];
        let follows = followed.iter().all(|name| source.attribute(name).is_some());
        let has_shape = source.attribute(&Semantic::Positions).is_some();
        if let (Some(skin), false, true) = (skin, follows, has_shape) {
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
                let name = node_name(root, node);
                add_note(&mut deform_notes, Note::Skin { node: name });
                apply_skin(shape, &source, node, joints, &mut deform_notes)
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
        let of_each = OF_A_PART + numbers_of_a_copy(&mesh);
        take(
            document,
            node,
            of_each.saturating_mul(transforms.len() as u64),
        )?;
        let place: Arc<str> = source.place.as_str().into();
        let meshes = std::iter::repeat_n(mesh, transforms.len());
        for (mesh, transform) in meshes.zip(&transforms) {
            let mut mesh = mesh.transformed(transform);
            if !mesh.is_finite() {
                return Err(nodes::error(root, node, NodeProblem::NotFinite));
            }
            if transform.matrix3.determinant() == 0.0 {
                // Normals in the plane that it is flat in have become none.
                let (mended, count) = replace_zero_normals(mesh);
                mesh = mended;
                if count > 0 {
                    let mesh = source.mesh.clone();
                    add_note(notes, Note::Normals { mesh, count });
                }
            }
            pieces.push(Piece {
                mesh,
                material: material.clone(),
                primitive: p,
                place: place.clone(),
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

/// How many vectors a copy of a mesh has of its own. One without normals gets those of its triangles.
fn numbers_of_a_copy(mesh: &Mesh) -> u64 {
    let vertices = mesh.vertex_count() as u64;
    match (mesh.has_normals(), mesh.tangents()) {
        (false, _) => 6 * mesh.triangle_count() as u64,
        (true, None) => 2 * vertices,
        (true, Some(_)) => 3 * vertices,
    }
}

/// Where a node draws its mesh: once, unless it is instanced; not at all where it is scaled to a line or a point.
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
        if !is_surface_left(&transform.matrix3) {
            let node = node_name(root, node);
            add_note(notes, Note::Flat { node });
        } else {
            transforms.push(transform);
        }
    }
    Ok(transforms)
}

/// Whether something is left of surfaces; of a body scaled flat its two sides are.
fn is_surface_left(linear: &DMat3) -> bool {
    let largest = linear.to_cols_array().into_iter().map(f64::abs);
    let largest = largest.fold(0.0, f64::max);
    if largest == 0.0 {
        return false;
    }
    // Relative to the largest number, because products of small ones vanish.
    let DMat3 {
        x_axis,
        y_axis,
        z_axis,
    } = *linear * largest.recip();
    let across = [
        x_axis.cross(y_axis),
        y_axis.cross(z_axis),
        z_axis.cross(x_axis),
    ];
    across.into_iter().any(|normal| normal != DVec3::ZERO)
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
                | Note::NoPositions { .. }
                | Note::Hidden { .. }
                | Note::Flat { .. }
        )
    });
    let skipped: Vec<Note> = skipped.cloned().collect();
    let skipped = lines(&skipped).into_iter().map(|line| format!("; {line}"));
    let skipped: String = skipped.collect();
    format!("{nodes} and {meshes}{skipped}")
}
