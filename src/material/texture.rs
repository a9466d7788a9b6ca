//! Textures and images of a material, as their source has them.

use std::collections::BTreeSet;
use std::sync::Arc;

use image::{DynamicImage, ImageFormat};
use serde_json::{Map, Value, json};

use super::pixels::{PictureError, decode};
use super::properties::add_extension_names;

/// An image, or several of which a program takes the one that it knows, and how it is laid on a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// A `texture` of glTF without its sampler, whose sources index into `images`.
    properties: Value,
    images: Vec<Arc<Image>>,
    /// A `sampler` of glTF.
    sampler: Option<Value>,
}

impl Texture {
    /// A texture of one image; `sampler`, as glTF has it, says how it is read.
    pub fn new(image: Arc<Image>, sampler: Option<Value>) -> Self {
        Self {
            properties: json!({ "source": 0 }),
            images: vec![image],
            sampler,
        }
    }

    /// A texture as a file has it; sources, those in extensions too, index into `images`.
    pub(crate) fn from_properties(
        properties: Value,
        images: Vec<Arc<Image>>,
        sampler: Option<Value>,
    ) -> Self {
        Self {
            properties,
            images,
            sampler,
        }
    }

    /// Everything it says, as a `texture` of glTF without its `sampler`; each `source`, also in extensions,
    /// is that in [`images`](Self::images).
    pub fn properties(&self) -> &Value {
        &self.properties
    }

    /// Its images.
    pub fn images(&self) -> &[Arc<Image>] {
        &self.images
    }

    /// The one that every program can read, PNG or JPEG, if it has one.
    pub fn image(&self) -> Option<&Arc<Image>> {
        let source = self.properties.get("source")?.as_u64()?;
        self.images.get(source as usize)
    }

    /// How it is read, as a `sampler` of glTF.
    pub fn sampler(&self) -> Option<&Value> {
        self.sampler.as_ref()
    }

    /// How it continues beyond its left and right edge, and beyond its upper and lower one.
    pub fn wrap(&self) -> [Wrap; 2] {
        ["wrapS", "wrapT"].map(|name| {
            let number = self.sampler.as_ref().and_then(|s| s.get(name)?.as_u64());
            match number {
                Some(33071) => Wrap::ClampToEdge,
                Some(33648) => Wrap::MirroredRepeat,
                _ => Wrap::Repeat,
            }
        })
    }

    /// Whether it shows its pixels where it is seen from near by, instead of mixing them.
    pub(crate) fn is_magnified_by_nearest(&self) -> bool {
        let filter = self.sampler.as_ref().and_then(|s| s.get("magFilter"));
        filter.and_then(Value::as_u64) == Some(9728)
    }

    /// Adds the names of the extensions that it uses, its sampler and images.
    pub(super) fn add_extensions(&self, names: &mut BTreeSet<String>) {
        add_extension_names(&self.properties, names);
        if let Some(sampler) = &self.sampler {
            add_extension_names(sampler, names);
        }
        for image in &self.images {
            add_extension_names(&image.properties, names);
        }
    }
}

/// Calls `visit` with each `source` of a texture's properties, its own and those of its extensions, and with
/// the name of the extension; takes out those for which it returns none.
pub(crate) fn map_sources(
    properties: &mut Value,
    mut visit: impl FnMut(Option<&str>, u64) -> Option<usize>,
) {
    let mut map = |extension: Option<&str>, object: &mut Value| -> bool {
        let Some(source) = object.get("source").and_then(Value::as_u64) else {
            return true;
        };
        match visit(extension, source) {
            Some(place) => object["source"] = place.into(),
            None => return false,
        }
        true
    };
    if !map(None, properties)
        && let Value::Object(properties) = properties
    {
        properties.shift_remove("source");
    }
    let Some(Value::Object(extensions)) = properties.get_mut("extensions") else {
        return;
    };
    extensions.retain(|name, extension| map(Some(name), extension));
    if extensions.is_empty()
        && let Value::Object(properties) = properties
    {
        properties.shift_remove("extensions");
    }
}

/// An image as its file has it, byte for byte.
#[derive(Clone, PartialEq)]
pub struct Image {
    /// An `image` of glTF that does not say where its bytes are.
    properties: Value,
    /// Shared among the images that a file makes of the same bytes.
    bytes: Arc<Vec<u8>>,
}

impl Image {
    /// An image from its file, whose first bytes tell its type; `None` for a type that is not known.
    pub fn new(name: Option<&str>, bytes: Vec<u8>) -> Option<Self> {
        let named = name.map(|name| ("name".to_owned(), Value::from(name)));
        Self::from_properties(Value::Object(Map::from_iter(named)), bytes)
    }

