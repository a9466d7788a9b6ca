//! Flags that say how fast the observer is: one speed, or several for pictures beside each other.

use anyhow::{Context, ensure};
use photosurface::DVec3;
use photosurface::spacetime::{Velocity, VelocityError};

use super::values::numbers;

/// The speed of the observer, in one of four forms.
#[derive(Debug, clap::Args)]
pub(super) struct SpeedArgs {
    /// Speed of the observer in units of the speed of light, 0 <= B < 1; for pictures also several, B,B,..., a row for each
    #[arg(long, value_name = "B", group = "speed", value_parser = speeds, allow_hyphen_values = true)]
    beta: Option<Speeds>,
    /// 1 - beta, for speeds too close to 1 for --beta, 0 < D <= 1
    #[arg(long, value_name = "D", group = "speed", value_parser = speeds, allow_hyphen_values = true)]
    one_minus_beta: Option<Speeds>,
    /// Lorentz factor of the observer, G >= 1
    #[arg(long, value_name = "G", group = "speed", value_parser = speeds, allow_hyphen_values = true)]
    gamma: Option<Speeds>,
    /// Rapidity of the observer, atanh(beta), from 0 to 350
    #[arg(long, value_name = "R", group = "speed", value_parser = speeds, allow_hyphen_values = true)]
    rapidity: Option<Speeds>,
}

/// A list of speeds as one value of a flag.
#[derive(Clone, Debug)]
pub(super) struct Speeds(Vec<f64>);

/// One of the forms in which speeds are given.
struct Form {
    flag: &'static str,
    /// How a picture calls it.
    symbol: &'static str,
    velocity: fn(f64, DVec3) -> Result<Velocity, VelocityError>,
}

impl SpeedArgs {
    fn given(&self) -> Option<(Form, &[f64])> {
        type Make = fn(f64, DVec3) -> Result<Velocity, VelocityError>;
        let forms: [(_, _, _, Make); 4] = [
            (&self.beta, "--beta", "β", Velocity::from_beta),
            (
                &self.one_minus_beta,
                "--one-minus-beta",
                "1 − β",
                Velocity::from_one_minus_beta,
            ),
            (&self.gamma, "--gamma", "γ", Velocity::from_gamma),
            (
                &self.rapidity,
                "--rapidity",
                "rapidity",
                Velocity::from_rapidity,
            ),
        ];
        forms
            .into_iter()
            .find_map(|(speeds, flag, symbol, velocity)| {
                let form = Form {
                    flag,
                    symbol,
                    velocity,
                };
                Some((form, speeds.as_ref()?.0.as_slice()))
            })
    }

    /// The first speed that is given, in a direction.
    pub(super) fn velocity(&self, direction: DVec3) -> anyhow::Result<Option<Velocity>> {
        let Some((form, speeds)) = self.given() else {
            return Ok(None);
        };
        let first = speeds
            .first()
            .map(|&speed| (form.velocity)(speed, direction));
        first.transpose().context(form.flag)
    }

    /// All speeds in a direction, each with the words for a picture; none unless there are several.
    pub(super) fn several(&self, direction: DVec3) -> anyhow::Result<Vec<(String, Velocity)>> {
        let Some((form, speeds)) = self.given().filter(|(_, speeds)| speeds.len() > 1) else {
            return Ok(vec![]);
        };
        let labelled = speeds.iter().map(|&speed| {
            let velocity = (form.velocity)(speed, direction).context(form.flag)?;
            Ok((format!("{} = {speed}", form.symbol), velocity))
        });
        labelled.collect()
    }

    /// Several speeds are an error where there is one observer.
    pub(super) fn refuse_several(&self) -> anyhow::Result<()> {
        match self.given() {
            Some((form, speeds)) => {
                ensure!(
                    speeds.len() == 1,
                    "{} has {} speeds, expected one; several are for pictures (photosurface render)",
                    form.flag,
                    speeds.len()
                );
                Ok(())
            }
            None => Ok(()),
        }
    }
}

/// `A` or `A,B,C`
fn speeds(text: &str) -> anyhow::Result<Speeds> {
    Ok(Speeds(numbers(text)?))
}

#[cfg(test)]
mod tests {
    use clap::{Args, FromArgMatches};

    use super::*;

    fn args(flags: &[&str]) -> SpeedArgs {
        let command = SpeedArgs::augment_args(clap::Command::new("render"));
        let words = std::iter::once("render").chain(flags.iter().copied());
        let matches = command.try_get_matches_from(words).unwrap();
        SpeedArgs::from_arg_matches(&matches).unwrap()
    }

    #[test]
    fn several_speeds_have_labels() {
        let one = args(&["--gamma", "5"]);
        assert_eq!(one.velocity(DVec3::X).unwrap().unwrap().gamma(), 5.0);
        assert!(one.several(DVec3::X).unwrap().is_empty() && one.refuse_several().is_ok());
        let several = args(&["--beta", "0.1,0.5"]);
        let labelled = several.several(DVec3::X).unwrap();
        assert_eq!(labelled[1].0, "β = 0.5");
        assert!((labelled[1].1.beta() - 0.5).abs() < 1e-15);
        assert!(several.refuse_several().is_err());
        assert_eq!(several.velocity(DVec3::X).unwrap(), Some(labelled[0].1));
        assert!(args(&["--beta=0.5,1"]).several(DVec3::X).is_err());
        assert!(args(&[]).velocity(DVec3::X).unwrap().is_none());
    }
}
