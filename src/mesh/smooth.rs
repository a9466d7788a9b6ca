//! Smooth normals: shared vertices, parted along creases.
//!
//! Source: G. Thürmer, C. Wüthrich, *Computing vertex normals from polygonal facets*, J. Graphics Tools 3 (1998), 43.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use super::alike::{first_alike, number};
use super::vectors::Places;
use super::{Mesh, MeshError};
use crate::spacetime::unit;

/// Rounding of the cosine of a limit: two facets at exactly that angle are smooth.
const ROUNDING: f64 = 1e-12;

/// Places, or triangles, of which several threads find out together, before one thread takes it up.
const AT_ONCE: usize = 1 << 18;
/// Those that a thread takes at a time.
const PER_JOB: usize = 1 << 12;

impl Mesh {
    /// The mesh with smooth normals in place of its own, without tangents. The normal of a vertex is the sum of the normals
    /// of its facets, each times the facet's angle there.
    ///
    /// Vertices of equal position, texture coordinates and colour become one, and each vertex is parted along creases: edges
    /// at which the surface turns by more than `max_angle` radians, and edges of one facet or of more than two. A facet
    /// without area has no crease. Vertices in no triangle vanish.
    ///
    /// # Errors
    ///
    /// More vertices than a `u32` index can tell apart.
    pub fn with_smooth_normals(&self, max_angle: f64) -> Result<Self, MeshError> {
        let triangles = self.triangles();
        let corners = triangles.as_flattened();
        if corners.len() > u32::MAX as usize {
            return Err(MeshError::TooManyVertices(corners.len()));
        }
        let surface = Surface {
            places: self.places(),
            triangles,
        };
        let alike = first_alike(self.vertex_count(), |vertex| {
            let place = surface.places.at(vertex) + DVec3::ZERO;
            place.to_array().map(f64::to_bits)
        });
        // The fan of each corner, in time the vertex of each corner.
        let mut numbers = surface.fans(&alike, max_angle.cos() - ROUNDING);
        let first_corners = number(numbers.as_flattened_mut());
        let sums = surface.sums(&numbers, first_corners.len());
        let normal = |sum: DVec3, corner: u32| {
            let facet = || unit(surface.facet(corner as usize / 3));
            unit(sum).or_else(facet).unwrap_or(DVec3::Y)
        };
        let (firsts, normals) = match self.is_bare() {
            // Each fan is a vertex.
            true => {
                let mut normals = sums;
                let jobs = normals.par_iter_mut().zip(&first_corners);
                let jobs = jobs.with_min_len(PER_JOB);
                jobs.for_each(|(sum, &corner)| *sum = normal(*sum, corner));
                (first_corners, normals)
            }
            false => {
                let bases = self.alike(&alike);
                let fans = numbers.as_flattened();
                let key = |corner: u32| {
                    let base = bases[corners[corner as usize] as usize];
                    (base, fans[corner as usize])
                };
                let mut vertices = first_alike(corners.len(), key);
                let firsts = number(&mut vertices);
                let jobs = firsts.par_iter().with_min_len(PER_JOB);
                let sum = |corner: u32| sums[fans[corner as usize] as usize];
                let normals = jobs.map(|&corner| normal(sum(corner), corner)).collect();
                numbers.as_flattened_mut().copy_from_slice(&vertices);
                (firsts, normals)
            }
        };
        let mut vertices = firsts;
        vertices
            .iter_mut()
            .for_each(|first| *first = corners[*first as usize]);
        let picked = |index: &u32| *index as usize;
        let colors = self.colors();
        let colors = colors.map(|colors| vertices.iter().map(|i| colors[picked(i)]).collect());
        let sets = self.texture_coordinates().iter();
        let sets = sets.map(|set| vertices.iter().map(|i| set[picked(i)]).collect());
        let sets = sets.collect();
        let positions = self.shared_positions().picked(&vertices);
        Ok(Self::from_vectors(
            positions,
            numbers,
            Some(normals.into()),
            sets,
            colors,
        ))
    }

    /// Whether vertices at one place are the same but for normals.
    fn is_bare(&self) -> bool {
        self.texture_coordinates().is_empty() && self.colors().is_none()
    }

