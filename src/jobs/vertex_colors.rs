//! Colours of the vertices of photosurfaces as the observer sees them, for files.

use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

use glam::Vec4;
use rayon::prelude::*;

use crate::effects::{Doppler, Lamplight, SeenLight, within_screen};
use crate::material::Material;
use crate::pipeline::{Photosurface, PlacedScene, SurfaceOptions};
use crate::render::{Paint, Textures};
use crate::scene::{Attribute, Attributes, Effects, Emission, Exposure, Object, Scene};

/// Vertices that a thread colours at a time.
const VERTICES_PER_JOB: usize = 1024;

/// Gives photosurfaces the colours that the observer sees, and materials that show them.
pub(super) struct VertexColors<'a> {
    objects: HashMap<&'a str, &'a Object>,
    effects: Effects,
    light: SeenLight,
    textures: Textures,
    /// By the address of the material that each stands for, which is kept there.
    materials: HashMap<usize, (Arc<Material>, Arc<Material>)>,
    glowing: Option<Arc<Material>>,
    notes: Vec<LightNote>,
}

/// What files do not hold of light and colours as pictures do.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LightNote {
    /// A texture whose colours became those of vertices.
    Texture {
        /// The first object whose material has it.
        object: String,
        /// The material as its source names it, if it does.
        material: Option<String>,
    },
    /// An exposure that is found for pictures alone.
    Exposure,
    /// Lamps, which light pictures alone.
    Lamps,
}

impl fmt::Display for LightNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Texture { object, material } => {
                write!(f, "\"{object}\": the texture of its material ")?;
                if let Some(material) = material {
                    write!(f, "\"{material}\" ")?;
                }
                f.write_str(
                    "became colours of vertices, which show no more of it than the mesh has vertices",
                )
            }
            Self::Lamps => f.write_str(
                "the scene's lamps light pictures; files have materials and colours without their light",
            ),
            Self::Exposure => f.write_str(
                "the exposure \"auto\" is for pictures; colours of vertices have an exposure of 0 stops",
            ),
        }
    }
}

impl<'a> VertexColors<'a> {
    /// What colours the photosurfaces of a scene, if the scene calls for colours.
    pub(super) fn new(placed: &'a PlacedScene, textures: &Textures) -> Option<Self> {
        let scene = placed.scene();
        let effects = scene.effects().shown();
        let objects = scene.objects().iter();
        Self::are_wanted(scene).then(|| Self {
            objects: objects.map(|o| (o.name.as_str(), o)).collect(),
            effects,
            light: SeenLight::new(effects.doppler, effects.searchlight),
            textures: textures.clone(),
            materials: HashMap::new(),
            glowing: None,
            notes: match effects.exposure {
                Exposure::Auto => vec![LightNote::Exposure],
                Exposure::Stops(_) => vec![],
            },
        })
    }

    /// Whether a scene calls for colours of vertices.
    pub(super) fn are_wanted(scene: &Scene) -> bool {
        let mut objects = scene.objects().iter();
        let Effects {
            doppler,
            searchlight,
            ..
        } = scene.effects().shown();
        doppler != Doppler::None || searchlight || objects.any(|object| object.emission.is_some())
    }

    /// What is wanted of photosurfaces, with what colours need.
    pub(super) fn needed(wanted: SurfaceOptions) -> SurfaceOptions {
        SurfaceOptions {
            attributes: wanted.attributes.with(Attribute::Doppler),
            ..wanted
        }
    }

    /// The photosurface with its colours, and with no other attributes than those that are asked for.
    pub(super) fn colored(
        &mut self,
        mut photosurface: Photosurface,
        asked_for: Attributes,
    ) -> Photosurface {
        let emission = self.objects.get(photosurface.facts.object.as_str());
        let emission = emission.and_then(|object| object.emission);
        if emission.is_some() || self.light.is_shifted() {
            let colors = self.colors(&photosurface, emission);
            let mesh = photosurface.mesh.with_colors(colors);
            photosurface.mesh = mesh.expect("one finite colour for each vertex");
            let before = photosurface.material.clone();
            photosurface.material = match (emission, photosurface.material) {
                (Some(_), _) => Some(self.glowing.get_or_insert_with(glowing).clone()),
                (None, Some(material)) => Some(self.plain(material, &photosurface.facts.object)),
                (None, None) => None,
            };
            let textures = |material: &Arc<Material>| material.textures().len();
            let has_textures = photosurface.material.as_ref().map_or(0, textures) > 0;
            // Programs that find coordinates look for a texture in place of the colours.
            if before.is_some() && !has_textures {
                photosurface.mesh = photosurface.mesh.without_texture_coordinates();
            }
        }
        if !asked_for.contains(Attribute::Doppler) {
            photosurface.vertex_data.set(Attribute::Doppler, None);
        }
        photosurface
    }

    /// What is to be said of the colours so far.
    pub(super) fn notes(&self) -> &[LightNote] {
        &self.notes
    }

    /// Linear colours and opacities, from 0 to 1.
    fn colors(&self, photosurface: &Photosurface, emission: Option<Emission>) -> Vec<Vec4> {
        let Photosurface {
            facts,
            mesh,
            material,
            ..
        } = photosurface;
        let paint = Paint::new(material.as_ref(), &facts.object, &self.textures);
        let factors = photosurface.vertex_data.doppler_factors();
        let factors = factors.expect("colours ask for the Doppler factor");
        let exposure = match self.effects.exposure {
            Exposure::Stops(stops) => stops.factor(),
            Exposure::Auto => 1.0,
        };
        let daylight: Lamplight = self.light.daylight();
        let vertices = factors
            .par_iter()
            .enumerate()
            .with_min_len(VERTICES_PER_JOB);
        let colors = vertices.map(|(vertex, &factor)| {
            let at_rest = paint.at_vertex(mesh, vertex);
            let light = match emission {
                Some(emission) => {
                    self.light
                        .glow(emission.temperature(), emission.luminance(), factor)
                }
                None => self
                    .light
                    .seen(at_rest.truncate().as_dvec3(), daylight, factor),
            };
            let shown = within_screen(light * exposure).as_vec3();
            let opacity = match emission {
                Some(_) => 1.0,
                None => at_rest.w.clamp(0.0, 1.0),
            };
            shown.extend(opacity)
        });
        colors.collect()
    }

    /// The material without its base colour: white, so that it shows the colours of the vertices.
    fn plain(&mut self, material: Arc<Material>, object: &str) -> Arc<Material> {
        let address = Arc::as_ptr(&material) as usize;
        if let Some((_, plain)) = self.materials.get(&address) {
            return plain.clone();
        }
        if material.base_color_texture().is_some() && self.effects.doppler != Doppler::Ramp {
            self.notes.push(LightNote::Texture {
                object: object.to_owned(),
                material: material.name().map(str::to_owned),
            });
        }
        let plain = Arc::new(material.without_base_color());
        self.materials.insert(address, (material, plain.clone()));
        plain
    }
}

/// The material of black bodies: unlit.
fn glowing() -> Arc<Material> {
    let properties = serde_json::json!({
        "pbrMetallicRoughness": { "metallicFactor": 0.0, "roughnessFactor": 1.0 },
        "doubleSided": true,
        "extensions": { "KHR_materials_unlit": {} },
    });
    Arc::new(Material::new(properties, vec![]).expect("as glTF has it"))
}
