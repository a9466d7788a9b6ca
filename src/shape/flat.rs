//! The flat shapes: the box, and the ground as a grid.

use glam::{DVec2, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::surface::{Side, Surface};
use super::{Count, Length, ShapeError};

/// A box about the origin with its edges along the axes.
#[derive(Clone, Debug, PartialEq, JsonSchema, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Cuboid {
    /// Lengths along x, y and z, in the object's units before `scale`.
    pub size: [Length; 3],
    /// Number of segments along each edge. If absent, refinement starts from one; without refinement there are 32.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resolution: Option<Count<1, 32>>,
}

impl Cuboid {
    /// Columns and rows of the checker on each face.
    pub(super) const CHECKER_CELLS: [u32; 2] = [8, 8];

    pub(super) fn surface(&self) -> Result<Surface, ShapeError> {
        let mut surface = Surface::with_room_for(self.triangle_count())?;
        for square in self.squares() {
            square.add_to(&mut surface, 1.0);
        }
        Ok(surface)
    }

    /// Tells the places of the vertices.
    pub(super) fn places(&self, mut tell: impl FnMut(DVec3)) {
        self.squares().for_each(|square| square.places(&mut tell));
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.squares().map(|square| square.vertex_count()).sum()
    }

    pub(super) fn triangle_count(&self) -> u64 {
        self.squares().map(|square| square.triangle_count()).sum()
    }

    fn squares(&self) -> impl Iterator<Item = Square> {
        let segments = self.resolution.unwrap_or_default().get();
        let size = DVec3::from_array(self.size.map(Length::get));
        Side::ALL.into_iter().map(move |side| Square {
            side,
            segments,
            size,
            centre: 0.5 * side.outward(),
        })
    }
}

/// A square in the xz plane about the origin that faces +y.
#[derive(Clone, Debug, PartialEq, JsonSchema, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Grid {
    /// Length of its edges, in the object's units before `scale`.
    pub size: Length,
    /// Number of checker cells along each edge.
    pub cells: Count<1, 1>,
    /// Number of segments along the edge of a cell. If absent, refinement starts from one; without refinement there are 8.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resolution: Option<Count<1, 8>>,
}

impl Grid {
    /// Columns and rows of the checker, which repeats.
    pub(super) const CHECKER_CELLS: [u32; 2] = [2, 2];

    pub(super) fn surface(&self) -> Result<Surface, ShapeError> {
        let mut surface = Surface::with_room_for(self.triangle_count())?;
        let repeats = f64::from(self.cells.get()) / 2.0;
        self.square().add_to(&mut surface, repeats);
        Ok(surface)
    }

    /// Tells the places of the vertices.
    pub(super) fn places(&self, tell: impl FnMut(DVec3)) {
        self.square().places(tell);
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.square().vertex_count()
    }

    pub(super) fn triangle_count(&self) -> u64 {
        self.square().triangle_count()
    }

    fn square(&self) -> Square {
        Square {
            side: Side::TOP,
            segments: self.cells.get() * self.resolution.unwrap_or_default().get(),
            size: DVec3::splat(self.size.get()),
            centre: DVec3::ZERO,
        }
    }
}

/// A unit square about `centre` on a side of the unit cube, stretched by `size`, in `segments` squared pieces.
struct Square {
    side: Side,
    segments: u32,
    size: DVec3,
    centre: DVec3,
}

impl Square {
    /// The vertex in column `i` and row `j`.
    fn place(&self, i: u32, j: u32) -> DVec3 {
        let segments = i64::from(self.segments);
        // From -1/2 to 1/2; mirror images are exact, so that two sides agree on their common edge.
        let place = |i: u32| (2 * i64::from(i) - segments) as f64 / (2 * segments) as f64;
        (self.centre + self.side.right * place(i) + self.side.up * place(j)) * self.size
    }

    fn vertex_count(&self) -> usize {
        let row = self.segments as usize + 1;
        row * row
    }

    fn triangle_count(&self) -> u64 {
        2 * u64::from(self.segments) * u64::from(self.segments)
    }

    fn places(&self, mut tell: impl FnMut(DVec3)) {
        for j in 0..=self.segments {
            for i in 0..=self.segments {
                // As in a `Surface`.
                tell(self.place(i, j) + DVec3::ZERO);
            }
        }
    }

