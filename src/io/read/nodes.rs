//! The tree of nodes: which are drawn, and where each stands.
//!
//! glTF 2.0, section 3.5. Trees of any depth, without recursion; what is not a tree is refused.

use glam::{DAffine3, DMat4, DQuat, DVec3};
use gltf::json::{Index, Node, Root};

use super::document::{Document, Placement};
use super::note::{Note, add_note};
use super::{NodeProblem, ReadError, extensions};

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
    for &node in &order {
        let parent = parents[node].map_or(DAffine3::IDENTITY, |parent| node_to_scene[parent]);
        let local = local_transform(&document.placements[node])
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

    let roots = scene_roots(root, &parents, orphans, notes)?;
    let drawn = depth_first(root, &roots, |node| {
        let visible = is_visible(&root.nodes[node]);
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
            if let Some(first) = parents[child].replace(parent) {
                let second = parent;
                let problem = NodeProblem::TwoParents { first, second };
                return Err(error(root, child, problem));
            }
        }
    }
    Ok(parents)
}

/// The nodes below and including `roots`, parents before children; `enter` can leave out a branch.
fn depth_first(root: &Root, roots: &[usize], mut enter: impl FnMut(usize) -> bool) -> Vec<usize> {
    let mut order = vec![];
    let mut stack: Vec<usize> = roots.iter().rev().copied().collect();
    while let Some(node) = stack.pop() {
        if enter(node) {
            order.push(node);
            let children = root.nodes[node].children.iter().flatten();
            stack.extend(children.rev().map(Index::value));
        }
    }
    order
}

fn local_transform(placement: &Placement) -> Result<DAffine3, NodeProblem> {
    if let Some(matrix) = &placement.matrix {
        let matrix = DMat4::from_cols_array(matrix);
        let row = matrix.row(3).to_array();
        if row != [0.0, 0.0, 0.0, 1.0] {
            return Err(NodeProblem::Projective { row });
        }
        return Ok(DAffine3::from_mat4(matrix));
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

/// The nodes that the scene to read starts at.
fn scene_roots(
    root: &Root,
    parents: &[Option<usize>],
    orphans: Vec<usize>,
    notes: &mut Vec<Note>,
) -> Result<Vec<usize>, ReadError> {
    let scenes = root.scenes.len();
    if scenes == 0 {
        add_note(notes, Note::Scene { read: None, scenes });
        return Ok(orphans);
    }
    let scene = root.scene.map_or(0, |scene| scene.value());
    if scenes > 1 {
        let read = Some(scene);
        add_note(notes, Note::Scene { read, scenes });
    }
    let mut listed = vec![false; parents.len()];
    for node in root.scenes[scene].nodes.iter().map(Index::value) {
        if parents[node].is_some() || std::mem::replace(&mut listed[node], true) {
            return Err(error(root, node, NodeProblem::NotARoot { scene }));
        }
    }
    Ok(root.scenes[scene].nodes.iter().map(Index::value).collect())
}

/// Whether the node is switched on, as `KHR_node_visibility` has it.
fn is_visible(node: &Node) -> bool {
    let extension = node
        .extensions
        .as_ref()
        .and_then(|extensions| extensions.others.get(extensions::VISIBILITY));
    let visible = extension.and_then(|extension| extension.get("visible"));
    visible.is_none_or(|visible| visible.as_bool() != Some(false))
}

#[cfg(test)]
mod tests {
    use super::super::uri::Folder;

    use super::super::bytes::Bytes;
    use super::super::document::read_document;
    use super::*;

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
        let twice = r#""scenes": [{"nodes": [0, 0]}], "nodes": [{}]"#;
        assert!(message(twice).contains("expected root nodes, each once"));
        let inner = r#""scenes": [{"nodes": [1]}], "nodes": [{"children": [1]}, {}]"#;
        assert!(message(inner).contains("expected root nodes, each once"));
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
