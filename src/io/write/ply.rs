//! Binary PLY with positions in double precision: for MeshLab, and where `f32` is not enough.
//!
//! The format has one list of vertices: all photosurfaces of a file become one mesh. `quality`, the one
//! scalar that MeshLab reads, is the Doppler factor. Materials and texture coordinates stay behind.
//!
//! Source: G. Turk, *The PLY Polygon File Format* (1994).

use std::io::Write;

use glam::{DVec3, Vec4};

use super::{Export, WriteError};
use crate::mesh::Mesh;

/// Writes one PLY; every photosurface must have its Doppler factors.
///
/// # Errors
///
/// A mesh without triangles, a Doppler factor that `f32` cannot hold, more than 2^32 - 1 vertices, or the
/// writer fails.
pub fn write_ply(export: &Export<'_>, mut writer: impl Write) -> Result<(), WriteError> {
    let layers = layers(export);
    let vertices: usize = layers
        .iter()
        .map(|layer| layer.mesh.positions().len())
        .sum();
    let triangles: usize = layers
        .iter()
        .map(|layer| layer.mesh.triangles().len())
        .sum();
    if vertices > u32::MAX as usize {
        return Err(WriteError::TooManyVertices(vertices));
    }
    for layer in &layers {
        check_numbers(layer.name, layer.mesh, layer.doppler_factors)?;
    }
    let with_colors = layers.iter().any(|layer| layer.mesh.colors().is_some());

    write!(
        writer,
        "ply\nformat binary_little_endian 1.0\ncomment {}\nelement vertex {vertices}\n\
         property double x\nproperty double y\nproperty double z\n\
         property float nx\nproperty float ny\nproperty float nz\nproperty float quality\n",
        export.scene.generator
    )?;
    if with_colors {
        writer.write_all(
            b"property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n",
        )?;
    }
    write!(
        writer,
        "element face {triangles}\nproperty list uchar uint vertex_indices\nend_header\n"
    )?;

    for layer in &layers {
        layer.write_vertices(&mut writer, with_colors)?;
    }
    let mut first = 0u32;
    for layer in &layers {
        for corners in layer.mesh.triangles().iter() {
            let mut face = [3; 13];
            for (bytes, corner) in face[1..].chunks_exact_mut(4).zip(corners) {
                bytes.copy_from_slice(&(first + corner).to_le_bytes());
            }
            writer.write_all(&face)?;
        }
        first += layer.mesh.positions().len() as u32;
    }
    Ok(())
}

/// A mesh of the file with its scalar.
struct Layer<'a> {
    name: &'a str,
    mesh: &'a Mesh,
    /// `None` for the observer's own marker: nothing moves.
    doppler_factors: Option<&'a [f64]>,
}

fn layers<'a>(export: &'a Export<'_>) -> Vec<Layer<'a>> {
    let marker = export.marker.map(|marker| Layer {
        name: &marker.name,
        mesh: marker.mesh(),
        doppler_factors: None,
    });
    let photosurfaces = export.photosurfaces.iter().map(|photosurface| Layer {
        name: &photosurface.facts.name,
        mesh: &photosurface.mesh,
        doppler_factors: photosurface.doppler_factors.as_deref(),
    });
    marker.into_iter().chain(photosurfaces).collect()
}

/// Refuses what the file cannot hold.
///
/// # Errors
///
/// No triangles, a place that is no number, or a Doppler factor that `f32` cannot hold.
pub(super) fn check_numbers(
    name: &str,
    mesh: &Mesh,
    doppler_factors: Option<&[f64]>,
) -> Result<(), WriteError> {
    let name = || name.to_owned();
    if mesh.triangles().is_empty() {
        return Err(WriteError::Empty(name()));
    }
    if let Some(vertex) = mesh.positions().iter().position(|p| !p.is_finite()) {
        return Err(WriteError::Overflow {
            name: name(),
            vertex,
        });
    }
    let limit = f64::from(f32::MAX);
    let factors = doppler_factors.unwrap_or_default();
    match factors.iter().position(|factor| !(*factor <= limit)) {
        Some(vertex) => Err(WriteError::Range {
            name: name(),
            quantity: "the Doppler factor",
            vertex,
            value: factors[vertex],
            limit,
        }),
        None => Ok(()),
    }
}

impl Layer<'_> {
    fn write_vertices(&self, writer: &mut impl Write, with_colors: bool) -> Result<(), WriteError> {
        for (vertex, position) in self.mesh.positions().iter().enumerate() {
            let normal = self
                .mesh
                .normals()
                .map_or(DVec3::ZERO, |normals| normals[vertex]);
            let quality = self.doppler_factors.map_or(1.0, |factors| factors[vertex]);
            for coordinate in position.to_array() {
                writer.write_all(&coordinate.to_le_bytes())?;
            }
            for value in [normal.x, normal.y, normal.z, quality] {
                writer.write_all(&(value as f32).to_le_bytes())?;
            }
            if with_colors {
                let color = self
                    .mesh
                    .colors()
                    .map_or(Vec4::ONE, |colors| colors[vertex]);
                writer.write_all(&shown_color(color))?;
            }
        }
        Ok(())
    }
}

/// Red, green, blue and opacity as PLY's readers show them: sRGB (IEC 61966-2-1), opacity as it is.
fn shown_color(linear: Vec4) -> [u8; 4] {
    let encode = |value: f32| match value {
        v if v <= 0.003_130_8 => 12.92 * v,
        v => 1.055 * v.powf(1.0 / 2.4) - 0.055,
    };
    let shown = linear.truncate().to_array().map(encode);
    [shown[0], shown[1], shown[2], linear.w]
        .map(|value| (value.clamp(0.0, 1.0) * 255.0).round() as u8)
}
