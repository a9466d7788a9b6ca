//! A whole mesh refined: edges first, each once, then triangles, each by itself.

use std::collections::HashMap;

use glam::{DVec3, DVec4, Vec2, Vec4};
use rayon::prelude::*;

use super::edge::{EDGE_SHARE, division, needs_division, point_between};
use super::sky::{Corner, Pieces, divide};
use super::survey::survey;
use super::{Allowance, minimum_triangles, triangle_gap};
use crate::mesh::Mesh;

/// A single triangle is never given more points than this many times what theory asks for, and a few.
const MOST_POINTS: f64 = 16.0;

/// More points than this inside one triangle are a tolerance that cannot be meant: behind a fast observer the fewest
/// triangles that theory allows go with `gamma`.
const MAX_POINTS: f64 = 4_194_304.0;

/// A mesh refined, and how well.
#[derive(Clone, Debug)]
pub(crate) struct Refined {
    /// On the same surface, to rounding; the mesh itself where nothing had to be done.
    pub(crate) mesh: Mesh,
    /// The largest gap `e`, in the rest frame before the factor `gamma beta`; never below the true one.
    pub(crate) gap: f64,
    /// Whether every gap is within the allowance.
    pub(crate) complete: bool,
    /// The fewest triangles that theory allows where `whole` is allowed.
    pub(crate) minimum_triangles: f64,
}

/// Refines `mesh` as seen from `observer`, both in the rest frame, until every gap is within the allowance; `whole` is
/// what would be allowed if gaps were all there is.
///
/// Vertices of the mesh stay what they are, in their order; new ones follow, first those on edges. The new
/// positions lie on the flat triangles to rounding, equal for equal edges whatever else the vertices carry;
/// attributes are interpolated, directions brought to unit length. Same result for any number of threads.
pub(crate) fn refine(
    mesh: &Mesh,
    observer: DVec3,
    allowance: &Allowance,
    whole: &Allowance,
) -> Refined {
    // What has a small gap at a glance is never divided, nor are its edges: their gaps are not larger.
    let small = match allowance {
        Allowance::Everywhere(allowed) => EDGE_SHARE * allowed,
        Allowance::Angle { .. } => 0.0,
    };
    let found = survey(mesh, observer, small, whole);
    let mut refined = Refined {
        mesh: mesh.clone(),
        gap: found.gap,
        complete: true,
        minimum_triangles: found.minimum_triangles,
    };
    if !found.above.is_empty() {
        divide_some(mesh, &found.above, observer, allowance, &mut refined);
    }
    refined
}

/// Divides those of some triangles that have to be, in their order; all others stay what they are.
fn divide_some(
    mesh: &Mesh,
    looked_at: &[u32],
    observer: DVec3,
    allowance: &Allowance,
    refined: &mut Refined,
) {
    let positions = mesh.positions();
    let all = mesh.triangles();
    let edges = divided_edges(mesh, looked_at, observer, allowance);
    let outcomes: Vec<Outcome> = looked_at
        .par_iter()
        .map(|&index| outcome(all[index as usize], positions, observer, &edges, allowance))
        .collect();

    let mut origins = edges.origins;
    let mut triangles = Vec::with_capacity(all.len());
    let mut done = 0;
    for (outcome, &index) in outcomes.into_iter().zip(looked_at) {
        let index = index as usize;
        triangles.extend_from_slice(&all[done..index]);
        done = index + 1;
        let corners = all[index];
        match outcome {
            Outcome::Kept { gap, complete } => {
                refined.gap = refined.gap.max(gap);
                refined.complete &= complete;
                triangles.push(corners);
            }
            Outcome::Divided { boundary, pieces } => {
                refined.gap = refined.gap.max(pieces.gap);
                refined.complete &= pieces.complete;
                let first = (positions.len() + origins.len()) as u32;
                let index = |local: u32| match boundary.get(local as usize) {
                    Some(&vertex) => vertex,
                    None => first + local - boundary.len() as u32,
                };
                triangles.extend(pieces.triangles.iter().map(|triangle| triangle.map(index)));
                origins.extend(
                    pieces
                        .inside
                        .iter()
                        .map(|&weights| Origin { corners, weights }),
                );
            }
        }
    }
    triangles.extend_from_slice(&all[done..]);
    if !origins.is_empty() {
        refined.mesh = interpolated(mesh, &origins, triangles);
    }
}

/// What becomes of one triangle.
enum Outcome {
    Kept {
        gap: f64,
        complete: bool,
    },
    Divided {
        /// The vertices of the boundary, counter-clockwise from the first corner on.
        boundary: Vec<u32>,
        pieces: Pieces,
    },
}

/// Where a new vertex comes from.
#[derive(Clone, Copy, Debug)]
struct Origin {
    corners: [u32; 3],
    weights: DVec3,
}

/// The new vertices on the edges of a mesh.
struct Edges {
    /// By the two vertices, in the order of the rule: where the edge is divided, and the first new vertex.
    divisions: HashMap<[u32; 2], (Vec<f64>, u32)>,
    origins: Vec<Origin>,
}

