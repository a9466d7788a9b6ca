//! All bodies for the moment of one picture, so that a ray asks only those near its way.
//!
//! Bodies that rest in one frame are a group with a tree of their boxes there, along the ray as it is in that frame. What
//! different groups take up of the sky is a tree of its own.

use glam::DVec3;

use super::Viewpoint;
use super::aberration::{Aberration, RestRay};
use super::body::{Body, BodyHit, Hit, Stands};
use super::bounds::Bounds;
use super::cone::Cone;
use super::ray::Ray;
use super::shading::Facing;
use super::tree::Tree;
use crate::spacetime::{ViewModel, WorldLine, unit};

/// A distance at rest that is turned into one that is seen and back may be rounded by this part.
const THERE_AND_BACK: f64 = 1.0 + 4.0 * f64::EPSILON;

pub(super) struct Crowd<'a> {
    eye: DVec3,
    /// Each with how the observer sees it; none from outside, and for what has no motion.
    bodies: Vec<(&'a Body, Option<Aberration>)>,
    groups: Vec<Group>,
    /// Of what the groups take up of the sky.
    sky: Tree,
}

/// Bodies that follow each other and have one frame.
struct Group {
    /// From the observer's frame to that of the bodies' geometry, where they are at rest.
    aberration: Option<Aberration>,
    cone: Cone,
    /// The number of its first body.
    first: usize,
    /// Of bodies, counted from the first.
    tree: Tree,
}

/// A ray in the frame of a group, followed back from the eye.
struct Path {
    ray: RestRay,
    /// The same, prepared for what it may meet.
    prepared: Ray,
}

/// What is nearest so far: of several at one distance the first.
struct Found {
    distance: f64,
    body: usize,
    hit: BodyHit,
    ray: RestRay,
}

/// What an observer sees of a place of a surface.
pub(super) struct Observed<'a> {
    pub(super) object: &'a str,
    /// The number of the observer's moment, of those of a scenery.
    pub(super) moment: usize,
    /// From the observer, in the rest frame of the surface.
    pub(super) offset_rest: DVec3,
    /// The unit direction in which its light arrives, and how far away it is seen, where it is shown there.
    pub(super) seen: Option<(DVec3, f64)>,
    /// In the rest frame of the surface.
    pub(super) facing: Facing,
}

impl<'a> Crowd<'a> {
    pub(super) fn new(bodies: impl Iterator<Item = &'a Body>, viewpoint: Viewpoint) -> Self {
        let eye = viewpoint.eye();
        let mut placed = Vec::new();
        // Where each group begins and the motion of those that are at rest in it.
        let mut starts: Vec<(usize, Option<(WorldLine, ViewModel)>)> = Vec::new();
        for body in bodies {
            let aberration = match (viewpoint, body.stands) {
                (Viewpoint::Observer(moment), Stands::AtRest(line, model)) => {
                    Some(Aberration::new(moment, &line, model))
                }
                (Viewpoint::Observer(_), Stands::Mapped(mapped)) => Some(mapped.aberration),
                _ => None,
            };
            let rests = match (&aberration, body.stands) {
                (Some(_), Stands::AtRest(line, model)) => Some((line, model)),
                _ => None,
            };
            if starts.last().is_none_or(|&(_, last)| last != rests) {
                starts.push((placed.len(), rests));
            }
            placed.push((body, aberration));
        }
        let ends = starts.iter().skip(1).map(|start| start.0);
        let ends = ends.chain([placed.len()]);
        let groups = starts.iter().zip(ends).map(|(&(start, rests), end)| {
            let aberration = rests.and(placed[start].1);
            Group::new(eye, aberration, start, &placed[start..end])
        });
        let groups: Vec<_> = groups.collect();
        let on_sky: Vec<_> = groups.iter().map(|group| group.cone.bounds()).collect();
        Self {
            eye,
            bodies: placed,
            groups,
            sky: Tree::new(&on_sky),
        }
    }

