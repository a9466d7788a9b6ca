//! Textures as pixels, each picture decoded once whatever is painted with it.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use glam::{DVec2, Vec4};
use image::RgbaImage;
use thiserror::Error;

use crate::effects::linear_of_byte;
use crate::material::{Image, PictureError, Texture, Wrap};

/// Pixels of all textures together, unless said otherwise: 1 GiB of memory.
const MAX_PIXELS: u64 = 1 << 28;

/// The textures of pictures, decoded: each once, however many parts, steps and [`Scenery`](super::Scenery)s show it.
///
/// A clone is another handle to the same textures.
#[derive(Clone, Debug)]
pub struct Textures(Arc<Mutex<Decoded>>);

#[derive(Debug)]
struct Decoded {
    /// How many pixels may still be decoded.
    pixels_left: u64,
    /// By the address of the file's bytes, with the image that keeps them there; none for those that are no pictures.
    known: HashMap<usize, (Arc<Image>, Option<Arc<RgbaImage>>)>,
    missing: Vec<Arc<MissingTexture>>,
}

/// A texture that pictures go without.
#[derive(Debug, Error)]
#[error("\"{object}\" is drawn without its texture{}", named(.image))]
#[non_exhaustive]
pub struct MissingTexture {
    /// The first object, or other thing, that would show it.
    pub object: String,
    /// As the source names the image, if it does.
    pub image: Option<String>,
    /// Why.
    pub source: PictureError,
}

fn named(image: &Option<String>) -> String {
    match image {
        Some(name) => format!(" {name:?}"),
        None => String::new(),
    }
}

impl Textures {
    /// None so far, and at most so many pixels of all together; a pixel takes four bytes.
    pub fn new(max_pixels: u64) -> Self {
        let decoded = Decoded {
            pixels_left: max_pixels,
            known: HashMap::new(),
            missing: vec![],
        };
        Self(Arc::new(Mutex::new(decoded)))
    }

    /// The textures that pictures go without, so far.
    pub fn missing(&self) -> Vec<Arc<MissingTexture>> {
        self.with(|decoded| decoded.missing.clone())
    }

    /// The pixels of a texture of `object`, if it can be decoded.
    pub(super) fn pixels(
        &self,
        texture: &Texture,
        bytes: BytesMean,
        object: &str,
    ) -> Option<Pixels> {
        // Without one that every program can read there are others, which are refused by their kind.
        let image = texture.image().or(texture.images().first())?;
        let picture = self.with(|decoded| decoded.picture(image, object))?;
        let linear = std::array::from_fn(|byte| match bytes {
            BytesMean::Color => linear_of_byte(byte as u8),
            BytesMean::Number => byte as f32 / 255.0,
        });
        Some(Pixels {
            image: picture,
            nearest: texture.is_magnified_by_nearest(),
            wrap: texture.wrap(),
            linear,
        })
    }

