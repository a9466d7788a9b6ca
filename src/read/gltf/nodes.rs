//! The tree of nodes: which are drawn, and where each stands.
//!
//! glTF 2.0, section 3.5. Trees of any depth, without recursion; what is not a tree is refused.

use glam::{DAffine3, DMat4, DQuat, DVec3, DVec4};
use gltf::json::{Index, Node, Root};

use super::document::{Document, Placement};
use super::extensions;
use crate::read::note::Note;
use crate::read::notes::add_note;
use crate::read::{NodeProblem, ReadError};

/// Where the nodes of a file stand.
pub(super) struct Tree {
    /// From the coordinates of each node, drawn or not, to those of the scene.
    pub(super) node_to_scene: Vec<DAffine3>,
    /// The nodes that are drawn, parents before children, in the order of the file.
    pub(super) drawn: Vec<usize>,
}

/// The tree of the default scene, of the first where none is the default, of all nodes without scenes.
pub(super) fn read_tree(document: &Document, notes: &mut Vec<Note>) -> Result<Tree, ReadError> {
    let root = &document.root;
    let parents = parents(root)?;
    let orphans: Vec<usize> = (0..parents.len())
        .filter(|&node| parents[node].is_none())
        .collect();
    let mut node_to_scene = vec![DAffine3::IDENTITY; parents.len()];
    let order = depth_first(root, &orphans, |_| true);
    let mut rounded = Rounded::default();
    for &node in &order {
        let parent = parents[node].map_or(DAffine3::IDENTITY, |parent| node_to_scene[parent]);
        let local = local_transform(&document.placements[node], &mut rounded)
            .map_err(|problem| error(root, node, problem))?;
        node_to_scene[node] = parent * local;
        if !node_to_scene[node].is_finite() {
            return Err(error(root, node, NodeProblem::NotFinite));
        }
    }
    // What cannot be reached from a node without a parent goes round in a circle.
    let mut reached = vec![false; parents.len()];
    order.iter().for_each(|&node| reached[node] = true);
    if let Some(node) = reached.iter().position(|reached| !reached) {
        return Err(error(root, node, NodeProblem::Cycle));
    }

    rounded.note("nodes", notes);

    let mut is_visible = vec![true; parents.len()];
    for &node in &order {
        let above = parents[node].is_none_or(|parent| is_visible[parent]);
        is_visible[node] = above && is_switched_on(&root.nodes[node]);
    }
    let roots = scene_roots(root, &parents, &order, orphans, notes);
    let drawn = depth_first(root, &roots, |node| {
        let visible = is_visible[node];
        if !visible {
            let node = node_name(root, node);
            add_note(notes, Note::Hidden { node });
        }
        visible
    });
    Ok(Tree {
        node_to_scene,
        drawn,
    })
}

/// What to call a node: its own name, that of its mesh, or its number.
pub(super) fn node_name(root: &Root, node: usize) -> String {
    let this = &root.nodes[node];
    let mesh_name = || {
        let mesh = this.mesh?;
        root.meshes[mesh.value()].name.clone()
    };
    let given = |name: &String| !name.is_empty();
    let name = this.name.clone().filter(given);
    let name = name.or_else(|| mesh_name().filter(given));
    name.unwrap_or_else(|| format!("node{node}"))
}

/// An error that says at which node.
pub(super) fn error(root: &Root, node: usize, problem: NodeProblem) -> ReadError {
    let name = root.nodes[node].name.as_ref();
    ReadError::Node {
        node,
        name: name.map_or(String::new(), |name| format!(" ({name:?})")),
        problem,
    }
}

/// The parent of every node that has one.
fn parents(root: &Root) -> Result<Vec<Option<usize>>, ReadError> {
    let mut parents = vec![None; root.nodes.len()];
    for (parent, node) in root.nodes.iter().enumerate() {
        for child in node.children.iter().flatten().map(Index::value) {
            // A node that lists its child twice means it once.
            if let Some(first) = parents[child].replace(parent)
                && first != parent
            {
                let second = parent;
                let problem = NodeProblem::TwoParents { first, second };
                return Err(error(root, child, problem));
            }
        }
    }
    Ok(parents)
}

