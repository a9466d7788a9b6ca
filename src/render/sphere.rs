//! Where rays meet a sphere: the surface itself, no facets.

use glam::{DAffine3, DVec3};

use super::shape_placement::{ShapePlacement, SmoothHit};
use crate::shape::Sphere;

/// A sphere, or what turning and stretching makes of one.
pub(super) struct Ball {
    shape: Sphere,
    placed: ShapePlacement,
}

impl Ball {
    pub(super) fn new(shape: Sphere, model_to_rest: DAffine3) -> Self {
        let placed = ShapePlacement::new(shape.radius.get(), model_to_rest);
        Self { shape, placed }
    }

    pub(super) fn around(&self) -> (DVec3, f64) {
        self.placed.around()
    }

    /// The nearest hit farther than `beyond` and not as far as `limit`.
    ///
    /// The ray is split at its point closest to the centre, so that the discriminant is a difference of
    /// lengths as small as the sphere, however far away the origin is.
    pub(super) fn cast(
        &self,
        origin: DVec3,
        direction: DVec3,
        beyond: f64,
        limit: f64,
    ) -> Option<SmoothHit> {
        let (origin, direction) = self.placed.ray_to_model(origin, direction);
        let radius = self.shape.radius.get();
        let speed = direction.length();
        let middle = -origin.dot(direction) / speed / speed;
        let closest = (origin + direction * middle).length();
        if !(closest < radius) {
            return None;
        }
        let half = ((radius - closest) * (radius + closest)).sqrt() / speed;
        // Of the two distances middle -+ half the one that would cancel is a quotient of their product.
        let excess = origin.length() - radius;
        let product = excess / speed * ((origin.length() + radius) / speed);
        let (near, far) = match middle > 0.0 {
            true => (product / (middle + half), middle + half),
            false => (middle - half, product / (middle - half)),
        };
        let distance = [near, far]
            .into_iter()
            .find(|&distance| distance > beyond)?;
        if !(distance < limit) {
            return None;
        }
        let place = origin + direction * distance;
        Some(SmoothHit {
            distance,
            normal: self.placed.normal_to_rest(place),
            texture: self.shape.texture_at(place),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Shape;
    use glam::DQuat;

    fn ball(radius: f64, model_to_rest: DAffine3) -> Ball {
        let Ok(Shape::Sphere(shape)) = Shape::sphere(radius) else {
            unreachable!()
        };
        Ball::new(shape, model_to_rest)
    }

    #[test]
    fn a_ray_meets_both_sides_and_none_beside() {
        let ball = ball(2.0, DAffine3::from_translation(DVec3::new(0.0, 0.0, -10.0)));
        let cast = |x: f64, beyond| ball.cast(DVec3::X * x, DVec3::NEG_Z, beyond, f64::MAX);
        assert_eq!(cast(0.0, 0.0).unwrap().distance, 8.0);
        assert_eq!(cast(0.0, 8.0).unwrap().distance, 12.0);
        assert!(cast(0.0, 12.0).is_none());
        assert!(cast(2.0, 0.0).is_none());
        assert!(cast(1.9999, 0.0).is_some());
        assert_eq!(cast(0.0, 0.0).unwrap().normal.normalize(), DVec3::Z);
    }

    /// Exactly representable: a sphere of radius 3 at a distance of 1e8, hit 1 beside its middle.
    #[test]
    fn far_away_nothing_cancels() {
        let ball = ball(3.0, DAffine3::from_translation(DVec3::new(1.0, 0.0, 1e8)));
        let hit = ball.cast(DVec3::ZERO, DVec3::Z, 0.0, f64::MAX).unwrap();
        assert!((hit.distance - (1e8 - 8f64.sqrt())).abs() < 2e-8);
        // From its surface, looking in and out.
        let touching = DVec3::new(1.0, 3.0, 1e8);
        assert!(ball.cast(touching, DVec3::Y, 1e-12, f64::MAX).is_none());
        let through = ball.cast(touching, DVec3::NEG_Y, 1e-12, f64::MAX).unwrap();
        assert_eq!(through.distance, 6.0);
    }

    #[test]
    fn stretched_spheres_are_ellipsoids() {
        let stretch = DAffine3::from_scale_rotation_translation(
            DVec3::new(1.0, 2.0, 3.0),
            DQuat::from_rotation_y(0.5),
            DVec3::new(4.0, 5.0, 6.0),
        );
        let ball = ball(1.5, stretch);
        for aim in [DVec3::new(4.2, 5.5, 6.0), DVec3::new(4.0, 7.0, 7.0)] {
            let hit = ball.cast(DVec3::ZERO, aim, 0.0, f64::MAX).unwrap();
            let place = aim * hit.distance;
            let model = stretch.inverse().transform_point3(place);
            assert!((model.length() - 1.5).abs() < 1e-14);
            // The normal is at right angles to two tangents.
            for step in [DVec3::X, DVec3::Y] {
                let tangent = stretch.matrix3 * model.cross(step);
                assert!(hit.normal.dot(tangent).abs() < 1e-12);
            }
            assert!(hit.normal.dot(aim) < 0.0);
        }
    }
}
