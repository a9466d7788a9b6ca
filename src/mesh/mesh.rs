//! A triangle mesh at rest, checked wherever it comes from.

use std::any::Any;
use std::sync::{Arc, OnceLock};

use glam::{DAffine3, DMat3, DVec3, DVec4, Vec2, Vec4};
use rayon::prelude::*;

use super::check::{MeshError, check, check_triangles};
use super::extent::Extent;
use super::triangles::Triangles;
use super::values::{VALUES_PER_JOB, change, change_shared, flattened, unit_or_zero};
use super::vectors::{Places, Vectors};
use super::vertices::{Compute, VERTICES_AT_ONCE, Vertices};

/// A triangle mesh: positions, indexed triangles, and attributes of its vertices.
///
/// Positions, normals and tangents are computed with in `f64`; what a file has in `f32` is held like that until someone asks
/// for a slice of it, and of a large mesh flat facets and the geometry of a photosurface are held by nobody until then. Texture
/// coordinates and colours only travel and are held as files have them. Every constructor checks, so that indices are in
/// range, every number is finite and every attribute has one value a vertex. A clone shares everything
/// with its original, and a mesh shares with its images what the map leaves as it is: of a
/// photosurface triangles, texture coordinates and colours.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    vertices: Vertices,
    triangles: Arc<Triangles>,
    tangents: Option<Arc<Vec<DVec4>>>,
    texture_coordinates: Vec<Arc<Vec<Vec2>>>,
    colors: Option<Arc<Vec<Vec4>>>,
    /// Of the positions, once someone has asked.
    extent: Remembered<Option<Extent>>,
    /// A value that determines positions and triangles, as long as they are as it made them.
    maker: Remembered<Arc<dyn Any + Send + Sync>>,
}

impl Mesh {
    /// A mesh of `triangles` between `positions`, counter-clockwise seen from outside.
    ///
    /// # Errors
    ///
    /// A position that is not finite, an index out of range, too many vertices.
    pub fn new(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        let vertices = positions.len();
        check_triangles(&triangles, vertices)?;
        check("POSITION", &positions, vertices, |p| p.is_finite())?;
        Ok(Self {
            vertices: Vertices::held(positions, None),
            triangles: Arc::new(triangles.into()),
            ..Self::default()
        })
    }

    /// With one normal a vertex; they are brought to unit length, zero ones stay zero.
    ///
    /// # Errors
    ///
    /// A wrong count or a value that is not finite.
    pub fn with_normals(mut self, mut normals: Vec<DVec3>) -> Result<Self, MeshError> {
        check("NORMAL", &normals, self.vertex_count(), |n| n.is_finite())?;
        change(&mut normals, unit_or_zero);
        let (positions, _) = self.vertices.into_held();
        let normals = Some(Arc::new(normals.into()));
        self.vertices = Vertices::Held { positions, normals };
        Ok(self)
    }

    /// With one tangent a vertex: direction, brought to unit length, and the sign of the bitangent.
    ///
    /// # Errors
    ///
    /// A wrong count or a value that is not finite.
    pub fn with_tangents(mut self, mut tangents: Vec<DVec4>) -> Result<Self, MeshError> {
        check("TANGENT", &tangents, self.vertex_count(), |t| t.is_finite())?;
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
        check("TEXCOORD", &coordinates, self.vertex_count(), |c| {
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
        check("COLOR_0", &colors, self.vertex_count(), |c| c.is_finite())?;
        self.colors = Some(colors.into());
        Ok(self)
    }

    /// Places of the vertices.
    pub fn positions(&self) -> &[DVec3] {
        self.vertices.positions()
    }

    /// How many vertices there are, which takes no room for their places.
    pub fn vertex_count(&self) -> usize {
        self.vertices.len()
    }

    /// Corners of the triangles, counter-clockwise seen from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        self.triangles.as_slice()
    }

    /// How many triangles there are, which takes no room for their corners.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Unit normals, or zero where the source has none that means anything.
    pub fn normals(&self) -> Option<&[DVec3]> {
        self.vertices.normals()
    }

    /// Whether there are normals, which takes no room for them.
    pub fn has_normals(&self) -> bool {
        self.vertices.has_normals()
    }

    /// Writes the positions of the vertices from number `first` on, and their normals if these are asked for and there are
    /// any. `first` is a multiple of [`VERTICES_AT_ONCE`].
    pub(crate) fn read_vertices(
        &self,
        first: usize,
        positions: &mut [DVec3],
        normals: Option<&mut [DVec3]>,
    ) {
        debug_assert!(first.is_multiple_of(VERTICES_AT_ONCE));
        self.vertices.read(first, positions, normals);
    }

    /// The places of vertices, and triangles between them: triangle by triangle they have the same corners as the mesh, though
    /// they may share vertices that it has for each triangle.
    pub(crate) fn facets(&self) -> (Places<'_>, &[[u32; 3]]) {
        match self.vertices.facets() {
            Some((places, triangles)) => (places, triangles.as_slice()),
            None => (self.vertices.places(), self.triangles()),
        }
    }

    /// Something of the position of every vertex.
    pub(crate) fn of_each_position<T: Copy + Default + Send>(
        &self,
        value: impl Fn(DVec3) -> T + Sync,
    ) -> Vec<T> {
        let count = self.vertex_count();
        let jobs = (0..count.div_ceil(VERTICES_AT_ONCE)).into_par_iter();
        // Arrays have a known place in the result, so that all threads write to it directly.
        let arrays = jobs.map(|job| {
            let first = job * VERTICES_AT_ONCE;
            let mut places = [DVec3::ZERO; VERTICES_AT_ONCE];
            let mut values = [T::default(); VERTICES_AT_ONCE];
            let places = &mut places[..VERTICES_AT_ONCE.min(count - first)];
            self.vertices.read(first, places, None);
            for (to, &place) in values.iter_mut().zip(&*places) {
                *to = value(place);
            }
            values
        });
        flattened(arrays.collect(), count)
    }

    /// The places of the vertices, for whoever reads single ones.
    pub(crate) fn places(&self) -> Places<'_> {
        self.vertices.places()
    }

