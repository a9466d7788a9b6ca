//! A material in the words of glTF.

use std::collections::BTreeSet;
use std::sync::Arc;

use serde_json::Value;

use super::properties::{check, names_of_extensions, tex_coord, texture_index};
use super::{MaterialError, Texture, extension_names, retain_textures};

/// A material in the words of glTF, with its textures.
///
/// # Example
///
/// ```
/// use photosurface::material::{AlphaMode, Material};
/// use serde_json::json;
///
/// let glass = json!({ "pbrMetallicRoughness": { "baseColorFactor": [0.2, 0.4, 0.3, 0.5] }, "alphaMode": "BLEND" });
/// let glass = Material::new(glass, vec![])?;
/// assert_eq!(glass.base_color(), [0.2, 0.4, 0.3, 0.5]);
/// assert_eq!(glass.alpha_mode(), AlphaMode::Blend);
/// # Ok::<(), photosurface::material::MaterialError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// A `material` of glTF whose texture infos index into `textures`.
    properties: Value,
    /// Those that are used.
    textures: Vec<Arc<Texture>>,
    /// Extensions without which it is not what it should be.
    required: BTreeSet<String>,
}

/// What the opacity of a material means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlphaMode {
    /// Nothing.
    Opaque,
    /// Opaque from this opacity on, else absent.
    Mask(f64),
    /// Blended with what is behind.
    Blend,
}

impl Material {
    /// A material with these properties, as a `material` of glTF has them; the `index` of each texture info
    /// says which of `textures` it means.
    ///
    /// Texture infos are the objects with an `index` whose name ends in `Texture`, in extensions too.
    ///
    /// # Errors
    ///
    /// A property of the metallic-roughness model that is not what glTF has there, or a texture that is not there.
    pub fn new(properties: Value, textures: Vec<Arc<Texture>>) -> Result<Self, MaterialError> {
        check(&properties)?;
        let mut material = Self {
            properties,
            textures: vec![],
            required: BTreeSet::new(),
        };
        let mut wrong = None;
        let used = &mut material.textures;
        retain_textures(&mut material.properties, |slot, info| {
            let index = texture_index(info);
            match textures.get(index as usize) {
                Some(texture) => info["index"] = position(used, texture).into(),
                None => {
                    wrong.get_or_insert(MaterialError::Texture {
                        slot: slot.to_owned(),
                        index,
                        count: textures.len(),
                    });
                }
            }
            true
        });
        wrong.map_or(Ok(material), Err)
    }

