//! What stands before the camera, and the picture of it.

use std::collections::HashMap;
use std::convert::Infallible;
use std::sync::Arc;

use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

use super::aberration::Aberration;
use super::body::{Body, Geometry, Mapped, Stands};
use super::caster::Caster;
use super::crowd::Crowd;
use super::lighting::{Lamps, Lighting};
use super::paint::Paint;
use super::picture::{Picture, encoded};
use super::pixel_shader::{Lit, PixelShader};
use super::sphere::Ball;
use super::turned::Turned;
use super::{Camera, PictureEffects, Strokes, Textures, Viewpoint};
use crate::material::{Material, Part};
use crate::mesh::Mesh;
use crate::scene::{Effects, Emission, Object, Scene, Source};
use crate::shape::{Color, Shape};
use crate::spacetime::{Moment, Velocity, VelocityKey};

/// How far facets of a round shape are from it, as a part of its size: less than a tenth of a pixel where it fills
/// a picture 1000 pixels wide.
const FACETS: f64 = 1e-4;

/// Things to take pictures of.
///
/// Three kinds: objects *at rest* in their own frames, which an observer sees by their light (the method of
/// rays); *photosurfaces*, mapped already, which the same observer sees as they stand (the method of
/// meshes); and things *in view*, which stand in the observer's frame, with no light to travel. From outside all are drawn
/// as they stand. Things in view can be *ghosts* too: seen through, and through what is in front of them.
///
/// # Shading
///
/// A lamp shines from the eye, and a little light comes from all around, more from above: metal, roughness, occlusion and
/// emission of materials are those of glTF, without normal maps and without most extensions (`KHR_materials_unlit`,
/// `KHR_materials_emissive_strength` and `KHR_texture_transform` hold). For an observer in motion normal and directions are
/// those in the *rest frame* of the object, "above" is +y there: there its surface scatters light, and only there do the
/// angles say how much of it. In the observer's frame the photosurface of whatever comes towards the observer is so long
/// that all of it would be seen at grazing incidence, and dark. For photosurfaces, normals are taken back to the rest
/// frame; so both methods shade alike.
///
/// # Lamps
///
/// With [`Scenery::set_lamps`] lamps of a scene take the place of the lamp at the eye. Of each the event is found at which the
/// light left that meets the surface when the surface's own light leaves for the observer; direction, strength and, with
/// effects, colour are those in the rest frame of the surface. Opaque surfaces at rest cast shadows, an object not in the
/// light of a lamp that rides on it, and itself not within 0.002 of its size. An object that is shown under another model has
/// the light of its photosurface.
///
/// # Effects
///
/// With [`Scenery::set_effects`], or with black bodies, the light of surfaces has an exposure, and what is brighter than a
/// screen can show is compressed; the background stays as it is. Photosurfaces have the colours that the observer sees, from
/// outside too; what stands in view keeps its own.
///
/// # Example
///
/// ```
/// use photosurface::render::{Camera, PictureOptions, PictureSize, Projection, Scenery, Viewpoint};
/// use photosurface::{DVec3, PlacedScene, Scene, load_models};
///
/// let scene = Scene::from_json(
///     r#"{ "observer": { "velocity": { "beta": 0.8 } },
///          "objects": [ { "name": "ball", "shape": { "sphere": { "radius": 1 } }, "position": [0, 0, -5] } ] }"#,
/// )?;
/// let (models, _) = load_models(&scene, ".".as_ref())?;
/// let placed = PlacedScene::new(scene, models)?;
/// let mut scenery = Scenery::new();
/// for (object, parts) in placed.objects() {
///     for (_, part) in parts {
///         scenery.add_at_rest(object, part);
///     }
/// }
/// let camera = Camera::new(PictureSize::new(64, 48)?, Projection::Perspective { vertical_fov_deg: 30.0 }, DVec3::NEG_Z)?;
/// let moment = placed.scene().moment(0).expect("a scene has a first step");
/// let picture = scenery.picture(&camera, Viewpoint::Observer(&moment), PictureOptions::default());
/// assert_ne!(picture.pixel(32, 24), picture.pixel(0, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Default)]
pub struct Scenery {
    pub(super) bodies: Vec<Body>,
    /// Each with its linear colour.
    ghosts: Vec<(Body, Vec3)>,
    textures: Textures,
    effects: Option<PictureEffects>,
    lamps: Option<Lamps>,
    /// What casts shadows beside what is at rest in it.
    occluders: Option<Arc<Scenery>>,
    /// Of the observers of photosurfaces.
    moments: Vec<Moment>,
}

