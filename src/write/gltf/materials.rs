//! Materials in a glTF file: in the words that they came in, their textures, samplers and images written once.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

use serde_json::{Value, json};

use crate::material::{Image, Material, Texture, map_sources, retain_textures};

/// The materials of a file in the making, with all that belongs to them.
#[derive(Default)]
pub(super) struct Materials {
    /// Kept, so that no other comes to the address of one.
    added: HashMap<usize, (Arc<Material>, usize)>,
    for_those_without: Option<Arc<Material>>,
    materials: Vec<Value>,
    textures: Once<Texture>,
    images: Once<Image>,
    extensions_used: BTreeSet<String>,
    extensions_required: BTreeSet<String>,
}

impl Materials {
    /// The index of a material in the file. For what has none: one seen from both sides, since some programs
    /// would hide the back, and no metal, which has no colour where it has nothing to reflect.
    pub(super) fn add(&mut self, material: Option<&Arc<Material>>) -> usize {
        let material = match material {
            Some(material) => material.clone(),
            None => self.for_those_without.get_or_insert_with(plain).clone(),
        };
        let address = Arc::as_ptr(&material) as usize;
        if let Some((_, index)) = self.added.get(&address) {
            return *index;
        }
        let mut properties = material.properties().clone();
        let of_material = material.textures();
        retain_textures(&mut properties, |_, info| {
            let slot = info["index"].as_u64().unwrap_or_default() as usize;
            info["index"] = self.textures.position(&of_material[slot]).into();
            true
        });
        for image in of_material.iter().flat_map(|texture| texture.images()) {
            self.images.position(image);
        }
        self.extensions_used.extend(material.extensions());
        let required = material.required_extensions();
        self.extensions_required.extend(required.iter().cloned());
        let index = self.materials.len();
        self.materials.push(properties);
        self.added.insert(address, (material, index));
        index
    }

    /// The images of all materials, in their order in the file.
    pub(super) fn images(&self) -> &[Arc<Image>] {
        &self.images.list
    }

    /// Writes everything into the root of a file in which the images are behind these buffer views.
    pub(super) fn write_into(mut self, root: &mut Value, views: &[usize]) {
        let mut samplers: Vec<&Value> = vec![];
        let mut known_samplers = HashMap::new();
        let mut textures = vec![];
        for texture in &self.textures.list {
            let mut properties = texture.properties().clone();
            map_sources(&mut properties, |_, source| {
                let image = &texture.images()[source as usize];
                Some(self.images.position(image))
            });
            if let Some(sampler) = texture.sampler() {
                let place = *known_samplers.entry(sampler).or_insert(samplers.len());
                if place == samplers.len() {
                    samplers.push(sampler);
                }
                properties["sampler"] = place.into();
            }
            textures.push(properties);
        }
        let images = self.images.list.iter().zip(views).map(|(image, view)| {
            let mut properties = image.properties().clone();
            properties["bufferView"] = json!(view);
            properties
        });
        let lists = [
            ("extensionsUsed", json!(self.extensions_used)),
            ("extensionsRequired", json!(self.extensions_required)),
            ("materials", json!(self.materials)),
            ("textures", json!(textures)),
            ("samplers", json!(samplers)),
            ("images", images.collect()),
        ];
        for (key, list) in lists {
            if list.as_array().is_some_and(|list| !list.is_empty()) {
                root[key] = list;
            }
        }
    }
}

/// Shared things, each once, in the order in which they came.
struct Once<T> {
    list: Vec<Arc<T>>,
    /// By address; what is listed stays at its own.
    places: HashMap<usize, usize>,
}

impl<T> Default for Once<T> {
    fn default() -> Self {
        Self {
            list: vec![],
            places: HashMap::new(),
        }
    }
}

impl<T> Once<T> {
    /// The place of something in the list, to which it is added where it is not there yet.
    fn position(&mut self, item: &Arc<T>) -> usize {
        let place = self.places.entry(Arc::as_ptr(item) as usize);
        *place.or_insert_with(|| {
            self.list.push(item.clone());
            self.list.len() - 1
        })
    }
}

fn plain() -> Arc<Material> {
    let properties =
        json!({ "pbrMetallicRoughness": { "metallicFactor": 0.0 }, "doubleSided": true });
    let material = Material::new(properties, vec![]);
    Arc::new(material.expect("as glTF has it"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texture(image: &Arc<Image>, sampler: Option<Value>) -> Arc<Texture> {
        Arc::new(Texture::new(image.clone(), sampler))
    }

    fn image(name: &str) -> Arc<Image> {
        Arc::new(Image::new(Some(name), b"\xff\xd8\xff".to_vec()).unwrap())
    }

    #[test]
    fn what_is_shared_is_written_once_and_indices_are_those_of_the_file() {
        let (bark, leaf) = (image("bark"), image("leaf"));
        let nearest = json!({ "magFilter": 9728 });
        let [a, b, c] = [
            texture(&bark, Some(nearest.clone())),
            texture(&bark, None),
            texture(&leaf, Some(nearest.clone())),
        ];
        let first = json!({
            "normalTexture": {"index": 0, "scale": 0.1},
            "extensions": {"ACME": {"aTexture": {"index": 1}}},
        });
        let first = Arc::new(Material::new(first, vec![a.clone(), b]).unwrap());
        let second = json!({"emissiveTexture": {"index": 1}, "occlusionTexture": {"index": 0}});
        let second = Arc::new(Material::new(second, vec![a, c]).unwrap());

        let mut materials = Materials::default();
        let order = [Some(&first), None, Some(&second), Some(&first), None];
        assert_eq!(order.map(|m| materials.add(m)), [0, 1, 2, 0, 1]);
        assert_eq!(materials.images(), [bark, leaf]);
        let mut root = json!({});
        materials.write_into(&mut root, &[7, 9]);
        assert_eq!(root["samplers"], json!([nearest]));
        assert_eq!(root["extensionsUsed"], json!(["ACME"]));
        assert_eq!(root.get("extensionsRequired"), None);
        let texture = |source: usize| json!({"source": source, "sampler": 0});
        assert_eq!(
            root["textures"],
            json!([texture(0), {"source": 0}, texture(1)])
        );
        let views: Vec<_> = (0..2).map(|i| &root["images"][i]["bufferView"]).collect();
        assert_eq!(views, [7, 9]);
        assert_eq!(
            root["materials"][0],
            json!({
                "normalTexture": {"index": 0, "scale": 0.1},
                "extensions": {"ACME": {"aTexture": {"index": 1}}},
            })
        );
        assert_eq!(
            root["materials"][2],
            json!({"emissiveTexture": {"index": 2}, "occlusionTexture": {"index": 0}})
        );
    }
}
