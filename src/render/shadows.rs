//! Whether light of a lamp gets to a surface: rays between two events, in the rest frame of everything in between.
//!
//! A straight way of light is straight in every frame. So everything that rests in one frame is asked in that frame, whatever
//! it is elsewhere: where the light reaches the surface, which way it came, and how far.

use std::collections::HashMap;

use glam::DVec3;

use super::aberration::Aberration;
use super::body::{Body, Geometry, Stands};
use super::bounds::Bounds;
use super::ray::Ray;
use super::tree::Tree;
use crate::spacetime::{Lorentz, Moment, Velocity, VelocityKey, ViewModel, WorldLine};

/// A surface of facets does not shadow itself closer than this part of its size: there it may be so far from the surface
/// that it stands for.
const CLEARANCE: f64 = 2e-3;

/// A way goes on behind what lets light through by this part.
const STEP_BEHIND: f64 = 1.0 + 1e-12;

/// Everything that may cast a shadow, for one moment of the observer.
pub(super) struct Shadows<'a> {
    groups: Vec<Group<'a>>,
}

/// What rests in one frame.
struct Group<'a> {
    velocity: Velocity,
    /// From the observer's frame to this one, whose origin is that of its first body.
    aberration: Aberration,
    occluders: Vec<Occluder<'a>>,
    tree: Tree,
}

struct Occluder<'a> {
    body: &'a Body,
    /// Where the origin of its coordinates is in those of the group.
    offset: DVec3,
    radius: f64,
}

/// A place of a surface, as the observer sees it.
#[derive(Clone, Copy)]
pub(super) struct LitPlace<'a> {
    /// The unit direction in which it is seen, and how far away.
    pub(super) seen: DVec3,
    pub(super) distance: f64,
    /// The object whose surface it is.
    pub(super) object: &'a str,
}

/// A way of light to a surface, in one frame.
#[derive(Clone, Copy)]
pub(super) struct Way {
    /// The unit direction from the surface to the lamp.
    pub(super) to_lamp: DVec3,
    /// How far that is; infinite for a sun.
    pub(super) distance: f64,
}

impl<'a> Shadows<'a> {
    /// The shadows of these bodies, of those at rest among them.
    pub(super) fn new(bodies: impl Iterator<Item = &'a Body>, moment: &Moment) -> Self {
        let mut starts: Vec<(WorldLine, Vec<Occluder<'a>>)> = Vec::new();
        let mut places: HashMap<VelocityKey, usize> = HashMap::new();
        for body in bodies {
            let Stands::AtRest(line, _) = body.stands else {
                continue;
            };
            if body.paint.is_blended() {
                continue;
            }
            let place = *places.entry(line.velocity.key()).or_insert_with(|| {
                starts.push((line, vec![]));
                starts.len() - 1
            });
            let (first, occluders) = &mut starts[place];
            let between = line.origin - first.origin;
            let (_, radius) = body.geometry.ball();
            occluders.push(Occluder {
                body,
                offset: Lorentz::boost(line.velocity).apply(between).position,
                radius,
            });
        }
        let groups = starts.into_iter().map(|(line, occluders)| {
            let bounds: Vec<_> = occluders.iter().map(Occluder::bounds).collect();
            Group {
                velocity: line.velocity,
                aberration: Aberration::new(moment, &line, ViewModel::Seen),
                occluders,
                tree: Tree::new(&bounds),
            }
        });
        Self {
            groups: groups.collect(),
        }
    }

    /// The velocities of the frames in which ways are asked for.
    pub(super) fn velocities(&self) -> impl Iterator<Item = Velocity> {
        self.groups.iter().map(|group| group.velocity)
    }

    /// Whether something opaque is between the lamp and a place; `way` gives the way in the frame of each number. What is
    /// of the object `rider`, on which the lamp rides, does not count.
    pub(super) fn fall_on(
        &self,
        place: LitPlace,
        rider: Option<&str>,
        way: impl Fn(usize) -> Way,
    ) -> bool {
        self.groups.iter().enumerate().any(|(number, group)| {
            let ray = group.aberration.ray(place.seen);
            let origin = ray.origin + ray.direction * (ray.stretch * place.distance);
            let Way { to_lamp, distance } = way(number);
            let mut blocked = false;
            group
                .tree
                .along(&Ray::new(origin, to_lamp), distance, |number| {
                    let occluder = &group.occluders[number as usize];
                    let object = occluder.body.object.as_str();
                    blocked = blocked
                        || (rider != Some(object)
                            && occluder.blocks(origin, to_lamp, distance, object == place.object));
                    // A limit below every distance ends the search.
                    if blocked { -1.0 } else { distance }
                });
            blocked
        })
    }
}

impl Occluder<'_> {
    fn bounds(&self) -> Bounds {
        match self.body.geometry.bounds() {
            Some(bounds) => Bounds {
                low: bounds.low + self.offset,
                high: bounds.high + self.offset,
            },
            None => Bounds {
                low: self.offset,
                high: self.offset,
            },
        }
    }

    /// Whether it is opaque on the way; `own` if the way begins on the same object.
    ///
    /// Of the own object only outer sides count, since a way begins outside: round shapes without facets, which are convex,
    /// never shadow themselves.
    fn blocks(&self, origin: DVec3, to_lamp: DVec3, distance: f64, own: bool) -> bool {
        let mut beyond = match (&self.body.geometry, own) {
            (Geometry::Ball(_) | Geometry::Turned(_), true) => return false,
            (Geometry::Mesh(_), true) => CLEARANCE * self.radius,
            (_, false) => 0.0,
        };
        let ray = Ray::new(origin - self.offset, to_lamp);
        while let Some(hit) = self.body.meet(&ray, beyond, distance, !own) {
            if self.body.opacity(&hit) > 0.5 {
                return true;
            }
            beyond = hit.distance() * STEP_BEHIND;
        }
        false
    }
}