    /// An image of a file that says so much of it; `None` if neither it nor the first bytes tell the type.
    pub(crate) fn from_properties(
        mut properties: Value,
        bytes: impl Into<Arc<Vec<u8>>>,
    ) -> Option<Self> {
        let bytes = bytes.into();
        if let Some(mime_type) = mime_type(&bytes) {
            properties["mimeType"] = mime_type.into();
        }
        properties.get("mimeType").and_then(Value::as_str)?;
        Some(Self { properties, bytes })
    }

    /// Everything that is said of it, as an `image` of glTF without `uri` and `bufferView`.
    pub fn properties(&self) -> &Value {
        &self.properties
    }

    /// As the source names it.
    pub fn name(&self) -> Option<&str> {
        self.properties.get("name")?.as_str()
    }

    /// Such as `image/png`.
    pub fn mime_type(&self) -> &str {
        let mime_type = self.properties.get("mimeType").and_then(Value::as_str);
        mime_type.expect("every constructor sees to it")
    }

    /// Whether glTF allows it without an extension.
    pub(crate) fn is_for_every_program(&self) -> bool {
        ["image/png", "image/jpeg"].contains(&self.mime_type())
    }

    /// Its pixels, at most `left` of them.
    pub(crate) fn decode(&self, left: u64) -> Result<DynamicImage, PictureError> {
        let format = match self.mime_type() {
            "image/png" => ImageFormat::Png,
            "image/jpeg" => ImageFormat::Jpeg,
            other => {
                let mime_type = other.to_owned();
                return Err(PictureError::Format { mime_type });
            }
        };
        decode(&self.bytes, format, left)
    }

    /// The file.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

impl std::fmt::Debug for Image {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Image")
            .field("properties", &self.properties)
            .field("bytes", &self.bytes.len())
            .finish()
    }
}

/// How a texture continues beyond its edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Wrap {
    ClampToEdge,
    MirroredRepeat,
    Repeat,
}

/// The type of a picture, by how its file begins.
fn mime_type(bytes: &[u8]) -> Option<&'static str> {
    let at = |start: usize, text: &[u8]| bytes.get(start..).is_some_and(|b| b.starts_with(text));
    match () {
        () if at(0, b"\x89PNG\r\n\x1a\n") => Some("image/png"),
        () if at(0, b"\xff\xd8\xff") => Some("image/jpeg"),
        () if at(0, b"RIFF") && at(8, b"WEBP") => Some("image/webp"),
        () if at(0, b"\xabKTX 20\xbb\r\n\x1a\n") => Some("image/ktx2"),
        () if at(0, b"DDS ") => Some("image/vnd-ms.dds"),
        () if at(4, b"ftypavif") => Some("image/avif"),
        () => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_bytes_of_an_image_tell_its_type() {
        let mime =
            |bytes: &[u8]| Image::new(None, bytes.to_vec()).map(|i| i.mime_type().to_owned());
        assert_eq!(mime(b"RIFF\0\0\0\0WEBPVP8 ").as_deref(), Some("image/webp"));
        assert_eq!(
            mime(b"\xabKTX 20\xbb\r\n\x1a\n").as_deref(),
            Some("image/ktx2")
        );
        assert_eq!(mime(b"\xff\xd8\xff\xe0").as_deref(), Some("image/jpeg"));
        assert_eq!(mime(b"BM"), None);
        // What a file says of bytes that nobody knows is believed, against bytes that are known it is not.
        let said =
            |bytes: &[u8]| Image::from_properties(json!({"mimeType": "image/x"}), bytes.to_vec());
        assert_eq!(said(b"??").unwrap().mime_type(), "image/x");
        assert_eq!(said(b"DDS ").unwrap().mime_type(), "image/vnd-ms.dds");
    }

    #[test]
    fn sources_are_found_in_extensions() {
        let mut properties = json!({"source": 4, "name": "t", "extensions": {
            "A": {"source": 5}, "B": {"source": 6}, "C": {"other": 6}}});
        let mut seen = vec![];
        map_sources(&mut properties, |extension, source| {
            seen.push((extension.map(str::to_owned), source));
            (source != 5).then_some(source as usize + 10)
        });
        assert_eq!(seen[0], (None, 4));
        assert_eq!(seen[1], (Some("A".to_owned()), 5));
        let expected = json!({"source": 14, "name": "t", "extensions": {"B": {"source": 16}, "C": {"other": 6}}});
        assert_eq!(properties, expected);
        map_sources(&mut properties, |_, _| None);
        assert_eq!(
            properties,
            json!({"name": "t", "extensions": {"C": {"other": 6}}})
        );
    }
}
