//! Numbers and a few letters as strokes: labels of axes, bars and steps.

use glam::DVec2;

/// Advance of one character as a part of its height.
const ADVANCE: f64 = 0.8;

/// The lines that write `text` with letters of so many pixels in height, from the lower left corner `start` on;
/// what there are no strokes for is left blank.
pub fn lettering(text: &str, start: DVec2, height_px: f64) -> Vec<[DVec2; 2]> {
    let place = |index: usize, x: u8, y: u8| {
        let column = index as f64 * ADVANCE + f64::from(x) / 6.0;
        start + height_px * DVec2::new(column, -f64::from(y) / 6.0)
    };
    let characters = text.chars().enumerate();
    let polylines = characters.flat_map(|(index, character)| {
        let glyph = glyph(character).split(' ');
        glyph.map(move |polyline| {
            let digits: Vec<_> = polyline.bytes().map(|digit| digit - b'0').collect();
            let points = digits.chunks_exact(2).map(|xy| place(index, xy[0], xy[1]));
            points.collect::<Vec<_>>()
        })
    });
    polylines
        .flat_map(|points| {
            points
                .windows(2)
                .map(|ends| [ends[0], ends[1]])
                .collect::<Vec<_>>()
        })
        .collect()
}

/// Width of a text of letters of so many pixels in height.
pub fn lettering_width(text: &str, height_px: f64) -> f64 {
    text.chars().count() as f64 * ADVANCE * height_px
}

/// Polylines of a character; each point is two digits, x from 0 to 4 and y from 0, the base line, to 6.
fn glyph(character: char) -> &'static str {
    match character {
        '0' => "1030414536160501 10",
        '1' => "0426 26201030",
        '2' => "0516364534000040",
        '3' => "0616364534231423344331100001",
        '4' => "3036020242",
        '5' => "46060323344341301001",
        '6' => "4536160501103041423313",
        '7' => "0646461020",
        '8' => "1304051636454433130201103041423313",
        '9' => "0110304145361605041333434",
        '.' => "20212020",
        '-' => "0343",
        '=' => "02420242 04440444",
        'x' => "0044 0440",
        'y' => "0422 4400",
        'z' => "04440040",
        'e' => "0242433414030110304",
        'τ' => "0444 24211030",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_character_that_a_number_needs_has_strokes_of_its_own() {
        let shapes: Vec<_> = "0123456789.-=xyzeτ"
            .chars()
            .map(|character| lettering(&character.to_string(), DVec2::ZERO, 6.0))
            .collect();
        for (index, shape) in shapes.iter().enumerate() {
            assert!(!shape.is_empty());
            assert!(!shapes[..index].contains(shape));
            for point in shape.iter().flatten() {
                assert!(point.x >= 0.0 && point.x <= 4.0, "{point}");
                assert!(point.y <= 0.0 && point.y >= -6.0, "{point}");
            }
        }
        assert!(lettering(" ", DVec2::ZERO, 6.0).is_empty());
        let second = lettering(" 1", DVec2::ZERO, 10.0);
        assert!(second.iter().flatten().all(|point| point.x >= 8.0));
    }
}
