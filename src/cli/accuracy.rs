//! Flags that say how accurate the result is to be, and what that may cost.

use anyhow::{Context, bail};
use clap::Args;
use photosurface::jobs::{DEFAULT_MAX_TRIANGLES, Fitted, Tally, levels_of_detail};
use photosurface::pipeline::Prediction;
use photosurface::scene::Measure;
use photosurface::tessellate::Precision;
use photosurface::write::Format;
use photosurface::{PlacedScene, Scene, SurfaceOptions, Tolerance};

use super::args::Given;
use super::messages::{Verbosity, grouped};
use super::values::whole_number;
use super::wording::in_words_of_flags;

/// Of more objects than this only so many are named.
const NAMED: usize = 4;

/// How accurate the result is to be, and what that may cost.
#[derive(Debug, Args)]
#[command(next_help_heading = "Accuracy (overrides the scene)")]
pub(super) struct AccuracyArgs {
    /// Largest distance between a mesh and its true photosurface: 1e-3 (a fraction of its diagonal), abs:0.01 (a length in
    /// scene units) or deg:0.02 (an angle seen by the observer, in degrees) [default: 1e-3]
    #[arg(long, value_name = "T", value_parser = tolerance, allow_hyphen_values = true)]
    tolerance: Option<Tolerance>,
    /// Which distance the tolerance limits: points, between where each point is drawn and where it is seen; or surface,
    /// between the mesh and the photosurface as surfaces, which is enough for shape alone and mostly takes fewer triangles
    /// [default: surface for round shapes without checker, attributes and effects of colour, else points]
    #[arg(long, value_name = "points|surface")]
    measure: Option<Measure>,
    /// Add no vertices; the certificate still bounds the distance from the true photosurface. A round shape without a
    /// resolution has that of its kind, which may be finer than the tolerance needs
    #[arg(long)]
    no_subdivide: bool,
    /// Maximum number of triangles of all photosurfaces together. If the tolerance needs more, the largest gaps are closed
    /// first and the result is not certified. Triangles of meshes and the coarsest forms of shapes are kept. "none" for no
    /// limit: then no step is predicted before the first is made, which saves time in parts of many steps
    /// [default: 20000000]
    #[arg(long, value_name = "N", value_parser = budget, allow_hyphen_values = true)]
    max_triangles: Option<u64>,
}

/// Several tolerances in place of one.
#[derive(Debug, Args)]
#[command(next_help_heading = "Accuracy (overrides the scene)")]
pub(super) struct DetailArgs {
    /// Levels of detail: for each of these tolerances export writes a file (and a report), out_lod0.glb, out_lod1.glb, ...,
    /// and check prints a table
    #[arg(long, value_name = "T,T,...", value_delimiter = ',', value_parser = tolerance, allow_hyphen_values = true,
        conflicts_with = "tolerance")]
    lod: Vec<Tolerance>,
}

impl DetailArgs {
    /// The placed scene at each level of detail.
    pub(super) fn levels(&self, placed: PlacedScene) -> anyhow::Result<Vec<PlacedScene>> {
        match self.lod.as_slice() {
            [] => Ok(vec![placed]),
            tolerances => levels_of_detail(&placed, tolerances).map_err(in_words_of_flags),
        }
    }

    /// The tolerances of several levels of detail; none for one level with those of the scene.
    pub(super) fn tolerances(&self) -> &[Tolerance] {
        &self.lod
    }

    /// How many levels of detail there are.
    pub(super) fn level_count(&self) -> usize {
        self.lod.len().max(1)
    }
}

impl AccuracyArgs {
    /// The scene with the tolerance and the measure that the flags say.
    pub(super) fn scene(&self, scene: Scene) -> Scene {
        let scene = match self.tolerance {
            Some(tolerance) => scene.with_tolerance_for_all(tolerance),
            None => scene,
        };
        match self.measure {
            Some(measure) => scene.with_measure_for_all(measure),
            None => scene,
        }
    }

