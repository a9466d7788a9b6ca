//! Cost against accuracy, drawn: triangles and time over the tolerance, both logarithmic.
//!
//! Drawn with `plotters`, which the community maintains: vectors by its SVG backend, pixels by its bitmap backend with
//! `ab_glyph` and a font of our own. Its usual way to text, `font-kit`, needs fontconfig of the system and draws with
//! whatever font is there; its PNG encoder brings a second version of `image`. Neither is switched on.

use std::io::Cursor;
use std::ops::Range;
use std::sync::OnceLock;

use image::imageops::{FilterType, resize};
use image::{ImageFormat, RgbImage};
use plotters::coord::Shift;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint};
use plotters::prelude::*;
use plotters::style::register_font;
use thiserror::Error;

use super::{CostStudy, Made, MeshCost};

/// Of DejaVu Sans what English and numbers need; `src/study/font/README.md` says where it is from.
const FONT: &[u8] = include_bytes!("font/DejaVuSans-subset.ttf");

/// What vector pictures are drawn with is up to the viewer; this is what it is asked for.
const FAMILY: &str = "sans-serif";

/// The bitmap backend knows no half-covered pixels: pictures are drawn so many times larger and made smaller.
const FINER: u32 = 4;

/// What is smaller holds no curve beside its numbers, what is larger no memory.
const LEAST_SIZE: (u32, u32) = (320, 200);
const LARGEST_SIDE: u32 = 8192;

const BLUE: RGBColor = RGBColor(0x1f, 0x5f, 0xbf);
const GREEN: RGBColor = RGBColor(0x2a, 0x8f, 0x4c);
const ORANGE: RGBColor = RGBColor(0xd9, 0x70, 0x14);
const VIOLET: RGBColor = RGBColor(0x84, 0x4f, 0xb5);
const GREY: RGBColor = RGBColor(0x77, 0x77, 0x77);

/// Why there is no plot.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PlotError {
    /// Too small to read or too large to hold.
    #[error(
        "the plot is {0} x {1} pixels, expected at least {least_width} x {least_height} and at most {LARGEST_SIDE} each way",
        least_width = LEAST_SIZE.0,
        least_height = LEAST_SIZE.1
    )]
    Size(u32, u32),
    /// Every tolerance needs more triangles than were allowed.
    #[error("there is nothing to plot: no tolerance was carried out")]
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
    /// Less than 320 by 200, or more than 8192 either way.
    pub fn new(width: u32, height: u32) -> Result<Self, PlotError> {
        let sides = [(width, LEAST_SIZE.0), (height, LEAST_SIZE.1)];
        let fits = |(side, least)| (least..=LARGEST_SIDE).contains(&side);
        match sides.into_iter().all(fits) {
            true => Ok(Self { width, height }),
            false => Err(PlotError::Size(width, height)),
        }
    }
}

impl CostStudy {
    /// A plot of cost against accuracy as SVG.
    ///
    /// # Errors
    ///
    /// No tolerance was carried out.
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
        let [triangles, times] = self.panels().ok_or(PlotError::Nothing)?;
        let draw = || {
            area.fill(&WHITE)?;
            let text = (FAMILY, 17.0 * scale);
            let title = match &self.scene.title {
                Some(title) => format!("What accuracy costs: {title}"),
                None => "What accuracy costs".to_owned(),
            };
            let above = (5.0 * scale) as i32;
            let area = area.margin(above, 0, 0, 0).titled(&title, text)?;
            let (left, right) = area.split_horizontally(area.dim_in_pixel().0 / 2);
            triangles.draw(&left, scale)?;
            times.draw(&right, scale)?;
            area.present()
        };
        draw().map_err(|error: DrawingAreaErrorKind<B::ErrorType>| PlotError::Draw(Box::new(error)))
    }

    /// Triangles and times; `None` if there are none.
    fn panels(&self) -> Option<[Panel; 2]> {
        let made = |value: fn(&Made) -> f64| self.points(|cost| cost.made.as_ref().map(value));
        let ours = made(|made| made.triangles as f64);
        let theory = made(|made| made.minimum_triangles);
        let uniform = made(|made| made.uniform.triangles);
        let foretold = self.points(|cost| Some(cost.predicted_triangles));
        let times = made(|made| made.seconds.photosurface);
        let (&tightest, &slowest) = (theory.last()?, times.last()?);
        let tolerance = match self.unit {
            "relative" => "tolerance, of the diagonal",
            "absolute" => "tolerance, a length",
            _ => "tolerance, degrees",
        };
        Some([
            Panel {
                x_text: tolerance,
                y_text: "triangles",
                slope: tightest,
                curves: vec![
                    Curve::new("uniform 1:4", ORANGE, uniform),
                    Curve::new("foretold", GREY, foretold).points_alone(),
                    Curve::new("made", BLUE, ours),
                    Curve::new("least by theory", GREEN, theory),
                ],
            },
            Panel {
                x_text: tolerance,
                y_text: "seconds",
                slope: slowest,
                curves: vec![
                    Curve::new("refine, map, prove", BLUE, times),
                    Curve::new("write", VIOLET, made(|made| made.seconds.write)),
                    Curve::new("foretell", GREY, made(|made| made.seconds.predict)),
                ],
            },
        ])
    }

    /// Tolerances as numbers that grow with accuracy, and what they cost, both as logarithms.
    fn points(&self, value: impl Fn(&MeshCost) -> Option<f64>) -> Vec<(f64, f64)> {
        let point = |cost: &MeshCost| Some((-cost.tolerance.log10(), value(cost)?.log10()));
        let finite = |&(x, y): &(f64, f64)| x.is_finite() && y.is_finite();
        self.meshes
            .iter()
            .filter_map(point)
            .filter(finite)
            .collect()
    }
}

