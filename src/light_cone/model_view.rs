//! How a moving observer is shown a moving object under a model: as the photosurface of a stand-in.

use glam::{DAffine3, DMat3, DVec3};

use super::View;
use crate::spacetime::ViewModel;

/// The largest relative rapidity at which a scene may show something under [`ViewModel::Delayed`]: its stand-in is `gamma`
/// times as long as the object, which costs as many digits as `gamma` has.
pub const MAX_DELAYED_RAPIDITY: f64 = 20.0;

/// How an observer is shown everything that moves along with one object, under a model.
///
/// # Derivation
///
/// Let `d` be the constant offset of a point from the observer's position, in the rest frame, and `d_par` its component
/// along the observer's motion. At time 0 in the observer's frame the point has the coordinate `d_par / gamma` along the
/// motion; without contraction that is `d_par`. So an object without contraction is, and is seen, where a contracted one
/// is whose `d_par` is `gamma` times as large:
///
/// ```text
/// delayed(d_par, d_perp) = seen(gamma d_par, d_perp)
/// contracted(d_par, d_perp) = (d_par / gamma, d_perp)
/// rest(d_par, d_perp) = (d_par, d_perp)
/// ```
///
/// each turned into the observer's axes. Each model is the view of a *stand-in*, the object stretched along the motion
/// about the observer, by an observer at rest or in motion. Gap, certificate and triangulation are those of the
/// stand-in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelView {
    view: View,
    model: ViewModel,
    /// From the rest frame of the object to the frame of its stand-in; none where the object is its own stand-in.
    rest_to_stand_in: Option<DAffine3>,
    /// The view of the stand-in, but for the rounding of its points.
    stand_in: View,
}

impl ModelView {
    /// The view of an object under a model.
    pub fn new(view: View, model: ViewModel) -> Self {
        let shown = Self {
            view,
            model,
            rest_to_stand_in: None,
            stand_in: match model.has_delay() {
                true => view,
                false => view.at_rest(),
            },
        };
        match shown.stretch() {
            1.0 => shown,
            stretch => {
                let matrix = shown.along_by(stretch);
                let origin = -(matrix * view.observer_rest());
                Self {
                    rest_to_stand_in: Some(DAffine3::from_mat3_translation(matrix, origin)),
                    stand_in: shown.stand_in.of_stand_in(stretch, 0.0),
                    ..shown
                }
            }
        }
    }

    /// The view of the object itself, whatever the model.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// The model.
    pub fn model(&self) -> ViewModel {
        self.model
    }

    /// How many times as long as the object its stand-in is along the motion.
    pub fn stretch(&self) -> f64 {
        let velocity = self.view.relative_velocity();
        match self.model {
            ViewModel::Seen | ViewModel::Rest => 1.0,
            ViewModel::Delayed => velocity.rapidity().cosh(),
            ViewModel::Contracted => velocity.rapidity().cosh().recip(),
        }
    }

    /// From the rest frame of the object to the frame of its stand-in, which has the observer at the origin; `None` where
    /// the object is its own stand-in.
    pub fn rest_to_stand_in(&self) -> Option<DAffine3> {
        self.rest_to_stand_in
    }

    /// The inverse of [`ModelView::rest_to_stand_in`].
    pub fn stand_in_to_rest(&self) -> Option<DAffine3> {
        self.rest_to_stand_in?;
        let matrix = self.along_by(self.stretch().recip());
        Some(DAffine3::from_mat3_translation(
            matrix,
            self.view.observer_rest(),
        ))
    }