/// How a picture is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureOptions {
    /// Rays a pixel along each side: N is N x N rays, evenly spread; from 1 to 1024, to which any other number is brought.
    pub samples: u32,
    /// What is seen where nothing is.
    pub background: Color,
    /// The colour in which the edges of the triangles of photosurfaces are drawn, if they are.
    pub wireframe: Option<Color>,
}

impl Default for PictureOptions {
    /// Nine rays a pixel before a dark background.
    fn default() -> Self {
        Self {
            samples: 3,
            background: Color([0x14, 0x17, 0x1c]),
            wireframe: None,
        }
    }
}

impl Scenery {
    /// Nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Nothing yet; textures are shared with everything else that has these.
    pub fn with_textures(textures: &Textures) -> Self {
        Self {
            textures: textures.clone(),
            ..Self::default()
        }
    }

    /// The textures of what is in it: also which of them could not be decoded, so that pictures go without.
    pub fn textures(&self) -> &Textures {
        &self.textures
    }

    /// Shows these effects.
    pub fn set_effects(&mut self, effects: PictureEffects) {
        self.effects = Some(effects);
    }

    /// Lights what moves by the lamps of a scene instead of the lamp at the eye, if the scene has some. Things in view, and
    /// from outside things at rest, keep the lamp at the eye.
    pub fn set_lamps(&mut self, scene: &Scene) {
        self.lamps = Lamps::of(scene);
        if self.lamps.is_some() {
            self.effects
                .get_or_insert_with(|| PictureEffects::new(Effects::default()));
        }
    }

    /// What casts shadows in the light of lamps, beside what is at rest in this scenery: what is at rest in `at_rest`.
    /// Photosurfaces cast none; what is at rest casts the shadows of theirs.
    pub fn set_occluders(&mut self, at_rest: &Arc<Scenery>) {
        self.occluders = Some(at_rest.clone());
    }

    /// Adds a part of `object`, at rest, in the object's rest frame, to be shown under the object's model.
    ///
    /// Spheres, cylinders, rods and cones are met as the surfaces that they are, whatever facets their parts have. A torus
    /// gets facets within a ten thousandth of its size, unless it has a resolution of its own: the
    /// quartic of the true one is ill-conditioned wherever a ray grazes it.
    pub fn add_at_rest(&mut self, object: &Object, part: &Part) {
        let geometry = match &object.source {
            Source::Shape(Shape::Sphere(sphere), _) => {
                Geometry::Ball(Ball::new(sphere.clone(), object.model_to_rest()))
            }
            Source::Shape(shape, _) => match shape.bands() {
                Some(bands) => Geometry::Turned(Turned::new(bands, object.model_to_rest())),
                None if shape.deviation() == 0.0 => {
                    Geometry::Mesh(Caster::new(part.mesh().clone()))
                }
                None => Geometry::Mesh(Caster::new(fine_mesh(object, shape, part))),
            },
            _ => Geometry::Mesh(Caster::new(part.mesh().clone())),
        };
        let stands = Stands::AtRest(object.world_line(), object.view_model());
        self.add(geometry, part.material.as_ref(), &object.name, stands);
        self.glow(object.emission);
    }

