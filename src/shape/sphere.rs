//! The sphere, as an icosahedron whose faces are split and pushed out.

use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::surface::{Surface, direction_of_turn};
use super::{Count, Length, ShapeError};

/// A sphere about the origin, made of about equally large triangles.
#[derive(Clone, Debug, PartialEq, JsonSchema, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Sphere {
    /// Distance of the surface from the centre, in the object's units before `scale`.
    pub radius: Length,
    /// Number of segments around a full turn, on average: each face of an icosahedron is split so
    /// that its edge, 63.43 degrees, has its share of them. If absent it follows from the tolerance;
    /// 96 where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resolution: Option<Count<3, 96>>,
}

/// The angle between neighbouring vertices of an icosahedron, `atan(2)`.
const ICOSAHEDRON_EDGE_DEG: f64 = 63.434_948_822_922_01;

impl Sphere {
    /// Columns and rows of the checker: 15 degrees of longitude and latitude.
    pub(super) const CHECKER_CELLS: [u32; 2] = [24, 12];

    pub(super) fn surface(&self) -> Result<Surface, ShapeError> {
        let splits = u64::from(self.splits());
        let mut sphere = Builder {
            surface: Surface::with_room_for(self.triangle_count())?,
            radius: self.radius.get(),
            known: HashMap::new(),
        };
        for face in icosahedron() {
            sphere.face(face, splits);
        }
        Ok(sphere.surface)
    }

    /// The texture coordinates of the sphere's point in `direction`, of any length.
    pub(crate) fn texture_at(&self, direction: DVec3) -> DVec2 {
        texture_toward(direction)
    }

    pub(super) fn triangle_count(&self) -> u64 {
        20 * u64::from(self.splits()).pow(2)
    }

    /// Into how many parts each edge of the icosahedron is split.
    pub(super) fn splits(&self) -> u32 {
        (f64::from(self.resolution.unwrap_or_default().get()) * ICOSAHEDRON_EDGE_DEG / 360.0).ceil()
            as u32
    }
}

/// The corners of the 20 faces, two of them at the poles, counter-clockwise seen from outside.
fn icosahedron() -> [[DVec3; 3]; 20] {
    let [height, radius] = [1.0 / 5f64.sqrt(), 2.0 / 5f64.sqrt()];
    let upper = |k| radius * direction_of_turn(2 * k, 10) + height * DVec3::Y;
    let lower = |k| radius * direction_of_turn(2 * k + 1, 10) - height * DVec3::Y;
    std::array::from_fn(|face| {
        let k = face as u64 / 4;
        match face % 4 {
            0 => [DVec3::Y, upper(k), upper(k + 1)],
            1 => [upper(k), lower(k), upper(k + 1)],
            2 => [upper(k + 1), lower(k), lower(k + 1)],
            _ => [lower(k), DVec3::NEG_Y, lower(k + 1)],
        }
    })
}

/// The sphere while it is built.
struct Builder {
    surface: Surface,
    radius: f64,
    /// Vertices by the bits of their position and longitude.
    known: HashMap<([u64; 3], u64), u32>,
}

impl Builder {
    /// Adds one face of the icosahedron, split into `splits` squared triangles.
    fn face(&mut self, [a, b, c]: [DVec3; 3], splits: u64) {
        // Along an edge one term is zero, so both faces at the edge get the same sum bit for bit.
        let point = |i: u64, j: u64| {
            let sum = a * (splits - i - j) as f64 + b * i as f64 + c * j as f64;
            sum / sum.length() + DVec3::ZERO
        };
        for i in 0..splits {
            for j in 0..splits - i {
                self.triangle([point(i, j), point(i + 1, j), point(i, j + 1)]);
                if i + j + 1 < splits {
                    self.triangle([point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]);
                }
            }
        }
    }

    fn triangle(&mut self, normals: [DVec3; 3]) {
        let turns = unwrapped_turns(normals);
        let corners = std::array::from_fn(|k| self.vertex(normals[k], turns[k]));
        self.surface.triangle(corners);
    }

    fn vertex(&mut self, normal: DVec3, turn: f64) -> u32 {
        let key = (normal.to_array().map(f64::to_bits), turn.to_bits());
        *self.known.entry(key).or_insert_with(|| {
            let texture = DVec2::new(turn, from_north(normal));
            self.surface.vertex(self.radius * normal, normal, texture)
        })
    }
}

