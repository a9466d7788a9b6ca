//! What decides the colour of a pixel: from hits to linear light.

use glam::{DVec2, DVec3, Vec3};

use super::Camera;
use super::body::Hit;
use super::crowd::Crowd;
use super::paint::Look;
use super::shading::head_light;

/// Most surfaces one ray of light is followed through.
const MAX_LAYERS: usize = 64;

/// A ray goes on behind a surface by this part of the way to it, so that it does not meet it again.
const STEP_BEHIND: f64 = 1.0 + 1e-12;

/// What is too faint to see: half a step of 8 bits, squared.
const OPAQUE: f32 = 1.0 / (510.0 * 510.0);

/// How opaque a ghost is where it is seen head-on, and how much more at its rim.
const GHOST: [f32; 2] = [0.1, 0.6];

/// How much of a ghost is seen through what is in front of it.
const GHOST_BEHIND: f32 = 0.8;

/// How opaque the edges of triangles are.
const WIRE: f32 = 0.7;

/// Half the width of the edges of triangles, in pixels.
const HALF_WIRE: f64 = 0.6;

/// What turns hits into linear light.
pub(super) struct PixelShader<'a> {
    pub(super) crowd: Crowd<'a>,
    pub(super) ghosts: Crowd<'a>,
    pub(super) ghost_colors: Vec<Vec3>,
    pub(super) background: Vec3,
    /// The colour of wires, and how they come to be on the picture.
    pub(super) wires: Option<(Vec3, &'a Camera)>,
}

impl PixelShader<'_> {
    /// The linear colour of a pixel: the mean over places within it, given from its upper left corner.
    pub(super) fn mean_light(
        &self,
        camera: &Camera,
        corner: DVec2,
        places: impl Iterator<Item = DVec2>,
    ) -> Vec3 {
        // In f64: the mean of many equal colours is this colour.
        let (mut sum, mut count) = (DVec3::ZERO, 0_u32);
        for inside in places {
            let place = corner + inside;
            sum += self.light(place, camera.direction(place)).as_dvec3();
            count += 1;
        }
        (sum / f64::from(count)).as_vec3()
    }

    /// The linear colour that is seen at a place of the picture, in the direction `seen`.
    fn light(&self, place: DVec2, seen: DVec3) -> Vec3 {
        let (mut light, distance) = self.solid_light(place, seen);
        for hit in self.ghosts.all(seen) {
            let grazing = 1.0 - hit.facing.eye_cosine() as f32;
            let opacity = GHOST[0] + GHOST[1] * grazing * grazing;
            let behind = hit.distance > distance;
            let veiled = if behind { GHOST_BEHIND } else { 1.0 };
            light = light.lerp(self.ghost_colors[hit.body], opacity * veiled);
        }
        light
    }

    /// Without ghosts, and how far away the first surface is.
    fn solid_light(&self, place: DVec2, seen: DVec3) -> (Vec3, f64) {
        let mut light = Vec3::ZERO;
        let mut clearness = 1.0;
        let mut beyond = 0.0;
        let mut first = f64::MAX;
        for _ in 0..MAX_LAYERS {
            let nearest = self
                .crowd
                .nearest(seen, beyond, f64::MAX, self.wires.is_some());
            let Some(hit) = nearest else {
                return (light + self.background * clearness, first);
            };
            let look = self.surface(place, &hit);
            if look.opacity > 0.0 {
                first = first.min(hit.distance);
                light += light_of(&look, &hit) * (look.opacity * clearness);
            }
            clearness *= 1.0 - look.opacity;
            if clearness < OPAQUE {
                break;
            }
            beyond = hit.distance * STEP_BEHIND;
        }
        (light, first)
    }

    /// What the place that is hit looks like, with the wires on it.
    fn surface(&self, place: DVec2, hit: &Hit) -> Look {
        let mut look = hit.paint.look(&hit.texture, hit.vertex_color);
        if let (Some((wire, camera)), Some(triangle)) = (self.wires, hit.triangle) {
            let corners = triangle.map(|corner| corner - self.crowd.eye());
            if is_on_edge(camera, corners, place) {
                // Not opaque: where triangles are smaller than pixels all would be wire.
                look.base_color = look.base_color.lerp(wire, WIRE);
                look.opacity = look.opacity.max(WIRE);
            }
        }
        look
    }
}

/// The light that the eye gets from a place of a surface.
fn light_of(look: &Look, hit: &Hit) -> Vec3 {
    debug_assert!(hit.doppler > 0.0);
    if hit.paint.unlit {
        return look.base_color;
    }
    let reflected = head_light(look.finish, hit.facing, look.open);
    look.base_color * reflected.tinted as f32 + reflected.white as f32 + look.emission
}

/// Whether a place of the picture is on an edge of a triangle, given by its corners from the eye.
fn is_on_edge(camera: &Camera, corners: [DVec3; 3], place: DVec2) -> bool {
    let [Some(a), Some(b), Some(c)] = corners.map(|corner| camera.place(corner)) else {
        return false;
    };
    [[a, b], [b, c], [c, a]].into_iter().any(|[start, end]| {
        let along = end - start;
        let part = (place - start).dot(along) / along.length_squared();
        place.distance(start.lerp(end, part.clamp(0.0, 1.0))) < HALF_WIRE
    })
}