    /// Adds it to a surface; a picture repeats `repeats` times each way on it.
    fn add_to(&self, surface: &mut Surface, repeats: f64) {
        let (side, segments) = (self.side, self.segments);
        let row = segments + 1;
        let mut first = 0;
        for j in 0..=segments {
            for i in 0..=segments {
                let texture =
                    DVec2::new(f64::from(i), f64::from(segments - j)) / f64::from(segments);
                let index = surface.vertex(self.place(i, j), side.outward(), repeats * texture);
                if i == 0 && j == 0 {
                    first = index;
                }
            }
        }
        for j in 0..segments {
            for i in 0..segments {
                let corner = first + j * row + i;
                surface.triangle([corner, corner + 1, corner + row + 1]);
                surface.triangle([corner, corner + row + 1, corner + row]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Shape, witness};
    use super::*;

    #[test]
    fn a_box_is_closed_and_exact() {
        for resolution in [1, 2, 7, 32] {
            let shape = Shape::cuboid([1.0, 2.5, 0.3]).unwrap();
            let mesh = witness::mesh(&shape.with_resolution(resolution).unwrap());
            let squares = 6 * resolution as usize * resolution as usize;
            assert_eq!(mesh.triangles().len(), 2 * squares);
            assert_eq!(mesh.positions().len(), 6 * (resolution as usize + 1).pow(2));
            assert_eq!(witness::assert_closed(&mesh), 2);
            witness::assert_well_made(&mesh);
            witness::assert_texture_within(&mesh, 1.0);
            witness::assert_normals_within(&mesh, 1e-12);
            witness::assert_volume(&mesh, 0.75);
            let area = 2.0 * (2.5 + 0.3 + 0.75);
            witness::assert_area(&mesh, area);
            for (position, normal) in mesh.positions().iter().zip(mesh.normals().unwrap()) {
                let half = DVec3::new(0.5, 1.25, 0.15);
                assert_eq!(
                    (position * normal).element_sum(),
                    (half * normal.abs()).element_sum()
                );
                assert!(position.abs().cmple(half).all());
            }
        }
    }

    #[test]
    fn pictures_on_the_upright_sides_stand_upright() {
        let mesh = witness::mesh(&Shape::cuboid([1.0; 3]).unwrap());
        let vertices = mesh
            .positions()
            .iter()
            .zip(mesh.texture_coordinates()[0].iter());
        for ((position, uv), normal) in vertices.zip(mesh.normals().unwrap()) {
            if normal.y == 0.0 {
                assert!((position.y - (0.5 - f64::from(uv.y))).abs() < 1e-7);
            }
        }
    }

    #[test]
    fn a_grid_is_a_square_that_faces_up() {
        for (cells, resolution) in [(1, 1), (3, 1), (4, 5), (10, 8)] {
            let shape = Shape::grid(6.0, cells).unwrap();
            let mesh = witness::mesh(&shape.with_resolution(resolution).unwrap());
            let segments = (cells * resolution) as usize;
            assert_eq!(mesh.triangles().len(), 2 * segments * segments);
            witness::assert_well_made(&mesh);
            witness::assert_texture_within(&mesh, 0.5);
            assert!(mesh.normals().unwrap().iter().all(|&n| n == DVec3::Y));
            witness::assert_area(&mesh, 36.0);
            let boundary = witness::boundary(&mesh);
            assert_eq!(boundary.len(), 4 * segments);
            for [a, b] in boundary {
                let on_one_side =
                    (a.x == b.x && a.x.abs() == 3.0) || (a.z == b.z && a.z.abs() == 3.0);
                assert!(on_one_side, "{a} {b}");
            }
            let uv = &mesh.texture_coordinates()[0];
            let last = uv.iter().copied().reduce(|a, b| a.max(b)).unwrap();
            assert_eq!(last.to_array(), [cells as f32 / 2.0; 2]);
        }
    }

    #[test]
    fn a_grid_of_too_many_cells_is_refused() {
        let shape = Shape::grid(1.0, 4096).unwrap();
        let error = shape.model(&super::super::Appearance::default());
        assert_eq!(
            error.unwrap_err(),
            ShapeError::TooManyTriangles {
                triangles: 2 * (4096 * 8) * (4096 * 8),
                limit: 20_000_000
            }
        );
    }
}
