//! The shapes turned on a lathe: cylinder, rod, cone and torus.

use std::f64::consts::TAU;

use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::lathe::{Chart, Ring, Strip, lid, revolve, segments_along};
use super::surface::{Surface, sin_cos_of_turn};
use super::{Count, Length, ShapeError};

/// The checker of the shapes whose fields are about square: two columns and rows, repeated.
pub(super) const CHECKER_TILE: [u32; 2] = [2, 2];

/// A closed cylinder about the y axis, half of it above the origin.
#[derive(Clone, Debug, PartialEq, JsonSchema, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Cylinder {
    /// Distance of the side from the axis, in the object's units before `scale`.
    pub radius: Length,
    /// Distance of the lids from each other, in the object's units before `scale`.
    pub height: Length,
    /// Number of segments around a full turn; along the height and on the lids they are as long.
    /// If absent it follows from the tolerance; 96 where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resolution: Option<Count<3, 96>>,
}

impl Cylinder {
    /// Checker cells around the side, 15 degrees each; 8 across a lid are about as large.
    pub(super) const COLUMNS: u32 = 24;

    pub(super) fn surface(&self) -> Result<Surface, ShapeError> {
        revolve(&self.profile())
    }

    pub(super) fn profile(&self) -> Vec<Strip> {
        let around = u64::from(self.resolution.unwrap_or_default().get());
        cylinder(
            self.radius.get(),
            self.height.get(),
            around,
            [Self::COLUMNS, 8],
        )
    }
}

/// A cylinder meant to be thin: the same as `cylinder`, but coarser where nothing else is said.
#[derive(Clone, Debug, PartialEq, JsonSchema, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Rod {
    /// Distance of its ends from each other along y, in the object's units before `scale`.
    pub length: Length,
    /// Distance of the side from the axis, in the object's units before `scale`.
    pub radius: Length,
    /// Number of segments around a full turn; along the rod they are as long, up to a length of 16
    /// circumferences; a longer rod is cut into 16 times as many pieces as a turn. If absent it follows
    /// from the tolerance; 24 where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resolution: Option<Count<3, 24>>,
}

impl Rod {
    pub(super) fn surface(&self) -> Result<Surface, ShapeError> {
        revolve(&self.profile())
    }

    pub(super) fn profile(&self) -> Vec<Strip> {
        let around = u64::from(self.resolution.unwrap_or_default().get());
        // Four cells around: more of them could not be told apart on something thin.
        cylinder(self.radius.get(), self.length.get(), around, [4, 2])
    }
}

/// The profile of a closed cylinder whose checker has so many cells around the side and across a lid.
fn cylinder(radius: f64, height: f64, around: u64, [columns, across]: [u32; 2]) -> Vec<Strip> {
    let bands = segments_along(height, radius, around);
    let rows = checker_rows(height, radius, columns);
    let side = (0..=bands).map(|k| Ring {
        radius,
        // Mirror images are exact.
        height: height * ((bands as f64 - 2.0 * k as f64) / (2 * bands) as f64),
        normal: DVec2::X,
        down: rows / 2.0 * (k as f64 / bands as f64),
        segments: around,
    });
    let repeats = f64::from(across) / 2.0;
    vec![
        lid(radius, height / 2.0, true, around, repeats),
        around_the_axis(columns, side.collect()),
        lid(radius, -height / 2.0, false, around, repeats),
    ]
}

/// A closed cone about the y axis: its tip half the height above the origin, its lid as far below.
#[derive(Clone, Debug, PartialEq, JsonSchema, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Cone {
    /// Radius of the lid, in the object's units before `scale`.
    pub radius: Length,
    /// Distance of the tip from the lid, in the object's units before `scale`.
    pub height: Length,
    /// Number of segments around the rim; fewer and shorter ones towards the tip, so that all of them
    /// are equally far inside the cone and about as long as wide. If absent it follows from the
    /// tolerance; 96 where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resolution: Option<Count<3, 96>>,
}

impl Cone {
    /// Checker cells around the side, 15 degrees each; 8 across the lid are about as large.
    pub(super) const COLUMNS: u32 = 24;