/// A line with a name.
struct Curve {
    label: &'static str,
    color: RGBColor,
    points: Vec<(f64, f64)>,
    /// Whether its points are joined.
    joined: bool,
}

impl Curve {
    fn new(label: &'static str, color: RGBColor, points: Vec<(f64, f64)>) -> Self {
        Self {
            label,
            color,
            points,
            joined: true,
        }
    }

    fn points_alone(self) -> Self {
        Self {
            joined: false,
            ..self
        }
    }
}

/// One pair of axes.
struct Panel {
    x_text: &'static str,
    y_text: &'static str,
    /// Through this point goes a line that is inverse to the tolerance.
    slope: (f64, f64),
    curves: Vec<Curve>,
}

impl Panel {
    fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
        scale: f64,
    ) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
        let px = |pixels: f64| (pixels * scale).round() as i32;
        let [x, y] = [|p: &(f64, f64)| p.0, |p: &(f64, f64)| p.1].map(|coordinate| {
            let values = self
                .curves
                .iter()
                .flat_map(|curve| curve.points.iter().map(coordinate));
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                (low.min(value), high.max(value))
            })
        });
        // Whole decades upwards with room for the legend.
        let (bottom, top) = (
            y.0.floor(),
            (y.1 + 0.15 * (y.1 - y.0)).ceil().max(y.0.floor() + 1.0),
        );
        let (left, right) = (x.0 - 0.2, x.1 + 0.2);
        let small = (FAMILY, 14.0 * scale).into_font();
        let mut chart = ChartBuilder::on(area)
            .margin(px(8.0))
            .x_label_area_size(px(42.0))
            .y_label_area_size(px(62.0))
            .build_cartesian_2d(Decades(left, right), Decades(bottom, top))?;
        chart
            .configure_mesh()
            .bold_line_style(RGBColor(0xdd, 0xdd, 0xdd).stroke_width(px(1.0) as u32))
            .axis_style(GREY.stroke_width(px(1.0) as u32))
            .set_all_tick_mark_size(px(4.0))
            .label_style(small.clone())
            .axis_desc_style(small.clone())
            .x_desc(self.x_text)
            .y_desc(self.y_text)
            .x_label_formatter(&|x| format!("1e{}", -x.round()).replace("e-0", "e0"))
            .y_label_formatter(&|y| format!("1e{}", y.round()))
            .draw()?;

        // What theory says of every doubling of accuracy: twice as much.
        let (at, cost) = self.slope;
        let from = left.max(at - (cost - bottom));
        let slope = [from, right].map(|x| (x, (cost + (x - at)).min(top)));
        let thin = GREY.stroke_width(px(1.0) as u32);
        chart
            .draw_series(DashedLineSeries::new(slope, px(5.0), px(4.0), thin))?
            .label("inverse to the tolerance")
            .legend(move |(x, y)| PathElement::new([(x, y), (x + px(9.0), y)], thin));
        for curve in &self.curves {
            let (color, joined) = (curve.color, curve.joined);
            let line = color.stroke_width(px(2.0) as u32);
            let joint = if joined { &curve.points[..] } else { &[] };
            chart.draw_series(LineSeries::new(joint.iter().copied(), line))?;
            let dots = curve.points.iter();
            chart
                .draw_series(dots.map(|&point| dot(point, px(3.5), color, joined)))?
                .label(curve.label)
                .legend(move |(x, y)| dot((x + px(9.0), y), px(3.5), color, joined));
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperLeft)
            .legend_area_size(px(22.0))
            .margin(px(6.0))
            .background_style(WHITE.mix(0.85))
            .label_font(small)
            .draw()
    }
}

/// An axis of logarithms, from one to another, with its marks at whole ones.
struct Decades(f64, f64);

/// More marks than this are too many to read.
const MOST_MARKS: i32 = 10;

impl Ranged for Decades {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        let part = (value - self.0) / (self.1 - self.0);
        from + (f64::from(to - from) * part).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _hint: Hint) -> Vec<f64> {
        let (low, high) = (self.0.ceil() as i32, self.1.floor() as i32);
        let stride = ((high - low) / MOST_MARKS + 1) as usize;
        (low..=high).step_by(stride).map(f64::from).collect()
    }

    fn range(&self) -> Range<f64> {
        self.0..self.1
    }
}

/// Full where points are joined, a ring where not.
fn dot<C>(at: C, radius: i32, color: RGBColor, full: bool) -> Circle<C, i32> {
    let style = match full {
        true => color.filled(),
        false => color.stroke_width((radius / 3).max(1) as u32),
    };
    Circle::new(at, radius, style)
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
        assert!(PlotSize::new(960, 420).is_ok());
        for (width, height) in [(319, 420), (960, 199), (8193, 420), (0, 0)] {
            let message = PlotSize::new(width, height).unwrap_err().to_string();
            assert!(
                message.contains(&format!("{width} x {height}")),
                "{message}"
            );
            assert!(
                message.contains("at least 320 x 200 and at most 8192"),
                "{message}"
            );
        }
    }
}
