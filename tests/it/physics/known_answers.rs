//! Published and hand-derived numbers: the table of known answers.
//!
//! All numbers here are 30 digits of a calculation in 60 digits, and were checked against a brute-force
//! solver of the light-cone equation. `beta` is the velocity of the *object* in the observer's frame;
//! the observer moves with `-beta` through the object's rest frame.
//!
//! Limits follow from the rounding of the decimal `beta` and from the roundings of the map itself; see
//! `common/passing.rs`.

#![allow(
    clippy::excessive_precision,
    clippy::unreadable_literal,
    reason = "the references are quoted with all their digits"
)]

use crate::common::passing::{Passing, angle_deg, assert_angle_deg, assert_close, assert_near};
use crate::common::{RELATIVE, TURN};
use photosurface::light_cone::PhotosurfaceMap;
use photosurface::spacetime::{Event, Lorentz, WorldLine};
use photosurface::{DVec3, Velocity};

/// `(1, 2, 3)` of an object that moves along +x with 0.9.
const AT_NINE_TENTHS: DVec3 = DVec3::new(1.0, 2.0, 3.0);
/// A velocity along no axis, and a point.
const OBLIQUE: DVec3 = DVec3::new(0.3, -0.5, 0.6);
const OBLIQUE_POINT: DVec3 = DVec3::new(1.5, -2.0, 4.0);

#[test]
fn points_are_seen_where_the_emission_event_is() {
    let x = -5.4313983388049515138295837447721;
    Passing::along_x(0.9).assert_seen(AT_NINE_TENTHS, DVec3::new(x, 2.0, 3.0));
    let time = Passing::along_x(0.9).map.emission_time(AT_NINE_TENTHS);
    assert_near(time, -6.5192091479544654100592021590645, 2e-14);

    let seen = DVec3::new(
        0.27887192972565097842337570482008,
        0.035213450457248369294373825299875,
        1.5577438594513019568467514096402,
    );
    Passing::new(OBLIQUE).assert_seen(OBLIQUE_POINT, seen);
}

/// The object's origin passes (-3, 2, 1) at time 0 with 0.8 along x; the observer is at (0, 0, 0) at 4.
#[test]
fn an_observer_event_away_from_the_origin_is_boosted_into_the_rest_frame() {
    let object = Velocity::from_beta(0.8, DVec3::X).unwrap();
    let event = Event::new(4.0, DVec3::new(3.0, -2.0, -1.0));
    let observer_rest = Lorentz::boost(object).apply(event).position;
    let offset = DVec3::new(0.5, -0.5, 0.5) - observer_rest;
    let seen = DVec3::new(-1.6499542958171873685715922011885, 1.5, 1.5);

    // The place in the rest frame has coordinates of exp(1.1) * 7 before they cancel, and the map
    // stretches by at most 3.
    let passing = Passing::along_x(0.8);
    let limit =
        passing.position_limit(offset, seen) + 3.0 * 21.0 * (RELATIVE + passing.uncertainty);
    assert_close(passing.map.seen_position(offset), seen, limit);
    // That emission event as the observer's clock, which shows 4, has it.
    let time = 4.0 + passing.map.emission_time(offset);
    assert_near(time, 1.3125571302285157892855097485144, limit);
}

#[test]
fn doppler_factors_follow_the_angle_at_rest_and_the_angle_seen() {
    Passing::along_x(0.9).assert_doppler(AT_NINE_TENTHS, 1.7423319331691484324362615291394);
    Passing::new(OBLIQUE).assert_doppler(OBLIQUE_POINT, 0.33557433389690035039644029663942);

    // beta, the angle seen between +x and the point, D.
    let seen_at = [
        (0.5, 0.0, 0.57735026918962576450914878050196),
        (0.5, 90.0, 0.86602540378443864676372317075294),
        (0.5, 180.0, 1.7320508075688772935274463415059),
        (0.9, 60.0, 0.3006137202441843829128953092317),
        (0.9, 120.0, 0.79252708064375882767945126979266),
        (0.99, 170.0, 5.6336074916177016820737196623685),
    ];
    for (beta, theta_deg, expected) in seen_at {
        let passing = Passing::along_x(beta);
        let (sine, cosine) = f64::to_radians(theta_deg).sin_cos();
        let offset = passing.map.rest_offset(DVec3::new(cosine, sine, 0.0));
        // D = 1 / (gamma (1 + beta cos)): an angle wrong by E changes it by gamma beta E D^2.
        let swing = passing.observer.gamma_beta() * expected * expected * 4.0 * f64::EPSILON;
        let limit = (2.0 * RELATIVE + 2.0 * passing.uncertainty) * expected + swing;
        assert_near(passing.map.doppler_factor(offset), expected, limit);
    }
}

