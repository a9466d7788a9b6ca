//! Drawings as SVG and as PNG.
//!
//! Drawn with `plotters`, which the community maintains: vectors by its SVG backend, pixels by its bitmap backend with
//! `ab_glyph` and a font of our own. Its usual way to text, `font-kit`, needs fontconfig of the system and draws with
//! whatever font is there; its PNG encoder brings a second version of `image`. Neither is switched on.

use std::io::Cursor;
use std::sync::OnceLock;

use image::imageops::{FilterType, resize};
use image::{ImageFormat, RgbImage};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::register_font;
use thiserror::Error;

use crate::render::FONT;

/// The font of all text in drawings. What vector pictures are drawn with is up to the viewer; this is what it is asked for.
pub(crate) const FAMILY: &str = "sans-serif";

// Told apart by everyone, also where red and green are one: M. Okabe, K. Ito, *Color Universal Design* (2008).
pub(crate) const BLUE: RGBColor = RGBColor(0x00, 0x72, 0xb2);
pub(crate) const GREEN: RGBColor = RGBColor(0x00, 0x9e, 0x73);
pub(crate) const ORANGE: RGBColor = RGBColor(0xd5, 0x5e, 0x00);
pub(crate) const VIOLET: RGBColor = RGBColor(0xcc, 0x79, 0xa7);

/// Of what is not the matter itself.
pub(crate) const GREY: RGBColor = RGBColor(0x77, 0x77, 0x77);

/// The bitmap backend knows no half-covered pixels: pictures are drawn so many times larger and made smaller, as far as
/// the larger picture has no more than [`MAX_FINE_PIXELS`], which is memory.
const FINER: u32 = 4;
const MAX_FINE_PIXELS: u64 = 1 << 26;

/// What is smaller has no room for two rows of curves beside their words, what is larger no memory.
const MIN_SIZE: (u32, u32) = (640, 480);
const LARGEST_SIDE: u32 = 8192;

/// Why there is no plot.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PlotError {
    /// Too small to read or too large to hold.
    #[error(
        "the plot is {0} x {1} pixels, expected at least {least_width} x {least_height} and at most {LARGEST_SIDE} each way",
        least_width = MIN_SIZE.0,
        least_height = MIN_SIZE.1
    )]
    Size(u32, u32),
    /// Every tolerance needs more triangles than were allowed, and no picture has an error; or no integrator has steps
    /// that are short enough.
    #[error(
        "there is nothing to plot: no tolerance was carried out, no picture is off, and no integrator came to the end"
    )]
    Nothing,
    /// The drawing library says no.
    #[error("cannot draw the plot")]
    Draw(#[source] Box<dyn std::error::Error + Send + Sync>),
    /// The encoder of PNG says no.
    #[error("cannot encode the plot")]
    Encode(#[from] image::ImageError),
}

/// Width and height of a plot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlotSize {
    width: u32,
    height: u32,
}

impl PlotSize {
    /// A size in pixels.
    ///
    /// # Errors
    ///
    /// Less than 640 by 480, or more than 8192 either way.
    pub fn new(width: u32, height: u32) -> Result<Self, PlotError> {
        let sides = [(width, MIN_SIZE.0), (height, MIN_SIZE.1)];
        let fits = |(side, least)| (least..=LARGEST_SIDE).contains(&side);
        match sides.into_iter().all(fits) {
            true => Ok(Self { width, height }),
            false => Err(PlotError::Size(width, height)),
        }
    }
}

/// Where drawings are drawn.
pub(crate) type Area<B> = DrawingArea<B, Shift>;

/// The outcome of drawing onto one kind of canvas.
pub(crate) type Drawn<B, T = ()> =
    Result<T, DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

/// Something that can be drawn onto any kind of canvas.
pub(crate) trait Drawing {
    /// Draws onto a white area; lengths in pixels are multiplied by `scale`.
    fn draw<B: DrawingBackend>(&self, area: &Area<B>, scale: f64) -> Drawn<B>;
}

/// A drawing as SVG.
pub(crate) fn svg(drawing: &impl Drawing, size: PlotSize) -> Result<String, PlotError> {
    let PlotSize { width, height } = size;
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, (width, height)).into_drawing_area();
        drawn(drawing, &area, 1.0)?;
    }
    // Names and titles may have characters that XML has not.
    svg.retain(is_in_xml);
    Ok(svg)
}

/// A drawing as PNG.
pub(crate) fn png(drawing: &impl Drawing, size: PlotSize) -> Result<Vec<u8>, PlotError> {
    let PlotSize { width, height } = size;
    let fits =
        |finer: &u32| u64::from(finer * width) * u64::from(finer * height) <= MAX_FINE_PIXELS;
    let finer = (1..=FINER).rev().find(fits).unwrap_or(1);
    let fine = (finer * width, finer * height);
    let mut pixels = RgbImage::new(fine.0, fine.1);
    {
        let area = BitMapBackend::with_buffer(&mut pixels, fine).into_drawing_area();
        drawn(drawing, &area, f64::from(finer))?;
    }
    let smooth = resize(&pixels, width, height, FilterType::Triangle);
    let mut png = Cursor::new(vec![]);
    smooth.write_to(&mut png, ImageFormat::Png)?;
    Ok(png.into_inner())
}

fn drawn<B: DrawingBackend>(
    drawing: &impl Drawing,
    area: &Area<B>,
    scale: f64,
) -> Result<(), PlotError>
where
    B::ErrorType: 'static,
{
    static REGISTERED: OnceLock<bool> = OnceLock::new();
    let registered =
        REGISTERED.get_or_init(|| register_font(FAMILY, FontStyle::Normal, FONT).is_ok());
    assert!(registered, "the font is part of the program");
    let draw = || {
        area.fill(&WHITE)?;
        drawing.draw(area, scale)?;
        area.present()
    };
    draw().map_err(|error: DrawingAreaErrorKind<B::ErrorType>| PlotError::Draw(Box::new(error)))
}

/// Whether a character may stand in a document of XML 1.0, section 2.2.
fn is_in_xml(character: char) -> bool {
    match character {
        '\t' | '\n' | '\r' => true,
        '\u{fffe}' | '\u{ffff}' => false,
        _ => character >= ' ',
    }
}

/// As much of a text as there is room for, in pixels.
pub(crate) fn shortened<B: DrawingBackend>(
    mut text: String,
    area: &Area<B>,
    style: &TextStyle<'_>,
    room: u32,
) -> Drawn<B, String> {
    while area.estimate_text_size(&text, style)?.0 > room {
        text.truncate(text.trim_end_matches("...").trim_end().len());
        if text.pop().is_none() {
            break;
        }
        text.push_str("...");
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_has_what_plots_say() {
        assert!(register_font(FAMILY, FontStyle::Normal, FONT).is_ok());
    }

    #[test]
    fn sizes_beyond_reason_are_refused() {
        assert!(PlotSize::new(640, 480).is_ok());
        for (width, height) in [(639, 480), (960, 479), (8193, 480), (0, 0)] {
            let message = PlotSize::new(width, height).unwrap_err().to_string();
            assert!(
                message.contains(&format!("{width} x {height}")),
                "{message}"
            );
            assert!(
                message.contains("at least 640 x 480 and at most 8192"),
                "{message}"
            );
        }
    }
}