    /// From where it is seen, in the observer's frame.
    pub(super) fn eye(&self) -> DVec3 {
        self.eye
    }

    /// The first thing that a ray along `seen` meets, farther than `beyond` and not as far as `limit`, both as seen.
    pub(super) fn nearest(
        &self,
        seen: DVec3,
        beyond: f64,
        limit: f64,
        wires: bool,
    ) -> Option<Hit<'a>> {
        let mut found: Option<Found> = None;
        self.in_view(seen, |group| {
            let path = group.path(self.eye, seen);
            let farthest = found.as_ref().map_or(limit, |found| found.distance);
            let [beyond, rest_limit] = [beyond, farthest].map(|d| path.to_rest(d));
            // Including what is as far as what was found: it may be the first.
            let rest_limit = match found {
                Some(_) => (rest_limit * THERE_AND_BACK).min(f64::MAX),
                None => rest_limit,
            };
            let Some((body, hit)) = group.nearest(&self.bodies, &path.prepared, beyond, rest_limit)
            else {
                return;
            };
            let distance = hit.distance() / path.ray.stretch;
            let is_nearer = found.as_ref().is_none_or(|found| {
                distance < found.distance || (distance == found.distance && body < found.body)
            });
            if is_nearer {
                found = Some(Found {
                    distance,
                    body,
                    hit,
                    ray: path.ray,
                });
            }
        });
        found.map(|found| self.seen(&found, seen, wires))
    }

    /// The first hit on every body that a ray along `seen` meets, in the order of the bodies.
    pub(super) fn all(&self, seen: DVec3) -> Vec<Hit<'a>> {
        let mut all = Vec::new();
        self.in_view(seen, |group| {
            let path = group.path(self.eye, seen);
            group.tree.along(&path.prepared, f64::MAX, |number| {
                let body = group.first + number as usize;
                if let Some(hit) = self.bodies[body].0.cast(&path.prepared, 0.0, f64::MAX) {
                    let found = Found {
                        distance: hit.distance() / path.ray.stretch,
                        body,
                        hit,
                        ray: path.ray,
                    };
                    all.push(self.seen(&found, seen, false));
                }
                f64::MAX
            });
        });
        all.sort_unstable_by_key(|hit| hit.body);
        all
    }

    /// Frequency seen over frequency emitted of a hit in the direction `seen`, for the observer: of photosurfaces that are
    /// seen from outside too. `None` of what has no motion.
    pub(super) fn doppler(&self, hit: &Hit, seen: DVec3) -> Option<f64> {
        let (body, aberration) = &self.bodies[hit.body];
        match (aberration, body.stands) {
            (Some(_), _) => Some(hit.doppler),
            (None, Stands::Mapped(mapped)) => {
                let place = self.eye + seen * hit.distance;
                Some(unit(place).map_or(1.0, |seen| mapped.aberration.ray(seen).doppler))
            }
            (None, Stands::AtRest(..) | Stands::InView) => None,
        }
    }

    /// Of a hit in the direction `seen`: what the observer sees of that place, also from outside. `None` of what has no
    /// observer.
    pub(super) fn observed(&self, hit: &Hit, seen: DVec3) -> Option<Observed<'a>> {
        let &(body, aberration) = &self.bodies[hit.body];
        let object = body.object.as_str();
        if let Some(aberration) = aberration {
            let ray = aberration.ray(seen);
            let model = match body.stands {
                Stands::AtRest(_, model) => model,
                Stands::Mapped(mapped) => mapped.model,
                Stands::InView => return None,
            };
            return Some(Observed {
                object,
                moment: 0,
                offset_rest: ray.direction * (ray.stretch * hit.distance),
                seen: (model == ViewModel::Seen).then_some((seen, hit.distance)),
                facing: hit.facing,
            });
        }
        let Stands::Mapped(mapped) = body.stands else {
            return None;
        };
        let place = self.eye + seen * hit.distance;
        let distance = place.length();
        let from_observer = unit(place)?;
        let ray = mapped.aberration.ray(from_observer);
        let normal = mapped
            .aberration
            .normal_at_rest(hit.facing.normal, from_observer);
        let to_eye = -ray.direction;
        Some(Observed {
            object,
            moment: mapped.moment,
            offset_rest: ray.direction * (ray.stretch * distance),
            seen: (mapped.model == ViewModel::Seen).then_some((from_observer, distance)),
            facing: Facing {
                normal: normal.unwrap_or(to_eye),
                to_eye,
            },
        })
    }

    /// Visits the groups that may be seen in a direction.
    fn in_view(&self, seen: DVec3, mut visit: impl FnMut(&Group)) {
        self.sky.holding(seen, |number| {
            let group = &self.groups[number as usize];
            if group.cone.may_hold(seen) {
                visit(group);
            }
        });
    }

    fn seen(&self, found: &Found, seen: DVec3, wires: bool) -> Hit<'a> {
        let (body, aberration) = &self.bodies[found.body];
        body.seen(
            found.body,
            &found.hit,
            found.ray,
            seen,
            aberration.as_ref(),
            wires,
        )
    }
}