    /// For each vertex the first one of the same place, texture coordinates and colour; `places` says the first one of the
    /// same place.
    fn alike(&self, places: &[u32]) -> Vec<u32> {
        let mut firsts = places.to_vec();
        for set in self.texture_coordinates() {
            firsts = first_alike(firsts.len(), |vertex| {
                let bits = set[vertex as usize].to_array().map(f32::to_bits);
                (firsts[vertex as usize], bits)
            });
        }
        if let Some(colors) = self.colors() {
            firsts = first_alike(firsts.len(), |vertex| {
                let bits = colors[vertex as usize].to_array().map(f32::to_bits);
                (firsts[vertex as usize], bits)
            });
        }
        firsts
    }
}

/// Triangles between places.
#[derive(Clone, Copy)]
struct Surface<'a> {
    places: Places<'a>,
    triangles: &'a [[u32; 3]],
}

impl Surface<'_> {
    fn corners_of(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|corner| self.places.at(corner))
    }

    /// The unit normal of a triangle; zero if it has no area.
    fn facet(&self, triangle: usize) -> DVec3 {
        let [a, b, c] = self.corners_of(triangle);
        unit((b - a).cross(c - a)).unwrap_or(DVec3::ZERO)
    }

    /// For each corner the first corner that has one normal with it. `alike` says the first vertex at the place of each,
    /// and `least` is the least cosine of a crease's angle.
    fn fans(&self, alike: &[u32], least: f64) -> Vec<[u32; 3]> {
        let corners = self.triangles.as_flattened();
        let place = |corner: u32| alike[corners[corner as usize] as usize];
        let edges = Edges::new(alike.len(), corners.len(), place);
        let is_smooth = |[one, other]: [u32; 2]| {
            let [n, m] = [one, other].map(|corner| self.facet(corner as usize / 3));
            n == DVec3::ZERO || m == DVec3::ZERO || n.dot(m) >= least
        };
        let mut fans = Fans::new(self.triangles.len());
        for start in (0..alike.len()).step_by(AT_ONCE) {
            let all = start..alike.len().min(start + AT_ONCE);
            let jobs = all.into_par_iter().step_by(PER_JOB);
            let smooth = jobs.map(|first| {
                let mut smooth = vec![];
                let places = first..alike.len().min(first + PER_JOB).min(start + AT_ONCE);
                edges.inner(places, place, |pair| {
                    if is_smooth(pair) {
                        smooth.push(pair);
                    }
                });
                smooth
            });
            for [one, other] in smooth.collect::<Vec<_>>().into_iter().flatten() {
                for corner in [one, next(one)] {
                    let same = [other, next(other)].into_iter();
                    let same = same.filter(|&same| place(same) == place(corner));
                    same.for_each(|same| fans.join(corner, same));
                }
            }
        }
        fans.into_roots()
    }

    /// The sum of the normals of each of so many fans, in the order of the corners.
    fn sums(&self, fans: &[[u32; 3]], count: usize) -> Vec<DVec3> {
        let mut sums = vec![DVec3::ZERO; count];
        let mut start = 0;
        for fans in fans.chunks(AT_ONCE) {
            let jobs = (start..start + fans.len()).into_par_iter();
            let jobs = jobs.with_min_len(PER_JOB);
            let normals: Vec<[DVec3; 3]> = jobs.map(|triangle| self.shares(triangle)).collect();
            for (fan, normal) in fans.as_flattened().iter().zip(normals.as_flattened()) {
                sums[*fan as usize] += *normal;
            }
            start += fans.len();
        }
        sums
    }

    /// The normal of a triangle times its angle at each corner.
    fn shares(&self, triangle: usize) -> [DVec3; 3] {
        let (normal, [a, b, c]) = (self.facet(triangle), self.corners_of(triangle));
        [[a, b, c], [b, c, a], [c, a, b]].map(|[own, one, other]| {
            let edges = [one - own, other - own];
            let [one, other] = edges.map(|edge| unit(edge).unwrap_or_default());
            normal * one.cross(other).length().atan2(one.dot(other))
        })
    }
}

/// The next corner of the same triangle.
fn next(corner: u32) -> u32 {
    match corner % 3 {
        2 => corner - 2,
        _ => corner + 1,
    }
}

