//! Light that reaches an observer, in the rest frame of what it came from.

use glam::{DMat3, DVec3};

use super::cone::Cone;
use crate::spacetime::{Moment, MovedLight, ViewModel, WorldLine, unit};

/// How light that an observer sees at one event came, for everything that moves with one velocity.
///
/// # Derivation
///
/// Light seen now in the unit direction `s` at the distance `l` comes from the event `l (-1, s)` of the
/// observer's frame, for some `l`: a straight line through the observation, in every frame. In the rest frame, in
/// which the observer moves along `n`, it is `l (-r, v)`, with the frequency `r` and the wave vector `v` of
/// [`MovedLight`] for the direction `s`,
/// and `|v| = r`: nothing cancels at any speed. So a ray in the rest frame is followed along `v`, and where it
/// hits after the distance `r l`, the thing is seen at the distance `l`: of several objects in
/// different motion the one with the smallest `l` hides the others. `1 / r` is the Doppler factor.
///
/// # Models
///
/// Without the travel time of light, things are where they are now: `l (0, s)` in the observer's frame, a straight line in
/// space along `v = s + (gamma - 1) n (n.s)` in the rest frame, where `gamma` undoes the contraction. Without contraction,
/// what is seen is seen of something `gamma` times as long along `n`: the component of `v` along `n` is that much smaller.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aberration {
    /// The observer's place in the rest frame.
    observer_rest: DVec3,
    /// The observer's direction of motion in the rest frame.
    along: DVec3,
    /// Of the observer in the rest frame; zero where light takes no time.
    rapidity: f64,
    /// How many times as long as the object its stand-in is along the motion.
    longer: f64,
    model: ViewModel,
    /// `exp(rapidity)` and `exp(-rapidity)`.
    grow: f64,
    shrink: f64,
    /// From the observer's axes to those that the boost alone would give.
    observer_to_boosted: DMat3,
}

/// A ray of light that reaches the observer, in a rest frame, followed back from the observer.
#[derive(Clone, Copy, Debug)]
pub(super) struct RestRay {
    pub(super) origin: DVec3,
    /// A unit vector.
    pub(super) direction: DVec3,
    /// Distance at rest over distance seen.
    pub(super) stretch: f64,
    /// Frequency seen over frequency emitted: positive, and above 1 where what is seen comes closer.
    pub(super) doppler: f64,
}

impl RestRay {
    /// A ray that is in the rest frame as it is seen.
    pub(super) fn unmoved(origin: DVec3, direction: DVec3) -> Self {
        Self {
            origin,
            direction,
            stretch: 1.0,
            doppler: 1.0,
        }
    }
}

impl Aberration {
    /// How the observer of `moment` sees what moves along with `object`.
    pub(super) fn new(moment: &Moment, object: &WorldLine, model: ViewModel) -> Self {
        let rest_to_observer = moment.rest_to_observer(object.velocity);
        let relative = rest_to_observer.boost_velocity();
        let event = moment.event_at_rest_with(object);
        let gamma = relative.rapidity().cosh();
        let rapidity = if model.has_delay() {
            relative.rapidity()
        } else {
            0.0
        };
        Self {
            observer_rest: event.position,
            along: relative.direction(),
            rapidity,
            longer: match model {
                ViewModel::Seen | ViewModel::Rest => 1.0,
                ViewModel::Delayed => gamma,
                ViewModel::Contracted => gamma.recip(),
            },
            model,
            grow: rapidity.exp(),
            shrink: (-rapidity).exp(),
            observer_to_boosted: DMat3::from_quat(rest_to_observer.rotation().inverse()),
        }
    }

    /// The ray that is seen in the unit direction `seen`.
    pub(super) fn ray(&self, seen: DVec3) -> RestRay {
        let MovedLight {
            across,
            along: par,
            factor: stretch,
        } = self.light(seen);
        let doppler = match self.model {
            ViewModel::Seen => 1.0 / stretch,
            // The classical factor: clocks are not slowed.
            ViewModel::Delayed => self.longer / stretch,
            ViewModel::Contracted | ViewModel::Rest => 1.0,
        };
        // Scaled before it is squared: `stretch` may be as large as exp(700).
        let direction = across / stretch + self.along * (par / stretch / self.longer);
        let longer = match self.model {
            ViewModel::Seen | ViewModel::Rest => 1.0,
            ViewModel::Delayed | ViewModel::Contracted => direction.length(),
        };
        RestRay {
            origin: self.observer_rest,
            direction: direction.normalize(),
            stretch: stretch * longer,
            doppler,
        }
    }