/// Solid angles shrink by `D^2`: by the angular part of the Jacobian.
#[test]
fn solid_angles_shrink_by_the_square_of_the_doppler_factor() {
    let passing = Passing::along_x(0.9);
    let jacobian = passing.map.jacobian(AT_NINE_TENTHS);
    let seen = passing.map.seen_position(AT_NINE_TENTHS);
    let (r, distance) = (AT_NINE_TENTHS.length(), seen.length());
    // det J = (solid angle ratio) (radial stretch) (distance / r)^2, the stretch being distance / r.
    let ratio = jacobian.determinant() / (distance / r).powi(3);
    // Each factor D of five is uncertain by the rapidity's share.
    let limit = 5.0 * (RELATIVE + passing.uncertainty);
    assert_near(ratio, 0.32941108329174887443835669916921, limit);
    // A black body of 5778 K looks like one of D times that.
    let limit = 10067.2 * (RELATIVE + passing.uncertainty);
    let temperature = 5778.0 * passing.map.doppler_factor(AT_NINE_TENTHS);
    assert_near(temperature, 10067.193909851339642616719115367, limit);
}

/// A facet at rest with normal (2, 3, 6)/7, seen in motion along no axis.
#[test]
fn normals_go_with_the_inverse_transpose() {
    let passing = Passing::new(OBLIQUE);
    let at_rest = DVec3::new(2.0, 3.0, 6.0) / 7.0;
    let expected = DVec3::new(
        0.28518254028743249135148395669418,
        0.11314618694899902502546717793713,
        0.95177143216956722581322528399028,
    );
    let seen = passing.map.seen_normal(OBLIQUE_POINT, at_rest);
    // gamma is 1.83 and D a third: no term of N is above 2 gamma / D = 11 times the whole.
    let uncertainty = 11.0 * (RELATIVE + TURN + passing.uncertainty);
    assert_close(seen, expected, uncertainty);

    // What goes wrong with the shortcuts: none at all, as a vector, as a tangent.
    let n = passing.observer.direction();
    let as_vector = at_rest + n * ((passing.observer.gamma() - 1.0) * n.dot(at_rest));
    let as_tangent = passing.map.seen_tangent(OBLIQUE_POINT, at_rest);
    assert_angle_deg(
        angle_deg(seen, at_rest),
        18.954638590691796477049711727459,
        uncertainty,
    );
    assert_angle_deg(
        angle_deg(seen, as_vector),
        4.795098340015958263459304524323,
        uncertainty,
    );
    assert_angle_deg(
        angle_deg(seen, as_tangent),
        54.401970860828139413936125123179,
        uncertainty,
    );
}

/// The face x = -2 of a passing box, at (-2, 1, 0): its normal tilts away from the motion. The same tilt
/// is the gradient of the hyperboloid.
#[test]
fn a_face_across_the_motion_tilts() {
    let tilts = [
        (0.5, 14.477512185929923878771034799127),
        (0.9, 42.718780532334003346449041605185),
        (0.99, 72.326954343683496190221902499233),
    ];
    for (beta, tilt_deg) in tilts {
        let passing = Passing::along_x(beta);
        let offset = DVec3::new(-2.0, 1.0, 0.0);
        let normal = passing.map.seen_normal(offset, DVec3::X);
        // tan(tilt) = gamma beta / sqrt(5) changes by gamma / sqrt(5) per unit of rapidity.
        let uncertainty = RELATIVE + passing.uncertainty * passing.observer.gamma();
        assert_angle_deg(angle_deg(normal, DVec3::X), tilt_deg, uncertainty);
    }
}

