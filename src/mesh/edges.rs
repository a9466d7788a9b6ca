//! The edges that a drawing of a mesh shows.

use std::collections::HashMap;

use glam::DVec3;

use super::Mesh;
use crate::spacetime::unit;

impl Mesh {
    /// Edges at which the surface ends, or turns by more than `angle` radians from one triangle to the next.
    ///
    /// Vertices at one place count as one: a seam of normals or of texture coordinates is no edge by itself. An `angle` of NaN
    /// leaves the edges at which the surface ends.
    pub fn sharp_edges(&self, angle: f64) -> Vec<[DVec3; 2]> {
        let mut normals: HashMap<[[u64; 3]; 2], Vec<DVec3>> = HashMap::new();
        let places = |corners: &[u32; 3]| corners.map(|corner| self.positions()[corner as usize]);
        let edges = |[a, b, c]: [DVec3; 3]| [[a, b], [b, c], [c, a]];
        for [a, b, c] in self.triangles().iter().map(places) {
            let Some(normal) = unit((b - a).cross(c - a)) else {
                continue;
            };
            for edge in edges([a, b, c]) {
                normals.entry(key(edge)).or_default().push(normal);
            }
        }
        let least = angle.cos();
        let mut sharp = Vec::new();
        // In the order of the triangles, so that a drawing is the same on every run.
        for edge in self.triangles().iter().flat_map(|t| edges(places(t))) {
            let Some(sides) = normals.remove(&key(edge)) else {
                continue;
            };
            if sides.len() != 2 || sides[0].dot(sides[1]) < least {
                sharp.push(edge);
            }
        }
        sharp
    }
}

/// The same for both directions of an edge.
fn key(edge: [DVec3; 2]) -> [[u64; 3]; 2] {
    // Adding zero makes one of both zeros.
    let mut ends = edge.map(|end| (end + DVec3::ZERO).to_array().map(f64::to_bits));
    ends.sort_unstable();
    ends
}

#[cfg(test)]
mod tests {
    use crate::shape::{Appearance, Shape};

    #[test]
    fn sharp_edges_are_those_of_the_shape_and_not_of_its_triangles() {
        let length = |shape: Shape, angle: f64| {
            let model = shape.model(&Appearance::default()).unwrap();
            let edges = model.parts[0].mesh().sharp_edges(angle);
            edges.iter().map(|[a, b]| a.distance(*b)).sum::<f64>()
        };
        let cuboid = length(Shape::cuboid([1.0, 2.0, 3.0]).unwrap(), 0.5);
        assert!((cuboid - 24.0).abs() < 1e-9, "{cuboid}");
        assert_eq!(length(Shape::sphere(1.0).unwrap(), 0.5), 0.0);
        // Two rims, each a polygon of 96 corners.
        let rims = 2.0 * 96.0 * 2.0 * (std::f64::consts::PI / 96.0).sin();
        let cylinder = length(Shape::cylinder(1.0, 2.0).unwrap(), 0.5);
        assert!((cylinder - rims).abs() < 1e-9, "{cylinder}");
        // A square sheet ends at its four sides.
        let sheet = length(Shape::grid(3.0, 4).unwrap(), 0.5);
        assert!((sheet - 12.0).abs() < 1e-9, "{sheet}");
    }
}