    /// Adds a photosurface of `object` as the observer of `moment` sees it, or what is shown of it under another model, in the
    /// observer's frame with the observer at the origin.
    pub fn add_photosurface(
        &mut self,
        object: &Object,
        moment: &Moment,
        mesh: &Mesh,
        material: Option<&Arc<Material>>,
    ) {
        let geometry = Geometry::Mesh(Caster::new(mesh.clone()));
        let line = object.world_line();
        let stands = Stands::Mapped(Mapped {
            aberration: Aberration::new(moment, &line, object.view_model()),
            velocity: line.velocity,
            model: object.view_model(),
            moment: self.number_of(moment),
        });
        self.add(geometry, material, &object.name, stands);
        self.glow(object.emission);
    }

    /// Adds a thing as it stands in the observer's frame.
    pub fn add_in_view(&mut self, part: &Part) {
        let geometry = Geometry::Mesh(Caster::new(part.mesh().clone()));
        self.add(geometry, part.material.as_ref(), &part.name, Stands::InView);
    }

    /// Sets all things that stand in the observer's frame and are only hinted at, each in one colour.
    pub fn set_ghosts(&mut self, ghosts: impl IntoIterator<Item = (Mesh, Color)>) {
        let ghost = |(mesh, color): (Mesh, Color)| {
            let body = Body {
                geometry: Geometry::Mesh(Caster::new(mesh)),
                paint: Paint::plain(),
                object: String::new(),
                emission: None,
                stands: Stands::InView,
            };
            (body, color.linear().into())
        };
        self.ghosts = ghosts.into_iter().map(ghost).collect();
    }

    fn add(
        &mut self,
        geometry: Geometry,
        material: Option<&Arc<Material>>,
        object: &str,
        stands: Stands,
    ) {
        self.bodies.push(Body {
            geometry,
            paint: Paint::new(material, object, &self.textures),
            object: object.to_owned(),
            emission: None,
            stands,
        });
    }

    /// The number of a moment among those of the observers of photosurfaces.
    fn number_of(&mut self, moment: &Moment) -> usize {
        if self.moments.last() != Some(moment) {
            self.moments.push(moment.clone());
        }
        self.moments.len() - 1
    }

    /// Gives the body that was added last its own light, if it has one.
    fn glow(&mut self, emission: Option<Emission>) {
        if let (Some(_), Some(body)) = (emission, self.bodies.last_mut()) {
            body.emission = emission;
            self.effects
                .get_or_insert_with(|| PictureEffects::new(Effects::default()));
        }
    }

    /// The picture that `camera` takes.
    ///
    /// Pixels are independent, rows are shared out among threads: the bytes are the same for any number
    /// of them. Memory is that of the picture.
    pub fn picture(
        &self,
        camera: &Camera,
        viewpoint: Viewpoint,
        options: PictureOptions,
    ) -> Picture {
        let going_on = || Ok::<(), Infallible>(());
        let Ok(picture) = self.try_picture(camera, viewpoint, options, going_on);
        picture
    }

    /// As [`Scenery::picture`], with a function that hears of every row and may stop the work: `row_done` is called once
    /// after each row, from several threads and in no particular order.
    ///
    /// # Errors
    ///
    /// An error that `row_done` has returned. No row is begun after it; rows in work on other threads are finished first.
    pub fn try_picture<E: Send>(
        &self,
        camera: &Camera,
        viewpoint: Viewpoint,
        options: PictureOptions,
        row_done: impl Fn() -> Result<(), E> + Sync,
    ) -> Result<Picture, E> {
        let shader = self.pixel_shader(camera, viewpoint, options);
        let size = camera.size();
        let mut bytes = vec![0; 3 * size.width() as usize * size.height() as usize];
        let rows = bytes.par_chunks_mut(3 * size.width() as usize);
        rows.enumerate().try_for_each(|(y, row)| {
            for (x, pixel) in row.chunks_exact_mut(3).enumerate() {
                let corner = DVec2::new(x as f64, y as f64);
                let light = shader.mean_light(camera, corner, grid_places(options.samples));
                pixel.copy_from_slice(&encoded(light));
            }
            row_done()
        })?;
        Ok(Picture::new(size, bytes))
    }

