//! Refinement of whole meshes: first each edge once, then each triangle on its own.

use glam::{DVec3, DVec4, Vec2, Vec4};
use rayon::prelude::*;

use super::adjacency::Adjacency;
use super::edge::{EDGE_SHARE, fewest_pieces, point_between, rim_gap_share};
use super::edges::{Edges, LARGEST, Origin};
use super::outcomes::{Made, Outcome, Wanted, make};
use super::outline::Need;
use super::survey::{Survey, survey};
use super::{Allowance, Motion, edge_gap, minimum_triangles};
use crate::mesh::Mesh;

/// A refined mesh and its largest gap.
#[derive(Clone, Debug)]
pub(crate) struct Refined {
    /// The refined mesh, on the same surface up to rounding; the unchanged mesh if nothing had to be divided.
    pub(crate) mesh: Mesh,
    /// An upper bound on the largest gap `e` of a triangle: a length in the rest frame, before the factor `gamma beta`.
    pub(crate) gap: f64,
    /// Whether the gap of every triangle is within the allowance.
    pub(crate) complete: bool,
    /// A bound on the same as surfaces, as a gap.
    pub(crate) surface_gap: f64,
    /// The fewest triangles that theory allows for the allowance `whole` of [`refine`].
    pub(crate) minimum_triangles: f64,
    /// The same with at least one triangle for each triangle of the mesh.
    pub(crate) minimum_with_source: f64,
}

/// Refines the meshes of one object until the gap of every triangle is within the allowance. The meshes and the
/// position `observer` are in the rest frame. `whole` is the allowance that the tolerance would leave if the gap were
/// the only error.
///
/// The vertices of a mesh stay unchanged and in their order. New vertices follow, first those on edges. The new
/// positions lie on the flat triangles up to rounding; edges with equal ends get equal new positions, whatever other
/// attributes their vertices have, within one mesh and across meshes. Attributes are interpolated, and normals and
/// tangents are brought to unit length. The result is the same for any number of threads.
///
/// All meshes together get at most `most_more` additional triangles. If that is too few, one common factor loosens the
/// allowance of all edges and triangles; in addition, a triangle that needs more than predicted stops when its share is
/// used up. No cracks appear in either case.
pub(crate) fn refine(
    meshes: &[&Mesh],
    observer: DVec3,
    allowance: &Allowance,
    whole: &Allowance,
    most_more: u64,
    motion: Option<&Motion>,
) -> Vec<Refined> {
    // A triangle whose cheap bound is this small is never divided, and neither are its edges, because their gaps are
    // not larger, whatever a neighbour asks for.
    let small = match allowance {
        Allowance::Everywhere(allowed) => LARGEST * EDGE_SHARE * allowed,
        Allowance::Angle { .. } => 0.0,
    };
    let small_edge = |offsets: &[DVec3]| 0.5 * EDGE_SHARE * allowance.between(offsets);
    let found: Vec<Survey> = meshes
        .par_iter()
        .map(|mesh| survey(mesh, observer, small, whole, motion))
        .collect();
    let mut adjacency = Adjacency::new(meshes, &found, observer, motion, small_edge);
    let off_plane = motion.map_or(0.0, |motion| motion.as_gap(adjacency.off_plane(meshes)));
    let sources = with_sides(meshes, &adjacency, observer, whole, motion);
    let wanted = Wanted {
        meshes,
        found: &found,
        observer,
        allowance,
        motion,
        most_more,
    };
    let Made { outline, outcomes } = make(wanted, &mut adjacency);

    let mut outcomes = outcomes.into_iter();
    let (looser, needs) = (outline.looser, outline.needs);
    let parts = found.into_iter().zip(outline.edges).zip(needs).zip(sources);
    let parts: Vec<_> = parts
        .map(|(((found, edges), needs), sides)| {
            let divided = needs.iter().filter(|need| need.is_divided).count();
            let outcomes: Vec<Outcome> = outcomes.by_ref().take(divided).collect();
            (found, edges, needs, outcomes, sides)
        })
        .collect();
    let refined = meshes.par_iter().zip(parts);
    refined
        .map(|(mesh, (found, edges, needs, outcomes, sides))| {
            let mut refined = Refined {
                mesh: (*mesh).clone(),
                gap: found.gap,
                complete: looser == 1.0,
                surface_gap: found.gap,
                minimum_triangles: found.minimum_triangles,
                minimum_with_source: found.minimum_with_source + sides,
            };
            if !found.above.is_empty() {
                assemble(mesh, &found.above, &needs, outcomes, edges, &mut refined);
            }
            refined.surface_gap += off_plane;
            refined
        })
        .collect()
}