impl Group {
    fn new(
        eye: DVec3,
        aberration: Option<Aberration>,
        first: usize,
        bodies: &[(&Body, Option<Aberration>)],
    ) -> Self {
        // A body of nothing is nowhere, but has its number.
        let nothing = Bounds {
            low: eye,
            high: eye,
        };
        let bounds = bodies
            .iter()
            .map(|(body, _)| body.geometry.bounds().unwrap_or(nothing));
        let bounds: Vec<_> = bounds.collect();
        let tree = Tree::new(&bounds);
        let (center, radius) = match bodies {
            // Of what is round the ball is smaller than that around its box.
            [(body, _)] => body.geometry.ball(),
            _ => tree.bounds().map_or((eye, 0.0), |bounds| bounds.ball()),
        };
        let cone = match &aberration {
            Some(aberration) => aberration.cone(center, radius),
            None => Cone::of_ball(eye, center, radius),
        };
        Self {
            aberration,
            cone,
            first,
            tree,
        }
    }

    fn path(&self, eye: DVec3, seen: DVec3) -> Path {
        let ray = match &self.aberration {
            Some(aberration) => aberration.ray(seen),
            None => RestRay::unmoved(eye, seen),
        };
        Path {
            ray,
            prepared: Ray::new(ray.origin, ray.direction),
        }
    }

    /// The nearest hit farther than `beyond` and not as far as `limit`, with the number of the body: of several at one
    /// distance the first.
    fn nearest(
        &self,
        bodies: &[(&Body, Option<Aberration>)],
        ray: &Ray,
        beyond: f64,
        limit: f64,
    ) -> Option<(usize, BodyHit)> {
        let mut nearest: Option<(usize, BodyHit)> = None;
        self.tree.along(ray, limit, |number| {
            let body = self.first + number as usize;
            let farthest = nearest.as_ref().map_or(limit, |(_, hit)| hit.distance());
            let is_first = nearest.as_ref().is_some_and(|&(first, _)| body < first);
            // Including what is as far as what was found.
            let reach = if is_first {
                farthest.next_up()
            } else {
                farthest
            };
            match bodies[body].0.cast(ray, beyond, reach) {
                Some(hit) => {
                    let distance = hit.distance();
                    nearest = Some((body, hit));
                    distance
                }
                None => farthest,
            }
        });
        nearest
    }
}

