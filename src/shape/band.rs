//! The true surfaces of cylinders, rods and cones, piece by piece, for those who need no facets.

use glam::{DVec2, DVec3};

use super::Shape;
use super::lathe::{Chart, Strip};
use super::sphere::turn;

/// A straight piece of a profile turned about the y axis: part of a cone or a cylinder, or a disc.
pub(crate) struct Band {
    /// Distance from the axis and height of its upper and its lower end; of a disc, heights are the same.
    pub(crate) ends: [DVec2; 2],
    /// Away from the axis and up.
    pub(crate) normal: DVec2,
    chart: Chart,
    /// Texture coordinate down the band at both ends.
    down: [f64; 2],
}

impl Band {
    /// The whole of a strip whose rings lie on one line.
    fn new(Strip { chart, rings }: Strip) -> Option<Self> {
        let (upper, lower) = (rings.first()?, rings.last()?);
        Some(Self {
            ends: [upper, lower].map(|ring| DVec2::new(ring.radius, ring.height)),
            normal: upper.normal,
            down: [upper.down, lower.down],
            chart,
        })
    }

    /// The texture coordinates of a point of the band.
    pub(crate) fn texture_at(&self, place: DVec3) -> DVec2 {
        match &self.chart {
            Chart::Around { repeats } => {
                let [upper, lower] = self.ends.map(|end| end.y);
                let part = (upper - place.y) / (upper - lower);
                let down = self.down[0] + part * (self.down[1] - self.down[0]);
                DVec2::new(repeats * turn(place), down)
            }
            flat @ Chart::Across { .. } => flat.across(place, self.normal.y),
        }
    }
}

impl Shape {
    /// The true surface of a shape with a straight profile: of a cylinder, a rod or a cone.
    pub(crate) fn bands(&self) -> Option<Vec<Band>> {
        let profile = match self {
            Self::Cylinder(cylinder) => cylinder.profile(),
            Self::Rod(rod) => rod.profile(),
            Self::Cone(cone) => cone.profile(),
            _ => return None,
        };
        profile.into_iter().map(Band::new).collect()
    }
}