/// How many triangles more than [`Survey::minimum_with_source`] says each mesh needs because the sides of its triangles
/// have to be divided: a polygon with `b` points on its boundary has at least `b - 2` triangles.
fn with_sides(
    meshes: &[&Mesh],
    adjacency: &Adjacency,
    observer: DVec3,
    whole: &Allowance,
    motion: Option<&Motion>,
) -> Vec<f64> {
    let more = adjacency.looked.par_iter().map(|looked| {
        let mesh = meshes[looked.mesh as usize];
        let corners = mesh.triangles()[looked.index as usize];
        let offsets = corners.map(|corner| mesh.positions()[corner as usize] - observer);
        let [a, b, c] = offsets;
        let pieces = [(a, b), (b, c), (c, a)].into_iter().zip(looked.is_free);
        let pieces = pieces.map(|((from, to), is_free)| {
            // As a surface, nothing has to be divided on an edge beyond which the plane goes on.
            if is_free {
                return 1.0;
            }
            let allowed = |places: &[DVec3], along: DVec3| {
                let share = motion.map_or(1.0, |motion| rim_gap_share(motion, places, along));
                whole.between(places) / share
            };
            fewest_pieces(from, to, edge_gap(from, to), &allowed)
        });
        let fewest = pieces.sum::<f64>() - 2.0;
        if fewest <= 1.0 {
            return 0.0;
        }
        let counted = minimum_triangles(offsets, whole, motion).max(1.0);
        (fewest - counted).max(0.0)
    });
    let more: Vec<f64> = more.collect();
    let of_meshes = adjacency.firsts.windows(2);
    of_meshes
        .map(|ends| more[ends[0]..ends[1]].iter().sum())
        .collect()
}

/// Assembles a mesh from the outcomes of the triangles in `looked_at` and from all its other triangles, in the order of
/// the triangles.
fn assemble(
    mesh: &Mesh,
    looked_at: &[u32],
    needs: &[Need],
    outcomes: Vec<Outcome>,
    edges: Edges,
    refined: &mut Refined,
) {
    let positions = mesh.positions();
    let all = mesh.triangles();
    let mut outcomes = outcomes.into_iter();
    let mut origins = edges.origins;
    let mut triangles = Vec::with_capacity(all.len());
    let mut done = 0;
    for (need, &index) in needs.iter().zip(looked_at) {
        let index = index as usize;
        triangles.extend_from_slice(&all[done..index]);
        done = index + 1;
        let corners = all[index];
        let outcome = if need.is_divided {
            outcomes.next()
        } else {
            None
        };
        let Some(Outcome {
            boundary,
            pieces,
            surface,
            ..
        }) = outcome
        else {
            refined.gap = refined.gap.max(need.gap);
            refined.surface_gap = refined.surface_gap.max(need.surface);
            triangles.push(corners);
            continue;
        };
        refined.gap = refined.gap.max(pieces.gap);
        refined.surface_gap = refined.surface_gap.max(surface);
        refined.complete &= pieces.complete;
        let first = (positions.len() + origins.len()) as u32;
        let index = |local: u32| match boundary.get(local as usize) {
            Some(&vertex) => vertex,
            None => first + local - boundary.len() as u32,
        };
        triangles.extend(pieces.triangles.iter().map(|triangle| triangle.map(index)));
        let inside = pieces.inside.iter();
        origins.extend(inside.map(|&weights| Origin { corners, weights }));
    }
    triangles.extend_from_slice(&all[done..]);
    if !origins.is_empty() {
        refined.mesh = interpolated(mesh, &origins, triangles);
    }
}

/// The mesh with new vertices after the old ones, and with new triangles.
fn interpolated(mesh: &Mesh, origins: &[Origin], triangles: Vec<[u32; 3]>) -> Mesh {
    let position = |origin: &Origin| {
        let [a, b, c] = origin
            .corners
            .map(|corner| mesh.positions()[corner as usize]);
        if origin.corners[1] == origin.corners[2] {
            // A vertex on an edge gets its position from the edge rule, so that it has the same bits on both sides.
            point_between(a, b, origin.weights.y)
        } else {
            a * origin.weights.x + b * origin.weights.y + c * origin.weights.z
        }
    };
    let direction = |vectors: &[DVec3], origin: &Origin| {
        let [a, b, c] = origin.corners.map(|corner| vectors[corner as usize]);
        let mixed = a * origin.weights.x + b * origin.weights.y + c * origin.weights.z;
        mixed.try_normalize().unwrap_or(a)
    };
    let bitangent_sign =
        |tangents: &[DVec4], origin: &Origin| tangents[origin.corners[0] as usize].w;

    let positions = extended(mesh.positions(), origins, position);
    let normals = mesh
        .normals()
        .map(|normals| extended(normals, origins, |o| direction(normals, o)));
    let tangents = mesh.tangents().map(|tangents| {
        let vectors: Vec<DVec3> = tangents.iter().map(|tangent| tangent.truncate()).collect();
        extended(tangents, origins, |o| {
            direction(&vectors, o).extend(bitangent_sign(tangents, o))
        })
    });
    let texture_coordinates = mesh.texture_coordinates().iter().map(|set| {
        extended(set, origins, |o| {
            let [a, b, c] = o.corners.map(|corner| set[corner as usize].as_dvec2());
            let mixed = a * o.weights.x + b * o.weights.y + c * o.weights.z;
            Vec2::new(mixed.x as f32, mixed.y as f32)
        })
    });
    let colors = mesh.colors().map(|colors| {
        extended(colors, origins, |o| -> Vec4 {
            let [a, b, c] = o.corners.map(|corner| colors[corner as usize].as_dvec4());
            (a * o.weights.x + b * o.weights.y + c * o.weights.z).as_vec4()
        })
    });
    Mesh::from_parts(
        positions,
        triangles,
        normals,
        tangents,
        texture_coordinates.collect(),
        colors,
    )
}