    /// The matrix that multiplies the component along the motion.
    fn along_by(&self, factor: f64) -> DMat3 {
        let along = self.view.relative_velocity().direction();
        let column = |axis: DVec3| axis + along * ((factor - 1.0) * along.dot(axis));
        DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z))
    }

    /// The view of the stand-in, whose points are up to `reach` from the observer in the rest frame of the object.
    ///
    /// The positions of a stand-in are rounded: by a few units in the last place of `reach` and of the observer's
    /// position, each times the stretch. The view counts this to the size of its own observer's position.
    pub(crate) fn of_stand_in(&self, reach: f64) -> View {
        match self.rest_to_stand_in {
            None => self.stand_in,
            Some(_) => {
                let size = reach + 2.0 * self.view.place_size();
                let rounded = self.stretch().max(1.0) * size;
                self.stand_in.of_stand_in(self.stretch(), rounded)
            }
        }
    }

    /// Where the point `position_rest` is shown, in the observer's frame.
    pub fn shown_position(&self, position_rest: DVec3) -> DVec3 {
        let position = self.in_stand_in(position_rest);
        self.stand_in.seen_position(position)
    }

    /// Frequency seen over frequency emitted, at the point `position_rest`.
    ///
    /// Without light on its way, under [`ViewModel::Contracted`] and [`ViewModel::Rest`], it is 1. Where light takes time
    /// but nothing is contracted, under [`ViewModel::Delayed`], clocks are not slowed either: the factor is the classical
    /// one, `gamma` times the relativistic one in the same direction.
    pub fn doppler_factor(&self, position_rest: DVec3) -> f64 {
        self.stand_in_doppler_factor(self.in_stand_in(position_rest))
    }

    /// The same as [`ModelView::doppler_factor`] at a point of the stand-in.
    pub(crate) fn stand_in_doppler_factor(&self, position: DVec3) -> f64 {
        match self.model {
            ViewModel::Seen => self.view.doppler_factor(position),
            ViewModel::Delayed => self.stretch() * self.stand_in.doppler_factor(position),
            ViewModel::Contracted | ViewModel::Rest => 1.0,
        }
    }

    /// The time, in the observer's frame, at which the light left that shows a point of the stand-in, counted from the
    /// observation; 0 where light takes no time.
    pub(crate) fn stand_in_emission_time(&self, position: DVec3) -> f64 {
        match self.model.has_delay() {
            true => self.stand_in.emission_time(position),
            false => 0.0,
        }
    }

    fn in_stand_in(&self, position_rest: DVec3) -> DVec3 {
        match self.rest_to_stand_in {
            Some(to_stand_in) => to_stand_in.transform_point3(position_rest),
            None => position_rest,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spacetime::{Event, Lorentz, Moment, Velocity, WorldLine};

    fn view(observer: Velocity, object: Velocity) -> View {
        let moment = Moment::new(
            Event::new(0.5, DVec3::new(1.0, 2.0, -3.0)),
            Lorentz::boost(observer),
        );
        let line = WorldLine {
            origin: Event::new(0.0, DVec3::Y),
            velocity: object,
        };
        View::new(&moment, &line)
    }

    fn velocity(beta: f64, direction: DVec3) -> Velocity {
        Velocity::from_beta(beta, direction).expect("below 1")
    }

    const PLACES: [DVec3; 4] = [
        DVec3::ZERO,
        DVec3::new(1.0, -2.0, 0.5),
        DVec3::Z,
        DVec3::new(7.0, 0.25, -9.0),
    ];

    /// The models against solvers of their own definitions: a point that is at `q` now and moves with the object's
    /// velocity is seen where it was when its light left, found by bisection.
    #[test]
    fn models_are_what_their_definitions_say() {
        for (speed, direction) in [
            (0.0, DVec3::X),
            (0.3, DVec3::X),
            (0.9, DVec3::new(1.0, -1.0, 0.3)),
            (0.999, DVec3::NEG_Z),
        ] {
            let view = view(
                velocity(speed, direction),
                velocity(0.6, DVec3::new(0.2, 1.0, -0.4)),
            );
            let to_observer = DMat3::from_quat(view.rotation());
            let relative = view.relative_velocity();
            // The object moves the other way in the observer's frame.
            let motion = to_observer * (-relative.direction() * relative.beta());
            let show = |model| ModelView::new(view, model);
            for place in PLACES {
                let whole = to_observer * (place - view.observer_rest());
                let contracted = view.rest_to_now().transform_point3(place);
                let limit = 1e-13 * relative.gamma().powi(2) * (1.0 + whole.length());
                let near = |a: DVec3, b: DVec3| {
                    assert!(a.distance(b) <= limit, "{speed} {place}: {a} {b}")
                };
                near(show(ViewModel::Rest).shown_position(place), whole);
                near(
                    show(ViewModel::Contracted).shown_position(place),
                    contracted,
                );
                near(
                    show(ViewModel::Seen).shown_position(place),
                    delayed(contracted, motion),
                );
                near(
                    show(ViewModel::Delayed).shown_position(place),
                    delayed(whole, motion),
                );
            }
        }
    }

    /// Where a point is seen that is at `now` and moves with velocity `motion`: by bisection of the time its light needs.
    fn delayed(now: DVec3, motion: DVec3) -> DVec3 {
        let late = |time: f64| (now - motion * time).length() - time;
        let (mut low, mut high) = (0.0, 1.0);
        while late(high) > 0.0 {
            high *= 2.0;
        }
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if late(middle) > 0.0 {
                low = middle
            } else {
                high = middle
            }
        }
        now - motion * high
    }

    /// Differences of the time between signals that leave at equal intervals of scene time.
    #[test]
    fn the_classical_doppler_factor_is_the_rate_at_which_signals_arrive() {
        let relative = velocity(0.8, DVec3::new(1.0, 0.5, 0.0));
        let view = view(relative, Velocity::ZERO);
        let shown = ModelView::new(view, ViewModel::Delayed);
        let motion = DMat3::from_quat(view.rotation()) * (-relative.direction() * relative.beta());
        for place in PLACES {
            let seen = shown.shown_position(place);
            // A signal that leaves `later` arrives so much later, less what it has come nearer.
            let later = 1e-6;
            let arrives = later + (seen + motion * later).length() - seen.length();
            let found = shown.doppler_factor(place);
            assert!(
                (found * arrives / later - 1.0).abs() < 1e-6,
                "{place}: {found}"
            );
        }
    }

    /// Distances between shown points against the bound, and the bound of a tiny ball against the slope itself.
    #[test]
    fn no_two_points_of_a_facet_are_shown_farther_apart_than_bounded() {
        for (beta, model) in [0.3, 0.9, 0.999, 0.999_999]
            .iter()
            .flat_map(|&beta| ViewModel::ALL.map(|model| (beta, model)))
        {
            let view = view(velocity(beta, DVec3::new(1.0, -1.0, 0.3)), Velocity::ZERO);
            let shown = ModelView::new(view, model);
            let to_stand_in = |place| {
                shown
                    .rest_to_stand_in()
                    .map_or(place, |there| there.transform_point3(place))
            };
            for place in PLACES {
                for size in [1e-4, 0.3] {
                    let corners = [DVec3::X, DVec3::Y, DVec3::new(-0.5, -1.0, 0.7)]
                        .map(|corner| place + size * corner);
                    let bound = shown
                        .of_stand_in(20.0)
                        .facet_stretch_bound(corners.map(to_stand_in));
                    let mut largest = 0.0_f64;
                    for step in 0..400 {
                        let turn = |by: f64| (f64::from(step) * by).fract() - 0.5;
                        let ends = [[0.618, 0.414, 0.732], [0.236, 0.317, 0.162]]
                            .map(|by| place + size * DVec3::from(by.map(turn)));
                        let [a, b] = ends.map(|end| shown.shown_position(end));
                        largest = largest.max(a.distance(b) / ends[0].distance(ends[1]));
                    }
                    assert!(
                        // Differences of rounded places.
                        largest <= bound * (1.0 + 1e-9),
                        "{model} {beta} {place} {size}: {largest} {bound}"
                    );
                    assert!(
                        size > 0.1 || bound <= 1.5 * largest,
                        "{model} {beta} {place}: {largest} {bound}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_stand_in_goes_there_and_back() {
        let view = view(velocity(0.9, DVec3::new(1.0, -1.0, 0.3)), Velocity::ZERO);
        for model in ViewModel::ALL {
            let shown = ModelView::new(view, model);
            let there = shown.rest_to_stand_in();
            assert_eq!(
                there.is_some(),
                matches!(model, ViewModel::Delayed | ViewModel::Contracted)
            );
            if let (Some(there), Some(back)) = (there, shown.stand_in_to_rest()) {
                for place in PLACES {
                    let again = back.transform_point3(there.transform_point3(place));
                    assert!(again.distance(place) < 1e-13, "{model}: {again}");
                }
            }
        }
        // At rest to each other every model is the object itself.
        let still = View::new(
            &Moment::new(Event::default(), Lorentz::IDENTITY),
            &WorldLine {
                origin: Event::default(),
                velocity: Velocity::ZERO,
            },
        );
        for model in ViewModel::ALL {
            assert_eq!(
                ModelView::new(still, model).shown_position(PLACES[1]),
                PLACES[1]
            );
        }
    }
}
