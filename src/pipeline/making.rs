//! The surfaces of one object at one step, made as its plan allows: refined, mapped, and certified.

use std::borrow::Cow;

use glam::DVec3;
use rayon::prelude::*;

use super::SurfaceOptions;
use super::certifying::{Measured, certificate};
use super::curved::make_curved;
use super::limits::Limits;
use super::mapped_mesh::MappedMesh;
use super::plan::{Draft, Plan};
use super::shared_mesh::SharedMesh;
use super::standing_in::back_at_rest;
use crate::material::Part;
use crate::mesh::Mesh;
use crate::tessellate::{Certificate, Counts, Refined, refine};

/// A part of the object, refined and seen.
pub(super) struct Surface<'a> {
    /// Its name in files.
    pub(super) name: String,
    /// The part at rest; that of the placed scene where nothing was refined.
    pub(super) part: Cow<'a, Part>,
    /// The mesh of the object itself where `part` is that of a stand-in and positions at rest are wanted.
    pub(super) at_rest: Option<Mesh>,
    /// The part in the observer's frame.
    pub(super) seen: MappedMesh,
    /// Low and high corner, in the observer's frame, of the box around all parts of the object that share an offset in a
    /// file with this one.
    pub(super) around: (DVec3, DVec3),
    pub(super) certificate: Certificate,
}

/// A part of the object in its final form, before its certificate: that needs the box around all parts.
struct Uncertified<'a> {
    name: String,
    part: Cow<'a, Part>,
    at_rest: Option<Mesh>,
    seen: MappedMesh,
    measured: Measured,
}

/// Carries out a plan: refines where that is wanted, maps, and certifies. A round shape may have the mesh that it shares
/// with others.
pub(super) fn make<'a>(
    mut plan: Plan<'a>,
    wanted: SurfaceOptions,
    shared: Option<&SharedMesh>,
) -> Vec<Surface<'a>> {
    if plan.as_curved.is_some() {
        match make_curved(&plan, shared) {
            Some(surface) => return vec![surface],
            None => plan.take_facets(wanted),
        }
    }
    let at_rest = plan.drafts_of_itself();
    let Draft {
        parts,
        seen,
        limits,
    } = plan.draft();
    let at_rest = match at_rest {
        Some(meshes) => meshes.into_iter().map(Some).collect(),
        None => vec![None; parts.len()],
    };
    let refined = match plan.refines(wanted) {
        true => {
            let meshes: Vec<&Mesh> = parts.iter().map(|(_, part)| part.mesh()).collect();
            let refined = refine_parts(&plan, &meshes, &limits, plan.granted);
            refined.into_iter().map(Some).collect()
        }
        false => vec![None; parts.len()],
    };
    let before = each_part(parts).into_par_iter().zip(seen);
    let made: Vec<Uncertified<'_>> = before
        .zip(refined.into_par_iter().zip(at_rest))
        .map(|((named, seen), (refined, at_rest))| match refined {
            Some(refined) => with_refined(&plan, named, seen, refined, at_rest),
            None => as_drafted(&plan, &limits, named, seen, at_rest),
        })
        .collect();
    // Refinement adds vertices beyond the box around the draft.
    let tolerance = &plan.tolerance;
    let around = tolerance.box_around(made.iter().map(|made| &made.seen));
    let surfaces = made.into_par_iter().map(|made| {
        let mesh = made.part.mesh();
        let certificate = certificate(tolerance, &limits, mesh, &made.seen, around, made.measured);
        Surface {
            name: made.name,
            part: made.part,
            at_rest: made.at_rest,
            seen: made.seen,
            around: around.unwrap_or_default(),
            certificate,
        }
    });
    surfaces.collect()
}

/// Refines the meshes of all parts at rest, within `granted` triangles beyond those of the source.
pub(super) fn refine_parts(
    plan: &Plan<'_>,
    meshes: &[&Mesh],
    limits: &Limits,
    granted: u64,
) -> Vec<Refined> {
    let before: usize = meshes.iter().map(|mesh| mesh.triangle_count()).sum();
    let more = plan.max_triangles(granted).saturating_sub(before as u64);
    let observer = plan.view().observer_rest();
    refine(
        meshes,
        observer,
        &limits.allowance,
        &limits.whole,
        more,
        plan.tolerance.motion().as_ref(),
    )
}

/// A part that keeps the mesh of its draft.
fn as_drafted<'a>(
    plan: &Plan<'_>,
    limits: &Limits,
    (name, part): (String, Cow<'a, Part>),
    seen: MappedMesh,
    at_rest: Option<Mesh>,
) -> Uncertified<'a> {
    Uncertified {
        measured: Measured::of_unrefined(&plan.tolerance, limits, part.mesh()),
        name,
        part,
        at_rest,
        seen,
    }
}

/// A part with its refined mesh, mapped again where that has more vertices than the draft.
fn with_refined<'a>(
    plan: &Plan<'_>,
    (name, part): (String, Cow<'a, Part>),
    seen: MappedMesh,
    refined: Refined,
    at_rest: Option<Mesh>,
) -> Uncertified<'a> {
    let mesh = part.mesh();
    let seen = if refined.mesh.vertex_count() == mesh.vertex_count() {
        seen
    } else {
        MappedMesh::new(plan.view(), &refined.mesh)
    };
    let counts = Counts {
        triangles_in: mesh.triangle_count(),
        triangles_out: refined.mesh.triangle_count(),
        minimum_triangles: refined.minimum_triangles,
        minimum_with_source: refined.minimum_with_source,
    };
    Uncertified {
        name,
        at_rest: at_rest.map(|before| back_at_rest(&plan.shown, &before, refined.mesh.clone())),
        part: Cow::Owned(part.with_mesh(refined.mesh)),
        seen,
        measured: Measured {
            gap: refined.gap,
            surface_gap: refined.surface_gap,
            counts,
        },
    }
}

/// The parts one by one, borrowed where all are borrowed.
fn each_part(parts: Cow<'_, [(String, Part)]>) -> Vec<(String, Cow<'_, Part>)> {
    match parts {
        Cow::Borrowed(parts) => {
            let parts = parts.iter();
            parts
                .map(|(name, part)| (name.clone(), Cow::Borrowed(part)))
                .collect()
        }
        Cow::Owned(parts) => {
            let parts = parts.into_iter();
            parts.map(|(name, part)| (name, Cow::Owned(part))).collect()
        }
    }
}