fn extended<T: Copy + Send + Sync>(
    values: &[T],
    origins: &[Origin],
    make: impl Fn(&Origin) -> T + Sync + Send,
) -> Vec<T> {
    values
        .par_iter()
        .copied()
        .chain(origins.par_iter().map(make))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The texture coordinates, colours and tangents of this quad are affine functions of the position, so those of
    /// every new vertex have to follow the same functions. The old vertices have to stay first, and the triangles have
    /// to keep their orientation.
    #[test]
    fn attributes_are_interpolated_where_the_new_vertices_lie() {
        let positions = vec![
            DVec3::new(-1.0, -1.0, -0.2),
            DVec3::new(1.0, -1.0, -0.3),
            DVec3::new(1.0, 1.0, -0.4),
            DVec3::new(-1.0, 1.0, -0.3),
        ];
        let uv = |p: &DVec3| Vec2::new(0.5 + 0.25 * p.x as f32, 2.0 - p.y as f32);
        let color =
            |p: &DVec3| Vec4::new(0.5 + 0.5 * p.x as f32, 0.25, 0.5 - 0.5 * p.y as f32, 1.0);
        let normal = DVec3::new(0.05, 0.05, 1.0).normalize();
        let mesh = Mesh::new(positions.clone(), vec![[0, 1, 2], [0, 2, 3]])
            .and_then(|mesh| mesh.with_normals(vec![normal; 4]))
            .and_then(|mesh| mesh.with_tangents(vec![DVec3::X.extend(-1.0); 4]))
            .and_then(|mesh| mesh.with_texture_coordinates(positions.iter().map(uv).collect()))
            .and_then(|mesh| mesh.with_colors(positions.iter().map(color).collect()))
            .unwrap();
        let allowance = Allowance::Everywhere(1e-4);
        let mut refined = refine(
            &[&mesh],
            DVec3::ZERO,
            &allowance,
            &allowance,
            u64::MAX,
            None,
        );
        let refined = refined.pop().unwrap();
        assert!(refined.complete && refined.gap <= 1e-4);
        let made = refined.mesh;
        assert!(made.positions().len() > 500);
        assert_eq!(made.positions()[..4], positions[..]);
        for (vertex, position) in made.positions().iter().enumerate() {
            assert!((made.texture_coordinates()[0][vertex] - uv(position)).length() < 1e-6);
            assert!((made.colors().unwrap()[vertex] - color(position)).length() < 1e-6);
            assert!((made.normals().unwrap()[vertex] - normal).length() < 1e-15);
            assert_eq!(made.tangents().unwrap()[vertex], DVec3::X.extend(-1.0));
        }
        let mut area = 0.0;
        for corners in made.triangles() {
            let [a, b, c] = corners.map(|corner| made.positions()[corner as usize]);
            let turned = (b - a).cross(c - a).dot(DVec3::Z);
            assert!(turned > 0.0, "a triangle is turned over or has no area");
            area += 0.5 * turned;
        }
        assert!(
            (area - 4.0).abs() < 1e-12,
            "the pieces cover the quad once: {area}"
        );
    }

    /// The tolerance of this quad needs far more triangles than the limit.
    #[test]
    fn a_limit_holds_and_most_of_it_is_used() {
        let positions = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let positions = positions.map(|(x, y)| DVec3::new(x, y, -0.5)).to_vec();
        let mesh = Mesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
        for allowed in [1e-9, 1e-300] {
            let allowance = Allowance::Everywhere(allowed);
            for most_more in [50, 200, 1000, 5000, 20_000] {
                let refined = refine(
                    &[&mesh],
                    DVec3::ZERO,
                    &allowance,
                    &allowance,
                    most_more,
                    None,
                );
                let more = refined[0].mesh.triangles().len() as u64 - 2;
                let used = format!("{more} of {most_more} at {allowed:e}");
                assert!(more <= most_more && 2 * more >= most_more, "{used}");
            }
        }
    }
}