/// The nodes below and including `roots`, each once and parents before children; `enter` can leave out a branch.
fn depth_first(root: &Root, roots: &[usize], mut enter: impl FnMut(usize) -> bool) -> Vec<usize> {
    let mut order = vec![];
    let mut met = vec![false; root.nodes.len()];
    let mut stack: Vec<usize> = roots.iter().rev().copied().collect();
    while let Some(node) = stack.pop() {
        if !std::mem::replace(&mut met[node], true) && enter(node) {
            order.push(node);
            let children = root.nodes[node].children.iter().flatten();
            stack.extend(children.rev().map(Index::value));
        }
    }
    order
}

/// How far the bottom row of a matrix may be from [0, 0, 0, 1]: products and inverses of `f32` matrices leave some
/// millionths there, and a perspective that anybody means is a thousand times more. Every program reads the
/// upper three rows alone.
const ROUNDING_OF_ROW: f64 = 1e-4;

/// Matrices whose bottom row is [0, 0, 0, 1] but for rounding.
#[derive(Default)]
pub(super) struct Rounded {
    count: usize,
    largest: f64,
}

impl Rounded {
    /// A matrix as an affine transformation, unless it is none; then its bottom row.
    pub(super) fn affine(&mut self, matrix: &DMat4) -> Result<DAffine3, [f64; 4]> {
        let row = matrix.row(3);
        let off = (row - DVec4::W).abs();
        // Not the other way round, for the sake of NaN.
        if !(off.cmple(DVec4::splat(ROUNDING_OF_ROW)).all()) {
            return Err(row.to_array());
        }
        if off != DVec4::ZERO {
            self.count += 1;
            self.largest = self.largest.max(off.max_element());
        }
        Ok(DAffine3::from_mat4(*matrix))
    }

    pub(super) fn note(self, place: &str, notes: &mut Vec<Note>) {
        let Self { count, largest } = self;
        if count > 0 {
            let place = place.to_owned();
            let note = Note::BottomRow {
                place,
                count,
                largest,
            };
            add_note(notes, note);
        }
    }
}

fn local_transform(placement: &Placement, rounded: &mut Rounded) -> Result<DAffine3, NodeProblem> {
    if let Some(matrix) = &placement.matrix {
        let matrix = rounded.affine(&DMat4::from_cols_array(matrix));
        return matrix.map_err(|row| NodeProblem::Projective { row });
    }
    let rotation = placement.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let quaternion = DQuat::from_array(rotation);
    let length = quaternion.length();
    if !(length > 0.0 && length.is_finite()) {
        return Err(NodeProblem::Rotation { rotation });
    }
    Ok(DAffine3::from_scale_rotation_translation(
        DVec3::from_array(placement.scale.unwrap_or([1.0; 3])),
        quaternion / length,
        DVec3::from_array(placement.translation.unwrap_or([0.0; 3])),
    ))
}

/// The nodes that the scene to read starts at; `order` has parents before children.
///
/// A scene should list nodes without a parent (glTF 2.0, section 3.5.1). One that lists a child means the child where
/// its parents place it; what a scene lists twice is drawn once.
fn scene_roots(
    root: &Root,
    parents: &[Option<usize>],
    order: &[usize],
    orphans: Vec<usize>,
    notes: &mut Vec<Note>,
) -> Vec<usize> {
    let scenes = root.scenes.len();
    if scenes == 0 {
        add_note(notes, Note::Scene { read: None, scenes });
        return orphans;
    }
    let scene = default_scene(root);
    if scenes > 1 {
        let read = Some(scene);
        add_note(notes, Note::Scene { read, scenes });
    }
    let listed = root.scenes[scene].nodes.iter().map(Index::value);
    let mut is_listed = vec![false; parents.len()];
    listed.clone().for_each(|node| is_listed[node] = true);
    // What is below a listed node is drawn with it.
    let mut is_below = vec![false; parents.len()];
    for &node in order {
        if let Some(parent) = parents[node] {
            is_below[node] = is_below[parent] || is_listed[parent];
        }
    }
    let inner = listed.clone().filter(|&node| parents[node].is_some());
    let mut distinct: Vec<usize> = inner.collect();
    distinct.sort_unstable();
    distinct.dedup();
    if let Some(&first) = distinct.first() {
        let note = Note::InnerRoots {
            scene,
            node: node_name(root, first),
            count: distinct.len(),
        };
        add_note(notes, note);
    }
    listed.filter(|&node| !is_below[node]).collect()
}

