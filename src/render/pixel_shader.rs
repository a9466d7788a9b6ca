//! What decides the colour of a pixel: from hits to linear light.

use glam::{DVec2, DVec3, Vec3};

use super::body::Hit;
use super::crowd::Crowd;
use super::crowd::Observed;
use super::lighting::{Lighting, Surface};
use super::paint::Look;
use super::shading::head_light;
use super::shadows::LitPlace;
use super::{Camera, PictureEffects};
use crate::effects::luminance;

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
    /// Without lamps there is one at the eye.
    pub(super) lit: Option<Lit<'a>>,
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
        if self.ghost_colors.is_empty() {
            return light;
        }
        for hit in self.ghosts.all(seen) {
            let grazing = 1.0 - hit.facing.eye_cosine() as f32;
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
            let (look, wire) = self.surface(place, &hit);
            if look.opacity > 0.0 {
                first = first.min(hit.distance);
                let part = look.opacity * clearness;
                match self.effects {
                    None => light += plain_light(&look, wire, &hit) * part,
                    Some(effects) => {
                        let strong_light = self.strong_light(effects, &look, wire, &hit, seen);
                        strong += strong_light * f64::from(part);
                    }
                }
            }
            clearness *= 1.0 - look.opacity;
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

    /// What the place that is hit looks like, and the colour of a wire on it.
    fn surface(&self, place: DVec2, hit: &Hit) -> (Look, Option<Vec3>) {
        let mut look = hit.paint.look(&hit.texture, hit.vertex_color);
        let (Some((wire, camera)), Some(triangle)) = (self.wires, hit.triangle) else {
            return (look, None);
        };
        let corners = triangle.map(|corner| corner - self.crowd.eye());
        let is_wire = is_on_edge(camera, corners, place);
        if is_wire {
            // Not opaque: where triangles are smaller than pixels all would be wire.
            look.opacity = look.opacity.max(WIRE);
        }
        (look, is_wire.then_some(wire))
    }

    /// With effects, before the exposure: the light that the eye gets from a place of a surface.
    fn strong_light(
        &self,
        effects: &PictureEffects,
        look: &Look,
        wire: Option<Vec3>,
        hit: &Hit,
        seen: DVec3,
    ) -> DVec3 {
        let doppler = self.crowd.doppler(hit, seen);
        let head = || head_light(look.finish, hit.facing, look.open);
        let light = if let Some(emission) = hit.emission {
            effects.of_black_body(emission, doppler)
        } else if hit.paint.unlit {
            effects.of_surface(look.base_color, doppler)
        } else {
            let emitted = match look.emission == Vec3::ZERO {
                true => DVec3::ZERO,
                false => effects.of_surface(look.emission, doppler),
            };
            let lit = self.lit.as_ref().zip(self.crowd.observed(hit, seen));
            let by_lamps = lit.and_then(|(lit, observed)| {
                lit.light(effects, look, hit, &observed, doppler.unwrap_or(1.0))
            });
            let reflected =
                by_lamps.unwrap_or_else(|| effects.of_head_light(look.base_color, head(), doppler));
            emitted + reflected
        };
        match wire {
            Some(wire) => light.lerp(wire.as_dvec3() * head().tinted, f64::from(WIRE)),
            None => light,
        }
    }
}

/// The lamps that light what is before the camera.
pub(super) struct Lit<'a> {
    /// The number of the frame of each body.
    pub(super) frames: Vec<usize>,
    /// For each moment of an observer.
    pub(super) by_moment: Vec<Lighting<'a>>,
    /// Whether the observer at the only moment takes the picture.
    pub(super) observer: bool,
}

impl Lit<'_> {
    /// The light of lamps that a surface reflects, before the exposure.
    fn light(
        &self,
        effects: &PictureEffects,
        look: &Look,
        hit: &Hit,
        observed: &Observed,
        doppler: f64,
    ) -> Option<DVec3> {
        let moment = if self.observer { 0 } else { observed.moment };
        let (lighting, frame) = (self.by_moment.get(moment)?, self.frames[hit.body]);
        let (seen, distance) = match observed.seen {
            Some(seen) => seen,
            None => lighting.seen(frame, observed.offset_rest)?,
        };
        let surface = Surface {
            place: LitPlace {
                seen,
                distance,
                object: observed.object,
            },
            frame,
            facing: observed.facing,
            finish: look.finish,
            open: look.open,
        };
        let mut sum = DVec3::ZERO;
        lighting.light(&surface, effects.shifts(), |lit| {
            sum += effects.of_lamp(look.base_color, &lit, doppler);
        });
        Some(sum)
    }
}

/// Without effects: the light that the eye gets from a place of a surface.
fn plain_light(look: &Look, wire: Option<Vec3>, hit: &Hit) -> Vec3 {
    debug_assert!(hit.doppler > 0.0);
    let color = wire.map_or(look.base_color, |wire| look.base_color.lerp(wire, WIRE));
    if hit.paint.unlit {
        return color;
    }
    let reflected = head_light(look.finish, hit.facing, look.open);
    color * reflected.tinted as f32 + reflected.white as f32 + look.emission
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
