//! Maps of MTL that share a picture in glTF: the opacity lies in the alpha of the base colour, the roughness in the green
//! and the metalness in the blue channel of one picture (glTF 2.0, section 5.22).
//!
//! A new PNG of 8 bits a channel is made. Where the pictures have different sizes, both are scaled to the larger width and
//! height. A picture of colours stands for its grey (the weights of ITU-R BT.709), as the MTL format says of scalar maps;
//! for opacity its alpha is taken if it is not opaque everywhere.

use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

use image::imageops::{FilterType, resize};
use image::{DynamicImage, GrayImage, ImageFormat, Luma, Rgb, RgbImage, Rgba, RgbaImage};

use super::mtl_map::{Map, Pictures};
use super::packing::Packing;
use crate::material::{Image, Texture};
use crate::read::error::reason;
use crate::read::note::Note;
use crate::read::notes::add_note;
use crate::read::uri::Folder;

/// A texture of two maps, and which of them are in it.
pub(super) type Packed = (Arc<Texture>, [bool; 2]);

impl Pictures<'_> {
    /// The texture of two maps that are laid in the same way, and which of them are in it; none where the pictures that
    /// need one are not to be had; or why they cannot be put together.
    pub(super) fn packed(
        &mut self,
        packing: Packing,
        maps: [Option<&Map>; 2],
        folder: &Path,
        notes: &mut Vec<Note>,
    ) -> Result<Option<Packed>, String> {
        let [first, second] = maps.map(|map| {
            let found = map.and_then(|map| self.image(map, folder, notes));
            found.unzip()
        });
        let (paths, images) = ([first.0, second.0], [first.1, second.1]);
        let are_in = images.each_ref().map(Option::is_some);
        let is_wanted = match packing {
            Packing::Opacity => are_in[1],
            Packing::Gloss => are_in.contains(&true),
        };
        if !is_wanted {
            return Ok(None);
        }
        let map = maps.into_iter().flatten().next();
        let key = (packing, paths, map.is_some_and(|map| map.clamped));
        if let Some(known) = self.packed.get(&key) {
            return known.clone().map(|texture| Some((texture, are_in)));
        }
        let made = pack(packing, &images, self.files).map(|(image, is_scaled)| {
            if is_scaled {
                let image = format!("{:?}", image.name().unwrap_or_default());
                add_note(notes, Note::ImageScaled { image });
            }
            Arc::new(Texture::new(image.into(), map.and_then(Map::sampler)))
        });
        self.packed.insert(key, made.clone());
        made.map(|texture| Some((texture, are_in)))
    }
}

/// A picture of two, and whether one of them was scaled.
fn pack(
    packing: Packing,
    images: &[Option<Arc<Image>>; 2],
    folder: &Folder,
) -> Result<(Image, bool), String> {
    let mut pictures = [None, None];
    let mut names: Vec<&str> = vec![];
    for (picture, image) in pictures.iter_mut().zip(images) {
        let Some(image) = image else { continue };
        let decoded = image.decode(folder.pixels_left()).map_err(|e| reason(&e))?;
        folder.take_pixels(u64::from(decoded.width()) * u64::from(decoded.height()));
        *picture = Some(decoded);
        let name = image.name().unwrap_or_default();
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let all = || pictures.iter().flatten();
    let width = all().map(DynamicImage::width).max().unwrap_or_default();
    let height = all().map(DynamicImage::height).max().unwrap_or_default();
    let pixels = u64::from(width) * u64::from(height);
    let left = folder.pixels_left();
    if pixels > left {
        return Err(format!(
            "{width} x {height} pixels, expected at most {left} more; --max-texture-pixels allows more"
        ));
    }
    folder.take_pixels(pixels);
    let is_scaled = all().any(|one| (one.width(), one.height()) != (width, height));

    let [first, second] = pictures;
    let scaled_grey = |grey: GrayImage| match grey.dimensions() == (width, height) {
        true => grey,
        false => resize(&grey, width, height, FilterType::Triangle),
    };
    let grey = |picture: DynamicImage| scaled_grey(picture.into_luma8());
    let packed: DynamicImage = match packing {
        Packing::Opacity => {
            let color = first.map(|picture| match is_scaled {
                true => resize(&picture.into_rgb8(), width, height, FilterType::Triangle),
                false => picture.into_rgb8(),
            });
            let opacity = second.map(|picture| scaled_grey(opacity(picture)));
            RgbaImage::from_fn(width, height, |x, y| {
                let [r, g, b] = color.as_ref().map_or([255; 3], |c| c.get_pixel(x, y).0);
                let [a] = opacity.as_ref().map_or([255], |o| o.get_pixel(x, y).0);
                Rgba([r, g, b, a])
            })
            .into()
        }
        Packing::Gloss => {
            let [roughness, metalness] = [first, second].map(|picture| picture.map(grey));
            let value = |picture: &Option<GrayImage>, x, y| {
                let picture = picture.as_ref();
                picture.map_or(255, |picture| picture.get_pixel(x, y).0[0])
            };
            // Nothing is read from red here; white there means no occlusion to programs that look all the same.
            RgbImage::from_fn(width, height, |x, y| {
                Rgb([255, value(&roughness, x, y), value(&metalness, x, y)])
            })
            .into()
        }
    };
    let mut png = Cursor::new(vec![]);
    let written = packed.write_to(&mut png, ImageFormat::Png);
    written.map_err(|error| reason(&error))?;
    let image = Image::new(Some(&names.join(" + ")), png.into_inner());
    Ok((image.ok_or("of a type that is not known")?, is_scaled))
}

fn opacity(picture: DynamicImage) -> GrayImage {
    let rgba = picture.color().has_alpha().then(|| picture.to_rgba8());
    match rgba.filter(|rgba| rgba.pixels().any(|pixel| pixel.0[3] < 255)) {
        Some(rgba) => GrayImage::from_fn(rgba.width(), rgba.height(), |x, y| {
            Luma([rgba.get_pixel(x, y).0[3]])
        }),
        None => picture.into_luma8(),
    }
}
