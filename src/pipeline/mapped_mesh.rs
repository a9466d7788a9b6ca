//! A mesh at rest as one observer sees it.

use glam::{DVec3, DVec4};
use rayon::prelude::*;

use crate::light_cone::{Batch, Extremes, ModelView, View};
use crate::mesh::{Extent, MANY_VERTICES, Mesh, VALUES_PER_JOB, VERTICES_AT_ONCE, flattened};

/// Number of vertices whose extremes are found together. It is a multiple of [`VERTICES_AT_ONCE`], and constant: which of 0
/// and -0 is less depends on it.
const VERTICES_IN_BATCH: usize = 1024;

/// A mesh in the observer's frame, and the extremes of its vertices.
#[derive(Clone, Debug)]
pub(super) struct MappedMesh {
    pub(super) mesh: Mesh,
    pub(super) extremes: Extremes,
}

impl MappedMesh {
    /// Maps every vertex of a mesh at rest, with its normal and its tangent. Of a large mesh only the extremes stay in memory:
    /// the vertices are mapped again wherever they are wanted.
    pub(super) fn new(view: &View, rest: &Mesh) -> Self {
        let tangents = rest.tangents().map(|tangents| {
            let places = rest.places();
            let jobs = tangents.par_iter().enumerate().with_min_len(VALUES_PER_JOB);
            // The map preserves orientation, so the bitangent keeps its sign.
            let seen = |(vertex, tangent): (usize, &DVec4)| {
                view.seen_tangent(places.at(vertex as u32), tangent.truncate())
                    .extend(tangent.w)
            };
            jobs.map(seen).collect()
        });
        if rest.vertex_count() > MANY_VERTICES {
            return Self::computed(*view, rest, tangents);
        }
        let (positions, normals, extremes) = places(view, rest);
        let normals = rest.has_normals().then_some(normals);
        Self {
            mesh: rest.with_geometry(positions, normals, tangents),
            extremes,
        }
    }

    fn computed(view: View, rest: &Mesh, tangents: Option<Vec<DVec4>>) -> Self {
        let vertices = rest.vertex_count();
        let jobs = (0..vertices.div_ceil(VALUES_PER_JOB)).into_par_iter();
        let found: Vec<(Extremes, Option<Extent>)> = jobs
            .map(|job| {
                let first = job * VALUES_PER_JOB;
                let end = vertices.min(first + VALUES_PER_JOB);
                let mut at_rest = [DVec3::ZERO; VERTICES_IN_BATCH];
                let mut seen = [DVec3::ZERO; VERTICES_IN_BATCH];
                let nothing = (Extremes::NONE, None);
                (first..end).step_by(VERTICES_IN_BATCH).fold(
                    nothing,
                    |(extremes, extent), first| {
                        let count = VERTICES_IN_BATCH.min(end - first);
                        let (at_rest, seen) = (&mut at_rest[..count], &mut seen[..count]);
                        rest.read_vertices(first, at_rest, None);
                        let found = view.see(Batch {
                            rest: at_rest,
                            seen,
                            normals: None,
                        });
                        (extremes.and(found), Extent::around(extent, seen))
                    },
                )
            })
            .collect();
        let (extremes, extents): (Vec<_>, Vec<_>) = found.into_iter().unzip();
        let extent = extents.into_iter().flatten().reduce(Extent::with);
        let at_rest = rest.clone();
        let compute =
            move |first: usize, positions: &mut [DVec3], normals: Option<&mut [DVec3]>| {
                see_piece(&view, &at_rest, first, positions, normals);
            };
        Self {
            mesh: rest.image(Box::new(compute), tangents, extent),
            extremes: extremes.into_iter().fold(Extremes::NONE, Extremes::and),
        }
    }

    /// How many times, at most, a small error of a vertex at rest is magnified.
    pub(super) fn condition(&self, shown: &ModelView) -> f64 {
        let of_stand_in = shown
            .of_stand_in(0.0)
            .stretch_toward(self.extremes.forwardness);
        of_stand_in * shown.stretch().max(1.0)
    }
}

