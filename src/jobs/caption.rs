//! Captions: what a picture shows, in words and numbers.

use std::ops::Range;

use glam::DVec2;

use super::contrast::{halo, ink, legible};
use super::ghosts::ghost_color;
use crate::pipeline::PlacedScene;
use crate::render::{Picture, lettering_width};
use crate::shape::Color;
use crate::spacetime::{Velocity, ViewModel};

/// Height of capitals as a fraction of the picture's height, and the least in pixels.
const LETTERS: f64 = 1.0 / 24.0;
const LEAST_PX: f64 = 9.0;

/// Letters above a sheet are so much larger than those on its views.
const STRIP: f64 = 1.6;

/// A text that does not fit becomes so much smaller, and is then cut off.
const SHRUNK: f64 = 0.7;

/// From one line to the next, in heights of capitals.
const LINE: f64 = 1.9;

/// Of a title so many characters are looked at.
const MAX_TITLE: usize = 300;

/// Between numbers on one line.
const GAP: &str = "   ";

/// Speeds are the same if their rapidities differ by no more than this part.
const SAME: f64 = 1e-9;

/// `1 - beta` below which beta is written as a difference from 1.
const NEAR_LIGHT: f64 = 1e-4;

/// The parts of a caption; the default is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Caption {
    /// The title of the scene.
    pub title: bool,
    /// The speed of the objects relative to the observer, in units of the speed of light.
    pub speed: bool,
    /// The Lorentz factor of that speed.
    pub gamma: bool,
    /// The observer's proper time.
    pub time: bool,
    /// The models under which objects are shown, and the names of their ghosts' models.
    pub model: bool,
}

impl Caption {
    /// Title, speed, Lorentz factor and proper time: the caption of sheets and films.
    pub const STANDARD: Self = Self {
        title: true,
        speed: true,
        gamma: true,
        time: true,
        model: false,
    };

    /// Whether there is no caption.
    pub fn is_none(self) -> bool {
        self == Self::default()
    }

    /// Whether there are parts that a whole sheet may have in common.
    pub(super) fn is_of_a_sheet(self) -> bool {
        self.title || self.speed || self.gamma || self.model
    }

    /// The title of a scene in one line, or the name of its only object, if that is asked for.
    pub(super) fn title(self, placed: &PlacedScene) -> Option<String> {
        if !self.title {
            return None;
        }
        let scene = placed.scene();
        // A mesh by itself is called by its name.
        let title = match (scene.title(), scene.objects()) {
            (Some(title), _) => title,
            (None, [alone]) => &alone.name,
            (None, _) => return None,
        };
        let shown = title.chars().take(MAX_TITLE);
        let text: String = shown
            .map(|c| if c.is_control() { ' ' } else { c })
            .collect();
        let words: Vec<&str> = text.split_whitespace().collect();
        let mut line = words.join(" ");
        if title.chars().nth(MAX_TITLE).is_some() {
            line.push('…');
        }
        (!line.is_empty()).then_some(line)
    }

    /// What is the same at all places of a scene's pictures at these steps: speed, Lorentz factor and model.
    pub(super) fn numbers(self, placed: &PlacedScene, steps: Range<usize>) -> Vec<String> {
        let mut parts = vec![];
        if let Some((slowest, fastest)) = speeds(placed, steps) {
            let is_one = fastest.rapidity() - slowest.rapidity() <= SAME * fastest.rapidity();
            let text = |symbol: &str, text: fn(&Velocity) -> String| match is_one {
                true => format!("{symbol} = {}", text(&fastest)),
                false => format!("{symbol} = {} … {}", text(&slowest), text(&fastest)),
            };
            if self.speed {
                parts.push(text("β", beta));
            }
            if self.gamma {
                parts.push(text("γ", gamma));
            }
        }
        if self.model {
            let objects = placed.scene().objects().iter();
            let mut models: Vec<String> = objects.map(|o| o.view_model().to_string()).collect();
            models.dedup();
            match models.as_slice() {
                [] => {}
                [model] => parts.push(format!("model: {model}")),
                _ => parts.push("several models".to_owned()),
            }
        }
        parts
    }

