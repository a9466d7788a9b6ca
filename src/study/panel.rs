//! One pair of logarithmic axes with curves and the slope of theory.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint};
use plotters::prelude::*;

/// What vector pictures are drawn with is up to the viewer; this is what it is asked for.
pub(super) const FAMILY: &str = "sans-serif";

/// Of what is not the matter itself.
pub(super) const GREY: RGBColor = RGBColor(0x77, 0x77, 0x77);

/// A line with a name.
pub(super) struct Curve {
    label: &'static str,
    color: RGBColor,
    points: Vec<(f64, f64)>,
    /// Whether its points are joined.
    joined: bool,
}

impl Curve {
    pub(super) fn new(label: &'static str, color: RGBColor, points: Vec<(f64, f64)>) -> Self {
        Self {
            label,
            color,
            points,
            joined: true,
        }
    }

    pub(super) fn points_alone(self) -> Self {
        Self {
            joined: false,
            ..self
        }
    }
}

/// One pair of axes.
pub(super) struct Panel {
    pub(super) x_text: &'static str,
    pub(super) y_text: &'static str,
    /// Through this point goes the line of theory.
    pub(super) through: (f64, f64),
    /// To which power of accuracy theory says that cost grows.
    pub(super) slope: f64,
    /// The same in words.
    pub(super) slope_text: &'static str,
    pub(super) curves: Vec<Curve>,
    /// Where there are no curves.
    pub(super) legend: SeriesLabelPosition,
}

impl Panel {
    pub(super) fn draw<B: DrawingBackend>(
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
            .x_label_formatter(&|x| mark(-x))
            .y_label_formatter(&|&y| mark(y))
            .draw()?;

        let (at, cost) = self.through;
        let reaches = |y: f64| at + (y - cost) / self.slope;
        let ends = [left.max(reaches(bottom)), right.min(reaches(top))];
        let slope = ends.map(|x| (x, cost + self.slope * (x - at)));
        let thin = GREY.stroke_width(px(1.0) as u32);
        chart
            .draw_series(DashedLineSeries::new(slope, px(5.0), px(4.0), thin))?
            .label(self.slope_text)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + px(18.0), y)], thin));
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
            .position(self.legend.clone())
            .legend_area_size(px(22.0))
            .margin(px(6.0))
            .background_style(WHITE.mix(0.85))
            .label_font(small)
            .draw()
    }
}

/// An axis of logarithms, from one to another, with its marks at whole ones, and between them where there are few.
struct Decades(f64, f64);

/// More marks than this are too many to read.
const MOST_MARKS: i32 = 10;

/// On an axis that is shorter there are marks at 2 and 5 too.
const FEW_DECADES: f64 = 3.0;

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
        let whole = (low..=high).step_by(stride).map(f64::from);
        if self.1 - self.0 >= FEW_DECADES {
            return whole.collect();
        }
        let between = (low - 1..=high)
            .flat_map(|decade| [1.0, 2.0, 5.0].map(|part: f64| f64::from(decade) + part.log10()));
        let within = |mark: &f64| (self.0..=self.1).contains(mark);
        between.filter(within).collect()
    }

    fn range(&self) -> Range<f64> {
        self.0..self.1
    }
}

/// The number of which `logarithm` is that, in one digit.
fn mark(logarithm: f64) -> String {
    format!("{:.0e}", 10f64.powf(logarithm))
}

/// Full where points are joined, a ring where not.
fn dot<C>(at: C, radius: i32, color: RGBColor, full: bool) -> Circle<C, i32> {
    let style = match full {
        true => color.filled(),
        false => color.stroke_width((radius / 3).max(1) as u32),
    };
    Circle::new(at, radius, style)
}
