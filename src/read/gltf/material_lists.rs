//! The lists of a file that describe materials, in the words of the file.

use std::collections::BTreeSet;

use serde_json::Value;

use super::mend::drop_nulls;
use crate::material::extension_names;

/// The lists of a file that describe materials.
pub(super) struct MaterialLists {
    pub(super) materials: Vec<Value>,
    pub(super) textures: Vec<Value>,
    pub(super) samplers: Vec<Value>,
    pub(super) images: Vec<Value>,
    /// Extensions that the file cannot do without.
    pub(super) required: Vec<String>,
}

impl MaterialLists {
    pub(super) fn new(root: &Value, required: Vec<String>) -> Self {
        let list = |key: &str| {
            let mut list = root.get(key).cloned().unwrap_or_default();
            drop_nulls(&mut list);
            let items = list.as_array_mut().map(std::mem::take);
            items.unwrap_or_default()
        };
        Self {
            materials: list("materials"),
            textures: list("textures"),
            samplers: list("samplers"),
            images: list("images"),
            required,
        }
    }

    /// The names of all extensions that say what surfaces look like.
    pub(super) fn extensions(&self) -> BTreeSet<String> {
        let lists = [
            &self.materials,
            &self.textures,
            &self.samplers,
            &self.images,
        ];
        let all = lists.into_iter().flatten();
        all.flat_map(extension_names).collect()
    }
}
