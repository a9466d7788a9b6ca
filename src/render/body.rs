//! Bodies that rays meet, and what is to be known of where they do.

use glam::{DVec2, DVec3, Vec4};

use super::Viewpoint;
use super::caster::{Caster, MeshHit, Ray};
use super::cone::Cone;
use super::paint::Paint;
use super::placed::SmoothHit;
use super::sight::Sight;
use super::sphere::Ball;
use super::turned::Turned;
use crate::mesh::Mesh;
use crate::spacetime::{WorldLine, unit};

/// How bright a surface is that the lamp only grazes.
pub(super) const AMBIENT: f32 = 0.25;

pub(super) struct Body {
    pub(super) geometry: Geometry,
    pub(super) paint: Paint,
    pub(super) stands: Stands,
}

pub(super) enum Geometry {
    Mesh(Caster),
    Ball(Ball),
    Turned(Turned),
}

impl Geometry {
    /// Centre and radius of a ball around it.
    fn ball(&self) -> (DVec3, f64) {
        match self {
            Self::Mesh(caster) => {
                let (low, high) = caster.mesh().bounds().unwrap_or_default();
                ((low + high) / 2.0, low.distance(high) / 2.0)
            }
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
    /// The observer's, mapped from its rest frame.
    Mapped(WorldLine),
    /// The observer's.
    Plain,
}

/// A body for the moment of one picture.
pub(super) struct Sitter<'a> {
    body: &'a Body,
    /// How the observer sees it; none from outside.
    sight: Option<Sight>,
    /// Where on the sky it is.
    cone: Cone,
}

/// What a ray meets.
pub(super) struct Meeting<'a> {
    pub(super) distance: f64,
    pub(super) paint: &'a Paint,
    /// How much of its colour the lamp shows.
    pub(super) brightness: f32,
    pub(super) texture: DVec2,
    pub(super) vertex_color: Vec4,
    /// The corners of the triangle, as they are seen, where wires are wanted.
    pub(super) triangle: Option<[DVec3; 3]>,
}

impl<'a> Sitter<'a> {
    pub(super) fn new(body: &'a Body, eye: DVec3, viewpoint: Viewpoint) -> Self {
        let sight = match (viewpoint, body.stands) {
            (
                Viewpoint::Observer(observer, proper_time),
                Stands::AtRest(line) | Stands::Mapped(line),
            ) => Some(Sight::new(observer, &line, proper_time)),
            _ => None,
        };
        let (center, radius) = body.geometry.ball();
        let cone = match (&sight, body.stands) {
            (Some(sight), Stands::AtRest(_)) => sight.cone(center, radius),
            _ => Cone::of_ball(eye, center, radius),
        };
        Self { body, sight, cone }
    }

    /// Where the ray from `eye` along `seen` meets it, farther than `beyond` and not as far as `limit`, both as
    /// seen.
    pub(super) fn meeting(
        &self,
        eye: DVec3,
        seen: DVec3,
        beyond: f64,
        limit: f64,
        wires: bool,
    ) -> Option<Meeting<'a>> {
        if !self.cone.may_hold(seen) {
            return None;
        }
        let (origin, direction, stretch) = match (&self.sight, self.body.stands) {
            (Some(sight), Stands::AtRest(_)) => {
                let ray = sight.ray(seen);
                (ray.origin, ray.direction, ray.stretch)
            }
            _ => (eye, seen, 1.0),
        };
        let [beyond, limit] = [beyond, limit].map(|seen| (seen * stretch).min(f64::MAX));
        let paint = &self.body.paint;
        let mut triangle = None;
        let (distance, normal, texture, vertex_color) = match &self.body.geometry {
            Geometry::Mesh(caster) => {
                let ray = Ray::new(origin, direction);
                let hit = caster.cast(&ray, beyond, limit, paint.double_sided)?;
                let (normal, texture, color) = attributes(caster.mesh(), paint, &hit);
                if wires && matches!(self.body.stands, Stands::Mapped(_)) {
                    let place = |corner: u32| caster.mesh().positions()[corner as usize];
                    triangle = Some(hit.corners.map(place));
                }
                (hit.distance, normal, texture, color)
            }
            Geometry::Ball(ball) => smooth(ball.cast(origin, direction, beyond, limit)?),
            Geometry::Turned(turned) => smooth(turned.cast(origin, direction, beyond, limit)?),
        };
        let lit = match (&self.sight, self.body.stands) {
            (Some(sight), Stands::Mapped(_)) => sight
                .normal_at_rest(normal, seen)
                .map(|normal| normal.dot(sight.ray(seen).direction)),
            _ => unit(normal).map(|normal| normal.dot(direction)),
        };
        Some(Meeting {
            distance: distance / stretch,
            paint,
            brightness: match lit {
                Some(cosine) if !paint.unlit => {
                    AMBIENT + (1.0 - AMBIENT) * cosine.abs().min(1.0) as f32
                }
                _ => 1.0,
            },
            texture,
            vertex_color,
            triangle,
        })
    }
}

/// The same of a surface that has no corners.
fn smooth(hit: SmoothHit) -> (f64, DVec3, DVec2, Vec4) {
    (hit.distance, hit.normal, hit.texture, Vec4::ONE)
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
