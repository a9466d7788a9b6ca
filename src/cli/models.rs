//! Flags that say which effects of special relativity shapes are shown with.

use anyhow::ensure;
use photosurface::spacetime::ViewModel;
use photosurface::{Model, PlacedScene, Scene};

use super::args::Given;

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Model (overrides the scene)")]
pub(super) struct ModelArgs {
    /// Which effects of special relativity shapes are shown with: seen, both (the photosurface); delayed, the travel time of
    /// light alone; contracted, Lorentz contraction alone: where things are now; rest, neither
    #[arg(long, value_name = "MODEL")]
    model: Option<ViewModel>,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Model (overrides the scene)")]
pub(super) struct ModelsArgs {
    #[command(flatten)]
    one: ModelArgs,
    /// Show several models side by side: in pictures a labelled column for each, in files objects moved apart, with the name
    /// of the model in theirs
    #[arg(
        long,
        value_name = "MODEL,MODEL,...",
        value_delimiter = ',',
        conflicts_with = "model"
    )]
    models: Vec<ViewModel>,
}

impl ModelArgs {
    /// Which of the flags are there.
    pub(super) fn given(&self) -> [Given; 1] {
        [("--model", self.model.is_some())]
    }

    /// The scene under the model that the flag says.
    pub(super) fn scene(&self, scene: Scene) -> Scene {
        match self.model {
            Some(model) => scene.with_model_for_all(model),
            None => scene,
        }
    }
}

impl ModelsArgs {
    /// The scene under the model that the flag says.
    pub(super) fn scene(&self, scene: Scene) -> Scene {
        self.one.scene(scene)
    }

    /// The scene under its models, or under several side by side.
    pub(super) fn placed(&self, scene: Scene, models: Vec<Model>) -> anyhow::Result<PlacedScene> {
        let scene = self.scene(scene);
        Ok(match self.side_by_side()? {
            [] => PlacedScene::new(scene, models)?,
            view_models => PlacedScene::side_by_side(scene, &models, view_models)?,
        })
    }

    /// The models that are to stand side by side, each once; none for those of the scene.
    pub(super) fn side_by_side(&self) -> anyhow::Result<&[ViewModel]> {
        for (number, model) in self.models.iter().enumerate() {
            ensure!(
                !self.models[..number].contains(model),
                "--models: \"{model}\" is given twice, expected each model once"
            );
        }
        Ok(&self.models)
    }
}
