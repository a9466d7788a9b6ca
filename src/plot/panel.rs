//! One pair of logarithmic axes with curves and the slopes of theory.

use std::ops::Range;

use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::{Area, Drawn, FAMILY, GREY};

/// A line with a name.
pub(crate) struct Curve {
    label: &'static str,
    color: RGBColor,
    points: Vec<(f64, f64)>,
    /// Whether its points are joined.
    joined: bool,
}

impl Curve {
    pub(crate) fn new(label: &'static str, color: RGBColor, points: Vec<(f64, f64)>) -> Self {
        Self {
            label,
            color,
            points,
            joined: true,
        }
    }

    pub(crate) fn points_alone(self) -> Self {
        Self {
            joined: false,
            ..self
        }
    }
}

/// One pair of axes.
pub(crate) struct Panel {
    pub(crate) x_text: &'static str,
    pub(crate) y_text: &'static str,
    /// Whether abscissae are logarithms of accuracies, whose inverses, tolerances or errors, stand at the axis.
    pub(crate) over_errors: bool,
    pub(crate) theories: Vec<Theory>,
    /// What the lines of theory say.
    pub(crate) theory_text: &'static str,
    pub(crate) curves: Vec<Curve>,
}

/// A line of theory.
pub(crate) struct Theory {
    /// A point on it.
    pub(crate) through: (f64, f64),
    /// To which power of the abscissa's number theory says that the ordinate's grows; not zero.
    pub(crate) slope: f64,
}

/// What a line or a dot stands for, and where in its line of the legend it stands.
pub(crate) struct LegendItem<'a> {
    text: &'static str,
    /// `None` of the lines of theory.
    curve: Option<&'a Curve>,
    left: i32,
}

/// In pixels: of letters, from line to line of a legend, of a swatch with room around it, and to the axes.
const LETTERS: f64 = 14.0;
const LINE: f64 = 19.0;
const SWATCH: f64 = 24.0;
const ASIDE: f64 = 62.0;
const MARGIN: f64 = 8.0;

impl Panel {
    /// What stands for what, line by line, none wider than the area.
    pub(crate) fn legend<B: DrawingBackend>(
        &self,
        area: &Area<B>,
        scale: f64,
    ) -> Drawn<B, Vec<Vec<LegendItem<'_>>>> {
        let px = |pixels: f64| (pixels * scale).round() as i32;
        let style = (FAMILY, LETTERS * scale).into_text_style(area);
        let room = area.dim_in_pixel().0 as i32 - px(ASIDE + 2.0 * MARGIN);
        let curves = self.curves.iter().map(|curve| (curve.label, Some(curve)));
        let mut lines: Vec<Vec<LegendItem<'_>>> = vec![vec![]];
        let mut left = 0;
        for (text, curve) in curves.chain([(self.theory_text, None)]) {
            let width = px(SWATCH) + area.estimate_text_size(text, &style)?.0 as i32;
            if left > 0 && left + width > room {
                lines.push(vec![]);
                left = 0;
            }
            let line = lines.last_mut().expect("there is a first line");
            line.push(LegendItem { text, curve, left });
            left += width + px(2.0 * MARGIN);
        }
        Ok(lines)
    }

    /// The legend is in a strip of so many lines above the axes, where it covers no curve.
    pub(crate) fn draw<B: DrawingBackend>(
        &self,
        area: &Area<B>,
        legend_lines: usize,
        scale: f64,
    ) -> Drawn<B> {
        let px = |pixels: f64| (pixels * scale).round() as i32;
        let (strip, area) = area.split_vertically(px(MARGIN + LINE * legend_lines as f64));
        self.draw_legend(&strip, scale)?;
        let [x, y] = [|p: &(f64, f64)| p.0, |p: &(f64, f64)| p.1].map(|coordinate| {
            let values = self
                .curves
                .iter()
                .flat_map(|curve| curve.points.iter().map(coordinate));
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                (low.min(value), high.max(value))
            })
        });
        // Whole decades.
        let (bottom, top) = (y.0.floor(), y.1.ceil().max(y.0.floor() + 1.0));
        let (left, right) = (x.0 - 0.2, x.1 + 0.2);
        let small = (FAMILY, LETTERS * scale).into_font();
        let (width, height) = area.dim_in_pixel();
        // As many marks as have room for their numbers.
        let marks = |side: u32, beside: f64, each: f64| {
            ((f64::from(side) / scale - beside) / each).max(2.0) as usize
        };
        let mut chart = ChartBuilder::on(&area)
            .margin(px(MARGIN))
            .margin_top(0)
            .x_label_area_size(px(42.0))
            .y_label_area_size(px(ASIDE))
            .build_cartesian_2d(Decades(left, right), Decades(bottom, top))?;
        chart
            .configure_mesh()
            .bold_line_style(RGBColor(0xdd, 0xdd, 0xdd).stroke_width(px(1.0) as u32))
            .axis_style(GREY.stroke_width(px(1.0) as u32))
            .set_all_tick_mark_size(px(4.0))
            .label_style(small.clone())
            .axis_desc_style(small)
            .x_desc(self.x_text)
            .y_desc(self.y_text)
            .x_labels(marks(width, ASIDE + 2.0 * MARGIN, 42.0))
            .y_labels(marks(height, 42.0 + MARGIN, 20.0))
            .x_label_formatter(&|&x| mark(if self.over_errors { -x } else { x }))
            .y_label_formatter(&|&y| mark(y))
            .draw()?;

        let thin = GREY.stroke_width(px(1.0) as u32);
        for Theory { through, slope } in &self.theories {
            let (at, cost) = through;
            let reaches = |y: f64| at + (y - cost) / slope;
            let (first, last) = match *slope > 0.0 {
                true => (reaches(bottom), reaches(top)),
                false => (reaches(top), reaches(bottom)),
            };
            let ends = [left.max(first), right.min(last)];
            let line = ends.map(|x| (x, cost + slope * (x - at)));
            chart.draw_series(DashedLineSeries::new(line, px(5.0), px(4.0), thin))?;
        }
        for curve in &self.curves {
            let (color, joined) = (curve.color, curve.joined);
            let line = color.stroke_width(px(2.0) as u32);
            let joint = if joined { &curve.points[..] } else { &[] };
            chart.draw_series(LineSeries::new(joint.iter().copied(), line))?;
            let dots = curve.points.iter();
            chart.draw_series(dots.map(|&point| dot(point, px(3.5), color, joined)))?;
        }
        Ok(())
    }

    fn draw_legend<B: DrawingBackend>(&self, strip: &Area<B>, scale: f64) -> Drawn<B> {
        let px = |pixels: f64| (pixels * scale).round() as i32;
        let style = (FAMILY, LETTERS * scale).into_text_style(strip);
        let style = style.pos(Pos::new(HPos::Left, VPos::Center));
        for (number, line) in self.legend(strip, scale)?.iter().enumerate() {
            let y = px(LINE * (number as f64 + 0.5));
            for entry in line {
                let x = px(ASIDE + MARGIN) + entry.left;
                let text = (x + px(SWATCH), y);
                let dash = |from: f64, to: f64| {
                    let thin = GREY.stroke_width(px(1.0) as u32);
                    PathElement::new([(x + px(from), y), (x + px(to), y)], thin)
                };
                match entry.curve {
                    Some(curve) => {
                        let middle = (x + px(10.0), y);
                        strip.draw(&dot(middle, px(3.5), curve.color, curve.joined))?;
                    }
                    None => {
                        strip.draw(&dash(2.0, 9.0))?;
                        strip.draw(&dash(12.0, 19.0))?;
                    }
                }
                strip.draw(&Text::new(entry.text, text, style.clone()))?;
            }
        }
        Ok(())
    }
}

