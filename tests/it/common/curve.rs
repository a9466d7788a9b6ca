//! The true surfaces of round shapes: random places on them, and the places next to others.

use photosurface::{DVec3, Shape};

use super::Random;

/// A random place of the true surface.
pub(crate) fn on_curve(shape: &Shape, random: &mut Random) -> DVec3 {
    let direction = random.direction();
    match shape {
        Shape::Sphere(sphere) => direction * sphere.radius.get(),
        Shape::Torus(torus) => {
            let [major, minor] = [torus.major_radius(), torus.minor_radius()].map(|r| r.get());
            let angle = random.between(0.0, std::f64::consts::TAU);
            turned(
                [major + minor * angle.cos(), minor * angle.sin()],
                direction,
            )
        }
        _ => {
            let corners = outline(shape);
            let side = random.between(0.0, corners.len() as f64 - 1.0);
            let (a, b) = (corners[side as usize], corners[side as usize + 1]);
            turned(
                [0, 1].map(|i| a[i] + (b[i] - a[i]) * side.fract()),
                direction,
            )
        }
    }
}

/// How many smooth pieces the true surface has.
pub(crate) fn pieces(shape: &Shape) -> usize {
    match shape {
        Shape::Sphere(_) | Shape::Torus(_) => 1,
        _ => outline(shape).len() - 1,
    }
}

/// The place of a piece of the true surface nearest to one near to it.
pub(crate) fn to_piece(shape: &Shape, piece: usize, place: DVec3) -> DVec3 {
    let radius = place.x.hypot(place.z);
    match shape {
        Shape::Sphere(sphere) => place.normalize() * sphere.radius.get(),
        Shape::Torus(torus) => {
            let middle = turned([torus.major_radius().get(), 0.0], place);
            middle + (place - middle).normalize() * torus.minor_radius().get()
        }
        _ => {
            let corners = outline(shape);
            let [a, b] = [piece, piece + 1].map(|k| DVec3::new(corners[k][0], corners[k][1], 0.0));
            let here = DVec3::new(radius, place.y, 0.0);
            let part = (here - a).dot(b - a) / (b - a).length_squared();
            let on = a + (b - a) * part.clamp(0.0, 1.0);
            match radius == 0.0 {
                true => DVec3::Y * on.y,
                false => turned([on.x, on.y], place),
            }
        }
    }
}

/// The corners of the generating outline in the half plane of distance from and height along the axis.
fn outline(shape: &Shape) -> Vec<[f64; 2]> {
    let (radius, half) = match shape {
        Shape::Cylinder(shape) => (shape.radius, 0.5 * shape.height.get()),
        Shape::Rod(shape) => (shape.radius, 0.5 * shape.length.get()),
        Shape::Cone(shape) => (shape.radius, 0.5 * shape.height.get()),
        _ => unreachable!("made of straight lines about an axis"),
    };
    let (top, bottom) = ([radius.get(), half], [radius.get(), -half]);
    match shape {
        Shape::Cone(_) => vec![[0.0, half], bottom, [0.0, -half]],
        _ => vec![[0.0, half], top, bottom, [0.0, -half]],
    }
}

fn turned([radius, height]: [f64; 2], direction: DVec3) -> DVec3 {
    let aside = DVec3::new(direction.x, 0.0, direction.z).normalize();
    aside * radius + DVec3::Y * height
}
