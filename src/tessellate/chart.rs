//! The plane of a triangle, and charts of it: the observer's sky, or flatter ones.

use glam::{DVec2, DVec3};

use super::Allowance;

/// More points than this are not spent on a chart that does not fit.
const MAX_MORE: f64 = 1e6;

/// So many times the power of a chart over what is allowed of a distance: all around, over forty powers of `e`, and that
/// five times.
const POINTS_OF_POWER: f64 = 500.0;

/// Steps to find a place of a chart with a power: nearly always less than ten.
const MAX_STEPS: usize = 100;

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

    /// What part of the distance is allowed as a gap, on the whole: between the least and the most at corners and in the
    /// middles of sides.
    fn share(&self, allowance: &Allowance) -> f64 {
        let [a, b, c] = self.corners;
        let places = [a, b, c, (a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5];
        let shares = places.map(|place| {
            let offset = self.x * place.x + self.y * place.y + self.away * self.height;
            allowance.between(&[offset]) / offset.length()
        });
        let least = shares.into_iter().fold(f64::INFINITY, f64::min);
        let most = shares.into_iter().fold(0.0, |most, share| {
            if share < f64::INFINITY {
                share.max(most)
            } else {
                most
            }
        });
        (least * most).sqrt()
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

/// A chart of a plane: `w = q / (r + h) (r / reach)^power` for the offset `q` from the foot of the perpendicular, with
/// `r = hypot(q, h)`.
///
/// With the height `h` of the plane and the power zero it is the stereographic chart of the sky. Where the observer is
/// in the plane or next to it that is all but a line, the horizon; a larger height is flatter than the sky, and with
/// a power the distances from the observer are told apart by their logarithm: what suits gaps that are allowed in
/// proportion to the distance, over any number of powers of ten.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chart {
    pub(super) plane: Plane,
    pub(super) height: f64,
    pub(super) power: f64,
    /// Farther away than any corner.
    reach: f64,
    /// The smallest of what is allowed.
    allowed: f64,
}

/// How many times as far away the far end of a triangle may be as its near end: the cheapest, about, in a plane
/// that the observer is in. Its logarithm.
const STRETCHED: f64 = 1.4;

/// A chart that does not fit is followed by one with so many times the power, up to this one.
const MORE_POWER: f64 = 2.0;
const MAX_POWER: f64 = 1.0;

/// A chart that does not fit is followed by one flatter by this factor where all gaps are alike.
const FLATTER: f64 = 4.0;

impl Chart {
    /// The first to be tried with `flattening` 0, then flatter ones; `allowed` is the smallest of what is allowed.
    pub(super) fn new(plane: Plane, allowance: &Allowance, allowed: f64, flattening: i32) -> Self {
        // Where the observer is in the plane every direction lies on the horizon. Any chart gives a valid mesh.
        let height = plane
            .height
            .max((2.0 * allowed * plane.nearest).sqrt())
            .max(allowed);
        let corners = plane
            .corners
            .map(|corner| corner.length().hypot(plane.height));
        let farthest = corners.into_iter().fold(0.0, f64::max);
        let sky = Self {
            plane,
            height: plane.height,
            power: 0.0,
            reach: 2.0 * farthest,
            allowed,
        };
        match allowance {
            Allowance::Everywhere(_) => Self {
                height: height * FLATTER.powi(flattening),
                ..sky
            },
            Allowance::Angle { .. } if height <= plane.height && flattening == 0 => sky,
            Allowance::Angle { .. } => {
                let before = i32::from(height <= plane.height);
                let flatter = MORE_POWER.powi(flattening - before);
                let power = (8.0 * plane.share(allowance)).sqrt() / STRETCHED * flatter;
                Self {
                    power: power.min(MAX_POWER),
                    ..sky
                }
            }
        }
    }

    pub(super) fn place_to_chart(&self, place: DVec2) -> DVec2 {
        let distance = place.length().hypot(self.height);
        let on_sky = place / (distance + self.height);
        if self.power == 0.0 {
            on_sky
        } else if distance == 0.0 {
            DVec2::ZERO
        } else {
            on_sky * (distance / self.reach).powf(self.power)
        }
    }

    pub(super) fn chart_to_place(&self, w: DVec2) -> DVec2 {
        if self.power == 0.0 {
            return w * (2.0 * self.height / (1.0 - w.length_squared()));
        }
        let radius = w.length();
        match radius {
            0.0 => DVec2::ZERO,
            _ => w * (self.distance_in_plane(radius) / radius),
        }
    }

    /// How far from the foot a place is that is so far from it in a chart with a power.
    fn distance_in_plane(&self, radius: f64) -> f64 {
        let Self {
            height,
            power,
            reach,
            ..
        } = *self;
        if height < 1e-200 * reach {
            return reach * radius.powf(1.0 / power);
        }
        // In `t` with `q = h sinh t` nothing cancels: Newton's steps where they stay between what is known, or halves.
        let target = radius.ln() - power * (height / reach).ln();
        let (mut low, mut high) = (0.0, (2.0 * reach / height).asinh());
        let mut t: f64 = 0.5 * high;
        for _ in 0..MAX_STEPS {
            let excess = (0.5 * t).tanh().ln() + power * t.cosh().ln() - target;
            match excess > 0.0 {
                true => high = t,
                false => low = t,
            }
            let next = t - excess / (1.0 / t.sinh() + power * t.tanh());
            let next = if low < next && next < high {
                next
            } else {
                0.5 * (low + high)
            };
            let is_there = (next - t).abs() <= 4.0 * f64::EPSILON * t;
            t = next;
            if is_there {
                break;
            }
        }
        height * t.sinh()
    }

    /// How many points more than the sky asks for such a chart may take.
    pub(super) fn points(&self, allowance: &Allowance) -> usize {
        let share = if self.power > 0.0 {
            POINTS_OF_POWER * self.power / self.plane.share(allowance)
        } else if self.height > self.plane.height {
            let reach = self.plane.nearest.max(self.height);
            self.height * self.plane.area / (reach * reach * self.allowed)
        } else {
            0.0
        };
        share.min(MAX_MORE) as usize
    }

    /// The square of the metric's factor: lengths in the chart times it are lengths in which a gap `e` is an
    /// edge of `sqrt(8 e)`.
    pub(super) fn metric(&self, w: DVec2) -> f64 {
        let square = w.length_squared();
        if self.power == 0.0 {
            return 4.0 * self.height / (1.0 - square * square).max(f64::EPSILON);
        }
        let distance = self.distance_in_plane(square.sqrt()).hypot(self.height);
        let on_sky = (distance + self.height).powi(2) / distance;
        let metric = on_sky * (self.reach / distance).powf(2.0 * self.power);
        // Next to the foot there is nothing to be told apart.
        if metric.is_finite() {
            metric
        } else {
            f64::MIN_POSITIVE
        }
    }

    /// The height that a plane would have of which theory asks for as many triangles as this chart takes at a place.
    pub(super) fn effective_height(&self, place: DVec2) -> f64 {
        let distance = place.length().hypot(self.height);
        match self.power {
            0.0 => self.height,
            power => self.height + power * place.length_squared() / distance,
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light_cone::View;
    use crate::spacetime::{Event, Velocity, WorldLine};

    /// There and back, with the observer in the plane and at any distance from it.
    #[test]
    fn places_are_found_again() {
        let world_line = |velocity| WorldLine {
            origin: Event::default(),
            velocity,
        };
        let view = View::new(
            &world_line(Velocity::from_rapidity(1.0, DVec3::X).unwrap()).moment(0.0),
            &world_line(Velocity::default()),
        );
        let allowance = Allowance::Angle {
            view,
            share: 1e-3,
            less: 0.0,
            least: 1e-9,
        };
        for height in [0.0, 1e-250, 1e-12, 1e-3, 0.7, 30.0] {
            let corners = [
                DVec3::new(-1.0, -1.0, height),
                DVec3::new(2.0, -1.0, height),
                DVec3::new(0.0, 1.5, height),
            ];
            let plane = Plane::new(corners).unwrap();
            for flattening in [0, 1, 7] {
                let chart = Chart::new(plane, &allowance, 1e-4, flattening);
                for exponent in -9..=0 {
                    let place = DVec2::new(0.6, -0.8) * 10f64.powi(exponent);
                    let w = chart.place_to_chart(place);
                    assert!(w.length() < 1.0);
                    let back = chart.chart_to_place(w);
                    // What a height hides is lost in a chart.
                    let digits =
                        1e-9 * (place.length() + height * 1e-6) / chart.power.clamp(1e-3, 1.0);
                    assert!(
                        (back - place).length() <= digits,
                        "{height} {flattening}: {back} {place}"
                    );
                }
            }
        }
    }
}