    /// The linear light of all pixels, row by row from the top, before it becomes bytes: of each pixel, by its number,
    /// the mean over `places` within it, at least one, from (0, 0) to (1, 1).
    pub(crate) fn light<P: Iterator<Item = DVec2>>(
        &self,
        camera: &Camera,
        viewpoint: Viewpoint,
        options: PictureOptions,
        places: impl Fn(usize) -> P + Sync,
    ) -> Vec<Vec3> {
        let shader = self.pixel_shader(camera, viewpoint, options);
        let width = camera.size().width() as usize;
        let pixels = (0..width * camera.size().height() as usize).into_par_iter();
        let light = pixels.map(|pixel| {
            let corner = DVec2::new((pixel % width) as f64, (pixel / width) as f64);
            shader.mean_light(camera, corner, places(pixel))
        });
        light.collect()
    }

    /// The luminances of the surfaces that are seen in these directions, before the exposure; of those where there are
    /// some.
    pub(crate) fn luminances(&self, viewpoint: Viewpoint, directions: &[DVec3]) -> Vec<f64> {
        let shader = self.shader(viewpoint, Color([0; 3]), None);
        let seen = directions.par_iter();
        seen.filter_map(|&seen| shader.luminance(seen)).collect()
    }

    fn pixel_shader<'a>(
        &'a self,
        camera: &'a Camera,
        viewpoint: Viewpoint,
        options: PictureOptions,
    ) -> PixelShader<'a> {
        let wires = options
            .wireframe
            .map(|color| (color.linear().into(), camera));
        self.shader(viewpoint, options.background, wires)
    }

    fn shader<'a>(
        &'a self,
        viewpoint: Viewpoint,
        background: Color,
        wires: Option<(Vec3, &'a Camera)>,
    ) -> PixelShader<'a> {
        let lit = self.lamps.as_ref().map(|lamps| self.lit(lamps, viewpoint));
        PixelShader {
            crowd: Crowd::new(self.bodies.iter(), viewpoint),
            lit,
            ghosts: Crowd::new(self.ghosts.iter().map(|(body, _)| body), viewpoint),
            ghost_colors: self.ghosts.iter().map(|&(_, color)| color).collect(),
            background: background.linear().into(),
            wires,
            effects: self.effects.as_ref(),
        }
    }

    fn lit<'a>(&'a self, lamps: &'a Lamps, viewpoint: Viewpoint) -> Lit<'a> {
        let mut velocities: Vec<Velocity> = Vec::new();
        let mut places: HashMap<VelocityKey, usize> = HashMap::new();
        let mut frames = Vec::with_capacity(self.bodies.len());
        for body in &self.bodies {
            let velocity = body.stands.velocity().unwrap_or_default();
            frames.push(*places.entry(velocity.key()).or_insert_with(|| {
                velocities.push(velocity);
                velocities.len() - 1
            }));
        }
        let others = self.occluders.iter().flat_map(|scenery| &scenery.bodies);
        let at = |moment: &Moment| {
            let occluders = self.bodies.iter().chain(others.clone());
            Lighting::new(lamps, moment, velocities.clone(), occluders)
        };
        let (by_moment, observer) = match viewpoint {
            Viewpoint::Observer(moment) => (vec![at(moment)], true),
            Viewpoint::Outside(_) => (self.moments.iter().map(at).collect(), false),
        };
        Lit {
            frames,
            by_moment,
            observer,
        }
    }

    /// Draws lines that stand in the observer's frame onto a picture that `camera` took, those of each colour over those
    /// before; what is behind something is faint.
    pub fn draw(
        &self,
        picture: &mut Picture,
        camera: &Camera,
        viewpoint: Viewpoint,
        strokes: &[Strokes<DVec3>],
    ) {
        let crowd = Crowd::new(self.bodies.iter(), viewpoint);
        let hidden = |seen, distance| crowd.nearest(seen, 0.0, distance, false).is_some();
        for strokes in strokes {
            picture.draw_in_space(strokes, camera, viewpoint.eye(), hidden);
        }
    }
}