/// The edges of all triangles, each named by its first corner, by the lower one of the places that they are between.
struct Edges {
    /// Where the edges of each place begin.
    starts: Vec<u32>,
    corners: Vec<u32>,
}

impl Edges {
    fn new(places: usize, corners: usize, place: impl Fn(u32) -> u32) -> Self {
        // An edge between equal places is none.
        let lower = |corner: u32| {
            let (from, to) = (place(corner), place(next(corner)));
            (from != to).then_some(from.min(to) as usize)
        };
        let all = || 0..corners as u32;
        let mut starts = vec![0; places + 1];
        all().filter_map(lower).for_each(|place| starts[place] += 1);
        // The end of each, which comes down to its start while edges are put there from behind.
        let mut end = 0;
        for start in &mut starts {
            end += *start;
            *start = end;
        }
        let mut sorted = vec![0; end as usize];
        for corner in all().rev() {
            if let Some(place) = lower(corner) {
                starts[place] -= 1;
                sorted[starts[place] as usize] = corner;
            }
        }
        Self {
            starts,
            corners: sorted,
        }
    }

    /// Tells the pairs of edges that are all the edges between two places, of which the lower is among `places`.
    fn inner(
        &self,
        places: Range<usize>,
        place: impl Fn(u32) -> u32,
        mut tell: impl FnMut([u32; 2]),
    ) {
        let mut edges: Vec<(u32, u32)> = vec![];
        for lower in places {
            let of_place = self.starts[lower] as usize..self.starts[lower + 1] as usize;
            let upper = |corner: u32| place(corner).max(place(next(corner)));
            let of_place = self.corners[of_place].iter();
            edges.clear();
            edges.extend(of_place.map(|&corner| (upper(corner), corner)));
            edges.sort_unstable();
            for alike in edges.chunk_by(|one, other| one.0 == other.0) {
                if let &[(_, one), (_, other)] = alike {
                    tell([one, other]);
                }
            }
        }
    }
}

/// Corners at one place that have one normal, each with a corner that stands for all.
struct Fans(Vec<[u32; 3]>);

impl Fans {
    fn new(triangles: usize) -> Self {
        let corners = |triangle: u32| [3 * triangle, 3 * triangle + 1, 3 * triangle + 2];
        Self((0..triangles as u32).map(corners).collect())
    }

    fn root(&mut self, mut corner: u32) -> u32 {
        let above = self.0.as_flattened_mut();
        while above[corner as usize] != corner {
            let highest = above[above[corner as usize] as usize];
            above[corner as usize] = highest;
            corner = highest;
        }
        corner
    }

    /// The lower root stays, so that the order of joins does not matter.
    fn join(&mut self, one: u32, other: u32) {
        let (one, other) = (self.root(one), self.root(other));
        self.0.as_flattened_mut()[one.max(other) as usize] = one.min(other);
    }

