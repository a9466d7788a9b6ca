//! How an observer in motion sees something else in motion: from a moment and a worldline to the photosurface map.

use glam::{DAffine3, DMat3, DQuat, DVec3};

use super::PhotosurfaceMap;
use crate::spacetime::{Event, Lorentz, Moment, Velocity, WorldLine, length};

/// How an observer sees, at one event, everything that moves with one velocity.
///
/// Two frames are spoken of: the *rest frame* of the object, with the object's origin at its origin, and
/// the *observer's frame*, with the observer there. The axes of the rest frame are those of the scene under a pure
/// boost, those of the observer's frame are the observer's own.
///
/// # Derivation
///
/// The observer's place in the rest frame is the boosted difference of the moment's and the worldline's origins, plus
/// the moment's displacement in the rest frame: differences are taken of numbers as they are given, before anything is
/// multiplied by `gamma`, and what they round is kept. The transformations from rest frame to scene and
/// from scene to observer together are one boost, which the photosurface map takes care of, and a
/// rotation (Wigner's and that of the observer's axes), which follows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    observer_rest: DVec3,
    /// How large the numbers are that this place is a sum of.
    place_size: f64,
    rest_to_observer: Lorentz,
    /// The rotation that follows the boost.
    turn: DMat3,
    map: PhotosurfaceMap,
}

impl View {
    /// How the observer of `moment` sees what moves along with `object`.
    ///
    /// An event that is not finite, in either, puts the observer infinitely far away: everything is seen at infinity.
    pub fn new(moment: &Moment, object: &WorldLine) -> Self {
        let rest_to_observer = moment.rest_to_observer(object.velocity);
        let relative = rest_to_observer.boost_velocity();
        let to_rest = Lorentz::boost(object.velocity);
        let (difference, rounded) = moment.origin().exact_difference(&object.origin);
        let origin = to_rest.apply(difference) + to_rest.apply(rounded);
        let size = |event: Event| length(event.position).max(event.time.abs());
        let (mut traveled, mut traveled_size) = (Event::default(), 0.0);
        for leg in moment.displacements_in(object.velocity) {
            traveled = traveled + leg;
            traveled_size += size(leg);
        }
        let place = origin.position + traveled.position;
        Self {
            // Beyond f64, where infinities may have cancelled.
            observer_rest: if place.is_finite() {
                place
            } else {
                DVec3::INFINITY
            },
            place_size: size(origin) + traveled_size,
            rest_to_observer,
            turn: DMat3::from_quat(rest_to_observer.rotation()),
            map: PhotosurfaceMap::new(&relative),
        }
    }

    /// The observer's velocity in the rest frame.
    pub fn relative_velocity(&self) -> Velocity {
        self.rest_to_observer.boost_velocity()
    }

    /// The observer's place in the rest frame; infinite where it is beyond `f64`.
    pub fn observer_rest(&self) -> DVec3 {
        self.observer_rest
    }

    /// How large the numbers are that [`View::observer_rest`] is a sum of: it is off by a few units in the last place of
    /// this, which may be more than of itself.
    pub(crate) fn place_size(&self) -> f64 {
        self.place_size
    }

