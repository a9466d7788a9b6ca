//! How a moving observer sees a moving object: from a moment of the observer and the object's worldline to the
//! photosurface map.

use glam::{DAffine3, DMat3, DQuat, DVec3};
use rayon::prelude::*;

use super::PhotosurfaceMap;
use crate::spacetime::{Event, Lorentz, Moment, Velocity, WorldLine, length};

/// How an observer sees, at one event, everything that moves along with one object.
///
/// Two frames are used. The *rest frame* of the object has the object's origin at its origin, and axes that a pure
/// boost makes from the axes of the scene. The *observer's frame* has the observer at its origin, and the observer's
/// own axes.
///
/// # Derivation
///
/// The observer's position in the rest frame is the boosted difference between the origins of the moment and of the
/// worldline, plus the moment's displacement in the rest frame. The difference is computed from the given numbers
/// before any multiplication by `gamma`, and its rounding error is kept. The transformations from the rest frame to the
/// scene and from the scene to the observer's frame are together one boost followed by a rotation. The photosurface map
/// includes the boost; the rotation combines Wigner's rotation with that of the observer's axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    observer_rest: DVec3,
    /// Sum of the sizes of the terms whose sum is the observer's position.
    place_size: f64,
    rest_to_observer: Lorentz,
    /// The rotation that follows the boost, as a matrix.
    turn: DMat3,
    map: PhotosurfaceMap,
    /// How many times as long along the motion what is viewed is as what it stands for.
    elongation: f64,
}

