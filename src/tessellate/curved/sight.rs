//! How one observer sees a round shape: the map of places, the tolerance, and what is derived from the map.

use glam::{DAffine3, DMat3, DVec3};

use crate::light_cone::PhotosurfaceMap;
use crate::spacetime::Velocity;
use crate::tessellate::nearest_point;

/// Which distance a tolerance is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum About {
    /// That of two surfaces.
    Surface,
    /// That of places with the same texture coordinates.
    Points,
}

/// How far a triangle may be from the photosurface, in the observer's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Allowed {
    /// So far everywhere.
    Length(f64),
    /// The fraction `share` of the distance at which it is seen, minus `less`; at least `least`.
    Share { share: f64, less: f64, least: f64 },
}

/// One observer's view of a round shape.
#[derive(Clone, Debug)]
pub(crate) struct Sight {
    map: PhotosurfaceMap,
    /// From the shape's own frame to the offset from the observer, in the rest frame.
    to_offset: DAffine3,
    /// For normals.
    inverse_transpose: DMat3,
    /// The direction of the observer's motion, `gamma - 1` and `gamma beta`.
    pub(super) motion: DVec3,
    pub(super) gamma_less_one: f64,
    pub(super) gamma_beta: f64,
    /// An upper bound on how many times `to_offset` lengthens anything.
    pub(super) scale: f64,
    pub(crate) allowed: Allowed,
}

impl Sight {
    /// The view of an observer who moves with `velocity` in the rest frame.
    pub(crate) fn new(velocity: &Velocity, to_offset: DAffine3, allowed: Allowed) -> Self {
        let (gamma, gamma_beta) = (velocity.gamma(), velocity.gamma_beta());
        Self {
            map: PhotosurfaceMap::new(velocity),
            inverse_transpose: to_offset.matrix3.inverse().transpose(),
            motion: velocity.direction(),
            // Without cancellation: gamma^2 - 1 is the square of gamma beta.
            gamma_less_one: gamma_beta * (gamma_beta / (gamma + 1.0)),
            gamma_beta,
            scale: largest_factor(&to_offset.matrix3),
            to_offset,
            allowed,
        }
    }

    /// Whether the observers of two sights differ in nothing but their places.
    pub(super) fn differs_in_place_only(&self, other: &Self) -> bool {
        self.to_offset.matrix3 == other.to_offset.matrix3
            && (self.motion, self.gamma_beta) == (other.motion, other.gamma_beta)
    }

    /// The same view with a tolerance that is `factor` times as large.
    pub(crate) fn loosened(&self, factor: f64) -> Self {
        Self {
            allowed: self.allowed.times(factor),
            ..self.clone()
        }
    }

    /// The offset of a place from the observer, in the rest frame.
    pub(super) fn offset(&self, place: DVec3) -> DVec3 {
        self.to_offset.transform_point3(place)
    }

    /// A vector of the shape's own frame in the rest frame.
    pub(crate) fn at_rest(&self, vector: DVec3) -> DVec3 {
        self.to_offset.matrix3 * vector
    }

    /// Where a place of the shape is seen.
    pub(super) fn seen(&self, place: DVec3) -> DVec3 {
        self.map.seen_position(self.offset(place))
    }

    /// The same, a little off by rounding: for all that is proven anew.
    pub(super) fn seen_nearly(&self, place: DVec3) -> DVec3 {
        // The distances along the motion cancel behind the observer.
        const FASTEST: f64 = 1e4;
        if self.gamma_beta > FASTEST {
            return self.seen(place);
        }
        let offset = self.offset(place);
        let along =
            self.gamma_less_one * offset.dot(self.motion) + self.gamma_beta * offset.length();
        offset + self.motion * along
    }

    /// Where an offset at rest is seen.
    pub(super) fn seen_at(&self, offset: DVec3) -> DVec3 {
        self.map.seen_position(offset)
    }

    /// The unit normal of the photosurface where a place with this normal is seen.
    pub(super) fn seen_normal(&self, place: DVec3, normal: DVec3) -> DVec3 {
        let at_rest = self.inverse_transpose * normal;
        self.map.seen_normal(self.offset(place), at_rest)
    }

    /// The vector `a` of the map's Jacobian `I + n a^T`, where the line of sight has this direction at rest.
    pub(super) fn jacobian_vector(&self, toward: DVec3) -> DVec3 {
        self.motion * self.gamma_less_one + toward * self.gamma_beta
    }

    /// How far a triangle with corners seen there may be from the photosurface.
    pub(super) fn allowed(&self, seen: [DVec3; 3]) -> f64 {
        match self.allowed {
            Allowed::Length(length) => length,
            Allowed::Share { .. } => self.allowed_at(nearest_point(seen).length()),
        }
    }

    /// How far the triangles at this distance may be from the photosurface.
    pub(super) fn allowed_at(&self, distance: f64) -> f64 {
        match self.allowed {
            Allowed::Length(length) => length,
            Allowed::Share { share, less, least } => (share * distance - less).max(least),
        }
    }
}

impl Allowed {
    /// The same, multiplied by a factor.
    fn times(self, factor: f64) -> Self {
        match self {
            Self::Length(length) => Self::Length(length * factor),
            Self::Share { share, less, least } => Self::Share {
                share: share * factor,
                less: less * factor,
                least: least * factor,
            },
        }
    }
}

/// An upper bound on the largest singular value of a matrix: exact where the columns are at right angles.
fn largest_factor(matrix: &DMat3) -> f64 {
    let [a, b, c] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let longest = a
        .length_squared()
        .max(b.length_squared())
        .max(c.length_squared());
    let slanted = a.dot(b).abs().max(b.dot(c).abs()).max(c.dot(a).abs());
    (longest + 2.0 * slanted).sqrt() * (1.0 + 8.0 * f64::EPSILON)
}
