//! The plane of a triangle, and charts of that plane: the observer's sky, or a flatter chart.

use glam::{DVec2, DVec3};

use super::Allowance;

/// The largest number of extra points for a chart that is flatter than the sky.
const MAX_MORE: f64 = 1e6;

/// Extra points for a chart with a power, in units of the power divided by the allowed gap per distance. The number is
/// enough for all directions and distances over forty powers of `e`, five times.
const POINTS_OF_POWER: f64 = 500.0;

/// Limit on the steps that find the point of a plane from its chart coordinates if the chart has a power; nearly always
/// fewer than ten are needed.
const MAX_STEPS: usize = 100;

/// The plane of a triangle, in the rest frame, with coordinates whose origin is the plane's point nearest to the
/// observer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub(super) x: DVec3,
    pub(super) y: DVec3,
    /// The unit normal that points away from the observer.
    pub(super) away: DVec3,
    /// Distance of the plane from the observer.
    pub(super) height: f64,
    /// Distance of the nearest point of the triangle from the observer.
    pub(super) nearest: f64,
    corners: [DVec2; 3],
    /// Twice the area of the triangle.
    area: f64,
}

impl Plane {
    /// The plane of the triangle whose corners have these offsets from the observer; `None` if the triangle is too thin
    /// to have one.
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

    /// The allowed gap per distance from the observer, as one number for the whole triangle: the geometric mean of the
    /// smallest and the largest value at the corners and at the midpoints of the sides.
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

/// A chart of a plane: `w = q / (r + h) (r / reach)^power`, where `q` is the in-plane offset from the foot of the
/// perpendicular through the observer, and `r = hypot(q, h)`.
///
/// If `h` is the distance of the plane from the observer and the power is zero, this is the stereographic chart of the
/// sky. For an observer in the plane or next to it, that chart shrinks to the horizon, almost a line. A larger height
/// makes the chart flatter than the sky. A power separates distances from the observer by their logarithm; this suits
/// an allowed gap that is proportional to the distance, over any number of powers of ten.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chart {
    pub(super) plane: Plane,
    pub(super) height: f64,
    pub(super) power: f64,
    /// A distance larger than that of any corner.
    reach: f64,
    /// The smallest allowed gap of the triangle.
    allowed: f64,
}

/// Logarithm of the ratio of the distances of an output triangle's far and near ends. This value gives about the fewest
/// triangles in a plane that contains the observer.
const STRETCHED: f64 = 1.4;

/// If a chart does not fit, the next one has the power multiplied by this factor, up to the maximum.
const MORE_POWER: f64 = 2.0;
const MAX_POWER: f64 = 1.0;

/// If a chart does not fit and the allowed gap is the same everywhere, the next chart's height is larger by this
/// factor.
const FLATTER: f64 = 4.0;

impl Chart {
    /// The chart number `flattening`: 0 is the first one to try, larger numbers are flatter. `allowed` is the smallest
    /// allowed gap of the triangle.
    pub(super) fn new(plane: Plane, allowance: &Allowance, allowed: f64, flattening: i32) -> Self {
        // For an observer in the plane every direction lies on the horizon, so the height is made larger. Any chart
        // gives a valid mesh.
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

    /// The in-plane distance from the foot, for a point whose chart coordinates have the length `radius`; the chart has
    /// a power.
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
        // The unknown is `t` with `q = h sinh t`, because nothing cancels then. A Newton step is used if it stays
        // between the known bounds; otherwise the interval is halved.
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

    /// How many more points this chart may use than the chart of the sky.
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

    /// The square of the factor by which the gap metric stretches lengths of the chart at `w`. In the gap metric an
    /// edge with the gap `e` has the length `sqrt(8 e)`.
    pub(super) fn metric(&self, w: DVec2) -> f64 {
        let square = w.length_squared();
        if self.power == 0.0 {
            return 4.0 * self.height / (1.0 - square * square).max(f64::EPSILON);
        }
        let distance = self.distance_in_plane(square.sqrt()).hypot(self.height);
        let on_sky = (distance + self.height).powi(2) / distance;
        let metric = on_sky * (self.reach / distance).powf(2.0 * self.power);
        // Next to the foot the chart cannot separate points.
        if metric.is_finite() {
            metric
        } else {
            f64::MIN_POSITIVE
        }
    }

    /// The distance that a plane would need to have from the observer so that theory asks for as many triangles as this
    /// chart needs at `place`.
    pub(super) fn effective_height(&self, place: DVec2) -> f64 {
        let distance = place.length().hypot(self.height);
        match self.power {
            0.0 => self.height,
            power => self.height + power * place.length_squared() / distance,
        }
    }
}

/// Distance of a counter-clockwise triangle from the origin; zero if the origin is inside.
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

    /// Points go to the chart and back, with the observer in the plane and at any distance from it.
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
                    // The chart loses digits of points that are near the foot compared with the height.
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
