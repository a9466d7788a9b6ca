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

/// The place of the true surface nearest to one near to it.
pub(crate) fn to_curve(shape: &Shape, place: DVec3) -> DVec3 {
    let radius = place.x.hypot(place.z);
    match shape {
        Shape::Sphere(sphere) => place.normalize() * sphere.radius.get(),
        Shape::Torus(torus) => {
            let middle = turned([torus.major_radius().get(), 0.0], place);
            middle + (place - middle).normalize() * torus.minor_radius().get()
        }
        _ => {
            let to_side = |ends: &[[f64; 2]]| {
                let [a, b] = [
                    DVec3::new(ends[0][0], ends[0][1], 0.0),
                    DVec3::new(ends[1][0], ends[1][1], 0.0),
                ];
                let here = DVec3::new(radius, place.y, 0.0);
                let part = (here - a).dot(b - a) / (b - a).length_squared();
                let on = a + (b - a) * part.clamp(0.0, 1.0);
                (here.distance(on), [on.x, on.y])
            };
            let corners = outline(shape);
            let sides = corners.windows(2).map(to_side);
            let nearest = sides.min_by(|a, b| a.0.total_cmp(&b.0)).expect("sides").1;
            if radius == 0.0 {
                place
            } else {
                turned(nearest, place)
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
