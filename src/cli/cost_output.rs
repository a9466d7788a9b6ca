//! Where the results of `photosurface cost` go: flags for JSON, CSV and plots.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use photosurface::study::{PlotError, PlotSize};
use photosurface::write::write_whole;

use super::messages::print;
use super::output::{extension, is_stdout};

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Output")]
pub(super) struct CostOutputArgs {
    /// Write the study as JSON; - for stdout, in place of the table
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,
    /// Write the table with all digits as CSV, one line for each tolerance, number of rays or integrator; if both meshes and
    /// pictures are studied, meshes go to FILE and pictures to FILE_rays, with the same extension; - for stdout, in place of
    /// the table, with --only or --integrators
    #[arg(long, value_name = "FILE")]
    pub(super) csv: Option<PathBuf>,
    /// Draw triangles and time over the tolerance, rays and time over the error of pictures, or with --integrators the
    /// errors of a flight over steps and time, all logarithmic, with the slopes of theory: .png or .svg
    #[arg(long, value_name = "FILE")]
    pub(super) plot: Option<PathBuf>,
    /// Size of the plot in pixels, from 640x480 to 8192x8192 [default: 960x480, or 960x780 for meshes and pictures]
    #[arg(long, value_name = "WxH", value_parser = plot_size, requires = "plot")]
    plot_size: Option<PlotSize>,
}

/// What a plot is written as.
#[derive(Clone, Copy)]
pub(super) enum Picture {
    Png,
    Svg,
}

impl CostOutputArgs {
    /// The file of the plot, if there is to be one, after a check that all outputs can be.
    pub(super) fn picture(&self) -> anyhow::Result<Option<(&Path, Picture)>> {
        ensure!(
            !(to_stdout(&self.json) && to_stdout(&self.csv)),
            "--json and --csv cannot both go to stdout"
        );
        let Some(path) = self.plot.as_deref() else {
            return Ok(None);
        };
        match extension(path).as_deref() {
            Some("png") => Ok(Some((path, Picture::Png))),
            Some("svg") => Ok(Some((path, Picture::Svg))),
            _ => bail!(
                "--plot {}: unknown extension, expected .png or .svg",
                path.display()
            ),
        }
    }

    /// Whether the tables for people go to stdout.
    pub(super) fn shows_tables(&self) -> bool {
        !to_stdout(&self.json) && !to_stdout(&self.csv)
    }

    /// Draws and writes the plot, so many pixels high unless the size is given.
    pub(super) fn write_plot(
        &self,
        picture: Option<(&Path, Picture)>,
        height: u32,
        draw: impl Fn(Picture, PlotSize) -> Result<Vec<u8>, PlotError>,
    ) -> anyhow::Result<()> {
        let Some((path, picture)) = picture else {
            return Ok(());
        };
        let size = match self.plot_size {
            Some(size) => size,
            None => PlotSize::new(960, height)?,
        };
        write(path, &draw(picture, size).context("--plot")?)
    }
}

/// Writes to a file or, for `-`, to stdout.
pub(super) fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    if is_stdout(path) {
        return print(|out| Ok(out.write_all(bytes)?));
    }
    Ok(write_whole(path, |writer| Ok(writer.write_all(bytes)?))?)
}

fn to_stdout(file: &Option<PathBuf>) -> bool {
    file.as_deref().is_some_and(is_stdout)
}

/// `960x480`
fn plot_size(text: &str) -> anyhow::Result<PlotSize> {
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