/// Longitudes of a triangle's corners in turns, as of one continuous chart: one that reaches across
/// the seam leaves the range from 0 to 1, a corner at a pole is halfway between the other two.
fn unwrapped_turns(normals: [DVec3; 3]) -> [f64; 3] {
    let middle = turn(normals.iter().sum());
    let mut turns = normals.map(|normal| {
        let turn = turn(normal);
        turn + (middle - turn).round()
    });
    if let Some(pole) = normals.iter().position(|n| n.x == 0.0 && n.z == 0.0) {
        turns[pole] = (turns[(pole + 1) % 3] + turns[(pole + 2) % 3]) / 2.0;
    }
    turns
}

/// Longitude in turns, and the part of half a turn from the north pole, of a direction of any length.
pub(super) fn texture_toward(direction: DVec3) -> DVec2 {
    DVec2::new(turn(direction), from_north(direction))
}

/// The part of half a turn that a direction is away from north.
fn from_north(direction: DVec3) -> f64 {
    direction.x.hypot(direction.z).atan2(direction.y) / PI
}

/// The part of a turn that [`direction_of_turn`] needs for this direction.
pub(super) fn turn(direction: DVec3) -> f64 {
    let turn = (-direction.x).atan2(-direction.z) / TAU;
    if turn < 0.0 { turn + 1.0 } else { turn }
}

#[cfg(test)]
mod tests {
    use super::super::surface::MAX_TRIANGLES;
    use super::super::{Shape, witness};
    use super::*;

    const RESOLUTIONS: [u32; 6] = [3, 6, 12, 13, 40, 96];

    /// Half the angle that the largest triangle takes up, seen from the centre: the circumradius of
    /// the split flat face over its distance from the centre, which is where pushing out enlarges most.
    fn half_angle(splits: f64) -> f64 {
        let edge = 2.0 * (ICOSAHEDRON_EDGE_DEG.to_radians() / 2.0).sin();
        let distance = (1.0 - edge * edge / 3.0).sqrt();
        (edge / 3f64.sqrt() / splits / distance).atan()
    }

    #[test]
    fn is_closed_smooth_and_round() {
        for resolution in RESOLUTIONS {
            let radius = 2.5;
            let shape = Shape::sphere(radius).unwrap();
            let mesh = witness::mesh(&shape.with_resolution(resolution).unwrap());
            let splits = (f64::from(resolution) * ICOSAHEDRON_EDGE_DEG / 360.0).ceil();
            assert_eq!(mesh.triangles().len() as f64, 20.0 * splits * splits);
            assert_eq!(witness::assert_closed(&mesh), 2);
            witness::assert_well_made(&mesh);
            witness::assert_texture_within(&mesh, 0.5);
            for (&position, &normal) in mesh.positions().iter().zip(mesh.normals().unwrap()) {
                assert!((position.length() / radius - 1.0).abs() < 1e-15);
                assert!((position - radius * normal).length() < 1e-15 * radius);
            }
            // Each triangle is within a cap of this half angle, so no nearer than its plane.
            let angle = half_angle(splits);
            witness::assert_normals_within(&mesh, angle * 1.000_001);
            let full = 4.0 / 3.0 * PI * radius.powi(3);
            let volume = witness::volume(&mesh);
            assert!(volume < full && volume > full * angle.cos().powi(3));
            // Volume is a third of area times distance, and the distance is between those limits.
            let area = witness::area(&mesh) * radius / 3.0;
            assert!(area > volume && area < volume / angle.cos() * 1.000_001);
        }
    }

    #[test]
    fn texture_is_longitude_and_latitude() {
        let mesh = witness::mesh(&Shape::sphere(1.0).unwrap());
        for (position, uv) in mesh
            .positions()
            .iter()
            .zip(mesh.texture_coordinates()[0].iter())
        {
            let [u, v] = uv.as_dvec2().to_array();
            assert!(
                (position.y - (PI * v).cos()).abs() < 4e-7,
                "{position} {uv}"
            );
            let expected = -(PI * v).sin() * DVec2::from_angle(TAU * u);
            let found = DVec2::new(position.z, position.x);
            assert!(found.distance(expected) < 2e-6, "{position} {uv}");
        }
    }

    #[test]
    fn poles_are_vertices() {
        let mesh = witness::mesh(&Shape::sphere(3.0).unwrap());
        for pole in [DVec3::Y * 3.0, DVec3::NEG_Y * 3.0] {
            assert_eq!(mesh.positions().iter().filter(|&&p| p == pole).count(), 5);
        }
    }

    #[test]
    fn the_finest_is_within_the_limit() {
        let finest = Shape::sphere(1.0).unwrap().with_resolution(4096).unwrap();
        let Shape::Sphere(sphere) = finest else {
            unreachable!()
        };
        assert!(sphere.triangle_count() <= MAX_TRIANGLES);
    }
}
