//! What stands before the camera, and the picture of it.

use std::sync::Arc;

use glam::{DVec2, DVec3, Vec3, Vec4};
use rayon::prelude::*;

use super::Camera;
use super::caster::{Caster, MeshHit, Ray};
use super::cone::Cone;
use super::paint::{Paint, RenderError};
use super::picture::{Picture, encoded};
use super::sight::Sight;
use super::sphere::Ball;
use crate::mesh::{Color, Material, Mesh, Part, Shape};
use crate::scene::{Object, Source};
use crate::spacetime::{WorldLine, unit};

/// How bright a surface is that the lamp only grazes.
const AMBIENT: f32 = 0.25;

/// Most surfaces one ray of light is followed through.
const MOST_LAYERS: usize = 64;

/// A ray goes on behind a surface by this part of the way to it, so that it does not meet it again.
const STEP_BEHIND: f64 = 1.0 + 1e-12;

/// How far facets of a round shape are from it, as a part of its size: less than a tenth of a pixel where it fills
/// a picture 1000 pixels wide.
const FACETS: f64 = 1e-4;

/// What is too faint to see: half a step of 8 bits, squared.
const OPAQUE: f32 = 1.0 / (510.0 * 510.0);

/// Things to take pictures of.
///
/// Three kinds: objects *at rest* in their own frames, which an observer sees by their light (the method of
/// rays); *photosurfaces*, mapped already, which the same observer sees as they stand (the method of
/// meshes); and *plain* things in the observer's frame, with no light to travel. From outside all are drawn as
/// they stand.
///
/// # Shading
///
/// A lamp shines from the eye: a surface is as bright as the cosine between its normal and the direction to
/// the eye, on top of a little light from everywhere. For an observer in motion these are normal and
/// direction in the *rest frame* of the object: there its surface scatters light, and only there does the angle say how
/// much of it. In the observer's frame the photosurface of whatever comes towards the observer is so long
/// that all of it would be seen at grazing incidence, and dark. For photosurfaces, normals are taken back to the rest
/// frame; so both methods shade alike.
#[derive(Default)]
pub struct Scenery {
    bodies: Vec<Body>,
}

/// Where the picture is taken.
#[derive(Clone, Copy, Debug)]
pub enum Viewpoint<'a> {
    /// By the observer, at a proper time on its worldline.
    Observer(&'a WorldLine, f64),
    /// At a place in the frame in which things stand.
    Outside(DVec3),
}

/// How a picture is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureOptions {
    /// Rays a pixel along each side: N is N x N rays, evenly spread; at least 1.
    pub samples: u32,
    /// What is seen where nothing is.
    pub background: Color,
}

impl Default for PictureOptions {
    /// Nine rays a pixel before a dark background.
    fn default() -> Self {
        Self {
            samples: 3,
            background: Color([0x14, 0x17, 0x1c]),
        }
    }
}

struct Body {
    geometry: Geometry,
    paint: Paint,
    stands: Stands,
}

enum Geometry {
    Mesh(Caster),
    Ball(Ball),
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
        }
    }
}

/// In which frame a body's geometry is given.
#[derive(Clone, Copy)]
enum Stands {
    /// Its rest frame.
    AtRest(WorldLine),
    /// The observer's, mapped from its rest frame.
    Mapped(WorldLine),
    /// The observer's.
    Plain,
}

/// A body for the moment of one picture.
struct Sitter<'a> {
    body: &'a Body,
    /// How the observer sees it; none from outside.
    sight: Option<Sight>,
    /// Where on the sky it is.
    cone: Cone,
}

/// What a ray meets.
struct Meeting<'a> {
    distance: f64,
    paint: &'a Paint,
    /// Where the lamp stands head-on: the cosine between normal and ray.
    cosine: f64,
    texture: DVec2,
    vertex_color: Vec4,
}

impl Scenery {
    /// Nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a part of `object`, at rest, in the object's rest frame.
    ///
    /// A sphere is met as the surface that it is, whatever facets its part has; other round shapes get facets
    /// within a ten thousandth of their size, unless they have a resolution of their own.
    ///
    /// # Errors
    ///
    /// A texture that cannot be decoded.
    pub fn add_at_rest(&mut self, object: &Object, part: &Part) -> Result<(), RenderError> {
        let geometry = match &object.source {
            Source::Shape(Shape::Sphere(sphere), _) => {
                Geometry::Ball(Ball::new(sphere.clone(), object.model_to_rest()))
            }
            Source::Shape(shape, appearance) => {
                let size = part
                    .mesh()
                    .bounds()
                    .map_or(0.0, |(low, high)| low.distance(high));
                let fine = shape.within(FACETS * size / object.scale.max_element());
                let made = fine.model(appearance).ok();
                let made = made.and_then(|mut model| model.parts.pop());
                let made = made.map(|part| part.transformed(&object.model_to_rest()));
                Geometry::Mesh(Caster::new(made.as_ref().unwrap_or(part).mesh().clone()))
            }
            _ => Geometry::Mesh(Caster::new(part.mesh().clone())),
        };
        let stands = Stands::AtRest(object.world_line());
        self.add(geometry, part.material.as_ref(), &object.name, stands)
    }