/// Seen length over length at rest of a rod along the motion: approaching, receding.
#[test]
fn rods_along_the_motion_stretch_when_they_come_and_shrink_when_they_go() {
    let ratios = [
        (
            0.5,
            1.7320508075688772935274463415059,
            0.57735026918962576450914878050196,
        ),
        (0.6, 2.0, 0.5),
        (0.8, 3.0, 1.0 / 3.0),
        (
            0.9,
            4.3588989435406735522369819838596,
            0.22941573387056176590720957809787,
        ),
        (
            0.95,
            6.2449979983983982058468931209398,
            0.16012815380508705334325366976769,
        ),
        (
            0.99,
            14.106735979665884425232163690877,
            0.070888120500833590076543536135062,
        ),
        (
            0.999,
            44.710177812216314199613423002048,
            0.022366272042129221710662042522285,
        ),
    ];
    for (beta, approaching, receding) in ratios {
        let passing = Passing::along_x(beta);
        // It comes along +x from the side of -x.
        for (side, expected) in [(-1.0, approaching), (1.0, receding)] {
            let ends =
                [4.0, 5.0].map(|x| passing.map.seen_position(DVec3::new(side * x, 0.0, 0.0)));
            // Both ends at up to 5 times the difference.
            let limit = 2.0 * 5.0 * expected * (RELATIVE + passing.uncertainty);
            assert_near(ends[0].distance(ends[1]), expected, limit);
        }
    }
}

#[test]
fn a_straight_edge_is_seen_as_a_branch_of_a_hyperbola() {
    let along = DVec3::new(2.0, -1.0, 2.0) / 3.0;
    let start = DVec3::new(1.0, 2.0, -1.0);
    let seen = DVec3::new(
        0.38247752481924931102644601325746,
        4.0014263475234733705114788667931,
        -3.0683782836948347112804413068184,
    );
    Passing::new(OBLIQUE).assert_seen(start + along * 1.25, seen);
    let distance = start.cross(along).length();
    assert_near(distance, 2.3570226039551584146694812070162, 3.0 * RELATIVE);

    // A rod along the motion, 2 to the side.
    for (x_rest, x_seen) in [
        (-1.0, -6.9110599230888110886271336125101),
        (0.0, -4.1294832096701117863297724057617),
        (1.0, -2.3227452456775757704829420505526),
    ] {
        let seen = DVec3::new(x_seen, 2.0, 0.0);
        Passing::along_x(0.9).assert_seen(DVec3::new(x_rest, 2.0, 0.0), seen);
    }
}

/// A grid across the motion at `x0` is seen on `((gamma x0 - x) / (gamma beta))^2 - rho^2 = x0^2`.
#[test]
fn a_plane_across_the_motion_is_seen_as_a_sheet_of_a_hyperboloid() {
    let passing = Passing::along_x(0.9);
    for (x0, vertex) in [
        (1.0, 0.22941573387056176590720957809787),
        (-1.0, -4.3588989435406735522369819838596),
    ] {
        passing.assert_seen(DVec3::new(x0, 0.0, 0.0), DVec3::new(vertex, 0.0, 0.0));
        let (gamma, gamma_beta) = (passing.observer.gamma(), passing.observer.gamma_beta());
        for (y, z) in [(0.5, 0.0), (2.0, -1.0), (0.0, 30.0)] {
            let seen = passing.map.seen_position(DVec3::new(x0, y, z));
            assert_eq!((seen.y, seen.z), (y, z));
            let ahead = ((gamma * x0 - seen.x) / gamma_beta).powi(2);
            // A difference of squares as large as this.
            let limit = 4.0 * ahead * (RELATIVE + passing.uncertainty);
            assert_near(ahead - (y * y + z * z), x0 * x0, limit);
        }
    }
    // Through the observer it is a cone; far out every sheet approaches it.
    let cone = DVec3::new(-4.1294832096701117863297724057617, 2.0, 0.0);
    passing.assert_seen(DVec3::new(0.0, 2.0, 0.0), cone);
    let far = passing.map.seen_position(DVec3::new(0.0, 1e8, 0.0));
    let half_angle = angle_deg(far, DVec3::NEG_X);
    assert_angle_deg(
        half_angle,
        25.84193276316712873516953925951,
        passing.uncertainty,
    );
}

