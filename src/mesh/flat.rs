//! Flat normals: three vertices of its own for each triangle, at hand or computed where they are wanted.

use glam::DVec3;

use super::triangles::Triangles;
use super::values::{flat_normal, pick};
use super::vertices::{MANY_VERTICES, Vertices};
use super::{Mesh, MeshError};

impl Mesh {
    /// The mesh with the normals of its flat triangles, each with three vertices of its own: what
    /// glTF asks for where a source has no normals. Vertices in no triangle vanish.
    ///
    /// # Errors
    ///
    /// More corners than a `u32` index can tell apart.
    pub fn with_flat_normals(self) -> Result<Self, MeshError> {
        let count = self.triangle_count();
        if 3 * count > u32::MAX as usize {
            return Err(MeshError::TooManyVertices(3 * count));
        }
        let list = || self.triangles().as_flattened();
        let positions = self.shared_positions();
        let vertices = match 3 * count > MANY_VERTICES {
            true => Vertices::of_facets(positions, self.shared_triangles().clone()),
            false => {
                let places = positions.places();
                let normals = self.triangles().iter().flat_map(|corners| {
                    let corners = corners.map(|corner| places.at(corner));
                    [flat_normal(corners); 3]
                });
                let normals: Vec<DVec3> = normals.collect();
                Vertices::held(positions.picked(list()), Some(normals.into()))
            }
        };
        let texture_coordinates = self.texture_coordinates().iter();
        Ok(Self::from_shared(
            vertices,
            Triangles::in_order(count),
            self.tangents().map(|tangents| pick(tangents, list())),
            texture_coordinates.map(|set| pick(set, list())).collect(),
            self.colors().map(|colors| pick(colors, list())),
        ))
    }
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::*;

    /// Facets of a large mesh are computed, those of a small one are at hand; nobody can tell which.
    #[test]
    fn flat_facets_are_the_same_wherever_they_come_from() {
        let rows = 300;
        let place = |k: u32| {
            let (x, y) = (f64::from(k % rows), f64::from(k / rows));
            DVec3::new(x, (0.1 * x).sin() * y.cos(), y)
        };
        let quad = |k: u32| [[k, k + 1, k + rows + 1], [k, k + rows + 1, k + rows]];
        let quads = (0..rows * (rows - 1)).filter(|k| k % rows < rows - 1);
        let triangles: Vec<[u32; 3]> = quads.flat_map(quad).collect();
        // The last one is in no triangle.
        let places: Vec<DVec3> = (0..rows * rows)
            .map(place)
            .chain([DVec3::splat(1e9)])
            .collect();
        let sheet = Mesh::new(places, triangles.clone()).unwrap();
        let large = sheet.clone().with_flat_normals().unwrap();
        assert!(large.vertex_count() > MANY_VERTICES && large.facets().1 == triangles);
        let corners = triangles.iter().flatten();
        let positions = corners.map(|&corner| sheet.positions()[corner as usize]);
        let positions: Vec<DVec3> = positions.collect();
        let normals = large.normals().unwrap().to_vec();
        let listed = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
        let own = Mesh::from_parts(
            positions,
            listed.collect(),
            Some(normals),
            None,
            vec![],
            None,
        );
        assert_eq!(large.bounds(), own.bounds());
        // None of them is shown where they differ, for they are long.
        assert!(large == own);
        assert_eq!(large.corners_of(7), own.corners_of(7));
        let twice = large.clone().without_normals().with_flat_normals().unwrap();
        assert!(twice == own);
        let mirror = DAffine3::from_scale(DVec3::new(-1.0, 2.0, 1.0));
        let moved = sheet
            .clone()
            .with_flat_normals()
            .unwrap()
            .transformed(&mirror);
        assert!(moved == own.transformed(&mirror));
        // A part of it is small.
        let few = Mesh::new(sheet.positions().to_vec(), triangles[..100].to_vec()).unwrap();
        let few = few.with_flat_normals().unwrap();
        assert_eq!(few.facets().1, few.triangles());
        assert!(few.positions() == &large.positions()[..300]);
        assert!(few.normals().unwrap() == &large.normals().unwrap()[..300]);
        assert_eq!(few.triangles(), &large.triangles()[..100]);
    }
}
