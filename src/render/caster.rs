//! Where rays meet a mesh.

use glam::DVec3;

use super::bounds::Bounds;
use super::ray::Ray;
use super::tree::Tree;
use crate::mesh::Mesh;

/// A mesh that rays are cast at.
pub(super) struct Caster {
    mesh: Mesh,
    tree: Tree,
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeshHit {
    pub(super) distance: f64,
    pub(super) corners: [u32; 3],
    /// Barycentric coordinates; their sum is 1.
    pub(super) weights: [f64; 3],
}

impl Caster {
    pub(super) fn new(mesh: Mesh) -> Self {
        let corners = |triangle: u32| places(&mesh, mesh.triangles()[triangle as usize]);
        let tree = Tree::of_triangles(mesh.triangles().len(), &corners);
        Self { mesh, tree }
    }

    pub(super) fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// A box around all triangles, if there are some.
    pub(super) fn bounds(&self) -> Option<Bounds> {
        self.tree.bounds()
    }

    /// The nearest hit farther than `beyond` and not as far as `limit`, of the first of several triangles that are hit there;
    /// back sides count if `both_sides`.
    pub(super) fn cast(
        &self,
        ray: &Ray,
        beyond: f64,
        limit: f64,
        both_sides: bool,
    ) -> Option<MeshHit> {
        let mut nearest: Option<(u32, MeshHit)> = None;
        self.tree.along(ray, limit, |triangle| {
            let corners = self.mesh.triangles()[triangle as usize];
            let farthest = nearest.map_or(limit, |(_, hit)| hit.distance);
            let Some((distance, weights, outside)) = ray.meets(places(&self.mesh, corners)) else {
                return farthest;
            };
            let is_first = nearest.is_some_and(|(first, _)| triangle < first);
            let is_nearer = distance < farthest || (distance == farthest && is_first);
            if !(distance > beyond && is_nearer && (outside || both_sides)) {
                return farthest;
            }
            let hit = MeshHit {
                distance,
                corners,
                weights,
            };
            nearest = Some((triangle, hit));
            distance
        });
        nearest.map(|(_, hit)| hit)
    }
}

fn places(mesh: &Mesh, corners: [u32; 3]) -> [DVec3; 3] {
    // A mesh holds no index beyond its vertices.
    corners.map(|corner| mesh.positions()[corner as usize])
}

#[cfg(test)]
mod tests {
    use super::super::tree::counted;
    use super::*;
    use crate::shape::{Appearance, Shape};

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

    /// A tilted disc of slivers, from its middle or from a point of its rim, as programs for design make them; the
    /// slivers are its last triangles.
    fn disc(count: u32, from_rim: bool) -> Caster {
        let rim = (0..count).map(|k| {
            let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / f64::from(count)).sin_cos();
            DVec3::new(cos * 0.7f64.cos(), sin, cos * 0.7f64.sin())
        });
        let positions: Vec<_> = rim.chain([DVec3::ZERO]).collect();
        let triangles = match from_rim {
            true => (1..count - 1).map(|k| [0, k, k + 1]).collect(),
            false => (0..count).map(|k| [count, k, (k + 1) % count]).collect(),
        };
        Caster::new(Mesh::new(positions, triangles).unwrap())
    }

    /// Rays evenly over the disc; the mean number of boxes that one is held against, and how many hit.
    fn boxes_a_ray(caster: &Caster) -> (f64, u32) {
        let (mut rays, mut hits) = (0, 0);
        counted::BOXES.set(0);
        for k in 0..2000 {
            let part = (f64::from(k) + 0.5) / 2000.0;
            let (sin, cos) = (f64::from(k) * 2.399_963).sin_cos();
            let aim = part.sqrt() * DVec3::new(cos * 0.7f64.cos(), sin, cos * 0.7f64.sin());
            let origin = DVec3::new(0.3, -0.2, 3.0);
            let ray = Ray::new(origin, aim - origin);
            hits += u32::from(caster.cast(&ray, 0.0, f64::MAX, true).is_some());
            rays += 1;
        }
        (counted::BOXES.get() as f64 / f64::from(rays), hits)
    }

    /// Work that is counted, not timed. Boxes along the axes around 12,000 slivers overlap so that a ray is held against
    /// thousands of them.
    #[test]
    fn slivers_take_a_ray_hardly_more_than_other_triangles() {
        for from_rim in [true, false] {
            for count in [1000, 12_000] {
                let (boxes, hits) = boxes_a_ray(&disc(count, from_rim));
                assert!(hits > 1980, "{hits}");
                // A tree of 12,000 has 13 levels or more, with two boxes looked at in each.
                assert!(boxes < 150.0, "{count} {from_rim}: {boxes}");
            }
        }
    }

    #[test]
    fn slanted_boxes_find_what_trying_all_slivers_finds() {
        for from_rim in [true, false] {
            let caster = disc(400, from_rim);
            let mesh = caster.mesh();
            for k in 0..1500 {
                let part = (f64::from(k) + 0.5) / 1500.0;
                let (sin, cos) = (f64::from(k) * 2.399_963).sin_cos();
                let aim =
                    1.01 * part.sqrt() * DVec3::new(cos * 0.7f64.cos(), sin, cos * 0.7f64.sin());
                // Also far away, where a ray that a triangle takes may be beside its box by roundings.
                for origin in [DVec3::new(0.3, -0.2, 3.0), DVec3::new(3e9, -2e9, 3e10)] {
                    let ray = Ray::new(origin, aim - origin);
                    let all = mesh.triangles().iter().filter_map(|&corners| {
                        Some((ray.meets(places(mesh, corners))?.0, corners))
                    });
                    let nearest = all.reduce(|a, b| if b.0 < a.0 { b } else { a });
                    let hit = caster.cast(&ray, 0.0, f64::MAX, true);
                    assert_eq!(hit.map(|hit| (hit.distance, hit.corners)), nearest);
                }
            }
        }
    }
}
