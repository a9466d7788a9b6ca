//! Why a file cannot be read.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::EXPECTED_MODEL;
use super::text::shown;
use crate::material::MaterialError;
use crate::mesh::MeshError;

/// Why a file does not give a model.
///
/// Places inside a glTF file are written as the path to them in its JSON, with names where there are some.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReadError {
    /// A name that says nothing about the content, and content that does not either.
    #[error("unknown kind of file {extension:?}, expected {EXPECTED_MODEL}")]
    UnknownExtension {
        /// What the name ends in; empty where it has no extension.
        extension: String,
    },
    /// The file or one that it refers to is missing or unreadable.
    #[error("cannot read {path:?}")]
    File {
        /// Which file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A file that another names and that is not where such files are read.
    #[error(
        "{path:?} is outside the folder of the file that refers to it, and outside the working directory; \
         --allow-read {folder:?} allows it"
    )]
    OutOfReach {
        /// Which file, as it is named.
        path: PathBuf,
        /// The folder in which it is, once all links are followed.
        folder: PathBuf,
    },
    /// A pipe, a device or a folder.
    #[error("{path:?} is {found}, expected an ordinary file")]
    NotOrdinary {
        /// Which file.
        path: PathBuf,
        /// What it is.
        found: &'static str,
    },
    /// A file that would take too much memory.
    #[error("{path:?} is too long, expected at most {limit} bytes")]
    TooLong {
        /// Which file.
        path: PathBuf,
        /// The limit.
        limit: u64,
    },
    /// Less than a GLB header, or less than it announces.
    #[error("a GLB file of {found} bytes, expected {expected}: it is cut off")]
    GlbLength {
        /// How many bytes there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// A GLB file with wrong chunks.
    #[error("a GLB file with wrong chunks, expected one of JSON, then one of binary data")]
    Glb(#[source] gltf::Error),
    /// A version of glTF other than 2.
    #[error("glTF of version {found}, expected 2")]
    Version {
        /// What the file says.
        found: String,
    },
    /// Text that is no JSON.
    #[error("not glTF, neither binary nor JSON")]
    Json(#[source] serde_json::Error),
    /// JSON that is no glTF.
    #[error("{place}: not valid glTF")]
    Schema {
        /// Where.
        place: String,
        /// What was found and what was expected there.
        source: serde_json::Error,
    },
    /// JSON whose parts do not fit together.
    #[error("{place}: {problem}")]
    Document {
        /// Where.
        place: String,
        /// What is wrong there.
        problem: DocumentProblem,
    },
    /// The shape is stored in a way that an extension defines.
    #[error("needs the glTF extension {name}, which is not supported; expected plain glTF 2.0")]
    Extension {
        /// Which one.
        name: String,
    },
    /// Numbers that cannot be taken from their buffer.
    #[error("{place}, accessors[{accessor}]: {problem}")]
    Accessor {
        /// What they are for.
        place: String,
        /// Which accessor.
        accessor: usize,
        /// What is wrong with it.
        problem: AccessorProblem,
    },
    /// A reference to another file that cannot be followed.
    #[error("{place}: {problem}")]
    Uri {
        /// Where it stands.
        place: String,
        /// What is wrong with it.
        problem: UriProblem,
    },
    /// A node that is not where it should be.
    #[error("nodes[{node}]{name}: {problem}")]
    Node {
        /// Which one.
        node: usize,
        /// Its name in brackets, or nothing.
        name: String,
        /// What is wrong with it.
        problem: NodeProblem,
    },
    /// Geometry that makes no mesh.
    #[error("{place}: {problem}")]
    Mesh {
        /// Which geometry.
        place: String,
        /// What is wrong with it.
        problem: MeshError,
    },
    /// Properties that make no material.
    #[error("{place}: {problem}")]
    Material {
        /// Which material.
        place: String,
        /// What is wrong with it.
        problem: MaterialError,
    },
    /// A line of an OBJ file.
    #[error("line {line}: {problem}")]
    ObjLine {
        /// Which one, from 1.
        line: usize,
        /// What is wrong with it.
        problem: ObjProblem,
    },
    /// A line of a PLY, STL or OFF file.
    #[error("line {line}: {problem}")]
    Line {
        /// Which one, from 1.
        line: usize,
        /// What is wrong with it.
        problem: DataProblem,
    },
    /// An element of a binary PLY or STL file.
    #[error("{element} {index}: {problem}")]
    Element {
        /// What such elements are called.
        element: String,
        /// Which one, from 0.
        index: u64,
        /// What is wrong with it.
        problem: DataProblem,
    },
    /// A PLY, STL or OFF file as a whole.
    #[error(transparent)]
    Data(DataProblem),
    /// A vertex so far away that computing with it would overflow.
    #[error(
        "{coordinate:e} is a coordinate of vertex {vertex} of part {part:?}, expected at most {limit:e}"
    )]
    TooFar {
        /// Which part.
        part: String,
        /// Which vertex, from 0.
        vertex: usize,
        /// Its largest coordinate.
        coordinate: f64,
        /// The limit.
        limit: f64,
    },
    /// Nothing that has a surface.
    #[error("no triangles, expected at least one; the file has {instead}")]
    NoTriangles {
        /// What there is.
        instead: String,
    },
}