    /// The fewest segments near the tip, where they can be few because they are small.
    const MIN_SEGMENTS: u64 = 8;

    pub(super) fn surface(&self) -> Result<Surface, ShapeError> {
        revolve(&self.profile())
    }

    /// The side from tip to rim, then the lid.
    pub(super) fn profile(&self) -> Vec<Strip> {
        let [radius, height] = [self.radius.get(), self.height.get()];
        let around = u64::from(self.resolution.unwrap_or_default().get());
        let slant = radius.hypot(height);
        // Rings at radii like squares, with segments like their roots: then width and distance of the
        // rings go alike, and the chord of a segment is everywhere equally far from its arc.
        let bands = segments_along(2.0 * slant, radius, around);
        let rows = checker_rows(slant, radius, Self::COLUMNS);
        let side = (0..=bands).map(|k| {
            let part = (k as f64 / bands as f64).powi(2);
            Ring {
                radius: radius * part,
                height: height * (0.5 - part),
                normal: DVec2::new(height, radius) / slant,
                down: rows / 2.0 * part,
                segments: match k {
                    0 => 0,
                    _ => (around * k)
                        .div_ceil(bands)
                        .max(Self::MIN_SEGMENTS.min(around)),
                },
            }
        });
        vec![
            around_the_axis(Self::COLUMNS, side.collect()),
            lid(radius, -height / 2.0, false, around, 4.0),
        ]
    }
}

/// A ring about the y axis.
#[derive(Clone, Debug, PartialEq, JsonSchema, Deserialize, Serialize)]
#[serde(try_from = "TorusFields")]
pub struct Torus {
    major_radius: Length,
    minor_radius: Length,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) resolution: Option<Count<3, 96>>,
}

/// A ring about the y axis.
#[derive(JsonSchema, Deserialize)]
#[serde(deny_unknown_fields)]
struct TorusFields {
    /// Distance of the middle of the tube from the axis, in the object's units before `scale`.
    major_radius: Length,
    /// Radius of the tube, less than `major_radius`, in the object's units before `scale`.
    minor_radius: Length,
    /// Number of segments around the axis; around the tube they are about as long. If absent it
    /// follows from the tolerance; 96 where there is none.
    resolution: Option<Count<3, 96>>,
}

impl TryFrom<TorusFields> for Torus {
    type Error = ShapeError;

    fn try_from(fields: TorusFields) -> Result<Self, ShapeError> {
        Self::new(fields.major_radius, fields.minor_radius, fields.resolution)
    }
}

impl Torus {
    /// Columns around the axis and rows around the tube.
    pub(super) const CHECKER_CELLS: [u32; 2] = [24, 8];

    /// A ring: distance of the middle of the tube from the axis, radius of the tube, and number of
    /// segments around the axis, 96 if there is none.
    ///
    /// # Errors
    ///
    /// A tube that reaches the axis.
    pub fn new(
        major_radius: Length,
        minor_radius: Length,
        resolution: Option<Count<3, 96>>,
    ) -> Result<Self, ShapeError> {
        if minor_radius >= major_radius {
            return Err(ShapeError::NotLess {
                name: "minor_radius",
                value: minor_radius.get(),
                limit_name: "major_radius",
                limit: major_radius.get(),
            });
        }
        Ok(Self {
            major_radius,
            minor_radius,
            resolution,
        })
    }

    /// Distance of the middle of the tube from the axis.
    pub fn major_radius(&self) -> Length {
        self.major_radius
    }

    /// Radius of the tube.
    pub fn minor_radius(&self) -> Length {
        self.minor_radius
    }

    /// The same ring with another number of segments around the axis.
    #[must_use]
    pub fn with_resolution(self, resolution: Count<3, 96>) -> Self {
        Self {
            resolution: Some(resolution),
            ..self
        }
    }

    /// How many segments there are around the axis, and how many around the tube.
    pub(super) fn segments(&self) -> [u64; 2] {
        let around = u64::from(self.resolution.unwrap_or_default().get());
        let tube = around as f64 * self.minor_radius.get() / self.major_radius.get();
        [around, (tube.round() as u64).max(3)]
    }

