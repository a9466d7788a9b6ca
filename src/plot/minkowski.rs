//! A Minkowski diagram: time upward, one direction of space to the right, light at 45 degrees.

use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::frame::{Frame, Pixel, Spot};
use super::labels::{ANY_SIDE, Labels};
use super::{Area, BLUE, Drawing, Drawn, FAMILY, GREEN, GREY, ORANGE, VIOLET, shortened};

/// What a line or a dot stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// The observer's worldline and moments.
    Observer,
    /// Worldlines of points of objects, and the events at which light leaves them.
    Object,
    /// Light from those events to the observer.
    Light,
    /// All light through an event of the observer.
    Cone,
    /// The observer's momentary axes.
    Axes,
}

/// A line of the diagram.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    pub(crate) role: Role,
    /// Whether it is beside the plane of the diagram.
    pub(crate) off_plane: bool,
    pub(crate) course: Course,
}

/// Where a line runs.
#[derive(Clone, Debug)]
pub(crate) enum Course {
    /// From spot to spot.
    Path(Vec<Spot>),
    /// Through a spot, both ways along a vector, to the edges.
    Endless(Spot, Spot),
    /// From a spot along a vector, to the edge.
    Toward(Spot, Spot),
}

/// An event of the diagram.
#[derive(Clone, Debug)]
pub(crate) struct Dot {
    pub(crate) role: Role,
    pub(crate) off_plane: bool,
    pub(crate) spot: Spot,
    pub(crate) label: Option<String>,
}

/// The observer's own axes at one moment.
#[derive(Clone, Debug)]
pub(crate) struct Axes {
    pub(crate) origin: Spot,
    /// Directions of the two axes, of any length, and their names.
    pub(crate) time: (Spot, String),
    pub(crate) space: (Spot, String),
    /// Where points are seen, each with the event of emission that is seen there.
    pub(crate) seen: Vec<(Spot, Spot)>,
}

/// A mark of proper time across a worldline.
#[derive(Clone, Debug)]
pub(crate) struct Tick {
    pub(crate) spot: Spot,
    /// The direction of the worldline there.
    pub(crate) along: Spot,
    /// Empty where a dot has a label already.
    pub(crate) label: String,
}

/// A Minkowski diagram.
#[derive(Clone, Debug)]
pub(crate) struct Minkowski {
    pub(crate) title: String,
    /// What the axes to the right and upward are.
    pub(crate) x_text: String,
    pub(crate) y_text: String,
    /// What lies within the frame for sure.
    pub(crate) within: Vec<Spot>,
    pub(crate) lines: Vec<Line>,
    pub(crate) dots: Vec<Dot>,
    pub(crate) axes: Vec<Axes>,
    pub(crate) ticks: Vec<Tick>,
    /// Names of endless lines, each with a spot and the direction of the line.
    pub(crate) names: Vec<(Spot, Spot, String)>,
    /// What dashed lines and hollow dots mean, if there are any.
    pub(crate) off_plane_text: Option<String>,
}

/// In pixels: of letters, from line to line of the legend, of a swatch with room around it.
const LETTERS: f64 = 14.0;
const LINE: f64 = 19.0;
const SWATCH: f64 = 28.0;

/// In pixels: the room of the numbers and the name of an axis to the left and below, and around the drawing.
const ASIDE: f64 = 68.0;
const BELOW: f64 = 44.0;
const MARGIN: f64 = 10.0;

/// In pixels: of dots the radius, of ticks half the length.
const DOT: f64 = 4.5;
const TICK: f64 = 4.5;

/// Half the length of momentary axes, as a part of the shorter side.
const AXIS: f64 = 0.17;

