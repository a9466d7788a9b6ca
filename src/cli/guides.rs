//! What helps to read a picture from outside: wires, ghosts, axes, a scale bar, labels.

use photosurface::{
    Color, DAffine3, DVec2, DVec3, Mesh, Picture, PlacedScene, Scenery, Strokes, View, Viewpoint,
    lettering_width,
};

use super::camera::Outside;

/// Where a ghost turns by more than this, in radians, an edge is drawn.
const SHARP: f64 = 0.5;

/// Height of letters as a part of a picture's, in pixels at least 8.
const LETTERS: f64 = 1.0 / 30.0;

const RED: Color = Color([0xe7, 0x4c, 0x3c]);
const GREEN: Color = Color([0x2e, 0xa8, 0x5a]);
const BLUE: Color = Color([0x3d, 0x8b, 0xe8]);

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Guides (for views from outside)")]
pub(super) struct GuideArgs {
    /// Draw the edges of all triangles of photosurfaces, also in the observer's view with --method mesh
    #[arg(long)]
    pub(super) wireframe: bool,
    /// Hint at other shapes of each object: "rest", as it is at rest, around the place where its middle is seen
    /// (blue); "contracted", where it is at the moment of observation, shortened by its motion (orange)
    #[arg(long, value_enum, value_name = "SHAPE,...", value_delimiter = ',')]
    ghost: Vec<Ghost>,
    /// Draw the observer's axes at its place: x red, y green, z blue
    #[arg(long)]
    pub(super) axes: bool,
    /// Draw a bar of a round length in scene units, as it is in the middle of what is shown
    #[arg(long, conflicts_with = "full_sky")]
    scale_bar: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Ghost {
    Rest,
    Contracted,
}

impl Ghost {
    fn color(self) -> Color {
        match self {
            Self::Rest => Color([0x5d, 0xad, 0xe2]),
            Self::Contracted => Color([0xf0, 0x9a, 0x2a]),
        }
    }

    /// From the rest frame to where it is shown, of something with its middle at `middle_rest`.
    fn rest_to_shown(self, view: &View, middle_rest: DVec3) -> DAffine3 {
        let now = view.rest_to_now();
        match self {
            Self::Contracted => now,
            Self::Rest => {
                let turned = DAffine3::from_quat(view.rotation());
                let offset = view.seen_position(middle_rest) - turned.transform_point3(middle_rest);
                DAffine3::from_translation(offset) * turned
            }
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
            (Ghost::Rest, "blue, the shape at rest"),
            (Ghost::Contracted, "orange, contracted by its motion"),
        ];
        let ghosts = ghosts.into_iter();
        let asked_for = ghosts.filter(|(ghost, _)| self.ghost.contains(ghost));
        let mut legend: Vec<_> = asked_for.map(|(_, words)| words).collect();
        if self.axes {
            legend.push("axes, x red, y green, z blue");
        }
        legend
    }

    /// Adds the ghosts of one step; their edges, to be drawn, and all places of them.
    pub(super) fn ghosts(
        &self,
        placed: &PlacedScene,
        step: usize,
    ) -> (Vec<(Mesh, Strokes<DVec3>)>, Vec<DVec3>) {
        let mut ghosts = Vec::new();
        for (object, parts) in placed.objects() {
            let view = placed.view(object, step).expect("a step of the scene");
            let bounds = parts.iter().filter_map(|(_, part)| part.mesh().bounds());
            let (low, high) = bounds.fold(
                (DVec3::INFINITY, DVec3::NEG_INFINITY),
                |(low, high), (a, b)| (low.min(a), high.max(b)),
            );
            for ghost in &self.ghost {
                let shown = ghost.rest_to_shown(&view, (low + high) / 2.0);
                for (_, part) in parts {
                    let mesh = part.clone().transformed(&shown).mesh().clone();
                    let edges = Strokes {
                        lines: mesh.sharp_edges(SHARP),
                        color: ghost.color(),
                        width_px: 1.5,
                    };
                    ghosts.push((mesh, edges));
                }
            }
        }
        let places = ghosts
            .iter()
            .flat_map(|(mesh, _)| mesh.positions().to_vec());
        let places = places.collect();
        (ghosts, places)
    }