impl ReadError {
    /// The file that its message names, if it names one.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::File { path, .. }
            | Self::OutOfReach { path, .. }
            | Self::NotOrdinary { path, .. }
            | Self::TooLong { path, .. } => Some(path),
            _ => None,
        }
    }

    /// The same of a file that is named otherwise.
    pub(super) fn at(mut self, name: &Path) -> Self {
        if let Self::File { path, .. }
        | Self::OutOfReach { path, .. }
        | Self::NotOrdinary { path, .. }
        | Self::TooLong { path, .. } = &mut self
        {
            name.clone_into(path);
        }
        self
    }
}

/// What is wrong with a part of glTF's JSON.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum DocumentProblem {
    /// A reference to something that is not there.
    #[error("index out of range, expected that of an existing element")]
    OutOfRange,
    /// A value that glTF does not define.
    #[error("not a value that glTF 2.0 defines")]
    Invalid,
    /// Something that has to be there.
    #[error("missing, expected by glTF 2.0")]
    Missing,
    /// A number that this machine cannot address.
    #[error("more bytes than this machine can address")]
    Oversize,
}

/// What is wrong with an accessor, the view it looks through or the buffer behind.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum AccessorProblem {
    /// Numbers of another kind.
    #[error("holds {found}, expected {expected}")]
    Kind {
        /// Type and component type.
        found: String,
        /// Those that would do.
        expected: &'static str,
    },
    /// Another number of elements than there are vertices.
    #[error("has {found} elements, expected {expected}")]
    Count {
        /// How many it has.
        found: usize,
        /// How many it should have.
        expected: usize,
    },
    /// Elements beyond the end of the view.
    #[error("ends at byte {end} of bufferViews[{view}], which has {length}")]
    BeyondView {
        /// First byte behind the elements.
        end: u128,
        /// Which view.
        view: usize,
        /// How many bytes the view has.
        length: usize,
    },
    /// A view beyond the end of the buffer.
    #[error("bufferViews[{view}] ends at byte {end} of buffers[{buffer}], which has {length}")]
    BeyondBuffer {
        /// Which view.
        view: usize,
        /// First byte behind the view.
        end: u128,
        /// Which buffer.
        buffer: usize,
        /// How many bytes the buffer has.
        length: usize,
    },
    /// A buffer that neither has a URI nor is the binary part of a GLB file.
    #[error("buffers[{buffer}] has no data, expected a uri or the binary chunk of a GLB file")]
    NoData {
        /// Which buffer.
        buffer: usize,
    },
    /// Elements that overlap.
    #[error("elements of {size} bytes every {stride} bytes, expected at least {size}")]
    Stride {
        /// Bytes from one element to the next.
        stride: usize,
        /// Bytes of an element.
        size: usize,
    },
    /// Substituted elements out of order or out of range.
    #[error(
        "sparse.indices[{position}] is {index}, expected more than the one before and less than {count}"
    )]
    SparseIndex {
        /// Which of the substituted elements.
        position: usize,
        /// What it says it replaces.
        index: u32,
        /// How many elements there are.
        count: usize,
    },
    /// Data that is read again and again, or zeros without end: a few bytes of JSON could ask for all memory.
    #[error("needs {found} numbers, expected at most {limit} of a file of this size")]
    TooMuch {
        /// How many there would be.
        found: u64,
        /// How many are read.
        limit: u64,
    },
    /// Positions that the file does not give.
    #[error("has neither a bufferView nor sparse values: all positions would be zero")]
    AllZeros,
    /// The index that glTF reserves.
    #[error("index {position} is {index}, which glTF reserves for primitive restart")]
    Restart {
        /// Which of the indices.
        position: usize,
        /// What it is.
        index: u32,
    },
    /// A joint that the skin does not have.
    #[error("vertex {vertex} follows joint {joint}, expected one below {joints}")]
    Joint {
        /// Which vertex.
        vertex: usize,
        /// What it says.
        joint: usize,
        /// How many joints the skin has.
        joints: usize,
    },
    /// A vertex that follows no joint.
    #[error("the weights of vertex {vertex} add up to {sum}, expected 1")]
    Weights {
        /// Which vertex.
        vertex: usize,
        /// What they add up to.
        sum: f64,
    },
}

