//! Materials and images of a glTF file.
//!
//! Everything that a material says travels, in the words of the file; images are kept byte for byte and
//! never decoded. One that cannot be had costs the texture, not the file.

use std::collections::HashMap;
use std::sync::Arc;

use serde_json::Value;

use super::document::Document;
use crate::material::{
    Image, Material, Texture, clamp_factors, map_sources, position, retain_textures,
};
use crate::read::ReadError;
use crate::read::error::reason;
use crate::read::fitted::Fitted;
use crate::read::note::Note;
use crate::read::notes::add_note;
use crate::read::picture;
use crate::read::uri::{Folder, read_uri};

/// Materials, textures and images of a file, each made once and shared.
pub(super) struct Materials<'a> {
    document: &'a Document<'a>,
    folder: &'a Folder<'a>,
    materials: HashMap<usize, Arc<Material>>,
    fitted: Fitted,
    /// `None` for those that cannot be had.
    textures: HashMap<usize, Option<Arc<Texture>>>,
    images: HashMap<usize, Option<Arc<Image>>>,
    /// The bytes of images, so that those of many images are there once.
    bytes: HashMap<Place, Arc<Vec<u8>>>,
}

/// Where an image is.
#[derive(PartialEq, Eq, Hash)]
enum Place {
    Uri(String),
    /// Buffer, offset and length.
    Part(usize, u64, u64),
}

impl<'a> Materials<'a> {
    /// None so far; external images are looked for in `folder`.
    pub(super) fn new(document: &'a Document<'a>, folder: &'a Folder<'a>) -> Self {
        Self {
            document,
            folder,
            materials: HashMap::new(),
            fitted: Fitted::default(),
            textures: HashMap::new(),
            images: HashMap::new(),
            bytes: HashMap::new(),
        }
    }

    /// The material with an index, for a mesh with so many sets of texture coordinates.
    pub(super) fn material(
        &mut self,
        index: usize,
        mesh: &str,
        sets: usize,
        notes: &mut Vec<Note>,
    ) -> Result<Arc<Material>, ReadError> {
        let material = match self.materials.get(&index) {
            Some(material) => material.clone(),
            None => {
                let material = Arc::new(self.read_material(index, notes)?);
                self.materials.insert(index, material.clone());
                material
            }
        };
        Ok(self.fitted.fit(&material, mesh, sets, notes))
    }

    fn read_material(
        &mut self,
        index: usize,
        notes: &mut Vec<Note>,
    ) -> Result<Material, ReadError> {
        let place = format!("materials[{index}]");
        let mut properties = self.document.material_lists.materials[index].clone();
        for factor in clamp_factors(&mut properties) {
            let place = place.clone();
            add_note(notes, Note::FactorClamped { place, factor });
        }
        let mut textures = vec![];
        retain_textures(&mut properties, |slot, info| {
            let Some(texture) = info["index"].as_u64() else {
                return false;
            };
            let Ok(texture) = self.texture(texture, notes) else {
                let image = format!("of the {slot} of {place}");
                let reason = format!("there is no textures[{texture}]");
                add_note(notes, Note::Image { image, reason });
                return false;
            };
            let slot = texture.map(|texture| position(&mut textures, &texture));
            slot.map(|slot| info["index"] = slot.into()).is_some()
        });
        let material = Material::new(properties, textures);
        let material = material.map_err(|problem| ReadError::Material { place, problem })?;
        let required = self.document.material_lists.required.iter();
        // A texture without a picture for everybody needs the extension that brings its own.
        let alone = material.textures().iter().filter(|t| t.image().is_none());
        let needed: Vec<String> = alone
            .filter_map(|texture| texture.properties().get("extensions")?.as_object())
            .flat_map(|extensions| extensions.keys().cloned())
            .collect();
        let names = required.chain(&needed).map(String::as_str);
        Ok(material.requiring(names))
    }