impl View {
    /// How the observer of `moment` sees everything that moves along with `object`.
    ///
    /// If an event of `moment` or `object` is not finite, the observer is infinitely far away and sees everything at
    /// infinity.
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
            // Beyond f64 infinities may have cancelled to NaN.
            observer_rest: if place.is_finite() {
                place
            } else {
                DVec3::INFINITY
            },
            place_size: size(origin) + traveled_size,
            rest_to_observer,
            turn: DMat3::from_quat(rest_to_observer.rotation()),
            map: PhotosurfaceMap::new(&relative),
            elongation: 1.0,
        }
    }

    /// The observer's velocity in the object's rest frame.
    pub fn relative_velocity(&self) -> Velocity {
        self.rest_to_observer.boost_velocity()
    }

    /// The observer's position in the rest frame; infinite if it is beyond `f64`.
    pub fn observer_rest(&self) -> DVec3 {
        self.observer_rest
    }

    /// The sum of the sizes of the terms whose sum is [`View::observer_rest`]. The error of that position is a few
    /// units in the last place of this number, which may be much larger than the position itself.
    pub(crate) fn place_size(&self) -> f64 {
        self.place_size
    }

    /// The view of an observer at the same place, with the same axes, for whom light takes no time: everything is shown at
    /// its offset in the rest frame.
    pub(super) fn at_rest(&self) -> Self {
        let unmoved = Lorentz::IDENTITY.turned_by(self.rotation());
        Self {
            rest_to_observer: unmoved,
            map: PhotosurfaceMap::new(&Velocity::ZERO),
            ..*self
        }
    }

    /// The same view of a stand-in that is `elongation` times as long along the motion, given relative to the observer, each
    /// point rounded by a few units in the last place of `place_size`.
    pub(super) fn of_stand_in(&self, elongation: f64, place_size: f64) -> Self {
        Self {
            observer_rest: DVec3::ZERO,
            place_size,
            elongation,
            ..*self
        }
    }

    /// An upper bound on the stretch at all of these points and between them.
    pub(crate) fn largest_stretch_at(&self, positions_rest: &[DVec3]) -> f64 {
        let forwardness = positions_rest
            .par_iter()
            .map(|&place| self.forwardness(place));
        let farthest = forwardness.reduce(|| 0.0, f64::max);
        // All directions within a right angle from behind are a convex cone, those of a wider angle are not.
        match farthest < 1.0 {
            true => self.stretch_toward(farthest * (1.0 + 16.0 * f64::EPSILON)),
            false => self.relative_velocity().stretch(),
        }
    }

    /// The map from the rest frame to where points *are*, in the observer's frame, at the moment of observation.
    /// Objects are contracted along their motion there (Lorentz, FitzGerald), which nobody sees.
    ///
    /// # Derivation
    ///
    /// Let `d` be the constant offset of a point from the observer's position, in the rest frame. At time 0 in the
    /// observer's frame the coordinate of the point along the motion is `d_par / gamma`; the coordinates across the
    /// motion are unchanged. The rotation follows.
    pub fn rest_to_now(&self) -> DAffine3 {
        let velocity = self.relative_velocity();
        let shortened = velocity.rapidity().cosh().recip() - 1.0;
        let along = velocity.direction();
        let column = |axis: DVec3| self.turned(axis + along * (shortened * along.dot(axis)));
        let matrix = DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z));
        DAffine3::from_mat3_translation(matrix, -(matrix * self.observer_rest))
    }

    /// The rotation between the axes that the boost alone would give and the observer's axes: Wigner's rotation and
    /// that of the observer's own axes.
    pub fn rotation(&self) -> DQuat {
        self.rest_to_observer.rotation()
    }

    /// Where the point `position_rest` is seen, in the observer's frame. The result is infinite if it is beyond `f64`,
    /// or if the point or the observer's position is not finite.
    pub fn seen_position(&self, position_rest: DVec3) -> DVec3 {
        self.turned(self.map.seen_position(self.offset(position_rest)))
    }

    /// The unit normal of the photosurface, in the observer's frame, where the point `position_rest` is seen; the
    /// surface has the normal `normal_rest` there in the rest frame.
    pub fn seen_normal(&self, position_rest: DVec3, normal_rest: DVec3) -> DVec3 {
        self.turned(
            self.map
                .seen_normal(self.offset(position_rest), normal_rest),
        )
    }

    /// The unit tangent of the photosurface, in the observer's frame, where the point `position_rest` is seen; the
    /// surface has the tangent `tangent_rest` there in the rest frame.
    pub fn seen_tangent(&self, position_rest: DVec3, tangent_rest: DVec3) -> DVec3 {
        self.turned(
            self.map
                .seen_tangent(self.offset(position_rest), tangent_rest),
        )
    }

    /// The Doppler factor at the point `position_rest`: the frequency seen divided by the frequency emitted.
    pub fn doppler_factor(&self, position_rest: DVec3) -> f64 {
        self.map.doppler_factor(self.offset(position_rest))
    }

    /// An upper bound on the stretch in the ball of `radius` around `position_rest`, both in the rest frame: how many
    /// times farther apart two points of the ball are seen than they are at rest.
    pub fn stretch_bound(&self, position_rest: DVec3, radius: f64) -> f64 {
        // The rotation that follows the map stretches nothing. The offset is a rounded difference, so the radius is
        // enlarged until the ball contains the true one.
        let offset = self.offset(position_rest);
        let rounding = f64::EPSILON * length(offset);
        self.map.stretch_bound(offset, radius + rounding)
    }

    /// An upper bound on how many times farther apart two points are shown than they are at rest, in the [`facet_ball`] of a
    /// triangle. For a triangle of a stand-in, ball and distances are those of what it stands for.
    pub(crate) fn facet_stretch_bound(&self, corners: [DVec3; 3]) -> f64 {
        if self.elongation == 1.0 {
            let (middle, radius) = facet_ball(corners);
            return self.stretch_bound(middle, radius);
        }
        let along = self.relative_velocity().direction();
        let shorter = self.elongation.recip() - 1.0;
        let at_rest = corners.map(|corner| corner + along * (shorter * along.dot(corner)));
        let (middle, radius) = facet_ball(at_rest);
        let rounding = 4.0 * f64::EPSILON * length(middle);
        self.map
            .elongated_stretch_bound(self.elongation, middle, radius + rounding)
    }

    /// How many times as long along the motion what is viewed is as what it stands for.
    pub(crate) fn elongation(&self) -> f64 {
        self.elongation
    }

    /// A number that grows with the stretch at a point: the argument of [`View::stretch_toward`].
    pub(crate) fn forwardness(&self, position_rest: DVec3) -> f64 {
        self.map.forwardness(self.offset(position_rest))
    }

    /// How many times, at most, the map magnifies a small error of a position with this [`View::forwardness`].
    pub(crate) fn stretch_toward(&self, forwardness: f64) -> f64 {
        self.map.stretch_toward(forwardness)
    }

    /// The time, in the observer's frame, at which the light seen now left the point, counted from the observation;
    /// never positive.
    pub fn emission_time(&self, position_rest: DVec3) -> f64 {
        self.map.emission_time(self.offset(position_rest))
    }

    /// The distance, in the observer's frame, at which a point is seen that has the offset `offset_rest` from the
    /// observer in the rest frame.
    pub(crate) fn seen_distance(&self, offset_rest: DVec3) -> f64 {
        -self.map.emission_time(offset_rest)
    }

    pub(super) fn map(&self) -> &PhotosurfaceMap {
        &self.map
    }

    /// The rotation from the axes that the boost alone would give to the observer's axes.
    pub(super) fn turn(&self) -> DMat3 {
        self.turn
    }

    fn offset(&self, position_rest: DVec3) -> DVec3 {
        position_rest - self.observer_rest
    }

    fn turned(&self, vector: DVec3) -> DVec3 {
        if !vector.is_finite() {
            // A vector beyond f64 has no direction that could be turned.
            return DVec3::INFINITY;
        }
        self.turn * vector
    }
}

/// Centre and radius of a ball around the centroid of a triangle that reaches twice as far as the corners, and so contains a
/// curved surface through the corners.
pub(crate) fn facet_ball([a, b, c]: [DVec3; 3]) -> (DVec3, f64) {
    let middle = (a + b + c) / 3.0;
    let reach = [a, b, c]
        .map(|corner| corner.distance(middle))
        .into_iter()
        .fold(0.0, f64::max);
    (middle, 2.0 * reach)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The reference goes through the scene frame and solves for the event at which a point at rest has time 0 in the
    /// observer's frame.
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
            // The time in the observer's frame is a linear function of the time in the rest frame.
            let (start, slope) = (seen(0.0).time, seen(1.0).time - seen(0.0).time);
            let event = seen(-start / slope);
            let found = now.transform_point3(place);
            assert!(event.time.abs() < 1e-13, "{event:?}");
            assert!(found.distance(event.position) < 1e-13, "{found} {event:?}");
        }
    }
}