/// The two vertices of an edge in an order that depends on their positions: both sides of a seam have the
/// same one.
fn canonical([a, b]: [u32; 2], positions: &[DVec3]) -> [u32; 2] {
    // Adding zero makes one zero of the two: they are one place.
    let key = |vertex: u32| positions[vertex as usize].to_array().map(|x| x + 0.0);
    let order = |p: [f64; 3], q: [f64; 3]| {
        p.iter()
            .zip(q)
            .map(|(p, q)| p.total_cmp(&q))
            .find(|order| order.is_ne())
    };
    match order(key(a), key(b)) {
        Some(std::cmp::Ordering::Greater) => [b, a],
        None if a > b => [b, a],
        _ => [a, b],
    }
}

fn sides([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

fn divided_edges(mesh: &Mesh, looked_at: &[u32], observer: DVec3, allowance: &Allowance) -> Edges {
    let positions = mesh.positions();
    let needs_division = |[a, b]: [u32; 2]| {
        let offset = |vertex: u32| positions[vertex as usize] - observer;
        needs_division(offset(a), offset(b), allowance)
    };
    let mut edges: Vec<[u32; 2]> = looked_at
        .par_iter()
        .flat_map_iter(|&index| sides(mesh.triangles()[index as usize]))
        .filter(|&side| needs_division(side))
        .map(|side| canonical(side, positions))
        .collect();
    edges.par_sort_unstable();
    edges.dedup();
    let divisions: Vec<Vec<f64>> = edges
        .par_iter()
        .map(|&[a, b]| {
            division(
                positions[a as usize],
                positions[b as usize],
                observer,
                allowance,
            )
        })
        .collect();

    let mut result = Edges {
        divisions: HashMap::with_capacity(edges.len()),
        origins: vec![],
    };
    for ([a, b], parameters) in edges.into_iter().zip(divisions) {
        let first = (positions.len() + result.origins.len()) as u32;
        result
            .origins
            .extend(parameters.iter().map(|&parameter| Origin {
                corners: [a, b, b],
                weights: DVec3::new(1.0 - parameter, parameter, 0.0),
            }));
        result.divisions.insert([a, b], (parameters, first));
    }
    result
}

fn outcome(
    corners: [u32; 3],
    positions: &[DVec3],
    observer: DVec3,
    edges: &Edges,
    allowance: &Allowance,
) -> Outcome {
    let [a, b, c] = corners.map(|corner| positions[corner as usize] - observer);
    let sides = sides(corners);
    let divided = |side: &[u32; 2]| edges.divisions.contains_key(&canonical(*side, positions));
    let gap = triangle_gap(a, b, c);
    let allowed = allowance.between(&[a, b, c]);
    if gap <= allowed && !sides.iter().any(divided) {
        let complete = gap <= allowed;
        return Outcome::Kept { gap, complete };
    }

    let corner_positions = corners.map(|corner| positions[corner as usize]);
    let mut boundary = vec![];
    let mut points = vec![];
    for (number, side) in sides.into_iter().enumerate() {
        let (from, to) = (number, (number + 1) % 3);
        let at = |weights: DVec3, position: DVec3, sides: u8| Corner {
            weights,
            offset: position - observer,
            sides,
        };
        let unit =
            |corner: usize| DVec3::from_array([0, 1, 2].map(|i| f64::from(u8::from(i == corner))));
        boundary.push(side[0]);
        points.push(at(
            unit(from),
            corner_positions[from],
            1 << number | 1 << ((number + 2) % 3),
        ));
        let key = canonical(side, positions);
        let Some((parameters, first)) = edges.divisions.get(&key) else {
            continue;
        };
        let [p, q] = key.map(|vertex| positions[vertex as usize]);
        let forward = key == side;
        let mut order: Vec<usize> = (0..parameters.len()).collect();
        if !forward {
            order.reverse();
        }
        for index in order {
            let parameter = parameters[index];
            let from_weight = if forward { 1.0 - parameter } else { parameter };
            let weights = unit(from) * from_weight + unit(to) * (1.0 - from_weight);
            boundary.push(first + index as u32);
            points.push(at(weights, point_between(p, q, parameter), 1 << number));
        }
    }
    let minimum = minimum_triangles([a, b, c], allowance);
    let most_points = MOST_POINTS * (minimum + points.len() as f64) + 64.0;
    let most_points = most_points.min(MAX_POINTS) as usize;
    let pieces = divide(corner_positions, observer, &points, allowance, most_points);
    Outcome::Divided { boundary, pieces }
}

/// The mesh with new vertices behind the old ones, and other triangles.
fn interpolated(mesh: &Mesh, origins: &[Origin], triangles: Vec<[u32; 3]>) -> Mesh {
    let position = |origin: &Origin| {
        let [a, b, c] = origin
            .corners
            .map(|corner| mesh.positions()[corner as usize]);
        if origin.corners[1] == origin.corners[2] {
            // On an edge, as the edge rule has it: the same bits from both sides.
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

    /// A quad whose texture coordinates, colours and tangents are affine in position: so are those of every new
    /// vertex; the old ones stay first, and triangles keep their side.
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
        let refined = refine(&mesh, DVec3::ZERO, &allowance, &allowance);
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
}
