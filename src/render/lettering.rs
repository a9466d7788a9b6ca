//! Text on a finished picture.

use std::f64::consts::FRAC_PI_4;
use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};
use glam::DVec2;

use super::picture::Picture;
use crate::shape::Color;

/// Of DejaVu Sans what titles and numbers need, and a box; `src/render/font/README.md` says where it is from.
pub(crate) const FONT: &[u8] = include_bytes!("font/DejaVuSans-subset.ttf");

/// Height of a capital letter in units of the font.
const CAPITAL: f32 = 1493.0;

/// Width of the seam around letters, in heights of capitals.
const SEAM: f64 = 0.14;

static FACE: LazyLock<FontRef<'static>> =
    LazyLock::new(|| FontRef::try_from_slice(FONT).expect("the font is part of the program"));

impl Picture {
    /// Writes a text in one line, its capitals so many pixels high, but no higher than the picture; `start` is the
    /// lower left corner of its first letter, in pixels.
    ///
    /// The font has the printable characters of ASCII and Latin-1, Greek without accents, `−`, dashes, quotation marks and
    /// `…`; a box stands for any other character. What is beyond an edge is cut off.
    pub fn write(&mut self, text: &str, start: DVec2, height_px: f64, color: Color) {
        let mut opacity = self.uncovered();
        self.cover_text(text, start, height_px, &mut opacity);
        self.blend(&opacity, color);
    }

    /// As [`Picture::write`], with a seam of another colour around all letters, so that they are read on anything.
    pub fn write_haloed(
        &mut self,
        text: &str,
        start: DVec2,
        height_px: f64,
        color: Color,
        halo: Color,
    ) {
        let mut opacity = self.uncovered();
        let seam = (SEAM * height_px).max(1.0);
        for part in 0..8 {
            let beside = DVec2::from_angle(f64::from(part) * FRAC_PI_4) * seam;
            self.cover_text(text, start + beside, height_px, &mut opacity);
        }
        self.blend(&opacity, halo);
        self.write(text, start, height_px, color);
    }

    fn uncovered(&self) -> Vec<f32> {
        vec![0.0; self.size().width() as usize * self.size().height() as usize]
    }

    fn cover_text(&self, text: &str, start: DVec2, height_px: f64, opacity: &mut [f32]) {
        let (width, height) = (self.size().width(), self.size().height());
        let (columns, rows) = (f64::from(width), f64::from(height));
        let scale = scale(height_px.clamp(0.0, rows));
        let mut place = start;
        for character in text.chars() {
            let id = FACE.glyph_id(character);
            // The font's own numbers are f32: of places it is told only the part within a pixel.
            let corner = place.floor();
            let inside = (place - corner).as_vec2();
            let glyph = id.with_scale_and_position(scale, point(inside.x, inside.y));
            if let Some(outlined) = FACE.outline_glyph(glyph).filter(|_| place.is_finite()) {
                let low = outlined.px_bounds().min;
                let corner = corner + DVec2::new(low.x.into(), low.y.into());
                outlined.draw(|x, y, covered| {
                    let DVec2 { x, y } = corner + DVec2::new(x.into(), y.into());
                    if x >= 0.0 && x < columns && y >= 0.0 && y < rows {
                        let seen = &mut opacity[y as usize * width as usize + x as usize];
                        *seen = seen.max(covered.min(1.0));
                    }
                });
            }
            place.x += f64::from(FACE.as_scaled(scale).h_advance(id));
        }
    }
}

/// Width of a text, in pixels, whose capitals are `height_px` pixels high; not finite where that is not.
pub fn lettering_width(text: &str, height_px: f64) -> f64 {
    let font = FACE.as_scaled(scale(height_px));
    let advances = text
        .chars()
        .map(|character| font.h_advance(font.glyph_id(character)));
    advances.map(f64::from).sum()
}

/// What the font calls its size: from the lowest descender to the highest ascender.
fn scale(height_px: f64) -> PxScale {
    PxScale::from(height_px as f32 / CAPITAL * FACE.height_unscaled())
}

#[cfg(test)]
mod tests {
    use super::super::PictureSize;
    use super::*;

