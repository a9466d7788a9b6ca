//! Materials as the meshes that have them can carry them.

use std::collections::HashMap;
use std::sync::Arc;

use super::note::Note;
use super::notes::add_note;
use crate::material::Material;

/// Materials without the textures that meshes have no coordinates for, each made once and shared.
#[derive(Default)]
pub(super) struct Fitted {
    /// By address and sets of texture coordinates; those that had too much, with the material that they were.
    known: HashMap<(usize, usize), (Arc<Material>, Fit)>,
}

struct Fit {
    material: Arc<Material>,
    dropped: Vec<String>,
}

impl Fitted {
    /// What is left of a material on a mesh with so many sets of texture coordinates.
    pub(super) fn fit(
        &mut self,
        material: &Arc<Material>,
        mesh: &str,
        sets: usize,
        notes: &mut Vec<Note>,
    ) -> Arc<Material> {
        let key = (Arc::as_ptr(material) as usize, sets);
        // The material is held, so that nothing else comes to its address.
        let (_, fit) = self.known.entry(key).or_insert_with(|| {
            let (rest, dropped) = material.placed_by(sets);
            let rest = match dropped.is_empty() {
                true => material.clone(),
                false => Arc::new(rest),
            };
            let fit = Fit {
                material: rest,
                dropped,
            };
            (material.clone(), fit)
        });
        if !fit.dropped.is_empty() {
            let note = Note::Unplaced {
                mesh: mesh.to_owned(),
                material: material.name().unwrap_or_default().to_owned(),
                slots: fit.dropped.clone(),
            };
            add_note(notes, note);
        }
        fit.material.clone()
    }
}