impl Drawing for Minkowski {
    fn draw<B: DrawingBackend>(&self, area: &Area<B>, scale: f64) -> Drawn<B> {
        let px = |pixels: f64| (pixels * scale).round() as i32;
        let text = (FAMILY, 17.0 * scale);
        let title = shortened(
            self.title.clone(),
            area,
            &text.into_text_style(area),
            area.dim_in_pixel().0,
        )?;
        let area = area.margin(px(5.0), 0, 0, 0).titled(&title, text)?;
        let legend = self.legend(&area, scale)?;
        let top = px(MARGIN + LINE * legend.len() as f64);
        let (width, height) = area.dim_in_pixel();
        let inner = |side: u32, around: i32| (side as i32 - around).max(1) as u32;
        let size = (
            inner(width, px(ASIDE + MARGIN)),
            inner(height, top + px(BELOW)),
        );
        let corner = (px(ASIDE), top);
        let frame = Frame::around(self.within.iter().copied(), corner, size);
        let pen = Pen {
            area: &area,
            frame,
            room: [corner, (corner.0 + size.0 as i32, corner.1 + size.1 as i32)],
            scale,
        };
        pen.legend(&legend)?;
        pen.grid(&self.x_text, &self.y_text)?;
        for role in [Role::Cone, Role::Object, Role::Light] {
            pen.lines(self.lines.iter().filter(|line| line.role == role))?;
        }
        self.axes.iter().try_for_each(|axes| pen.axes(axes))?;
        pen.lines(self.lines.iter().filter(|line| line.role == Role::Observer))?;
        self.ticks.iter().try_for_each(|tick| pen.tick(tick))?;
        for dot in &self.dots {
            if pen.frame.contains(dot.spot) {
                pen.dot(pen.frame.pixel(dot.spot), dot.role, dot.off_plane)?;
            }
        }
        pen.words(self)
    }
}

/// A part of the legend: what stands there, what it means, and where in its line it begins, in pixels.
struct Entry {
    swatch: Swatch,
    text: String,
    left: i32,
}

#[derive(Clone, Copy)]
enum Swatch {
    Line(Role),
    Dot(Role),
    Seen,
    OffPlane,
}

impl Minkowski {
    /// What stands for what, line by line, none wider than the area.
    fn legend<B: DrawingBackend>(&self, area: &Area<B>, scale: f64) -> Drawn<B, Vec<Vec<Entry>>> {
        let px = |pixels: f64| (pixels * scale).round() as i32;
        let style = (FAMILY, LETTERS * scale).into_text_style(area);
        let room = area.dim_in_pixel().0 as i32 - px(2.0 * MARGIN);
        let has_dots = |role| self.dots.iter().any(|dot| dot.role == role);
        let has_lines = |role| self.lines.iter().any(|line| line.role == role);
        let has_seen = self.axes.iter().any(|axes| !axes.seen.is_empty());
        let entries = [
            (
                Swatch::Line(Role::Observer),
                "observer, with proper time",
                true,
            ),
            (
                Swatch::Line(Role::Axes),
                "observer's own axes",
                !self.axes.is_empty(),
            ),
            (
                Swatch::Line(Role::Cone),
                "light cone",
                has_lines(Role::Cone),
            ),
            (
                Swatch::Line(Role::Object),
                "object",
                has_lines(Role::Object),
            ),
            (
                Swatch::Dot(Role::Object),
                "emission of what is seen",
                has_dots(Role::Object),
            ),
            (
                Swatch::Line(Role::Light),
                "its light",
                has_lines(Role::Light),
            ),
            (Swatch::Seen, "where it is seen", has_seen),
        ];
        let shown = entries.into_iter().filter(|entry| entry.2);
        let shown = shown.map(|(swatch, text, _)| (swatch, text.to_owned()));
        let off = self.off_plane_text.iter();
        let off = off.map(|text| (Swatch::OffPlane, text.clone()));
        let mut lines: Vec<Vec<Entry>> = vec![vec![]];
        let mut left = 0;
        for (swatch, text) in shown.chain(off) {
            let width = px(SWATCH) + area.estimate_text_size(&text, &style)?.0 as i32;
            if left > 0 && left + width > room {
                lines.push(vec![]);
                left = 0;
            }
            let line = lines.last_mut().expect("there is a first line");
            line.push(Entry { swatch, text, left });
            left += width + px(2.0 * MARGIN);
        }
        Ok(lines)
    }
}