    /// The proper time of these steps.
    pub(super) fn time(self, placed: &PlacedScene, steps: Range<usize>) -> Option<String> {
        let all = placed.scene().steps();
        let (first, last) = (all.get(steps.start)?, all.get(steps.end.checked_sub(1)?)?);
        let (first, last) = (time(*first, all), time(*last, all));
        self.time.then(|| match first == last {
            true => format!("τ = {first}"),
            false => format!("τ = {first} … {last}"),
        })
    }
}

/// The slowest and the fastest of a scene's objects relative to the observer at some steps.
fn speeds(placed: &PlacedScene, steps: Range<usize>) -> Option<(Velocity, Velocity)> {
    let objects = placed.scene().objects().iter();
    let views = objects.flat_map(|object| {
        let steps = steps.clone();
        steps.filter_map(move |step| placed.view(object, step))
    });
    let mut found: Option<(Velocity, Velocity)> = None;
    for velocity in views.map(|view| view.relative_velocity()) {
        let (slowest, fastest) = found.get_or_insert((velocity, velocity));
        if velocity.rapidity() < slowest.rapidity() {
            *slowest = velocity;
        }
        if velocity.rapidity() > fastest.rapidity() {
            *fastest = velocity;
        }
    }
    found
}

fn beta(velocity: &Velocity) -> String {
    let (beta, rest) = (velocity.beta(), velocity.one_minus_beta());
    match (beta, rest) {
        (0.0, _) => "0".to_owned(),
        (_, ..NEAR_LIGHT) => format!("1 − {}", scientific(rest)),
        (..1e-3, _) => scientific(beta),
        _ => without_zeros(&format!("{beta:.4}")),
    }
}

fn gamma(velocity: &Velocity) -> String {
    match velocity.gamma() {
        gamma @ ..10.0 => format!("{gamma:.2}"),
        gamma @ ..100.0 => format!("{gamma:.1}"),
        gamma @ ..1e6 => format!("{gamma:.0}"),
        gamma => scientific(gamma),
    }
}

/// A proper time, one of `all`: with as many places as tell them apart, the same for all.
fn time(time: f64, all: &[f64]) -> String {
    let (low, high) = all
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &time| {
            (low.min(time), high.max(time))
        });
    let is_short = |time: &f64| (1000.0 * time).fract() == 0.0 && time.abs() < 1e6;
    let text = match high - low {
        _ if all.iter().all(is_short) => time.to_string(),
        span @ 1e-3..1e6 if low.abs().max(high.abs()) < 1e6 => {
            let places = (3.0 - span.log10().ceil()).clamp(0.0, 6.0) as usize;
            format!("{time:.places$}")
        }
        _ => short(time),
    };
    // A rounded time may have a sign and be zero.
    let is_zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    let text = text.trim_start_matches(if is_zero { "-" } else { "" });
    text.replacen('-', "−", usize::from(text.starts_with('-')))
}

/// A number in at most six digits.
fn short(number: f64) -> String {
    match number.to_string() {
        text if text.len() <= 8 => text,
        _ if (1e-3..1e6).contains(&number.abs()) => {
            let places = (5.0 - number.abs().log10().floor()).clamp(0.0, 8.0) as usize;
            let text = format!("{number:.places$}");
            match text.contains('.') {
                true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
                false => text,
            }
        }
        _ => scientific_to(number, 5),
    }
}

fn scientific(number: f64) -> String {
    scientific_to(number, 1)
}

fn scientific_to(number: f64, places: usize) -> String {
    let text = format!("{number:.places$e}");
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    match exponent {
        "0" => without_zeros(digits),
        _ => format!("{}e{exponent}", without_zeros(digits)),
    }
}

fn without_zeros(text: &str) -> String {
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text.to_owned(),
    }
}

/// Words of one colour on a caption.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Words {
    pub(super) text: String,
    /// The colour, if they name something of that colour.
    color: Option<Color>,
}

impl Words {
    pub(super) fn new(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            color: None,
        }
    }

    /// The names of ghosts' models, each in the colour of its ghosts.
    pub(super) fn of_ghosts(models: &[ViewModel]) -> Vec<Self> {
        let name = |&model: &ViewModel| Self {
            text: match model {
                ViewModel::Rest => "at rest".to_owned(),
                model => model.to_string(),
            },
            color: Some(ghost_color(model)),
        };
        models.iter().map(name).collect()
    }

    fn color(&self, background: Color) -> Color {
        let legible = |color| legible(color, background);
        self.color.map_or(ink(background), legible)
    }
}

