//! A surface while it is built: vertices with all their attributes, triangles, and what all shapes need
//! to build them.

use std::cmp::Ordering;
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

use glam::{DVec2, DVec3, Vec2};

use super::ShapeError;
use crate::mesh::{Mesh, MeshError};

/// The most triangles that a shape is made of, so that a slip of the keyboard does not use up the memory.
pub(super) const MAX_TRIANGLES: u64 = 20_000_000;

/// Vertices and triangles of a shape, as they come.
#[derive(Default)]
pub(super) struct Surface {
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
    texture_coordinates: Vec<Vec2>,
    triangles: Vec<[u32; 3]>,
}

impl Surface {
    /// Nothing yet, with room for so many triangles.
    ///
    /// # Errors
    ///
    /// More than [`MAX_TRIANGLES`], so that it is refused before any work.
    pub(super) fn with_room_for(triangles: u64) -> Result<Self, ShapeError> {
        check_triangles(triangles)?;
        Ok(Self {
            triangles: Vec::with_capacity(triangles as usize),
            ..Self::default()
        })
    }

    /// Adds a vertex and returns its index.
    pub(super) fn vertex(&mut self, position: DVec3, normal: DVec3, texture: DVec2) -> u32 {
        // Adding zero turns -0 into +0: points computed alike are then equal bit for bit.
        self.positions.push(position + DVec3::ZERO);
        self.normals.push(normal + DVec3::ZERO);
        self.texture_coordinates.push(texture.as_vec2());
        (self.positions.len() - 1) as u32
    }

    /// Adds a triangle, its corners counter-clockwise seen from outside.
    pub(super) fn triangle(&mut self, corners: [u32; 3]) {
        self.triangles.push(corners);
    }

    /// The finished mesh.
    pub(super) fn into_mesh(self) -> Result<Mesh, MeshError> {
        Mesh::new(self.positions, self.triangles)?
            .with_normals(self.normals)?
            .with_texture_coordinates(self.texture_coordinates)
    }
}

/// Refuses more than [`MAX_TRIANGLES`].
pub(super) fn check_triangles(triangles: u64) -> Result<(), ShapeError> {
    if triangles > MAX_TRIANGLES {
        return Err(ShapeError::TooManyTriangles {
            triangles,
            limit: MAX_TRIANGLES,
        });
    }
    Ok(())
}

/// A side of an axis-aligned box: where the right and the upper edge of a picture on it point.
#[derive(Clone, Copy)]
pub(super) struct Side {
    pub(super) right: DVec3,
    pub(super) up: DVec3,
}

impl Side {
    /// The sides of a box; pictures on the upright ones stand upright, those on top and bottom
    /// are upright after the box is tilted by a quarter turn towards +z.
    pub(super) const ALL: [Self; 6] = [
        Self::new(DVec3::X, DVec3::Y),
        Self::new(DVec3::NEG_Z, DVec3::Y),
        Self::new(DVec3::NEG_X, DVec3::Y),
        Self::new(DVec3::Z, DVec3::Y),
        Self::TOP,
        Self::new(DVec3::X, DVec3::Z),
    ];

    /// The side that faces up.
    pub(super) const TOP: Self = Self::new(DVec3::X, DVec3::NEG_Z);

    const fn new(right: DVec3, up: DVec3) -> Self {
        Self { right, up }
    }

    /// The normal.
    pub(super) fn outward(self) -> DVec3 {
        self.right.cross(self.up)
    }
}

/// Sine and cosine of `part / parts` of a full turn, `parts` not zero.
///
/// Exact at quarter turns, and mirror images have bit for bit the same values up to their sign.
pub(super) fn sin_cos_of_turn(part: u64, parts: u64) -> (f64, f64) {
    let quarters = 4 * (part % parts);
    let rest = quarters % parts;
    let of_quarter = |part: u64| (part as f64 / parts as f64 * FRAC_PI_2).sin_cos();
    let (sin, cos) = match (2 * rest).cmp(&parts) {
        Ordering::Less => of_quarter(rest),
        Ordering::Equal => (FRAC_1_SQRT_2, FRAC_1_SQRT_2),
        Ordering::Greater => {
            let (sin, cos) = of_quarter(parts - rest);
            (cos, sin)
        }
    };
    match quarters / parts {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// The direction from the axis after `part / parts` of a turn about +y, starting behind, at -z.
///
/// Seen from outside, with y up, it moves to the right; half a turn faces +z.
pub(super) fn direction_of_turn(part: u64, parts: u64) -> DVec3 {
    let (sin, cos) = sin_cos_of_turn(part, parts);
    DVec3::new(-sin, 0.0, -cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_a_turn_are_exact_where_they_can_be() {
        for parts in [3, 4, 5, 8, 12, 96, 97] {
            for part in 0..2 * parts {
                let (sin, cos) = sin_cos_of_turn(part, parts);
                let angle = part as f64 / parts as f64 * 4.0 * FRAC_PI_2;
                assert!((sin - angle.sin()).abs() < 2e-15, "{part} / {parts}");
                assert!((cos - angle.cos()).abs() < 2e-15, "{part} / {parts}");
                let mirrored = sin_cos_of_turn(2 * parts - part, parts);
                assert_eq!((sin, cos), (-mirrored.0, mirrored.1), "{part} / {parts}");
            }
        }
        assert_eq!(sin_cos_of_turn(1, 4), (1.0, 0.0));
        assert_eq!(sin_cos_of_turn(4, 8), (0.0, -1.0));
        assert_eq!(sin_cos_of_turn(9, 12), (-1.0, 0.0));
    }

    #[test]
    fn the_turn_starts_behind_and_goes_to_the_right() {
        let at = |part| direction_of_turn(part, 4);
        assert_eq!(
            [at(0), at(1), at(2), at(3)],
            [DVec3::NEG_Z, DVec3::NEG_X, DVec3::Z, DVec3::X]
        );
    }

    #[test]
    fn refuses_too_many_triangles() {
        assert!(Surface::with_room_for(0).is_ok());
        let error = Surface::with_room_for(20_000_001).err().unwrap();
        assert_eq!(
            error.to_string(),
            "20000001 triangles, expected at most 20000000: lower the resolution"
        );
    }
}
