//! The plane of a triangle, and the observer's sky as a stereographic chart of it.

use glam::{DVec2, DVec3};

/// More points than this are not spent on a chart that does not fit.
const MOST_MORE: f64 = 1e6;

/// The plane of a triangle, with coordinates from the point nearest to the observer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub(super) x: DVec3,
    pub(super) y: DVec3,
    /// The unit normal that leads away from the observer.
    pub(super) away: DVec3,
    /// Distance of the plane from the observer.
    pub(super) height: f64,
    /// Distance of the triangle from the observer.
    pub(super) nearest: f64,
    corners: [DVec2; 3],
    /// Twice the area.
    area: f64,
}

impl Plane {
    /// `None` for a triangle without a plane.
    pub(super) fn new([a, b, c]: [DVec3; 3]) -> Option<Self> {
        let x = (b - a).try_normalize()?;
        let normal = (b - a).cross(c - a).try_normalize()?;
        let y = normal.cross(x);
        let corners = [a, b, c].map(|corner| DVec2::new(corner.dot(x), corner.dot(y)));
        let area = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]);
        let longest = (b - a)
            .length_squared()
            .max((c - b).length_squared())
            .max((a - c).length_squared());
        let ahead = a.dot(normal);
        let height = ahead.abs();
        (area > 1e-13 * longest).then(|| Self {
            x,
            y,
            away: normal * 1f64.copysign(ahead),
            height,
            nearest: height.hypot(distance_from_origin(corners)),
            corners,
            area,
        })
    }

    pub(super) fn place(&self, offset: DVec3) -> DVec2 {
        DVec2::new(offset.dot(self.x), offset.dot(self.y))
    }

    pub(super) fn weights(&self, place: DVec2) -> DVec3 {
        let [a, b, c] = self.corners;
        let w1 = (place - a).perp_dot(c - a) / self.area;
        let w2 = (b - a).perp_dot(place - a) / self.area;
        DVec3::new(1.0 - w1 - w2, w1, w2)
    }
}

/// The stereographic chart of a plane; for a height beyond that of the plane it is flatter than the sky.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chart {
    pub(super) plane: Plane,
    pub(super) height: f64,
}

impl Chart {
    pub(super) fn place_to_chart(&self, place: DVec2) -> DVec2 {
        place / (place.length().hypot(self.height) + self.height)
    }

    pub(super) fn chart_to_place(&self, w: DVec2) -> DVec2 {
        w * (2.0 * self.height / (1.0 - w.length_squared()))
    }

    /// How many points more than the sky asks for a flatter chart may take.
    pub(super) fn points(&self, allowed: f64) -> usize {
        if self.height <= self.plane.height {
            return 0;
        }
        let reach = self.plane.nearest.max(self.height);
        let share = self.height * self.plane.area / (reach * reach * allowed);
        share.min(MOST_MORE) as usize
    }

    /// The square of the metric's factor: lengths in the chart times it are lengths in which a gap `e` is an
    /// edge of `sqrt(8 e)`.
    pub(super) fn metric(&self, w: DVec2) -> f64 {
        let square = w.length_squared();
        4.0 * self.height / (1.0 - square * square).max(f64::EPSILON)
    }
}

/// Distance of a counter-clockwise triangle from the origin; zero inside.
fn distance_from_origin(corners: [DVec2; 3]) -> f64 {
    let sides = [0, 1, 2].map(|i| (corners[i], corners[(i + 1) % 3]));
    if sides.iter().all(|(a, b)| a.perp_dot(*b) >= 0.0) {
        return 0.0;
    }
    let to_side = |(a, b): (DVec2, DVec2)| {
        let parameter = (-a.dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        (a + (b - a) * parameter).length()
    };
    sides.map(to_side).into_iter().fold(f64::INFINITY, f64::min)
}
