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
    pub(super) fn seen_by(&self, sight: &Sight, about: About) -> Option<Triangulated> {
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
        let limited = match about {
            About::Surface => 0,
            About::Points => 1,
        };
        bounds
            .iter()
            .all(|bounds| bounds[limited] <= allowed)
            .then(|| Triangulated {
                mesh: self.made.mesh.clone(),
                bounds: vec![bounds],
            })
    }
}