    /// Which of the flags are there.
    pub(super) fn given(&self) -> [Given; 4] {
        [
            ("--tolerance", self.tolerance.is_some()),
            ("--measure", self.measure.is_some()),
            ("--no-subdivide", self.no_subdivide),
            ("--max-triangles", self.max_triangles.is_some()),
        ]
    }

    /// Whether meshes are refined.
    pub(super) fn subdivides(&self) -> bool {
        !self.no_subdivide
    }

    pub(super) fn max_triangles(&self) -> u64 {
        self.max_triangles.unwrap_or(DEFAULT_MAX_TRIANGLES)
    }

    /// What is wanted of the photosurfaces of a placed scene in a file.
    pub(super) fn wanted_in(&self, format: Format, scene: &Scene) -> SurfaceOptions {
        SurfaceOptions {
            subdivide: self.subdivides(),
            ..format.surface_options(scene)
        }
    }

    /// What is wanted of the photosurfaces of a placed scene in pictures.
    pub(super) fn wanted(&self, precision: Precision) -> SurfaceOptions {
        SurfaceOptions {
            subdivide: self.subdivides(),
            precision,
            ..SurfaceOptions::default()
        }
    }

    /// The placed scene with aims that are within the budget; tells what the tolerances need.
    pub(super) fn within_budget(
        &self,
        placed: PlacedScene,
        wanted: SurfaceOptions,
        verbosity: Verbosity,
    ) -> Fitted {
        let fitted = Fitted::new(placed, wanted, self.max_triangles());
        self.tell_fitted(&fitted, verbosity);
        fitted
    }

    /// Tells what the tolerances need, and which ones the budget leaves room for.
    pub(super) fn tell_fitted(&self, fitted: &Fitted, verbosity: Verbosity) {
        let needed = total(&fitted.needed);
        verbosity.detail(format_args!("about {needed}"));
        let Fitted {
            predictions,
            loosening,
            ..
        } = fitted;
        if loosening.iter().all(|&times| times == 1.0) {
            return;
        }
        let loosened: Vec<_> = fitted
            .loosened()
            .map(|(name, fitting)| (name, fitting.to_string()))
            .collect();
        let advice = match &loosened[..] {
            _ if loosening.contains(&f64::INFINITY)
                || predicted(predictions) > self.max_triangles() as f64 =>
            {
                "no looser tolerance near it fits".to_owned()
            }
            [(_, fitting)] if loosening.len() == 1 => format!("--tolerance {fitting} fits"),
            several => {
                let named = several.iter().take(NAMED);
                let named: Vec<_> = named
                    .map(|(name, fitting)| format!("{fitting} for \"{name}\""))
                    .collect();
                let rest = match several.len() - named.len() {
                    0 => String::new(),
                    rest => format!(" and looser ones for {rest} more"),
                };
                format!("the tolerance {}{rest} fits", named.join(", "))
            }
        };
        verbosity.note(format_args!(
            "the tolerance needs about {needed}, more than --max-triangles {}; {advice}",
            grouped(self.max_triangles() as usize),
        ));
    }

    /// Says so where a source alone has more triangles than the budget.
    pub(super) fn tell_beyond_budget(&self, triangles: f64, verbosity: Verbosity) {
        if triangles.round() > self.max_triangles() as f64 {
            verbosity.note(format_args!(
                "{} triangles are more than --max-triangles {}: those of meshes and the coarsest forms of shapes are always kept",
                grouped_number(triangles),
                grouped(self.max_triangles() as usize)
            ));
        }
    }

    /// Whether the photosurfaces are within their tolerances; says so where they are not, or are beyond the budget.
    ///
    /// A source that is larger than the budget is one that the budget is not about: it is told, and certificates alone
    /// say what is proven.
    pub(super) fn is_kept(&self, made: &Tally, verbosity: Verbosity) -> bool {
        self.tell_beyond_budget(made.triangles as f64, verbosity);
        all_certified(made, verbosity)
    }
}

/// Such as "1,200 triangles".
fn total(predictions: &[Prediction]) -> String {
    triangles(predicted(predictions))
}

