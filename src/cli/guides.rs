//! Flags for what helps to read a picture, and what its colours mean.

use anyhow::ensure;
use photosurface::jobs::{Caption, Guides};
use photosurface::spacetime::ViewModel;

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Guides")]
pub(super) struct GuideArgs {
    /// Draw the edges of all triangles of photosurfaces, also in the observer's view with --method mesh
    #[arg(long)]
    pub(super) wireframe: bool,
    /// Hint at each object under other models: "rest", as it is at rest, around the place where its middle is seen (blue);
    /// "contracted", where it is at the moment of observation, shortened by its motion (orange); "delayed", with the travel
    /// time of light alone (violet); "seen", the photosurface (green)
    #[arg(long, value_name = "MODEL,...", value_delimiter = ',')]
    ghost: Vec<ViewModel>,
    /// Draw the observer's axes at its place in views from outside: x red, y green, z blue
    #[arg(long)]
    axes: bool,
    /// Draw a grid of longitude and latitude every 30 degrees, with the direction of motion, in the observer's pictures
    /// [default in pictures of the whole sky]
    #[arg(long)]
    grid: bool,
    /// Draw no grid in pictures of the whole sky
    #[arg(long, conflicts_with = "grid")]
    no_grid: bool,
    /// Draw a bar of a round length in scene units in views from outside, as it is in the middle of what is shown
    #[arg(long, conflicts_with = "full_sky")]
    scale_bar: bool,
    /// Write the name of each object beside it
    #[arg(long)]
    labels: bool,
    /// What is written on a picture, or above a sheet: "title" of the scene, "speed" and "gamma" of the objects relative to
    /// the observer, its proper "time", the "model" under which objects are shown, the "scale" of views from outside; or "none".
    /// The names of ghosts' models stand below [default: title,speed,gamma,time,scale on sheets and films, none on other
    /// pictures]
    #[arg(long, value_name = "PART,...", value_enum, value_delimiter = ',')]
    caption: Vec<Part>,
}

/// A part of a caption.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Part {
    Title,
    Speed,
    Gamma,
    Time,
    Model,
    Scale,
    None,
}

impl GuideArgs {
    /// The guides of pictures, of the whole sky or of less; `tells_time` is whether the pictures show several moments together.
    pub(super) fn guides(&self, of_full_sky: bool, tells_time: bool) -> anyhow::Result<Guides> {
        Ok(Guides {
            ghosts: self.ghost.clone(),
            axes: self.axes,
            scale_bar: self.scale_bar || self.tells_scale(tells_time),
            sky_grid: self.grid || of_full_sky && !self.no_grid,
            wireframe: self.wireframe,
            labels: self.labels,
            caption: self.caption(tells_time)?,
        })
    }

    fn caption(&self, tells_time: bool) -> anyhow::Result<Caption> {
        let has = |part| self.caption.contains(&part);
        ensure!(
            !has(Part::None) || self.caption.len() == 1,
            "--caption: none stands alone, expected no other part beside it"
        );
        Ok(match self.caption.as_slice() {
            [] if tells_time => Caption::STANDARD,
            _ => Caption {
                title: has(Part::Title),
                speed: has(Part::Speed),
                gamma: has(Part::Gamma),
                time: has(Part::Time),
                model: has(Part::Model),
            },
        })
    }

    /// Whether a caption has the scale of views from outside.
    fn tells_scale(&self, tells_time: bool) -> bool {
        match self.caption.as_slice() {
            [] => tells_time,
            parts => parts.contains(&Part::Scale),
        }
    }

    /// Whether something is asked for that only pictures from outside have.
    pub(super) fn are_for_outside(&self) -> bool {
        self.axes || self.scale_bar
    }

    /// What the colours of guides mean, of those that are asked for.
    pub(super) fn legend(&self) -> Vec<&'static str> {
        let ghosts = [
            (ViewModel::Rest, "blue, the shape at rest"),
            (ViewModel::Contracted, "orange, contracted by its motion"),
            (
                ViewModel::Delayed,
                "violet, delayed by the travel time of light",
            ),
            (ViewModel::Seen, "green, the photosurface"),
        ];
        let ghosts = ghosts.into_iter();
        let asked_for = ghosts.filter(|(ghost, _)| self.ghost.contains(ghost));
        let mut legend: Vec<_> = asked_for.map(|(_, words)| words).collect();
        if self.axes {
            legend.push("axes, x red, y green, z blue");
        }
        legend
    }
}
