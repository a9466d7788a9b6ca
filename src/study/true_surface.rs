//! The true surfaces that the facets of round shapes stand for.

use glam::{DAffine3, DVec2, DVec3};

use crate::scene::{Object, Source};
use crate::shape::Shape;

/// The curved surface of a round shape, in the object's rest frame.
pub(super) struct TrueSurface {
    outline: Outline,
    model_to_rest: DAffine3,
    rest_to_model: DAffine3,
}

/// What makes the surface when it is turned about the y axis: distance from the axis, and height.
enum Outline {
    Circle { middle: DVec2, radius: f64 },
    Polyline(Vec<DVec2>),
}

impl TrueSurface {
    /// That of an object; `None` where the facets are the surface.
    pub(super) fn of(object: &Object) -> Option<Self> {
        let Source::Shape(shape, _) = &object.source else {
            return None;
        };
        let model_to_rest = object.model_to_rest();
        Some(Self {
            outline: Outline::of(shape)?,
            model_to_rest,
            rest_to_model: model_to_rest.inverse(),
        })
    }

    /// The point of the surface that is nearest to `point_rest`, before the object's scale.
    pub(super) fn nearest(&self, point_rest: DVec3) -> DVec3 {
        let point = self.rest_to_model.transform_point3(point_rest);
        let from_axis = point.x.hypot(point.z);
        let nearest = self.outline.nearest(DVec2::new(from_axis, point.y));
        let outward = match from_axis {
            0.0 => DVec2::X,
            _ => DVec2::new(point.x, point.z) / from_axis,
        };
        let across = outward * nearest.x;
        self.model_to_rest
            .transform_point3(DVec3::new(across.x, nearest.y, across.y))
    }
}

impl Outline {
    fn of(shape: &Shape) -> Option<Self> {
        let cylinder = |radius: f64, length: f64| {
            let (top, bottom) = (0.5 * length, -0.5 * length);
            let corners = [(0.0, top), (radius, top), (radius, bottom), (0.0, bottom)];
            Self::Polyline(corners.map(DVec2::from).to_vec())
        };
        match shape {
            Shape::Sphere(sphere) => Some(Self::Circle {
                middle: DVec2::ZERO,
                radius: sphere.radius.get(),
            }),
            Shape::Torus(torus) => Some(Self::Circle {
                middle: DVec2::new(torus.major_radius().get(), 0.0),
                radius: torus.minor_radius().get(),
            }),
            Shape::Cylinder(shape) => Some(cylinder(shape.radius.get(), shape.height.get())),
            Shape::Rod(shape) => Some(cylinder(shape.radius.get(), shape.length.get())),
            Shape::Cone(cone) => {
                let (radius, top) = (cone.radius.get(), 0.5 * cone.height.get());
                let corners = [(0.0, top), (radius, -top), (0.0, -top)];
                Some(Self::Polyline(corners.map(DVec2::from).to_vec()))
            }
            Shape::Cuboid(_) | Shape::Grid(_) | Shape::Lattice(_) => None,
        }
    }

    fn nearest(&self, point: DVec2) -> DVec2 {
        match self {
            Self::Circle { middle, radius } => {
                let outward = (point - *middle).try_normalize().unwrap_or(DVec2::X);
                *middle + outward * *radius
            }
            Self::Polyline(corners) => {
                let on_sides = corners.windows(2).map(|side| {
                    let along = side[1] - side[0];
                    let part = (point - side[0]).dot(along) / along.length_squared();
                    side[0] + along * part.clamp(0.0, 1.0)
                });
                let nearer = |a: DVec2, b: DVec2| match point.distance_squared(a)
                    <= point.distance_squared(b)
                {
                    true => a,
                    false => b,
                };
                on_sides.reduce(nearer).unwrap_or(point)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Rotation, Scale};
    use crate::shape::{Appearance, Shape};

    fn object(shape: Shape) -> Object {
        Object::new("object", Source::Shape(shape, Appearance::default()))
    }

    #[test]
    fn nearest_points_are_those_of_the_true_shapes() {
        let nearest = |shape: Shape, point: [f64; 3]| {
            let surface = TrueSurface::of(&object(shape)).unwrap();
            surface.nearest(point.into()).to_array()
        };
        let sphere = Shape::sphere(2.0).unwrap();
        assert_eq!(nearest(sphere, [0.0, 1.5, 0.0]), [0.0, 2.0, 0.0]);
        let cylinder = Shape::cylinder(1.0, 4.0).unwrap();
        assert_eq!(
            nearest(cylinder.clone(), [0.0, 0.5, -0.75]),
            [0.0, 0.5, -1.0]
        );
        assert_eq!(nearest(cylinder, [0.25, 2.0, 0.0]), [0.25, 2.0, 0.0]);
        let torus = Shape::torus(2.0, 0.5).unwrap();
        assert_eq!(nearest(torus, [-2.25, 0.0, 0.0]), [-2.5, 0.0, 0.0]);
        // The side of this cone is inclined by 45 degrees and passes through (1, 0, 0) from its axis.
        let cone = Shape::cone(2.0, 2.0).unwrap();
        assert_eq!(nearest(cone, [0.875, -0.125, 0.0]), [1.0, 0.0, 0.0]);
        assert!(TrueSurface::of(&object(Shape::grid(1.0, 1).unwrap())).is_none());
    }

    #[test]
    fn scale_and_rotation_of_the_object_count() {
        let mut object = object(Shape::sphere(1.0).unwrap());
        object.scale = Scale::new(DVec3::new(3.0, 1.0, 1.0)).unwrap();
        let quarter = glam::DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2);
        object.rotation = Rotation::new(quarter).unwrap();
        let nearest = TrueSurface::of(&object)
            .unwrap()
            .nearest(DVec3::new(0.0, 2.5, 0.0));
        assert!(
            (nearest - DVec3::new(0.0, 3.0, 0.0)).length() < 1e-14,
            "{nearest}"
        );
    }
}