    fn into_roots(mut self) -> Vec<[u32; 3]> {
        let above = self.0.as_flattened_mut();
        for corner in 0..above.len() {
            // Those before have been replaced by their roots.
            above[corner] = above[above[corner] as usize];
        }
        self.0
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;
    use std::f64::consts::PI;

    use super::*;
    use crate::shape::Shape;

    const LIMIT: f64 = PI / 3.0;

    /// Facets that share no vertex.
    fn soup(mesh: &Mesh) -> Mesh {
        mesh.clone().without_normals().with_flat_normals().unwrap()
    }

    #[test]
    fn normals_of_a_sphere_are_nearly_radial_and_its_vertices_shared() {
        let sphere = Shape::sphere(2.0).unwrap().mesh().unwrap();
        let bits = |place: &DVec3| (*place + DVec3::ZERO).to_array().map(f64::to_bits);
        let places: HashSet<_> = sphere.positions().iter().map(bits).collect();
        // Without texture coordinates, whose seams part vertices.
        let bare = Mesh::new(sphere.positions().to_vec(), sphere.triangles().to_vec()).unwrap();
        let again = soup(&bare).with_smooth_normals(LIMIT).unwrap();
        assert_eq!(again.positions().len(), places.len());
        for (position, normal) in again.positions().iter().zip(again.normals().unwrap()) {
            let angle = normal.angle_between(*position);
            assert!(angle < 0.02, "{angle} at {position}");
            assert!((normal.length() - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn a_cube_is_sharp_or_round_as_the_limit_says() {
        let sign = |i: u32, axis: u32| if i >> axis & 1 == 1 { 1.0 } else { -1.0 };
        let corner = |i| DVec3::new(sign(i, 0), 2.0 * sign(i, 1), 3.0 * sign(i, 2));
        let sides = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let triangles = sides
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        let cube = Mesh::new((0..8).map(corner).collect(), triangles.collect()).unwrap();
        let count = |degrees: f64| {
            let smooth = soup(&cube)
                .with_smooth_normals(degrees.to_radians())
                .unwrap();
            for (position, normal) in smooth.positions().iter().zip(smooth.normals().unwrap()) {
                // The angle of each side is a right one, however it is cut into triangles.
                let corner = position.signum() / 3f64.sqrt();
                match degrees < 90.0 {
                    true => assert_eq!(normal.abs().max_element(), 1.0),
                    false => assert!(normal.distance(corner) < 1e-15, "{normal}"),
                }
            }
            smooth.positions().len()
        };
        assert_eq!(
            [0.0, 60.0, 89.9, 90.0, 180.0].map(count),
            [24, 24, 24, 8, 8]
        );
    }

    #[test]
    fn texture_coordinates_part_vertices_and_normals_do_not() {
        let places = [
            DVec3::ZERO,
            DVec3::X,
            DVec3::Y,
            DVec3::X,
            DVec3::Y,
            DVec3::ONE,
        ];
        let mesh = Mesh::new(places.to_vec(), vec![[0, 1, 2], [4, 3, 5]]).unwrap();
        let smooth = mesh.with_smooth_normals(PI).unwrap();
        assert_eq!(smooth.triangles(), [[0, 1, 2], [2, 1, 3]]);
        let seam = [0.0, 0.5, 0.5, 0.5, 0.75, 1.0].map(glam::Vec2::splat);
        let mesh = mesh.with_texture_coordinates(seam.to_vec()).unwrap();
        let parted = mesh.with_smooth_normals(PI).unwrap();
        assert_eq!(parted.triangles(), [[0, 1, 2], [3, 1, 4]]);
        // One normal on both sides of the seam.
        let normals = parted.normals().unwrap();
        assert_eq!(normals[2], normals[3]);
        assert_eq!(parted.texture_coordinates()[0][3].x, 0.75);
    }

    #[test]
    fn hard_cases_have_unit_normals_in_any_order_of_threads() {
        let [o, x, y, z] = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let far = 1e75;
        let places = vec![
            o,
            x,
            y,
            z,
            -z,
            x * 0.5,
            o,
            x * far,
            y * far,
            x * 1e-300,
            y * 1e-300,
            DVec3::ONE,
        ];
        // Three facets at one edge, facets without area, a huge one and a tiny one; the last vertex is isolated.
        let triangles = vec![
            [0, 1, 2],
            [0, 1, 3],
            [1, 0, 4],
            [0, 1, 5],
            [0, 6, 1],
            [3, 3, 3],
            [6, 7, 8],
            [0, 9, 10],
            [2, 1, 0],
        ];
        let mesh = Mesh::new(places, triangles).unwrap();
        let smooth = mesh.with_smooth_normals(LIMIT).unwrap();
        assert_eq!(smooth.triangles().len(), mesh.triangles().len());
        for normal in smooth.normals().unwrap() {
            assert!((normal.length() - 1.0).abs() < 1e-15, "{normal}");
        }
        assert!(!smooth.positions().contains(&DVec3::ONE));
        let corners = |mesh: &Mesh| -> Vec<_> {
            (0..mesh.triangles().len())
                .map(|t| mesh.corners_of(t))
                .collect()
        };
        assert_eq!(corners(&smooth), corners(&mesh));
        let torus = Shape::torus(2.0, 0.5).unwrap().mesh().unwrap();
        for mesh in [mesh, soup(&torus)] {
            let with = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                pool.unwrap()
                    .install(|| mesh.with_smooth_normals(LIMIT).unwrap())
            };
            assert_eq!(with(1), with(5));
        }
        let none = Mesh::default().with_smooth_normals(LIMIT).unwrap();
        assert_eq!(none.positions().len(), 0);
    }
}