/// Words at their places on a picture.
pub(super) struct Block {
    placed: Vec<(Words, DVec2, f64)>,
    /// Of the corner that it fills, in pixels.
    pub(super) size: DVec2,
}

impl Block {
    /// A line for each list of words, broken where it does not fit, in the upper left corner of a picture of this size.
    pub(super) fn in_corner(lines: &[Vec<Words>], width: f64, height: f64) -> Self {
        let letter = (LETTERS * height).max(LEAST_PX);
        let margin = 0.8 * letter;
        let room = width - 2.0 * margin;
        let mut block = Self {
            placed: vec![],
            size: DVec2::ZERO,
        };
        let mut baseline = margin + letter;
        for words in lines {
            let mut x = margin;
            for words in words {
                let (text, fitting) = fitted(&words.text, letter, room);
                let wide = lettering_width(&text, fitting);
                if x > margin && x + wide > margin + room {
                    (x, baseline) = (margin, baseline + LINE * letter);
                }
                let words = Words {
                    text,
                    ..words.clone()
                };
                block.placed.push((words, DVec2::new(x, baseline), fitting));
                let end = DVec2::new(x + wide, baseline + 0.5 * letter);
                block.size = block.size.max(end);
                x += wide + lettering_width(GAP, letter);
            }
            baseline += if words.is_empty() { 0.0 } else { LINE * letter };
        }
        block
    }

    pub(super) fn draw(&self, picture: &mut Picture, background: Color) {
        for (words, start, letter) in &self.placed {
            let color = words.color(background);
            picture.write_haloed(&words.text, *start, *letter, color, halo(background));
        }
    }
}

/// The text in letters of `letter` pixels, or smaller ones, or cut off so that it fits.
fn fitted(text: &str, letter: f64, room: f64) -> (String, f64) {
    let width = lettering_width(text, letter);
    if width <= room {
        return (text.to_owned(), letter);
    }
    let shrunk = letter * room / width;
    if shrunk >= SHRUNK * letter {
        return (text.to_owned(), shrunk);
    }
    let letter = SHRUNK * letter;
    let mut shown = String::new();
    let mut used = lettering_width("…", letter);
    for character in text.chars() {
        used += lettering_width(character.encode_utf8(&mut [0; 4]), letter);
        if used > room {
            break;
        }
        shown.push(character);
    }
    (format!("{}…", shown.trim_end()), letter)
}

/// Height of the strip above a sheet of views of this height, in pixels.
pub(super) fn strip_height(height: u32) -> u32 {
    (2.2 * (STRIP * LETTERS * f64::from(height)).max(LEAST_PX)).round() as u32
}