/// A small body seen at a right angle to its motion: from its front side and from its rear the eye gets as
/// much as from a body rotated by `asin(beta)`, but in depth it is sheared, not rotated.
#[test]
fn a_small_body_abeam_looks_rotated_but_is_sheared() {
    let rotations = [
        (0.5, 30.0),
        (0.8, 53.130102354155978703144387440907),
        (0.9, 64.15806723683287126483046074049),
        (0.95, 71.805127661233223475817833285113),
        (0.999, 87.437441266876862087254856565118),
    ];
    for (beta, rotation_deg) in rotations {
        let passing = Passing::along_x(beta);
        let jacobian = passing.map.jacobian(passing.map.rest_offset(DVec3::Y));
        let (front, side) = (jacobian * DVec3::X, jacobian * DVec3::Y);
        // The line of sight is y: across it the front is cos, the side sin of the rotation.
        let rotation_seen = side.x.abs().atan2(front.x).to_degrees();
        // asin(tanh(rapidity)) changes by 1 / gamma; both parts are good to RELATIVE of 1.
        let uncertainty = 2.0 * RELATIVE + passing.uncertainty / passing.observer.gamma();
        assert_angle_deg(rotation_seen, rotation_deg, uncertainty);
        assert_near(front.length(), rotation_deg.to_radians().cos(), uncertainty);
    }

    let jacobian_of = |beta| {
        let passing = Passing::along_x(beta);
        passing.map.jacobian(passing.map.rest_offset(DVec3::Y))
    };
    let depth_edge = jacobian_of(0.8) * DVec3::Y;
    let front = jacobian_of(0.8) * DVec3::X;
    let uncertainty = 2.0 * RELATIVE + Passing::along_x(0.8).uncertainty;
    assert_near(
        depth_edge.length(),
        1.2806248474865697372976435349244,
        uncertainty,
    );
    let edge_angle_deg = angle_deg(front, depth_edge);
    assert_angle_deg(
        edge_angle_deg,
        128.65980825409009060400586233517,
        uncertainty,
    );
}

/// `tan(theta / 2) = exp(eta) tan(theta' / 2)`.
#[test]
fn aberration_turns_directions() {
    let directions = [
        (0.8, 30.0, 77.587953773993771629918643767245),
        (0.8, 60.0, 120.0),
        (0.9, 45.0, 122.0394952707187903071017931488),
    ];
    for (beta, at_rest_deg, seen_deg) in directions {
        let passing = Passing::along_x(beta);
        let (sine, cosine) = f64::to_radians(at_rest_deg).sin_cos();
        let offset = DVec3::new(cosine, sine, 0.0);
        let seen = passing.map.seen_position(offset);
        // Angles at rest are magnified by 1 / D, the rapidity counts sin(theta) times.
        let magnified = 2.0 * f64::EPSILON / passing.map.doppler_factor(offset);
        let uncertainty = RELATIVE + magnified + passing.uncertainty;
        assert_angle_deg(angle_deg(seen, DVec3::X), seen_deg, uncertainty);
    }
}