    /// From the rest frame to where things *are* at the moment of observation, in the observer's frame: shortened
    /// along their motion (Lorentz, FitzGerald), which nobody sees.
    ///
    /// # Derivation
    ///
    /// A point at the offset `d` from the observer, at whatever time at rest, is at the observer's time 0 where its
    /// place along the motion is `d_par / gamma`; the rotation follows.
    pub fn rest_to_now(&self) -> DAffine3 {
        let velocity = self.relative_velocity();
        let shortened = velocity.rapidity().cosh().recip() - 1.0;
        let along = velocity.direction();
        let column = |axis: DVec3| self.turned(axis + along * (shortened * along.dot(axis)));
        let matrix = DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z));
        DAffine3::from_mat3_translation(matrix, -(matrix * self.observer_rest))
    }

    /// How the observer's axes are turned against those that the boost alone would give (Wigner, and the observer's own axes).
    pub fn rotation(&self) -> DQuat {
        self.rest_to_observer.rotation()
    }

    /// Where the point `position_rest` is seen, in the observer's frame: infinite where that is beyond `f64`, or where the
    /// point or the observer's place is.
    pub fn seen_position(&self, position_rest: DVec3) -> DVec3 {
        self.turned(self.map.seen_position(self.offset(position_rest)))
    }

    /// The unit normal there of a surface with the normal `normal_rest` at rest.
    pub fn seen_normal(&self, position_rest: DVec3, normal_rest: DVec3) -> DVec3 {
        self.turned(
            self.map
                .seen_normal(self.offset(position_rest), normal_rest),
        )
    }

    /// The unit tangent there of a surface with the tangent `tangent_rest` at rest.
    pub fn seen_tangent(&self, position_rest: DVec3, tangent_rest: DVec3) -> DVec3 {
        self.turned(
            self.map
                .seen_tangent(self.offset(position_rest), tangent_rest),
        )
    }

    /// Frequency seen over frequency emitted at the point `position_rest`.
    pub fn doppler_factor(&self, position_rest: DVec3) -> f64 {
        self.map.doppler_factor(self.offset(position_rest))
    }

    /// A bound of how much anything in the ball of `radius` about `position_rest` is stretched: how much
    /// farther apart, at most, two points of the ball are seen than they are at rest.
    pub fn stretch_bound(&self, position_rest: DVec3, radius: f64) -> f64 {
        // The rotation that follows the map stretches nothing. The offset is a difference that has been rounded: the true
        // ball is in one a little larger.
        let offset = self.offset(position_rest);
        let rounding = f64::EPSILON * length(offset);
        self.map.stretch_bound(offset, radius + rounding)
    }

    /// What grows with the stretch at a point: see [`View::stretch_toward`].
    pub(crate) fn forwardness(&self, position_rest: DVec3) -> f64 {
        self.map.forwardness(self.offset(position_rest))
    }

    /// How many times a small error of a position is magnified, at most, where [`View::forwardness`] is this.
    pub(crate) fn stretch_toward(&self, forwardness: f64) -> f64 {
        self.map.stretch_toward(forwardness)
    }

    /// The time, in the observer's frame, at which the light seen now left the point; not positive.
    pub fn emission_time(&self, position_rest: DVec3) -> f64 {
        self.map.emission_time(self.offset(position_rest))
    }

    /// How far away the point at `offset_rest` from the observer is seen.
    pub(crate) fn seen_distance(&self, offset_rest: DVec3) -> f64 {
        -self.map.emission_time(offset_rest)
    }

    pub(super) fn map(&self) -> &PhotosurfaceMap {
        &self.map
    }

    /// From the axes that the boost alone would give to those of the observer.
    pub(super) fn turn(&self) -> DMat3 {
        self.turn
    }

    fn offset(&self, position_rest: DVec3) -> DVec3 {
        position_rest - self.observer_rest
    }

    fn turned(&self, vector: DVec3) -> DVec3 {
        if !vector.is_finite() {
            // What is beyond f64 has no direction left to turn.
            return DVec3::INFINITY;
        }
        self.turn * vector
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Through the scene frame: the event at which a point at rest has the observer's time 0 is found by trial.
    #[test]
    fn things_are_now_where_two_boosts_put_them() {
        let velocity = |beta, direction| Velocity::from_beta(beta, direction).expect("below 1");
        let line = |time, position, velocity| WorldLine {
            origin: Event::new(time, position),
            velocity,
        };
        let observer = line(0.5, DVec3::new(1.0, 2.0, -3.0), velocity(0.6, DVec3::X));
        let object = line(0.0, DVec3::Y, velocity(0.8, DVec3::new(1.0, 2.0, -2.0)));
        let now = View::new(&observer.moment(0.75), &object).rest_to_now();
        let to_scene = Lorentz::boost(object.velocity.reversed());
        let to_observer = Lorentz::boost(observer.velocity);
        for place in [DVec3::ZERO, DVec3::new(1.0, -2.0, 0.5), DVec3::Z] {
            let seen = |time: f64| {
                let scene = object.origin + to_scene.apply(Event::new(time, place));
                to_observer.apply(scene - observer.at(0.75))
            };
            // The observer's time is linear in the time at rest.
            let (start, slope) = (seen(0.0).time, seen(1.0).time - seen(0.0).time);
            let event = seen(-start / slope);
            let found = now.transform_point3(place);
            assert!(event.time.abs() < 1e-13, "{event:?}");
            assert!(found.distance(event.position) < 1e-13, "{found} {event:?}");
        }
    }
}
