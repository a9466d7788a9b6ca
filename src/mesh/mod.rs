//! Triangle meshes at rest: geometry, the attributes that travel with it, and what it is made of.

mod edges;
mod material;
mod part;
mod shape;

pub use material::{AlphaMode, Image, Material, MaterialError, Texture, Wrap};
pub(crate) use material::{clamp_factors, extension_names, map_sources, position, retain_textures};
pub use part::{Model, Part};
pub(crate) use shape::Band;
pub use shape::{
    Appearance, Cells, Color, Cone, Count, Cuboid, Cylinder, Grid, Lattice, Length, Rod, Shape,
    ShapeError, Sphere, Torus,
};

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3, DVec4, Vec2, Vec4};
use thiserror::Error;

use crate::spacetime::unit;

/// A triangle mesh: positions, indexed triangles, and attributes of its vertices.
///
/// Positions, normals and tangents are computed with and held in `f64`; texture coordinates and colours
/// only travel and are held as files have them. Every constructor checks, so that indices are in
/// range, every number is finite and every attribute has one value a vertex. What the photosurface map
/// leaves as it is (triangles, texture coordinates, colours) is shared between a mesh and its images.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Mesh {
    positions: Vec<DVec3>,
    triangles: Arc<[[u32; 3]]>,
    normals: Option<Vec<DVec3>>,
    tangents: Option<Vec<DVec4>>,
    texture_coordinates: Vec<Arc<[Vec2]>>,
    colors: Option<Arc<[Vec4]>>,
}

/// Why data does not make a [`Mesh`].
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MeshError {
    /// More vertices than a `u32` index can tell apart.
    #[error("{0} vertices, expected at most {max}", max = u32::MAX)]
    TooManyVertices(usize),
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle} uses vertex {index}, expected an index below {vertices}")]
    Index {
        /// Which triangle, from 0.
        triangle: usize,
        /// What it says.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// An attribute with too many or too few values.
    #[error("{attribute} has {found} values, expected one for each of {vertices} vertices")]
    Count {
        /// Which attribute.
        attribute: &'static str,
        /// How many values it has.
        found: usize,
        /// How many vertices there are.
        vertices: usize,
    },
    /// NaN or infinity.
    #[error("{attribute} of vertex {vertex} is {value}, expected finite numbers")]
    NotFinite {
        /// Which attribute.
        attribute: &'static str,
        /// Which vertex, from 0.
        vertex: usize,
        /// The offending value.
        value: String,
    },
}

