//! Light of moving lamps, against the textbook's formulas in 300 digits and against solvers of their definitions.

use std::f64::consts::{PI, TAU};

use photosurface::effects::{
    arrival, far_irradiance, from_point, point_irradiance, sky_irradiance,
};
use photosurface::spacetime::{Event, Lorentz};
use photosurface::{DVec3, Velocity};

use crate::common::oracle::{apply, big_vector, boost, error, length, small, vector_error};
use crate::common::{Random, Worst};

fn velocity(rapidity: f64, direction: DVec3) -> Velocity {
    Velocity::from_rapidity(rapidity, direction).expect("not too fast")
}

/// Directions at all angles to an axis, also next to it: of those the last place decides.
fn directions(random: &mut Random, axis: DVec3) -> Vec<DVec3> {
    let mut all = vec![axis, -axis];
    for exponent in 0..12 {
        let aside = random.direction() * 10f64.powi(-exponent);
        all.extend([(axis + aside).normalize(), (aside - axis).normalize()]);
    }
    all
}

/// A null vector, boosted by a matrix of 300 digits.
///
/// # Where the limits come from
///
/// A direction is rounded by a unit in its last place, across which the factor has the slope `sin(theta) sinh(eta)` and the
/// direction there `1 / D`; beside that there are ten roundings.
#[test]
fn light_is_shifted_and_aberrated_as_in_the_textbook() {
    let mut random = Random::new(15);
    let (mut factors, mut ways) = (Worst::new("factor"), Worst::new("direction"));
    for rapidity in [0.0, 1e-9, 0.5, 3.0, 10.0, 20.0] {
        for axis in [DVec3::X, DVec3::NEG_Y, DVec3::new(0.0, 0.6, -0.8)] {
            let frame = velocity(rapidity, axis);
            let matrix = boost(&frame);
            for travel in directions(&mut random, axis) {
                let found = arrival(&Lorentz::boost(frame), travel);
                let exact = big_vector(travel);
                let size = length(&exact);
                let [x, y, z] = exact;
                let there = apply(&matrix, &[size.clone(), x, y, z]);
                let factor = there[0].clone() / &size;
                let way = [1, 2, 3].map(|i| there[i].clone() / &there[0]);
                let sine = frame.direction().cross(travel).length();
                let of_angle = 2.0 * f64::EPSILON * sine * rapidity.sinh();
                let limit = of_angle + 20.0 * f64::EPSILON * small(&factor);
                let told = || format!("{rapidity} {axis} {travel}");
                factors.record(error(found.factor, &factor), limit, limit, told);
                let limit = f64::EPSILON * (20.0 + 2.0 / small(&factor));
                ways.record(vector_error(found.travel, &way), limit.min(2.0), 1.0, told);
                assert!((found.travel.length() - 1.0).abs() < 4.0 * f64::EPSILON);
            }
        }
    }
    factors.check();
    ways.check();
}

#[test]
fn no_rapidity_makes_a_number_that_is_none() {
    for rapidity in [0.0, 1e-300, 30.0, 300.0, 350.0] {
        for axis in [DVec3::X, DVec3::new(0.3, -0.5, 0.6)] {
            let frame = velocity(rapidity, axis);
            let opposite = Lorentz::between(velocity(rapidity, -axis), frame);
            for to_frame in [Lorentz::boost(frame), opposite] {
                for travel in [
                    DVec3::X,
                    DVec3::NEG_X,
                    DVec3::Y,
                    axis.normalize(),
                    -axis.normalize(),
                ] {
                    let found = arrival(&to_frame, travel);
                    assert!(
                        found.factor > 0.0 && found.factor.is_finite(),
                        "{rapidity} {travel}"
                    );
                    assert!((found.travel.length() - 1.0).abs() < 1e-12);
                    for shifted in [true, false] {
                        let far = far_irradiance(6504.0, found.factor, shifted);
                        let near = point_irradiance(1e-3, 6504.0, found.factor, shifted);
                        assert!(far >= 0.0 && far.is_finite() && near.is_finite());
                    }
                }
            }
            let mut sum = 0.0;
            sky_irradiance(frame, DVec3::Y, |part, factor| {
                assert!(part > 0.0 && factor > 0.0 && factor.is_finite());
                sum += part;
            });
            assert!((sum - 1.0).abs() < 1e-12, "{rapidity}: {sum}");
        }
    }
}

