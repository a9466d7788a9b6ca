//! Places the models of objects in their rest frames; objects that are alike share what they are made of.

use std::collections::HashMap;

use glam::{DAffine3, DVec3};

use super::names::UniqueNames;
use super::placed_object::{PlacedObject, Shaped, triangle_count};
use super::placed_scene::wanted_name;
use crate::material::{Model, Part};
use crate::mesh::{Mesh, MeshIdentity};
use crate::scene::Object;

/// The objects placed so far, and the meshes that others like them can share.
#[derive(Default)]
pub(super) struct Placing {
    names: UniqueNames,
    /// Each mesh that a transform has changed: the original, which is kept so that no other gets its identity, and the
    /// result.
    transformed: HashMap<(MeshIdentity, [u64; 12]), (Mesh, Mesh)>,
}

impl Placing {
    /// Places objects whose parts get names that `names` has not given yet.
    pub(super) fn new(names: UniqueNames) -> Self {
        Self {
            names,
            transformed: HashMap::new(),
        }
    }

    /// An object with its model, in its rest frame. A shape with flat faces and no resolution of its own has its coarsest
    /// form, whatever form its model has.
    pub(super) fn placed(&mut self, object: &Object, model: Model) -> PlacedObject {
        let shaped = Shaped::of(object);
        let count = model.parts.len();
        let to_rest = object.model_to_rest();
        let parts = model.parts.into_iter().map(|part| {
            let name = self.names.unique(&wanted_name(object, &part, count));
            let part = match &shaped {
                Some(shaped) if shaped.is_sampled() => with_form(part, shaped),
                _ => part,
            };
            (name, self.transformed(part, &to_rest))
        });
        let parts: Vec<(String, Part)> = parts.collect();
        PlacedObject {
            source_triangles: match &shaped {
                Some(shaped) => shaped.min_triangles(&parts),
                None => triangle_count(&parts),
            },
            parts,
            shaped,
            loosening: 1.0,
            beside: DVec3::ZERO,
            granted: None,
        }
    }

    fn transformed(&mut self, part: Part, to_rest: &DAffine3) -> Part {
        if *to_rest == DAffine3::IDENTITY {
            return part;
        }
        let key = (
            part.mesh().identity(),
            to_rest.to_cols_array().map(f64::to_bits),
        );
        if let Some((_, mesh)) = self.transformed.get(&key) {
            return part.with_mesh(mesh.clone());
        }
        let original = part.mesh().clone();
        let part = part.transformed(to_rest);
        // Once for all who share the mesh: a clone knows what its original knows.
        part.mesh().bounds();
        self.transformed
            .insert(key, (original, part.mesh().clone()));
        part
    }
}

/// The part with the mesh of the form in which the shape is placed.
fn with_form(part: Part, shaped: &Shaped) -> Part {
    if part.mesh().maker() == Some(&shaped.placed) {
        return part;
    }
    match shaped.placed.mesh() {
        Ok(mesh) => part.with_mesh(mesh),
        // A finer form was made.
        Err(_) => unreachable!("the coarsest form of a shape that could be made"),
    }
}