impl Mesh {
    /// A mesh of `triangles` between `positions`, counter-clockwise seen from outside.
    ///
    /// # Errors
    ///
    /// A position that is not finite, an index out of range, too many vertices.
    pub fn new(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        let vertices = positions.len();
        if vertices > u32::MAX as usize {
            return Err(MeshError::TooManyVertices(vertices));
        }
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&index) = corners.iter().find(|&&index| index as usize >= vertices) {
                return Err(MeshError::Index {
                    triangle,
                    index,
                    vertices,
                });
            }
        }
        check("POSITION", &positions, vertices, |p| p.is_finite())?;
        Ok(Self {
            positions,
            triangles: triangles.into(),
            ..Self::default()
        })
    }

    /// With one normal a vertex; they are brought to unit length, zero ones stay zero.
    ///
    /// # Errors
    ///
    /// A wrong count or a value that is not finite.
    pub fn with_normals(mut self, normals: Vec<DVec3>) -> Result<Self, MeshError> {
        check("NORMAL", &normals, self.positions.len(), |n| n.is_finite())?;
        self.normals = Some(normals.into_iter().map(unit_or_zero).collect());
        Ok(self)
    }

    /// With one tangent a vertex: direction, brought to unit length, and the sign of the bitangent.
    ///
    /// # Errors
    ///
    /// A wrong count or a value that is not finite.
    pub fn with_tangents(mut self, tangents: Vec<DVec4>) -> Result<Self, MeshError> {
        check("TANGENT", &tangents, self.positions.len(), |t| {
            t.is_finite()
        })?;
        let tangents = tangents.into_iter();
        self.tangents = Some(
            tangents
                .map(|t| unit_or_zero(t.truncate()).extend(if t.w < 0.0 { -1.0 } else { 1.0 }))
                .collect(),
        );
        Ok(self)
    }

    /// With one more set of texture coordinates, the next `TEXCOORD_n`.
    ///
    /// # Errors
    ///
    /// A wrong count or a value that is not finite.
    pub fn with_texture_coordinates(mut self, coordinates: Vec<Vec2>) -> Result<Self, MeshError> {
        check("TEXCOORD", &coordinates, self.positions.len(), |c| {
            c.is_finite()
        })?;
        self.texture_coordinates.push(coordinates.into());
        Ok(self)
    }

    /// With one colour a vertex: linear red, green, blue and opacity, each from 0 to 1.
    ///
    /// # Errors
    ///
    /// A wrong count or a value that is not finite.
    pub fn with_colors(mut self, colors: Vec<Vec4>) -> Result<Self, MeshError> {
        check("COLOR_0", &colors, self.positions.len(), |c| c.is_finite())?;
        self.colors = Some(colors.into());
        Ok(self)
    }

    /// Places of the vertices.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// Corners of the triangles, counter-clockwise seen from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Unit normals, or zero where the source has none that means anything.
    pub fn normals(&self) -> Option<&[DVec3]> {
        self.normals.as_deref()
    }

    /// Unit tangents with the sign of the bitangent.
    pub fn tangents(&self) -> Option<&[DVec4]> {
        self.tangents.as_deref()
    }

    /// All sets of texture coordinates.
    pub fn texture_coordinates(&self) -> &[Arc<[Vec2]>] {
        &self.texture_coordinates
    }

    /// The triangles as all meshes share them that differ in geometry alone.
    pub(crate) fn shared_triangles(&self) -> &Arc<[[u32; 3]]> {
        &self.triangles
    }

    /// The colours, likewise.
    pub(crate) fn shared_colors(&self) -> Option<&Arc<[Vec4]>> {
        self.colors.as_ref()
    }

    /// Linear colours.
    pub fn colors(&self) -> Option<&[Vec4]> {
        self.colors.as_deref()
    }

    /// The smallest and the largest corner of the box around the vertices; `None` without vertices.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let first = *self.positions.first()?;
        Some(
            self.positions
                .iter()
                .fold((first, first), |(low, high), &p| (low.min(p), high.max(p))),
        )
    }

    /// The mesh moved, turned, scaled or mirrored; mirrored triangles keep their outside.
    #[must_use]
    pub fn transformed(mut self, transform: &DAffine3) -> Self {
        let linear = transform.matrix3;
        // The cofactor matrix is the inverse transpose up to a factor, and exists for singular ones too.
        let cofactor = DMat3::from_cols(
            linear.y_axis.cross(linear.z_axis),
            linear.z_axis.cross(linear.x_axis),
            linear.x_axis.cross(linear.y_axis),
        );
        let mirror = linear.determinant() < 0.0;
        let sign = if mirror { -1.0 } else { 1.0 };
        for position in &mut self.positions {
            *position = transform.transform_point3(*position);
        }
        for normal in self.normals.iter_mut().flatten() {
            *normal = unit_or_zero(cofactor * *normal * sign);
        }
        for tangent in self.tangents.iter_mut().flatten() {
            *tangent = unit_or_zero(linear * tangent.truncate()).extend(tangent.w * sign);
        }
        if mirror {
            for corners in Arc::make_mut(&mut self.triangles) {
                corners.swap(1, 2);
            }
        }
        self
    }

    /// A mesh of data that is known to fit: indices in range, one value a vertex, all finite.
    pub(crate) fn from_parts(
        positions: Vec<DVec3>,
        triangles: Vec<[u32; 3]>,
        normals: Option<Vec<DVec3>>,
        tangents: Option<Vec<DVec4>>,
        texture_coordinates: Vec<Vec<Vec2>>,
        colors: Option<Vec<Vec4>>,
    ) -> Self {
        debug_assert!(
            triangles
                .iter()
                .flatten()
                .all(|&index| (index as usize) < positions.len())
        );
        Self {
            positions,
            triangles: triangles.into(),
            normals,
            tangents,
            texture_coordinates: texture_coordinates.into_iter().map(Into::into).collect(),
            colors: colors.map(Into::into),
        }
    }

    /// The same mesh with other geometry; `positions` and the rest have one value a vertex, as before.
    pub(crate) fn with_geometry(
        &self,
        positions: Vec<DVec3>,
        normals: Option<Vec<DVec3>>,
        tangents: Option<Vec<DVec4>>,
    ) -> Self {
        debug_assert_eq!(positions.len(), self.positions.len());
        Self {
            positions,
            triangles: self.triangles.clone(),
            normals,
            tangents,
            texture_coordinates: self.texture_coordinates.clone(),
            colors: self.colors.clone(),
        }
    }

    /// The mesh with the normals of its flat triangles, each with three vertices of its own: what
    /// glTF asks for where a source has no normals. Vertices in no triangle vanish.
    ///
    /// # Errors
    ///
    /// More corners than a `u32` index can tell apart.
    pub fn with_flat_normals(self) -> Result<Self, MeshError> {
        let corners: Vec<usize> = self
            .triangles
            .iter()
            .flatten()
            .map(|&i| i as usize)
            .collect();
        if corners.len() > u32::MAX as usize {
            return Err(MeshError::TooManyVertices(corners.len()));
        }
        let normals = self.triangles.iter().flat_map(|&[a, b, c]| {
            let [a, b, c] = [a, b, c].map(|index| self.positions[index as usize]);
            // A triangle without area has no normal; any unit vector keeps files valid.
            [unit((b - a).cross(c - a)).unwrap_or(DVec3::Y); 3]
        });
        Ok(Self {
            normals: Some(normals.collect()),
            positions: pick(&self.positions, &corners),
            triangles: (0..corners.len() as u32 / 3)
                .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
                .collect(),
            tangents: self.tangents.map(|tangents| pick(&tangents, &corners)),
            texture_coordinates: self
                .texture_coordinates
                .iter()
                .map(|set| pick(set, &corners).into())
                .collect(),
            colors: self.colors.map(|colors| pick(&colors, &corners).into()),
        })
    }
}

fn pick<T: Copy>(values: &[T], indices: &[usize]) -> Vec<T> {
    indices.iter().map(|&index| values[index]).collect()
}

fn unit_or_zero(vector: DVec3) -> DVec3 {
    unit(vector).unwrap_or(DVec3::ZERO)
}

fn check<T: std::fmt::Display>(
    attribute: &'static str,
    values: &[T],
    vertices: usize,
    is_finite: impl Fn(&T) -> bool,
) -> Result<(), MeshError> {
    if values.len() != vertices {
        return Err(MeshError::Count {
            attribute,
            found: values.len(),
            vertices,
        });
    }
    match values.iter().position(|value| !is_finite(value)) {
        Some(vertex) => Err(MeshError::NotFinite {
            attribute,
            vertex,
            value: values[vertex].to_string(),
        }),
        None => Ok(()),
    }
}
