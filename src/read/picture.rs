//! Pictures of materials: those that glTF does not have are made into PNG where that loses nothing.

use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

use image::ImageFormat;
use serde_json::Value;

use super::error::reason;
use super::uri::Folder;
use crate::material::{Image, decode};

/// The signature at the end of most TGA files (*Truevision TGA File Format Specification*, version 2.0, field 30).
const TGA_FOOTER: &[u8] = b"TRUEVISION-XFILE.\0";

/// An image of which a file says so much, and the name of the format that it had, if it was another than it has now; or why
/// there is none.
pub(super) fn image(
    mut properties: Value,
    bytes: impl Into<Arc<Vec<u8>>>,
    file: &str,
    folder: &Folder,
) -> Result<(Image, Option<&'static str>), String> {
    let bytes = bytes.into();
    let said = properties.get("mimeType").and_then(Value::as_str);
    let Some((name, format)) = foreign(&bytes, file, said.unwrap_or_default()) else {
        let image = Image::from_properties(properties, bytes);
        return Ok((image.ok_or("of a type that is not known")?, None));
    };
    let png = to_png(&bytes, format, folder).map_err(|reason| format!("{name}: {reason}"))?;
    if let Value::Object(properties) = &mut properties {
        properties.shift_remove("mimeType");
    }
    let image = Image::from_properties(properties, png);
    Ok((image.ok_or("of a type that is not known")?, Some(name)))
}

/// A format that is made into PNG, by its first bytes, or, for TGA, whose files begin in many ways, by its last ones, its
/// name or what is said of it.
fn foreign(bytes: &[u8], file: &str, said: &str) -> Option<(&'static str, ImageFormat)> {
    if bytes.starts_with(b"BM") {
        return Some(("BMP", ImageFormat::Bmp));
    }
    if Image::new(None, bytes.get(..64.min(bytes.len()))?.to_vec()).is_some() {
        return None;
    }
    let extension = Path::new(file).extension().unwrap_or_default();
    let is_tga = bytes.ends_with(TGA_FOOTER)
        || extension.eq_ignore_ascii_case("tga")
        || ["image/tga", "image/x-tga", "image/x-targa", "image/targa"].contains(&said);
    is_tga.then_some(("TGA", ImageFormat::Tga))
}

fn to_png(bytes: &[u8], format: ImageFormat, folder: &Folder) -> Result<Vec<u8>, String> {
    let picture = decode(bytes, format, folder.pixels_left()).map_err(|error| reason(&error))?;
    folder.take_pixels(u64::from(picture.width()) * u64::from(picture.height()));
    let mut png = Cursor::new(vec![]);
    let written = picture.write_to(&mut png, ImageFormat::Png);
    written.map_err(|error| reason(&error))?;
    Ok(png.into_inner())
}

#[cfg(test)]
mod tests {
    use image::{DynamicImage, GrayImage, RgbImage, RgbaImage};
    use serde_json::json;

    use super::super::Access;
    use super::*;

    fn encoded(picture: &DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(vec![]);
        picture.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn tga_and_bmp_keep_every_pixel() {
        let folder = Folder::new("".as_ref());
        let color = RgbImage::from_fn(3, 2, |x, y| image::Rgb([x as u8, 100 * y as u8, 7]));
        let clear = RgbaImage::from_fn(3, 2, |x, y| image::Rgba([x as u8, 9, 7, 100 * y as u8]));
        let grey = GrayImage::from_fn(3, 2, |x, y| image::Luma([x as u8 + 10 * y as u8]));
        for picture in [
            DynamicImage::from(color),
            DynamicImage::from(clear),
            DynamicImage::from(grey),
        ] {
            for (format, file, name) in [
                (ImageFormat::Tga, "a.TGA", "TGA"),
                (ImageFormat::Bmp, "a", "BMP"),
            ] {
                let bytes = encoded(&picture, format);
                let (made, from) = image(json!({"name": "a"}), bytes, file, &folder).unwrap();
                assert_eq!((from, made.mime_type()), (Some(name), "image/png"));
                assert_eq!(made.name(), Some("a"));
                let read = image::load_from_memory(made.bytes()).unwrap();
                assert_eq!(read.to_rgba8(), picture.to_rgba8(), "{name}");
            }
        }
    }

    #[test]
    fn a_tga_is_known_by_what_is_said_of_it_but_not_against_its_first_bytes() {
        let folder = Folder::new("".as_ref());
        let picture = DynamicImage::from(GrayImage::new(1, 1));
        let tga = encoded(&picture, ImageFormat::Tga);
        let format = |bytes: &[u8], file: &str, said: &str| {
            let properties = match said {
                "" => json!({}),
                said => json!({ "mimeType": said }),
            };
            image(properties, bytes.to_vec(), file, &folder).map(|(_, from)| from)
        };
        assert_eq!(format(&tga, "", "image/x-tga"), Ok(Some("TGA")));
        let png = encoded(&picture, ImageFormat::Png);
        assert_eq!(format(&png, "a.tga", ""), Ok(None));
        assert!(format(b"", "a.png", "").is_err());
        let broken = format(b"BM", "a.bmp", "").unwrap_err();
        assert!(broken.starts_with("BMP: cannot be decoded: "), "{broken}");
    }

    #[test]
    fn the_pixels_of_all_together_are_limited() {
        let access = Access {
            max_texture_pixels: 10,
            ..Access::default()
        };
        let folder = Folder::within("".as_ref(), access.reach("".as_ref()));
        let bmp = encoded(&DynamicImage::from(GrayImage::new(3, 2)), ImageFormat::Bmp);
        let convert = || image(json!({}), bmp.clone(), "", &folder).map(|_| ());
        assert_eq!(convert(), Ok(()));
        let error = convert().unwrap_err();
        assert_eq!(
            error,
            "BMP: 3 x 2 pixels, expected at most 4 more; --max-texture-pixels allows more"
        );
    }
}
