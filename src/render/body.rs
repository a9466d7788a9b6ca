//! Bodies that rays meet, and what is to be known of where they do.

use glam::{DVec2, DVec3, Vec4};

use super::aberration::{Aberration, RestRay};
use super::bounds::Bounds;
use super::caster::{Caster, MeshHit};
use super::paint::Paint;
use super::ray::Ray;
use super::shape_placement::SmoothHit;
use super::sphere::Ball;
use super::turned::Turned;
use crate::mesh::Mesh;
use crate::scene::Emission;
use crate::spacetime::{WorldLine, unit};

/// What has no corners is within a ball so much larger, roundings and all.
const RADIUS_MARGIN: f64 = 1.0 + 1e-9;

pub(super) struct Body {
    pub(super) geometry: Geometry,
    pub(super) paint: Paint,
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
    AtRest(WorldLine),
    /// The observer's, mapped from its rest frame as that observer sees it.
    Mapped(Aberration),
    /// The observer's frame, as it is.
    InView,
}

/// Where a ray meets a body, in the frame of the body's geometry.
pub(super) struct BodyHit {
    /// In units of the ray's direction.
    pub(super) distance: f64,
    /// Of any length.
    normal: DVec3,
    texture: DVec2,
    vertex_color: Vec4,
    /// The corners of a triangle.
    corners: Option<[u32; 3]>,
}

/// What is seen in a direction.
///
/// Distance, cosine and Doppler factor are apart: what light does with each of them is for
/// [`PixelShader`](super::pixel_shader::PixelShader) to say.
pub(super) struct Hit<'a> {
    /// The number of the body that is hit.
    pub(super) body: usize,
    pub(super) paint: &'a Paint,
    pub(super) emission: Option<Emission>,
    /// From the eye, as it is seen.
    pub(super) distance: f64,
    /// Of the angle between the ray and the normal on the side that is hit, from 0 to 1, in the rest frame of the body;
    /// where viewpoint or body has no motion, in the frame in which things stand. 1 where the normal has no direction.
    pub(super) cosine: f64,
    /// Frequency seen over frequency emitted; positive. 1 where viewpoint or body has no motion.
    pub(super) doppler: f64,
    pub(super) texture: DVec2,
    pub(super) vertex_color: Vec4,
    /// The corners of the triangle, as they are seen, where wires are wanted.
    pub(super) triangle: Option<[DVec3; 3]>,
}

impl Body {
    /// The nearest hit farther than `beyond` and not as far as `limit`.
    pub(super) fn cast(&self, ray: &Ray, beyond: f64, limit: f64) -> Option<BodyHit> {
        let (origin, direction) = (ray.origin(), ray.direction());
        match &self.geometry {
            Geometry::Mesh(caster) => {
                let hit = caster.cast(ray, beyond, limit, self.paint.double_sided)?;
                let (normal, texture, vertex_color) = attributes(caster.mesh(), &self.paint, &hit);
                Some(BodyHit {
                    distance: hit.distance,
                    normal,
                    texture,
                    vertex_color,
                    corners: Some(hit.corners),
                })
            }
            Geometry::Ball(ball) => ball.cast(origin, direction, beyond, limit).map(smooth),
            Geometry::Turned(turned) => turned.cast(origin, direction, beyond, limit).map(smooth),
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
        let mapped = aberration.filter(|_| self.is_mapped());
        let (normal_rest, ray_rest) = match mapped {
            Some(aberration) => (
                aberration.normal_at_rest(hit.normal, seen),
                aberration.ray(seen),
            ),
            None => (unit(hit.normal), ray),
        };
        let cosine = normal_rest.map_or(1.0, |normal| normal.dot(ray_rest.direction));
        let triangle = match (&self.geometry, hit.corners) {
            (Geometry::Mesh(caster), Some(corners)) if wires && self.is_mapped() => {
                // A mesh holds no index beyond its vertices.
                Some(corners.map(|corner| caster.mesh().positions()[corner as usize]))
            }
            _ => None,
        };
        Hit {
            body: number,
            paint: &self.paint,
            emission: self.emission,
            distance: hit.distance / ray.stretch,
            cosine: cosine.abs().min(1.0),
            doppler: ray_rest.doppler(),
            texture: hit.texture,
            vertex_color: hit.vertex_color,
            triangle,
        }
    }

    fn is_mapped(&self) -> bool {
        matches!(self.stands, Stands::Mapped(_))
    }
}

/// The hit of a surface that has no corners.
fn smooth(hit: SmoothHit) -> BodyHit {
    BodyHit {
        distance: hit.distance,
        normal: hit.normal,
        texture: hit.texture,
        vertex_color: Vec4::ONE,
        corners: None,
    }
}

/// Normal, texture coordinates and colour between the corners of a triangle.
fn attributes(mesh: &Mesh, paint: &Paint, hit: &MeshHit) -> (DVec3, DVec2, Vec4) {
    let corners = hit.corners.map(|corner| corner as usize);
    let between = corners.into_iter().zip(hit.weights);
    let normals = mesh.normals().unwrap_or_default();
    let normal = between
        .clone()
        .filter_map(|(corner, weight)| Some(*normals.get(corner)? * weight))
        .sum();
    let set = paint
        .texture_set()
        .and_then(|set| mesh.texture_coordinates().get(set));
    let texture = set.map_or(DVec2::ZERO, |set| {
        let weighted = between.clone();
        weighted
            .map(|(corner, weight)| set[corner].as_dvec2() * weight)
            .sum()
    });
    let color = mesh.colors().map_or(Vec4::ONE, |colors| {
        let weighted = between;
        weighted
            .map(|(corner, weight)| colors[corner] * weight as f32)
            .sum()
    });
    (normal, texture, color)
}