/// An axis of logarithms, from one to another, with its marks at whole ones, and between them where there are few.
struct Decades(f64, f64);

/// On an axis that is shorter there are marks at 2 and 5 too.
const FEW_DECADES: f64 = 3.0;

impl Ranged for Decades {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        let part = (value - self.0) / (self.1 - self.0);
        from + (f64::from(to - from) * part).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        let most = hint.max_num_points().max(1);
        let (low, high) = (self.0.ceil() as i32, self.1.floor() as i32);
        let stride = (high - low).max(0) as usize / most + 1;
        let whole = (low..=high).step_by(stride).map(f64::from);
        let between = |parts: &[u8]| -> Vec<f64> {
            let of_decade = |decade: i32| {
                let marks = parts.iter().map(move |&part| f64::from(part).log10());
                marks.map(move |mark| f64::from(decade) + mark)
            };
            let within = |mark: &f64| (self.0..=self.1).contains(mark);
            (low - 1..=high)
                .flat_map(of_decade)
                .filter(within)
                .collect()
        };
        let few = between(&[1, 2, 5]);
        if few.len() < 2 {
            // One number alone says nothing of the distance to it.
            return between(&[1, 2, 3, 4, 5, 6, 7, 8, 9]);
        }
        if self.1 - self.0 < FEW_DECADES && few.len() <= most {
            return few;
        }
        whole.collect()
    }

    fn range(&self) -> Range<f64> {
        self.0..self.1
    }
}

/// The number of which `logarithm` is that, in one digit.
fn mark(logarithm: f64) -> String {
    format!("{:.0e}", 10f64.powf(logarithm))
}

/// Full where points are joined, else a ring around where they may coincide with others.
fn dot<C>(at: C, radius: i32, color: RGBColor, full: bool) -> Circle<C, i32> {
    match full {
        true => Circle::new(at, radius, color.filled()),
        false => {
            let line = color.stroke_width((radius / 3).max(1) as u32);
            Circle::new(at, radius + (radius / 2).max(1), line)
        }
    }
}