/// The light-cone equation of a lamp in the scene frame, solved by halving: `|x - x_lamp(t)| = t_0 - t`.
fn emission_time(lamp: DVec3, beta: DVec3, event: Event) -> f64 {
    let late = |time: f64| event.position.distance(lamp + beta * time) > event.time - time;
    let (mut early, mut after) = (event.time - 1e6, event.time);
    for _ in 0..200 {
        let middle = 0.5 * (early + after);
        match late(middle) {
            true => after = middle,
            false => early = middle,
        }
    }
    0.5 * (early + after)
}

#[test]
fn light_left_the_lamp_where_the_light_cone_says() {
    let mut random = Random::new(3);
    for _ in 0..2000 {
        let moving = Velocity::from_beta(random.between(0.0, 0.99), random.direction()).unwrap();
        let beta = moving.direction() * moving.beta();
        let lamp = random.direction() * random.between(0.0, 5.0);
        let event = Event::new(random.between(-5.0, 5.0), random.direction() * 4.0);
        let event_lamp = Lorentz::boost(moving).apply(event - Event::new(0.0, lamp));
        let light = from_point(DVec3::ZERO, event_lamp).expect("not at the lamp");
        let time = emission_time(lamp, beta, event);
        // The lamp's clock is slow by gamma. Of an event up to 1e6 before, halving leaves 1e-9.
        let expected = time / moving.gamma();
        assert!(
            (light.emitted - expected).abs() < 1e-8,
            "{} {expected}",
            light.emitted
        );
        let travel = event.position - (lamp + beta * time);
        let back = arrival(&Lorentz::boost(moving.reversed()), light.travel);
        assert!(back.travel.distance(travel.normalize()) < 1e-8 * (1.0 + 1.0 / travel.length()));
        // The distance in the scene is D times that in the lamp's frame.
        let distance = back.factor * light.distance;
        assert!(
            (distance - travel.length()).abs() < 1e-8 * (1.0 + distance),
            "{distance}"
        );
    }
}

/// `B(D T)` over the square of the distance from which a surface sees the lamp, and, of all wavelengths together, what a
/// count of photons says: of `P / (4 pi R^2)` in the lamp's frame both energies and rates change by `D`.
#[test]
fn both_forms_of_the_irradiance_of_a_moving_lamp_agree() {
    let mut random = Random::new(8);
    for _ in 0..2000 {
        let beta = random.between(-0.999, 0.999);
        let (cosine, distance) = (random.between(-1.0, 1.0), random.between(0.1, 10.0));
        // In the surface's frame the lamp moves along x; its light comes from the angle of this cosine.
        let gamma = 1.0 / ((1.0 - beta) * (1.0 + beta)).sqrt();
        let source = distance * DVec3::new(cosine, (1.0 - cosine * cosine).sqrt(), 0.0);
        let factor = 1.0 / (gamma * (1.0 + beta * cosine));
        let moving = Velocity::from_vector(DVec3::X * beta).unwrap();
        // The surface at the origin now, the lamp where it was.
        let offset = Event::new(distance, -source);
        let light = from_point(DVec3::ZERO, Lorentz::boost(moving).apply(offset)).unwrap();
        let there = arrival(&Lorentz::boost(moving.reversed()), light.travel);
        assert!(
            (there.factor / factor - 1.0).abs() < 1e-11,
            "{} {factor}",
            there.factor
        );
        let found = point_irradiance(light.distance, 6504.0, there.factor, true);
        assert!((found * distance * distance - 1.0).abs() < 1e-10, "{found}");
        let photons = factor.powi(2) / light.distance.powi(2);
        assert!((found * factor.powi(4) / photons - 1.0).abs() < 1e-10);
        let plain = point_irradiance(light.distance, 6504.0, there.factor, false);
        assert!((plain * light.distance.powi(2) - 1.0).abs() < 1e-12);
    }
}

