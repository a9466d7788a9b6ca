//! Bodies that rays meet, and what is to be known of where they do.

use glam::{DVec2, DVec3, Vec4};

use super::aberration::{Aberration, RestRay};
use super::bounds::Bounds;
use super::caster::{Caster, MeshHit};
use super::paint::{Paint, TexturePlaces};
use super::ray::Ray;
use super::shading::Facing;
use super::shape_placement::SmoothHit;
use super::sphere::Ball;
use super::turned::Turned;
use crate::mesh::{Mesh, unit_or_zero};
use crate::scene::Emission;
use crate::spacetime::{Velocity, ViewModel, WorldLine, unit};

/// What has no corners is within a ball so much larger, roundings and all.
const RADIUS_MARGIN: f64 = 1.0 + 1e-9;

pub(super) struct Body {
    pub(super) geometry: Geometry,
    pub(super) paint: Paint,
    /// The name of what it is a part of.
    pub(super) object: String,
    /// Its own light, in place of its paint.
    pub(super) emission: Option<Emission>,
    pub(super) stands: Stands,
}

pub(super) enum Geometry {
    Mesh(Caster),
    Ball(Ball),
    Turned(Turned),
}

impl Geometry {
    /// A box around it, if there is something.
    pub(super) fn bounds(&self) -> Option<Bounds> {
        let (center, radius) = match self {
            Self::Mesh(caster) => return caster.bounds(),
            Self::Ball(ball) => ball.around(),
            Self::Turned(turned) => turned.around(),
        };
        let radius = radius * RADIUS_MARGIN;
        Some(Bounds {
            low: center - radius,
            high: center + radius,
        })
    }

    /// Centre and radius of a ball around it.
    pub(super) fn ball(&self) -> (DVec3, f64) {
        match self {
            Self::Mesh(caster) => caster
                .bounds()
                .map_or((DVec3::ZERO, 0.0), |bounds| bounds.ball()),
            Self::Ball(ball) => ball.around(),
            Self::Turned(turned) => turned.around(),
        }
    }
}

/// In which frame a body's geometry is given.
#[derive(Clone, Copy)]
pub(super) enum Stands {
    /// Its rest frame.
    AtRest(WorldLine, ViewModel),
    /// The observer's, mapped from its rest frame as that observer sees it.
    Mapped(Mapped),
    /// The observer's frame, as it is.
    InView,
}

impl Stands {
    /// In the scene frame, of what has one.
    pub(super) fn velocity(&self) -> Option<Velocity> {
        match self {
            Self::AtRest(line, _) => Some(line.velocity),
            Self::Mapped(mapped) => Some(mapped.velocity),
            Self::InView => None,
        }
    }
}

/// How a photosurface comes from what is at rest.
#[derive(Clone, Copy)]
pub(super) struct Mapped {
    /// Of the observer who sees it.
    pub(super) aberration: Aberration,
    pub(super) velocity: Velocity,
    pub(super) model: ViewModel,
    /// The number of the observer's moment in its scenery.
    pub(super) moment: usize,
}

/// Where a ray meets a body, in the frame of the body's geometry.
pub(super) enum BodyHit {
    Mesh(MeshHit),
    Smooth(SmoothHit),
}

impl BodyHit {
    /// In units of the ray's direction.
    pub(super) fn distance(&self) -> f64 {
        match self {
            Self::Mesh(hit) => hit.distance,
            Self::Smooth(hit) => hit.distance,
        }
    }
}

/// What is seen in a direction.
///
/// Distance, angles and Doppler factor are apart: what light does with each of them is for
/// [`PixelShader`](super::pixel_shader::PixelShader) to say.
pub(super) struct Hit<'a> {
    /// The number of the body that is hit.
    pub(super) body: usize,
    pub(super) paint: &'a Paint,
    pub(super) emission: Option<Emission>,
    /// From the eye, as it is seen.
    pub(super) distance: f64,
    /// Normal on the side that is hit and direction to the eye, in the rest frame of the body; where viewpoint or body has
    /// no motion, in the frame in which things stand. The normal is towards the eye where it has no direction.
    pub(super) facing: Facing,
    /// Frequency seen over frequency emitted; positive. 1 where viewpoint or body has no motion.
    pub(super) doppler: f64,
    pub(super) texture: TexturePlaces,
    pub(super) vertex_color: Vec4,
    /// The corners of the triangle, as they are seen, where wires are wanted.
    pub(super) triangle: Option<[DVec3; 3]>,
}

impl Body {
    /// The nearest hit farther than `beyond` and not as far as `limit`.
    pub(super) fn cast(&self, ray: &Ray, beyond: f64, limit: f64) -> Option<BodyHit> {
        self.meet(ray, beyond, limit, self.paint.double_sided)
    }