    fn written(text: &str, start: DVec2, height_px: f64) -> Picture {
        let mut picture = Picture::filled(PictureSize::new(60, 40).unwrap(), Color([0; 3]));
        picture.write(text, start, height_px, Color([255; 3]));
        picture
    }

    fn of(character: char) -> Picture {
        written(&character.to_string(), DVec2::new(10.0, 30.0), 20.0)
    }

    #[test]
    fn characters_that_pictures_need_look_each_their_own_way() {
        let all = (' '..='~').chain("×°éß…β−γτΩ–".chars());
        let shapes: Vec<_> = all.map(of).collect();
        for (index, shape) in shapes.iter().enumerate() {
            assert!(!shapes[..index].contains(shape), "{index}");
        }
    }

    #[test]
    fn what_the_font_lacks_is_a_box() {
        let shape = of('ű');
        assert_ne!(shape, of(' '));
        for character in ['漢', 'ж', '\n', '\u{10ffff}'] {
            assert_eq!(of(character), shape);
        }
        assert!(lettering_width("ű", 20.0) > 10.0);
    }

    #[test]
    fn letters_with_a_seam_are_read_on_anything() {
        for level in [0, 128, 255] {
            let mut picture = Picture::filled(PictureSize::new(60, 40).unwrap(), Color([level; 3]));
            let (ink, seam) = (Color([255; 3]), Color([0; 3]));
            picture.write_haloed("H", DVec2::new(10.0, 30.0), 20.0, ink, seam);
            // Across an upright: seam, ink, seam.
            let row: Vec<u8> = (8..18).map(|x| picture.pixel(x, 15)[0]).collect();
            let first = row
                .iter()
                .position(|&level| level == 255 && row.contains(&0));
            assert!(first.is_some() || level == 255, "{row:?}");
            assert!(row.contains(&0) && row.contains(&255), "{row:?}");
        }
    }

    #[test]
    fn capitals_stand_on_the_line_and_are_as_high_as_is_said() {
        let picture = of('H');
        let is_lit = |y| (0..60).any(|x| picture.pixel(x, y) != [0; 3]);
        let lit: Vec<_> = (0..40).filter(|&y| is_lit(y)).collect();
        assert_eq!(lit, Vec::from_iter(10..30));
        // Two uprights, each 2.7 pixels wide.
        let full = (0..60).filter(|&x| picture.pixel(x, 15) == [255; 3]);
        assert!((2..=4).contains(&full.count()));
    }

    #[test]
    fn letters_follow_each_other_by_their_widths() {
        let start = DVec2::new(3.25, 30.5);
        let mut apart = written("A", start, 12.0);
        let second = start + DVec2::X * lettering_width("A", 12.0);
        apart.write("V", second, 12.0, Color([255; 3]));
        let together = written("AV", start, 12.0);
        // Where both touch, the one is laid over the other.
        let off = apart.bytes().iter().zip(together.bytes());
        assert!(off.filter(|(a, b)| a != b).count() < 12);
        assert_eq!(lettering_width("", 12.0), 0.0);
    }

    #[test]
    fn what_is_beyond_the_picture_is_cut_off() {
        let nothing = written("", DVec2::ZERO, 20.0);
        for place in [
            DVec2::new(-100.0, 30.0),
            DVec2::new(70.0, 30.0),
            DVec2::new(10.0, -30.0),
            DVec2::new(1e300, 1e300),
            DVec2::NAN,
            DVec2::NEG_INFINITY,
        ] {
            assert_eq!(written("gH", place, 20.0), nothing, "{place}");
        }
        for height in [0.0, -5.0, f64::NAN] {
            assert_eq!(written("H", DVec2::new(10.0, 30.0), height), nothing);
        }
        let cut = written("H", DVec2::new(-4.0, 30.0), 20.0);
        assert_ne!(cut, nothing);
        // No higher than the picture is.
        let huge = written("H", DVec2::new(0.0, 40.0), 1e30);
        assert_eq!(huge, written("H", DVec2::new(0.0, 40.0), 40.0));
    }
}
