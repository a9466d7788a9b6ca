//! Where rays meet a mesh.
//!
//! The triangle test is that of Woop, Benthin and Wald, *Watertight Ray/Triangle Intersection* (JCGT 2013): the
//! ray is sheared into an axis, and each edge is judged by the same product from both of its sides, so that no
//! ray slips through between two triangles.

use glam::DVec3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhLeafCost, BvhNode};

use crate::mesh::Mesh;

/// The boxes of triangles are larger by this part of the whole mesh: a ray that the triangle test takes,
/// roundings and all, must not be lost at a box.
const BOX_MARGIN: f64 = 1e-12;

/// What three divisions, subtractions and products may round by, twice over (Ize, *Robust BVH Ray Traversal*, JCGT
/// 2013).
const FAR_MARGIN: f64 = 1.0 + 8.0 * f64::EPSILON;

/// A mesh that rays are cast at.
pub(super) struct Caster {
    mesh: Mesh,
    tree: Bvh,
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeshHit {
    pub(super) distance: f64,
    pub(super) corners: [u32; 3],
    /// Barycentric coordinates; their sum is 1.
    pub(super) weights: [f64; 3],
}

/// A ray prepared for many boxes and triangles.
pub(super) struct Ray {
    origin: DVec3,
    inverse: DVec3,
    /// The axis closest to the direction, and the other two, so that handedness is kept.
    axes: [usize; 3],
    shear: DVec3,
}

impl Ray {
    /// `direction` need not be of unit length, distances are in units of it; it is not zero.
    pub(super) fn new(origin: DVec3, direction: DVec3) -> Self {
        let z = direction.abs().max_position();
        let (x, y) = match direction[z] < 0.0 {
            true => ((z + 2) % 3, (z + 1) % 3),
            false => ((z + 1) % 3, (z + 2) % 3),
        };
        let along = direction[z];
        Self {
            origin,
            inverse: direction.recip(),
            axes: [x, y, z],
            shear: DVec3::new(direction[x] / along, direction[y] / along, 1.0 / along),
        }
    }

    /// The distance at which the ray enters the box, or `f64::MAX`.
    fn enters(&self, low: DVec3, high: DVec3) -> f64 {
        let to_low = (low - self.origin) * self.inverse;
        let to_high = (high - self.origin) * self.inverse;
        // 0 * infinity, a ray within a face of the box, is NaN: both functions prefer the other number.
        let span = |axis: usize| {
            (
                to_low[axis].min(to_high[axis]),
                to_low[axis].max(to_high[axis]),
            )
        };
        let ((near_x, far_x), (near_y, far_y), (near_z, far_z)) = (span(0), span(1), span(2));
        let near = near_x.max(near_y).max(near_z).max(0.0);
        let far = far_x.min(far_y).min(far_z) * FAR_MARGIN;
        if near <= far { near } else { f64::MAX }
    }

    /// Distance and weights of the hit with a triangle, and whether it is seen from outside.
    fn meets(&self, corners: [DVec3; 3]) -> Option<(f64, [f64; 3], bool)> {
        let [x, y, z] = self.axes;
        let sheared = corners.map(|corner| {
            let from_origin = corner - self.origin;
            DVec3::new(
                from_origin[x] - self.shear.x * from_origin[z],
                from_origin[y] - self.shear.y * from_origin[z],
                self.shear.z * from_origin[z],
            )
        });
        let [a, b, c] = sheared;
        let areas = [
            c.x * b.y - c.y * b.x,
            a.x * c.y - a.y * c.x,
            b.x * a.y - b.y * a.x,
        ];
        let negative = areas.iter().any(|&area| area < 0.0);
        let positive = areas.iter().any(|&area| area > 0.0);
        if negative && positive {
            return None;
        }
        let sum = areas[0] + areas[1] + areas[2];
        if sum == 0.0 {
            return None;
        }
        let weights = areas.map(|area| area / sum);
        let distance = weights[0] * a.z + weights[1] * b.z + weights[2] * c.z;
        Some((distance, weights, sum > 0.0))
    }
}

impl Caster {
    pub(super) fn new(mesh: Mesh) -> Self {
        let (low, high) = mesh.bounds().unwrap_or_default();
        let margin = DVec3::splat((high - low).length() * BOX_MARGIN);
        let boxes = mesh.triangles().iter().map(|corners| {
            let [a, b, c] = corners.map(|corner| mesh.positions()[corner as usize]);
            Aabb::new(
                to_parry(a.min(b).min(c) - margin),
                to_parry(a.max(b).max(c) + margin),
            )
        });
        let tree = Bvh::from_iter(BvhBuildStrategy::Binned, boxes.enumerate());
        Self { mesh, tree }
    }

