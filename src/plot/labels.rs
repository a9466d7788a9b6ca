//! Words beside what they name, none over another, and over as little else as there is a choice.

use super::frame::Pixel;

/// Where words are already, as rectangles of pixels, and where there may be some.
#[derive(Debug)]
pub(super) struct Labels {
    room: [Pixel; 2],
    taken: Vec<[Pixel; 2]>,
    /// Pixels of lines, at even distances.
    lines: Vec<Pixel>,
}

/// On which side of its place a word stands: to the right (1) or left (-1), below (1) or above (-1).
pub(super) type Side = (i32, i32);

/// A word that runs upward beside a steep line has room to the right and to the left.
pub(super) const ANY_SIDE: [Side; 8] = [
    (1, 0),
    (-1, 0),
    (1, 1),
    (-1, -1),
    (1, -1),
    (-1, 1),
    (0, -1),
    (0, 1),
];

impl Labels {
    /// None so far, in a room between its upper left and lower right corner.
    pub(super) fn new(room: [Pixel; 2]) -> Self {
        Self {
            room,
            taken: vec![],
            lines: vec![],
        }
    }

    /// Keeps words away from a place and from what is within a distance of it.
    pub(super) fn keep_free(&mut self, (x, y): Pixel, distance: i32) {
        self.taken
            .push([(x - distance, y - distance), (x + distance, y + distance)]);
    }

    /// Keeps words away from a line as long as there is room elsewhere; `distance` is that between two of its pixels that
    /// count.
    pub(super) fn avoid(&mut self, [start, end]: [Pixel; 2], distance: i32) {
        let (right, down) = (end.0 - start.0, end.1 - start.1);
        let count = right.abs().max(down.abs()) / distance.max(1) + 1;
        let part =
            |length: i32, n: i32| (f64::from(length) * f64::from(n) / f64::from(count)) as i32;
        let pixels = (0..=count).map(|n| (start.0 + part(right, n), start.1 + part(down, n)));
        self.lines.extend(pixels);
    }

    /// The upper left corner of a word of `size` at a distance from `place`, on the one of the `sides` that is free and
    /// over the fewest lines, of equal ones the first; `None` if none is free.
    pub(super) fn find(
        &mut self,
        place: Pixel,
        distance: i32,
        size: (u32, u32),
        sides: &[Side],
    ) -> Option<Pixel> {
        let (width, height) = (size.0 as i32, size.1 as i32);
        let start = |side: i32, place: i32, length: i32| match side {
            1 => place + distance,
            -1 => place - distance - length,
            _ => place - length / 2,
        };
        let corners = sides.iter().map(|side| {
            (
                start(side.0, place.0, width),
                start(side.1, place.1, height),
            )
        });
        let rectangle = |(x, y): Pixel| [(x, y), (x + width, y + height)];
        let free = corners.map(rectangle).filter(|word| self.is_free(word));
        let word = free.min_by_key(|word| self.lines_under(word))?;
        self.taken.push(word);
        Some(word[0])
    }

    fn lines_under(&self, [low, high]: &[Pixel; 2]) -> usize {
        let (columns, rows) = (low.0..=high.0, low.1..=high.1);
        let under = |pixel: &&Pixel| columns.contains(&pixel.0) && rows.contains(&pixel.1);
        self.lines.iter().filter(under).count()
    }

    fn is_free(&self, [low, high]: &[Pixel; 2]) -> bool {
        let [first, last] = self.room;
        let inside = low.0 >= first.0 && low.1 >= first.1 && high.0 <= last.0 && high.1 <= last.1;
        let apart = |other: &[Pixel; 2]| {
            high.0 < other[0].0 || other[1].0 < low.0 || high.1 < other[0].1 || other[1].1 < low.1
        };
        inside && self.taken.iter().all(apart)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_moves_aside_until_there_is_no_room() {
        let mut labels = Labels::new([(0, 0), (100, 50)]);
        let mut find = || labels.find((50, 25), 5, (40, 10), &ANY_SIDE[..2]);
        assert_eq!(find(), Some((55, 20)));
        assert_eq!(find(), Some((5, 20)));
        assert_eq!(find(), None);
        labels.keep_free((10, 10), 5);
        assert_eq!(labels.find((3, 3), 5, (9, 9), &ANY_SIDE), None);
    }

    #[test]
    fn a_word_gives_way_to_a_line_if_it_can() {
        let mut labels = Labels::new([(0, 0), (100, 50)]);
        labels.avoid([(50, 25), (100, 25)], 4);
        let mut find = || labels.find((50, 25), 5, (40, 10), &ANY_SIDE[..2]);
        assert_eq!(find(), Some((5, 20)));
        assert_eq!(find(), Some((55, 20)));
    }
}