    /// Unit tangents with the sign of the bitangent.
    pub fn tangents(&self) -> Option<&[DVec4]> {
        self.tangents.as_deref().map(Vec::as_slice)
    }

    /// All sets of texture coordinates.
    pub fn texture_coordinates(&self) -> &[Arc<Vec<Vec2>>] {
        &self.texture_coordinates
    }

    /// The positions as they are held.
    pub(super) fn shared_positions(&self) -> Arc<Vectors> {
        self.vertices.clone().into_held().0
    }

    /// The positions of the corners of one triangle.
    pub(crate) fn corners_of(&self, triangle: usize) -> [DVec3; 3] {
        let (places, triangles) = self.facets();
        triangles[triangle].map(|corner| places.at(corner))
    }

    /// The triangles as all meshes share them that differ in geometry alone.
    pub(crate) fn shared_triangles(&self) -> &Arc<Triangles> {
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
        self.extent().map(|extent| (extent.low, extent.high))
    }

    /// Whether all vertices are somewhere, which only a transform can change.
    pub(crate) fn is_finite(&self) -> bool {
        self.extent().is_none_or(|extent| extent.is_finite)
    }

    /// The mesh with the value that its positions and triangles were made from, for a comparison without making them again.
    /// The mesh forgets the value as soon as either changes.
    pub(crate) fn made_by(self, maker: impl Any + Send + Sync) -> Self {
        let maker: Arc<dyn Any + Send + Sync> = Arc::new(maker);
        Self {
            maker: Remembered(OnceLock::from(maker)),
            ..self
        }
    }

    /// The value that positions and triangles were made from, if one of this type is known.
    pub(crate) fn maker<T: Any>(&self) -> Option<&T> {
        self.maker.0.get()?.downcast_ref()
    }

    fn extent(&self) -> Option<Extent> {
        if let Some(extent) = self.extent.0.get() {
            return *extent;
        }
        // Not while the lock is held: a thread that waits for others in here may take up work that asks too. The same jobs
        // for any number of threads, for which of 0 and -0 is less depends on their order.
        let jobs = (0..self.vertex_count().div_ceil(VALUES_PER_JOB)).into_par_iter();
        let extents: Vec<Option<Extent>> = jobs.map(|job| self.extent_of_job(job)).collect();
        let extent = extents.into_iter().flatten().reduce(Extent::with);
        *self.extent.0.get_or_init(|| extent)
    }

    fn extent_of_job(&self, job: usize) -> Option<Extent> {
        let first = job * VALUES_PER_JOB;
        let end = self.vertex_count().min(first + VALUES_PER_JOB);
        if let Some(extent) = self.vertices.extent_at_once(first..end) {
            return Some(extent);
        }
        let mut places = [DVec3::ZERO; VERTICES_AT_ONCE];
        (first..end)
            .step_by(VERTICES_AT_ONCE)
            .fold(None, |extent, first| {
                let places = &mut places[..VERTICES_AT_ONCE.min(end - first)];
                self.vertices.read(first, places, None);
                Extent::around(extent, places)
            })
    }

