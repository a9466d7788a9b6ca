//! Any of the shapes, as scenes name them.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    Appearance, Cells, Cone, Count, Cuboid, Cylinder, Grid, Lattice, Length, Rod, ShapeError,
    Sphere, Torus, checker, round,
};
use crate::material::{Material, Model, Part};
use crate::mesh::Mesh;

/// A shape that the program makes itself, centred on the origin of its object.
///
/// Without a resolution of its own a shape has the default one of its kind. Round shapes take the
/// one that a tolerance calls for from [`Shape::within`]; [`Shape::deviation`] says how far their facets
/// are from the true surface.
///
/// # Example
///
/// ```
/// use photosurface::shape::Appearance;
/// use photosurface::Shape;
///
/// let model = Shape::torus(2.0, 0.5)?.with_resolution(48)?.model(&Appearance::default())?;
/// assert_eq!(model.triangle_count(), 2 * 48 * 12);
/// # Ok::<(), photosurface::shape::ShapeError>(())
/// ```
#[derive(Clone, Debug, PartialEq, JsonSchema, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// A sphere.
    Sphere(Sphere),
    /// A box with its edges along the axes; `box` in JSON.
    #[serde(rename = "box")]
    Cuboid(Cuboid),
    /// A closed cylinder about the y axis.
    Cylinder(Cylinder),
    /// A closed cone about the y axis, its tip up.
    Cone(Cone),
    /// A ring about the y axis.
    Torus(Torus),
    /// A thin cylinder along the y axis.
    Rod(Rod),
    /// A square in the xz plane that faces +y, in cells.
    Grid(Grid),
    /// Square bars along the edges of a stack of cubes.
    Lattice(Lattice),
}

impl Shape {
    /// A sphere of the default resolution.
    ///
    /// # Errors
    ///
    /// A radius that is not a finite length > 0.
    pub fn sphere(radius: f64) -> Result<Self, ShapeError> {
        Ok(Self::Sphere(Sphere {
            radius: Length::named("radius", radius)?,
            resolution: None,
        }))
    }

    /// A box of the default resolution with these lengths along x, y and z.
    ///
    /// # Errors
    ///
    /// One that is not a finite length > 0.
    pub fn cuboid([x, y, z]: [f64; 3]) -> Result<Self, ShapeError> {
        let length = |value| Length::named("size", value);
        Ok(Self::Cuboid(Cuboid {
            size: [length(x)?, length(y)?, length(z)?],
            resolution: None,
        }))
    }

    /// A cylinder of the default resolution.
    ///
    /// # Errors
    ///
    /// One that is not a finite length > 0.
    pub fn cylinder(radius: f64, height: f64) -> Result<Self, ShapeError> {
        Ok(Self::Cylinder(Cylinder {
            radius: Length::named("radius", radius)?,
            height: Length::named("height", height)?,
            resolution: None,
        }))
    }

    /// A cone of the default resolution.
    ///
    /// # Errors
    ///
    /// One that is not a finite length > 0.
    pub fn cone(radius: f64, height: f64) -> Result<Self, ShapeError> {
        Ok(Self::Cone(Cone {
            radius: Length::named("radius", radius)?,
            height: Length::named("height", height)?,
            resolution: None,
        }))
    }

    /// A torus of the default resolution: distance of the tube from the axis, radius of the tube.
    ///
    /// # Errors
    ///
    /// One that is not a finite length > 0, or a tube that reaches the axis.
    pub fn torus(major_radius: f64, minor_radius: f64) -> Result<Self, ShapeError> {
        let major_radius = Length::named("major_radius", major_radius)?;
        let minor_radius = Length::named("minor_radius", minor_radius)?;
        Torus::new(major_radius, minor_radius, None).map(Self::Torus)
    }

    /// A rod of the default resolution.
    ///
    /// # Errors
    ///
    /// One that is not a finite length > 0.
    pub fn rod(length: f64, radius: f64) -> Result<Self, ShapeError> {
        Ok(Self::Rod(Rod {
            length: Length::named("length", length)?,
            radius: Length::named("radius", radius)?,
            resolution: None,
        }))
    }

