//! Penrose and Terrell: however fast a sphere passes, its outline is a circle.
//!
//! The outline of a mesh is made of the edges between a triangle that faces the observer and one that faces
//! away. In the mapped mesh of a fine sphere the ends of these edges must lie on the circle of
//! `fixtures/penrose_terrell.json`, to within what the mesh resolves.
//!
//! # Where the limit comes from
//!
//! Let a triangle's corners lie on a sphere of radius `R`, its circumcircle having the radius
//! `R sin kappa`. Its plane is `R cos kappa` from the centre; its normal points at the middle of the
//! circle, at an angle `phi` from the direction to the observer, who is at the distance
//! `H = |d cos phi - R cos kappa|` from the plane.
//!
//! 1. *Facing.* Three mapped corners are `p_i = A d_i` with `A` a boost plus `gamma beta n g^T`, where
//!    `g . d_i = r_i`, and `det A = gamma (1 + beta g.n)`. So they face as they do at rest unless
//!    `beta |g| > 1`. Now `|g| = 1 / cos rho`, with `rho` the angular circumradius of the triangle on the
//!    sky, and `tan rho <= R sin(kappa) / H`. Hence facing changes only where
//!    `H < gamma beta R sin kappa`.
//! 2. *Where on the sphere.* So an edge between the two kinds has its ends within `kappa` of
//!    `cos phi = (R / d) (cos kappa +- gamma beta sin kappa)`, the largest `kappa` of the mesh being taken.
//! 3. *Where on the sky at rest.* The sphere's point at `phi` is seen `atan(R sin phi / (d - R cos phi))` from
//!    its centre, at most `psi'` on the tangent circle `cos phi = R / d`. The end farthest from that circle
//!    is inside the outline by the limit at rest, of second order in `kappa`.
//! 4. *Where on the sky in motion.* Aberration magnifies angles by `1 / D`, at most by that of the point of
//!    the disc nearest to the direction in which the object moves.

use std::collections::HashMap;
use std::f64::consts::PI;

use photosurface::light_cone::PhotosurfaceMap;
use photosurface::shape::Appearance;
use photosurface::{DVec3, Shape, Velocity};
use serde_json::Value;

/// One line of the fixture; angles in radians.
#[derive(Debug)]
struct Case {
    beta: f64,
    centre: DVec3,
    radius: f64,
    half_angle: f64,
    centre_angle: f64,
}

fn cases() -> Vec<Case> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/penrose_terrell.json");
    let text = std::fs::read_to_string(path).expect("the fixture is there");
    let fixture: Value = serde_json::from_str(&text).expect("the fixture is JSON");
    let cases = fixture["cases"].as_array().expect("a list of cases");
    cases
        .iter()
        .map(|case| {
            let number = |value: &Value| value.as_f64().expect("a number");
            Case {
                beta: number(&case["beta"]),
                centre: DVec3::from_array([0, 1, 2].map(|i| number(&case["centre"][i]))),
                radius: number(&case["radius"]),
                half_angle: number(&case["half_angle_deg"]).to_radians(),
                centre_angle: number(&case["centre_angle_deg"]).to_radians(),
            }
        })
        .collect()
}

/// Positions and triangles, every position once.
struct Surface {
    positions: Vec<DVec3>,
    triangles: Vec<[usize; 3]>,
}

impl Surface {
    /// A sphere about the origin, welded: vertices with one place and two texture coordinates would cut
    /// the outline.
    fn sphere(radius: f64, resolution: u32) -> Self {
        let model = Shape::sphere(radius)
            .and_then(|shape| shape.with_resolution(resolution))
            .and_then(|shape| shape.model(&Appearance::default()))
            .expect("a sphere");
        let mesh = model.parts[0].mesh();
        let mut positions = Vec::new();
        let mut known = HashMap::new();
        let welded: Vec<usize> = mesh
            .positions()
            .iter()
            .map(|&position| {
                // Adding zero makes the two zeros one.
                let key = (position + DVec3::ZERO).to_array().map(f64::to_bits);
                *known.entry(key).or_insert_with(|| {
                    positions.push(position);
                    positions.len() - 1
                })
            })
            .collect();
        let triangles = mesh.triangles().iter();
        let triangles = triangles
            .map(|corners| corners.map(|corner| welded[corner as usize]))
            .collect();
        Self {
            positions,
            triangles,
        }
    }

    fn moved(&self, place: impl Fn(DVec3) -> DVec3) -> Self {
        Self {
            positions: self.positions.iter().map(|&at| place(at)).collect(),
            triangles: self.triangles.clone(),
        }
    }

    /// The largest circumradius of a triangle.
    fn circumradius(&self) -> f64 {
        let radii = self.triangles.iter().map(|corners| {
            let [a, b, c] = corners.map(|corner| self.positions[corner]);
            let twice_area = (b - a).cross(c - a).length();
            (b - a).length() * (c - b).length() * (a - c).length() / (2.0 * twice_area)
        });
        radii.fold(0.0, f64::max)
    }

    /// The ends of all edges between a triangle that faces the origin and one that faces away.
    fn outline(&self) -> Vec<DVec3> {
        let mut facing_sides: HashMap<[usize; 2], Vec<bool>> = HashMap::new();
        for corners in &self.triangles {
            let [a, b, c] = corners.map(|corner| self.positions[corner]);
            let faces_origin = (b - a).cross(c - a).dot(a) < 0.0;
            for (from, to) in [(0, 1), (1, 2), (2, 0)] {
                let mut edge = [corners[from], corners[to]];
                edge.sort_unstable();
                facing_sides.entry(edge).or_default().push(faces_origin);
            }
        }
        let mut outline = Vec::new();
        for (edge, sides) in facing_sides {
            assert_eq!(sides.len(), 2, "a sphere has no borders");
            if sides[0] != sides[1] {
                outline.extend(edge.map(|end| self.positions[end]));
            }
        }
        outline
    }
}

