//! Where the results of `photosurface cost` go: flags for JSON, CSV and plots.

use std::path::{Path, PathBuf};

use anyhow::Context;
use photosurface::study::{PlotError, PlotSize};

use super::drawing::{DrawingFormat, plot_size};
use super::output::{shows_table, write_result};

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

impl CostOutputArgs {
    /// The file of the plot, if there is to be one.
    pub(super) fn drawing(&self) -> anyhow::Result<Option<(&Path, DrawingFormat)>> {
        DrawingFormat::of_flag("--plot", self.plot.as_deref())
    }

    /// Whether the tables for people go to stdout.
    pub(super) fn shows_tables(&self) -> anyhow::Result<bool> {
        shows_table(self.json.as_deref(), self.csv.as_deref())
    }

    /// Draws and writes the plot, so many pixels high unless the size is given.
    pub(super) fn write_plot(
        &self,
        drawing: Option<(&Path, DrawingFormat)>,
        height: u32,
        draw: impl Fn(DrawingFormat, PlotSize) -> Result<Vec<u8>, PlotError>,
    ) -> anyhow::Result<()> {
        let Some((path, format)) = drawing else {
            return Ok(());
        };
        let size = match self.plot_size {
            Some(size) => size,
            None => PlotSize::new(960, height)?,
        };
        write_result(path, &draw(format, size).context("--plot")?)
    }
}