/// Light of radiance `D^power` on one side of a surface: a sum over a fine grid of the sky.
fn by_grid(motion: Velocity, normal: DVec3, power: i32) -> f64 {
    let (gamma, beta) = (motion.gamma(), motion.beta());
    let (rings, turns) = (4000, 400);
    let (u, v) = motion.direction().any_orthonormal_pair();
    let mut sum = 0.0;
    for ring in 0..rings {
        // Even steps of the square root of the angle: finer ahead.
        let (low, high) = [ring, ring + 1]
            .map(|edge| PI * (f64::from(edge) / f64::from(rings)).powi(3))
            .into();
        let angle = 0.5 * (low + high);
        let factor = 1.0 / (gamma * (1.0 - beta * angle.cos()));
        let area = (low.cos() - high.cos()) * TAU / f64::from(turns);
        for turn in 0..turns {
            let (sine, cosine) = (TAU * (f64::from(turn) + 0.5) / f64::from(turns)).sin_cos();
            let from = motion.direction() * angle.cos() + (u * cosine + v * sine) * angle.sin();
            sum += from.dot(normal).max(0.0) * factor.powi(power) * area / PI;
        }
    }
    sum
}

#[test]
fn a_sky_lights_a_moving_surface_as_a_sum_over_all_directions_says() {
    let mut random = Random::new(5);
    let mut worst = 0.0_f64;
    for rapidity in [0.1, 0.5, 1.4722, 3.0] {
        let motion = velocity(rapidity, DVec3::new(0.2, -0.4, 0.7));
        for case in 0..6 {
            let normal = match case {
                0 => motion.direction(),
                1 => -motion.direction(),
                2 => motion.direction().any_orthonormal_vector(),
                _ => random.direction(),
            };
            for power in [0, 1, 4] {
                let mut found = 0.0;
                sky_irradiance(motion, normal, |part, factor| {
                    found += part * factor.powi(power)
                });
                let expected = by_grid(motion, normal, power);
                worst = worst.max((found / expected - 1.0).abs());
            }
        }
    }
    println!("worst: {worst:.2e}");
    assert!(worst < 2e-4, "{worst}");
}

/// Net flux: the light on one side of a surface less that on the other. Of an isotropic sky, of all wavelengths,
/// `4 beta gamma^2 / 3` times the energy density at rest, `4 pi` times the radiance, flows against the motion. Each side is
/// right to 2e-4, as the test before this one says.
#[test]
fn the_flux_of_a_sky_through_a_moving_surface_is_that_of_its_stress() {
    for rapidity in [0.1, 0.5, 1.4722, 3.0] {
        let motion = velocity(rapidity, DVec3::X);
        let side = |normal: DVec3| {
            let mut sum = 0.0;
            sky_irradiance(motion, normal, |part, factor| sum += part * factor.powi(4));
            sum
        };
        let sides = [DVec3::X, DVec3::NEG_X].map(side);
        let found = sides[0] - sides[1];
        let expected = 16.0 / 3.0 * motion.gamma_beta() * motion.gamma();
        assert!(
            (found - expected).abs() < 2e-4 * (sides[0] + sides[1]),
            "{rapidity}: {found} {expected}"
        );
    }
}

#[test]
fn at_rest_a_sky_is_uniform_and_near_rest_nearly_so() {
    for (rapidity, limit) in [(0.0, 0.0), (1e-12, 1e-9), (1e-4, 1e-3)] {
        for normal in [DVec3::X, DVec3::Y, DVec3::new(0.6, 0.0, -0.8)] {
            let mut sum = 0.0;
            sky_irradiance(velocity(rapidity, DVec3::X), normal, |part, factor| {
                sum += part * factor.powi(4);
            });
            assert!((sum - 1.0).abs() <= limit, "{rapidity} {normal}: {sum}");
        }
    }
}