    pub(super) fn surface(&self) -> Result<Surface, ShapeError> {
        let [major, minor] = [self.major_radius.get(), self.minor_radius.get()];
        let [around, tube] = self.segments();
        // From the innermost circle over the top: the texture runs down on the outside.
        let rings = (0..=tube).map(|k| {
            let (sin, cos) = sin_cos_of_turn(k, tube);
            Ring {
                radius: major - minor * cos,
                height: minor * sin,
                normal: DVec2::new(-cos, sin),
                down: k as f64 / tube as f64,
                segments: around,
            }
        });
        revolve(&[Strip {
            chart: Chart::Around { repeats: 1.0 },
            rings: rings.collect(),
        }])
    }
}

/// How many rows of checker cells along `length` are about as high as one of `columns` is wide.
pub(super) fn checker_rows(length: f64, radius: f64, columns: u32) -> f64 {
    (length * f64::from(columns) / (TAU * radius))
        .round()
        .max(1.0)
}

/// A strip with so many checker cells around it.
fn around_the_axis(columns: u32, rings: Vec<Ring>) -> Strip {
    let repeats = f64::from(columns) / 2.0;
    Strip {
        chart: Chart::Around { repeats },
        rings,
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use glam::DVec3;

    use super::super::{Shape, witness};
    use super::*;

    const RESOLUTIONS: [u32; 6] = [3, 4, 7, 24, 96, 97];

    /// Distance from the y axis.
    fn from_axis(position: DVec3) -> f64 {
        position.x.hypot(position.z)
    }

    #[test]
    fn cylinders_and_rods_are_exact_prisms() {
        for (radius, height) in [(1.0, 2.0), (0.3, 40.0), (5.0, 0.01)] {
            for resolution in RESOLUTIONS {
                let shapes = [Shape::cylinder(radius, height), Shape::rod(height, radius)];
                for shape in shapes {
                    let mesh = witness::mesh(&shape.unwrap().with_resolution(resolution).unwrap());
                    assert_eq!(witness::assert_closed(&mesh), 2);
                    witness::assert_well_made(&mesh);
                    let n = f64::from(resolution);
                    witness::assert_normals_within(&mesh, PI / n * 1.000_001);
                    let polygon = n / 2.0 * (TAU / n).sin() * radius * radius;
                    witness::assert_volume(&mesh, polygon * height);
                    let side = 2.0 * n * radius * (PI / n).sin() * height;
                    witness::assert_area(&mesh, 2.0 * polygon + side);
                    for (&p, n) in mesh.positions().iter().zip(mesh.normals().unwrap()) {
                        let on_lid =
                            p.y == n.y * height / 2.0 && from_axis(p) <= radius * (1.0 + 1e-15);
                        let on_side = (from_axis(p) / radius - 1.0).abs() < 1e-15
                            && p.distance(radius * *n + p.y * DVec3::Y) < 1e-15 * radius
                            && p.y.abs() <= height / 2.0;
                        assert!(if n.y == 0.0 { on_side } else { on_lid }, "{p} {n}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_cone_lies_within_its_sagitta_inside() {
        for (radius, height) in [(1.0, 2.0), (1.0, 10.0), (2.0, 0.3)] {
            for resolution in RESOLUTIONS {
                let shape = Shape::cone(radius, height).unwrap();
                let mesh = witness::mesh(&shape.with_resolution(resolution).unwrap());
                assert_eq!(witness::assert_closed(&mesh), 2);
                witness::assert_well_made(&mesh);
                let slant = radius.hypot(height);
                for (&p, n) in mesh.positions().iter().zip(mesh.normals().unwrap()) {
                    let expected = radius * (0.5 - p.y / height);
                    let error = (from_axis(p) - expected).abs();
                    assert!(n.y == -1.0 || error < 1e-15 * radius, "{p}");
                    assert!(n.y == -1.0 || (n.y - radius / slant).abs() < 1e-15, "{n}");
                }
                // A triangle reaches around no further than a segment of its coarser ring, so its
                // points are at least cos(half of it) times as far out as the cone is there.
                let n = f64::from(resolution);
                let bands = (slant * n / (PI * radius)).ceil();
                let sagitta = |k: f64| {
                    let coarser = (n * (k - 1.0) / bands).ceil().max(n.min(8.0));
                    radius * (k / bands).powi(2) * (1.0 - (PI / coarser).cos())
                };
                let sagitta = (1..=bands as u32).map(|k| sagitta(f64::from(k)));
                let sagitta = sagitta.reduce(f64::max).unwrap();
                let full = PI * radius * radius * height / 3.0;
                let volume = witness::volume(&mesh);
                assert!(volume < full && volume > full - PI * radius * slant * sagitta);
                let area = PI * radius * (radius + slant);
                assert!(witness::area(&mesh) < area);
            }
        }
    }

    #[test]
    fn normals_of_a_cone_are_those_of_its_facets_away_from_the_tip() {
        let (radius, height, n) = (1.0, 2.0, 96.0);
        let mesh = witness::mesh(&Shape::cone(radius, height).unwrap());
        let slant = radius.hypot(height);
        let outer = |&&triangle: &&[u32; 3]| {
            let corners = triangle.map(|index| mesh.positions()[index as usize]);
            corners.iter().all(|&p| from_axis(p) > radius / 4.0)
        };
        let outer: Vec<_> = mesh.triangles().iter().filter(outer).copied().collect();
        let outer = crate::mesh::Mesh::new(mesh.positions().to_vec(), outer).unwrap();
        let outer = outer
            .with_normals(mesh.normals().unwrap().to_vec())
            .unwrap();
        // There, rings have at least half the segments. Around the axis a facet's normal is off by at
        // most one of them; up and down by the sagitta of two over the distance of the rings.
        let bands = (slant * n / (PI * radius)).ceil();
        let limit = 4.0 * PI / n + 2.0 * PI * PI * radius * bands / (n * n * height);
        witness::assert_normals_within(&outer, limit);
    }

    #[test]
    fn a_torus_has_the_volume_of_its_polygon_turned() {
        for (major, minor) in [(1.0, 0.3), (1.0, 0.999), (4.0, 0.01)] {
            for resolution in RESOLUTIONS {
                let shape = Shape::torus(major, minor).unwrap();
                let mesh = witness::mesh(&shape.with_resolution(resolution).unwrap());
                assert_eq!(witness::assert_closed(&mesh), 0);
                witness::assert_well_made(&mesh);
                witness::assert_texture_within(&mesh, 0.5);
                let n = f64::from(resolution);
                let m = (n * minor / major).round().max(3.0);
                // The integral of the distance from the axis over the regular polygon, turned in
                // n steps: the area of a regular polygon replaces that of a circle.
                let polygon = m / 2.0 * (TAU / m).sin() * minor * minor;
                witness::assert_volume(&mesh, n * (TAU / n).sin() * major * polygon);
                for (&p, &normal) in mesh.positions().iter().zip(mesh.normals().unwrap()) {
                    let middle = DVec3::new(p.x, 0.0, p.z).normalize() * major;
                    assert!(((p - middle).length() - minor).abs() < 1e-15 * major, "{p}");
                    assert!(
                        (p - middle - minor * normal).length() < 2e-15 * major,
                        "{p}"
                    );
                }
            }
        }
    }

    #[test]
    fn normals_of_a_torus_are_those_of_its_facets() {
        let mesh = witness::mesh(&Shape::torus(1.0, 0.25).unwrap());
        // Half a segment each way, and the flattening of the wedge to second order.
        let [n, m] = [96.0, 24.0];
        witness::assert_normals_within(&mesh, PI / n + PI / m + (PI / n).powi(2));
    }

    #[test]
    fn a_torus_that_reaches_its_axis_is_refused() {
        let message = Shape::torus(1.0, 1.5).unwrap_err().to_string();
        assert_eq!(
            message,
            "minor_radius is 1.5, expected less than major_radius, which is 1"
        );
        let json = r#"{"major_radius": 1, "minor_radius": 1}"#;
        let message = serde_json::from_str::<Torus>(json).unwrap_err().to_string();
        assert!(
            message.starts_with("minor_radius is 1, expected less"),
            "{message}"
        );
        let json = r#"{"major_radius": 2, "minor_radius": 1, "radius": 1}"#;
        assert!(serde_json::from_str::<Torus>(json).is_err());
    }
}