    /// The part of the observer's sky that a ball takes up, given in the rest frame.
    pub(super) fn cone(&self, center: DVec3, radius: f64) -> Cone {
        let boosted_to_observer = self.observer_to_boosted.transpose();
        let ball = match self.longer {
            1.0 => (center, radius),
            longer => {
                let offset = center - self.observer_rest;
                let stretched = offset + self.along * ((longer - 1.0) * self.along.dot(offset));
                // Everything of the stretched ball is in this one, roundings and all.
                (
                    self.observer_rest + stretched,
                    (radius + 1e-12 * offset.length()) * longer.max(1.0),
                )
            }
        };
        Cone::of_moving(self.observer_rest, self.along, self.rapidity, ball)
            .turned(|direction| boosted_to_observer * direction)
    }

    /// The unit normal at rest of a surface that has the normal `normal` where it is seen, in the unit
    /// direction `seen`; `None` if that has no direction.
    ///
    /// # Derivation
    ///
    /// What is at the offset `x` from the observer at rest is seen at `x_across + n gamma (x_par + beta |x|)`; a
    /// normal at rest is the gradient by `x` of `normal . seen place`, which is
    /// `N_across + (N.n) (gamma n + gamma beta x / |x|)`. With `x / |x| = v / r` and
    /// `gamma (1 + beta v_par / r) = 1 / r` that is, times `r`, `r N_across + (N.n) (n + gamma beta s_across)`.
    pub(super) fn normal_at_rest(&self, normal: DVec3, seen: DVec3) -> Option<DVec3> {
        let MovedLight { across, factor, .. } = self.light(seen);
        let normal = self.observer_to_boosted * normal;
        let normal_along = normal.dot(self.along);
        let normal_across = self.along.cross(normal).cross(self.along);
        let slanted = self.along + across * self.rapidity.sinh();
        let of_stand_in = normal_across * factor + slanted * normal_along;
        let longer = self.along * ((self.longer - 1.0) * self.along.dot(of_stand_in));
        unit(of_stand_in + longer)
    }

    /// The line of sight in the rest frame of the stand-in.
    fn light(&self, seen: DVec3) -> MovedLight {
        let seen = self.observer_to_boosted * seen;
        MovedLight::new(seen, self.along, self.grow, self.shrink)
    }
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;
    use crate::spacetime::{Event, Lorentz, Rotation, Velocity};

    fn rotation(turn: DQuat) -> Rotation {
        Rotation::new(turn).unwrap()
    }

    fn line(time: f64, position: DVec3, velocity: Velocity) -> WorldLine {
        WorldLine {
            origin: Event::new(time, position),
            velocity,
        }
    }

    fn directions() -> Vec<DVec3> {
        let steps = [-1.0, -0.3, 0.0, 1e-9, 0.7];
        let all =
            (0..125).map(|k: usize| DVec3::new(steps[k % 5], steps[k / 5 % 5], steps[k / 25]));
        all.filter_map(unit).collect()
    }

    /// Through the scene frame, where all axes are given: two pure boosts, and the observer's own turn.
    #[test]
    fn rays_are_those_of_two_boosts_through_the_scene() {
        let speeds = [0.0, 0.3, 0.9, 0.99];
        let ways = [DVec3::X, DVec3::new(-0.3, 0.5, 0.6), DVec3::NEG_Z];
        for (speed, other) in speeds.iter().flat_map(|a| speeds.map(|b| (*a, b))) {
            for (way, other_way) in ways.iter().flat_map(|a| ways.map(|b| (*a, b))) {
                let observer = Velocity::from_beta(speed, way).unwrap();
                let object = Velocity::from_beta(other, other_way).unwrap();
                let seen_from = line(0.5, DVec3::new(1.0, 2.0, -3.0), observer);
                let thing = line(0.0, DVec3::new(0.25, -1.0, 2.0), object);
                let turn = DQuat::from_rotation_arc(DVec3::Z, unit(other_way).unwrap());
                let moment = seen_from.moment(1.5).turned(rotation(turn));
                let aberration = Aberration::new(&moment, &thing, ViewModel::Seen);
                for seen in directions() {
                    let ray = aberration.ray(seen);
                    let distance = 3.0;
                    let to_scene = Lorentz::boost(observer.reversed());
                    let emission = seen_from.at(1.5)
                        + to_scene.apply(Event::new(-distance, turn * seen * distance));
                    let rest = Lorentz::boost(object).apply(emission - thing.origin);
                    let found = ray.origin + ray.direction * (ray.stretch * distance);
                    // Each boost magnifies by at most 14.2, and so do the roundings of its coordinates.
                    let limit = 200.0 * 20.0 * 14.2 * f64::EPSILON;
                    assert!(found.distance(rest.position) < limit, "{found} {rest:?}");
                }
            }
        }
    }

