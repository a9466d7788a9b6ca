//! Whether a place is inside a surface: the winding number of its triangles.
//!
//! The winding number is the sum of the solid angles of all triangles, by orientation, over that of the whole sphere: 1
//! inside a closed surface, 0 outside, and in between near holes (Jacobson, Kavan & Sorkine-Hornung 2013). The solid angle of
//! a triangle is that of van Oosterom & Strackee (1983).

use std::f64::consts::TAU;

use glam::DVec3;
use rayon::prelude::*;

use super::Mesh;

impl Mesh {
    /// How often the surface goes around a place, in the coordinates of the mesh; the sign says on which side its triangles
    /// are seen. Not a number where the place is not finite.
    pub fn winding_number(&self, place: DVec3) -> f64 {
        let (places, triangles) = self.facets();
        let angles = triangles.par_iter().map(|corners| {
            let [a, b, c] = corners.map(|index| {
                let offset = places.at(index) - place;
                // A corner at the place itself takes no part of the sphere.
                offset.try_normalize().unwrap_or(DVec3::ZERO)
            });
            let volume = a.dot(b.cross(c));
            let rest = 1.0 + a.dot(b) + b.dot(c) + c.dot(a);
            // Half the solid angle.
            volume.atan2(rest)
        });
        angles.sum::<f64>() / TAU
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eight triangles around the origin, seen from outside.
    fn octahedron() -> Mesh {
        let positions = DVec3::AXES
            .iter()
            .flat_map(|&axis| [2.0 * axis, -2.0 * axis]);
        let mut triangles = vec![];
        for (x, y, z) in [
            (0, 2, 4),
            (0, 3, 4),
            (1, 2, 4),
            (1, 3, 4),
            (0, 2, 5),
            (0, 3, 5),
            (1, 2, 5),
            (1, 3, 5),
        ] {
            let inwards = (x + y + z) % 2 == 1;
            triangles.push(if inwards { [x, z, y] } else { [x, y, z] });
        }
        Mesh::new(positions.collect(), triangles).unwrap()
    }

    #[test]
    fn a_closed_surface_goes_once_around_what_is_inside() {
        for (place, expected) in [
            (DVec3::ZERO, 1.0),
            (DVec3::new(0.5, -0.6, 0.7), 1.0),
            (DVec3::new(0.0, 2.1, 0.0), 0.0),
            (DVec3::splat(1.0), 0.0),
            (DVec3::X * 1e9, 0.0),
        ] {
            let found = octahedron().winding_number(place);
            assert!((found - expected).abs() < 1e-9, "{place}: {found}");
        }
    }

    #[test]
    fn a_sheet_goes_around_by_halves() {
        let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let positions = vec![corner(-1e6, -1e6), corner(1e6, -1e6), corner(0.0, 1e6)];
        let sheet = Mesh::new(positions, vec![[0, 1, 2]]).unwrap();
        let above = sheet.winding_number(DVec3::Z);
        let below = sheet.winding_number(-DVec3::Z);
        assert!(
            (above + 0.5).abs() < 1e-5 && (below - 0.5).abs() < 1e-5,
            "{above} {below}"
        );
    }
}
