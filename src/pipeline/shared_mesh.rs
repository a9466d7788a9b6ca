//! A mesh of a round shape that is made for one observer and kept where it is good enough for others.

use crate::shape::Shape;
use crate::tessellate::{About, Allowed, Carried, Sight, Triangulated, triangulate_about};

/// The triangles of a round shape for one sight, with what their bounds for other sights need.
pub(super) struct SharedMesh {
    made: Triangulated,
    /// The square of the longest side of each triangle, an offset at rest.
    sides: Vec<f64>,
    sight: Sight,
    /// No place of the shape is farther from the origin of its own frame.
    radius: f64,
}

impl SharedMesh {
    /// The triangles for a sight whose tolerance is a length; `None` if they cannot be proven.
    pub(super) fn new(shape: &Shape, sight: Sight, about: About) -> Option<Self> {
        let made = triangulate_about(shape, std::slice::from_ref(&sight), about, u64::MAX)?;
        let places = made.mesh.positions();
        let longest = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|corner| places[corner as usize]);
            let sides = [b - a, c - b, a - c].map(|side| sight.at_rest(side).length_squared());
            sides.into_iter().fold(0.0, f64::max)
        };
        Some(Self {
            sides: made.mesh.triangles().iter().map(longest).collect(),
            radius: shape.reach(),
            made,
            sight,
        })
    }

    /// The same triangles with their bounds for another sight; `None` if these are more than is allowed.
    pub(super) fn seen_by(&self, sight: &Sight) -> Option<Triangulated> {
        let Allowed::Length(allowed) = sight.allowed else {
            return None;
        };
        let carried = Carried::new(&self.sight, sight, self.radius)?;
        let [bounds] = &self.made.bounds[..] else {
            return None;
        };
        let bounds = bounds.iter().zip(&self.sides);
        let bounds: Vec<[f64; 2]> = bounds
            .map(|(bounds, &side)| bounds.map(|bound| carried.bound(bound, side)))
            .collect();
        // What is proven comes first, under either measure.
        let are_near = bounds.iter().all(|&[proven, _]| proven <= allowed);
        are_near.then(|| Triangulated {
            mesh: self.made.mesh.clone(),
            bounds: vec![bounds],
        })
    }
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DVec3};

    use super::*;
    use crate::spacetime::Velocity;

    #[test]
    fn bounds_of_another_direction_are_larger_and_end() {
        let shape = Shape::sphere(0.5).unwrap();
        let velocity = Velocity::from_beta(0.9, DVec3::NEG_Z).unwrap();
        let sight = |at: DVec3, allowed: f64| {
            let to_offset = DAffine3::from_translation(at);
            Sight::new(&velocity, to_offset, Allowed::Length(allowed))
        };
        let ahead = DVec3::new(0.0, 0.0, -60.0);
        let shared = SharedMesh::new(&shape, sight(ahead, 0.01), About::Surface).unwrap();
        let own = &shared.made.bounds[0];
        let largest = |bounds: &[[f64; 2]]| bounds.iter().map(|of| of[0]).fold(0.0, f64::max);
        let mut before = largest(own);
        for aside in [0.3, 1.0, 3.0] {
            let beside = ahead + aside * DVec3::X;
            let seen = shared.seen_by(&sight(beside, 0.1)).expect("near enough");
            let bounds = &seen.bounds[0];
            assert!(
                bounds
                    .iter()
                    .zip(own)
                    .all(|(carried, own)| carried[0] >= own[0])
            );
            assert!(largest(bounds) > 1.0001 * before, "{aside}");
            before = largest(bounds);
            assert!(shared.seen_by(&sight(beside, 0.999 * before)).is_none());
        }
        assert!(shared.seen_by(&sight(DVec3::X * 60.0, 0.01)).is_none());
    }
}
