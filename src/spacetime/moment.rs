//! What an observer is at one instant.

use std::sync::Arc;

use glam::DVec3;

use super::{Event, Lorentz, Rotation, Velocity, WorldLine};

/// What an observer is at one instant: event, velocity and axes.
///
/// All that is seen follows from a moment and the worldlines of what there is to see; whether the observer coasts or
/// flies, before and after, does not matter. An event, a displacement or a proper time that is not finite makes a moment
/// whose observer is infinitely far from everything.
///
/// # Accuracy
///
/// The event is kept as the *origin*, in the scene frame as it was given, and the *displacement* from there: for each
/// leg of the way in the observer's own frame when the leg began. Nothing is multiplied by `gamma` before differences
/// are taken: an observer beside a fast object moves far in the scene and little in the object's rest frame, to which
/// each leg is carried at once (`tests/it/physics/moving_objects.rs`).
///
/// # Example
///
/// ```
/// use photosurface::spacetime::{Event, Lorentz};
/// use photosurface::{DVec3, Moment, Velocity};
///
/// let velocity = Velocity::from_beta(0.6, DVec3::X)?;
/// let start = Moment::new(Event::default(), Lorentz::boost(velocity));
/// let later = start.coasted(4.0).event();
/// assert!((later.time - 5.0).abs() < 1e-14 && (later.position.x - 3.0).abs() < 1e-14);
/// # Ok::<(), photosurface::spacetime::VelocityError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    origin: Event,
    way: Vec<Way>,
    scene_to_observer: Lorentz,
}

/// A part of an observer's way.
#[derive(Clone, Debug, PartialEq)]
enum Way {
    Leg(Leg),
    /// So many legs, the first ones of a flight.
    Legs(Arc<[Leg]>, usize),
}

/// A displacement, given in a frame in which it is not much longer than need be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Leg {
    scene_to_frame: Lorentz,
    displacement_frame: Event,
}

impl Moment {
    /// An observer at `event` of the scene frame, with the velocity and the axes of `scene_to_observer`.
    pub fn new(event: Event, scene_to_observer: Lorentz) -> Self {
        Self {
            origin: event,
            way: vec![],
            scene_to_observer,
        }
    }

    /// The observer after `proper_time` of coasting, axes unturned.
    #[must_use]
    pub fn coasted(&self, proper_time: f64) -> Self {
        let rest = Event::new(proper_time, DVec3::ZERO);
        let leg = Leg::new(self.scene_to_observer, rest);
        self.with_legs([leg], self.scene_to_observer)
    }

    /// The observer after a flight that leads to `displacement_own` and into the frame behind `own_to_next`, both in the
    /// observer's frame at this moment.
    #[must_use]
    pub fn flown(&self, displacement_own: Event, own_to_next: &Lorentz) -> Self {
        let leg = Leg::new(self.scene_to_observer, displacement_own);
        let scene_to_next = self.scene_to_observer.then(own_to_next);
        self.with_legs([leg], scene_to_next)
    }

    /// The observer after these legs, in the frame of `scene_to_observer`.
    fn with_legs(&self, legs: impl IntoIterator<Item = Leg>, scene_to_observer: Lorentz) -> Self {
        let mut way = self.way.clone();
        way.extend(legs.into_iter().map(Way::Leg));
        Self {
            origin: self.origin,
            way,
            scene_to_observer,
        }
    }

    /// The observer after the first `count` legs of a flight and some more, in the frame of `scene_to_observer`.
    pub(super) fn along(
        &self,
        flight: &Arc<[Leg]>,
        count: usize,
        legs: impl IntoIterator<Item = Leg>,
        scene_to_observer: Lorentz,
    ) -> Self {
        let mut later = self.clone();
        if count > 0 {
            later.way.push(Way::Legs(flight.clone(), count));
        }
        later.with_legs(legs, scene_to_observer)
    }

    /// The observer with other axes: those of now, turned by `rotation`, which is given in them.
    ///
    /// What was seen in the direction `rotation * v` is then seen in the direction `v`.
    #[must_use]
    pub fn turned(&self, rotation: Rotation) -> Self {
        let back = rotation.get().inverse();
        Self {
            scene_to_observer: self.scene_to_observer.turned_by(back),
            ..self.clone()
        }
    }