/// The scene to read, where there is one.
pub(super) fn default_scene(root: &Root) -> usize {
    root.scene.map_or(0, |scene| scene.value())
}

/// Whether the node is switched on, as `KHR_node_visibility` has it.
fn is_switched_on(node: &Node) -> bool {
    let extension = node
        .extensions
        .as_ref()
        .and_then(|extensions| extensions.others.get(extensions::VISIBILITY));
    let visible = extension.and_then(|extension| extension.get("visible"));
    visible.is_none_or(|visible| visible.as_bool() != Some(false))
}

#[cfg(test)]
mod tests {
    use crate::read::uri::Folder;

    use super::super::document::read_document;
    use super::*;
    use crate::read::bytes::Bytes;

    fn read(rest: &str) -> Result<(Tree, Vec<Note>), ReadError> {
        let json = format!(r#"{{"asset": {{"version": "2.0"}}, {rest}}}"#);
        let mut notes = vec![];
        let bytes = Bytes::Held(json.as_bytes().into());
        let document = read_document(bytes, &Folder::new(".".as_ref()), &mut notes)?;
        read_tree(&document, &mut notes).map(|tree| (tree, notes))
    }

    fn message(rest: &str) -> String {
        read(rest).err().expect("an error").to_string()
    }

    #[test]
    fn transforms_nest() {
        let (tree, notes) = read(
            r#""nodes": [
                {"name": "child", "matrix": [2,0,0,0, 0,2,0,0, 0,0,2,0, 1,0,0,1]},
                {"children": [0], "translation": [0,10,0], "rotation": [0,0,3,3], "scale": [1,1,-1]}
            ]"#,
        )
        .unwrap();
        // The scaling first, then a quarter turn about z, then the translation.
        let point = tree.node_to_scene[0].transform_point3(DVec3::new(1.0, 2.0, 3.0));
        assert!(
            point.abs_diff_eq(DVec3::new(-4.0, 13.0, -6.0), 1e-14),
            "{point}"
        );
        assert_eq!(tree.drawn, [1, 0]);
        assert_eq!(
            notes,
            [Note::Scene {
                read: None,
                scenes: 0
            }]
        );
    }

