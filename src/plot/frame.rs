//! The part of a plane that a drawing shows, at one scale both ways.

use std::ops::Range;

/// A place of the plane: along the axis to the right, and along the axis upward.
pub(crate) type Spot = (f64, f64);

/// A pixel: to the right of the left edge, and below the upper edge.
pub(super) type Pixel = (i32, i32);

/// What lies between the contents and the edges, as a part of the frame.
const MARGIN: f64 = 0.05;

/// Numbers of relative difference below this are one in `f64`, or nearly so: a frame shows no less of them.
const LEAST_PART: f64 = 1e-12;

/// The distance between marks on an axis is at least so many pixels.
const BETWEEN_MARKS: f64 = 58.0;

/// A rectangle of the plane and the pixels that it covers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) low: Spot,
    pub(super) high: Spot,
    corner: Pixel,
    per_pixel: f64,
}

impl Frame {
    /// The frame that has all `spots` in it and covers `size` pixels from the upper left `corner`.
    pub(super) fn around(
        spots: impl Iterator<Item = Spot>,
        corner: Pixel,
        size: (u32, u32),
    ) -> Self {
        let nothing = (f64::INFINITY, f64::NEG_INFINITY);
        let (mut x, mut y) = (nothing, nothing);
        for spot in spots {
            x = (x.0.min(spot.0), x.1.max(spot.0));
            y = (y.0.min(spot.1), y.1.max(spot.1));
        }
        let (width, height) = (f64::from(size.0), f64::from(size.1));
        let largest = [x.0, x.1, y.0, y.1].map(f64::abs).into_iter();
        let largest = largest.fold(0.0, f64::max);
        let filled = 1.0 - 2.0 * MARGIN;
        let fitting = ((x.1 - x.0) / width).max((y.1 - y.0) / height) / filled;
        let per_pixel = match fitting.max(LEAST_PART * largest / width.min(height)) {
            // A single spot at the origin.
            0.0 => 2.0 / width.min(height),
            per_pixel => per_pixel,
        };
        let middle = (0.5 * x.0 + 0.5 * x.1, 0.5 * y.0 + 0.5 * y.1);
        let half = (0.5 * width * per_pixel, 0.5 * height * per_pixel);
        Self {
            low: (middle.0 - half.0, middle.1 - half.1),
            high: (middle.0 + half.0, middle.1 + half.1),
            corner,
            per_pixel,
        }
    }

    /// The length of so many pixels.
    pub(super) fn length(&self, pixels: f64) -> f64 {
        pixels * self.per_pixel
    }

    /// The pixel of a spot that the frame contains.
    pub(super) fn pixel(&self, (x, y): Spot) -> Pixel {
        let right = ((x - self.low.0) / self.per_pixel).round() as i32;
        let down = ((self.high.1 - y) / self.per_pixel).round() as i32;
        (self.corner.0 + right, self.corner.1 + down)
    }

    /// Whether the frame shows a spot.
    pub(super) fn contains(&self, (x, y): Spot) -> bool {
        (self.low.0..=self.high.0).contains(&x) && (self.low.1..=self.high.1).contains(&y)
    }

    /// The ends of the part of a line that the frame shows: the line has the spots `from + s * toward` for all `s` of
    /// `range`. `None` if it shows nothing of it.
    pub(super) fn clip(&self, from: Spot, toward: Spot, range: Range<f64>) -> Option<[Spot; 2]> {
        let Range { mut start, mut end } = range;
        for (from, toward, low, high) in [
            (from.0, toward.0, self.low.0, self.high.0),
            (from.1, toward.1, self.low.1, self.high.1),
        ] {
            if toward == 0.0 {
                if !(low..=high).contains(&from) {
                    return None;
                }
                continue;
            }
            let (a, b) = ((low - from) / toward, (high - from) / toward);
            start = start.max(a.min(b));
            end = end.min(a.max(b));
        }
        let at = |s: f64| (from.0 + s * toward.0, from.1 + s * toward.1);
        (start <= end).then(|| [at(start), at(end)])
    }

    /// The parts of a path that the frame shows, as pixels.
    pub(super) fn clipped_path(&self, path: &[Spot]) -> Vec<Vec<Pixel>> {
        let mut parts: Vec<Vec<Pixel>> = vec![];
        for ends in path.windows(2) {
            let toward = (ends[1].0 - ends[0].0, ends[1].1 - ends[0].1);
            let Some(shown) = self.clip(ends[0], toward, 0.0..1.0) else {
                continue;
            };
            let [start, end] = shown.map(|spot| self.pixel(spot));
            match parts.last_mut() {
                Some(part) if part.last() == Some(&start) => {
                    if end != start {
                        part.push(end);
                    }
                }
                _ => parts.push(vec![start, end]),
            }
        }
        parts
    }