/// Maps the vertices from number `first` on, and their normals where these are asked for.
fn see_piece(
    view: &View,
    rest: &Mesh,
    first: usize,
    positions: &mut [DVec3],
    normals: Option<&mut [DVec3]>,
) {
    let mut places = [DVec3::ZERO; VERTICES_AT_ONCE];
    let firsts = (first..).step_by(VERTICES_AT_ONCE);
    let pieces = firsts.zip(positions.chunks_mut(VERTICES_AT_ONCE));
    let Some(normals) = normals else {
        for (first, seen) in pieces {
            let places = &mut places[..seen.len()];
            rest.read_vertices(first, places, None);
            view.seen_positions(places, seen);
        }
        return;
    };
    let mut directions = [DVec3::ZERO; VERTICES_AT_ONCE];
    for ((first, seen), seen_normals) in pieces.zip(normals.chunks_mut(VERTICES_AT_ONCE)) {
        let places = &mut places[..seen.len()];
        let directions = &mut directions[..seen.len()];
        rest.read_vertices(first, places, Some(&mut *directions));
        view.see_again(Batch {
            rest: places,
            seen,
            normals: Some((directions, seen_normals)),
        });
    }
}

/// The positions and normals of the vertices in the observer's frame, and their extremes. The normals have no meaning
/// if the mesh at rest has none.
fn places(view: &View, rest: &Mesh) -> (Vec<DVec3>, Vec<DVec3>, Extremes) {
    let vertices = rest.vertex_count();
    let (places, directions) = (rest.positions(), rest.normals());
    let see = |first: usize, positions: &mut [DVec3], normals: &mut [DVec3]| {
        let part = first..first + positions.len();
        view.see(Batch {
            rest: &places[part.clone()],
            seen: positions,
            normals: directions.map(|rest| (&rest[part], normals)),
        })
    };
    if vertices <= VERTICES_IN_BATCH {
        let (mut positions, mut normals) =
            (vec![DVec3::ZERO; vertices], vec![DVec3::ZERO; vertices]);
        let extremes = see(0, &mut positions, &mut normals);
        return (positions, normals, extremes);
    }
    // Each array has a known index in the result, so all threads write directly to the result's memory.
    let jobs = (0..vertices.div_ceil(VERTICES_IN_BATCH)).into_par_iter();
    let arrays = jobs.map(|job| {
        let first = job * VERTICES_IN_BATCH;
        let count = VERTICES_IN_BATCH.min(vertices - first);
        let mut positions = [DVec3::ZERO; VERTICES_IN_BATCH];
        let mut normals = [DVec3::ZERO; VERTICES_IN_BATCH];
        let extremes = see(first, &mut positions[..count], &mut normals[..count]);
        (extremes, (positions, normals))
    });
    let (extremes, (positions, normals)): (Vec<_>, (Vec<_>, Vec<_>)) = arrays.unzip();
    (
        flattened(positions, vertices),
        flattened(normals, vertices),
        extremes.into_iter().fold(Extremes::NONE, Extremes::and),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Shape;
    use crate::spacetime::{Event, Velocity, WorldLine};

    #[test]
    fn vertices_are_seen_the_same_at_hand_or_wherever_they_are_wanted() {
        let line = |position, velocity| WorldLine {
            origin: Event::new(0.0, position),
            velocity,
        };
        let velocity = Velocity::from_beta(0.9, DVec3::new(1.0, 2.0, -3.0)).unwrap();
        let observer = line(DVec3::new(0.1, 0.2, 4.0), velocity).moment(0.25);
        let view = View::new(&observer, &line(DVec3::ZERO, Velocity::default()));
        let torus = Shape::torus(2.0, 0.5).unwrap().mesh().unwrap();
        for rest in [torus.clone(), torus.without_normals(), Mesh::default()] {
            let at_hand = MappedMesh::new(&view, &rest);
            let computed = MappedMesh::computed(view, &rest, None);
            assert_eq!(computed.extremes, at_hand.extremes);
            assert_eq!(computed.mesh.bounds(), at_hand.mesh.bounds());
            assert_eq!(computed.mesh.has_normals(), rest.has_normals());
            let count = rest.vertex_count();
            let mut read = [vec![DVec3::ZERO; count], vec![DVec3::ZERO; count]];
            let [places, directions] = &mut read;
            computed.mesh.read_vertices(0, places, None);
            assert_eq!(places, at_hand.mesh.positions());
            if let Some(normals) = at_hand.mesh.normals() {
                computed.mesh.read_vertices(0, places, Some(directions));
                assert_eq!(directions, normals);
            }
            assert_eq!(places, at_hand.mesh.positions());
            assert!(computed.mesh == at_hand.mesh);
        }
    }
}
