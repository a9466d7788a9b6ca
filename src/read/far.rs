//! How far away anything of a model may be.

use glam::DVec3;

use super::ReadError;
use crate::material::Model;

/// The largest coordinate of a source: its square times the exponential of any rapidity is within `f64`.
const FARTHEST: f64 = 1e75;

/// The model, if nothing in it is so far away that computing with it would overflow.
pub(super) fn checked(model: Model) -> Result<Model, ReadError> {
    let largest = |position: &DVec3| position.abs().max_element();
    for part in &model.parts {
        // Its bounds are wanted sooner or later, and one look at all vertices is enough.
        let (low, high) = part.mesh().bounds().unwrap_or_default();
        if largest(&low) <= FARTHEST && largest(&high) <= FARTHEST {
            continue;
        }
        let positions = part.mesh().positions();
        if let Some(vertex) = positions.iter().position(|p| largest(p) > FARTHEST) {
            return Err(ReadError::TooFar {
                part: part.name.clone(),
                vertex,
                coordinate: largest(&positions[vertex]),
                limit: FARTHEST,
            });
        }
    }
    Ok(model)
}