/// What draws into one area.
struct Pen<'a, B: DrawingBackend> {
    area: &'a Area<B>,
    frame: Frame,
    /// The pixels of the frame: its upper left and its lower right corner.
    room: [Pixel; 2],
    scale: f64,
}

impl<B: DrawingBackend> Pen<'_, B> {
    fn px(&self, pixels: f64) -> i32 {
        (pixels * self.scale).round() as i32
    }

    fn stroke(&self, color: RGBColor, width: f64) -> ShapeStyle {
        color.stroke_width(self.px(width).max(1) as u32)
    }

    fn style(&self, role: Role) -> ShapeStyle {
        match role {
            Role::Observer => self.stroke(BLUE, 2.5),
            Role::Object => self.stroke(ORANGE, 2.0),
            Role::Light => self.stroke(VIOLET, 1.5),
            Role::Cone => self.stroke(RGBColor(0xaa, 0xaa, 0xaa), 1.0),
            Role::Axes => self.stroke(GREEN, 1.5),
        }
    }

    fn path(&self, path: Vec<Pixel>, dashed: bool, style: ShapeStyle) -> Drawn<B> {
        if dashed {
            let (dash, gap) = (self.px(7.0), self.px(5.0));
            let path = DashedPathElement::new(path, dash, gap, style);
            return self.area.draw(&path);
        }
        self.area.draw(&PathElement::new(path, style))
    }

    fn text(&self, text: &str, color: RGBColor, at: Pixel, anchor: Pos) -> Drawn<B> {
        let style = (FAMILY, LETTERS * self.scale).into_text_style(self.area);
        let style = style.pos(anchor).color(&color);
        self.area.draw(&Text::new(text, at, style))
    }

    fn legend(&self, lines: &[Vec<Entry>]) -> Drawn<B> {
        let px = |pixels| self.px(pixels);
        for (number, line) in lines.iter().enumerate() {
            let y = px(LINE * (number as f64 + 0.5));
            for entry in line {
                let x = px(MARGIN) + entry.left;
                let ends = vec![(x, y), (x + px(20.0), y)];
                match entry.swatch {
                    Swatch::Line(role) => self.path(ends, false, self.style(role))?,
                    Swatch::Dot(role) => self.dot((x + px(12.0), y), role, false)?,
                    Swatch::Seen => self.square((x + px(12.0), y))?,
                    Swatch::OffPlane => {
                        let ends = vec![(x - px(6.0), y), (x + px(18.0), y)];
                        self.path(ends, true, self.stroke(ORANGE, 2.0))?;
                        self.dot((x + px(15.0), y), Role::Object, true)?;
                    }
                }
                let anchor = Pos::new(HPos::Left, VPos::Center);
                self.text(&entry.text, BLACK, (x + px(SWATCH), y), anchor)?;
            }
        }
        Ok(())
    }

    fn grid(&self, x_text: &str, y_text: &str) -> Drawn<B> {
        let (px, frame, [low, high]) = (|pixels| self.px(pixels), &self.frame, self.room);
        let thin = self.stroke(RGBColor(0xe4, 0xe4, 0xe4), 1.0);
        let under = Pos::new(HPos::Center, VPos::Top);
        let beside = Pos::new(HPos::Right, VPos::Center);
        for (x, word) in frame.marks(frame.low.0, frame.high.0, self.scale) {
            let (x, _) = frame.pixel((x, frame.low.1));
            self.path(vec![(x, low.1), (x, high.1)], false, thin)?;
            self.text(&word, GREY, (x, high.1 + px(5.0)), under)?;
        }
        for (y, word) in frame.marks(frame.low.1, frame.high.1, self.scale) {
            let (_, y) = frame.pixel((frame.low.0, y));
            self.path(vec![(low.0, y), (high.0, y)], false, thin)?;
            self.text(&word, GREY, (low.0 - px(6.0), y), beside)?;
        }
        self.area
            .draw(&Rectangle::new([low, high], self.stroke(GREY, 1.0)))?;
        let middle = ((low.0 + high.0) / 2, (low.1 + high.1) / 2);
        let below = Pos::new(HPos::Center, VPos::Bottom);
        let bottom = self.area.dim_in_pixel().1 as i32 - px(4.0);
        self.text(x_text, BLACK, (middle.0, bottom), below)?;
        let upward = (FAMILY, LETTERS * self.scale).into_font();
        let upward = upward.transform(FontTransform::Rotate270);
        let upward = TextStyle::from(upward).pos(Pos::new(HPos::Center, VPos::Top));
        self.area
            .draw(&Text::new(y_text, (px(4.0), middle.1), upward))
    }

    fn lines<'l>(&self, lines: impl Iterator<Item = &'l Line>) -> Drawn<B> {
        for line in lines {
            for part in self.shown(&line.course) {
                self.path(part, line.off_plane, self.style(line.role))?;
            }
        }
        Ok(())
    }

    /// The parts of a line within the frame.
    fn shown(&self, course: &Course) -> Vec<Vec<Pixel>> {
        let frame = &self.frame;
        let ends = match course {
            Course::Path(path) => return frame.clipped_path(path),
            Course::Endless(from, toward) => {
                frame.clip(*from, *toward, f64::NEG_INFINITY..f64::INFINITY)
            }
            Course::Toward(from, toward) => frame.clip(*from, *toward, 0.0..f64::INFINITY),
        };
        let ends = ends.map(|ends| ends.map(|spot| frame.pixel(spot)).to_vec());
        ends.into_iter().collect()
    }

    /// The part of a momentary axis within the frame.
    fn shown_axis(&self, origin: Spot, toward: Spot) -> Option<[Pixel; 2]> {
        let reach = self.reach(toward);
        let ends = self.frame.clip(origin, toward, -reach..reach)?;
        Some(ends.map(|spot| self.frame.pixel(spot)))
    }

    /// Half the length of an axis along a vector, in lengths of the vector.
    fn reach(&self, (x, y): Spot) -> f64 {
        let [low, high] = self.room;
        let side = f64::from((high.0 - low.0).min(high.1 - low.1));
        self.frame.length(AXIS * side) / x.hypot(y)
    }

    fn axes(&self, axes: &Axes) -> Drawn<B> {
        let style = self.style(Role::Axes);
        for (toward, _) in [&axes.time, &axes.space] {
            if let Some(ends) = self.shown_axis(axes.origin, *toward) {
                self.path(ends.to_vec(), false, style)?;
            }
        }
        let thin = self.stroke(GREEN, 1.0);
        for &(seen, emission) in &axes.seen {
            if !self.frame.contains(seen) {
                continue;
            }
            // Parallel to the axis of time, and along that of space.
            for from in [emission, axes.origin] {
                for part in self.frame.clipped_path(&[from, seen]) {
                    let (dash, gap) = (self.px(2.0), self.px(3.0));
                    let dotted = DashedPathElement::new(part, dash, gap, thin);
                    self.area.draw(&dotted)?;
                }
            }
            self.square(self.frame.pixel(seen))?;
        }
        Ok(())
    }

    fn square(&self, (x, y): Pixel) -> Drawn<B> {
        let half = self.px(4.0);
        let corners = [(x - half, y - half), (x + half, y + half)];
        self.area.draw(&Rectangle::new(corners, WHITE.filled()))?;
        self.area
            .draw(&Rectangle::new(corners, self.stroke(GREEN, 1.5)))
    }

    fn tick(&self, tick: &Tick) -> Drawn<B> {
        if !self.frame.contains(tick.spot) {
            return Ok(());
        }
        let (x, y) = self.frame.pixel(tick.spot);
        let (across, length) = (
            (tick.along.1, tick.along.0),
            tick.along.0.hypot(tick.along.1),
        );
        let part = |way: f64| (TICK * self.scale * way / length).round() as i32;
        let (right, down) = (part(across.0), part(across.1));
        let ends = vec![(x - right, y - down), (x + right, y + down)];
        self.path(ends, false, self.stroke(BLUE, 1.5))
    }

    fn dot(&self, at: Pixel, role: Role, hollow: bool) -> Drawn<B> {
        let color = self.style(role).color;
        if hollow {
            self.area
                .draw(&Circle::new(at, self.px(DOT), WHITE.filled()))?;
            let ring = color.stroke_width(self.px(2.0).max(1) as u32);
            return self.area.draw(&Circle::new(at, self.px(DOT), ring));
        }
        self.area
            .draw(&Circle::new(at, self.px(DOT), color.filled()))
    }

    /// All words within the frame, the most important ones first; those that have no room are left out.
    fn words(&self, diagram: &Minkowski) -> Drawn<B> {
        let frame = &self.frame;
        let mut labels = Labels::new(self.room);
        let seen = diagram.axes.iter().flat_map(|axes| &axes.seen);
        let seen = seen.map(|(seen, _)| *seen);
        let dots = diagram.dots.iter().map(|dot| dot.spot).chain(seen);
        for spot in dots.filter(|spot| frame.contains(*spot)) {
            labels.keep_free(frame.pixel(spot), self.px(DOT + 1.0));
        }
        let apart = self.px(3.0);
        for line in &diagram.lines {
            let parts = self.shown(&line.course);
            for ends in parts.iter().flat_map(|part| part.windows(2)) {
                labels.avoid([ends[0], ends[1]], apart);
            }
        }
        for axes in &diagram.axes {
            for (toward, _) in [&axes.time, &axes.space] {
                let ends = self.shown_axis(axes.origin, *toward);
                ends.into_iter().for_each(|ends| labels.avoid(ends, apart));
            }
        }
        for dot in &diagram.dots {
            if let Some(label) = dot.label.as_ref().filter(|_| frame.contains(dot.spot)) {
                let color = if dot.role == Role::Observer {
                    BLUE
                } else {
                    ORANGE
                };
                self.word(&mut labels, label, color, dot.spot)?;
            }
        }
        for axes in &diagram.axes {
            for (toward, name) in [&axes.time, &axes.space] {
                let reach = self.reach(*toward);
                let end = frame.clip(axes.origin, *toward, 0.0..reach);
                if let Some([_, end]) = end {
                    self.word(&mut labels, name, GREEN, end)?;
                }
            }
        }
        for (spot, toward, name) in &diagram.names {
            let all = f64::NEG_INFINITY..f64::INFINITY;
            let Some([a, b]) = frame.clip(*spot, *toward, all) else {
                continue;
            };
            // A little below the upper end, else above the lower one.
            let inside = frame.length(12.0 * self.scale) / toward.0.hypot(toward.1);
            let (top, bottom) = if a.1 > b.1 { (a, b) } else { (b, a) };
            let along = |end: Spot, way: f64| {
                (
                    end.0 + way * inside * toward.0,
                    end.1 + way * inside * toward.1,
                )
            };
            let upward = toward.1.signum();
            for end in [along(top, -upward), along(bottom, upward)] {
                if self.word(&mut labels, name, ORANGE, end)? {
                    break;
                }
            }
        }
        for tick in &diagram.ticks {
            if frame.contains(tick.spot) && !tick.label.is_empty() {
                self.word(&mut labels, &tick.label, BLUE, tick.spot)?;
            }
        }
        Ok(())
    }

    /// Writes a word beside a spot if there is room for it, and says whether there was.
    fn word(&self, labels: &mut Labels, word: &str, color: RGBColor, spot: Spot) -> Drawn<B, bool> {
        let style = (FAMILY, LETTERS * self.scale).into_text_style(self.area);
        let size = self.area.estimate_text_size(word, &style)?;
        let place = self.frame.pixel(spot);
        let Some(corner) = labels.find(place, self.px(DOT + 4.0), size, &ANY_SIDE) else {
            return Ok(false);
        };
        // Readable also over a line.
        let end = (corner.0 + size.0 as i32, corner.1 + size.1 as i32);
        let veil = WHITE.mix(0.75).filled();
        self.area.draw(&Rectangle::new([corner, end], veil))?;
        self.text(word, color, corner, Pos::new(HPos::Left, VPos::Top))?;
        Ok(true)
    }
}
