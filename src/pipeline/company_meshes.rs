//! The meshes of companies at one step: each is made before the first object that needs it, and dropped after the last one.

use std::collections::HashMap;
use std::ops::Range;

use glam::DAffine3;
use rayon::prelude::*;

use super::companies::{Candidate, Company, companies};
use super::shared_mesh::SharedMesh;
use super::{PlacedScene, SurfaceOptions};
use crate::scene::Unit;
use crate::spacetime::ViewModel;

/// The companies of a scene at one step, and those of their meshes that are wanted now.
pub(super) struct CompanyMeshes {
    companies: Vec<Company>,
    /// The company of each object that is in one.
    of: HashMap<usize, usize>,
    /// Of companies that have one; some have none because it cannot be proven.
    meshes: HashMap<usize, Option<SharedMesh>>,
}

impl CompanyMeshes {
    pub(super) fn new(placed: &PlacedScene, step: usize, wanted: SurfaceOptions) -> Self {
        let companies = match wanted.subdivide {
            true => companies(candidates(placed, step)),
            false => vec![],
        };
        let members = companies.iter().enumerate();
        let of = members.flat_map(|(number, company)| {
            company.members.iter().map(move |&object| (object, number))
        });
        Self {
            of: of.collect(),
            companies,
            meshes: HashMap::new(),
        }
    }

    /// Makes the meshes that these objects need, and drops those that neither they nor later ones need.
    pub(super) fn prepare(
        &mut self,
        objects: &Range<usize>,
        make: impl Fn(usize, f64) -> Option<SharedMesh> + Sync,
    ) {
        let companies = &self.companies;
        self.meshes.retain(|&number, _| {
            let last = companies[number].members.last();
            last.is_some_and(|&last| last >= objects.start)
        });
        let mut needed: Vec<usize> = objects
            .clone()
            .filter_map(|object| self.of.get(&object).copied())
            .collect();
        needed.sort_unstable();
        needed.dedup();
        needed.retain(|number| !self.meshes.contains_key(number));
        let made = needed.into_par_iter().map(|number| {
            let company = &companies[number];
            (number, make(company.leader, company.tightened))
        });
        self.meshes.par_extend(made);
    }

    /// The mesh of an object's company, if it is in one that has a mesh.
    pub(super) fn of(&self, object: usize) -> Option<&SharedMesh> {
        self.meshes.get(self.of.get(&object)?)?.as_ref()
    }
}

/// The round objects of a scene whose meshes may be shared: seen as they are, with a tolerance that is a length and that no
/// budget has loosened.
fn candidates(placed: &PlacedScene, step: usize) -> impl Iterator<Item = Candidate<'_>> {
    let all = placed.scene.objects().iter().zip(&placed.objects);
    all.enumerate()
        .filter_map(move |(number, (object, placed_object))| {
            let shaped = placed_object.curved()?;
            let tolerance = placed.scene.tolerance(object);
            let is_alone = placed_object.loosening != 1.0
                || object.view_model() != ViewModel::Seen
                || tolerance.unit() == Unit::Degrees;
            if is_alone {
                return None;
            }
            let view = placed.view(object, step)?;
            let to_observer = DAffine3::from_translation(-view.observer_rest());
            Some(Candidate {
                object: number,
                shape: &shaped.shape,
                to_offset: to_observer * shaped.to_frame(),
                velocity: view.relative_velocity(),
                tolerance,
                measure: placed.measure(object, &placed_object.parts),
            })
        })
}
