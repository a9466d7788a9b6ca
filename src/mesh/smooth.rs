//! Smooth normals: shared vertices, parted along creases.
//!
//! Source: G. Thürmer, C. Wüthrich, *Computing vertex normals from polygonal facets*, J. Graphics Tools 3 (1998), 43.

use std::collections::HashMap;
use std::hash::Hash;

use glam::DVec3;
use rayon::prelude::*;

use super::{Mesh, MeshError};
use crate::spacetime::unit;

/// Rounding of the cosine of a limit: two facets at exactly that angle are smooth.
const ROUNDING: f64 = 1e-12;

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
        let bits = |place: &DVec3| (*place + DVec3::ZERO).to_array().map(f64::to_bits);
        let places = numbered(self.positions().iter().map(bits));
        let facets: Vec<DVec3> = triangles
            .par_iter()
            .map(|&[a, b, c]| {
                let [a, b, c] = [a, b, c].map(|index| self.positions()[index as usize]);
                unit((b - a).cross(c - a)).unwrap_or(DVec3::ZERO)
            })
            .collect();
        let place = |corner: u32| places[corners[corner as usize] as usize];
        let mut fans = Fans::new(corners.len());
        let least = max_angle.cos() - ROUNDING;
        for [one, other] in inner_edges(triangles.len(), place) {
            let [n, m] = [one, other].map(|corner| facets[corner as usize / 3]);
            if n == DVec3::ZERO || m == DVec3::ZERO || n.dot(m) >= least {
                for corner in [one, next(one)] {
                    let same = [other, next(other)].into_iter();
                    let same = same.filter(|&same| place(same) == place(corner));
                    same.for_each(|same| fans.join(corner, same));
                }
            }
        }

        let roots: Vec<u32> = (0..corners.len() as u32).map(|c| fans.root(c)).collect();
        let mut sums = vec![DVec3::ZERO; corners.len()];
        for (corner, &root) in roots.iter().enumerate() {
            let normal = facets[corner / 3];
            sums[root as usize] += normal * self.angle(corner);
        }
        let bases = self.alike(places.clone());
        let keys = corners.iter().map(|&vertex| bases[vertex as usize]);
        let numbers = numbered(keys.zip(roots.iter().copied()));
        // The corner that each vertex is made of.
        let mut firsts: Vec<usize> = vec![];
        for (corner, &number) in numbers.iter().enumerate() {
            if number as usize == firsts.len() {
                firsts.push(corner);
            }
        }
        let vertex = |&corner: &usize| corners[corner] as usize;
        let normal = |&corner: &usize| {
            let smooth = unit(sums[roots[corner] as usize]);
            smooth
                .or_else(|| unit(facets[corner / 3]))
                .unwrap_or(DVec3::Y)
        };
        let colors = self
            .colors()
            .map(|colors| firsts.iter().map(|first| colors[vertex(first)]).collect());
        let sets = self.texture_coordinates().iter();
        let sets = sets.map(|set| firsts.iter().map(|first| set[vertex(first)]).collect());
        Ok(Self::from_parts(
            firsts
                .iter()
                .map(|first| self.positions()[vertex(first)])
                .collect::<Vec<_>>(),
            numbers.as_chunks().0.to_vec(),
            Some(firsts.iter().map(normal).collect::<Vec<_>>().into()),
            None,
            sets.collect(),
            colors,
        ))
    }

    /// The angle of a triangle at a corner.
    fn angle(&self, corner: usize) -> f64 {
        let [a, b, c] = self.corners_of(corner / 3);
        let (own, one, other) = match corner % 3 {
            0 => (a, b, c),
            1 => (b, c, a),
            _ => (c, a, b),
        };
        let [one, other] = [one - own, other - own].map(|edge| unit(edge).unwrap_or_default());
        one.cross(other).length().atan2(one.dot(other))
    }

    /// Numbers of the vertices by `places`, texture coordinates and colours.
    fn alike(&self, places: Vec<u32>) -> Vec<u32> {
        let mut numbers = places;
        for set in self.texture_coordinates() {
            let bits = set.iter().map(|uv| uv.to_array().map(f32::to_bits));
            numbers = numbered(numbers.iter().copied().zip(bits));
        }
        if let Some(colors) = self.colors() {
            let bits = colors
                .iter()
                .map(|color| color.to_array().map(f32::to_bits));
            numbers = numbered(numbers.iter().copied().zip(bits));
        }
        numbers
    }
}

/// The same number for equal values, from 0 in the order of their first ones.
fn numbered<T: Hash + Eq>(values: impl Iterator<Item = T>) -> Vec<u32> {
    let mut known = HashMap::new();
    let number = |value| {
        let next = known.len() as u32;
        *known.entry(value).or_insert(next)
    };
    values.map(number).collect()
}

/// The next corner of the same triangle.
fn next(corner: u32) -> u32 {
    match corner % 3 {
        2 => corner - 2,
        _ => corner + 1,
    }
}

/// Pairs of edges, each named by its first corner, that are all the edges between two places.
fn inner_edges(
    triangles: usize,
    place: impl Fn(u32) -> u32 + Sync,
) -> impl Iterator<Item = [u32; 2]> {
    let ends = |corner: u32| {
        let (from, to) = (place(corner), place(next(corner)));
        ([from.min(to), from.max(to)], corner)
    };
    let corners = (0..3 * triangles as u32).into_par_iter();
    let mut edges: Vec<([u32; 2], u32)> = corners.map(ends).collect();
    edges.par_sort_unstable();
    let mut at = 0;
    std::iter::from_fn(move || {
        loop {
            let start = at;
            let (ends, one) = *edges.get(start)?;
            while edges.get(at).is_some_and(|edge| edge.0 == ends) {
                at += 1;
            }
            if at - start == 2 && ends[0] != ends[1] {
                return Some([one, edges[start + 1].1]);
            }
        }
    })
}

/// Corners at one place that have one normal, each with a corner that stands for all.
struct Fans(Vec<u32>);

impl Fans {
    fn new(corners: usize) -> Self {
        Self((0..corners as u32).collect())
    }

    fn root(&mut self, mut corner: u32) -> u32 {
        while self.0[corner as usize] != corner {
            let above = self.0[self.0[corner as usize] as usize];
            self.0[corner as usize] = above;
            corner = above;
        }
        corner
    }

    /// The lower root stays, so that the order of joins does not matter.
    fn join(&mut self, one: u32, other: u32) {
        let (one, other) = (self.root(one), self.root(other));
        self.0[one.max(other) as usize] = one.min(other);
    }
}

#[cfg(test)]
mod tests {
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
        let places = numbered(
            sphere
                .positions()
                .iter()
                .map(|p| (*p + DVec3::ZERO).to_array().map(f64::to_bits)),
        );
        let count = places.iter().max().unwrap() + 1;
        // Without texture coordinates, whose seams part vertices.
        let bare = Mesh::new(sphere.positions().to_vec(), sphere.triangles().to_vec()).unwrap();
        let again = soup(&bare).with_smooth_normals(LIMIT).unwrap();
        assert_eq!(again.positions().len(), count as usize);
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
