//! What holds for every observer and every point, tried on numbers that hurt: near light speed, near the
//! observer, on and next to the line of motion, neighbouring floats, signed zeros, subnormal and huge.
//!
//! Limits are those of `common/mod.rs`: `RELATIVE` for roundings in a row, `TURN` for directions.

use std::f64::consts::PI;

use crate::common::{RELATIVE, TURN, cases, normal_limit};
use photosurface::light_cone::PhotosurfaceMap;
use photosurface::spacetime::MAX_RAPIDITY;
use photosurface::{DVec3, Velocity};
use proptest::prelude::*;

/// An observer and a point, as a user may give them and as bad luck does.
#[derive(Clone, Copy, Debug)]
struct Case {
    observer: Velocity,
    offset: DVec3,
    along_axis: bool,
}

impl Case {
    fn map(&self) -> PhotosurfaceMap {
        PhotosurfaceMap::new(&self.observer)
    }

    fn distance(&self) -> f64 {
        self.offset.length()
    }

    /// Sine of the angle between offset and motion; not smaller than it can be known.
    fn sin_theta(&self) -> f64 {
        let sine = self.observer.direction().cross(self.offset).length() / self.distance();
        sine + self.turn()
    }

    fn turn(&self) -> f64 {
        if self.along_axis { 0.0 } else { TURN }
    }

    /// How far from the truth the point may be seen.
    fn position_limit(&self) -> f64 {
        let distance_seen = self.map().doppler_factor(self.offset) * self.distance();
        let swing = 1.0 + (self.observer.gamma() - 1.0) * self.sin_theta();
        RELATIVE * distance_seen + self.turn() * self.distance() * swing
    }
}

fn axis() -> impl Strategy<Value = DVec3> {
    prop::sample::select(vec![
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        DVec3::NEG_X,
        DVec3::NEG_Y,
        DVec3::NEG_Z,
        DVec3::new(-0.0, 1.0, -0.0),
    ])
}

fn direction() -> impl Strategy<Value = DVec3> {
    (-1.0..1.0f64, 0.0..2.0 * PI).prop_map(|(height, around)| {
        let across = ((1.0 - height) * (1.0 + height)).sqrt();
        DVec3::new(across * around.cos(), height, across * around.sin())
    })
}

/// From 0 to `most`: slow, moderate, fast, and the ends.
fn rapidity(most: f64) -> impl Strategy<Value = f64> {
    prop_oneof![
        1 => Just(0.0),
        1 => Just(most),
        1 => Just(most.next_down()),
        1 => Just(5e-324),
        1 => 1e-20..1e-3f64,
        4 => 0.0..most.min(3.0),
        4 => 0.0..most,
    ]
}

/// Angles from the direction of motion: any, straight ahead and behind, and next to these.
fn angle() -> impl Strategy<Value = f64> {
    prop_oneof![
        1 => Just(0.0),
        1 => Just(PI),
        1 => Just(0.5 * PI),
        3 => 0.0..PI,
        2 => (-16.0..0.0f64).prop_map(|exponent| 10f64.powf(exponent)),
        2 => (-16.0..0.0f64).prop_map(|exponent| PI - 10f64.powf(exponent)),
    ]
}

/// An observer of at most the rapidity `most`, and a point 1e-9 to 1e9 away.
fn case(most: f64, any_direction: bool) -> impl Strategy<Value = Case> {
    let axes = axis().prop_map(|axis| (axis, true)).boxed();
    let directions = if any_direction {
        let any = direction().prop_map(|direction| (direction, false));
        prop_oneof![axes, any].boxed()
    } else {
        axes
    };
    (
        directions,
        rapidity(most),
        angle(),
        direction(),
        -9.0..9.0f64,
    )
        .prop_map(
            |((direction, along_axis), rapidity, angle, aside, exponent)| {
                let observer = Velocity::from_rapidity(rapidity, direction).expect("valid");
                let n = observer.direction();
                let aside = n.cross(aside).normalize_or(n.any_orthonormal_vector());
                let sine = if angle == PI { 0.0 } else { angle.sin() };
                Case {
                    observer,
                    offset: (n * angle.cos() + aside * sine) * 10f64.powf(exponent),
                    along_axis,
                }
            },
        )
}