    #[test]
    fn at_any_speed_directions_are_aberrated_by_the_half_angle() {
        for rapidity in [0.0, 1e-9, 1.0, 20.0, 350.0] {
            let velocity = Velocity::from_rapidity(rapidity, DVec3::NEG_Z).unwrap();
            let observer = line(0.0, DVec3::ZERO, velocity);
            let thing = line(0.0, DVec3::ZERO, Velocity::ZERO);
            let aberration = Aberration::new(&observer.moment(0.0), &thing, ViewModel::Seen);
            for seen in directions() {
                let ray = aberration.ray(seen);
                assert!(ray.stretch > 0.0 && ray.stretch.is_finite());
                assert!((ray.direction.length() - 1.0).abs() < 1e-15);
                let half = |v: DVec3| v.x.hypot(v.y).atan2(-v.z) / 2.0;
                let expected = (half(seen).sin() * rapidity.exp()).atan2(half(seen).cos());
                assert!(
                    (half(ray.direction) - expected).abs() < 1e-15,
                    "{rapidity} {seen} {} {expected}",
                    half(ray.direction)
                );
                // Around the direction of motion nothing turns.
                let (a, b) = (seen.truncate(), ray.direction.truncate());
                assert!(a.perp_dot(b).abs() <= 4.0 * f64::EPSILON * b.length().max(1e-300));
            }
        }
    }

    /// What is seen within `acos(beta)` of the direction of motion is half of the sky; light is unshifted on the ring at
    /// `acos((1 - 1 / gamma) / beta)`. Angles in degrees.
    #[test]
    fn half_of_the_sky_is_ahead_and_a_ring_is_unshifted() {
        for (beta, unshifted) in [(0.5, 74.4577), (0.9, 51.1864), (0.99, 29.8181)] {
            let velocity = Velocity::from_beta(beta, DVec3::NEG_Z).unwrap();
            let observer = line(0.0, DVec3::ZERO, velocity);
            let thing = line(0.0, DVec3::ZERO, Velocity::ZERO);
            let aberration = Aberration::new(&observer.moment(0.0), &thing, ViewModel::Seen);
            let doppler = |seen| aberration.ray(seen).doppler;
            let at = |angle: f64| DVec3::new(0.6 * angle.sin(), 0.8 * angle.sin(), -angle.cos());
            let half = aberration.ray(at(beta.acos())).direction;
            assert!(half.z.abs() < 1e-14, "{beta}: {half}");
            let ring = at(f64::to_radians(unshifted));
            assert!((doppler(ring) - 1.0).abs() < 1e-5, "{beta}");
            let exact = at(((1.0 - 1.0 / velocity.gamma()) / beta).acos());
            assert!((doppler(exact) - 1.0).abs() < 1e-14, "{beta}");
        }
    }

    /// Against differences of the ray's own map: a small triangle, seen point by point.
    #[test]
    fn normals_at_rest_are_those_of_the_surface_that_is_seen() {
        let velocity = Velocity::from_beta(0.8, DVec3::new(0.2, -1.0, 0.4)).unwrap();
        let other = Velocity::from_beta(0.6, DVec3::X).unwrap();
        let turn = DQuat::from_rotation_x(1.3);
        let aberration = Aberration::new(
            &line(0.0, DVec3::ZERO, velocity)
                .moment(0.0)
                .turned(rotation(turn)),
            &line(0.0, DVec3::Y, other),
            ViewModel::Seen,
        );
        for seen in directions() {
            let (u, v) = seen.any_orthonormal_pair();
            // Three points of a slanted seen plane, and where they are at rest.
            let corners = [DVec3::ZERO, u + 0.3 * seen, v - 0.8 * seen].map(|offset| {
                let place = seen + 1e-5 * offset;
                let distance = place.length();
                let ray = aberration.ray(place / distance);
                (place, ray.direction * (ray.stretch * distance))
            });
            let normal = |k: fn(&(DVec3, DVec3)) -> DVec3| {
                let [a, b, c] = [k(&corners[0]), k(&corners[1]), k(&corners[2])];
                (b - a).cross(c - a).normalize()
            };
            let found = aberration.normal_at_rest(normal(|c| c.0), seen).unwrap();
            // Of second order in 1e-5, times the square of a Doppler factor of at most 8.
            assert!(found.distance(normal(|c| c.1)) < 1e-3, "{seen}");
        }
    }
}
