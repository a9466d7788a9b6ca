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

use std::sync::{Arc, OnceLock};

use glam::{DAffine3, DMat3, DVec3, DVec4, Vec2, Vec4};
use rayon::prelude::*;
use thiserror::Error;

use crate::spacetime::unit;

/// A triangle mesh: positions, indexed triangles, and attributes of its vertices.
///
/// Positions, normals and tangents are computed with and held in `f64`; texture coordinates and colours
/// only travel and are held as files have them. Every constructor checks, so that indices are in
/// range, every number is finite and every attribute has one value a vertex. A clone shares everything
/// with its original, and a mesh shares with its images what the map leaves as it is: of a
/// photosurface triangles, texture coordinates and colours.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Mesh {
    positions: Arc<Vec<DVec3>>,
    triangles: Arc<Vec<[u32; 3]>>,
    normals: Option<Arc<Vec<DVec3>>>,
    tangents: Option<Arc<Vec<DVec4>>>,
    texture_coordinates: Vec<Arc<Vec<Vec2>>>,
    colors: Option<Arc<Vec<Vec4>>>,
    /// Of the positions, once someone has asked.
    bounds: Remembered<Option<(DVec3, DVec3)>>,
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
        let is_wrong = |corners: &[u32; 3]| corners.iter().any(|&i| i as usize >= vertices);
        let jobs = triangles.par_iter().with_min_len(VALUES_PER_JOB);
        if let Some(triangle) = jobs.position_first(is_wrong) {
            let corners = triangles[triangle];
            let index = corners.into_iter().find(|&i| i as usize >= vertices);
            return Err(MeshError::Index {
                triangle,
                index: index.expect("one of them is"),
                vertices,
            });
        }
        check("POSITION", &positions, vertices, |p| p.is_finite())?;
        Ok(Self {
            positions: positions.into(),
            triangles: triangles.into(),
            ..Self::default()
        })
    }

    /// With one normal a vertex; they are brought to unit length, zero ones stay zero.
    ///
    /// # Errors
    ///
    /// A wrong count or a value that is not finite.
    pub fn with_normals(mut self, mut normals: Vec<DVec3>) -> Result<Self, MeshError> {
        check("NORMAL", &normals, self.positions.len(), |n| n.is_finite())?;
        change(&mut normals, unit_or_zero);
        self.normals = Some(normals.into());
        Ok(self)
    }

    /// With one tangent a vertex: direction, brought to unit length, and the sign of the bitangent.
    ///
    /// # Errors
    ///
    /// A wrong count or a value that is not finite.
    pub fn with_tangents(mut self, mut tangents: Vec<DVec4>) -> Result<Self, MeshError> {
        check("TANGENT", &tangents, self.positions.len(), |t| {
            t.is_finite()
        })?;
        change(&mut tangents, |t| {
            unit_or_zero(t.truncate()).extend(if t.w < 0.0 { -1.0 } else { 1.0 })
        });
        self.tangents = Some(tangents.into());
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
        self.normals.as_deref().map(Vec::as_slice)
    }

    /// Unit tangents with the sign of the bitangent.
    pub fn tangents(&self) -> Option<&[DVec4]> {
        self.tangents.as_deref().map(Vec::as_slice)
    }

    /// All sets of texture coordinates.
    pub fn texture_coordinates(&self) -> &[Arc<Vec<Vec2>>] {
        &self.texture_coordinates
    }

    /// The triangles as all meshes share them that differ in geometry alone.
    pub(crate) fn shared_triangles(&self) -> &Arc<Vec<[u32; 3]>> {
        &self.triangles
    }

    /// The colours, likewise.
    pub(crate) fn shared_colors(&self) -> Option<&Arc<Vec<Vec4>>> {
        self.colors.as_ref()
    }

    /// Linear colours.
    pub fn colors(&self) -> Option<&[Vec4]> {
        self.colors.as_deref().map(Vec::as_slice)
    }

    /// The smallest and the largest corner of the box around the vertices; `None` without vertices.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let around = |positions: &[DVec3]| {
            let first = positions[0];
            let corners = positions
                .iter()
                .fold((first, first), |(low, high), &p| (low.min(p), high.max(p)));
            corners
        };
        *self.bounds.0.get_or_init(|| {
            // The same jobs for any number of threads, for which of 0 and -0 is less depends on their order.
            let jobs = self.positions.par_chunks(VALUES_PER_JOB).map(around);
            let boxes: Vec<_> = jobs.collect();
            boxes
                .into_iter()
                .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
        })
    }

    /// Whether all vertices are somewhere, which only a transform can change.
    pub(crate) fn is_finite(&self) -> bool {
        let jobs = self.positions.par_iter().with_min_len(VALUES_PER_JOB);
        jobs.all(|position| position.is_finite())
    }

    /// The mesh moved, turned, scaled or mirrored; mirrored triangles keep their outside.
    #[must_use]
    pub fn transformed(mut self, transform: &DAffine3) -> Self {
        if *transform == DAffine3::IDENTITY {
            return self;
        }
        self.bounds = Remembered::default();
        change_shared(&mut self.positions, |position| {
            transform.transform_point3(position)
        });
        let linear = transform.matrix3;
        if linear == DMat3::IDENTITY {
            return self;
        }
        // The cofactor matrix is the inverse transpose up to a factor, and exists for singular ones too.
        let cofactor = DMat3::from_cols(
            linear.y_axis.cross(linear.z_axis),
            linear.z_axis.cross(linear.x_axis),
            linear.x_axis.cross(linear.y_axis),
        );
        let mirror = linear.determinant() < 0.0;
        let sign = if mirror { -1.0 } else { 1.0 };
        if let Some(normals) = &mut self.normals {
            change_shared(normals, |normal| unit_or_zero(cofactor * normal * sign));
        }
        if let Some(tangents) = &mut self.tangents {
            change_shared(tangents, |tangent| {
                unit_or_zero(linear * tangent.truncate()).extend(tangent.w * sign)
            });
        }
        if mirror {
            change_shared(&mut self.triangles, |[a, b, c]| [a, c, b]);
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
            positions: positions.into(),
            triangles: triangles.into(),
            normals: normals.map(Into::into),
            tangents: tangents.map(Into::into),
            texture_coordinates: texture_coordinates.into_iter().map(Into::into).collect(),
            colors: colors.map(Into::into),
            bounds: Remembered::default(),
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
            positions: positions.into(),
            triangles: self.triangles.clone(),
            normals: normals.map(Into::into),
            tangents: tangents.map(Into::into),
            texture_coordinates: self.texture_coordinates.clone(),
            colors: self.colors.clone(),
            bounds: Remembered::default(),
        }
    }

    /// The mesh with the normals of its flat triangles, each with three vertices of its own: what
    /// glTF asks for where a source has no normals. Vertices in no triangle vanish.
    ///
    /// # Errors
    ///
    /// More corners than a `u32` index can tell apart.
    pub fn with_flat_normals(self) -> Result<Self, MeshError> {
        let corners = self.triangles.as_flattened();
        if corners.len() > u32::MAX as usize {
            return Err(MeshError::TooManyVertices(corners.len()));
        }
        let jobs = self.triangles.par_iter().with_min_len(VALUES_PER_JOB);
        let normals = jobs.map(|&[a, b, c]| {
            let [a, b, c] = [a, b, c].map(|index| self.positions[index as usize]);
            // A triangle without area has no normal; any unit vector keeps files valid.
            [unit((b - a).cross(c - a)).unwrap_or(DVec3::Y); 3]
        });
        let normals: Vec<[DVec3; 3]> = normals.collect();
        let new_triangles = (0..corners.len() as u32 / 3).into_par_iter();
        Ok(Self {
            normals: Some(normals.into_flattened().into()),
            positions: pick(&self.positions, corners),
            triangles: new_triangles
                .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
                .collect::<Vec<_>>()
                .into(),
            tangents: self
                .tangents
                .as_ref()
                .map(|tangents| pick(tangents, corners)),
            texture_coordinates: self
                .texture_coordinates
                .iter()
                .map(|set| pick(set, corners))
                .collect(),
            colors: self.colors.as_ref().map(|colors| pick(colors, corners)),
            bounds: Remembered::default(),
        })
    }
}