/// Numbers from signed zero over the subnormal ones to 1e150; results stay below 1e303 then.
fn nasty_number() -> impl Strategy<Value = f64> {
    let size = prop_oneof![
        Just(0.0),
        Just(5e-324),
        Just(f64::MIN_POSITIVE),
        Just(f64::MIN_POSITIVE.next_down()),
        Just(1.0),
        Just(1f64.next_up()),
        Just(1e150),
        (-320.0..150.0f64).prop_map(|exponent| 10f64.powf(exponent)),
        0.5..2.0f64,
    ];
    (size, any::<bool>()).prop_map(|(size, negative)| if negative { -size } else { size })
}

fn nasty_vector() -> impl Strategy<Value = DVec3> {
    (nasty_number(), nasty_number(), nasty_number()).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

proptest! {
    #![proptest_config(cases(2000))]

    #[test]
    fn nothing_is_ever_nan(
        direction in nasty_vector().prop_filter("a direction", |vector| *vector != DVec3::ZERO),
        rapidity in rapidity(MAX_RAPIDITY),
        offset in nasty_vector(),
        normal in nasty_vector(),
    ) {
        let observer = Velocity::from_rapidity(rapidity, direction).expect("valid");
        prop_assert!((observer.direction().length() - 1.0).abs() <= 2.0 * f64::EPSILON);
        let map = PhotosurfaceMap::new(&observer);
        let seen = map.seen_position(offset);
        prop_assert!(seen.is_finite());
        prop_assert!(map.rest_offset(offset).is_finite());
        prop_assert!(map.emission_time(offset) <= 0.0);
        let doppler = map.doppler_factor(offset);
        let widest = rapidity.exp() * (1.0 + RELATIVE);
        prop_assert!(doppler <= widest && doppler * widest >= 1.0, "D = {doppler}");
        prop_assert!(map.jacobian(offset).is_finite());
        let bound = map.stretch_bound(offset, normal.x);
        prop_assert!(bound >= 1.0 && bound <= widest, "stretched by {bound}");
        for unit in [map.seen_normal(offset, normal), map.seen_tangent(offset, normal)] {
            let expected = if normal == DVec3::ZERO { 0.0 } else { 1.0 };
            // Where a vector is so small that it vanishes on the way, it stays zero.
            let vanished = unit == DVec3::ZERO && normal.abs().max_element() < 1e-150;
            prop_assert!(vanished || (unit.length() - expected).abs() <= RELATIVE, "{unit}");
        }
    }

    /// Two points of a ball, near its observer or around him, are never seen farther apart than its bound says.
    #[test]
    fn the_bound_of_the_stretching_contains_every_pair_of_points(
        case in case(15.0, true),
        part in prop_oneof![0.0..1.5f64, (-9.0..0.0f64).prop_map(|exponent| 10f64.powf(exponent))],
        ends in [(direction(), 0.0..1.0f64), (direction(), 0.0..1.0f64)],
    ) {
        let radius = part * case.distance();
        let bound = case.map().stretch_bound(case.offset, radius);
        let [a, b] = ends.map(|(direction, out)| case.offset + direction * (out * radius));
        let seen = case.map().seen_position(a).distance(case.map().seen_position(b));
        let rounding: f64 = [a, b].map(|offset| Case { offset, ..case }.position_limit()).iter().sum();
        prop_assert!(seen <= bound * a.distance(b) + rounding, "{seen}, bound {bound}, {a}, {b}");
    }

    /// A larger ball never has a smaller bound.
    #[test]
    fn the_bound_of_the_stretching_grows_with_the_ball(
        case in case(MAX_RAPIDITY, true),
        part in 0.0..1.2f64,
        more in 0.0..0.5f64,
    ) {
        let bound = |part: f64| case.map().stretch_bound(case.offset, part * case.distance());
        prop_assert!(bound(part) <= bound(part + more) * (1.0 + RELATIVE));
    }

    #[test]
    fn there_and_back_is_where_it_was(case in case(15.0, true)) {
        let back = case.map().rest_offset(case.map().seen_position(case.offset));
        let doppler = case.map().doppler_factor(case.offset);
        let gamma = case.observer.gamma();
        // The way back magnifies an error by |J^-1| <= 1 + (1 + gamma beta sin theta) / D and makes its own.
        let magnified = 1.0 + (1.0 + case.observer.gamma_beta() * case.sin_theta()) / doppler;
        let own_swing = doppler * case.distance() + gamma * case.distance() * case.sin_theta();
        let limit = magnified * case.position_limit()
            + RELATIVE * case.distance()
            + case.turn() * own_swing;
        prop_assert!((back - case.offset).length() <= limit, "{back}, limit {limit:e}");
    }

    /// Along an axis only relative roundings of the light-cone coordinates remain, at any speed.
    #[test]
    fn there_and_back_along_an_axis_at_any_speed(case in case(MAX_RAPIDITY, false)) {
        let back = case.map().rest_offset(case.map().seen_position(case.offset));
        let limit = 2.0 * RELATIVE * case.distance();
        prop_assert!((back - case.offset).length() <= limit, "{back}, limit {limit:e}");
    }

    /// Powers of two only change exponents: nothing may round differently.
    #[test]
    fn the_map_is_homogeneous(case in case(15.0, true), exponent in -900..900i32, stretch in 0.1..10.0f64) {
        let scale = 2f64.powi(exponent);
        let seen = case.map().seen_position(case.offset);
        prop_assert_eq!(case.map().seen_position(case.offset * scale), seen * scale);
        prop_assert_eq!(
            case.map().doppler_factor(case.offset * scale),
            case.map().doppler_factor(case.offset)
        );
        // Linear along every ray; the stretched offset is rounded, as if turned.
        let stretched = case.map().seen_position(case.offset * stretch);
        let swing = 1.0 + case.observer.gamma() * case.sin_theta();
        let limit = 2.0 * stretch * (case.position_limit() + TURN * case.distance() * swing);
        prop_assert!((stretched - seen * stretch).length() <= limit);
    }

    #[test]
    fn the_distance_seen_is_the_doppler_factor_times_the_distance(case in case(MAX_RAPIDITY, true)) {
        let distance_seen = case.map().doppler_factor(case.offset) * case.distance();
        // As ratios: the square of a distance of 1e160 overflows.
        let seen = case.map().seen_position(case.offset) / distance_seen;
        let limit = 2.0 * RELATIVE + case.position_limit() / distance_seen;
        prop_assert!((seen.length() - 1.0).abs() <= limit, "{seen}");
        let time = case.map().emission_time(case.offset) / distance_seen;
        prop_assert!((time + 1.0).abs() <= 2.0 * RELATIVE, "{time}");
    }

    #[test]
    fn the_determinant_of_the_jacobian_is_the_doppler_factor(case in case(MAX_RAPIDITY, false)) {
        let doppler = case.map().doppler_factor(case.offset);
        let determinant = case.map().jacobian(case.offset).determinant();
        prop_assert!((determinant - doppler).abs() <= 2.0 * RELATIVE * doppler);
    }

    /// In no axis's direction the terms of the determinant are as large as `(1 + |b|)^3` before they
    /// cancel, `b` being the vector of `J = I - n n^T + n b^T`.
    #[test]
    fn the_determinant_is_the_doppler_factor_in_any_direction(case in case(3.0, true)) {
        let doppler = case.map().doppler_factor(case.offset);
        let determinant = case.map().jacobian(case.offset).determinant();
        let b = doppler.hypot(case.observer.gamma_beta() * case.sin_theta());
        let limit = RELATIVE * (1.0 + b).powi(3);
        prop_assert!((determinant - doppler).abs() <= limit);
    }

    #[test]
    fn planes_through_the_line_of_motion_stay(case in case(MAX_RAPIDITY, true)) {
        let n = case.observer.direction();
        let seen = case.map().seen_position(case.offset);
        if case.along_axis {
            let across = |vector: DVec3| vector - n * n.dot(vector);
            prop_assert_eq!(across(seen), across(case.offset));
        } else {
            let limit = TURN * (seen.length() + case.distance());
            prop_assert!((n.cross(seen) - n.cross(case.offset)).length() <= limit);
        }
    }

    /// `M.p = m.d`, where `M = m - a (n.m) / D` is the normal before it is brought to unit length.
    #[test]
    fn a_facet_faces_the_observer_when_it_does_at_rest(
        case in case(10.0, true),
        normal in direction(),
    ) {
        let (map, n) = (case.map(), case.observer.direction());
        let (seen, seen_normal) = (
            map.seen_position(case.offset),
            map.seen_normal(case.offset, normal),
        );
        let at_rest = normal.dot(case.offset);
        let doppler = map.doppler_factor(case.offset);
        let across = n.cross(case.offset).cross(n) / case.distance();
        let slanted = n - across * case.observer.gamma_beta();
        let length = (n.cross(normal).cross(n) * doppler + slanted * n.dot(normal)).length() / doppler;

        let uncertain = normal_limit(&case.observer, case.offset, normal, RELATIVE, case.turn());
        // `length` has the errors of M, counted once more.
        let band = 2.0 * uncertain * seen.length()
            + case.position_limit()
            + (RELATIVE + TURN) * case.distance() / length;
        let in_motion = seen_normal.dot(seen);
        prop_assert!((in_motion - at_rest / length).abs() <= band, "{in_motion}, band {band:e}");
        if (at_rest / length).abs() > band {
            prop_assert_eq!(in_motion > 0.0, at_rest > 0.0);
        }
    }

    /// `T.M = t.m`: what is tangent to a surface at rest is tangent to its photosurface.
    #[test]
    fn tangents_stay_perpendicular_to_normals(
        case in case(10.0, true),
        normal in direction(),
        other in direction(),
    ) {
        let (map, n) = (case.map(), case.observer.direction());
        let tangent = normal.cross(other).normalize_or(normal.any_orthonormal_vector());
        let seen_normal = map.seen_normal(case.offset, normal);
        let seen_tangent = map.seen_tangent(case.offset, tangent);

        let jacobian = map.jacobian(case.offset);
        let tangent_length = (jacobian * tangent).length();
        let doppler = map.doppler_factor(case.offset);
        let gamma_beta = case.observer.gamma_beta();
        let sine = case.sin_theta();
        let parts = 1.0 + doppler + gamma_beta * sine;
        let swing = 1.0 + doppler + gamma_beta * (1.0 + 2.0 * sine);
        let tangent_limit = (RELATIVE * parts + case.turn() * swing) / tangent_length;
        let across = n.cross(case.offset).cross(n) / case.distance();
        let slanted = n - across * gamma_beta;
        let normal_length =
            (n.cross(normal).cross(n) * doppler + slanted * n.dot(normal)).length() / doppler;
        let limit = tangent_limit
            + normal_limit(&case.observer, case.offset, normal, RELATIVE, case.turn())
            // The two are perpendicular at rest but for this.
            + RELATIVE / (tangent_length * normal_length);
        prop_assert!(seen_tangent.dot(seen_normal).abs() <= limit);
    }

    /// Neighbouring points are seen next to each other, also where the formula changes sides.
    #[test]
    fn neighbours_stay_neighbours(case in case(15.0, true), level in any::<bool>()) {
        let n = case.observer.direction();
        // To the side of the observer, where ahead and behind meet, or where it is.
        let beside = case.offset - n * n.dot(case.offset);
        let offset = if level && beside != DVec3::ZERO { beside } else { case.offset };
        let case = Case { offset, ..case };
        let seen = case.map().seen_position(offset);
        let steepest = 1.0
            + case.map().doppler_factor(offset)
            + case.observer.gamma_beta() * case.sin_theta();
        for neighbour in [
            DVec3::new(offset.x.next_up(), offset.y, offset.z),
            DVec3::new(offset.x, offset.y.next_down(), offset.z),
            DVec3::new(offset.x, offset.y, offset.z.next_up()),
        ] {
            let apart = (case.map().seen_position(neighbour) - seen).length();
            let limit = steepest * (neighbour - offset).length() + 2.0 * case.position_limit();
            prop_assert!(apart <= limit, "{apart:e} apart, limit {limit:e}");
        }
    }

    #[test]
    fn the_sign_of_zero_means_nothing(case in case(MAX_RAPIDITY, false), which in 0..3usize) {
        let mut plus = case.offset;
        plus[which] = 0.0;
        let mut minus = plus;
        minus[which] = -0.0;
        let map = case.map();
        prop_assert_eq!(map.seen_position(plus), map.seen_position(minus));
        prop_assert_eq!(map.doppler_factor(plus), map.doppler_factor(minus));
        prop_assert_eq!(map.jacobian(plus), map.jacobian(minus));
        prop_assert_eq!(map.seen_normal(plus, DVec3::ONE), map.seen_normal(minus, DVec3::ONE));
    }
}
