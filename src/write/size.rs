//! How large a file will be, before anything is computed: what is too large is refused in good time.

use std::collections::HashSet;
use std::sync::Arc;

use super::{Format, WriteError};
use crate::material::Part;
use crate::mesh::Mesh;
use crate::pipeline::PlacedScene;
use crate::scene::{Object, Source};

impl Format {
    /// How many bytes a file of `steps` steps of the placed scene has at least: its numbers and images, without the
    /// words around them, which are few.
    ///
    /// # Errors
    ///
    /// The format cannot hold so many, whatever else there is in the file.
    ///
    /// # Accuracy
    ///
    /// Never more than the file will have: what would fit is not refused.
    pub fn min_size(self, placed: &PlacedScene, steps: usize) -> Result<u64, WriteError> {
        // Other shapes are made as fine as their tolerance asks for, which may be next to nothing.
        let fixed = |object: &Object| match &object.source {
            Source::Shape(shape, _) => shape.has_resolution(),
            Source::File(_) | Source::Model(_) => true,
        };
        let parts: Vec<&Part> = placed
            .objects()
            .filter(|(object, _)| fixed(object))
            .flat_map(|(_, parts)| parts.iter().map(|(_, part)| part))
            .collect();
        let scalars = self.attributes(placed.scene()).scalars();
        match self {
            Self::Glb | Self::Gltf => {
                let bytes = min_gltf(&parts, steps as u64, scalars);
                let limit = u64::from(u32::MAX);
                if self == Self::Glb && bytes > limit {
                    return Err(WriteError::TooLarge {
                        format: "GLB",
                        bytes,
                        limit,
                    });
                }
                Ok(bytes)
            }
            Self::Ply => min_ply(&parts, steps as u64, scalars),
        }
    }
}

/// What differs from step to step is counted for each, what steps share once.
fn min_gltf(parts: &[&Part], steps: u64, scalars: u64) -> u64 {
    let mut shared = HashSet::new();
    let mut once = |address: usize, bytes: usize| match shared.insert(address) {
        true => bytes as u64,
        false => 0,
    };
    let (mut of_step, mut of_all) = (0_u64, 0_u64);
    for part in parts {
        let mesh = part.mesh();
        let vectors =
            12 + if mesh.has_normals() { 12 } else { 0 } + mesh.tangents().map_or(0, |_| 16);
        let of_vertex = vectors + 4 * scalars;
        of_step += of_vertex * mesh.vertex_count() as u64;
        of_all += once(
            Arc::as_ptr(mesh.shared_triangles()) as usize,
            size_of::<[u32; 3]>() * mesh.triangle_count(),
        );
        for set in mesh.texture_coordinates() {
            of_all += once(set.as_ptr() as usize, size_of_val(&set[..]));
        }
        if let Some(colors) = mesh.colors() {
            of_all += once(colors.as_ptr() as usize, 4 * colors.len());
        }
        let textures = part.material.iter().flat_map(|m| m.textures());
        for image in textures.flat_map(|texture| texture.images()) {
            of_all += once(image.bytes().as_ptr() as usize, image.bytes().len());
        }
    }
    of_step.saturating_mul(steps).saturating_add(of_all)
}

fn min_ply(parts: &[&Part], steps: u64, scalars: u64) -> Result<u64, WriteError> {
    let count = |of: fn(&Mesh) -> usize| {
        let each = parts.iter().map(|part| of(part.mesh()) as u64);
        steps.saturating_mul(each.sum())
    };
    let vertices = count(|mesh| mesh.vertex_count());
    if vertices > u64::from(u32::MAX) {
        return Err(WriteError::TooManyVertices(vertices as usize));
    }
    let color = match parts.iter().any(|part| part.mesh().colors().is_some()) {
        true => 4,
        false => 0,
    };
    let normal = match parts.iter().all(|part| part.mesh().has_normals()) {
        true => 12,
        false => 0,
    };
    // Three f64 a vertex and what else it has, a byte and three u32 a triangle.
    Ok((24 + normal + 4 * scalars + color) * vertices + 13 * count(|mesh| mesh.triangle_count()))
}

#[cfg(test)]
mod tests {
    use super::super::{Export, write_glb, write_ply};
    use super::*;
    use crate::jobs::load_models;
    use crate::material::Model;
    use crate::pipeline::SurfaceOptions;
    use crate::scene::{Observer, Scene};

    #[test]
    fn the_least_size_is_just_below_that_of_the_file() {
        let scene = Scene::from_json(
            r##"{ "attributes": ["doppler", "rest_position"], "objects": [
                { "name": "a", "shape": { "sphere": { "radius": 1 } }, "checker": "#ffffff", "position": [0, 3, 0] },
                { "name": "b", "shape": { "torus": { "major_radius": 2, "minor_radius": 1 } } } ] }"##,
        )
        .unwrap();
        let (models, _) = load_models(&scene, "".as_ref()).unwrap();
        // The same as geometry that is at hand: no tolerance makes it coarser.
        let own = |(object, model): (&Object, &Model)| Object {
            source: Source::Model(Arc::new(model.clone())),
            ..object.clone()
        };
        let objects = scene.objects().iter().zip(&models).map(own).collect();
        let asked_for = scene.attributes();
        let scene = Scene::new(Observer::default(), objects).unwrap();
        let scene = scene.with_attributes(asked_for);
        let placed =
            PlacedScene::new(scene.with_steps(vec![0.0, 1.0, 2.0]).unwrap(), models).unwrap();
        let wanted = SurfaceOptions {
            attributes: Format::Ply.attributes(placed.scene()),
            ..SurfaceOptions::default()
        };
        let photosurfaces: Vec<_> = (0..3)
            .flat_map(|step| placed.photosurfaces(step, wanted).unwrap())
            .collect();
        let export = Export {
            scene: &placed.facts(),
            marker: None,
            photosurfaces: &photosurfaces,
            playback: None,
        };
        let (mut glb, mut ply) = (vec![], vec![]);
        write_glb(&export, &mut glb).unwrap();
        write_ply(&export, &mut ply).unwrap();
        for (format, file, words) in [(Format::Glb, glb, 13_000), (Format::Ply, ply, 500)] {
            let least = format.min_size(&placed, 3).unwrap();
            let rest = file.len() as u64 - least;
            assert!(rest < words, "{format:?}: {rest} bytes more than {least}");
        }
        let [one, two] = [1, 2].map(|steps| Format::Glb.min_size(&placed, steps).unwrap());
        let most = 1 + (u64::from(u32::MAX) - one) / (two - one);
        assert!(Format::Glb.min_size(&placed, most as usize).is_ok());
        assert!(Format::Glb.min_size(&placed, most as usize + 1).is_err());
        assert!(Format::Gltf.min_size(&placed, 34_000).is_ok());
        assert!(Format::Ply.min_size(&placed, 800_000).is_err());
        assert_eq!(
            Format::Gltf.min_size(&placed, usize::MAX).unwrap(),
            u64::MAX
        );
        assert!(Format::Ply.min_size(&placed, usize::MAX).is_err());
    }
}
