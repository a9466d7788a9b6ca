//! Where rays meet cylinders, rods and cones: the surfaces themselves, no facets.

use glam::{DAffine3, DVec2, DVec3};

use super::shape_placement::{ShapePlacement, SmoothHit};
use crate::shape::Band;

/// A meeting that is no farther than this from the origin of the ray, in radii of the shape, is none.
const ON_SURFACE: f64 = 1e-12;

/// A closed surface of straight bands turned about an axis, or what turning and stretching makes of it.
pub(super) struct Turned {
    bands: Vec<Band>,
    /// No place is farther from the middle, in the shape's own coordinates.
    radius: f64,
    placed: ShapePlacement,
}

impl Turned {
    pub(super) fn new(bands: Vec<Band>, model_to_rest: DAffine3) -> Self {
        let ends = bands.iter().flat_map(|band| band.ends);
        let radius = ends.map(DVec2::length).fold(0.0, f64::max);
        Self {
            bands,
            radius,
            placed: ShapePlacement::new(radius, model_to_rest),
        }
    }

    pub(super) fn around(&self) -> (DVec3, f64) {
        self.placed.around()
    }

    /// The nearest hit farther than `beyond` and not as far as `limit`.
    ///
    /// The ray of a far origin is followed from its point closest to the middle, so that the numbers are as small as the
    /// shape. What is as good as at the origin is not met.
    pub(super) fn cast(
        &self,
        origin: DVec3,
        direction: DVec3,
        beyond: f64,
        limit: f64,
    ) -> Option<SmoothHit> {
        let (origin, direction) = self.placed.ray_to_model(origin, direction);
        let speed = direction.length();
        let direction = direction / speed;
        // From the tip of a cone both meetings are at the origin, which is exact only from there.
        let middle = match origin.length() < 2.0 * self.radius {
            true => 0.0,
            false => -origin.dot(direction),
        };
        let start = origin + direction * middle;
        // A surface that the origin is on is met there or not, as rounding has it.
        let on_surface = ON_SURFACE * self.radius;
        let mut nearest: Option<(f64, &Band)> = None;
        for band in &self.bands {
            for after in meetings(band, start, direction).into_iter().flatten() {
                let distance = (middle + after) / speed;
                let is_nearest = nearest.is_none_or(|(found, _)| distance < found);
                let is_ahead = distance > beyond && middle + after > on_surface;
                if is_ahead && distance < limit && is_nearest {
                    nearest = Some((distance, band));
                }
            }
        }
        let (distance, band) = nearest?;
        let place = start + direction * (distance * speed - middle);
        let outwards = DVec2::new(place.x, place.z).normalize_or_zero() * band.normal.x;
        let normal = DVec3::new(outwards.x, band.normal.y, outwards.y);
        Some(SmoothHit {
            distance,
            normal: self.placed.normal_to_rest(normal),
            texture: band.texture_at(place),
        })
    }
}

/// How far after `start` a ray meets a band: once at most for a disc, twice for the side of a cone.
fn meetings(band: &Band, start: DVec3, direction: DVec3) -> [Option<f64>; 2] {
    let [upper, lower] = band.ends;
    if upper.y == lower.y {
        let after = (upper.y - start.y) / direction.y;
        let place = start + direction * after;
        let on_disc = place.x.hypot(place.z) <= upper.x.max(lower.x);
        return [(after.is_finite() && on_disc).then_some(after), None];
    }
    // The distance from the axis is that of the band: two squares are equal.
    let slope = (upper.x - lower.x) / (upper.y - lower.y);
    let radius = lower.x + slope * (start.y - lower.y);
    let growth = slope * direction.y;
    let across = |vector: DVec3| DVec2::new(vector.x, vector.z);
    let (from_axis, outwards) = (across(start), across(direction));
    let squared = outwards.length_squared() - growth * growth;
    let half_linear = from_axis.dot(outwards) - radius * growth;
    let constant = (from_axis.length() - radius) * (from_axis.length() + radius);
    let discriminant = half_linear * half_linear - squared * constant;
    if !(discriminant >= 0.0) {
        return [None; 2];
    }
    // The larger root in size, and the other one from the product of both, so that nothing cancels.
    let sum = -(half_linear + discriminant.sqrt().copysign(half_linear));
    [sum / squared, constant / sum].map(|after| {
        let height = start.y + direction.y * after;
        // Beyond its tip a cone goes on, upside down.
        (height <= upper.y && height >= lower.y).then_some(after)
    })
}

#[cfg(test)]
mod tests {
    use super::super::caster::Caster;
    use super::super::ray::Ray;
    use super::*;
    use crate::shape::{Appearance, Shape};
    use glam::DQuat;