    /// The same material, which is not what it should be without those of its extensions that are among
    /// `names`: a file with it says so.
    #[must_use]
    pub fn requiring<'a>(mut self, names: impl IntoIterator<Item = &'a str>) -> Self {
        let own = self.extensions();
        let required = names.into_iter().filter(|name| own.contains(*name));
        self.required = required.map(str::to_owned).collect();
        self
    }

    /// Everything it says, as a `material` of glTF; the `index` of each texture info is that in
    /// [`textures`](Self::textures).
    pub fn properties(&self) -> &Value {
        &self.properties
    }

    /// Its textures, each once.
    pub fn textures(&self) -> &[Arc<Texture>] {
        &self.textures
    }

    /// Names of the extensions that it uses, and its textures.
    pub fn extensions(&self) -> BTreeSet<String> {
        let mut names = extension_names(&self.properties);
        for texture in &self.textures {
            texture.add_extensions(&mut names);
        }
        names
    }

    /// Those of its extensions without which it is not what it should be.
    pub fn required_extensions(&self) -> &BTreeSet<String> {
        &self.required
    }

    /// As the source names it.
    pub fn name(&self) -> Option<&str> {
        self.properties.get("name")?.as_str()
    }

    /// Linear red, green, blue and opacity.
    pub fn base_color(&self) -> [f64; 4] {
        let factor = self
            .properties
            .pointer("/pbrMetallicRoughness/baseColorFactor");
        let number = |channel: usize| factor.and_then(|factor| factor.get(channel)?.as_f64());
        [0, 1, 2, 3].map(|channel| number(channel).unwrap_or(1.0))
    }

    /// What multiplies the base colour, and by which `TEXCOORD_n` it is placed.
    pub fn base_color_texture(&self) -> Option<(&Arc<Texture>, u64)> {
        let info = self
            .properties
            .pointer("/pbrMetallicRoughness/baseColorTexture")?;
        let texture = self.textures.get(texture_index(info) as usize)?;
        Some((texture, tex_coord(info)))
    }

    /// What the opacity means.
    pub fn alpha_mode(&self) -> AlphaMode {
        match self.properties.get("alphaMode").and_then(Value::as_str) {
            Some("BLEND") => AlphaMode::Blend,
            Some("MASK") => {
                let cutoff = self.properties.get("alphaCutoff").and_then(Value::as_f64);
                AlphaMode::Mask(cutoff.unwrap_or(0.5))
            }
            _ => AlphaMode::Opaque,
        }
    }

    /// Whether the back of the triangles is drawn.
    pub fn double_sided(&self) -> bool {
        self.properties.get("doubleSided").and_then(Value::as_bool) == Some(true)
    }

    /// Whether it has its colour whatever the light, as `KHR_materials_unlit` says.
    pub fn is_unlit(&self) -> bool {
        names_of_extensions(&self.properties).any(|name| name == "KHR_materials_unlit")
    }

    /// The same with white in place of the base colour and its texture: for a mesh whose vertices have all of it.
    pub(crate) fn without_base_color(&self) -> Self {
        let mut properties = self.properties.clone();
        if let Some(base) = properties
            .get_mut("pbrMetallicRoughness")
            .and_then(Value::as_object_mut)
        {
            base.remove("baseColorTexture");
            base.remove("baseColorFactor");
        }
        Self::new(properties, self.textures.clone())
            .expect("less of what has been checked")
            .requiring(self.required.iter().map(String::as_str))
    }

    /// The same without the textures that a mesh of so many texture coordinate sets cannot place, and the
    /// names of their slots.
    pub(crate) fn placed_by(&self, sets: usize) -> (Self, Vec<String>) {
        let mut dropped = vec![];
        let mut properties = self.properties.clone();
        retain_textures(&mut properties, |slot, info| {
            let moved = info.pointer("/extensions/KHR_texture_transform");
            let needed = tex_coord(info).max(moved.map_or(0, tex_coord));
            let placed = needed < sets as u64;
            if !placed {
                dropped.push(slot.to_owned());
            }
            placed
        });
        let rest = Self::new(properties, self.textures.clone())
            .expect("less of what has been checked")
            .requiring(self.required.iter().map(String::as_str));
        (rest, dropped)
    }
}

/// The place of something shared in a list, to which it is added where it is not there yet.
pub(crate) fn position<T>(list: &mut Vec<Arc<T>>, item: &Arc<T>) -> usize {
    let known = list.iter().position(|known| Arc::ptr_eq(known, item));
    known.unwrap_or_else(|| {
        list.push(item.clone());
        list.len() - 1
    })
}

#[cfg(test)]
mod tests {
    use super::super::Image;
    use super::*;
    use serde_json::json;

    fn texture() -> Arc<Texture> {
        let image = Image::new(None, b"\xff\xd8\xff".to_vec()).unwrap();
        Arc::new(Texture::new(Arc::new(image), None))
    }

    #[test]
    fn what_gltf_leaves_out_has_its_defaults() {
        let material = Material::new(json!({}), vec![texture()]).unwrap();
        assert_eq!(material.base_color(), [1.0; 4]);
        assert_eq!(material.alpha_mode(), AlphaMode::Opaque);
        assert!(!material.double_sided() && !material.is_unlit());
        assert_eq!(material.name(), None);
        assert!(
            material.textures().is_empty(),
            "one that no slot uses is gone"
        );
        let mask = Material::new(json!({"alphaMode": "MASK"}), vec![]).unwrap();
        assert_eq!(mask.alpha_mode(), AlphaMode::Mask(0.5));
    }