/// Rays a pixel along each side, at most: a million a pixel show all that eight bits do.
const MAX_SAMPLES: u32 = 1024;

/// Places in a pixel, from (0, 0) to (1, 1): the middles of `samples` by `samples` squares, from 1 to [`MAX_SAMPLES`].
pub(crate) fn grid_places(samples: u32) -> impl Iterator<Item = DVec2> {
    let samples = samples.clamp(1, MAX_SAMPLES);
    let columns = move |row| (0..samples).map(move |column| DVec2::new(column.into(), row));
    let squares = (0..samples).flat_map(move |row| columns(row.into()));
    squares.map(move |square| (square + 0.5) / f64::from(samples))
}

/// The mesh of a part that a shape is, fine enough for pictures.
fn fine_mesh(object: &Object, shape: &Shape, part: &Part) -> Mesh {
    let size = part
        .mesh()
        .bounds()
        .map_or(0.0, |(low, high)| low.distance(high));
    // Of a part without an extent nothing says how fine it has to be.
    let has_extent = size > 0.0 && size.is_finite();
    let fine = has_extent.then(|| shape.within(FACETS * size / object.scale.largest()));
    let made = fine.and_then(|fine| fine.mesh().ok());
    let made = made.map(|mesh| mesh.transformed(&object.model_to_rest()));
    made.unwrap_or_else(|| part.mesh().clone())
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::super::{PictureSize, Projection};
    use super::*;

    /// A large square at `z` that faces +z, of a linear colour and an opacity, which it has whatever the light.
    fn square(z: f64, base_color: [f32; 4], alpha_mode: &str, double_sided: bool) -> Part {
        let material = json!({
            "pbrMetallicRoughness": { "baseColorFactor": base_color },
            "alphaMode": alpha_mode,
            "doubleSided": double_sided,
            "extensions": { "KHR_materials_unlit": {} },
        });
        square_of(z, material)
    }

    fn square_of(z: f64, material: serde_json::Value) -> Part {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let corners = corners.map(|(x, y)| DVec3::new(100.0 * x, 100.0 * y, z));
        let mesh = Mesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
        let material = Material::new(material, vec![]).unwrap();
        Part::new("square", mesh, Some(Arc::new(material))).unwrap()
    }

    /// What one pixel shows, seen from `eye` along `look`.
    fn pixel(parts: &[Part], eye: DVec3, look: DVec3) -> [u8; 3] {
        let mut scenery = Scenery::new();
        for part in parts {
            scenery.add_in_view(part);
        }
        let size = PictureSize::new(1, 1).unwrap();
        let projection = Projection::Perspective {
            vertical_fov_deg: 1.0,
        };
        let camera = Camera::new(size, projection, look).unwrap();
        let options = PictureOptions {
            samples: 1,
            background: Color([0, 0, 255]),
            wireframe: None,
        };
        let picture = scenery.picture(&camera, Viewpoint::Outside(eye), options);
        picture.pixel(0, 0)
    }

    #[test]
    fn what_is_clear_lets_through_what_is_behind() {
        let (red, green) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        let of = |z, [r, g, b]: [f32; 3], opacity, mode| square(z, [r, g, b, opacity], mode, true);
        let seen = |parts: &[Part]| pixel(parts, DVec3::Z, DVec3::NEG_Z);
        let half = |parts: &[Part]| {
            let linear = Color(seen(parts)).linear();
            linear.map(|channel| (channel * 100.0).round())
        };
        let back = of(-9.0, green, 1.0, "OPAQUE");
        assert_eq!(seen(&[]), [0, 0, 255]);
        assert_eq!(seen(std::slice::from_ref(&back)), [0, 255, 0]);
        let pane = of(-3.0, red, 0.5, "BLEND");
        assert_eq!(half(&[back.clone(), pane.clone()]), [50.0, 50.0, 0.0]);
        assert_eq!(half(&[pane]), [50.0, 0.0, 50.0]);
        let hole = of(-3.0, red, 0.4, "MASK");
        assert_eq!(seen(&[hole, back.clone()]), [0, 255, 0]);
        let no_hole = of(-3.0, red, 0.6, "MASK");
        assert_eq!(seen(&[no_hole, back]), [255, 0, 0]);
    }

    #[test]
    fn backs_are_there_only_where_the_material_says_so() {
        let white = [1.0; 4];
        let behind = |double_sided| {
            let part = square(0.0, white, "OPAQUE", double_sided);
            pixel(&[part], DVec3::NEG_Z, DVec3::Z)
        };
        assert_eq!(behind(true), [255; 3]);
        assert_eq!(behind(false), [0, 0, 255]);
    }

    /// Half a pixel is black and half is white: half the light, which is more than half the levels.
    #[test]
    fn pixels_are_means_of_linear_light() {
        let mut scenery = Scenery::new();
        let mut wall = square(0.0, [1.0; 4], "OPAQUE", true);
        wall = wall.transformed(&glam::DAffine3::from_translation(DVec3::X * 100.0));
        scenery.add_in_view(&wall);
        let size = PictureSize::new(1, 1).unwrap();
        let projection = Projection::Perspective {
            vertical_fov_deg: 1.0,
        };
        let camera = Camera::new(size, projection, DVec3::NEG_Z).unwrap();
        for samples in [2, 4] {
            let options = PictureOptions {
                samples,
                background: Color([0; 3]),
                wireframe: None,
            };
            let viewpoint = Viewpoint::Outside(DVec3::Z);
            let picture = scenery.picture(&camera, viewpoint, options);
            assert_eq!(picture.pixel(0, 0), [188; 3]);
        }
    }

    /// Linear light of a matte square of linear grey `grey` and some emission, whose normal is +z, seen along `look`.
    fn lit(grey: f64, emission: f64, look: DVec3) -> f64 {
        let material = json!({
            "pbrMetallicRoughness": { "baseColorFactor": [grey, grey, grey, 1.0], "metallicFactor": 0.0 },
            "emissiveFactor": [emission, emission, emission],
        });
        let [level, ..] = Color(pixel(&[square_of(0.0, material)], -look, look)).linear();
        f64::from(level)
    }

    /// Half a step of 8 bits, where steps are largest.
    const HALF_STEP: f64 = 0.0045;

    #[test]
    fn the_lamp_is_at_the_eye_and_matte_surfaces_do_not_burn_out() {
        let ahead = lit(1.0, 0.0, DVec3::NEG_Z);
        assert!((0.8..0.9).contains(&ahead), "{ahead}");
        let grey = lit(0.25, 0.0, DVec3::NEG_Z);
        // A gloss of a hundredth at most, whatever the colour.
        assert!((grey - 0.25 * ahead).abs() < 0.01, "{grey} {ahead}");
        let glowing = lit(0.25, 0.5, DVec3::NEG_Z);
        assert!((glowing - grey - 0.5).abs() < 2.0 * HALF_STEP, "{glowing}");
        let slanted = lit(1.0, 0.0, DVec3::new(3.0, 0.0, -4.0));
        let grazed = lit(1.0, 0.0, DVec3::new(1.0, 0.0, -1e-3));
        // The part of the lamp goes as the cosine, but for the gloss.
        let expected = grazed + (ahead - grazed) * 0.8;
        assert!((slanted - expected).abs() < 0.015, "{slanted} {expected}");
    }
}