    /// Draws what is asked for onto a picture from outside.
    pub(super) fn draw(
        &self,
        picture: &mut Picture,
        outside: &Outside,
        scenery: &Scenery,
        ghost_edges: &[Strokes<DVec3>],
        background: Color,
    ) {
        let viewpoint = Viewpoint::Outside(outside.place);
        scenery.draw(picture, &outside.camera, viewpoint, ghost_edges);
        if self.axes {
            let length = round_below(outside.height / 5.0);
            for (axis, name, color) in [
                (DVec3::X, "x", RED),
                (DVec3::Y, "y", GREEN),
                (DVec3::Z, "z", BLUE),
            ] {
                let line = Strokes {
                    lines: vec![[DVec3::ZERO, axis * length]],
                    color,
                    width_px: 2.0,
                };
                scenery.draw(
                    picture,
                    &outside.camera,
                    viewpoint,
                    std::slice::from_ref(&line),
                );
                let end = outside.camera.place(axis * (1.15 * length) - outside.place);
                if let Some(end) = end {
                    let height = letters(picture);
                    let middle = DVec2::new(-lettering_width(name, height), height) / 2.0;
                    write(picture, name, end + middle, color);
                }
            }
        }
        if self.scale_bar {
            let (width, height) = (picture.size().width(), picture.size().height());
            let per_unit = f64::from(height) / outside.height;
            let length = round_below(0.2 * f64::from(width) / per_unit);
            let letters = letters(picture);
            let start = DVec2::new(letters, f64::from(height) - letters);
            let end = start + DVec2::X * (length * per_unit);
            let tick = DVec2::Y * (letters / 3.0);
            let color = contrasting(background);
            picture.draw(&Strokes {
                lines: vec![[start, end], [start - tick, start], [end - tick, end]],
                color,
                width_px: 2.0,
            });
            write(picture, &length.to_string(), start - 2.0 * tick, color);
        }
    }
}

/// Labels a picture in its upper left corner.
pub(super) fn label(picture: &mut Picture, text: &str, background: Color) {
    let letters = letters(picture);
    write(
        picture,
        text,
        DVec2::new(0.8, 1.8) * letters,
        contrasting(background),
    );
}

fn letters(picture: &Picture) -> f64 {
    (f64::from(picture.size().height()) * LETTERS).max(8.0)
}

fn write(picture: &mut Picture, text: &str, start: DVec2, color: Color) {
    let height = letters(picture);
    picture.write(text, start, height, color);
}

/// Grey that is told from the background, darker or lighter.
fn contrasting(background: Color) -> Color {
    let [red, green, blue] = background.linear();
    let luminance = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
    Color(if luminance > 0.18 {
        [0x20; 3]
    } else {
        [0xd8; 3]
    })
}

/// The largest of 1, 2 and 5 times a power of ten that is not above `limit`.
fn round_below(limit: f64) -> f64 {
    let exponent = limit.log10().floor();
    let power = 10f64.powi(exponent.abs() as i32);
    let round = |digit: f64| {
        if exponent < 0.0 {
            digit / power
        } else {
            digit * power
        }
    };
    let fitting = [5.0, 2.0].map(round).into_iter().find(|&n| n <= limit);
    fitting.unwrap_or(round(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_have_round_lengths() {
        for (limit, expected) in [
            (1.0, 1.0),
            (1.99, 1.0),
            (4.9, 2.0),
            (7.0, 5.0),
            (0.03, 0.02),
            (99.0, 50.0),
            (0.5, 0.5),
        ] {
            assert_eq!(round_below(limit), expected);
        }
    }

    #[test]
    fn lines_are_told_from_the_background() {
        assert_eq!(contrasting(Color([0; 3])), Color([0xd8; 3]));
        assert_eq!(contrasting(Color([255; 3])), Color([0x20; 3]));
    }
}