/// A point on the line y = 1, at `u` along the motion at the time of observation: where it is seen and
/// how fast that place moves.
#[test]
fn apparent_motion_is_faster_coming_than_going() {
    let beta = 0.9;
    let passing = Passing::along_x(beta);
    let (gamma, gamma_beta) = (passing.observer.gamma(), passing.observer.gamma_beta());
    let motion = |u: f64| {
        // In the rest frame lengths along the motion are gamma times as long.
        let offset = DVec3::new(gamma * u, 1.0, 0.0);
        let speed = (passing.map.jacobian(offset) * DVec3::new(gamma_beta, 0.0, 0.0)).x;
        (offset, passing.map.seen_position(offset).x, speed)
    };
    let known = [
        (
            -1.0,
            Some(-10.430442580616917352816810020335),
            8.6448725399623744685169151414295,
        ),
        (
            0.0,
            Some(-2.0647416048350558931648862028809),
            4.7368421052631578947368421052632,
        ),
        (
            1.0,
            Some(0.095873208856766857709505769139152),
            0.82881167056394132095676906909684,
        ),
        (-100.0, None, 8.9999595005771158623394135350919),
    ];
    for (u, x, speed) in known {
        let (offset, x_seen, speed_seen) = motion(u);
        // gamma is in the offset, too, and a shift of the offset counts D times.
        let doppler = passing.map.doppler_factor(offset);
        let shift = offset.length() * doppler * (RELATIVE + passing.uncertainty);
        if let Some(x) = x {
            assert_near(x_seen, x, 2.0 * shift);
        }
        // v = gamma beta D: each factor has the rapidity's uncertainty; D changes with the offset.
        let limit = 4.0 * gamma_beta * gamma * 2.0 * (RELATIVE + passing.uncertainty);
        assert_near(speed_seen, speed, limit);
    }
    // At the foot of the perpendicular, seen at x = 0, it seems as fast as it is.
    let limit = 8.0 * gamma_beta * gamma * (RELATIVE + passing.uncertainty);
    let (_, x, speed) = motion(beta);
    assert_near(x, 0.0, limit);
    assert_near(speed, beta, limit);
    // From afar: beta / (1 - beta) and beta / (1 + beta), but for terms in 1 / u^2 = 1e-16.
    assert_near(motion(-1e8).2, 9.0, 9.0 * limit);
    assert_near(motion(1e8).2, 0.47368421052631578947368421052632, limit);
}

/// `beta sin / (1 - beta cos)`, the angle being that between the motion and the way to the observer.
#[test]
fn transverse_motion_may_seem_faster_than_light() {
    let seen_at = [
        (0.95, 10.0, 2.5602828397344933351581689711251),
        (0.95, 20.0, 3.0283628332812239859479079428963),
        (0.99, 10.0, 6.8653940873359780122442679794046),
        (0.9, 45.0, 1.7502455513746097007743864300746),
    ];
    let fastest = [
        (0.9, 2.0647416048350558931648862028809),
        (0.95, 3.0424349222966555361818197255861),
        (0.99, 7.0179239295825254175778100773711),
    ];
    let at_fastest = fastest.map(|(beta, speed)| (beta, f64::acos(beta).to_degrees(), speed));
    for (beta, angle, expected) in seen_at.into_iter().chain(at_fastest) {
        let passing = Passing::along_x(beta);
        let (sine, cosine) = f64::to_radians(angle).sin_cos();
        let toward_source = -DVec3::new(cosine, sine, 0.0);
        let offset = passing.map.rest_offset(toward_source);
        let jacobian = passing.map.jacobian(offset);
        let velocity = jacobian * DVec3::new(passing.observer.gamma_beta(), 0.0, 0.0);
        let transverse = velocity.cross(toward_source).length();
        // v = gamma beta D sin with D = 1 / (gamma (1 - beta cos)): the rapidity counts up to 1 + p_par / |p|
        // times, an angle wrong by E gamma beta D / tan times and more; all below 4 gamma^2.
        let magnified = 4.0 * passing.observer.gamma().powi(2);
        let limit = expected * magnified * (RELATIVE + passing.uncertainty);
        assert_near(transverse, expected, limit);
    }
}

