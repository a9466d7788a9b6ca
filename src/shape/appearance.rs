//! How a shape is painted: plain or checkered.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::ShapeError;
use crate::effects::linear_of_byte;

/// The colours of a shape.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, JsonSchema, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Appearance {
    /// The colour, `#rrggbb` in sRGB.
    pub color: Color,
    /// The colour of every other cell of a checker pattern; without it the shape is plain. Cells: on
    /// a sphere 15 degrees; on a box 8 x 8 a side; on a torus 24 around the axis and 8 around the
    /// tube; on cylinder and cone 24 around and about square; on a rod 4 around and about square; on
    /// a grid its own; on a lattice about as wide as a bar.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub checker: Option<Color>,
}

/// An opaque colour in sRGB; `#rrggbb` in JSON.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Deserialize, Serialize)]
#[serde(try_from = "String", into = "String")]
#[schemars(inline, extend("pattern" = "^#[0-9a-fA-F]{6}$"))]
pub struct Color(
    /// Red, green, blue.
    pub [u8; 3],
);

impl Color {
    /// Linear red, green and blue from 0 to 1.
    pub fn linear(self) -> [f32; 3] {
        self.0.map(linear_of_byte)
    }
}

impl Default for Color {
    /// A calm blue: light enough to show shading, far enough from red to show a red shift.
    fn default() -> Self {
        Self([0x5b, 0x8d, 0xc9])
    }
}

impl TryFrom<String> for Color {
    type Error = ShapeError;

    fn try_from(text: String) -> Result<Self, ShapeError> {
        let channels = text.strip_prefix('#').and_then(|digits| {
            let only_digits =
                digits.len() == 6 && digits.bytes().all(|digit| digit.is_ascii_hexdigit());
            let number = u32::from_str_radix(digits, 16).ok()?;
            let [_, red, green, blue] = number.to_be_bytes();
            only_digits.then_some([red, green, blue])
        });
        channels.map(Self).ok_or(ShapeError::Color(text))
    }
}

impl From<Color> for String {
    fn from(Color([red, green, blue]): Color) -> String {
        format!("#{red:02x}{green:02x}{blue:02x}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_read_and_written() {
        let color: Color = serde_json::from_str("\"#0aFf80\"").unwrap();
        assert_eq!(color, Color([10, 255, 128]));
        assert_eq!(serde_json::to_string(&color).unwrap(), "\"#0aff80\"");
        for text in [
            "", "red", "0aff80", "#0aff8", "#0aff800", "#+aff80", "#0aff8é",
        ] {
            let message = Color::try_from(text.to_owned()).unwrap_err().to_string();
            assert!(message.contains("expected #rrggbb"), "{message}");
        }
    }

    #[test]
    fn linear_colours_keep_their_channels() {
        assert_eq!(Color([0, 255, 0]).linear(), [0.0, 1.0, 0.0]);
        let [low, high, middle] = Color([10, 11, 188]).linear();
        assert!(low < high && high < middle);
        assert!((middle - 0.502_886_5).abs() < 1e-7, "{middle}");
    }

    #[test]
    fn an_appearance_needs_nothing_and_refuses_the_unknown() {
        let read = serde_json::from_str::<Appearance>;
        assert_eq!(read("{}").unwrap(), Appearance::default());
        assert_eq!(
            read(r##"{"checker": "#ffffff"}"##).unwrap().checker,
            Some(Color([255; 3]))
        );
        assert!(read(r##"{"colour": "#ffffff"}"##).is_err());
    }
}