    pub(super) fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The nearest hit farther than `beyond` and not as far as `limit`; back sides count if `both_sides`.
    pub(super) fn cast(
        &self,
        ray: &Ray,
        beyond: f64,
        limit: f64,
        both_sides: bool,
    ) -> Option<MeshHit> {
        let enters =
            |node: &BvhNode, _| ray.enters(from_parry(node.mins()), from_parry(node.maxs()));
        let meets = |triangle: u32, _| {
            let corners = self.mesh.triangles()[triangle as usize];
            let places = corners.map(|corner| self.mesh.positions()[corner as usize]);
            let (distance, weights, outside) = ray.meets(places)?;
            (distance > beyond && (outside || both_sides)).then_some(Leaf { distance, weights })
        };
        let (triangle, leaf) = self.tree.find_best(limit, enters, meets)?;
        Some(MeshHit {
            distance: leaf.distance,
            corners: self.mesh.triangles()[triangle as usize],
            weights: leaf.weights,
        })
    }
}

/// What the tree is searched for: the least distance.
struct Leaf {
    distance: f64,
    weights: [f64; 3],
}

impl BvhLeafCost for Leaf {
    fn cost(&self) -> f64 {
        self.distance
    }
}

fn to_parry(vector: DVec3) -> Vector {
    vector.to_array().into()
}

fn from_parry(vector: Vector) -> DVec3 {
    vector.to_array().into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Appearance, Shape};

    fn caster(shape: Shape) -> Caster {
        let mut model = shape.model(&Appearance::default()).unwrap();
        Caster::new(model.parts.pop().unwrap().mesh().clone())
    }

    /// Through vertices and middles of edges, from inside: a closed convex mesh has no way out.
    #[test]
    fn no_ray_slips_through_a_closed_mesh() {
        let shapes = [
            Shape::cuboid([2.0, 2.0, 2.0]).unwrap(),
            Shape::sphere(1.5).unwrap(),
            Shape::cone(2.0, 4.0).unwrap(),
        ];
        for shape in shapes {
            let caster = caster(shape);
            let mesh = caster.mesh();
            let origins = [DVec3::new(0.2, 0.0, 0.1), DVec3::new(0.11, 0.0, 0.0)];
            for origin in origins.map(|o| o + DVec3::X * 0.5) {
                for triangle in mesh.triangles() {
                    let [a, b, c] = triangle.map(|i| mesh.positions()[i as usize]);
                    for aim in [a, b, (a + b) / 2.0, 0.3 * b + 0.7 * c, (a + b + c) / 3.0] {
                        let ray = Ray::new(origin, aim - origin);
                        let hit = caster.cast(&ray, 0.0, f64::MAX, true);
                        let hit = hit.expect("there is no way out");
                        assert!(hit.distance < 1.0 + 1e-12, "{hit:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_tree_finds_what_trying_all_triangles_finds() {
        let caster = caster(Shape::lattice([2, 2, 2], 1.0, 0.3).unwrap());
        let mesh = caster.mesh();
        let mut hits = 0;
        for k in 0..4000_u32 {
            let part = f64::from(k) / 4000.0;
            let (sin, cos) = (part * 300.0).sin_cos();
            let origin = DVec3::new(4.0 * cos, 3.0 * part - 1.5, 4.0 * sin);
            let ray = Ray::new(origin, DVec3::new(0.3 * sin, 0.1, 0.2 * part) - origin);
            for both_sides in [true, false] {
                let all = mesh.triangles().iter().filter_map(|corners| {
                    let found = ray.meets(corners.map(|i| mesh.positions()[i as usize]))?;
                    (found.0 > 0.0 && (found.2 || both_sides)).then_some(found.0)
                });
                let nearest = all.reduce(f64::min);
                let hit = caster.cast(&ray, 0.0, f64::MAX, both_sides);
                assert_eq!(hit.map(|hit| hit.distance), nearest);
                hits += u32::from(nearest.is_some());
            }
        }
        assert!(hits > 4000, "{hits}");
    }

    #[test]
    fn sides_and_weights_are_told() {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let mesh = Mesh::new(positions, vec![[0, 1, 2]]).unwrap();
        let caster = Caster::new(mesh);
        let front = Ray::new(DVec3::new(0.5, 0.25, 3.0), DVec3::NEG_Z);
        let back = Ray::new(DVec3::new(0.5, 0.25, -3.0), DVec3::Z);
        let hit = caster.cast(&front, 0.0, f64::MAX, false).unwrap();
        assert_eq!(hit.distance, 3.0);
        assert_eq!(hit.weights, [0.25, 0.5, 0.25]);
        assert!(caster.cast(&back, 0.0, f64::MAX, false).is_none());
        assert!(caster.cast(&back, 0.0, f64::MAX, true).is_some());
        assert!(caster.cast(&front, 3.0, f64::MAX, true).is_none());
        assert!(caster.cast(&front, 0.0, 3.0, true).is_none());
    }
}