/// Constant proper acceleration 0.5 for a proper time of 3, as an event and a velocity.
#[test]
fn an_accelerated_observer_sees_what_an_inertial_one_there_would() {
    let (acceleration, proper_time) = (0.5, 3.0);
    let rapidity: f64 = acceleration * proper_time;
    let event = Event::new(
        rapidity.sinh() / acceleration,
        DVec3::new((rapidity.cosh() - 1.0) / acceleration, 0.0, 0.0),
    );
    let limit = RELATIVE * event.time;
    assert_near(event.time, 4.2585589101896349936687749893553, limit);
    assert_near(event.position.x, 2.7048192304864946515353359308833, limit);
    let velocity = Velocity::from_rapidity(rapidity, DVec3::X).unwrap();
    assert_near(velocity.beta(), 0.9051482536448664382423036964565, RELATIVE);

    let seen =
        PhotosurfaceMap::new(&velocity).seen_position(DVec3::new(5.0, 1.0, 0.0) - event.position);
    let expected = DVec3::new(10.730002082765421660632536101846, 1.0, 0.0);
    // The place of the observer is known to RELATIVE, the map stretches by exp(1.5) at most.
    let limit = RELATIVE * (expected.length() + rapidity.exp() * event.position.x);
    assert_close(seen, expected, limit);
}

/// 0.6 along x, then 0.8 along y.
#[test]
fn two_boosts_at_right_angles_amount_to_a_boost_and_a_rotation() {
    let first = Lorentz::boost(Velocity::from_beta(0.6, DVec3::X).unwrap());
    let second = Lorentz::boost(Velocity::from_beta(0.8, DVec3::Y).unwrap());
    let both = first.then(&second);
    // gamma = (5/4) (5/3).
    assert_near(both.boost_velocity().gamma(), 25.0 / 12.0, 3.0 * RELATIVE);
    let turned = both.rotation() * DVec3::X;
    assert_angle_deg(
        angle_deg(turned, DVec3::X),
        18.924644416051234782280141083484,
        2.0 * RELATIVE,
    );
    // The plane is x, y; the axes of the second frame are turned from x towards -y, against the turn of
    // the velocity, so that a fixed vector is turned the other way.
    assert_eq!(turned.z, 0.0);
    assert!(turned.y > 0.0);
}

/// A circle at 0.6, made of small boosts in the traveller's own frame. Its axes turn backwards by
/// `2 pi (gamma - 1)` = 90 degrees per lap, less what a polygon is short of its circle.
#[test]
fn axes_carried_around_a_circle_precess() {
    const STEPS: u32 = 4000;
    let speed = Velocity::from_beta(0.6, DVec3::X).unwrap();
    let mut frame = Lorentz::boost(speed);
    for step in 1..=STEPS {
        let (sine, cosine) = (std::f64::consts::TAU * f64::from(step) / f64::from(STEPS)).sin_cos();
        let direction = DVec3::new(cosine, sine, 0.0);
        let next = Velocity::from_rapidity(speed.rapidity(), direction).unwrap();
        let flight = WorldLine {
            origin: Event::default(),
            velocity: next,
        };
        // The next velocity as the traveller sees it now.
        let own = frame.apply(flight.velocity.four_velocity()).position;
        let boost = Velocity::from_rapidity(own.length().asinh(), own).unwrap();
        frame = frame.then(&Lorentz::boost(boost));
    }
    // Each step has a few roundings of size 1, magnified by gamma and the boost.
    let limit = f64::from(STEPS) * 4.0 * (RELATIVE + TURN);
    assert_close(frame.boost_velocity().direction(), DVec3::X, limit);
    assert_near(frame.boost_velocity().gamma(), 1.25, limit);

    // Parallel transport around a regular polygon in hyperbolic space turns by its area, its angular
    // defect: half the angle at a corner has the tangent 1 / (gamma tan(pi / N)).
    let corner = (std::f64::consts::PI / f64::from(STEPS)).tan() * speed.gamma();
    let defect = f64::from(STEPS) * 2.0 * corner.atan() - std::f64::consts::TAU;
    let turned = frame.rotation() * DVec3::X;
    // The lap is counter-clockwise, the axes turn clockwise, so in them a fixed vector turns
    // counter-clockwise.
    let angle = turned.y.atan2(turned.x);
    assert_near(angle, defect, limit);
    // As tabulated, to its seven digits.
    assert_near(angle.to_degrees(), 89.99995, 0.5e-5);
}