/// Something known of a mesh that is no part of what it is: all are alike.
#[derive(Clone, Debug, Default)]
struct Remembered<T>(OnceLock<T>);

impl<T> PartialEq for Remembered<T> {
    fn eq(&self, _other: &Self) -> bool {
        true
    }
}

/// Values a thread takes at a time: enough to outweigh handing them over.
const VALUES_PER_JOB: usize = 4096;

fn pick<T: Copy + Send + Sync>(values: &[T], indices: &[u32]) -> Arc<Vec<T>> {
    let jobs = indices.par_iter().with_min_len(VALUES_PER_JOB);
    let picked: Vec<T> = jobs.map(|&index| values[index as usize]).collect();
    picked.into()
}

/// Makes something else of every value.
fn change<T: Copy + Send + Sync>(values: &mut [T], new: impl Fn(T) -> T + Sync) {
    let jobs = values.par_iter_mut().with_min_len(VALUES_PER_JOB);
    jobs.for_each(|value| *value = new(*value));
}

/// Makes something else of every value; those who share the values keep them as they are.
fn change_shared<T: Copy + Send + Sync>(values: &mut Arc<Vec<T>>, new: impl Fn(T) -> T + Sync) {
    match Arc::get_mut(values) {
        Some(values) => change(values, new),
        None => {
            let jobs = values.par_iter().with_min_len(VALUES_PER_JOB);
            let changed: Vec<T> = jobs.map(|&value| new(value)).collect();
            *values = changed.into();
        }
    }
}

/// A vector brought to unit length, or zero where there is none.
///
/// Where nothing overflows and nothing is lost below the smallest numbers, a square root and divisions are as good
/// as the detour by powers of two.
pub(crate) fn unit_or_zero(vector: DVec3) -> DVec3 {
    const ORDINARY: std::ops::Range<f64> = 1e-100..1e100;
    let square = vector.length_squared();
    match ORDINARY.contains(&square) {
        true => vector / square.sqrt(),
        false => unit(vector).unwrap_or(DVec3::ZERO),
    }
}

fn check<T: std::fmt::Display + Sync>(
    attribute: &'static str,
    values: &[T],
    vertices: usize,
    is_finite: impl Fn(&T) -> bool + Sync,
) -> Result<(), MeshError> {
    if values.len() != vertices {
        return Err(MeshError::Count {
            attribute,
            found: values.len(),
            vertices,
        });
    }
    let jobs = values.par_iter().with_min_len(VALUES_PER_JOB);
    match jobs.position_first(|value| !is_finite(value)) {
        Some(vertex) => Err(MeshError::NotFinite {
            attribute,
            vertex,
            value: values[vertex].to_string(),
        }),
        None => Ok(()),
    }
}
