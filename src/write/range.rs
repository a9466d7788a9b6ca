//! Whether the numbers of a file can hold what is seen, before any of the work.

use super::layer::{Layer, Numbers};
use super::pack::Packing;
use super::ply::check_positions;
use super::{Format, WriteError};
use crate::material::Part;
use crate::pipeline::{PlacedScene, SurfaceOptions};

impl Format {
    /// Maps the vertices that are there before any refinement, at the steps where they might be beyond the
    /// range of numbers, and refuses what the format cannot hold.
    ///
    /// # Errors
    ///
    /// As the format's own writer: the first number that is too large, or an extent that vanishes.
    pub fn check_range(self, placed: &PlacedScene) -> Result<(), WriteError> {
        let wanted = SurfaceOptions {
            subdivide: false,
            attributes: self.attributes(placed.scene()),
            ..SurfaceOptions::default()
        };
        // The boxes at rest, the same for all steps.
        let of_part = |(_, part): &(String, Part)| part.mesh().bounds().unwrap_or_default();
        let objects = placed.objects();
        let boxes: Vec<Vec<_>> = objects
            .map(|(_, parts)| parts.iter().map(of_part).collect())
            .collect();
        let steps = 0..placed.scene().steps().len();
        for step in steps.filter(|&step| !placed.is_within_f32(step, &boxes)) {
            for photosurface in placed.photosurfaces(step, wanted)? {
                let (name, mesh) = (&photosurface.facts.name, &photosurface.mesh);
                match self {
                    Self::Glb | Self::Gltf => {
                        let around = Some(photosurface.around);
                        Packing::new(name, &[mesh], around).map_err(|error| {
                            by_cause(error, photosurface.facts.relative_rapidity)
                        })?;
                    }
                    Self::Ply => check_positions(name, mesh)?,
                }
                let numbers = match self {
                    Self::Glb | Self::Gltf => Numbers::Single,
                    Self::Ply => Numbers::Any,
                };
                Layer::from(&photosurface).scalars(wanted.attributes, numbers)?;
            }
        }
        Ok(())
    }
}

/// Whether it is the speed that makes a position so large: it makes the way to the step `exp(rapidity)` times as long at
/// most, and what is seen there as many times as large again.
fn by_cause(error: WriteError, rapidity: f64) -> WriteError {
    match error {
        WriteError::Range {
            name,
            quantity,
            vertex,
            value,
            limit,
        } if value.abs() / rapidity.exp().powi(2) > limit => WriteError::TooFar {
            name,
            quantity,
            vertex,
            value,
            limit,
        },
        error => error,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::load_models;
    use crate::scene::Scene;

    fn placed(observer: &str, radius: &str) -> PlacedScene {
        let scene = format!(
            r#"{{ "observer": {{ "velocity": {observer} }},
                 "objects": [ {{ "name": "ball", "shape": {{ "sphere": {{ "radius": {radius} }} }}, "position": [0, 0, -5] }} ],
                 "steps": [-1, 0, 1] }}"#
        );
        let scene = Scene::from_json(&scene).unwrap();
        let (models, _) = load_models(&scene, "".as_ref()).unwrap();
        PlacedScene::new(scene, models).unwrap()
    }

    #[test]
    fn what_a_file_cannot_hold_is_named_before_the_work() {
        for (observer, radius, gltf, ply) in [
            (r#"{ "beta": 0.9 }"#, "1", None, None),
            (r#"{ "gamma": 1e12 }"#, "1", None, None),
            (
                r#"{ "rapidity": 350 }"#,
                "1",
                Some("the position of vertex 0 of the photosurface \"ball_step000\""),
                None,
            ),
            (
                r#"{ "beta": 0.5 }"#,
                "1e-45",
                Some("the photosurface \"ball_step000\" is only"),
                None,
            ),
            (
                r#"{ "beta": 0.5 }"#,
                "1e45",
                Some("it is too far away; choose a smaller distance"),
                None,
            ),
            (
                r#"{ "rapidity": 60 }"#,
                "1",
                Some("choose a smaller rapidity"),
                None,
            ),
        ] {
            let placed = placed(observer, radius);
            for (format, expected) in [
                (Format::Glb, gltf),
                (Format::Gltf, gltf),
                (Format::Ply, ply),
            ] {
                let found = format
                    .check_range(&placed)
                    .map_err(|error| error.to_string());
                match (found, expected) {
                    (Ok(()), None) => {}
                    (Err(message), Some(expected)) => {
                        assert!(message.contains(expected), "{message}");
                    }
                    (found, expected) => {
                        panic!("{observer} {radius} {format:?}: {found:?}, {expected:?}")
                    }
                }
            }
        }
    }
}
