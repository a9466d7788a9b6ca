//! Parts of an object in the frame of what stands for it under its model, and back.

use glam::DAffine3;

use crate::light_cone::ModelView;
use crate::material::Part;
use crate::mesh::Mesh;

/// Parts in the frame of a stand-in, from those at rest.
pub(super) fn stretched(
    parts: &[(String, Part)],
    rest_to_stand_in: &DAffine3,
) -> Vec<(String, Part)> {
    let parts = parts.iter();
    parts
        .map(|(name, part)| (name.clone(), part.clone().transformed(rest_to_stand_in)))
        .collect()
}

/// The mesh at rest of a refined stand-in. The vertices of `before`, the mesh at rest that has been refined, stay as they
/// are; those that are new are taken back. Taken back, a place moves by the rounding of its stand-in times the stretch or
/// its inverse, which for a fast observer may be more than the whole object.
pub(super) fn back_at_rest(shown: &ModelView, before: &Mesh, refined: Mesh) -> Mesh {
    let Some(to_rest) = shown.stand_in_to_rest() else {
        return refined;
    };
    fn kept<T: Copy>(old: Option<&[T]>, new: Option<&[T]>) -> Option<Vec<T>> {
        let (old, new) = old.zip(new)?;
        Some([old, &new[old.len()..]].concat())
    }
    let back = refined.transformed(&to_rest);
    let positions = kept(Some(before.positions()), Some(back.positions()));
    back.with_geometry(
        positions.unwrap_or_default(),
        kept(before.normals(), back.normals()),
        kept(before.tangents(), back.tangents()),
    )
}
