//! What decides the colour of a pixel: from hits to linear light.

use glam::{DVec2, DVec3, Vec3};

use super::body::Hit;
use super::crowd::Crowd;
use super::{Camera, PictureEffects};
use crate::effects::luminance;

/// How bright a surface is that the lamp only grazes.
pub(super) const AMBIENT: f32 = 0.25;

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
    pub(super) effects: Option<&'a PictureEffects>,
}

/// What comes along one ray.
struct Gathered {
    /// The light of surfaces, if there are no effects.
    light: Vec3,
    /// With effects, before the exposure.
    strong: DVec3,
    /// The light of the background.
    behind: Vec3,
    /// How far away the first surface is.
    first: f64,
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
            let grazing = 1.0 - hit.cosine as f32;
            let opacity = GHOST[0] + GHOST[1] * grazing * grazing;
            let behind = hit.distance > distance;
            let veiled = if behind { GHOST_BEHIND } else { 1.0 };
            light = light.lerp(self.ghost_colors[hit.body], opacity * veiled);
        }
        light
    }

    /// The luminance of the surfaces that are seen in a direction, before the exposure, if there are some.
    pub(super) fn luminance(&self, seen: DVec3) -> Option<f64> {
        let gathered = self.gathered(DVec2::ZERO, seen);
        let light = gathered.strong + gathered.light.as_dvec3();
        (gathered.first < f64::MAX).then(|| luminance(light).max(0.0))
    }

    /// Without ghosts, and how far away the first surface is.
    fn solid_light(&self, place: DVec2, seen: DVec3) -> (Vec3, f64) {
        let gathered = self.gathered(place, seen);
        let light = match self.effects {
            Some(effects) => effects.shown(gathered.strong),
            None => gathered.light,
        };
        (light + gathered.behind, gathered.first)
    }

    fn gathered(&self, place: DVec2, seen: DVec3) -> Gathered {
        let mut light = Vec3::ZERO;
        let mut strong = DVec3::ZERO;
        let mut behind = Vec3::ZERO;
        let mut clearness = 1.0;
        let mut beyond = 0.0;
        let mut first = f64::MAX;
        for _ in 0..MAX_LAYERS {
            let nearest = self
                .crowd
                .nearest(seen, beyond, f64::MAX, self.wires.is_some());
            let Some(hit) = nearest else {
                behind = self.background * clearness;
                break;
            };
            let (color, opacity, wire) = self.surface(place, &hit);
            if opacity > 0.0 {
                first = first.min(hit.distance);
            }
            let bright = |color: DVec3| color * f64::from(brightness(&hit));
            match self.effects {
                None => {
                    let color = wire.map_or(color, |wire| color.lerp(wire, WIRE));
                    light += color * (brightness(&hit) * opacity * clearness);
                }
                Some(effects) => {
                    let doppler = self.crowd.doppler(&hit, seen);
                    let seen = match hit.emission {
                        Some(emission) => effects.of_black_body(emission, doppler),
                        None => bright(effects.of_surface(color, doppler)),
                    };
                    let seen = wire.map_or(seen, |wire| {
                        seen.lerp(bright(wire.as_dvec3()), f64::from(WIRE))
                    });
                    strong += seen * f64::from(opacity * clearness);
                }
            }
            clearness *= 1.0 - opacity;
            if clearness < OPAQUE {
                break;
            }
            beyond = hit.distance * STEP_BEHIND;
        }
        Gathered {
            light,
            strong,
            behind,
            first,
        }
    }

    /// Colour and opacity of what is hit, and the colour of a wire on it.
    fn surface(&self, place: DVec2, hit: &Hit) -> (Vec3, f32, Option<Vec3>) {
        let (color, opacity) = hit.paint.color_at(hit.texture, hit.vertex_color);
        let (Some((wire, camera)), Some(triangle)) = (self.wires, hit.triangle) else {
            return (color, opacity, None);
        };
        let corners = triangle.map(|corner| corner - self.crowd.eye());
        match is_on_edge(camera, corners, place) {
            // Not opaque: where triangles are smaller than pixels all would be wire.
            true => (color, opacity.max(WIRE), Some(wire)),
            false => (color, opacity, None),
        }
    }
}

/// How much of its colour what is hit shows by the lamp at the eye.
fn brightness(hit: &Hit) -> f32 {
    debug_assert!((0.0..=1.0).contains(&hit.cosine) && hit.doppler > 0.0);
    match hit.paint.unlit {
        true => 1.0,
        false => AMBIENT + (1.0 - AMBIENT) * hit.cosine as f32,
    }
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
