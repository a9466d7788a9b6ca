//! Errors of the library in the words of the command line.

use anyhow::anyhow;
use photosurface::PlacedScene;
use photosurface::jobs::ExportError;
use photosurface::write::{Format, WriteError};

use super::file_camera::flagged;
use super::messages::counted;

/// The error with the flags that the settings come from.
pub(super) fn in_words_of_flags(error: ExportError) -> anyhow::Error {
    match error {
        ExportError::NoTime => anyhow!("--animate: a .ply has no time, expected .glb or .gltf"),
        ExportError::NoCamera => anyhow!("--camera: a .ply has no camera, expected .glb or .gltf"),
        ExportError::Framing(error) => flagged(error),
        ExportError::OneStep => anyhow!(
            "--animate: the scene has one step, expected at least two, such as --steps -6..6/7"
        ),
        ExportError::FramesPerSecond(number) => {
            anyhow!("--fps is {number:?}, expected a number from 0.001 to 1000")
        }
        ExportError::MorphingAttributes => anyhow!(
            "--animate=morph shows one mesh, and attributes differ from step to step; use --animate=frames"
        ),
        ExportError::MorphingColors => anyhow!(
            "--animate=morph shows one mesh, and colours as the observer sees them (Doppler effect, black bodies) differ from \
             step to step; use --animate=frames, or a scene without these effects"
        ),
        ExportError::Part { only, steps } => anyhow!(
            "--only is {}..{}, expected a part of {}",
            only.start,
            only.end,
            counted(steps, "step")
        ),
        ExportError::PartOfAnimation => anyhow!(
            "--only is for files of steps, and --animate shows all steps in one; make the animation in one run"
        ),
        ExportError::RepeatedLevel(tolerance) => {
            anyhow!("--lod names the tolerance {tolerance} twice")
        }
        error => error.into(),
    }
}

/// An error of numbers that the format cannot hold, with advice where another format could.
pub(super) fn or_ply(error: WriteError, placed: &PlacedScene) -> anyhow::Error {
    let is_of_numbers = matches!(
        error,
        WriteError::Range { .. } | WriteError::TooFar { .. } | WriteError::TooSmall { .. }
    );
    match is_of_numbers && Format::Ply.check_range(placed).is_ok() {
        true => anyhow!("{error}; or write a .ply, whose 64-bit numbers hold it"),
        false => error.into(),
    }
}