    #[test]
    fn textures_are_found_in_extensions_but_not_in_extras() {
        let properties = json!({
            "extensions": {"ACME_coat": {"layers": [{"coatTexture": {"index": 1}}], "index": 7}},
            "extras": {"myTexture": {"index": 99}},
        });
        let textures = vec![texture(), texture()];
        let material = Material::new(properties, textures.clone()).unwrap();
        assert!(Arc::ptr_eq(&material.textures()[0], &textures[1]));
        let found = material
            .properties()
            .pointer("/extensions/ACME_coat/layers/0/coatTexture/index");
        assert_eq!(found, Some(&json!(0)));
        assert_eq!(
            material.properties()["extras"]["myTexture"]["index"],
            json!(99)
        );
    }

    #[test]
    fn what_makes_no_material_is_refused() {
        for (properties, message) in [
            (json!([]), "the material is [], expected an object"),
            (
                json!({"doubleSided": 1}),
                "doubleSided is 1, expected true or false",
            ),
            (
                json!({"alphaMode": "GLOW"}),
                "alphaMode is \"GLOW\", expected OPAQUE, MASK or BLEND",
            ),
            (
                json!({"pbrMetallicRoughness": {"metallicFactor": 1.5}}),
                "pbrMetallicRoughness.metallicFactor is 1.5, expected a number from 0 to 1",
            ),
            (
                json!({"emissiveFactor": [1, 0]}),
                "emissiveFactor is [1,0], expected 3 numbers from 0 to 1",
            ),
            (
                json!({"normalTexture": {"index": 2}}),
                "normalTexture asks for texture 2, expected one of 1",
            ),
            (
                json!({"normalTexture": {}}),
                "normalTexture.index is null, expected a whole number from 0",
            ),
        ] {
            let error = Material::new(properties, vec![texture()]).unwrap_err();
            assert_eq!(error.to_string(), message);
        }
    }

    #[test]
    fn vertices_may_have_all_of_the_base_colour() {
        let properties = json!({
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.1, 0.2, 0.3, 0.4], "baseColorTexture": {"index": 1}, "metallicFactor": 0.25,
            },
            "normalTexture": {"index": 0},
            "alphaMode": "MASK",
        });
        let material = Material::new(properties, vec![texture(), texture()]).unwrap();
        let plain = material.without_base_color();
        assert_eq!(plain.base_color(), [1.0; 4]);
        assert!(plain.base_color_texture().is_none());
        assert_eq!(plain.textures().len(), 1);
        let expected = json!({
            "pbrMetallicRoughness": {"metallicFactor": 0.25}, "normalTexture": {"index": 0}, "alphaMode": "MASK",
        });
        assert_eq!(plain.properties(), &expected);
    }

    #[test]
    fn a_mesh_without_coordinates_drops_what_needs_them() {
        let moved = json!({"index": 0, "extensions": {"KHR_texture_transform": {"texCoord": 1}}});
        let properties = json!({
            "pbrMetallicRoughness": {"metallicRoughnessTexture": {"index": 1, "texCoord": 1}},
            "normalTexture": {"index": 0},
            "emissiveTexture": moved,
        });
        let material = Material::new(properties, vec![texture(), texture()]).unwrap();
        assert_eq!(material.placed_by(2), (material.clone(), vec![]));
        let (rest, dropped) = material.placed_by(1);
        assert_eq!(dropped, ["metallicRoughnessTexture", "emissiveTexture"]);
        assert_eq!(rest.textures().len(), 1);
        // Where the metal is was in the texture: all would be metal without it.
        let factors = json!({"metallicFactor": 0.0});
        let expected = json!({"pbrMetallicRoughness": factors, "normalTexture": {"index": 0}});
        assert_eq!(rest.properties(), &expected);
    }
}
