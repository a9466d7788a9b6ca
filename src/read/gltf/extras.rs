//! What a glTF file says beyond glTF of itself, of its nodes, meshes and primitives, and who made it.

use std::collections::HashMap;
use std::sync::Arc;

use gltf::json::{Extras, Root};
use serde_json::{Map, Value, json};

use super::nodes::default_scene;
use crate::read::note::{Note, plural};
use crate::read::notes::add_note;

/// What wrote the file, if that is this program.
pub(super) fn own_generator(root: &Root) -> Option<&str> {
    let generator = root.asset.generator.as_deref()?;
    let ours = generator.starts_with(concat!(env!("CARGO_PKG_NAME"), " "));
    ours.then_some(generator)
}

/// The `copyright` of the file, and the `extras` of its `asset`, of the `scene` that is read and of the `file` itself.
pub(super) fn origin(root: &Root) -> Option<Arc<Value>> {
    let copyright = root.asset.copyright.as_deref().map(Value::from);
    let scene = root.scenes.get(default_scene(root));
    let of_scene = scene.and_then(|scene| value(&scene.extras));
    let all = match own_generator(root) {
        // What this program writes there it makes anew; what it had from elsewhere goes on.
        Some(_) => vec![
            ("copyright", copyright),
            ("sources", of_scene.and_then(|e| e.get("sources").cloned())),
        ],
        None => vec![
            ("copyright", copyright),
            ("asset", value(&root.asset.extras)),
            ("scene", of_scene),
            ("file", value(&root.extras)),
        ],
    };
    table(all)
}

/// The `extras` of nodes, meshes and primitives, those that are the same made once and shared.
pub(super) struct PartExtras<'a> {
    root: &'a Root,
    is_own: bool,
    /// By mesh, and by primitive where that has some; `None` for the node where that has none.
    known: HashMap<Key, Option<Arc<Value>>>,
}

type Key = (Option<usize>, Option<usize>, Option<usize>);

impl<'a> PartExtras<'a> {
    pub(super) fn new(root: &'a Root) -> Self {
        Self {
            root,
            is_own: own_generator(root).is_some(),
            known: HashMap::new(),
        }
    }

    /// How many letters those of a part have.
    pub(super) fn letters(&self, node: usize, primitive: usize) -> u64 {
        let (_, all) = self.of(node, primitive);
        let texts = all.iter().filter_map(|(_, extras)| extras.as_ref());
        texts.map(|text| text.get().len() as u64).sum()
    }

    /// Those of a part: of a primitive of the mesh at a node.
    pub(super) fn get(&mut self, node: usize, primitive: usize) -> Option<Arc<Value>> {
        let (key, all) = self.of(node, primitive);
        if let Some(known) = self.known.get(&key) {
            return known.clone();
        }
        let made = match self.is_own {
            true => value(all[0].1).and_then(|extras| extras.get("source").cloned().map(Arc::new)),
            false => table(all.map(|(name, extras)| (name, value(extras)))),
        };
        self.known.insert(key, made.clone());
        made
    }

    fn of(&self, node: usize, primitive: usize) -> (Key, [(&'static str, &'a Extras); 3]) {
        const NONE: &Extras = &None;
        let of_node = &self.root.nodes[node].extras;
        let index = self.root.nodes[node].mesh.map(|mesh| mesh.value());
        let mesh = index.map(|index| &self.root.meshes[index]);
        let of_mesh = mesh.map_or(NONE, |mesh| &mesh.extras);
        let of_primitive = mesh.and_then(|mesh| mesh.primitives.get(primitive));
        let of_primitive = of_primitive.map_or(NONE, |primitive| &primitive.extras);
        let key = (
            of_node.is_some().then_some(node),
            index,
            of_primitive.is_some().then_some(primitive),
        );
        let all = [
            ("node", of_node),
            ("mesh", of_mesh),
            ("primitive", of_primitive),
        ];
        (key, all)
    }
}

/// Names the extras that have no place in what is read.
pub(super) fn note_lost_extras(root: &Root, notes: &mut Vec<Note>) {
    fn count<'a>(all: impl Iterator<Item = &'a Extras>) -> usize {
        all.filter(|extras| extras.is_some()).count()
    }
    let empty = root.nodes.iter().filter(|node| node.mesh.is_none());
    let left = default_scene(root);
    let other_scenes = root.scenes.iter().enumerate();
    let other_scenes = other_scenes.filter(|(index, _)| *index != left);
    for (count, singular, rest) in [
        (
            count(empty.map(|node| &node.extras)),
            "node",
            " without a mesh",
        ),
        (
            count(other_scenes.map(|(_, scene)| &scene.extras)),
            "scene",
            " that is not read",
        ),
        (
            count(root.skins.iter().map(|skin| &skin.extras)),
            "skin",
            "",
        ),
        (
            count(root.accessors.iter().map(|accessor| &accessor.extras)),
            "accessor",
            "",
        ),
        (
            count(root.buffer_views.iter().map(|view| &view.extras)),
            "buffer view",
            "",
        ),
        (
            count(root.buffers.iter().map(|buffer| &buffer.extras)),
            "buffer",
            "",
        ),
    ] {
        if count > 0 {
            let what = format!("extras of {}{rest}", plural(count, singular));
            add_note(notes, Note::NotCarried { what });
        }
    }
}

fn value(extras: &Extras) -> Option<Value> {
    let text = extras.as_ref()?.get();
    Some(serde_json::from_str(text).expect("it was read as a part of the file"))
}

/// Those that say something, by their names; nothing where none does.
fn table(all: impl IntoIterator<Item = (&'static str, Option<Value>)>) -> Option<Arc<Value>> {
    let all: Map<_, _> = all
        .into_iter()
        .filter_map(|(name, extras)| Some((name.to_owned(), extras?)))
        // Some programs write what says nothing.
        .filter(|(_, extras)| *extras != json!({}))
        .collect();
    (!all.is_empty()).then(|| Arc::new(Value::Object(all)))
}