    /// A square of edge `size` with `cells` squared cells, of the default resolution.
    ///
    /// # Errors
    ///
    /// A size that is not a finite length > 0, or cells not from 1 to 4096.
    pub fn grid(size: f64, cells: u32) -> Result<Self, ShapeError> {
        Ok(Self::Grid(Grid {
            size: Length::named("size", size)?,
            cells: Count::named("cells", cells)?,
            resolution: None,
        }))
    }

    /// A lattice of the default resolution: cells along x, y and z, their edge, the width of the bars.
    ///
    /// # Errors
    ///
    /// Cells not from 1 to 4096, one that is not a finite length > 0, or bars that touch.
    pub fn lattice([x, y, z]: [u32; 3], spacing: f64, thickness: f64) -> Result<Self, ShapeError> {
        let count = |value| Count::named("cells", value);
        let cells = Cells::Each([count(x)?, count(y)?, count(z)?]);
        let spacing = Length::named("spacing", spacing)?;
        let thickness = Length::named("thickness", thickness)?;
        Lattice::new(cells, spacing, thickness, None).map(Self::Lattice)
    }

    /// The same shape with another resolution; what it counts depends on the shape.
    ///
    /// # Errors
    ///
    /// Less than 3 around a full turn, less than 1 along a straight edge, more than 4096.
    pub fn with_resolution(self, resolution: u32) -> Result<Self, ShapeError> {
        const NAME: &str = "resolution";
        Ok(match self {
            Self::Sphere(shape) => Self::Sphere(Sphere {
                resolution: Some(Count::named(NAME, resolution)?),
                ..shape
            }),
            Self::Cuboid(shape) => Self::Cuboid(Cuboid {
                resolution: Some(Count::named(NAME, resolution)?),
                ..shape
            }),
            Self::Cylinder(shape) => Self::Cylinder(Cylinder {
                resolution: Some(Count::named(NAME, resolution)?),
                ..shape
            }),
            Self::Cone(shape) => Self::Cone(Cone {
                resolution: Some(Count::named(NAME, resolution)?),
                ..shape
            }),
            Self::Torus(shape) => {
                Self::Torus(shape.with_resolution(Count::named(NAME, resolution)?))
            }
            Self::Rod(shape) => Self::Rod(Rod {
                resolution: Some(Count::named(NAME, resolution)?),
                ..shape
            }),
            Self::Grid(shape) => Self::Grid(Grid {
                resolution: Some(Count::named(NAME, resolution)?),
                ..shape
            }),
            Self::Lattice(shape) => {
                Self::Lattice(shape.with_resolution(Count::named(NAME, resolution)?))
            }
        })
    }

    /// The resolution of its own, if it has one.
    pub fn resolution(&self) -> Option<u32> {
        match self {
            Self::Sphere(shape) => shape.resolution.map(Count::get),
            Self::Cuboid(shape) => shape.resolution.map(Count::get),
            Self::Cylinder(shape) => shape.resolution.map(Count::get),
            Self::Cone(shape) => shape.resolution.map(Count::get),
            Self::Torus(shape) => shape.resolution.map(Count::get),
            Self::Rod(shape) => shape.resolution.map(Count::get),
            Self::Grid(shape) => shape.resolution.map(Count::get),
            Self::Lattice(shape) => shape.resolution.map(Count::get),
        }
    }

    /// The shape as a mesh with its material.
    ///
    /// Vertices are on the true surface and have its normals; where faces meet at an edge, each has
    /// vertices of its own. A closed shape is watertight: vertices at the same place are
    /// equal bit for bit. Texture coordinates show a picture upright and not mirrored from outside;
    /// on sphere, torus and each side of a box it is there once, on the others it repeats.
    ///
    /// # Accuracy
    ///
    /// Vertices are within a few units in the last place of the shape's size of the true surface.
    ///
    /// # Errors
    ///
    /// More than 20 million triangles, or lengths too different for `f64`.
    pub fn model(&self, appearance: &Appearance) -> Result<Model, ShapeError> {
        let part = Part::new("", self.mesh()?, Some(Arc::new(self.material(appearance))))?;
        Ok(Model {
            parts: vec![part],
            origin: None,
        })
    }