    /// The event from which the way to this moment is counted, in the scene frame, as it was given.
    pub fn origin(&self) -> Event {
        self.origin
    }

    /// The event in the scene frame, rounded to the digits that it has there.
    pub fn event(&self) -> Event {
        let way = self.displacements_in(Velocity::ZERO);
        way.fold(self.origin, |event, leg| event + leg)
    }

    /// The observer's velocity in the scene frame.
    pub fn velocity(&self) -> Velocity {
        self.scene_to_observer.boost_velocity()
    }

    /// The direction in which the observer moves in the scene, as a unit vector in its own axes: where aberration crowds the
    /// sky. `None` at rest.
    pub fn heading_own(&self) -> Option<DVec3> {
        let scene = self.scene_to_observer.inverse().boost_velocity();
        (scene.rapidity() > 0.0).then(|| -scene.direction())
    }

    /// The observer's own axes x, y, z, as differences of events in the scene frame: each of length 1, and at the same time
    /// in the observer's frame.
    pub fn axes(&self) -> [Event; 3] {
        let back = self.scene_to_observer.inverse();
        DVec3::AXES.map(|axis| back.apply(Event::new(0.0, axis)))
    }

    /// From the scene frame to the observer's: the velocity, and how the axes are turned after that boost.
    pub fn scene_to_observer(&self) -> Lorentz {
        self.scene_to_observer
    }

    /// From the rest frame of something that moves with `velocity` to the observer's, its axes those of the scene under
    /// a pure boost.
    pub fn rest_to_observer(&self, velocity: Velocity) -> Lorentz {
        Lorentz::boost(velocity.reversed()).then(&self.scene_to_observer)
    }

    /// The event of the observation in the rest frame of `line`, counted from the event at which that has proper time 0.
    ///
    /// Differences are taken of the events as they are given, before anything grows by `gamma`.
    pub(crate) fn event_at_rest_with(&self, line: &WorldLine) -> Event {
        let start = Lorentz::boost(line.velocity).apply(self.origin() - line.origin);
        let way = self.displacements_in(line.velocity);
        way.fold(start, |event, leg| event + leg)
    }

    /// The displacement from [`Moment::origin`], leg by leg, in the rest frame of something that moves with `velocity`.
    pub(crate) fn displacements_in(&self, velocity: Velocity) -> impl Iterator<Item = Event> {
        let legs = self.way.iter().flat_map(|part| match part {
            Way::Leg(leg) => std::slice::from_ref(leg),
            Way::Legs(legs, count) => &legs[..*count],
        });
        legs.map(move |leg| leg.in_rest_frame(velocity))
    }
}

impl Leg {
    pub(super) fn new(scene_to_frame: Lorentz, displacement_frame: Event) -> Self {
        Self {
            scene_to_frame,
            displacement_frame,
        }
    }

    /// Whether the leg leads nowhere.
    pub(super) fn is_empty(&self) -> bool {
        self.displacement_frame == Event::default()
    }

    /// This leg and `next` as one, in this leg's frame; `None` if the rapidity between their frames is above
    /// `max_rapidity`.
    pub(super) fn with(&self, next: &Self, max_rapidity: f64) -> Option<Self> {
        let next_to_this = next.scene_to_frame.inverse().then(&self.scene_to_frame);
        let near = next_to_this.boost_velocity().rapidity() <= max_rapidity;
        near.then(|| Self {
            displacement_frame: self.displacement_frame
                + next_to_this.apply(next.displacement_frame),
            ..*self
        })
    }

    /// This leg and `next` as one, in the scene frame.
    pub(super) fn with_in_scene(&self, next: &Self) -> Self {
        let [this, next] = [self, next].map(|leg| leg.in_rest_frame(Velocity::ZERO));
        Self::new(Lorentz::IDENTITY, this + next)
    }

    /// The displacement in the rest frame of something that moves with `velocity`.
    fn in_rest_frame(&self, velocity: Velocity) -> Event {
        let rest_to_frame = Lorentz::boost(velocity.reversed()).then(&self.scene_to_frame);
        let frame = rest_to_frame.boost_velocity();
        let Event { time, position } = self.displacement_frame;
        if position == DVec3::ZERO {
            // A clock alone: as many digits at any speed, also at one that adds next to nothing to 1.
            return frame.four_velocity() * time;
        }
        // The turn is undone first: so the boost back is along the velocity as it was given.
        let boosted = Event::new(time, rest_to_frame.rotation().inverse() * position);
        Lorentz::boost(frame.reversed()).apply(boosted)
    }
}