/// Draws words in one line in a strip along the upper edge; the first, a title, is cut off if there is not room for all.
pub(super) fn draw_strip(picture: &mut Picture, words: &[Words], height: u32, background: Color) {
    let letter = f64::from(height) / 2.2;
    let gap = lettering_width(GAP, letter);
    let room = f64::from(picture.size().width()) - 1.2 * letter;
    let rest = words.iter().skip(1);
    let taken: f64 = rest
        .map(|words| lettering_width(&words.text, letter) + gap)
        .sum();
    let mut start = DVec2::new(0.6 * letter, 1.6 * letter);
    let end = start.x + room;
    for (number, words) in words.iter().enumerate() {
        let left = match number {
            0 => (room - taken).max(0.3 * room),
            _ => end - start.x,
        };
        if left < 2.0 * letter {
            return;
        }
        let (text, fitting) = fitted(&words.text, letter, left);
        picture.write(&text, start, fitting, words.color(background));
        start.x += lettering_width(&text, fitting) + gap;
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::render::PictureSize;

    #[test]
    fn speeds_are_written_as_people_read_them() {
        let of_gap = |gap: f64| Velocity::from_one_minus_beta(gap, DVec3::X).unwrap();
        let of_beta = |beta: f64| Velocity::from_beta(beta, DVec3::X).unwrap();
        let text = |velocity: Velocity| (beta(&velocity), gamma(&velocity));
        let pair = |a: &str, b: &str| (a.to_owned(), b.to_owned());
        assert_eq!(text(of_beta(0.95)), pair("0.95", "3.20"));
        assert_eq!(text(of_beta(0.0)), pair("0", "1.00"));
        assert_eq!(text(of_beta(0.9994)), pair("0.9994", "28.9"));
        assert_eq!(text(of_beta(2e-5)), pair("2e-5", "1.00"));
        assert_eq!(text(of_gap(1e-20)), pair("1 − 1e-20", "7.1e9"));
        assert_eq!(text(of_gap(3.2e-7)), pair("1 − 3.2e-7", "1250"));
    }

    /// Speeds add up as Einstein has it: 0.5 and 0.5 are 0.8.
    #[test]
    fn speeds_are_those_of_objects_relative_to_the_observer() {
        let numbers = |objects: &[f64]| {
            let object = |(number, beta): (usize, &f64)| {
                format!(
                    r#"{{ "name": "{number}", "shape": {{ "sphere": {{ "radius": 1 }} }},
                       "velocity": {{ "beta": {beta}, "direction": [-1, 0, 0] }} }}"#
                )
            };
            let objects: Vec<String> = objects.iter().enumerate().map(object).collect();
            let scene = crate::scene::Scene::from_json(&format!(
                r#"{{ "title": "  a\n b", "observer": {{ "velocity": {{ "beta": 0.5, "direction": [1, 0, 0] }} }},
                   "objects": [{}] }}"#,
                objects.join(", ")
            ))
            .unwrap();
            let (models, _) = crate::jobs::load_models(&scene, ".".as_ref()).unwrap();
            let placed = PlacedScene::new(scene, models).unwrap();
            assert_eq!(Caption::STANDARD.title(&placed).unwrap(), "a b");
            let all = Caption {
                model: true,
                ..Caption::STANDARD
            };
            all.numbers(&placed, 0..1)
        };
        assert_eq!(numbers(&[0.5, 0.5]), ["β = 0.8", "γ = 1.67", "model: seen"]);
        assert_eq!(numbers(&[0.0]), ["β = 0.5", "γ = 1.15", "model: seen"]);
        assert_eq!(numbers(&[0.5, 0.0])[0], "β = 0.5 … 0.8");
    }

    #[test]
    fn times_of_a_film_have_the_same_places() {
        let film: Vec<f64> = (0..200)
            .map(|n| -8.0 + 16.0 * f64::from(n) / 199.0)
            .collect();
        assert_eq!(time(film[1], &film), "−7.9");
        assert_eq!(time(film[199], &film), "8.0");
        let short = [-0.5, 1.0, 12.0];
        assert_eq!(short.map(|t| time(t, &short)), ["−0.5", "1", "12"]);
        let far = [1e9 / 3.0];
        assert_eq!(time(far[0], &far), "3.33333e8");
        let odd = [-1.0 / 3.0, -1e-4, 2.0 / 3.0];
        assert_eq!(odd.map(|t| time(t, &odd)), ["−0.333", "0.000", "0.667"]);
    }

    #[test]
    fn captions_fit_into_their_pictures() {
        let long = "A title ".repeat(200);
        for (width, height) in [
            (1280.0, 720.0),
            (320.0, 240.0),
            (64.0, 48.0),
            (3000.0, 40.0),
        ] {
            let lines = vec![
                vec![Words::new(long.clone())],
                vec![
                    Words::new("β = 0.95"),
                    Words::new("γ = 3.20"),
                    Words::new("τ = −7.92"),
                ],
                vec![],
                Words::of_ghosts(&[ViewModel::Rest, ViewModel::Contracted]),
            ];
            let block = Block::in_corner(&lines, width, height);
            assert!(block.size.x <= width, "{} {width}", block.size);
            assert_eq!(block.placed.len(), 6);
            assert!(block.placed[0].0.text.ends_with('…'));
            for (_, _, letter) in &block.placed {
                assert!(*letter >= SHRUNK * LEAST_PX);
            }
        }
    }

    #[test]
    fn a_caption_is_read_on_black_white_and_checks() {
        let size = PictureSize::new(320, 240).unwrap();
        for background in [0, 255] {
            let background = Color([background; 3]);
            let mut picture = Picture::filled(size, Color([200, 30, 30]));
            let words = vec![vec![Words::new("HHH")]];
            Block::in_corner(&words, 320.0, 240.0).draw(&mut picture, background);
            let has = |color: Color| (0..60).any(|x| picture.pixel(x, 12) == color.0);
            assert!(has(ink(background)) && has(halo(background)));
        }
    }
}