impl Path {
    fn to_rest(&self, seen: f64) -> f64 {
        (seen * self.ray.stretch).min(f64::MAX)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use serde_json::json;

    use super::super::tree::counted;
    use super::super::{Camera, PictureSize, Projection, Scenery, grid_places};
    use super::*;
    use crate::scene::{BuiltInScene, Scene, Source};
    use crate::shape::{Appearance, Shape};
    use glam::DVec2;

    /// All objects of a scene of shapes at rest.
    fn scenery(scene: &Scene) -> Scenery {
        let mut scenery = Scenery::new();
        for object in scene.objects() {
            let Source::Shape(shape, appearance) = &object.source else {
                panic!("a scene of shapes")
            };
            for part in shape.model(appearance).unwrap().parts {
                let mut part = part.transformed(&object.model_to_rest());
                // Textures do not matter here and take long to decode.
                part.material = None;
                scenery.add_at_rest(object, &part);
            }
        }
        scenery
    }

    fn camera(look: DVec3) -> Camera {
        let size = PictureSize::new(96, 72).unwrap();
        let projection = Projection::Perspective {
            vertical_fov_deg: 60.0,
        };
        Camera::new(size, projection, look).unwrap()
    }

    fn rays(camera: &Camera) -> impl Iterator<Item = DVec3> {
        let (width, height) = (camera.size().width(), camera.size().height());
        let corners = (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)));
        corners.flat_map(move |(x, y)| {
            grid_places(3)
                .map(move |place| camera.direction(DVec2::new(x.into(), y.into()) + place))
        })
    }

    /// Every body alone is the judge: the nearest is what is seen, and of several at one distance the first.
    #[test]
    fn a_crowd_finds_what_asking_every_body_finds() {
        for (name, look) in [
            ("street", DVec3::NEG_Z),
            ("street", DVec3::Z),
            ("cube", DVec3::X),
        ] {
            let scene = Scene::from_json(BuiltInScene::named(name).unwrap().json).unwrap();
            let scenery = scenery(&scene);
            let moment = scene.moment(0).unwrap();
            let viewpoint = Viewpoint::Observer(&moment);
            let crowd = Crowd::new(scenery.bodies.iter(), viewpoint);
            let alone = scenery.bodies.iter();
            let alone: Vec<_> = alone
                .map(|body| Crowd::new(std::iter::once(body), viewpoint))
                .collect();
            for seen in rays(&camera(look)) {
                let mut nearest: Option<Hit> = None;
                for hit in alone
                    .iter()
                    .filter_map(|one| one.nearest(seen, 0.0, f64::MAX, false))
                {
                    if nearest
                        .as_ref()
                        .is_none_or(|nearest| hit.distance < nearest.distance)
                    {
                        nearest = Some(hit);
                    }
                }
                let found = crowd.nearest(seen, 0.0, f64::MAX, false);
                let told = |hit: Hit| (hit.distance, hit.facing, hit.doppler, hit.texture);
                assert_eq!(found.map(told), nearest.map(told), "{name} {seen}");
            }
        }
    }

    /// Of an observer at 0.8 c in the middle of a ball and of a box: the ray alone says what the Doppler factor is,
    /// `1 / (gamma (1 - beta cos angle))` with the angle that is seen, whatever is hit.
    #[test]
    fn hits_know_how_light_is_shifted() {
        let scene = |shape| {
            let scene = json!({
                "observer": { "velocity": { "beta": 0.8, "direction": [0, 0, -1] } },
                "objects": [{ "name": "around", "shape": shape }],
            });
            Scene::from_json(&scene.to_string()).unwrap()
        };
        let ball = scene(json!({ "sphere": { "radius": 9 } }));
        let cube = scene(json!({ "box": { "size": [9, 9, 9] } }));
        let moment = ball.moment(0).unwrap();
        let mut mapped = Scenery::new();
        let cubes = scenery(&cube);
        let Source::Shape(shape, appearance) = &cube.objects()[0].source else {
            unreachable!()
        };
        let model = shape.model(appearance).unwrap();
        mapped.add_photosurface(&cube.objects()[0], &moment, model.parts[0].mesh(), None);
        let balls = scenery(&ball);
        for (scenery, is_ball) in [(&balls, true), (&cubes, false), (&mapped, false)] {
            let observer = Viewpoint::Observer(&moment);
            for (viewpoint, is_moving) in
                [(observer, true), (Viewpoint::Outside(DVec3::ZERO), false)]
            {
                let crowd = Crowd::new(scenery.bodies.iter(), viewpoint);
                for seen in rays(&camera(DVec3::new(0.0, 0.9, -1.0))).step_by(101) {
                    let hit = crowd.nearest(seen, 0.0, f64::MAX, false).unwrap();
                    let doppler = match is_moving {
                        true => 0.6 / (1.0 + 0.8 * seen.z),
                        false => 1.0,
                    };
                    assert!((hit.doppler - doppler).abs() < 1e-14 * doppler, "{seen}");
                    // At rest, all of a ball is seen head-on from its middle.
                    assert!(
                        !is_ball || (hit.facing.eye_cosine() - 1.0).abs() < 1e-14,
                        "{seen}"
                    );
                }
                // Straight ahead and behind, whatever the frame.
                for (seen, for_observer) in [(DVec3::NEG_Z, 3.0), (DVec3::Z, 1.0 / 3.0)] {
                    let hit = crowd.nearest(seen, 0.0, f64::MAX, false).unwrap();
                    let doppler = if is_moving { for_observer } else { 1.0 };
                    assert!((hit.doppler - doppler).abs() < 1e-14);
                    assert!((hit.facing.eye_cosine() - 1.0).abs() < 1e-14);
                    assert_eq!(hit.body, 0);
                    // From the middle too a photosurface is as the observer sees it.
                    let is_mapped = matches!(scenery.bodies[0].stands, Stands::Mapped(_));
                    let shown = crowd.doppler(&hit, seen);
                    let expected = (is_moving || is_mapped).then_some(for_observer);
                    assert_eq!(shown.is_some(), expected.is_some());
                    assert!((shown.unwrap_or(1.0) - expected.unwrap_or(1.0)).abs() < 1e-14);
                }
            }
        }
    }

    /// The energy density of the light of a glowing ball, of all wavelengths together: the fourth power of the Doppler
    /// factor over the part of the observer's sky that it takes up. In its rest frame the sums of its light over directions
    /// are known in closed form, and what moves along the unit vector `n` sees of them
    /// `gamma^2 (E - 2 beta P cos(theta) + beta^2 T)`.
    #[test]
    fn a_glowing_ball_gives_as_much_light_as_its_energy_says() {
        for (position, direction, density) in [
            ([0, 3, 0], [1, 0, 0], 1.934_241_610_912_67),
            ([-3, 2, 1], [-1, 0, 0], 3.517_558_179_693_52),
        ] {
            let scene = json!({
                "observer": { "velocity": { "beta": 0.9, "direction": direction } },
                "objects": [{ "name": "ball", "shape": { "sphere": { "radius": 1 } }, "position": position }],
            });
            let scene = Scene::from_json(&scene.to_string()).unwrap();
            let scenery = scenery(&scene);
            let moment = scene.moment(0).unwrap();
            let crowd = Crowd::new(scenery.bodies.iter(), Viewpoint::Observer(&moment));
            // Rings of equal solid angle around an axis, each with places of its own, first over the whole sky, then around
            // the ball.
            let places = |axis: DVec3, rings: u32, least: f64| {
                let (u, v) = axis.any_orthonormal_pair();
                let numbers =
                    (0..rings).flat_map(move |ring| (0..rings).map(move |step| (ring, step)));
                numbers.map(move |(ring, step)| {
                    let [ring, step, rings] = [ring, step, rings].map(f64::from);
                    let along = least + (1.0 - least) * (ring + 0.5) / rings;
                    let angle = TAU * (step / rings + 0.618 * ring);
                    let across = (1.0 - along * along).sqrt();
                    axis * along + (u * angle.cos() + v * angle.sin()) * across
                })
            };
            let hit = |seen| crowd.nearest(seen, 0.0, f64::MAX, false);
            let coarse: Vec<DVec3> = places(DVec3::X, 300, -1.0)
                .filter(|&seen| hit(seen).is_some())
                .collect();
            let axis = coarse.iter().sum::<DVec3>().normalize();
            let farthest = coarse
                .iter()
                .map(|seen| seen.angle_between(axis))
                .fold(0.0, f64::max);
            let least = (1.2 * farthest).cos();
            let rings = 800;
            let seen = places(axis, rings, least).filter_map(hit);
            let sum: f64 = seen.map(|hit| hit.doppler.powi(4)).sum();
            let found = sum * TAU * (1.0 - least) / f64::from(rings * rings);
            assert!((found / density - 1.0).abs() < 1e-3, "{found} {density}");
        }
    }

    /// The mean number of boxes a ray is held against before a field of cubes with these velocities; some are hit.
    fn boxes_a_ray(count: u32, beta: impl Fn(u32) -> f64) -> f64 {
        let side = f64::from(count).sqrt().ceil();
        let objects = (0..count).map(|k| {
            let (x, z) = (f64::from(k) % side, (f64::from(k) / side).floor());
            json!({
                "name": format!("cube{k}"),
                "shape": { "box": { "size": [1, 1, 1], "resolution": 1 } },
                "position": [3.0 * (x - side / 2.0), -6, -6.0 - 3.0 * z],
                "velocity": { "beta": beta(k), "direction": [1, 0, 0] },
            })
        });
        let scene = json!({
            "observer": { "velocity": { "beta": 0.8 } },
            "objects": objects.collect::<Vec<_>>(),
        });
        let scene = Scene::from_json(&scene.to_string()).unwrap();
        let scenery = scenery(&scene);
        let moment = scene.moment(0).unwrap();
        let crowd = Crowd::new(scenery.bodies.iter(), Viewpoint::Observer(&moment));
        counted::BOXES.set(0);
        let (mut rays_cast, mut hits) = (0, 0);
        for seen in rays(&camera(DVec3::NEG_Z)).step_by(7) {
            rays_cast += 1;
            hits += u32::from(crowd.nearest(seen, 0.0, f64::MAX, false).is_some());
        }
        assert!(hits > 100, "{hits}");
        counted::BOXES.get() as f64 / f64::from(rays_cast)
    }

    /// Work that is counted, not timed: with sixteen times as many objects, a few times as many boxes, since a ray near
    /// the horizon passes above more of them.
    #[test]
    fn a_ray_asks_few_of_many_objects() {
        for (name, beta) in [
            ("of one velocity", (|_| 0.5) as fn(u32) -> f64),
            ("of many velocities", |k| f64::from(k % 97) / 100.0),
        ] {
            let [few, many] = [250, 4000].map(|count| boxes_a_ray(count, beta));
            assert!(many < 4.0 * few && many < 400.0, "{name}: {few} {many}");
        }
    }

    /// Parts of one object: far fewer boxes than parts.
    #[test]
    fn a_ray_asks_few_of_many_parts() {
        let cube = Shape::cuboid([1.0; 3]).unwrap();
        let cube = cube.with_resolution(1).unwrap();
        let model = cube.model(&Appearance::default()).unwrap();
        let object =
            crate::scene::Object::new("cubes", Source::Model(std::sync::Arc::new(model.clone())));
        let mut scenery = Scenery::new();
        for k in 0..4000 {
            let place = DVec3::new(f64::from(k % 63) - 31.0, f64::from(k / 63) - 31.0, -20.0);
            let moved = glam::DAffine3::from_translation(3.0 * place);
            let mut part = model.parts[0].clone().transformed(&moved);
            part.material = None;
            scenery.add_at_rest(&object, &part);
        }
        let crowd = Crowd::new(scenery.bodies.iter(), Viewpoint::Outside(DVec3::ZERO));
        counted::BOXES.set(0);
        let mut hits = 0;
        for seen in rays(&camera(DVec3::NEG_Z)) {
            hits += u32::from(crowd.nearest(seen, 0.0, f64::MAX, false).is_some());
        }
        let boxes = counted::BOXES.get() as f64 / (96.0 * 72.0 * 9.0);
        assert!(hits > 1000 && boxes < 100.0, "{boxes} {hits}");
    }
}