    #[test]
    fn what_is_no_tree_is_refused() {
        assert_eq!(
            message(r#""nodes": [{"children": [1]}, {"name": "b"}, {"children": [1]}]"#),
            "nodes[1] (\"b\"): is a child of nodes[0] and of nodes[2], expected one parent"
        );
        for cycle in [
            r#""nodes": [{}, {"children": [2]}, {"children": [1]}]"#,
            r#""nodes": [{}, {"children": [1]}]"#,
            r#""scenes": [{"nodes": [1]}], "nodes": [{}, {"children": [1]}]"#,
        ] {
            assert_eq!(
                message(cycle),
                "nodes[1]: is among its own descendants, expected a tree"
            );
        }
    }

    #[test]
    fn what_a_scene_lists_is_drawn_once_where_its_parents_place_it() {
        let nodes = r#""nodes": [{"name": "up", "children": [1, 1], "translation": [0,5,0]},
            {"name": "inner", "children": [2], "translation": [1,0,0]}, {"name": "leaf"}, {}]"#;
        let inner = |count| Note::InnerRoots {
            scene: 0,
            node: "inner".into(),
            count,
        };
        for (listed, drawn, notes) in [
            ("0, 3, 0", vec![0, 1, 2, 3], vec![]),
            ("1", vec![1, 2], vec![inner(1)]),
            ("1, 0", vec![0, 1, 2], vec![inner(1)]),
            ("0, 2, 1, 1", vec![0, 1, 2], vec![inner(2)]),
            ("2, 1", vec![1, 2], vec![inner(2)]),
        ] {
            let (tree, found) =
                read(&format!("\"scenes\": [{{\"nodes\": [{listed}]}}], {nodes}")).unwrap();
            assert_eq!(tree.drawn, drawn, "{listed}");
            assert_eq!(found, notes, "{listed}");
            let leaf = tree.node_to_scene[2].translation;
            assert_eq!(leaf, DVec3::new(1.0, 5.0, 0.0), "{listed}");
        }
        let hidden = r#""scenes": [{"nodes": [1]}], "nodes": [{"children": [1],
            "extensions": {"KHR_node_visibility": {"visible": false}}}, {}]"#;
        let (tree, notes) = read(hidden).unwrap();
        assert!(tree.drawn.is_empty());
        let node = "node1".to_owned();
        assert!(notes.contains(&Note::Hidden { node }));
    }

    #[test]
    fn a_matrix_with_rounding_is_affine() {
        let row = |w: &str| {
            format!(
                "\"scenes\": [{{\"nodes\": [0]}}], \"nodes\": [{{\"matrix\": [2,0,0,{w}, 0,2,0,0, 0,0,2,0, 7,0,0,1.0000001]}}]"
            )
        };
        let (tree, notes) = read(&row("-3e-6")).unwrap();
        let point = tree.node_to_scene[0].transform_point3(DVec3::ONE);
        assert_eq!(point, DVec3::new(9.0, 2.0, 2.0));
        let texts: Vec<String> = notes.iter().map(Note::to_string).collect();
        assert_eq!(
            texts,
            [
                "nodes: the bottom row of 1 matrix differs from [0, 0, 0, 1] by up to 3e-6 and is ignored"
            ]
        );
        assert!(message(&row("2e-4")).contains("the bottom row of the matrix is [0.0002, "));
    }

    #[test]
    fn what_is_no_placement_is_refused() {
        assert_eq!(
            message(r#""nodes": [{"matrix": [1,0,0,0.5, 0,1,0,0, 0,0,1,0, 0,0,0,1]}]"#),
            "nodes[0]: the bottom row of the matrix is [0.5, 0.0, 0.0, 1.0], expected [0, 0, 0, 1]"
        );
        assert_eq!(
            message(r#""nodes": [{"rotation": [0,0,0,0]}]"#),
            "nodes[0]: the rotation is [0.0, 0.0, 0.0, 0.0], expected a unit quaternion"
        );
        assert_eq!(
            message(
                r#""nodes": [{"scale": [1e200,1,1], "children": [1]}, {"scale": [1e200,1,1]}]"#
            ),
            "nodes[1]: the transformation overflows, expected finite numbers"
        );
    }

    #[test]
    fn depth_is_no_limit() {
        let inner: Vec<String> = (1..100_000)
            .map(|i| format!("{{\"children\": [{i}]}}"))
            .collect();
        let (tree, _) = read(&format!("\"nodes\": [{}, {{}}]", inner.join(","))).unwrap();
        assert_eq!(tree.drawn.len(), 100_000);
    }

    #[test]
    fn a_node_that_is_not_visible_hides_its_children() {
        let (tree, notes) = read(
            r#""scenes": [{"nodes": [0, 2]}], "nodes": [{"name": "off", "children": [1],
                "extensions": {"KHR_node_visibility": {"visible": false}}}, {}, {}]"#,
        )
        .unwrap();
        assert_eq!(tree.drawn, [2]);
        assert_eq!(notes, [Note::Hidden { node: "off".into() }]);
    }
}
