//! What was found in a file and is not copied as it stands.

use std::fmt;
use std::path::PathBuf;

/// Something in a file that was left out, replaced or chosen, and that its user may want to know.
///
/// `Display` gives one line.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// Several scenes, or none marked as the one to show.
    Scene {
        /// The one that is read; `None` means all nodes.
        read: Option<usize>,
        /// How many there are.
        scenes: usize,
    },
    /// The file is one that this program wrote: what is in it is how things were seen.
    Photosurface {
        /// What it says that wrote it.
        generator: String,
    },
    /// Things that have no surface, or that would change it in time.
    NotCarried {
        /// Such as "2 cameras".
        what: String,
    },
    /// An extension of glTF that does not change the shape.
    Extension {
        /// Which one.
        name: String,
    },
    /// A node that is switched off.
    Hidden {
        /// Its name.
        node: String,
    },
    /// A scene that lists nodes which have parents.
    InnerRoots {
        /// Which scene.
        scene: usize,
        /// Name of the first of those nodes.
        node: String,
        /// How many there are.
        count: usize,
    },
    /// Matrices with rounding where an affine transformation has none.
    BottomRow {
        /// Where they are.
        place: String,
        /// How many.
        count: usize,
        /// How far off their bottom rows are at most.
        largest: f64,
    },
    /// A node scaled to a line or a point.
    Flat {
        /// Its name.
        node: String,
    },
    /// Points or lines.
    PointsAndLines {
        /// Name of the node or the file that has them.
        place: String,
        /// How many primitives, or lines of the file.
        count: usize,
    },
    /// A primitive without positions.
    NoPositions {
        /// Which one.
        place: String,
    },
    /// Indices that glTF reserves for a new strip, taken for the vertex that they name.
    LastIndex {
        /// Which primitive.
        place: String,
        /// The index.
        index: u32,
        /// How often it occurs.
        count: usize,
    },
    /// A primitive without a triangle, or a mesh without a primitive.
    Empty {
        /// Which one.
        place: String,
    },
    /// Faces without a triangle.
    EmptyFaces {
        /// How many.
        count: usize,
    },
    /// Triangles that have no area since two of their corners are one vertex.
    EqualCorners {
        /// How many.
        count: usize,
    },
    /// Vertices that no triangle uses.
    UnusedVertices {
        /// How many.
        count: usize,
    },
    /// Normals of facets that contradict the order of the corners, which decides.
    FacetNormals {
        /// Which part.
        mesh: String,
        /// How many facets.
        count: usize,
    },
    /// Indices that do not make up a triangle.
    LeftOver {
        /// Which primitive.
        place: String,
        /// How many indices.
        count: usize,
    },
    /// Data of vertices that no photosurface carries.
    Attributes {
        /// Which mesh.
        mesh: String,
        /// Their names.
        names: Vec<String>,
    },
    /// Colours beyond 0 to 1.
    ColorsClamped {
        /// Which mesh.
        mesh: String,
        /// How many vertices.
        count: usize,
    },
    /// Colours of vertices in a file of a format that does not say what they mean.
    ColorsFromSrgb,
    /// Parts without normals that are shaded flat; bytes of a step in a glTF file without refinement.
    FlatForWantOfNormals {
        /// As they are.
        flat: u64,
        /// With smooth normals, at least.
        smooth: u64,
        /// Without normals.
        none: u64,
    },
    /// A mesh that has other forms.
    Morph {
        /// Which mesh.
        mesh: String,
        /// The weights that are applied.
        weights: Vec<f32>,
    },
    /// A mesh that follows joints.
    Skin {
        /// Name of the node.
        node: String,
    },
    /// Vertices that follow joints by no weight.
    NoWeights {
        /// Which mesh.
        mesh: String,
        /// How many vertices.
        count: usize,
    },
    /// Vertices whose weights are not 1 together.
    Weights {
        /// Which mesh.
        mesh: String,
        /// How many vertices.
        count: usize,
    },
    /// Normals without a direction.
    Normals {
        /// Which mesh.
        mesh: String,
        /// How many vertices.
        count: usize,
    },
    /// Corners without texture coordinates in a part that has some.
    TextureCoordinates {
        /// Which part.
        part: String,
        /// How many vertices.
        count: usize,
    },
    /// What a material of an OBJ file has that glTF has no room for.
    Material {
        /// Its name.
        material: String,
        /// What else it has.
        properties: Vec<String>,
    },
    /// A factor of a material beyond what glTF allows.
    FactorClamped {
        /// Which material.
        place: String,
        /// Which factor.
        factor: String,
    },
    /// Textures that a mesh has no texture coordinates for.
    Unplaced {
        /// Which mesh.
        mesh: String,
        /// Name of the material; empty where it has none.
        material: String,
        /// What the textures are for.
        slots: Vec<String>,
    },
    /// A picture of bumps that is taken for one of normals.
    BumpAsNormals {
        /// Name of the material.
        material: String,
    },
    /// An image that cannot be used.
    Image {
        /// Which one.
        image: String,
        /// Why.
        reason: String,
    },
    /// An image that was made into PNG, since glTF does not have its format.
    ImageConverted {
        /// Which one.
        image: String,
        /// The format that it had.
        format: &'static str,
    },
    /// A material library that cannot be read.
    MaterialLibrary {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// Something in an OBJ file that does not bear on the shape and makes no sense.
    PassedOver {
        /// What it is.
        what: &'static str,
        /// How often it is there.
        count: usize,
        /// The line that has it first, from 1, where that is known.
        first_line: Option<usize>,
    },
    /// A file that is not where it is said to be, and one that may be it.
    FoundElsewhere {
        /// What is said.
        named: String,
        /// The file that is read.
        path: PathBuf,
    },
    /// Names that are too long to be told apart by more of them.
    NamesCut {
        /// How many.
        count: usize,
        /// Bytes that are left of each at most.
        limit: usize,
    },
    /// A picture made of several of different sizes.
    ImageScaled {
        /// Which one.
        image: String,
    },
    /// A material that no library defines.
    UnknownMaterial {
        /// Its name.
        name: String,
    },
    /// Lines of a material library that make no sense.
    MaterialLines {
        /// The file.
        path: PathBuf,
        /// The numbers of the lines.
        lines: Vec<usize>,
    },
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene { read: None, .. } => write!(f, "no scenes: all nodes are read"),
            Self::Scene {
                read: Some(read),
                scenes,
            } => write!(f, "{scenes} scenes: only scenes[{read}] is read"),
            Self::Photosurface { generator } => write!(
                f,
                "written by {generator}: this mesh already is a photosurface; it is read as an ordinary mesh at rest"
            ),
            Self::NotCarried { what } => write!(f, "{what}: not copied"),
            Self::Extension { name } => write!(f, "extension {name}: not copied"),
            Self::Hidden { node } => write!(f, "node {node:?} is not visible: skipped"),
            Self::InnerRoots { scene, node, count } => {
                let those = plural(*count, "node");
                write!(
                    f,
                    "scenes[{scene}] lists {those} with a parent, the first {node:?}: drawn once, where the parent \
                     places it"
                )
            }
            Self::BottomRow {
                place,
                count,
                largest,
            } => {
                let those = match count {
                    1 => "1 matrix".to_owned(),
                    _ => format!("{count} matrices"),
                };
                write!(
                    f,
                    "{place}: the bottom row of {those} differs from [0, 0, 0, 1] by up to {largest:.0e} and is ignored"
                )
            }
            Self::Flat { node } => {
                write!(f, "node {node:?} is scaled to a line or a point: skipped")
            }
            Self::PointsAndLines { place, count } => {
                let those = plural(*count, "primitive");
                write!(f, "{place}: {those} of points or lines skipped")
            }
            Self::NoPositions { place } => write!(f, "{place}: has no POSITION, skipped"),
            Self::LastIndex {
                place,
                index,
                count,
            } => {
                let times = plural(*count, "time");
                write!(
                    f,
                    "{place}, indices: {index}, reserved by glTF, used {times} as the index of a vertex"
                )
            }
            Self::Empty { place } => write!(f, "{place}: has no triangles, skipped"),
            Self::EmptyFaces { count } => {
                let those = plural(*count, "face");
                write!(f, "{those} of fewer than three corners skipped")
            }
            Self::EqualCorners { count } => {
                let those = plural(*count, "triangle");
                write!(f, "{those} with two corners at one vertex skipped")
            }
            Self::UnusedVertices { count } => {
                let those = plural(*count, "vertex");
                write!(f, "{those} of no triangle skipped")
            }
            Self::FacetNormals { mesh, count } => {
                let those = plural(*count, "facet normal");
                write!(
                    f,
                    "{mesh}: {those} against the order of the corners ignored"
                )
            }
            Self::LeftOver { place, count } => {
                let those = plural(*count, "left-over index");
                write!(
                    f,
                    "{place}: {those} skipped, expected three for each triangle"
                )
            }
            Self::Attributes { mesh, names } => {
                write!(f, "{mesh}: {} not copied", names.join(", "))
            }
            Self::ColorsClamped { mesh, count } => {
                let those = plural(*count, "colour");
                write!(f, "{mesh}: {those} outside 0 to 1 clamped")
            }
            Self::ColorsFromSrgb => write!(f, "vertex colours: taken as sRGB, made linear"),
            Self::FlatForWantOfNormals { flat, smooth, none } => {
                let [flat, smooth, none] = [flat, smooth, none].map(|&bytes| bytes as f64 / 1e6);
                write!(
                    f,
                    "no normals: facets are shaded flat, with three vertices each, {flat:.1} MB a step; shared vertices need \
                     about {smooth:.1} MB with --normals smooth, {none:.1} MB with --normals none"
                )
            }
            Self::Morph { mesh, weights } if weights.iter().all(|&weight| weight == 0.0) => {
                let targets = plural(weights.len(), "morph target");
                write!(f, "{mesh}: {targets} left at weight 0")
            }
            Self::Morph { mesh, weights } => {
                write!(f, "{mesh}: morph targets applied with weights {weights:?}")
            }
            Self::Skin { node } => write!(f, "node {node:?}: skin applied in its default pose"),
            Self::NoWeights { mesh, count } => {
                let those = plural(*count, "vertex");
                write!(
                    f,
                    "{mesh}: {those} without weights: the first joint applies"
                )
            }
            Self::Weights { mesh, count } => {
                let those = plural(*count, "vertex");
                write!(
                    f,
                    "{mesh}: weights of {those} divided by their sum, expected 1"
                )
            }
            Self::Normals { mesh, count } => {
                let those = plural(*count, "zero normal");
                write!(
                    f,
                    "{mesh}: {those} replaced by that of an adjacent triangle"
                )
            }
            Self::TextureCoordinates { part, count } => {
                let those = plural(*count, "vertex");
                write!(
                    f,
                    "part {part:?}: {those} without texture coordinates get 0, 0"
                )
            }
            Self::Material {
                material,
                properties,
            } => {
                let properties = properties.join(", ");
                write!(f, "material {material:?}: {properties} not copied")
            }
            Self::FactorClamped { place, factor } => {
                write!(
                    f,
                    "{place}: {factor} changed to the nearest value that glTF allows"
                )
            }
            Self::Unplaced {
                mesh,
                material,
                slots,
            } => {
                let slots = slots.join(", ");
                write!(
                    f,
                    "{mesh}: no texture coordinates for the {slots} of material {material:?}, dropped"
                )
            }
            Self::BumpAsNormals { material } => {
                write!(f, "material {material:?}: bump map taken as a normal map")
            }
            Self::Image { image, reason } => write!(f, "image {image} dropped: {reason}"),
            Self::ImageConverted { image, format } => {
                write!(f, "image {image} made into PNG from {format}")
            }
            Self::ImageScaled { image } => {
                write!(
                    f,
                    "image {image} combines images of different sizes: scaled to the larger size"
                )
            }
            Self::MaterialLibrary { path, reason } => {
                write!(f, "material library {path:?} skipped: {reason}")
            }
            Self::PassedOver {
                what,
                count,
                first_line,
            } => {
                let (times, word) = match count {
                    1 => ("once".to_owned(), "in"),
                    _ => (format!("{count} times"), "first in"),
                };
                write!(f, "{what}: ignored {times}")?;
                let line = first_line.map(|line| format!(", {word} line {line}"));
                f.write_str(&line.unwrap_or_default())
            }
            Self::FoundElsewhere { named, path } => {
                write!(f, "file {named:?} is not there: {path:?} is read instead")
            }
            Self::NamesCut { count, limit } => {
                let those = plural(*count, "name");
                write!(f, "{those} of parts cut to {limit} bytes")
            }
            Self::UnknownMaterial { name } => {
                write!(
                    f,
                    "material {name:?} is not defined: parts keep only its name"
                )
            }
            Self::MaterialLines { path, lines } => {
                write!(
                    f,
                    "material library {path:?}: malformed lines {lines:?} skipped"
                )
            }
        }
    }
}

/// Such as "1 camera", "2 cameras".
pub(super) fn plural(count: usize, singular: &str) -> String {
    match (count, singular) {
        (1, _) => format!("1 {singular}"),
        (_, "vertex") => format!("{count} vertices"),
        (_, "left-over index") => format!("{count} left-over indices"),
        (_, "mesh") => format!("{count} meshes"),
        _ => format!("{count} {singular}s"),
    }
}