/// What is wrong with a reference to another file.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum UriProblem {
    /// Something that would have to be fetched.
    #[error("refers to {uri:?} by the scheme {scheme:?}, expected a relative path or a data URI")]
    Scheme {
        /// The reference, shortened.
        uri: String,
        /// How it starts.
        scheme: String,
    },
    /// A path from the root of the file system.
    #[error("refers to {uri:?}, expected a path relative to the file")]
    Absolute {
        /// The reference, shortened.
        uri: String,
    },
    /// A path that is not UTF-8 once decoded.
    #[error("refers to {uri:?}, which is not UTF-8 when decoded")]
    NotUtf8 {
        /// The reference, shortened.
        uri: String,
    },
    /// A data URI that cannot be decoded.
    #[error("holds {uri:?}, expected `data:`, a type, `;base64,` and base64")]
    Data {
        /// The reference, shortened.
        uri: String,
    },
}

/// What is wrong with a node.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum NodeProblem {
    /// A child of two nodes, or listed twice.
    #[error("is a child of nodes[{first}] and of nodes[{second}], expected one parent")]
    TwoParents {
        /// The one.
        first: usize,
        /// The other; the same where it lists its child twice.
        second: usize,
    },
    /// Its own ancestor.
    #[error("is among its own descendants, expected a tree")]
    Cycle,
    /// A matrix that is not an affine transformation.
    #[error("the bottom row of the matrix is {row:?}, expected [0, 0, 0, 1]")]
    Projective {
        /// The row.
        row: [f64; 4],
    },
    /// No rotation at all.
    #[error("the rotation is {rotation:?}, expected a unit quaternion")]
    Rotation {
        /// The quaternion.
        rotation: [f64; 4],
    },
    /// Copies without end: a few bytes of JSON could ask for all memory.
    #[error(
        "with its copies {found} numbers would be made, expected at most {limit} of a file of this size; what is stored \
         as a mesh of its own has no limit"
    )]
    TooMuch {
        /// How many there would be.
        found: u64,
        /// How many are made.
        limit: u64,
    },
    /// Numbers beyond all measure.
    #[error("the transformation overflows, expected finite numbers")]
    NotFinite,
    /// A skin that does not fit.
    #[error("skins[{skin}] has {matrices} inverse bind matrices for {joints} joints")]
    BindMatrices {
        /// Which skin.
        skin: usize,
        /// How many matrices it has.
        matrices: usize,
        /// How many joints it has.
        joints: usize,
    },
    /// A skin on a mesh that does not say which vertex follows which joint.
    #[error("has skins[{skin}], but its mesh has no JOINTS_0 and WEIGHTS_0")]
    NoJoints {
        /// Which skin.
        skin: usize,
    },
    /// Weights that do not fit the morph targets.
    #[error("has {found} morph weights, expected {expected}")]
    MorphWeights {
        /// How many there are.
        found: usize,
        /// How many targets the mesh has.
        expected: usize,
    },
}

