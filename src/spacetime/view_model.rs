//! Models: which effects of special relativity the shape of an object is shown with.

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

/// Which effects of special relativity an object is shown with.
///
/// Two effects change the shape of whatever moves: it *is* shorter along its motion, and it is *seen* where each of its
/// points was when the light left. A model has both, one or neither. All four agree at the observer's place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(inline)]
pub enum ViewModel {
    /// Both effects: the photosurface.
    #[default]
    Seen,
    /// Lorentz contraction alone: where the object is, in the observer's frame, at the moment of observation.
    Contracted,
    /// The travel time of light alone: the photosurface of an object that is not contracted.
    Delayed,
    /// Neither effect: the object as it is in its rest frame, at the offset from the observer that it has there.
    Rest,
}

/// A name that is none of a [`ViewModel`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown model \"{0}\", expected one of {names}", names = ViewModel::ALL.map(ViewModel::name).join(", "))]
pub struct UnknownModel(String);

impl ViewModel {
    /// All models, the photosurface first.
    pub const ALL: [Self; 4] = [Self::Seen, Self::Delayed, Self::Contracted, Self::Rest];

    /// The name in scenes and flags.
    pub fn name(self) -> &'static str {
        match self {
            Self::Seen => "seen",
            Self::Contracted => "contracted",
            Self::Delayed => "delayed",
            Self::Rest => "rest",
        }
    }

    /// Whether light takes time from the object to the observer.
    pub fn has_delay(self) -> bool {
        matches!(self, Self::Seen | Self::Delayed)
    }

    /// Whether the object is shortened along its motion.
    pub fn has_contraction(self) -> bool {
        matches!(self, Self::Seen | Self::Contracted)
    }
}

impl fmt::Display for ViewModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl<'de> Deserialize<'de> for ViewModel {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Name;

        impl Visitor<'_> for Name {
            type Value = ViewModel;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                let names = ViewModel::ALL.map(|model| format!("\"{model}\""));
                write!(f, "a model: {}", names.join(", "))
            }

            fn visit_str<E: Error>(self, name: &str) -> Result<ViewModel, E> {
                name.parse().map_err(E::custom)
            }
        }

        deserializer.deserialize_str(Name)
    }
}

impl FromStr for ViewModel {
    type Err = UnknownModel;

    fn from_str(name: &str) -> Result<Self, UnknownModel> {
        let found = Self::ALL.into_iter().find(|model| model.name() == name);
        found.ok_or_else(|| UnknownModel(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_the_same_in_scenes_and_on_the_command_line() {
        for model in ViewModel::ALL {
            assert_eq!(model.to_string().parse(), Ok(model));
            let in_scene: ViewModel = serde_json::from_str(&format!("\"{model}\"")).unwrap();
            assert_eq!(in_scene, model);
        }
        let error = "shown".parse::<ViewModel>().unwrap_err().to_string();
        assert!(
            error.contains("\"shown\"") && error.contains("seen, delayed, contracted, rest"),
            "{error}"
        );
    }
}
