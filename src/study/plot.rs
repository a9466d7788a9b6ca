//! Cost against accuracy, drawn: of meshes triangles and time over the tolerance, of pictures rays and time over the
//! error, all logarithmic.
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

use crate::plot::{Curve, FAMILY, GREY, Panel};
use crate::render::FONT;
use crate::scene::Unit;
use crate::study::{CostStudy, Made, MeshCost, RayCost};

/// The bitmap backend knows no half-covered pixels: pictures are drawn so many times larger and made smaller.
const FINER: u32 = 4;

/// What is smaller has no room for two rows of curves beside their words, what is larger no memory.
const MIN_SIZE: (u32, u32) = (640, 480);
const LARGEST_SIDE: u32 = 8192;

// Told apart by everyone, also where red and green are one: M. Okabe, K. Ito, *Color Universal Design* (2008).
const BLUE: RGBColor = RGBColor(0x00, 0x72, 0xb2);
const GREEN: RGBColor = RGBColor(0x00, 0x9e, 0x73);
const ORANGE: RGBColor = RGBColor(0xd5, 0x5e, 0x00);
const VIOLET: RGBColor = RGBColor(0xcc, 0x79, 0xa7);

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
    /// Every tolerance needs more triangles than were allowed, and no picture has an error.
    #[error("there is nothing to plot: no tolerance was carried out, and no picture is off")]
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

impl CostStudy {
    /// A plot of cost against accuracy as SVG: above of meshes, below of pictures by rays.
    ///
    /// # Errors
    ///
    /// There is no point to draw.
    pub fn plot_svg(&self, size: PlotSize) -> Result<String, PlotError> {
        let PlotSize { width, height } = size;
        let mut svg = String::new();
        {
            let area = SVGBackend::with_string(&mut svg, (width, height)).into_drawing_area();
            self.draw(&area, 1.0)?;
        }
        Ok(svg)
    }

    /// The same as PNG.
    ///
    /// # Errors
    ///
    /// As [`CostStudy::plot_svg`].
    pub fn plot_png(&self, size: PlotSize) -> Result<Vec<u8>, PlotError> {
        let PlotSize { width, height } = size;
        let fine = (FINER * width, FINER * height);
        let mut pixels = RgbImage::new(fine.0, fine.1);
        {
            let area = BitMapBackend::with_buffer(&mut pixels, fine).into_drawing_area();
            self.draw(&area, f64::from(FINER))?;
        }
        let smooth = resize(&pixels, width, height, FilterType::Triangle);
        let mut png = Cursor::new(vec![]);
        smooth.write_to(&mut png, ImageFormat::Png)?;
        Ok(png.into_inner())
    }

    fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
        scale: f64,
    ) -> Result<(), PlotError>
    where
        B::ErrorType: 'static,
    {
        static REGISTERED: OnceLock<bool> = OnceLock::new();
        let registered =
            REGISTERED.get_or_init(|| register_font(FAMILY, FontStyle::Normal, FONT).is_ok());
        assert!(registered, "the font is part of the program");
        let rows = [self.mesh_panels(), self.ray_panels()];
        let rows: Vec<[Panel; 2]> = rows.into_iter().flatten().collect();
        if rows.is_empty() {
            return Err(PlotError::Nothing);
        }
        let draw = || {
            area.fill(&WHITE)?;
            let text = (FAMILY, 17.0 * scale);
            let title = match &self.scene.title {
                Some(title) => format!("What accuracy costs: {title}"),
                None => "What accuracy costs".to_owned(),
            };
            let above = (5.0 * scale) as i32;
            let title = shortened(
                title,
                area,
                &text.into_text_style(area),
                area.dim_in_pixel().0,
            )?;
            let area = area.margin(above, 0, 0, 0).titled(&title, text)?;
            let parts = area.split_evenly((rows.len(), 2));
            for (row, parts) in rows.iter().zip(parts.chunks(2)) {
                // The axes of a row begin at one height.
                let mut lines = 0;
                for (panel, part) in row.iter().zip(parts) {
                    lines = lines.max(panel.legend(part, scale)?.len());
                }
                for (panel, part) in row.iter().zip(parts) {
                    panel.draw(part, lines, scale)?;
                }
            }
            area.present()
        };
        draw().map_err(|error: DrawingAreaErrorKind<B::ErrorType>| PlotError::Draw(Box::new(error)))
    }

    /// Triangles and times; `None` if there are none.
    fn mesh_panels(&self) -> Option<[Panel; 2]> {
        let made = |value: fn(&Made) -> f64| self.points(|cost| cost.made.as_ref().map(value));
        let ours = made(|made| made.triangles as f64);
        let theory = made(|made| made.minimum_triangles);
        let uniform = made(|made| made.uniform.triangles);
        let predicted = self.points(|cost| Some(cost.predicted_triangles));
        let times = made(|made| made.seconds.photosurface);
        let (&tightest, &slowest) = (theory.last()?, times.last()?);
        let tolerance = match self.unit? {
            Unit::Relative => "tolerance, of the diagonal",
            Unit::Absolute => "tolerance, a length",
            Unit::Degrees => "tolerance, degrees",
        };
        let panel = |y_text, through, curves| Panel {
            x_text: tolerance,
            y_text,
            through,
            slope: 1.0,
            slope_text: "inverse to the tolerance",
            curves,
        };
        Some([
            panel(
                "triangles",
                tightest,
                vec![
                    Curve::new("uniform 1:4", ORANGE, uniform),
                    Curve::new("made", BLUE, ours),
                    Curve::new("least by theory", GREEN, theory),
                    Curve::new("predicted", GREY, predicted).points_alone(),
                ],
            ),
            panel(
                "seconds for meshes",
                slowest,
                vec![
                    Curve::new("refine, map, prove", BLUE, times),
                    Curve::new("write", VIOLET, made(|made| made.seconds.write)),
                    Curve::new("predict", GREY, made(|made| made.seconds.predict)),
                ],
            ),
        ])
    }

    /// Rays and times; `None` if there are no errors that they are for.
    fn ray_panels(&self) -> Option<[Panel; 2]> {
        let points = |error: fn(&RayCost) -> f64, value: fn(&RayCost) -> f64| {
            logarithms(self.rays.iter().map(|cost| (error(cost), value(cost))))
        };
        let rays = points(|cost| cost.error, |cost| cost.rays as f64);
        let largest = points(|cost| cost.largest_error, |cost| cost.rays as f64);
        let times = points(|cost| cost.error, |cost| cost.seconds);
        let (&finest, &slowest) = (rays.last()?, times.last()?);
        let panel = |y_text, through, curves| Panel {
            x_text: "picture error, of white in linear light",
            y_text,
            through,
            slope: 4.0 / 3.0,
            slope_text: "edges by theory: error to the \u{2212}4/3",
            curves,
        };
        Some([
            panel(
                "rays",
                finest,
                vec![
                    Curve::new("root mean square", BLUE, rays),
                    Curve::new("largest of a pixel", ORANGE, largest),
                ],
            ),
            panel(
                "seconds for pictures",
                slowest,
                vec![Curve::new("root mean square", BLUE, times)],
            ),
        ])
    }

    /// Tolerances and what they cost.
    fn points(&self, value: impl Fn(&MeshCost) -> Option<f64>) -> Vec<(f64, f64)> {
        let point = |cost: &MeshCost| Some((cost.tolerance, value(cost)?));
        logarithms(self.meshes.iter().filter_map(point))
    }
}

/// As much of a text as there is room for.
fn shortened<B: DrawingBackend>(
    mut text: String,
    area: &DrawingArea<B, Shift>,
    style: &TextStyle<'_>,
    room: u32,
) -> Result<String, DrawingAreaErrorKind<B::ErrorType>> {
    while area.estimate_text_size(&text, style)?.0 > room {
        text.truncate(text.trim_end_matches("...").trim_end().len());
        if text.pop().is_none() {
            break;
        }
        text.push_str("...");
    }
    Ok(text)
}

/// Tolerances or errors as numbers that grow with accuracy, and what they cost, both as logarithms.
fn logarithms(points: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    points
        .map(|(error, cost)| (-error.log10(), cost.log10()))
        .filter(|&(x, y)| x.is_finite() && y.is_finite())
        .collect()
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