/// The unit cube's corners at z = 0.5, moving with 0.9, abeam at y = 1.5 and two lengths before.
#[test]
fn the_corners_of_a_passing_cube() {
    let corners = [
        ((-2.5, 1.0), -11.389921108701933491928349492672),
        ((-2.5, 2.0), -12.425920821839297293565982553649),
        ((-1.5, 1.0), -7.3040138468137110750589834343435),
        ((-1.5, 2.0), -8.7053148748488428120920183478396),
        ((-0.5, 1.0), -3.675860360623382537359829882341),
        ((-0.5, 2.0), -5.5270570398833973599769740562595),
        ((0.5, 1.0), -1.3817030219177648782877341013622),
        ((0.5, 2.0), -3.2328997011777797009048782752807),
    ];
    let passing = Passing::along_x(0.9);
    for ((x_rest, y), x) in corners {
        for z in [0.5, -0.5] {
            passing.assert_seen(DVec3::new(x_rest, y, z), DVec3::new(x, y, z));
        }
    }
}

/// A sphere of radius 1 that passes at y = 3 with 0.95: where its centre and its extremes along the motion
/// in the plane z = 0 are seen, at five times of the observer.
#[test]
fn a_sphere_passes_by() {
    let steps = [
        (
            -6.0,
            -114.74500319468068,
            -120.96987194034973,
            -108.52128030383324,
        ),
        (
            -2.0,
            -40.127727339588838,
            -46.221087327247774,
            -34.058814136014869,
        ),
        (
            0.0,
            -9.1273047668899667,
            -13.782385008712004,
            -5.0132601298720746,
        ),
        (
            2.0,
            -1.1533683652298636,
            -2.7976889347273436,
            0.0494338612963144,
        ),
        (
            12.0,
            5.4717847253442909,
            5.1363903581413304,
            5.7450869901639968,
        ),
    ];
    let beta = 0.95;
    let object = Velocity::from_beta(beta, DVec3::X).unwrap();
    let passing = Passing::along_x(beta);
    for (time, centre_x, lowest, highest) in steps {
        let observer_rest = Lorentz::boost(object)
            .apply(Event::new(time, DVec3::ZERO))
            .position;
        let centre = DVec3::new(0.0, 3.0, 0.0) - observer_rest;
        let seen_x = |offset: DVec3| passing.map.seen_position(offset).x;
        // The observer's place in the rest frame, gamma beta T, has the rapidity's uncertainty, too; the
        // references have 17 digits.
        let stretch = passing.observer.rapidity().exp();
        let limit = 2.0 * (RELATIVE + passing.uncertainty) * stretch * (centre.length() + 1.0);
        assert_near(seen_x(centre), centre_x, limit);

        let on_circle = |angle: f64| seen_x(centre + DVec3::new(angle.cos(), angle.sin(), 0.0));
        assert_near(-largest(|angle| -on_circle(angle)), lowest, limit);
        assert_near(largest(on_circle), highest, limit);
    }
}

/// The largest value of a smooth function of an angle with one maximum.
fn largest(function: impl Fn(f64) -> f64) -> f64 {
    let step = std::f64::consts::TAU / 360.0;
    let best = (0..360)
        .map(|i| f64::from(i) * step)
        .max_by(|a, b| function(*a).total_cmp(&function(*b)))
        .expect("360 angles");
    // Ternary search; near the maximum the function is flat, so the angle need not be exact.
    let (mut low, mut high) = (best - step, best + step);
    for _ in 0..80 {
        let third = (high - low) / 3.0;
        if function(low + third) < function(high - third) {
            low += third;
        } else {
            high -= third;
        }
    }
    function(0.5 * (low + high))
}
