//! Flags that say how accurate the result is to be, and what that may cost.

use anyhow::{Context, bail};
use clap::Args;
use photosurface::{Facts, Precision, Scene, Stage, Tolerance, Wanted};

use super::messages::{Verbosity, grouped};

/// Room for predictions: they are good to about a half (`tests/cli.rs`).
const PREDICTION_ROOM: f64 = 1.6;

/// Of more steps than this a prediction looks at as many, evenly spread.
const STEPS_LOOKED_AT: usize = 32;

/// A budget below what is there before any refinement fits no tolerance.
const MAX_LOOSENING: f64 = 1e9;

/// How accurate the result is to be, and what that may cost.
#[derive(Debug, Args)]
#[command(next_help_heading = "Accuracy (overrides the scene)")]
pub(super) struct AccuracyArgs {
    /// How far a photosurface may be from the true one: 1e-3 (a fraction of its diagonal), abs:0.01 (a length in
    /// scene units) or deg:0.02 (an angle seen by the observer, in degrees) [default: 1e-3]
    #[arg(long, value_name = "T", value_parser = tolerance)]
    tolerance: Option<Tolerance>,
    /// Leave every vertex what it is; the certificate still tells how far off the mesh is
    #[arg(long)]
    no_subdivide: bool,
    /// Most triangles of all photosurfaces together; if the tolerance needs more, the largest gaps are closed
    /// first and the result is not certified
    #[arg(long, value_name = "N", default_value_t = 20_000_000)]
    max_triangles: u64,
    /// Level of detail: a file for each of these tolerances, out_lod0.glb, out_lod1.glb, ...
    #[arg(long, value_name = "T,T,...", value_delimiter = ',', value_parser = tolerance, conflicts_with = "tolerance")]
    lod: Vec<Tolerance>,
}

impl AccuracyArgs {
    /// The scene at each level of detail, with what to add to the names of files.
    pub(super) fn levels(&self, scene: Scene) -> Vec<(String, Scene)> {
        if !self.lod.is_empty() {
            let level = |(level, tolerance): (usize, &Tolerance)| {
                (
                    format!("_lod{level}"),
                    scene.clone().with_tolerance_for_all(*tolerance),
                )
            };
            return self.lod.iter().enumerate().map(level).collect();
        }
        let scene = match self.tolerance {
            Some(tolerance) => scene.with_tolerance_for_all(tolerance),
            None => scene,
        };
        vec![(String::new(), scene)]
    }

    /// How many levels of detail there are.
    pub(super) fn level_count(&self) -> usize {
        self.lod.len().max(1)
    }

    /// What is wanted of the stage's photosurfaces, within the budget; tells what the tolerance takes.
    pub(super) fn wanted(
        &self,
        stage: &Stage,
        precision: Precision,
        verbosity: Verbosity,
    ) -> Wanted {
        let wanted = Wanted {
            subdivide: !self.no_subdivide,
            precision,
            ..Wanted::default()
        };
        let predicted = predicted_total(stage, wanted);
        let needed = grouped(predicted.round() as usize);
        verbosity.detail(format_args!("about {needed} triangles"));
        let most = self.max_triangles as f64;
        if !wanted.subdivide || PREDICTION_ROOM * predicted <= most {
            return wanted;
        }
        // Triangles go with the inverse of the tolerance, but for those that are there anyway.
        let loosened = |loosening| Wanted {
            loosening,
            ..wanted
        };
        let (mut loosening, mut excess) = (1.0, PREDICTION_ROOM * predicted / most);
        while excess > 1.0 && loosening < MAX_LOOSENING {
            loosening *= excess.max(1.5);
            excess = PREDICTION_ROOM * predicted_total(stage, loosened(loosening)) / most;
        }
        let advice = if excess > 1.0 {
            "no tolerance would fit".to_owned()
        } else {
            let scene = stage.scene();
            let objects = scene.objects().iter();
            let fitting =
                objects.map(|object| scene.tolerance(object).times(loosening).to_string());
            let mut fitting: Vec<_> = fitting.collect();
            fitting.dedup();
            format!("--tolerance {} would fit", fitting.join(", "))
        };
        verbosity.note(format_args!(
            "the tolerance needs about {needed} triangles, more than --max-triangles {}; {advice}",
            self.max_triangles,
        ));
        loosened(loosening)
    }
}

/// About how many triangles the photosurfaces of each object will have, all steps together; of many steps only
/// some are looked at.
pub(super) fn predicted_triangles(stage: &Stage, wanted: Wanted) -> Vec<f64> {
    let steps = stage.scene().steps().len();
    let looked_at = steps.min(STEPS_LOOKED_AT);
    let mut sums = vec![0.0; stage.scene().objects().len()];
    for index in 0..looked_at {
        let step = index * (steps - 1) / (looked_at - 1).max(1);
        for (sum, triangles) in sums.iter_mut().zip(stage.predicted_triangles(step, wanted)) {
            *sum += triangles * steps as f64 / looked_at as f64;
        }
    }
    sums
}

fn predicted_total(stage: &Stage, wanted: Wanted) -> f64 {
    predicted_triangles(stage, wanted).iter().sum()
}

/// Says which photosurfaces are not certified; `true` if all are.
pub(super) fn all_certified(made: &[Facts], verbosity: Verbosity) -> bool {
    let open: Vec<_> = made
        .iter()
        .filter(|facts| !facts.certificate.complete)
        .collect();
    let excess = |facts: &Facts| facts.certificate.total / facts.certificate.tolerance;
    let Some(worst) = open.iter().max_by(|a, b| excess(a).total_cmp(&excess(b))) else {
        return true;
    };
    let certificate = &worst.certificate;
    verbosity.note(format_args!(
        "{} of {} photosurfaces are not within the tolerance; the worst is \"{}\", proven within {:.3e} where {:.3e} \
         was asked for ({}: gap {:.3e}, curvature {:.3e}, rounding {:.3e})",
        open.len(),
        made.len(),
        worst.name,
        certificate.total,
        certificate.tolerance,
        certificate.unit,
        certificate.gap,
        certificate.curvature,
        certificate.rounding,
    ));
    false
}

/// `1e-3`, `abs:0.01` or `deg:0.02`
fn tolerance(text: &str) -> anyhow::Result<Tolerance> {
    let number = |text: &str| -> anyhow::Result<f64> {
        text.trim()
            .parse()
            .with_context(|| format!("\"{text}\" is no number"))
    };
    let tolerance = match text.split_once(':') {
        None => Tolerance::Relative(number(text)?),
        Some(("abs", length)) => Tolerance::Absolute(number(length)?),
        Some(("deg", degrees)) => Tolerance::Angle(number(degrees)?),
        Some((unit, _)) => bail!("unknown unit \"{unit}\", expected 1e-3, abs:0.01 or deg:0.02"),
    };
    Ok(tolerance.checked()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_are_read_in_their_three_units() {
        assert_eq!(tolerance("1e-3").unwrap(), Tolerance::Relative(1e-3));
        assert_eq!(tolerance("abs:0.5").unwrap(), Tolerance::Absolute(0.5));
        assert_eq!(tolerance("deg:0.02").unwrap(), Tolerance::Angle(0.02));
        for wrong in ["", "0", "-1", "inf", "nan", "rel:1", "deg:91", "abs:"] {
            assert!(tolerance(wrong).is_err(), "{wrong}");
        }
        let shown = Tolerance::Angle(0.02).to_string();
        assert_eq!(tolerance(&shown).unwrap(), Tolerance::Angle(0.02));
    }
}