    /// A texture, if it can be had; an error if there is none with this index.
    fn texture(
        &mut self,
        index: u64,
        notes: &mut Vec<Note>,
    ) -> Result<Option<Arc<Texture>>, NoSuch> {
        let place = index as usize;
        if let Some(texture) = self.textures.get(&place) {
            return Ok(texture.clone());
        }
        let material_lists = &self.document.material_lists;
        let mut properties = material_lists.textures.get(place).ok_or(NoSuch)?.clone();
        let sampler = properties
            .as_object_mut()
            .and_then(|texture| texture.shift_remove("sampler"))
            .and_then(|sampler| material_lists.samplers.get(sampler.as_u64()? as usize));
        let mut images = vec![];
        let mut has_source = false;
        map_sources(&mut properties, |extension, source| {
            has_source = true;
            let image = self.image(source as usize, extension.is_none(), notes)?;
            Some(position(&mut images, &image))
        });
        if !has_source {
            let note = Note::Image {
                image: format!("of textures[{index}]"),
                reason: "it has none".to_owned(),
            };
            add_note(notes, note);
        }
        let texture = (!images.is_empty()).then(|| {
            Arc::new(Texture::from_properties(
                properties,
                images,
                sampler.cloned(),
            ))
        });
        self.textures.insert(place, texture.clone());
        Ok(texture)
    }

    /// An image, if it can be had; where no extension says otherwise, every program must be able to read it.
    fn image(
        &mut self,
        index: usize,
        for_every_program: bool,
        notes: &mut Vec<Note>,
    ) -> Option<Arc<Image>> {
        if !self.images.contains_key(&index) {
            let image = match self.read_image(index) {
                Ok((image, format)) => {
                    if let Some(format) = format {
                        let image = self.name_of_image(index);
                        add_note(notes, Note::ImageConverted { image, format });
                    }
                    Some(Arc::new(image))
                }
                Err(reason) => {
                    self.drop_image(index, reason, notes);
                    None
                }
            };
            self.images.insert(index, image);
        }
        let image = self.images.get(&index)?.clone()?;
        if for_every_program && !image.is_for_every_program() {
            self.drop_image(index, "neither PNG nor JPEG".to_owned(), notes);
            return None;
        }
        Some(image)
    }

    fn drop_image(&self, index: usize, reason: String, notes: &mut Vec<Note>) {
        let image = self.name_of_image(index);
        add_note(notes, Note::Image { image, reason });
    }

    /// What to call an image in notes.
    fn name_of_image(&self, index: usize) -> String {
        let source = self.document.material_lists.images.get(index);
        let word = |key: &str| source.and_then(|source| source.get(key)?.as_str());
        let name = word("name").or_else(|| word("uri"));
        let name = name.filter(|name| !name.starts_with("data:"));
        name.map_or(format!("images[{index}]"), |name| format!("{name:?}"))
    }

    /// An image, and the name of the format that it had, if that was another; or why it cannot be had.
    fn read_image(&mut self, index: usize) -> Result<(Image, Option<&'static str>), String> {
        let source = self.document.material_lists.images.get(index);
        let mut properties = source.ok_or("there is no such image")?.clone();
        let object = properties.as_object_mut().ok_or("it is not an object")?;
        let uri = object.shift_remove("uri");
        let view = object.shift_remove("bufferView");
        let uri = uri.as_ref().and_then(Value::as_str);
        let bytes = match (uri, view.and_then(|view| view.as_u64())) {
            (Some(uri), _) => self.shared(Place::Uri(uri.to_owned()), |this| {
                let place = format!("images[{index}].uri");
                let bytes = read_uri(uri, this.folder, u64::MAX, &place);
                this.folder.picture(bytes.map_err(|error| reason(&error))?)
            })?,
            (None, Some(view)) => {
                let view = view as usize;
                let bytes = self.document.view(view).map_err(|error| reason(&error))?;
                let part = &self.document.root.buffer_views[view];
                let offset = part.byte_offset.map_or(0, |offset| offset.0);
                let place = Place::Part(part.buffer.value(), offset, part.byte_length.0);
                self.shared(place, |this| this.folder.picture(bytes))?
            }
            (None, None) => return Err("it has neither a uri nor a bufferView".to_owned()),
        };
        picture::image(properties, bytes, uri.unwrap_or_default(), self.folder)
    }

    /// The bytes at a place, which are read once.
    fn shared(
        &mut self,
        place: Place,
        read: impl FnOnce(&Self) -> Result<Vec<u8>, String>,
    ) -> Result<Arc<Vec<u8>>, String> {
        if let Some(bytes) = self.bytes.get(&place) {
            return Ok(bytes.clone());
        }
        let bytes = Arc::new(read(self)?);
        // Data in place of a reference is longer than what it stands for.
        if !matches!(&place, Place::Uri(uri) if uri.starts_with("data:")) {
            self.bytes.insert(place, bytes.clone());
        }
        Ok(bytes)
    }
}

/// There is no texture with an index.
struct NoSuch;