    /// The material of [`Shape::model`] alone.
    pub(crate) fn material(&self, appearance: &Appearance) -> Material {
        checker::material(appearance, self.checker_cells())
    }

    /// The mesh of [`Shape::model`] alone.
    ///
    /// # Errors
    ///
    /// As [`Shape::model`].
    pub fn mesh(&self) -> Result<Mesh, ShapeError> {
        check_proportions(&self.lengths())?;
        let surface = match self {
            Self::Sphere(shape) => shape.surface()?,
            Self::Cuboid(shape) => shape.surface()?,
            Self::Cylinder(shape) => shape.surface()?,
            Self::Cone(shape) => shape.surface()?,
            Self::Torus(shape) => shape.surface()?,
            Self::Rod(shape) => shape.surface()?,
            Self::Grid(shape) => shape.surface()?,
            Self::Lattice(shape) => shape.surface()?,
        };
        Ok(surface.into_mesh()?.made_by(self.clone()))
    }

    /// Columns and rows of the checker.
    pub(crate) fn checker_cells(&self) -> [u32; 2] {
        match self {
            Self::Sphere(_) => Sphere::CHECKER_CELLS,
            Self::Cuboid(_) => Cuboid::CHECKER_CELLS,
            Self::Cylinder(_) | Self::Cone(_) | Self::Rod(_) => round::CHECKER_TILE,
            Self::Torus(_) => Torus::CHECKER_CELLS,
            Self::Grid(_) => Grid::CHECKER_CELLS,
            Self::Lattice(_) => Lattice::CHECKER_CELLS,
        }
    }

    /// All lengths of the shape and the gaps that they leave.
    fn lengths(&self) -> Vec<f64> {
        match self {
            Self::Sphere(shape) => vec![shape.radius.get()],
            Self::Cuboid(shape) => shape.size.map(Length::get).to_vec(),
            Self::Cylinder(shape) => vec![shape.radius.get(), shape.height.get()],
            Self::Cone(shape) => vec![shape.radius.get(), shape.height.get()],
            Self::Torus(shape) => {
                let [major, minor] = [shape.major_radius().get(), shape.minor_radius().get()];
                vec![major, minor, major - minor]
            }
            Self::Rod(shape) => vec![shape.length.get(), shape.radius.get()],
            Self::Grid(shape) => vec![shape.size.get()],
            Self::Lattice(shape) => {
                let [spacing, thickness] = [shape.spacing().get(), shape.thickness().get()];
                vec![spacing, thickness, spacing - thickness]
            }
        }
    }
}

/// Refuses lengths so different that vertices would fall together, or so small or large that the
/// square of an area is beyond the range of `f64`.
fn check_proportions(lengths: &[f64]) -> Result<(), ShapeError> {
    let smallest = lengths.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = lengths.iter().copied().fold(0.0, f64::max);
    if smallest >= 1e-60 && largest <= 1e60 && largest <= 1e6 * smallest {
        Ok(())
    } else {
        Err(ShapeError::Proportions { smallest, largest })
    }
}

#[cfg(test)]
mod tests {
    use super::super::witness;
    use super::*;

    /// One of each.
    fn shapes() -> Vec<Shape> {
        let shapes = [
            Shape::sphere(1.0),
            Shape::cuboid([1.0, 1.0, 1.0]),
            Shape::cylinder(1.0, 2.0),
            Shape::cone(1.0, 2.0),
            Shape::torus(1.0, 0.25),
            Shape::rod(10.0, 0.1),
            Shape::grid(10.0, 10),
            Shape::lattice([4, 4, 4], 1.0, 0.1),
        ];
        shapes.map(Result::unwrap).into()
    }

    #[test]
    fn a_model_is_one_nameless_part_of_the_expected_size() {
        let counts = shapes().into_iter().map(|shape| {
            let model = shape.model(&Appearance::default()).unwrap();
            assert_eq!(model.parts[0].name, "");
            assert!(model.parts[0].material.is_some());
            (model.triangle_count(), model.vertex_count())
        });
        let expected = [
            (5_780, 2_950),
            (12_288, 6_534),
            (9_024, 4_738),
            (8_260, 4_304),
            (4_608, 2_425),
            (18_528, 9_697),
            (12_800, 6_561),
            (9_900, 10_104),
        ];
        assert_eq!(counts.collect::<Vec<_>>(), expected);
    }

