//! The edges that a drawing of a mesh shows.

use std::collections::HashMap;

use glam::DVec3;

use super::Mesh;
use crate::spacetime::unit;

/// What a drawing of a mesh from one place shows.
pub(crate) struct Outline {
    /// Edges at which the surface ends, or turns away from the place.
    pub(crate) lines: Vec<[DVec3; 2]>,
    /// All other edges at which the surface turns sharply, and which lead on at both ends to others of these two kinds.
    pub(crate) creases: Vec<[DVec3; 2]>,
    /// Number of all edges.
    pub(crate) edges: usize,
}

/// A triangle beside an edge.
#[derive(Clone, Copy)]
struct Side {
    normal: DVec3,
    /// Whether it has the edge in the direction of its key.
    is_forward: bool,
    /// Whether the place is on the side to which the normal points.
    is_towards: bool,
}

impl Mesh {
    /// The lines of a drawing as it is seen from `eye`. A crease is an edge at which the surface turns by more than `angle`
    /// radians from one triangle to the next.
    ///
    /// Vertices at one place count as one: a seam of normals or of texture coordinates is no edge by itself. An `angle` of NaN
    /// leaves no creases.
    pub(crate) fn outline(&self, eye: DVec3, angle: f64) -> Outline {
        let mut sides: HashMap<[[u64; 3]; 2], Vec<Side>> = HashMap::new();
        let places = |corners: &[u32; 3]| corners.map(|corner| self.positions()[corner as usize]);
        let edges = |[a, b, c]: [DVec3; 3]| [[a, b], [b, c], [c, a]];
        for [a, b, c] in self.triangles().iter().map(places) {
            let Some(normal) = unit((b - a).cross(c - a)) else {
                continue;
            };
            for edge in edges([a, b, c]) {
                let (key, is_forward) = key(edge);
                let is_towards = normal.dot(eye - a) > 0.0;
                let side = Side {
                    normal,
                    is_forward,
                    is_towards,
                };
                sides.entry(key).or_default().push(side);
            }
        }
        let least = angle.cos();
        let mut outline = Outline {
            lines: vec![],
            creases: vec![],
            edges: sides.len(),
        };
        // In the order of the triangles, so that a drawing is the same on every run.
        for edge in self.triangles().iter().flat_map(|t| edges(places(t))) {
            let Some(sides) = sides.remove(&key(edge).0) else {
                continue;
            };
            let &[one, other] = sides.as_slice() else {
                outline.lines.push(edge);
                continue;
            };
            // Two triangles that are wound alike have their edge in opposite directions.
            let is_alike = one.is_forward != other.is_forward;
            let turn = one.normal.dot(other.normal) * if is_alike { 1.0 } else { -1.0 };
            if (one.is_towards == other.is_towards) != is_alike {
                outline.lines.push(edge);
            } else if turn < least {
                outline.creases.push(edge);
            }
        }
        outline.drop_stubs();
        outline
    }
}

impl Outline {
    /// Leaves out creases that are no part of a longer line: a scan has them anywhere.
    fn drop_stubs(&mut self) {
        let mut ends: HashMap<[u64; 3], u32> = HashMap::new();
        for place in self.lines.iter().chain(&self.creases).flatten() {
            *ends.entry(bits(*place)).or_default() += 1;
        }
        let leads_on = |place: &DVec3| ends.get(&bits(*place)).is_some_and(|&edges| edges > 1);
        self.creases.retain(|edge| edge.iter().all(leads_on));
    }
}

/// A key of a place.
fn bits(place: DVec3) -> [u64; 3] {
    // Adding zero makes one of both zeros.
    (place + DVec3::ZERO).to_array().map(f64::to_bits)
}

/// The same for both directions of an edge, and whether this one is from the lower end to the higher.
fn key(edge: [DVec3; 2]) -> ([[u64; 3]; 2], bool) {
    let [a, b] = edge.map(bits);
    match a <= b {
        true => ([a, b], true),
        false => ([b, a], false),
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use crate::shape::{Appearance, Shape};

    fn lengths(shape: Shape, eye: DVec3) -> [f64; 2] {
        let model = shape.model(&Appearance::default()).unwrap();
        let outline = model.parts[0].mesh().outline(eye, 0.5);
        let length = |edges: &[[DVec3; 2]]| edges.iter().map(|[a, b]| a.distance(*b)).sum::<f64>();
        [length(&outline.lines), length(&outline.creases)]
    }

    #[test]
    fn outlines_are_those_of_the_shape_and_not_of_its_triangles() {
        // In front of a face the outline is that face; from a corner six edges.
        let cuboid = || Shape::cuboid([1.0, 2.0, 3.0]).unwrap();
        for (eye, outline) in [(DVec3::Z * 9.0, 6.0), (DVec3::splat(9.0), 12.0)] {
            let [lines, creases] = lengths(cuboid(), eye);
            assert!((lines - outline).abs() < 1e-9, "{lines}");
            assert!((lines + creases - 24.0).abs() < 1e-9, "{creases}");
        }
        // From a distance of 2 the outline of a unit sphere has a radius of sqrt(3)/2; its triangles make it no more than
        // a zigzag around that.
        let [lines, creases] = lengths(Shape::sphere(1.0).unwrap(), DVec3::new(0.3, 0.2, 1.966));
        let circle = 3.0_f64.sqrt() * std::f64::consts::PI;
        assert!((0.98..1.5).contains(&(lines / circle)), "{lines}");
        assert_eq!(creases, 0.0);
        // Along its axis a cylinder's rims: two polygons of 96 corners, of which the nearer is its outline.
        let rim = 2.0 * 96.0 * (std::f64::consts::PI / 96.0).sin();
        let [lines, creases] = lengths(Shape::cylinder(1.0, 2.0).unwrap(), DVec3::Y * 9.0);
        assert!(
            (lines - rim).abs() < 1e-9 && (creases - rim).abs() < 1e-9,
            "{lines} {creases}"
        );
        // A square sheet ends at its four sides.
        let sheet = lengths(Shape::grid(3.0, 4).unwrap(), DVec3::ONE);
        assert!(
            (sheet[0] - 12.0).abs() < 1e-9 && sheet[1] == 0.0,
            "{sheet:?}"
        );
    }
}