impl Case {
    fn map(&self) -> PhotosurfaceMap {
        // The object moves along +x, so the observer moves along -x in its rest frame.
        PhotosurfaceMap::new(&Velocity::from_beta(self.beta, DVec3::NEG_X).expect("valid"))
    }

    /// The direction to the centre of the outline.
    fn axis(&self) -> DVec3 {
        let aside = DVec3::new(0.0, self.centre.y, self.centre.z).normalize();
        DVec3::X * self.centre_angle.cos() + aside * self.centre_angle.sin()
    }

    /// How far, in radians, the farthest point is from the circle of the outline.
    ///
    /// The points must be all around it: none of 12 sectors may be empty.
    fn deviation(&self, outline: &[DVec3]) -> f64 {
        let axis = self.axis();
        let (up, aside) = axis.any_orthonormal_pair();
        let mut sectors = [0; 12];
        let mut largest = 0f64;
        for &point in outline {
            let from_axis = axis.cross(point).length().atan2(axis.dot(point));
            largest = largest.max((from_axis - self.half_angle).abs());
            let around = point.dot(aside).atan2(point.dot(up)) + PI;
            sectors[((around / (2.0 * PI) * 12.0) as usize).min(11)] += 1;
        }
        assert!(!sectors.contains(&0), "gaps in the outline: {sectors:?}");
        largest
    }

    /// The limit derived above, for a mesh with this largest circumradius.
    fn limit(&self, circumradius: f64) -> f64 {
        let (radius, distance) = (self.radius, self.centre.length());
        let kappa = (circumradius / radius).asin();
        let gamma_beta = self.beta / ((1.0 - self.beta) * (1.0 + self.beta)).sqrt();
        let gamma = gamma_beta / self.beta;

        let on_sphere = |sign: f64| {
            let cosine = radius / distance * (kappa.cos() + sign * gamma_beta * kappa.sin());
            (cosine.clamp(-1.0, 1.0).acos() - sign * kappa).clamp(0.0, PI)
        };
        let half_angle_at_rest = (radius / distance).asin();
        let inside = |phi: f64| {
            half_angle_at_rest - (radius * phi.sin()).atan2(distance - radius * phi.cos())
        };
        let at_rest = inside(on_sphere(1.0)).max(inside(on_sphere(-1.0)));

        let centre_at_rest = self.centre.angle_between(DVec3::X);
        let nearest = (centre_at_rest - half_angle_at_rest).max(0.0);
        let smallest_doppler = gamma * (1.0 - self.beta * nearest.cos());
        at_rest / smallest_doppler
    }
}

#[test]
fn the_outline_of_a_passing_sphere_is_the_circle_of_penrose_and_terrell() {
    for case in cases() {
        let mut coarser = f64::INFINITY;
        for resolution in [64, 128, 256] {
            let sphere = Surface::sphere(case.radius, resolution);
            let limit = case.limit(sphere.circumradius());
            let map = case.map();
            let seen = sphere.moved(|point| map.seen_position(case.centre + point));
            let deviation = case.deviation(&seen.outline());
            println!("{case:?}, resolution {resolution}: {deviation:e} of {limit:e}");
            assert!(
                deviation <= limit,
                "{case:?}, resolution {resolution}: {deviation:e} off the circle, limit {limit:e}"
            );
            // Of second order: twice as fine is nearly four times as close.
            assert!(limit < coarser / 3.0, "the limit does not shrink");
            coarser = limit;
        }
        // And it does say something about this circle.
        assert!(coarser < 0.02 * case.half_angle, "limit {coarser:e}");
    }
}

/// The same test on bodies whose outline is another: it must tell them by far.
#[test]
fn other_bodies_are_not_taken_for_a_sphere() {
    for case in cases() {
        let sphere = Surface::sphere(case.radius, 256);
        let limit = case.limit(sphere.circumradius());
        let map = case.map();

        // A rest-frame ellipsoid a fifth longer across the motion and the line of sight.
        let ellipsoid = sphere
            .moved(|point| map.seen_position(case.centre + point * DVec3::new(1.0, 1.0, 1.2)));
        // A sphere that is merely Lorentz-contracted, put where its centre is seen.
        let contraction = ((1.0 - case.beta) * (1.0 + case.beta)).sqrt();
        let seen_centre = map.seen_position(case.centre);
        let contracted =
            sphere.moved(|point| seen_centre + point * DVec3::new(contraction, 1.0, 1.0));
        // A sphere of that size that is not even contracted.
        let at_rest = sphere.moved(|point| seen_centre + point);

        for (body, surface) in [
            ("an ellipsoid", ellipsoid),
            ("a contracted sphere", contracted),
            ("a sphere at rest", at_rest),
        ] {
            let axis = case.axis();
            let outline = surface.outline();
            let off = outline
                .iter()
                .map(|point| (point.angle_between(axis) - case.half_angle).abs())
                .fold(0.0, f64::max);
            println!("{case:?}, {body}: {off:e}, limit {limit:e}");
            assert!(
                off > 10.0 * limit,
                "{case:?}: {body} is only {off:e} off, limit {limit:e}"
            );
        }
    }
}