    /// The same, with back sides of triangles if `both_sides`.
    pub(super) fn meet(
        &self,
        ray: &Ray,
        beyond: f64,
        limit: f64,
        both_sides: bool,
    ) -> Option<BodyHit> {
        let (origin, direction) = (ray.origin(), ray.direction());
        match &self.geometry {
            Geometry::Mesh(caster) => caster
                .cast(ray, beyond, limit, both_sides)
                .map(BodyHit::Mesh),
            Geometry::Ball(ball) => ball
                .cast(origin, direction, beyond, limit)
                .map(BodyHit::Smooth),
            Geometry::Turned(turned) => turned
                .cast(origin, direction, beyond, limit)
                .map(BodyHit::Smooth),
        }
    }

    /// What is seen of a hit of this body, the one numbered `number`, in the direction `seen`, which is along `ray` in the
    /// frame of its geometry.
    pub(super) fn seen(
        &self,
        number: usize,
        hit: &BodyHit,
        ray: RestRay,
        seen: DVec3,
        aberration: Option<&Aberration>,
        wires: bool,
    ) -> Hit<'_> {
        let Attributes {
            normal,
            texture,
            vertex_color,
        } = self.attributes(hit);
        let mapped = aberration.filter(|_| self.is_mapped());
        let (normal_rest, ray_rest) = match mapped {
            Some(aberration) => (
                aberration.normal_at_rest(normal, seen),
                aberration.ray(seen),
            ),
            None => (unit(normal), ray),
        };
        let to_eye = -ray_rest.direction;
        let normal = normal_rest.unwrap_or(to_eye);
        let triangle = match (&self.geometry, hit) {
            (Geometry::Mesh(caster), BodyHit::Mesh(hit)) if wires && self.is_mapped() => {
                // A mesh holds no index beyond its vertices.
                let place = |corner| caster.mesh().positions()[corner as usize];
                Some(hit.corners.map(place))
            }
            _ => None,
        };
        Hit {
            body: number,
            paint: &self.paint,
            emission: self.emission,
            distance: hit.distance() / ray.stretch,
            facing: Facing {
                normal: if normal.dot(to_eye) < 0.0 {
                    -normal
                } else {
                    normal
                },
                to_eye,
            },
            doppler: ray_rest.doppler,
            texture,
            vertex_color,
            triangle,
        }
    }

    /// How opaque it is where it is hit, from 0 to 1.
    pub(super) fn opacity(&self, hit: &BodyHit) -> f32 {
        if self.paint.is_opaque() {
            return 1.0;
        }
        let Attributes {
            texture,
            vertex_color,
            ..
        } = self.attributes(hit);
        self.paint.opacity_at(&texture, vertex_color)
    }

    fn attributes(&self, hit: &BodyHit) -> Attributes {
        match (&self.geometry, hit) {
            (Geometry::Mesh(caster), BodyHit::Mesh(hit)) => {
                of_triangle(caster.mesh(), &self.paint, hit)
            }
            (_, BodyHit::Mesh(_)) => unreachable!("only meshes have triangles"),
            (_, BodyHit::Smooth(hit)) => Attributes {
                normal: hit.normal,
                texture: [hit.texture; 4],
                vertex_color: Vec4::ONE,
            },
        }
    }

    fn is_mapped(&self) -> bool {
        matches!(self.stands, Stands::Mapped(..))
    }
}

/// What a body is where it is hit.
struct Attributes {
    /// Of any length, in the frame of the geometry.
    normal: DVec3,
    texture: TexturePlaces,
    vertex_color: Vec4,
}

/// Attributes between the corners of a triangle.
fn of_triangle(mesh: &Mesh, paint: &Paint, hit: &MeshHit) -> Attributes {
    let corners = hit.corners.map(|corner| corner as usize);
    let between = corners.into_iter().zip(hit.weights);
    let normal = match mesh.normals() {
        Some(normals) => {
            let weighted = between.clone();
            weighted
                .map(|(corner, weight)| normals[corner] * weight)
                .sum()
        }
        None => {
            let [a, b, c] = corners.map(|corner| mesh.positions()[corner]);
            unit_or_zero((b - a).cross(c - a))
        }
    };
    let mut texture = TexturePlaces::default();
    for (place, &set) in texture.iter_mut().zip(paint.texture_sets()) {
        let set = mesh.texture_coordinates().get(set);
        *place = set.map_or(DVec2::ZERO, |set| {
            let weighted = between.clone();
            weighted
                .map(|(corner, weight)| set[corner].as_dvec2() * weight)
                .sum()
        });
    }
    let vertex_color = mesh.colors().map_or(Vec4::ONE, |colors| {
        let weighted = between;
        weighted
            .map(|(corner, weight)| colors[corner] * weight as f32)
            .sum()
    });
    Attributes {
        normal,
        texture,
        vertex_color,
    }
}
