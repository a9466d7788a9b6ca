//! The legend of pictures that show the Doppler factor as a colour.

use glam::DVec2;

use super::guides::letters;
use crate::effects::{RAMP_OCTAVES, byte_of_linear, ramp_color, tone};
use crate::render::{Picture, PictureSize, Strokes, lettering_width};
use crate::shape::Color;

const TITLE: &str = "Doppler factor";

/// Doppler factors from the left end of the bar to the right one: each twice the one before.
const TICKS: [&str; 7] = ["1/8", "1/4", "1/2", "1", "2", "4", "8"];

/// Of a plate of its own, so that the legend is read on any background.
const PLATE: Color = Color([0x14, 0x17, 0x1c]);
const INK: Color = Color([0xe6; 3]);

/// Width and height of the plate, its margin, the height of the bar and of a tick, in heights of letters.
const SIZE: DVec2 = DVec2::new(20.0, 6.2);
const MARGIN: f64 = 1.0;
const BAR: f64 = 1.2;
const TICK: f64 = 0.4;

/// Nobody reads smaller letters, in pixels: a picture for which these are too large has no legend.
const SMALLEST: f64 = 6.0;

/// Draws the legend into the lower right corner.
pub(super) fn draw_ramp_legend(picture: &mut Picture) {
    let (width, height) = (picture.size().width(), picture.size().height());
    let largest = DVec2::new(width.into(), height.into()) / (SIZE + 1.0);
    let letter = (0.75 * letters(picture))
        .max(SMALLEST)
        .min(largest.min_element());
    let [plate_width, plate_height] = (SIZE * letter).to_array().map(|side| side.round() as u32);
    let Ok(size) = PictureSize::new(plate_width, plate_height) else {
        return;
    };
    if letter < SMALLEST {
        return;
    }
    let mut plate = Picture::filled(size, PLATE);
    let left = MARGIN * letter;
    let length = f64::from(plate_width) - 2.0 * left;
    let top = (2.0 * MARGIN + 0.6) * letter;
    let bottom = top + BAR * letter;
    for column in 0..length as u32 {
        let place = left + f64::from(column) + 0.5;
        let octaves = RAMP_OCTAVES * (2.0 * (f64::from(column) + 0.5) / length - 1.0);
        let color = tone(ramp_color(octaves.exp2())).as_vec3().to_array();
        plate.draw(&Strokes {
            lines: vec![[DVec2::new(place, top), DVec2::new(place, bottom)]],
            color: Color(color.map(byte_of_linear)),
            width_px: 1.0,
        });
    }
    let middle = |text: &str| (f64::from(plate_width) - lettering_width(text, letter)) / 2.0;
    let title = DVec2::new(middle(TITLE), (MARGIN + 0.9) * letter);
    plate.write(TITLE, title, letter, INK);
    for (number, label) in TICKS.iter().enumerate() {
        let place = left + length * number as f64 / (TICKS.len() - 1) as f64;
        plate.draw(&Strokes {
            lines: vec![[
                DVec2::new(place, bottom),
                DVec2::new(place, bottom + TICK * letter),
            ]],
            color: INK,
            width_px: 1.0,
        });
        let half = lettering_width(label, 0.8 * letter) / 2.0;
        let start = DVec2::new(place - half, bottom + (TICK + 1.2) * letter);
        plate.write(label, start, 0.8 * letter, INK);
    }
    let gap = (0.5 * letter) as u32;
    picture.paste(
        &plate,
        width - plate_width - gap,
        height - plate_height - gap,
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_legend(width: u32, height: u32) -> Picture {
        let mut picture =
            Picture::filled(PictureSize::new(width, height).unwrap(), Color([255; 3]));
        draw_ramp_legend(&mut picture);
        picture
    }

    /// Blue on the right, red on the left, nothing in the other corners.
    #[test]
    fn the_bar_goes_from_red_to_blue() {
        let picture = with_legend(640, 480);
        let is_strong = |x: u32, channel: usize| {
            (0..480).any(|y| {
                let pixel = picture.pixel(x, y);
                let others = (0..3).filter(|&other| other != channel);
                others
                    .into_iter()
                    .all(|other| i32::from(pixel[channel]) > i32::from(pixel[other]) + 40)
            })
        };
        let reds: Vec<u32> = (0..640).filter(|&x| is_strong(x, 0)).collect();
        let blues: Vec<u32> = (0..640).filter(|&x| is_strong(x, 2)).collect();
        assert!(
            reds.len() > 50 && blues.len() > 50,
            "{} {}",
            reds.len(),
            blues.len()
        );
        assert!(reds.last() < blues.first());
        for x in 0..300 {
            assert!((0..480).all(|y| picture.pixel(x, y) == [255; 3]), "{x}");
        }
        assert!((0..640).all(|x| picture.pixel(x, 240) == [255; 3]));
    }

    #[test]
    fn a_picture_without_room_has_no_legend() {
        for (width, height) in [(1, 1), (100, 480), (640, 20)] {
            let picture = with_legend(width, height);
            assert!(
                picture.bytes().iter().all(|&byte| byte == 255),
                "{width} x {height}"
            );
        }
        let smallest = with_legend(150, 60);
        assert!(smallest.bytes().iter().any(|&byte| byte != 255));
    }
}