    /// Which data the mesh holds: two meshes of one identity share all of them, as long as both are there.
    pub(crate) fn identity(&self) -> MeshIdentity {
        let [positions, normals] = self.vertices.addresses();
        let address = |data: Option<*const ()>| data.map_or(0, |data| data as usize);
        let mut data = vec![positions, normals, Arc::as_ptr(&self.triangles) as usize];
        data.push(address(
            self.tangents.as_ref().map(|data| Arc::as_ptr(data).cast()),
        ));
        data.push(address(
            self.colors.as_ref().map(|data| Arc::as_ptr(data).cast()),
        ));
        data.extend(
            self.texture_coordinates
                .iter()
                .map(|set| Arc::as_ptr(set) as usize),
        );
        MeshIdentity(data)
    }

    /// The mesh without places on textures, and without the tangents that these make.
    pub(crate) fn without_texture_coordinates(self) -> Self {
        Self {
            texture_coordinates: vec![],
            tangents: None,
            ..self
        }
    }

    /// The mesh moved, turned, scaled or mirrored; mirrored triangles keep their outside.
    ///
    /// A transform that is not finite, or that takes a vertex beyond `f64`, makes a mesh with vertices that are not finite:
    /// [`PlacedScene::new`](crate::PlacedScene::new) and the writers of files refuse it, pictures show nothing there.
    #[must_use]
    pub fn transformed(mut self, transform: &DAffine3) -> Self {
        if *transform == DAffine3::IDENTITY {
            return self;
        }
        self.extent = Remembered::default();
        self.maker = Remembered::default();
        let (mut positions, mut normals) = self.vertices.into_held();
        positions.placed(transform);
        let linear = transform.matrix3;
        if linear == DMat3::IDENTITY {
            self.vertices = Vertices::Held { positions, normals };
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
        if let Some(normals) = &mut normals {
            normals.changed(|normal| unit_or_zero(cofactor * normal * sign));
        }
        if let Some(tangents) = &mut self.tangents {
            change_shared(tangents, |tangent| {
                unit_or_zero(linear * tangent.truncate()).extend(tangent.w * sign)
            });
        }
        if mirror {
            let turned = |&[a, b, c]: &[u32; 3]| [a, c, b];
            let jobs = self.triangles.as_slice().par_iter();
            let jobs = jobs.with_min_len(VALUES_PER_JOB);
            self.triangles = Arc::new(Triangles::Listed(jobs.map(turned).collect()));
        }
        self.vertices = Vertices::Held { positions, normals };
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
        Self {
            tangents: tangents.map(Into::into),
            ..Self::from_vectors(
                positions.into(),
                triangles,
                normals.map(Into::into),
                texture_coordinates,
                colors,
            )
        }
    }

    /// The same of vectors of any precision, without tangents.
    pub(crate) fn from_vectors(
        positions: Vectors,
        triangles: Vec<[u32; 3]>,
        normals: Option<Vectors>,
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
            vertices: Vertices::held(positions, normals),
            triangles: Arc::new(triangles.into()),
            texture_coordinates: texture_coordinates.into_iter().map(Into::into).collect(),
            colors: colors.map(Into::into),
            ..Self::default()
        }
    }

    /// A mesh of data that are known to fit, shared or not.
    pub(super) fn from_shared(
        vertices: Vertices,
        triangles: Triangles,
        tangents: Option<Arc<Vec<DVec4>>>,
        texture_coordinates: Vec<Arc<Vec<Vec2>>>,
        colors: Option<Arc<Vec<Vec4>>>,
    ) -> Self {
        Self {
            vertices,
            triangles: Arc::new(triangles),
            tangents,
            texture_coordinates,
            colors,
            ..Self::default()
        }
    }

    /// The same mesh with other geometry; `positions` and the rest have one value a vertex, as before.
    pub(crate) fn with_geometry(
        &self,
        positions: Vec<DVec3>,
        normals: Option<Vec<DVec3>>,
        tangents: Option<Vec<DVec4>>,
    ) -> Self {
        debug_assert_eq!(positions.len(), self.vertex_count());
        let vertices = Vertices::held(positions, normals.map(Into::into));
        self.with_vertices(vertices, tangents, None)
    }

