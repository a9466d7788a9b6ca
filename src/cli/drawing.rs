//! Flags of drawings: their format and their size.

use std::path::Path;

use anyhow::{Context, bail};
use photosurface::study::PlotSize;

use super::output::extension;

/// What a drawing is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DrawingFormat {
    Png,
    Svg,
}

impl DrawingFormat {
    /// The format that the name of the file says, if the flag is given.
    pub(super) fn of_flag<'a>(
        flag: &str,
        path: Option<&'a Path>,
    ) -> anyhow::Result<Option<(&'a Path, Self)>> {
        let Some(path) = path else {
            return Ok(None);
        };
        match extension(path).as_deref() {
            Some("png") => Ok(Some((path, Self::Png))),
            Some("svg") => Ok(Some((path, Self::Svg))),
            _ => bail!(
                "{flag} {}: unknown extension, expected .png or .svg",
                path.display()
            ),
        }
    }
}

/// `960x480`
pub(super) fn plot_size(text: &str) -> anyhow::Result<PlotSize> {
    let sides = text
        .split_once('x')
        .context("expected WxH, such as 960x480")?;
    let pixels = |side: &str| {
        side.parse::<u32>()
            .with_context(|| format!("\"{side}\" is not a number of pixels (expected e.g. 960)"))
    };
    Ok(PlotSize::new(pixels(sides.0)?, pixels(sides.1)?)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_of_plots_are_read_as_people_write_them() {
        assert_eq!(
            plot_size("960x480").unwrap(),
            PlotSize::new(960, 480).unwrap()
        );
        for wrong in [
            "",
            "960",
            "960x",
            "960x480x2",
            "0x0",
            "9.5x480",
            "10000x480",
        ] {
            assert!(plot_size(wrong).is_err(), "{wrong}");
        }
    }
}