    /// Against facets within `1.5 (1 - cos(pi / 800))`, the 1.5 being the scale: where a ray comes in at a cosine of
    /// more than 0.3, the distance differs by at most that over 0.3, or 0.29 for a facet that is turned by pi / 800.
    #[test]
    fn rays_meet_what_facets_come_close_to() {
        let placed = DAffine3::from_scale_rotation_translation(
            DVec3::new(1.0, 1.5, 0.8),
            DQuat::from_euler(glam::EulerRot::XYZ, 0.5, 1.0, -0.3),
            DVec3::new(0.5, -1.0, 2.0),
        );
        for shape in [
            Shape::cylinder(1.0, 2.0).unwrap(),
            Shape::rod(3.0, 0.4).unwrap(),
            Shape::cone(1.0, 1.5).unwrap(),
        ] {
            let turned = Turned::new(shape.bands().unwrap(), placed);
            let fine = shape.clone().with_resolution(800).unwrap();
            let mut model = fine.model(&Appearance::default()).unwrap();
            let part = model.parts.pop().unwrap().transformed(&placed);
            let caster = Caster::new(part.mesh().clone());
            let (center, radius) = turned.around();
            let mut compared = 0;
            for k in 0..4000 {
                let angle = f64::from(k) * 2.399_963;
                let height = (f64::from(k) + 0.5) / 2000.0 - 1.0;
                let flat = (1.0 - height * height).sqrt();
                let away = DVec3::new(flat * angle.cos(), height, flat * angle.sin());
                let aim = center + radius * 0.6 * DVec3::new(angle.sin(), (3.0 * angle).cos(), 0.3);
                let origin = center + away * 5.0;
                let direction = (aim - origin).normalize();
                let facets = caster.cast(&Ray::new(origin, direction), 0.0, f64::MAX, true);
                let smooth = turned.cast(origin, direction, 0.0, f64::MAX);
                let (Some(facets), Some(smooth)) = (facets, smooth) else {
                    continue;
                };
                if smooth.normal.normalize().dot(direction).abs() < 0.3 {
                    continue;
                }
                let error = (smooth.distance - facets.distance).abs();
                assert!(error < 1.5 * 7.8e-6 / 0.29, "{shape:?} {k}: {error}");
                let between = |values: &[DVec3]| {
                    let weighted = facets.corners.iter().zip(facets.weights);
                    weighted
                        .map(|(&c, w)| values[c as usize] * w)
                        .sum::<DVec3>()
                };
                let normal = between(caster.mesh().normals().unwrap()).normalize();
                assert!(
                    normal.dot(smooth.normal.normalize()) > 0.999,
                    "{shape:?} {k}"
                );
                let texture = caster.mesh().texture_coordinates()[0].iter();
                let texture: Vec<_> = texture.map(|t| t.as_dvec2().extend(0.0)).collect();
                let off = (between(&texture).truncate() - smooth.texture).abs();
                assert!(off.max_element() < 0.05, "{shape:?} {k}: {off}");
                compared += 1;
            }
            assert!(compared > 1000, "{compared}");
        }
    }

    /// What is seen from the tip of a cone: its base through its inside, and beside that nothing.
    #[test]
    fn from_its_tip_a_cone_is_seen_from_inside() {
        let there = DAffine3::from_scale_rotation_translation(
            DVec3::splat(0.7),
            DQuat::from_euler(glam::EulerRot::XYZ, 0.5, 1.0, -0.3),
            DVec3::new(0.5, -1.0, 2.0),
        );
        let cone = Shape::cone(1.0, 2.0).unwrap();
        let turned = Turned::new(cone.bands().unwrap(), there);
        let tip = there.transform_point3(DVec3::Y);
        let (mut through, mut beside) = (0, 0);
        for k in 0..10_000 {
            let angle = f64::from(k) * 2.399_963;
            let height = (f64::from(k) + 0.5) / 5000.0 - 1.0;
            let flat = (1.0 - height * height).sqrt();
            // The base is 2 below, with a radius of 1.
            let out = 2.0 * flat / -height;
            if (out - 1.0).abs() < 1e-9 {
                continue;
            }
            let direction = DVec3::new(flat * angle.cos(), height, flat * angle.sin());
            let hit = turned.cast(tip, there.transform_vector3(direction), 0.0, f64::MAX);
            if height < 0.0 && out < 1.0 {
                let error = (hit.expect("the base").distance + 2.0 / height).abs();
                assert!(error < 1e-14, "{k}: {error}");
                through += 1;
            } else {
                assert!(hit.is_none(), "{k}: {}", hit.unwrap().distance);
                beside += 1;
            }
        }
        assert!(through > 500 && beside > 9000, "{through} {beside}");
    }

    /// A cylinder 1e8 away, hit 1 beside its axis; along its axis, and through its wall from inside.
    #[test]
    fn far_away_nothing_cancels() {
        let cylinder = Shape::cylinder(3.0, 4.0).unwrap();
        let there = DAffine3::from_translation(DVec3::new(1.0, 0.0, 1e8));
        let turned = Turned::new(cylinder.bands().unwrap(), there);
        let hit = turned.cast(DVec3::ZERO, DVec3::Z, 0.0, f64::MAX).unwrap();
        assert!((hit.distance - (1e8 - 8f64.sqrt())).abs() < 2e-8);
        let here = Turned::new(cylinder.bands().unwrap(), DAffine3::IDENTITY);
        let down = here.cast(DVec3::Y * 10.0, DVec3::NEG_Y, 0.0, f64::MAX);
        assert_eq!(down.unwrap().distance, 8.0);
        let out = here.cast(DVec3::ZERO, DVec3::X, 0.0, f64::MAX).unwrap();
        assert_eq!((out.distance, out.normal), (3.0, DVec3::X));
        assert!(here.cast(DVec3::Y * 2.5, DVec3::X, 0.0, f64::MAX).is_none());
    }
}