    /// The image of the mesh, whose vertices `compute` makes, with a normal for each of the mesh. Its positions are within
    /// `extent`.
    pub(crate) fn image(
        &self,
        compute: Box<Compute>,
        tangents: Option<Vec<DVec4>>,
        extent: Option<Extent>,
    ) -> Self {
        let vertices = Vertices::image(self.vertex_count(), self.has_normals(), compute);
        self.with_vertices(vertices, tangents, extent)
    }

    fn with_vertices(
        &self,
        vertices: Vertices,
        tangents: Option<Vec<DVec4>>,
        extent: Option<Extent>,
    ) -> Self {
        let remembered = extent.map_or_else(OnceLock::new, |extent| OnceLock::from(Some(extent)));
        Self {
            vertices,
            triangles: self.triangles.clone(),
            tangents: tangents.map(Into::into),
            texture_coordinates: self.texture_coordinates.clone(),
            colors: self.colors.clone(),
            extent: Remembered(remembered),
            maker: Remembered::default(),
        }
    }

    /// The mesh without normals and without the tangents that belong to them.
    #[must_use]
    pub fn without_normals(self) -> Self {
        if !self.has_normals() && self.tangents.is_none() {
            return self;
        }
        let (positions, _) = self.vertices.into_held();
        Self {
            vertices: Vertices::Held {
                positions,
                normals: None,
            },
            tangents: None,
            maker: Remembered::default(),
            ..self
        }
    }
}

/// Two meshes are the same if all numbers of both are, wherever these come from.
impl PartialEq for Mesh {
    fn eq(&self, other: &Self) -> bool {
        self.triangles == other.triangles
            && self.tangents == other.tangents
            && self.texture_coordinates == other.texture_coordinates
            && self.colors == other.colors
            && self.positions() == other.positions()
            && self.normals() == other.normals()
    }
}

/// The addresses of the data that a mesh shares with its clones.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct MeshIdentity(Vec<usize>);

/// Something known of a mesh that is no part of what it is.
#[derive(Clone, Debug)]
struct Remembered<T>(OnceLock<T>);

impl<T> Default for Remembered<T> {
    fn default() -> Self {
        Self(OnceLock::new())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet() -> Mesh {
        let position = |i: u32| DVec3::new((f64::from(i) * 0.37).sin(), f64::from(i), 1.0);
        let positions: Vec<DVec3> = (0..10_000).map(position).collect();
        let normals = positions.clone();
        let triangles = (0..9_998).map(|i| [i, i + 1, i + 2]).collect();
        let mesh = Mesh::new(positions, triangles).unwrap();
        mesh.with_normals(normals).unwrap()
    }

    #[test]
    fn bounds_are_those_of_all_vertices() {
        let mesh = sheet();
        let first = mesh.positions()[0];
        let fold = |corner: fn(DVec3, DVec3) -> DVec3| {
            let positions = mesh.positions().iter().copied();
            positions.fold(first, corner)
        };
        let expected = Some((fold(DVec3::min), fold(DVec3::max)));
        assert_eq!(mesh.bounds(), expected);
        let moved = mesh.transformed(&DAffine3::from_translation(DVec3::X));
        let corners = expected.map(|(low, high)| (low + DVec3::X, high + DVec3::X));
        assert_eq!(moved.bounds(), corners);
        assert_eq!(Mesh::default().bounds(), None);
    }

    #[test]
    fn what_is_moved_leaves_its_original_where_it_is() {
        let original = sheet();
        let turn = DAffine3::from_rotation_z(0.3);
        let mirror = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        for transform in [turn, mirror, DAffine3::from_translation(DVec3::Y)] {
            let copy = original.clone();
            assert_eq!(original.positions().as_ptr(), copy.positions().as_ptr());
            let moved = copy.transformed(&transform);
            assert_eq!(original, sheet());
            // The same as of a mesh that nobody shares.
            assert_eq!(moved, sheet().transformed(&transform));
            assert_eq!(
                moved.positions()[77],
                transform.transform_point3(original.positions()[77])
            );
        }
        let same = original.clone().transformed(&DAffine3::IDENTITY);
        assert_eq!(original.positions().as_ptr(), same.positions().as_ptr());
    }

    #[test]
    fn a_vertex_that_a_transform_makes_nothing_of_is_noticed() {
        let far = Mesh::new(vec![DVec3::ZERO, DVec3::splat(1e300)], vec![]).unwrap();
        assert!(far.is_finite());
        let mut transform = DAffine3::from_scale(DVec3::new(1.0, 1e300, 1.0));
        transform.matrix3.x_axis.y = -1e300;
        // Infinity less infinity, which bounds need not show.
        assert!(!far.transformed(&transform).is_finite());
    }
}
