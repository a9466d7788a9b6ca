//! Flat shapes whose resolution the scene leaves to the program: their coarsest form, and places all over their faces.
//!
//! Facets of a flat face stand for it exactly, however few they are, and refinement divides them where that is called for. So
//! such a shape is held with the fewest facets. Where its photosurface bends, only places between the corners tell how
//! large it is: those of the default resolution.

use glam::DVec3;

use super::surface::check_triangles;
use super::{Shape, ShapeError};

impl Shape {
    /// The form with the fewest facets of a shape with flat faces that has no resolution of its own; `None` for other shapes.
    pub(crate) fn coarsest_flat(&self) -> Option<Self> {
        match self {
            Self::Cuboid(_) | Self::Grid(_) | Self::Lattice(_) if !self.has_resolution() => {
                Some(self.within(f64::INFINITY))
            }
            _ => None,
        }
    }

    /// A shape with flat faces and without a resolution of its own in so large a part of its default number of segments, but
    /// at least one; another shape as it is.
    pub(crate) fn with_share_of_segments(&self, share: f64) -> Self {
        let default = match self {
            Self::Cuboid(shape) => shape.resolution.unwrap_or_default().get(),
            Self::Grid(shape) => shape.resolution.unwrap_or_default().get(),
            Self::Lattice(shape) => shape.resolution.unwrap_or_default().get(),
            _ => 1,
        };
        let segments = (f64::from(default) * share) as u32;
        match self.coarsest_flat() {
            Some(coarsest) if segments < default => {
                let finer = coarsest.clone().with_resolution(segments.max(1));
                finer.unwrap_or(coarsest)
            }
            _ => self.clone(),
        }
    }

    /// Refuses a shape with flat faces that is too fine at its own or its default resolution; a round shape is never.
    ///
    /// # Errors
    ///
    /// More than 20 million triangles.
    pub(crate) fn check_flat_size(&self) -> Result<(), ShapeError> {
        check_triangles(match self {
            Self::Cuboid(shape) => shape.triangle_count(),
            Self::Grid(shape) => shape.triangle_count(),
            Self::Lattice(shape) => shape.triangle_count(),
            _ => 0,
        })
    }

    /// The number of vertices of a shape with flat faces; 0 for a round shape.
    pub(crate) fn flat_vertex_count(&self) -> usize {
        match self {
            Self::Cuboid(shape) => shape.vertex_count(),
            Self::Grid(shape) => shape.vertex_count(),
            Self::Lattice(shape) => shape.vertex_count(),
            _ => 0,
        }
    }

    /// Tells the places of the vertices of a shape with flat faces, at its resolution; nothing of a round shape.
    ///
    /// They are those of [`Shape::mesh`], bit for bit, though in another order and some of them more or less often.
    pub(crate) fn places_on_faces(&self, tell: impl FnMut(DVec3)) {
        match self {
            Self::Cuboid(shape) => shape.places(tell),
            Self::Grid(shape) => shape.places(tell),
            Self::Lattice(shape) => shape.places(tell),
            Self::Sphere(_) | Self::Cylinder(_) | Self::Cone(_) | Self::Torus(_) | Self::Rod(_) => {
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    fn flat_shapes() -> [Shape; 4] {
        [
            Shape::cuboid([1.0, 2.0, 3.0]),
            Shape::grid(1.3, 3),
            Shape::lattice([2, 1, 3], 1.0, 0.1),
            Shape::lattice([1, 1, 1], 0.7, 0.3),
        ]
        .map(Result::unwrap)
    }

    #[test]
    fn places_are_those_of_the_mesh() {
        for shape in flat_shapes() {
            for shape in [None, Some(1), Some(2), Some(5)].map(|resolution| match resolution {
                None => shape.clone(),
                Some(resolution) => shape.clone().with_resolution(resolution).unwrap(),
            }) {
                let bits = |place: DVec3| place.to_array().map(f64::to_bits);
                let mut found = HashSet::new();
                shape.places_on_faces(|place| {
                    found.insert(bits(place));
                });
                let mesh = shape.mesh().unwrap();
                let expected: HashSet<_> = mesh.positions().iter().map(|&p| bits(p)).collect();
                assert!(found == expected, "{shape:?}");
                assert_eq!(shape.flat_vertex_count(), mesh.vertex_count(), "{shape:?}");
            }
        }
    }

    #[test]
    fn a_share_of_the_segments_has_a_share_of_the_vertices() {
        let cuboid = &flat_shapes()[0];
        assert_eq!(cuboid.with_share_of_segments(1.0), *cuboid);
        for (share, segments) in [(0.5, 16), (0.1, 3), (0.0, 1)] {
            let expected = cuboid.clone().with_resolution(segments).unwrap();
            assert_eq!(cuboid.with_share_of_segments(share), expected);
        }
        let own = cuboid.clone().with_resolution(7).unwrap();
        assert_eq!(own.with_share_of_segments(0.1), own);
        let round = Shape::sphere(1.0).unwrap();
        assert_eq!(round.with_share_of_segments(0.1), round);
        assert_eq!(round.flat_vertex_count(), 0);
    }

    #[test]
    fn a_shape_is_too_fine_where_its_mesh_is() {
        for shape in flat_shapes() {
            assert_eq!(shape.check_flat_size(), Ok(()));
        }
        let fine = Shape::grid(1.0, 396).unwrap();
        assert!(fine.check_flat_size().is_err() && fine.mesh().is_err());
        let coarsest = fine.coarsest_flat().unwrap();
        assert!(coarsest.check_flat_size().is_ok() && coarsest.mesh().is_ok());
    }

    #[test]
    fn only_flat_shapes_without_a_resolution_have_a_coarsest_form() {
        for shape in flat_shapes() {
            let coarsest = shape.clone().with_resolution(1).unwrap();
            assert_eq!(shape.coarsest_flat(), Some(coarsest.clone()));
            assert_eq!(coarsest.coarsest_flat(), None);
        }
        for round in [Shape::sphere(1.0), Shape::torus(2.0, 0.5)] {
            let round = round.unwrap();
            assert_eq!(round.coarsest_flat(), None);
            round.places_on_faces(|place| panic!("{place}"));
        }
    }
}
