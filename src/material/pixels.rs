//! From the file of a picture to its pixels: its size is asked for before there is memory for it.

use std::io::Cursor;

use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, ImageResult, Limits};
use thiserror::Error;

/// Memory for what a picture's file has beside pixels.
const BESIDE: u64 = 1 << 26;
/// Bytes that a pixel has at most in memory: four channels of 16 bits.
const BYTES_OF_PIXEL: u64 = 8;

/// Why there are no pixels.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PictureError {
    /// Another format.
    #[error("of the type {mime_type}, expected image/png or image/jpeg")]
    Format {
        /// Which one.
        mime_type: String,
    },
    /// More pixels than are allowed.
    #[error(
        "{width} x {height} pixels, expected at most {left} more; --max-texture-pixels allows more"
    )]
    TooLarge {
        /// Pixels from left to right.
        width: u32,
        /// Pixels from top to bottom.
        height: u32,
        /// How many pixels there may be.
        left: u64,
    },
    /// A file that is not as its format has it.
    #[error("cannot be decoded")]
    Broken(#[from] image::ImageError),
}

/// The pixels of a picture, at most `left` of them.
pub(crate) fn decode(
    bytes: &[u8],
    format: ImageFormat,
    left: u64,
) -> Result<DynamicImage, PictureError> {
    let (width, height) = decoder(bytes, format, BESIDE)?.dimensions();
    let pixels = u64::from(width) * u64::from(height);
    if pixels > left {
        return Err(PictureError::TooLarge {
            width,
            height,
            left,
        });
    }
    let decoder = decoder(bytes, format, pixels * BYTES_OF_PIXEL + BESIDE)?;
    Ok(DynamicImage::from_decoder(decoder)?)
}

fn decoder(bytes: &[u8], format: ImageFormat, memory: u64) -> ImageResult<impl ImageDecoder> {
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(memory);
    reader.limits(limits);
    reader.into_decoder()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png(width: u32, height: u32) -> Vec<u8> {
        let mut bytes = Cursor::new(vec![]);
        let picture = image::GrayImage::new(width, height);
        picture.write_to(&mut bytes, ImageFormat::Png).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn the_header_decides() {
        let file = png(20, 10);
        assert_eq!(
            decode(&file, ImageFormat::Png, 200)
                .unwrap()
                .to_luma8()
                .len(),
            200
        );
        let error = decode(&file, ImageFormat::Png, 199).unwrap_err();
        assert_eq!(
            error.to_string(),
            "20 x 10 pixels, expected at most 199 more; --max-texture-pixels allows more"
        );
        // A header that says much, without anything behind it: 4 million times 4 million pixels.
        let mut huge = png(1, 1);
        huge[16..24].copy_from_slice(&[0, 64, 0, 0, 0, 64, 0, 0]);
        let checksum = crc32(&huge[12..29]).to_be_bytes();
        huge[29..33].copy_from_slice(&checksum);
        let error = decode(&huge, ImageFormat::Png, 1 << 28).unwrap_err();
        let expected = "4194304 x 4194304 pixels, expected at most 268435456 more";
        assert!(error.to_string().starts_with(expected), "{error}");
        let cut = decode(&file[..40], ImageFormat::Png, 200);
        assert!(matches!(cut, Err(PictureError::Broken(_))));
    }

    /// PNG, third edition, annex D, bit by bit.
    fn crc32(bytes: &[u8]) -> u32 {
        let step = |crc: u32| (crc >> 1) ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 };
        !bytes.iter().fold(u32::MAX, |crc, &byte| {
            (0..8).fold(crc ^ u32::from(byte), |crc, _| step(crc))
        })
    }
}