    /// Adds a photosurface of `object`, in the observer's frame with the observer at the origin.
    ///
    /// # Errors
    ///
    /// A texture that cannot be decoded.
    pub fn add_photosurface(
        &mut self,
        object: &Object,
        mesh: &Mesh,
        material: Option<&Arc<Material>>,
    ) -> Result<(), RenderError> {
        let geometry = Geometry::Mesh(Caster::new(mesh.clone()));
        let stands = Stands::Mapped(object.world_line());
        self.add(geometry, material, &object.name, stands)
    }

    /// Adds a thing as it stands in the observer's frame.
    ///
    /// # Errors
    ///
    /// A texture that cannot be decoded.
    pub fn add_plain(&mut self, part: &Part) -> Result<(), RenderError> {
        let geometry = Geometry::Mesh(Caster::new(part.mesh().clone()));
        self.add(geometry, part.material.as_ref(), &part.name, Stands::Plain)
    }

    fn add(
        &mut self,
        geometry: Geometry,
        material: Option<&Arc<Material>>,
        object: &str,
        stands: Stands,
    ) -> Result<(), RenderError> {
        self.bodies.push(Body {
            geometry,
            paint: Paint::new(material, object)?,
            stands,
        });
        Ok(())
    }

    /// The picture that `camera` takes; `row_done` is called after every row.
    ///
    /// Pixels are independent, rows are shared out among threads: the bytes are the same for any number
    /// of them. Memory is that of the picture.
    pub fn picture(
        &self,
        camera: &Camera,
        viewpoint: Viewpoint,
        options: PictureOptions,
        row_done: &(dyn Fn() + Sync),
    ) -> Picture {
        let eye = match viewpoint {
            Viewpoint::Observer(..) => DVec3::ZERO,
            Viewpoint::Outside(place) => place,
        };
        let sitters: Vec<_> = self
            .bodies
            .iter()
            .map(|body| Sitter::new(body, eye, viewpoint))
            .collect();
        let samples = options.samples.max(1);
        let background = Vec3::from(options.background.linear());
        let sample = |place: DVec2| light(&sitters, eye, camera.direction(place), background);
        let size = camera.size();
        let mut bytes = vec![0; 3 * size.width() as usize * size.height() as usize];
        let rows = bytes.par_chunks_mut(3 * size.width() as usize);
        rows.enumerate().for_each(|(y, row)| {
            for (x, pixel) in row.chunks_exact_mut(3).enumerate() {
                let corner = DVec2::new(x as f64, y as f64);
                let mut sum = Vec3::ZERO;
                for part in 0..samples * samples {
                    let inside = DVec2::new((part % samples).into(), (part / samples).into());
                    sum += sample(corner + (inside + 0.5) / f64::from(samples));
                }
                pixel.copy_from_slice(&encoded(sum / (samples * samples) as f32));
            }
            row_done();
        });
        Picture::new(size, bytes)
    }
}

/// The linear colour that is seen in one direction.
fn light(sitters: &[Sitter], eye: DVec3, seen: DVec3, background: Vec3) -> Vec3 {
    let mut light = Vec3::ZERO;
    let mut clearness = 1.0;
    let mut beyond = 0.0;
    for _ in 0..MOST_LAYERS {
        let nearest = sitters
            .iter()
            .fold(None, |nearest: Option<Meeting>, sitter| {
                let limit = nearest
                    .as_ref()
                    .map_or(f64::MAX, |nearest| nearest.distance);
                sitter.meeting(eye, seen, beyond, limit).or(nearest)
            });
        let Some(meeting) = nearest else {
            return light + background * clearness;
        };
        let Meeting { paint, texture, .. } = meeting;
        let (color, opacity) = paint.color_at(texture, meeting.vertex_color);
        let lit = AMBIENT + (1.0 - AMBIENT) * meeting.cosine as f32;
        light += color * (lit * opacity * clearness);
        clearness *= 1.0 - opacity;
        if clearness < OPAQUE {
            break;
        }
        beyond = meeting.distance * STEP_BEHIND;
    }
    light
}

impl<'a> Sitter<'a> {
    fn new(body: &'a Body, eye: DVec3, viewpoint: Viewpoint) -> Self {
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
    fn meeting(&self, eye: DVec3, seen: DVec3, beyond: f64, limit: f64) -> Option<Meeting<'a>> {
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
        let (distance, normal, texture, vertex_color) = match &self.body.geometry {
            Geometry::Mesh(caster) => {
                let ray = Ray::new(origin, direction);
                let hit = caster.cast(&ray, beyond, limit, paint.double_sided)?;
                let (normal, texture, color) = attributes(caster.mesh(), paint, &hit);
                (hit.distance, normal, texture, color)
            }
            Geometry::Ball(ball) => {
                let hit = ball.cast(origin, direction, beyond, limit)?;
                (hit.distance, hit.normal, hit.texture, Vec4::ONE)
            }
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
            cosine: lit.map_or(1.0, f64::abs).min(1.0),
            texture,
            vertex_color,
        })
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