/// What is wrong with a line of an OBJ file.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ObjProblem {
    /// Not a number.
    #[error("{found:?}, expected a finite number")]
    Number {
        /// What stands there.
        found: String,
    },
    /// Too few numbers.
    #[error("{statement} has {found} numbers, expected {expected}")]
    Count {
        /// The first word.
        statement: &'static str,
        /// How many follow it.
        found: usize,
        /// How many should.
        expected: &'static str,
    },
    /// Not the corner of a face.
    #[error("corner {found:?}, expected v, v/vt, v//vn or v/vt/vn")]
    Corner {
        /// What stands there.
        found: String,
    },
    /// A corner at a vertex that is not there.
    #[error("corner {found:?} refers to v {index}, but only {count} are defined so far")]
    Index {
        /// What stands there.
        found: String,
        /// The offending number.
        index: i64,
        /// How many vertices there are: before the corner, if it counts from there, else in the file.
        count: usize,
    },
}

/// What is wrong with a PLY, STL or OFF file, or with a line or an element of it.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum DataProblem {
    /// Not a number, or not one that is possible here.
    #[error("{found:?}, expected {expected}")]
    Word {
        /// What stands there.
        found: String,
        /// What should stand there.
        expected: &'static str,
    },
    /// A coordinate that is NaN or infinite.
    #[error("{property} is {found}, expected a finite number")]
    NotFinite {
        /// Which number.
        property: String,
        /// Its value.
        found: String,
    },
    /// Too few numbers.
    #[error("{found} numbers, expected {expected}")]
    Count {
        /// How many there are.
        found: usize,
        /// How many there should be, and of which kind.
        expected: String,
    },
    /// A corner at a vertex that is not there.
    #[error("a corner at vertex {found}, expected one of the {vertices} vertices, from 0")]
    Corner {
        /// What stands there.
        found: String,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A list whose length is negative or no whole number.
    #[error("a list of {found} values, expected a whole number that is not negative")]
    Length {
        /// Its length.
        found: String,
    },
    /// A text that ends before it is complete.
    #[error("the file ends, expected {expected}")]
    End {
        /// What should follow.
        expected: String,
    },
    /// More elements than the rest of the file has room for.
    #[error(
        "{count} {element} elements need at least {needed} bytes, but {left} are left: the file is cut off"
    )]
    CutOff {
        /// How many elements there should be.
        count: u64,
        /// What they are called.
        element: String,
        /// How many bytes they need.
        needed: u128,
        /// How many bytes there are.
        left: usize,
    },
    /// A file with nothing that says where its vertices are.
    #[error("no {missing}, expected {expected}")]
    Missing {
        /// What is not there.
        missing: &'static str,
        /// Where it should be.
        expected: &'static str,
    },
}

/// Bytes of a word that an error shows at most.
const MAX_WORD: usize = 80;

impl DataProblem {
    /// A word of a text that should be something else.
    pub(super) fn word(found: &[u8], expected: &'static str) -> Self {
        let found = shown(&found[..found.len().min(MAX_WORD)]).into_owned();
        Self::Word { found, expected }
    }
}

/// An error and its causes in one line.
pub(super) fn reason(error: &dyn std::error::Error) -> String {
    match error.source() {
        Some(source) => format!("{error}: {}", reason(source)),
        None => error.to_string(),
    }
}