    fn with<T>(&self, act: impl FnOnce(&mut Decoded) -> T) -> T {
        // Nothing is left half done by a thread that panics: what is decoded is added last.
        act(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Default for Textures {
    /// None so far, and at most 2^28 pixels.
    fn default() -> Self {
        Self::new(MAX_PIXELS)
    }
}

impl Decoded {
    fn picture(&mut self, image: &Arc<Image>, object: &str) -> Option<Arc<RgbaImage>> {
        let address = image.bytes().as_ptr() as usize;
        if let Some((_, known)) = self.known.get(&address) {
            return known.clone();
        }
        let picture = match image.decode(self.pixels_left) {
            Ok(picture) => {
                let pixels = u64::from(picture.width()) * u64::from(picture.height());
                self.pixels_left = self.pixels_left.saturating_sub(pixels);
                Some(Arc::new(picture.into_rgba8()))
            }
            Err(source) => {
                self.missing.push(Arc::new(MissingTexture {
                    object: object.to_owned(),
                    image: image.name().map(str::to_owned),
                    source,
                }));
                None
            }
        };
        self.known.insert(address, (image.clone(), picture.clone()));
        picture
    }
}

/// What the bytes of a texture's channels stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BytesMean {
    /// A colour, encoded in sRGB.
    Color,
    /// Numbers from 0 to 1, in even steps.
    Number,
}

/// A decoded texture.
pub(super) struct Pixels {
    image: Arc<RgbaImage>,
    /// Whether it is magnified without mixing pixels.
    nearest: bool,
    /// Beyond left and right, and beyond top and bottom.
    wrap: [Wrap; 2],
    /// What each of the 256 bytes stands for.
    linear: [f32; 256],
}

impl Pixels {
    /// Linear colour and opacity. Colours are decoded before they are mixed, as glTF demands.
    pub(super) fn at(&self, texture: DVec2) -> Vec4 {
        let (width, height) = self.image.dimensions();
        let place = texture * DVec2::new(width.into(), height.into());
        if self.nearest {
            return self.pixel(place.floor());
        }
        let corner = (place - 0.5).floor();
        let part = (place - 0.5 - corner).as_vec2();
        let row = |y: f64| {
            let left = self.pixel(corner + DVec2::new(0.0, y));
            left.lerp(self.pixel(corner + DVec2::new(1.0, y)), part.x)
        };
        row(0.0).lerp(row(1.0), part.y)
    }

    fn pixel(&self, place: DVec2) -> Vec4 {
        let (width, height) = self.image.dimensions();
        let x = wrapped(place.x, width, self.wrap[0]);
        let y = wrapped(place.y, height, self.wrap[1]);
        let [red, green, blue, alpha] = self.image.get_pixel(x, y).0;
        let linear = |byte: u8| self.linear[usize::from(byte)];
        Vec4::new(
            linear(red),
            linear(green),
            linear(blue),
            f32::from(alpha) / 255.0,
        )
    }
}

/// The pixel that stands for the one numbered `index`, a whole number, of `count`.
fn wrapped(index: f64, count: u32, wrap: Wrap) -> u32 {
    let length = f64::from(count);
    let inside = match wrap {
        Wrap::ClampToEdge => index,
        Wrap::Repeat => index.rem_euclid(length),
        Wrap::MirroredRepeat => {
            let there_and_back = index.rem_euclid(2.0 * length);
            there_and_back.min(2.0 * length - 1.0 - there_and_back)
        }
    };
    inside.clamp(0.0, length - 1.0) as u32
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    fn png(side: u32) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        let picture = RgbaImage::new(side, side);
        picture
            .write_to(&mut bytes, image::ImageFormat::Png)
            .unwrap();
        bytes.into_inner()
    }

    fn texture(name: &str, bytes: Vec<u8>) -> Texture {
        let image = Image::new(Some(name), bytes).expect("a known type");
        Texture::new(Arc::new(image), None)
    }

    #[test]
    fn textures_continue_as_their_sampler_says() {
        let indices = |wrap| [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0].map(|i| wrapped(i, 2, wrap));
        assert_eq!(indices(Wrap::Repeat), [1, 0, 1, 0, 1, 0, 1]);
        assert_eq!(indices(Wrap::ClampToEdge), [0, 0, 0, 0, 1, 1, 1]);
        assert_eq!(indices(Wrap::MirroredRepeat), [1, 1, 0, 0, 1, 1, 0]);
    }

    #[test]
    fn a_picture_is_decoded_once_and_shared() {
        let textures = Textures::new(16);
        let wood = texture("wood", png(4));
        let first = textures.pixels(&wood, BytesMean::Color, "a").unwrap();
        // The limit would be exceeded if it were decoded again.
        let again = textures
            .clone()
            .pixels(&wood, BytesMean::Color, "b")
            .unwrap();
        assert!(Arc::ptr_eq(&first.image, &again.image));
        assert!(textures.missing().is_empty());
    }

    #[test]
    fn what_cannot_be_drawn_is_missing_once_and_named() {
        let textures = Textures::new(16);
        let broken = texture("wood", b"\x89PNG\r\n\x1a\n".to_vec());
        let large = texture("sky", png(5));
        let basis = texture("bark", b"\xabKTX 20\xbb\r\n\x1a\n".to_vec());
        for _ in 0..2 {
            for texture in [&broken, &large, &basis] {
                assert!(
                    textures
                        .pixels(texture, BytesMean::Color, "chair")
                        .is_none()
                );
            }
        }
        let missing: Vec<String> = textures
            .missing()
            .iter()
            .map(|missing| format!("{missing}: {}", missing.source))
            .collect();
        assert_eq!(
            missing,
            [
                "\"chair\" is drawn without its texture \"wood\": cannot be decoded",
                "\"chair\" is drawn without its texture \"sky\": 5 x 5 pixels, expected at most 16 more; \
                 --max-texture-pixels allows more",
                "\"chair\" is drawn without its texture \"bark\": of the type image/ktx2, expected image/png or image/jpeg",
            ]
        );
        // What is too large takes nothing from what is left.
        assert!(
            textures
                .pixels(&texture("small", png(4)), BytesMean::Color, "x")
                .is_some()
        );
    }
}
