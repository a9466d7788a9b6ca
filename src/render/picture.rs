//! A finished picture, and how it becomes a file.

use std::io::Write;

use glam::Vec3;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use thiserror::Error;

use super::{CameraError, PictureSize};
use crate::effects::byte_of_linear;
use crate::shape::Color;

/// Reasons why bytes are not a picture.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PngError {
    /// They are not a PNG.
    #[error("is no PNG that can be read")]
    Image(#[from] image::ImageError),
    /// The picture is too large.
    #[error(transparent)]
    Size(#[from] CameraError),
}

/// Red, green and blue in sRGB, one byte each, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    size: PictureSize,
    bytes: Vec<u8>,
}

impl Picture {
    /// A picture of rows that fit its size.
    pub(super) fn new(size: PictureSize, bytes: Vec<u8>) -> Self {
        debug_assert_eq!(
            bytes.len(),
            3 * size.width() as usize * size.height() as usize
        );
        Self { size, bytes }
    }

    /// A picture of one colour.
    pub fn filled(size: PictureSize, color: Color) -> Self {
        let pixels = size.width() as usize * size.height() as usize;
        Self::new(size, color.0.repeat(pixels))
    }

    /// Lays another picture on this one, its upper left corner at `x`, `y`; what is beyond an edge is cut off.
    pub fn paste(&mut self, other: &Picture, x: u32, y: u32) {
        let (width, height) = (self.size.width(), self.size.height());
        let columns = other.size.width().min(width.saturating_sub(x)) as usize;
        if columns == 0 {
            return;
        }
        let rows = other.bytes.chunks_exact(3 * other.size.width() as usize);
        for (row, y) in rows.zip(y..height) {
            let start = 3 * (y as usize * width as usize + x as usize);
            self.bytes[start..start + 3 * columns].copy_from_slice(&row[..3 * columns]);
        }
    }

    /// Width and height.
    pub fn size(&self) -> PictureSize {
        self.size
    }

    /// All bytes: three a pixel, row by row from the top.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Red, green and blue of one pixel.
    ///
    /// # Panics
    ///
    /// Outside the picture.
    pub fn pixel(&self, x: u32, y: u32) -> [u8; 3] {
        assert!(x < self.size.width() && y < self.size.height());
        let start = 3 * (y as usize * self.size.width() as usize + x as usize);
        [0, 1, 2].map(|channel| self.bytes[start + channel])
    }

    /// All pixels, row by row from the top.
    pub(super) fn pixels_mut(&mut self) -> impl Iterator<Item = &mut [u8; 3]> {
        self.bytes.as_chunks_mut().0.iter_mut()
    }

    /// Reads a picture from the bytes of a PNG; transparency is left out.
    ///
    /// # Errors
    ///
    /// The bytes are not a PNG, or it has more pixels in a row or a column than pictures may have.
    pub fn from_png(png: &[u8]) -> Result<Self, PngError> {
        let image = image::load_from_memory_with_format(png, image::ImageFormat::Png)?;
        let image = image.into_rgb8();
        let size = PictureSize::new(image.width(), image.height())?;
        Ok(Self::new(size, image.into_raw()))
    }

    /// Writes the picture as PNG.
    ///
    /// # Errors
    ///
    /// `writer` fails.
    pub fn write_png(&self, mut writer: impl Write) -> std::io::Result<()> {
        let (width, height) = (self.size.width(), self.size.height());
        // Encoded first: the encoder's error hides what the writer's was, a broken pipe or a full disk.
        let mut file = Vec::new();
        PngEncoder::new(&mut file)
            .write_image(&self.bytes, width, height, ExtendedColorType::Rgb8)
            .expect("three bytes a pixel, written to memory");
        writer.write_all(&file)
    }
}

/// A linear colour as bytes in sRGB; what is brighter than white is white.
pub(super) fn encoded(linear: Vec3) -> [u8; 3] {
    linear.to_array().map(byte_of_linear)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_laid_on_each_other() {
        let of = |width, height, level| {
            Picture::filled(PictureSize::new(width, height).unwrap(), Color([level; 3]))
        };
        let mut sheet = of(4, 3, 0);
        sheet.paste(&of(2, 2, 1), 1, 0);
        sheet.paste(&of(5, 5, 2), 3, 2);
        sheet.paste(&of(1, 1, 3), 9, 9);
        sheet.paste(&of(1, 1, 4), 9, 2);
        sheet.paste(&of(1, 1, 5), u32::MAX, 2);
        let levels: Vec<_> = sheet.bytes().chunks(3).map(|pixel| pixel[0]).collect();
        assert_eq!(levels, [0, 1, 1, 0, 0, 1, 1, 0, 0, 0, 0, 2]);
    }

    #[test]
    fn a_png_holds_the_same_pixels() {
        let size = PictureSize::new(3, 2).unwrap();
        let picture = Picture::new(size, (0..18).collect());
        let mut file = Vec::new();
        picture.write_png(&mut file).unwrap();
        let read = image::load_from_memory(&file).unwrap().to_rgb8();
        assert_eq!(read.dimensions(), (3, 2));
        assert_eq!(read.get_pixel(1, 1).0, picture.pixel(1, 1));
        assert_eq!(picture.pixel(1, 1), [12, 13, 14]);
    }
}