impl WorldLine {
    /// The observer at `proper_time`, its axes those of the frame of `origin` under a pure boost.
    pub fn moment(&self, proper_time: f64) -> Moment {
        Moment::new(self.origin, Lorentz::boost(self.velocity)).coasted(proper_time)
    }
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;

    fn rotation(turn: DQuat) -> Rotation {
        Rotation::new(turn).expect("a unit quaternion")
    }

    fn velocity(rapidity: f64, direction: DVec3) -> Velocity {
        Velocity::from_rapidity(rapidity, direction).expect("not too fast")
    }

    /// A length in time and space of two events' difference.
    fn apart(a: Event, b: Event) -> f64 {
        (a.time - b.time).abs() + a.position.distance(b.position)
    }

    /// Thrust of 1 straight ahead for a proper time: the hyperbola `(sinh, cosh - 1)`.
    fn thrust(moment: &Moment, direction: DVec3, proper_time: f64) -> Moment {
        let way = direction * (proper_time.cosh() - 1.0);
        let boost = Lorentz::boost(velocity(proper_time, direction));
        moment.flown(Event::new(proper_time.sinh(), way), &boost)
    }

    #[test]
    fn legs_add_up_to_the_way_they_are_parts_of() {
        let start = velocity(1.5, DVec3::new(1.0, -2.0, 0.5));
        let origin = Event::new(0.5, DVec3::new(3.0, 1.0, -1.0));
        let start = Moment::new(origin, Lorentz::boost(start))
            .turned(rotation(DQuat::from_rotation_y(0.7)));
        let coasted = start.coasted(1.25).coasted(-3.0);
        assert!(apart(coasted.event(), start.coasted(-1.75).event()) < 1e-14);
        let ahead = DVec3::new(0.6, 0.0, -0.8);
        let (halves, whole) = (
            thrust(&thrust(&start, ahead, 0.75), ahead, 0.5),
            thrust(&start, ahead, 1.25),
        );
        assert!(apart(halves.event(), whole.event()) < 1e-13);
        let frames = (halves.scene_to_observer(), whole.scene_to_observer());
        assert!(
            (frames.0.boost_velocity().rapidity() - frames.1.boost_velocity().rapidity()).abs()
                < 1e-14
        );
        assert!(frames.0.rotation().angle_between(frames.1.rotation()) < 1e-7);
    }

    /// From rest at the origin, turned axes: ahead in own axes is where `scene_to_observer` has it.
    #[test]
    fn thrust_is_in_the_observers_own_axes() {
        let left = DQuat::from_rotation_y(0.5 * std::f64::consts::PI);
        let start = Moment::new(Event::default(), Lorentz::IDENTITY).turned(rotation(left));
        let flown = thrust(&start, DVec3::NEG_Z, 1.0);
        let expected = Event::new(1f64.sinh(), DVec3::NEG_X * (1f64.cosh() - 1.0));
        assert!(apart(flown.event(), expected) < 1e-15);
        assert!(flown.velocity().direction().distance(DVec3::NEG_X) < 1e-15);
        // Its own axes are turned as before.
        let ahead = flown.scene_to_observer().apply(Event::new(0.0, DVec3::Y));
        assert!(ahead.position.distance(DVec3::Y) < 1e-15);
    }

    /// Beside something as fast as the observer a short way stays short, though it is long in the scene.
    #[test]
    fn a_way_beside_something_fast_keeps_its_digits() {
        let fast = velocity(30.0, DVec3::new(1.0, 2.0, -2.0));
        let start = Moment::new(Event::default(), Lorentz::boost(fast));
        let flown = thrust(&start.coasted(0.25), DVec3::Y, 0.5);
        let way = flown.displacements_in(fast);
        let way = way.fold(Event::default(), |event, leg| event + leg);
        let expected = Event::new(0.25 + 0.5f64.sinh(), DVec3::Y * (0.5f64.cosh() - 1.0));
        assert!(apart(way, expected) < 1e-15, "{way:?}");
        assert!(flown.event().time > 1e12);
    }
}