    /// The numbers with marks between two ends of an axis, and how they are written; `scale` is that of the pixels.
    pub(super) fn marks(&self, low: f64, high: f64, scale: f64) -> Vec<(f64, String)> {
        let step = round_step(self.length(BETWEEN_MARKS * scale));
        let largest = low.abs().max(high.abs());
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        let first = (low / step).ceil();
        let count = (high / step).floor() - first;
        let numbers = (0..=count.clamp(0.0, 200.0) as u32).map(|n| (first + f64::from(n)) * step);
        let written = |number: f64| {
            if largest < 1e5 && decimals < 5 {
                format!("{number:.decimals$}")
            } else if number == 0.0 {
                "0".to_owned()
            } else {
                let digits = (largest / step).log10().ceil().clamp(0.0, 12.0) as usize;
                format!("{number:.digits$e}")
            }
        };
        numbers
            .map(|number| number + 0.0)
            .map(|number| (number, written(number)))
            .collect()
    }
}

/// The least of the numbers 1, 2 and 5 times a power of ten that is not below `least`, which is above 0.
pub(crate) fn round_step(least: f64) -> f64 {
    let power = 10f64.powf(least.log10().floor());
    let steps = [1.0, 2.0, 5.0].map(|digit| digit * power);
    let fitting = steps.into_iter().find(|&step| step >= least);
    fitting.unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> Frame {
        Frame::around([(0.0, 0.0), (9.0, 4.5)].into_iter(), (10, 20), (100, 100))
    }

    #[test]
    fn one_scale_holds_both_ways_and_the_contents_are_inside() {
        let frame = frame();
        assert_eq!(frame.pixel((0.0, 0.25)), (15, 90));
        assert_eq!(frame.pixel((9.0, 2.25)), (105, 70));
        assert!(frame.contains((9.0, 4.5)) && !frame.contains((9.6, 0.0)));
    }

    #[test]
    fn lines_end_at_the_edges() {
        let frame = frame();
        let all = f64::NEG_INFINITY..f64::INFINITY;
        let [a, b] = frame.clip((1.0, 100.0), (0.0, 2.0), all.clone()).unwrap();
        assert_eq!((a.0, b.0), (1.0, 1.0));
        assert!((a.1 - frame.low.1).abs() < 1e-12 && (b.1 - frame.high.1).abs() < 1e-12);
        assert!(frame.clip((100.0, 0.0), (0.0, 1.0), all.clone()).is_none());
        assert!(frame.clip((100.0, 0.0), (1.0, 1.0), 0.0..1e9).is_none());
        assert!(frame.clip((100.0, 0.0), (-1.0, 0.0), 0.0..1e9).is_some());
        let parts = frame.clipped_path(&[
            (-9.0, 1.0),
            (4.0, 1.0),
            (4.0, 99.0),
            (5.0, 99.0),
            (5.0, 1.0),
        ]);
        assert_eq!(parts.len(), 2);
        assert_eq!(parts[0].len(), 3);
    }

    #[test]
    fn marks_are_round_numbers() {
        let marks = frame().marks(-0.5, 9.5, 0.5);
        let words: Vec<_> = marks.iter().map(|(_, word)| word.as_str()).collect();
        assert_eq!(words, ["0", "5"]);
        let large = Frame::around(
            [(1e9, 0.0), (1e9 + 90.0, 0.0)].into_iter(),
            (0, 0),
            (900, 900),
        );
        let marks = large.marks(large.low.0, large.high.0, 1.0);
        assert_eq!(marks[1].1, "1.000000010e9");
        for (least, step) in [(0.3, 0.5), (1.0, 1.0), (60.0, 100.0), (1.5e-7, 2e-7)] {
            assert!((round_step(least) / step - 1.0).abs() < 1e-12);
        }
    }

    /// An observer who stays at one event at the origin, and one so late that its times are all one number.
    #[test]
    fn a_single_spot_has_a_frame() {
        let single = Frame::around([(0.0, 0.0)].into_iter(), (0, 0), (600, 600));
        assert!((single.high.0 - 1.0).abs() < 1e-12 && (single.high.1 - 1.0).abs() < 1e-12);
        let late = Frame::around([(0.0, 1e18)].into_iter(), (0, 0), (600, 600));
        assert!(late.high.1 > 1e18 && late.marks(late.low.1, late.high.1, 1.0).len() < 200);
    }
}
