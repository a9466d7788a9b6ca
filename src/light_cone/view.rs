//! How an observer in motion sees something else in motion: from two worldlines to the photosurface map.

use glam::DVec3;

use super::PhotosurfaceMap;
use crate::spacetime::{Lorentz, Velocity, WorldLine};

/// How an observer sees, at one event, everything that moves with one velocity.
///
/// Two frames are spoken of: the *rest frame* of the object, with the object's origin at its origin, and
/// the *observer's frame*, with the observer there. The axes of both are those of the scene under a pure
/// boost.
///
/// # Derivation
///
/// The observer's place in the rest frame is the boosted difference of the two worldlines' origins, plus
/// the proper time times the observer's four-velocity in the rest frame: differences are taken of numbers
/// as they are given, before anything is multiplied by `gamma`. The boosts from rest frame to scene and
/// from scene to observer together are one boost, which the photosurface map takes care of, and a
/// rotation (Wigner's), which follows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    observer_rest: DVec3,
    rest_to_observer: Lorentz,
    map: PhotosurfaceMap,
}

impl View {
    /// How `observer`, at `proper_time` on its worldline, sees what moves along with `object`.
    pub fn new(observer: &WorldLine, object: &WorldLine, proper_time: f64) -> Self {
        let rest_to_observer = Lorentz::between(object.velocity, observer.velocity);
        let relative = rest_to_observer.boost_velocity();
        let observer_in_rest_frame = WorldLine {
            origin: Lorentz::boost(object.velocity).apply(observer.origin - object.origin),
            velocity: relative,
        };
        Self {
            observer_rest: observer_in_rest_frame.at(proper_time).position,
            rest_to_observer,
            map: PhotosurfaceMap::new(&relative),
        }
    }

    /// The observer's velocity in the rest frame.
    pub fn relative_velocity(&self) -> Velocity {
        self.rest_to_observer.boost_velocity()
    }

    /// The observer's place in the rest frame.
    pub fn observer_rest(&self) -> DVec3 {
        self.observer_rest
    }

    /// Where the point `position_rest` is seen, in the observer's frame.
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
        // The rotation that follows the map stretches nothing.
        self.map.stretch_bound(self.offset(position_rest), radius)
    }

    /// The time, in the observer's frame, at which the light seen now left the point; not positive.
    pub fn emission_time(&self, position_rest: DVec3) -> f64 {
        self.map.emission_time(self.offset(position_rest))
    }

    /// How far away the point at `offset_rest` from the observer is seen.
    pub(crate) fn seen_distance(&self, offset_rest: DVec3) -> f64 {
        -self.map.emission_time(offset_rest)
    }

    fn offset(&self, position_rest: DVec3) -> DVec3 {
        position_rest - self.observer_rest
    }

    fn turned(&self, vector: DVec3) -> DVec3 {
        self.rest_to_observer.rotation() * vector
    }
}
