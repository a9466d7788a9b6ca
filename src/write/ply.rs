//! Binary PLY with positions in double precision: for MeshLab, and where `f32` is not enough.
//!
//! The format has one list of vertices: all photosurfaces of a file become one mesh. `quality`, the one
//! scalar that MeshLab reads, is the Doppler factor; what else is known of vertices has properties of its own. They are
//! `float`, and `double` where some number of theirs is beyond that.
//! Materials and texture coordinates stay behind.
//!
//! Source: G. Turk, *The PLY Polygon File Format* (1994).

use std::io::Write;

use glam::{DVec3, Vec4};

use super::layer::{Layer, Numbers, Scalar, layers};
use super::{Export, Seal, WriteError};
use crate::effects::byte_of_linear;
use crate::mesh::{Mesh, VERTICES_AT_ONCE};
use crate::pipeline::Photosurface;

/// Writes one PLY, all photosurfaces at once.
///
/// # Errors
///
/// A mesh without triangles, a number at a vertex that is none, more than 2^32 - 1 vertices, or the writer fails.
pub fn write_ply(export: &Export<'_>, writer: impl Write) -> Result<(), WriteError> {
    write_sealed_ply(export, None, writer)
}

/// As [`write_ply`]; a seal, which is to be closed when the file is written, becomes a comment.
pub(crate) fn write_sealed_ply(
    export: &Export<'_>,
    seal: Option<&Seal>,
    mut writer: impl Write,
) -> Result<(), WriteError> {
    let layers: Vec<Layer<'_>> = layers(export).collect();
    let vertices: usize = layers.iter().map(|layer| layer.mesh.vertex_count()).sum();
    let triangles: usize = layers.iter().map(|layer| layer.mesh.triangle_count()).sum();
    if vertices > u32::MAX as usize {
        return Err(WriteError::TooManyVertices(vertices));
    }
    let asked_for = export.photosurfaces.first().map(Photosurface::attributes);
    let asked_for = asked_for.unwrap_or_default();
    let mut scalars = vec![];
    for layer in &layers {
        check_positions(layer.name, layer.mesh)?;
        scalars.push(layer.scalars(asked_for, Numbers::Any)?);
    }
    let columns = scalars.first().map_or(0, Vec::len);
    let is_double = |column: usize| {
        let mut all = layers.iter().zip(&scalars);
        !all.all(|(layer, scalars)| scalars[column].is_single(layer.mesh.vertex_count()))
    };
    let doubles: Vec<bool> = (0..columns).map(is_double).collect();
    let with_colors = layers.iter().any(|layer| layer.mesh.colors().is_some());

    write!(
        writer,
        "ply\nformat binary_little_endian 1.0\ncomment {}\n",
        export.scene.generator
    )?;
    for line in comment_lines(&export.scene.copyright().unwrap_or_default()) {
        writeln!(writer, "comment copyright {line}")?;
    }
    if let Some(seal) = seal {
        writeln!(writer, "comment {}", seal.text())?;
    }
    write!(
        writer,
        "element vertex {vertices}\n\
         property double x\nproperty double y\nproperty double z\n",
    )?;
    let with_normals = layers.iter().all(|layer| layer.mesh.has_normals());
    if with_normals {
        writer.write_all(b"property float nx\nproperty float ny\nproperty float nz\n")?;
    }
    for (scalar, is_double) in scalars.first().into_iter().flatten().zip(&doubles) {
        let kind = if *is_double { "double" } else { "float" };
        writeln!(writer, "property {kind} {}", property(scalar))?;
    }
    if with_colors {
        writer.write_all(
            b"property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n",
        )?;
    }
    write!(
        writer,
        "element face {triangles}\nproperty list uchar uint vertex_indices\nend_header\n"
    )?;

    for (layer, scalars) in layers.iter().zip(&scalars) {
        write_vertices(
            &mut writer,
            layer,
            scalars,
            &doubles,
            (with_normals, with_colors),
        )?;
    }
    let mut first = 0u32;
    for layer in &layers {
        let triangles = layer.mesh.shared_triangles();
        for corners in (0..triangles.len()).map(|index| triangles.at(index)) {
            let mut face = [3; 13];
            for (bytes, corner) in face[1..].chunks_exact_mut(4).zip(corners) {
                bytes.copy_from_slice(&(first + corner).to_le_bytes());
            }
            writer.write_all(&face)?;
        }
        first += layer.mesh.vertex_count() as u32;
    }
    Ok(())
}

/// A text in lines that a header may have: some programs read no more than some hundred bytes of one.
fn comment_lines(text: &str) -> Vec<String> {
    const LONGEST: usize = 60;
    let plain = |letter: char| if letter.is_control() { ' ' } else { letter };
    let letters: Vec<char> = text.chars().map(plain).collect();
    letters.chunks(LONGEST).map(String::from_iter).collect()
}

/// MeshLab shows `quality`, and nothing that is called anything else.
fn property<'a>(scalar: &Scalar<'a>) -> &'a str {
    match scalar.name {
        "doppler" => "quality",
        other => other,
    }
}

/// Refuses what the file cannot hold.
///
/// # Errors
///
/// No triangles, or a place that is not a number.
pub(super) fn check_positions(name: &str, mesh: &Mesh) -> Result<(), WriteError> {
    let name = || name.to_owned();
    if mesh.triangle_count() == 0 {
        return Err(WriteError::Empty(name()));
    }
    if mesh.is_finite() {
        return Ok(());
    }
    let vertex = mesh.positions().iter().position(|p| !p.is_finite());
    Err(WriteError::Overflow {
        name: name(),
        vertex: vertex.expect("one of them is not finite"),
    })
}

fn write_vertices(
    writer: &mut impl Write,
    layer: &Layer<'_>,
    scalars: &[Scalar<'_>],
    doubles: &[bool],
    (with_normals, with_colors): (bool, bool),
) -> Result<(), WriteError> {
    let mesh = layer.mesh;
    let mut positions = [DVec3::ZERO; VERTICES_AT_ONCE];
    let mut normals = [DVec3::ZERO; VERTICES_AT_ONCE];
    for vertex in 0..mesh.vertex_count() {
        let in_piece = vertex % VERTICES_AT_ONCE;
        if in_piece == 0 {
            let count = VERTICES_AT_ONCE.min(mesh.vertex_count() - vertex);
            let normals = with_normals.then_some(&mut normals[..count]);
            mesh.read_vertices(vertex, &mut positions[..count], normals);
        }
        for coordinate in layer.moved(positions[in_piece]).to_array() {
            writer.write_all(&coordinate.to_le_bytes())?;
        }
        if with_normals {
            for value in normals[in_piece].to_array() {
                writer.write_all(&(value as f32).to_le_bytes())?;
            }
        }
        for (scalar, is_double) in scalars.iter().zip(doubles) {
            let value = scalar.at(vertex);
            if *is_double {
                writer.write_all(&value.to_le_bytes())?;
            } else {
                writer.write_all(&(value as f32).to_le_bytes())?;
            }
        }
        if with_colors {
            let color = mesh.colors().map_or(Vec4::ONE, |colors| colors[vertex]);
            writer.write_all(&shown_color(color))?;
        }
    }
    Ok(())
}

/// Red, green, blue and opacity as PLY's readers show them: in sRGB, opacity as it is.
fn shown_color(linear: Vec4) -> [u8; 4] {
    let [red, green, blue] = linear.truncate().to_array().map(byte_of_linear);
    [red, green, blue, (linear.w * 255.0).round() as u8]
}