    #[test]
    fn json_is_read_and_written() {
        let text = r##"[
            {"sphere": {"radius": 1}},
            {"box": {"size": [1, 1, 1]}},
            {"cylinder": {"radius": 1, "height": 2}},
            {"cone": {"radius": 1, "height": 2}},
            {"torus": {"major_radius": 1, "minor_radius": 0.25}},
            {"rod": {"length": 10, "radius": 0.1}},
            {"grid": {"size": 10, "cells": 10}},
            {"lattice": {"cells": [4, 4, 4], "spacing": 1, "thickness": 0.1}}
        ]"##;
        let read: Vec<Shape> = serde_json::from_str(text).unwrap();
        assert_eq!(read, shapes());
        let again = serde_json::to_string(&read).unwrap();
        assert_eq!(serde_json::from_str::<Vec<Shape>>(&again).unwrap(), read);
    }

    #[test]
    fn unknown_and_impossible_parameters_are_refused() {
        for (text, expected) in [
            (
                r#"{"sphere": {"radius": -1}}"#,
                "-1, expected a finite length > 0",
            ),
            (
                r#"{"sphere": {"radius": 1, "size": 2}}"#,
                "unknown field `size`",
            ),
            (
                r#"{"sphere": {"radius": 1, "resolution": 2}}"#,
                "from 3 to 4096",
            ),
            (r#"{"sphere": {}}"#, "missing field `radius`"),
            (r#"{"ball": {"radius": 1}}"#, "unknown variant `ball`"),
            (r#"{"box": {"size": [1, 1]}}"#, "array of length 3"),
            (
                r#"{"lattice": {"cells": 0, "spacing": 1, "thickness": 0.1}}"#,
                "from 1 to 4096",
            ),
        ] {
            let message = serde_json::from_str::<Shape>(text).unwrap_err().to_string();
            assert!(message.contains(expected), "{text}: {message}");
        }
        assert!(Shape::sphere(1.0).unwrap().with_resolution(2).is_err());
        assert!(Shape::rod(1.0, f64::NAN).is_err());
        assert!(Shape::grid(1.0, 0).is_err());
    }

    #[test]
    fn the_json_schema_describes_the_scene_file() {
        let schema = schemars::schema_for!(Vec<Shape>);
        let validator = jsonschema::validator_for(schema.as_value()).unwrap();
        let valid = serde_json::to_value(shapes()).unwrap();
        assert!(validator.is_valid(&valid));
        for invalid in [
            serde_json::json!([{"sphere": {"radius": 0}}]),
            serde_json::json!([{"sphere": {"radius": 1, "resolution": 2}}]),
            serde_json::json!([{"torus": {"major_radius": 1, "minor_radius": 0.1, "radius": 1}}]),
            serde_json::json!([{"lattice": {"cells": [1, 1], "spacing": 1, "thickness": 0.1}}]),
        ] {
            assert!(!validator.is_valid(&invalid), "{invalid}");
        }
        let text = serde_json::to_string(&schema).unwrap();
        assert!(text.contains("Radius of the tube, less than `major_radius`"));
    }

    #[test]
    fn extreme_proportions_are_refused_and_extreme_sizes_are_not() {
        let model = |shape: Shape| shape.model(&Appearance::default());
        for shape in [
            Shape::torus(1.0, 1.0 - 1e-9),
            Shape::cylinder(1.0, 1e-7),
            Shape::lattice([1; 3], 1.0, 1.0 - 1e-9),
            Shape::sphere(1e-61),
            Shape::sphere(1e61),
        ] {
            let error = model(shape.unwrap()).unwrap_err();
            assert!(matches!(error, ShapeError::Proportions { .. }), "{error}");
        }
        for scale in [1e-50, 1e50] {
            for shape in [Shape::sphere(scale), Shape::torus(scale, 1e-5 * scale)] {
                let mesh = witness::mesh(&shape.unwrap());
                witness::assert_closed(&mesh);
                witness::assert_well_made(&mesh);
            }
        }
    }
}