/// Such as "1,200 triangles".
pub(super) fn triangles(triangles: f64) -> String {
    let plural = if triangles.round() == 1.0 { "" } else { "s" };
    format!("{} triangle{plural}", grouped_number(triangles))
}

/// Such as "1,200"; what is beyond counting as "2e302".
pub(super) fn grouped_number(number: f64) -> String {
    if number < 1e15 {
        grouped(number.round() as usize)
    } else {
        format!("{number:.0e}")
    }
}

pub(super) fn predicted(predictions: &[Prediction]) -> f64 {
    let triangles = predictions.iter().map(|prediction| prediction.triangles);
    triangles.sum()
}

/// Says which photosurfaces are not certified; `true` if all are.
fn all_certified(made: &Tally, verbosity: Verbosity) -> bool {
    let Some(worst) = &made.worst else {
        return true;
    };
    let certificate = &worst.certificate;
    verbosity.note(format_args!(
        "{} of {} photosurfaces are not within their tolerance; the worst is \"{}\", with a proven bound of {:.3e} for a \
         tolerance of {:.3e} ({}, {}: gap {:.3e}, curvature {:.3e}, rounding {:.3e}){}",
        made.uncertified,
        made.photosurfaces,
        worst.name,
        certificate.total,
        certificate.tolerance,
        certificate.unit,
        certificate.measure,
        certificate.measured_gap(),
        certificate.curvature,
        certificate.rounding,
        match certificate.tolerance {
            0.0 => "; it has no extent, so a relative tolerance of it is zero: give a length, such as --tolerance abs:0.01",
            _ => "",
        }
    ));
    false
}

/// The forms that a tolerance may have.
const TOLERANCE_FORMS: &str = "expected a fraction of the diagonal like 1e-3, a length like abs:0.01 or an angle like deg:0.02";

/// `1000000`, `1e6` or `none`
fn budget(text: &str) -> anyhow::Result<u64> {
    match text {
        "none" => Ok(u64::MAX),
        number => whole_number(number),
    }
}

/// `1e-3`, `abs:0.01` or `deg:0.02`
pub(super) fn tolerance(text: &str) -> anyhow::Result<Tolerance> {
    let number = |number: &str| -> anyhow::Result<f64> {
        let read = number.trim().parse();
        read.with_context(|| format!("\"{number}\" is not a number; {TOLERANCE_FORMS}"))
    };
    let tolerance = match text.split_once(':') {
        None => Tolerance::relative(number(text)?),
        Some(("abs", length)) => Tolerance::absolute(number(length)?),
        Some(("deg", degrees)) => Tolerance::degrees(number(degrees)?),
        Some((unit, _)) => bail!("unknown unit \"{unit}\"; {TOLERANCE_FORMS}"),
    };
    Ok(tolerance?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A flag that tells whether it is there cannot have clap say its default.
    #[test]
    fn help_says_the_default() {
        let help = AccuracyArgs::augment_args(clap::Command::new("export"))
            .render_long_help()
            .to_string();
        assert!(
            help.contains(&format!("[default: {DEFAULT_MAX_TRIANGLES}]")),
            "{help}"
        );
    }

    #[test]
    fn tolerances_are_read_in_their_three_units() {
        assert_eq!(
            tolerance("1e-3").unwrap(),
            Tolerance::relative(1e-3).unwrap()
        );
        assert_eq!(
            tolerance("abs:0.5").unwrap(),
            Tolerance::absolute(0.5).unwrap()
        );
        assert_eq!(
            tolerance("deg:0.02").unwrap(),
            Tolerance::degrees(0.02).unwrap()
        );
        for wrong in ["", "0", "-1", "inf", "nan", "rel:1", "deg:91", "abs:"] {
            assert!(tolerance(wrong).is_err(), "{wrong}");
        }
        let shown = Tolerance::degrees(0.02).unwrap().to_string();
        assert_eq!(
            tolerance(&shown).unwrap(),
            Tolerance::degrees(0.02).unwrap()
        );
    }
}
