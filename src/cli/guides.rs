//! Flags for what helps to read a picture from outside, and what its colours mean.

use photosurface::jobs::{Ghost, Guides};

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Guides (for views from outside)")]
pub(super) struct GuideArgs {
    /// Draw the edges of all triangles of photosurfaces, also in the observer's view with --method mesh
    #[arg(long)]
    pub(super) wireframe: bool,
    /// Hint at other shapes of each object: "rest", as it is at rest, around the place where its middle is seen
    /// (blue); "contracted", where it is at the moment of observation, shortened by its motion (orange)
    #[arg(long, value_enum, value_name = "SHAPE,...", value_delimiter = ',')]
    ghost: Vec<GhostShape>,
    /// Draw the observer's axes at its place: x red, y green, z blue
    #[arg(long)]
    axes: bool,
    /// Draw a bar of a round length in scene units, as it is in the middle of what is shown
    #[arg(long, conflicts_with = "full_sky")]
    scale_bar: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum GhostShape {
    Rest,
    Contracted,
}

impl From<GhostShape> for Ghost {
    fn from(shape: GhostShape) -> Self {
        match shape {
            GhostShape::Rest => Self::Rest,
            GhostShape::Contracted => Self::Contracted,
        }
    }
}

impl From<&GuideArgs> for Guides {
    fn from(args: &GuideArgs) -> Self {
        Self {
            ghosts: args.ghost.iter().map(|&shape| shape.into()).collect(),
            axes: args.axes,
            scale_bar: args.scale_bar,
            wireframe: args.wireframe,
        }
    }
}

impl GuideArgs {
    /// Whether something is asked for that only pictures from outside have.
    pub(super) fn are_for_outside(&self) -> bool {
        self.axes || self.scale_bar || !self.ghost.is_empty()
    }

    /// What the colours of guides mean, of those that are asked for.
    pub(super) fn legend(&self) -> Vec<&'static str> {
        let ghosts = [
            (GhostShape::Rest, "blue, the shape at rest"),
            (GhostShape::Contracted, "orange, contracted by its motion"),
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
