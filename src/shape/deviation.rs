//! How far the facets of the round shapes are from the true surfaces, and how fine they have to be.
//!
//! All bounds are two-sided: each point of a facet has a point of the true surface within them, and each
//! point of the true surface a point of a facet. They are proven, in the comments here, and not estimated.

use std::f64::consts::PI;

use super::lathe::{Ring, triangle_count};
use super::size::MAX;
use super::surface::MAX_TRIANGLES;
use super::{Cone, Shape, Sphere, Torus};

/// The coarsest resolution that a tolerance leads to: however large it is, what is round looks round.
const COARSEST: u32 = 12;

/// Relative room for the rounding of a bound, and for that of vertices (at most five epsilon of the
/// shape's size off its surface, by the tests of the shapes).
const ROOM: f64 = 16.0 * f64::EPSILON;

impl Shape {
    /// A bound of the distance between the facets of the shape's mesh and the true curved surface, in the
    /// object's units before `scale`, which may enlarge it by its largest factor.
    ///
    /// Each point of a facet has a point of the true surface within it, and the other way round. Zero
    /// for shapes with flat faces.
    ///
    /// # Derivation
    ///
    /// A chord of angle `a` in a circle of radius `R` is at most its sagitta `R (1 - cos(a/2))` away from
    /// its arc.
    ///
    /// - Sphere: the sagitta of the angle under which the largest facet is seen from the centre. A face of the
    ///   icosahedron, in a plane at distance `h`, is split into equal triangles of circumradius `c`,
    ///   and `cos(a/2) = h / hypot(h, c)` for a triangle in its middle; none is seen larger.
    /// - Cylinder and rod: the sagitta of a segment; the lids are flat, their rims have the same.
    /// - Cone: the sagitta of the rim, or if larger the largest of any band of its side, where
    ///   facets span no more than a segment of the coarser ring, times the cosine of the side's slope.
    /// - Torus: the sagitta of a segment of the tube plus that of a segment of the outermost circle.
    ///
    /// # Accuracy
    ///
    /// Rounded up. What samples deviate is all of it on cylinders and rods, nine tenths on spheres, two thirds on
    /// cones and tori, or more (tests of this module).
    pub fn deviation(&self) -> f64 {
        match self {
            Self::Sphere(shape) => sphere(shape),
            Self::Cylinder(shape) => {
                let around = u64::from(shape.resolution.unwrap_or_default().get());
                cylinder(shape.radius.get(), shape.height.get(), around)
            }
            Self::Rod(shape) => {
                let around = u64::from(shape.resolution.unwrap_or_default().get());
                cylinder(shape.radius.get(), shape.length.get(), around)
            }
            Self::Cone(shape) => cone(shape),
            Self::Torus(shape) => torus(shape),
            Self::Cuboid(_) | Self::Grid(_) | Self::Lattice(_) => 0.0,
        }
    }

    /// The shape with the coarsest resolution whose [`Shape::deviation`] is at most `deviation`.
    ///
    /// At least 12 around, however large the deviation; at most 4096, or what 20 million triangles allow.
    /// Where that is not enough, as for a deviation of zero or NaN, the result has the finest
    /// resolution, and its own deviation tells. A shape with flat faces gets the coarsest resolution. A shape that
    /// has a resolution stays as it is.
    ///
    /// # Example
    ///
    /// ```
    /// use photosurface::Shape;
    ///
    /// let sphere = Shape::sphere(2.0)?.within(1e-4);
    /// assert!(sphere.deviation() <= 1e-4);
    /// let as_asked = Shape::sphere(2.0)?.with_resolution(8)?;
    /// assert_eq!(as_asked.within(1e-4), as_asked);
    /// # Ok::<(), photosurface::shape::ShapeError>(())
    /// ```
    #[must_use]
    pub fn within(&self, deviation: f64) -> Self {
        if self.has_resolution() {
            return self.clone();
        }
        if self.deviation() == 0.0 {
            let coarsest = self.clone().with_resolution(1);
            return coarsest.expect("flat shapes have a resolution of 1");
        }
        let at = |resolution| {
            let shape = self.clone().with_resolution(resolution);
            shape.expect("every resolution from 12 to 4096 is one of a round shape")
        };
        let too_many = |resolution| at(resolution).triangle_count() > MAX_TRIANGLES;
        let finest = first(COARSEST + 1, MAX + 1, too_many) - 1;
        // A cone's deviation is not monotone, as rings are added one by one; its rim's is.
        let start = first(COARSEST, finest, |n| at(n).falling_deviation() <= deviation);
        let resolution = (start..=finest).find(|&n| at(n).deviation() <= deviation);
        at(resolution.unwrap_or(finest))
    }

    /// Whether it has a resolution of its own.
    pub(crate) fn has_resolution(&self) -> bool {
        match self {
            Self::Sphere(shape) => shape.resolution.is_some(),
            Self::Cylinder(shape) => shape.resolution.is_some(),
            Self::Rod(shape) => shape.resolution.is_some(),
            Self::Cone(shape) => shape.resolution.is_some(),
            Self::Torus(shape) => shape.resolution.is_some(),
            Self::Cuboid(shape) => shape.resolution.is_some(),
            Self::Grid(shape) => shape.resolution.is_some(),
            Self::Lattice(shape) => shape.resolution.is_some(),
        }
    }

    /// No more than the deviation, and never larger for a higher resolution.
    fn falling_deviation(&self) -> f64 {
        match self {
            Self::Cone(shape) => {
                let around = u64::from(shape.resolution.unwrap_or_default().get());
                shape.radius.get() * sagitta(around)
            }
            _ => self.deviation(),
        }
    }

    /// Of how many triangles a round shape is made; of others no one asks.
    pub(crate) fn triangle_count(&self) -> u64 {
        match self {
            Self::Sphere(shape) => shape.triangle_count(),
            Self::Cylinder(shape) => triangle_count(&shape.profile()),
            Self::Rod(shape) => triangle_count(&shape.profile()),
            Self::Cone(shape) => triangle_count(&shape.profile()),
            Self::Torus(shape) => 2 * shape.segments().iter().product::<u64>(),
            Self::Cuboid(_) | Self::Grid(_) | Self::Lattice(_) => 0,
        }
    }
}

/// With corners in the cap `p.a >= R cos`, `a` a unit vector, a whole facet is in it, so between `R cos`
/// and `R` from the centre; and the ray from the centre to any point of the sphere meets a facet. What is
/// to be shown is that the corners of each facet are in a cap with `cos = h / hypot(h, c)`.
///
/// They are the directions to points `p` of a circle of radius `c`, in a plane at distance `h`, about a
/// point at the distance `d` and at the angle `t` from the plane's foot, `h = d cos t`. With `k = cos^2` and
/// `K = 2k - 1` take for `a` the direction at the angle `s` from the foot to the same side, where
/// `sin(2s - t) = K sin t`. For the point after the angle `f` on the circle, `(p.a)^2 - k |p|^2` has then no
/// term in `cos f`: it is `(c sin s cos f)^2 + d^2 cos^2(s - t) - k (d^2 + c^2)`, and the last two terms are
/// `d^2 / 2` times `cos t (sqrt(1 - K^2 sin^2 t) - cos t)`, not negative since `K^2 <= 1`.
fn sphere(shape: &Sphere) -> f64 {
    // Of the icosahedron with corners on the unit sphere: the circumradius of a face is 0.6071, its
    // distance from the centre 0.7947; the squares are (10 -+ 2 sqrt(5)) / 15 and 1 minus that.
    let face_circumradius_squared = (10.0 - 2.0 * 5f64.sqrt()) / 15.0;
    let h_squared = 1.0 - face_circumradius_squared;
    let c_squared = face_circumradius_squared / f64::from(shape.splits()).powi(2);
    let corner = (h_squared + c_squared).sqrt();
    // 1 - h / corner
    let sagitta = c_squared / (corner * (corner + h_squared.sqrt()));
    let radius = shape.radius.get();
    rounded_up(radius * sagitta, radius)
}

/// The side is a prism, and the lids are inside the true ones up to the sagitta of the rim.
fn cylinder(radius: f64, height: f64, around: u64) -> f64 {
    rounded_up(radius * sagitta(around), radius + height)
}

/// At each height a facet of the side is a chord between points that are no further out than the cone is
/// there, at an angle of at most one segment of the coarser ring of its band. The cone and the facets are
/// therefore apart by the sagitta at most, horizontally, and the normal of the cone is shorter by the
/// cosine of its slope.
///
/// From a point of a facet along the normal one meets the cone. From a point of the cone against
/// the normal one meets a facet of the side, unless one comes to the lid's plane first, outside the lid's
/// polygon; from there on straight to the lid's edge the way is no longer than the sagitta of the rim.
fn cone(shape: &Cone) -> f64 {
    let [radius, height] = [shape.radius.get(), shape.height.get()];
    let side = &shape.profile()[0].rings;
    let band_sagitta = |band: &[Ring]| {
        // The tip has no segments, and any angle.
        let coarser = match band[0].segments {
            0 => band[1].segments,
            segments => segments.min(band[1].segments),
        };
        band[1].radius * sagitta(coarser)
    };
    let largest = side.windows(2).map(band_sagitta).fold(0.0, f64::max);
    let rim = radius * sagitta(side[side.len() - 1].segments);
    let slope_cosine = height / radius.hypot(height);
    rounded_up(rim.max(largest * slope_cosine), radius + height)
}

/// A facet is half a trapezoid between two rings and two meridians. Cut by a half-plane through the axis, the
/// facets are the tube's polygon with its distance from the axis multiplied by a number between 1 and
/// the cosine of half a segment: shifted, by no more than the sagitta of the outermost circle. The polygon and
/// the tube's circle are apart by no more than the sagitta of a segment of the tube.
fn torus(shape: &Torus) -> f64 {
    let [major, minor] = [shape.major_radius().get(), shape.minor_radius().get()];
    let [around, tube] = shape.segments();
    let deviation = minor * sagitta(tube) + (major + minor) * sagitta(around);
    rounded_up(deviation, major + minor)
}

/// `1 - cos(pi / segments)`: how far a side of a regular polygon is inside its circle of radius 1.
fn sagitta(segments: u64) -> f64 {
    2.0 * (PI / (2 * segments) as f64).sin().powi(2)
}

fn rounded_up(deviation: f64, size: f64) -> f64 {
    deviation * (1.0 + ROOM) + ROOM * size
}

/// The first number from `low` on for which `holds`, if it holds for all after it; at most `high`.
fn first(mut low: u32, mut high: u32, holds: impl Fn(u32) -> bool) -> u32 {
    while low < high {
        let middle = low + (high - low) / 2;
        if holds(middle) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use glam::{DVec2, DVec3};

    use super::super::{Appearance, witness};
    use super::*;

    const RESOLUTIONS: [u32; 9] = [3, 4, 5, 6, 7, 9, 12, 13, 30];

    /// Round shapes of many proportions, without a resolution.
    fn round_shapes() -> Vec<Shape> {
        let mut shapes = vec![Shape::sphere(2.5)];
        for (radius, length) in [(1.0, 2.0), (1.0, 0.02), (0.5, 8.0)] {
            shapes.push(Shape::cylinder(radius, length));
            shapes.push(Shape::rod(length, radius));
        }
        for (radius, height) in [(1.0, 1.0), (1.0, 2.0), (1.0, 4.0), (1.0, 12.0), (3.0, 0.2)] {
            shapes.push(Shape::cone(radius, height));
        }
        for (major, minor) in [(1.0, 0.25), (1.0, 0.5), (1.0, 0.99), (1.0, 0.03)] {
            shapes.push(Shape::torus(major, minor));
        }
        shapes.into_iter().map(Result::unwrap).collect()
    }

    /// The curve in the half-plane of radius and height that makes the surface when it is turned.
    enum Outline {
        Arc { middle: DVec2, radius: f64 },
        Polygon(Vec<DVec2>),
    }

    impl Outline {
        fn of(shape: &Shape) -> Self {
            let cylinder = |radius: f64, half: f64| {
                let corners = [(0.0, half), (radius, half), (radius, -half), (0.0, -half)];
                Self::Polygon(corners.map(DVec2::from).to_vec())
            };
            match shape {
                Shape::Sphere(sphere) => Self::Arc {
                    middle: DVec2::ZERO,
                    radius: sphere.radius.get(),
                },
                Shape::Cylinder(shape) => cylinder(shape.radius.get(), shape.height.get() / 2.0),
                Shape::Rod(shape) => cylinder(shape.radius.get(), shape.length.get() / 2.0),
                Shape::Cone(cone) => {
                    let [radius, half] = [cone.radius.get(), cone.height.get() / 2.0];
                    let corners = [(0.0, half), (radius, -half), (0.0, -half)];
                    Self::Polygon(corners.map(DVec2::from).to_vec())
                }
                Shape::Torus(torus) => Self::Arc {
                    middle: DVec2::new(torus.major_radius().get(), 0.0),
                    radius: torus.minor_radius().get(),
                },
                flat => panic!("{flat:?} is not round"),
            }
        }

        /// The distance of a point from the true surface.
        fn distance(&self, point: DVec3) -> f64 {
            let point = DVec2::new(point.x.hypot(point.z), point.y);
            match self {
                Self::Arc { middle, radius } => (point.distance(*middle) - radius).abs(),
                Self::Polygon(corners) => {
                    let sides = corners.windows(2).map(|side| {
                        let along = side[1] - side[0];
                        let part = (point - side[0]).dot(along) / along.length_squared();
                        point.distance(side[0] + along * part.clamp(0.0, 1.0))
                    });
                    sides.fold(f64::INFINITY, f64::min)
                }
            }
        }

        /// Points of the curve, its corners among them.
        fn points(&self, count: u32) -> Vec<DVec2> {
            match self {
                Self::Arc { middle, radius } => (0..count)
                    .map(|i| TAU * f64::from(i) / f64::from(count))
                    .map(|angle| *middle + *radius * DVec2::from_angle(angle))
                    .filter(|point| point.x >= 0.0)
                    .collect(),
                Self::Polygon(corners) => corners
                    .windows(2)
                    .flat_map(|side| {
                        let part = move |i| f64::from(i) / f64::from(count);
                        (0..=count).map(move |i| side[0].lerp(side[1], part(i)))
                    })
                    .collect(),
            }
        }
    }

    /// The largest distance of points of the facets from the true surface.
    fn from_facets(triangles: &[[DVec3; 3]], outline: &Outline, grid: u32) -> f64 {
        let mut largest: f64 = 0.0;
        for [a, b, c] in triangles {
            for i in 0..=grid {
                for j in 0..=grid - i {
                    let [u, v] = [i, j].map(|k| f64::from(k) / f64::from(grid));
                    let point = *a * (1.0 - u - v) + *b * u + *c * v;
                    largest = largest.max(outline.distance(point));
                }
            }
        }
        largest
    }

    /// The largest distance of points of the true surface from the facets.
    fn from_surface(triangles: &[[DVec3; 3]], outline: &Outline, around: u32) -> f64 {
        let mut largest: f64 = 0.0;
        for point in outline.points(around / 2) {
            for i in 0..around {
                let direction = DVec2::from_angle(TAU * f64::from(i) / f64::from(around));
                let point = DVec3::new(point.x * direction.x, point.y, point.x * direction.y);
                let mut nearest = f64::INFINITY;
                for triangle in triangles {
                    // No need to look closer where all of it is too far.
                    let size = triangle[0]
                        .distance(triangle[1])
                        .max(triangle[0].distance(triangle[2]));
                    if point.distance(triangle[0]) - size < nearest {
                        nearest = nearest.min(from_triangle(point, *triangle));
                    }
                    if nearest <= largest {
                        break;
                    }
                }
                largest = largest.max(nearest);
            }
        }
        largest
    }

    fn from_triangle(point: DVec3, corners: [DVec3; 3]) -> f64 {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize();
        let edges = [(a, b), (b, c), (c, a)];
        if edges
            .iter()
            .all(|&(from, to)| (to - from).cross(point - from).dot(normal) >= 0.0)
        {
            return (point - a).dot(normal).abs();
        }
        let to_edges = edges.map(|(from, to)| {
            let part = (point - from).dot(to - from) / (to - from).length_squared();
            point.distance(from.lerp(to, part.clamp(0.0, 1.0)))
        });
        to_edges.into_iter().fold(f64::INFINITY, f64::min)
    }

    fn facets(shape: &Shape) -> Vec<[DVec3; 3]> {
        let mesh = witness::mesh(shape);
        let corner = |index: u32| mesh.positions()[index as usize];
        let triangles = mesh.triangles().iter();
        triangles.map(|corners| corners.map(corner)).collect()
    }

    #[test]
    fn the_bound_contains_every_sample_and_little_more() {
        for shape in round_shapes() {
            let tightness = match shape {
                Shape::Sphere(_) => 0.9,
                Shape::Cylinder(_) | Shape::Rod(_) => 1.0 - 1e-6,
                _ => 2.0 / 3.0,
            };
            for resolution in RESOLUTIONS {
                let shape = shape.clone().with_resolution(resolution).unwrap();
                let facets = facets(&shape);
                let outline = Outline::of(&shape);
                let bound = shape.deviation();
                let there = from_facets(&facets, &outline, 8);
                let back = from_surface(&facets, &outline, 4 * resolution.min(16));
                let samples = format!("{shape:?}: {there:e} from and {back:e} to a facet");
                let largest = there.max(back);
                assert!(largest <= bound, "{samples}, bound {bound:e}");
                assert!(largest >= tightness * bound, "{samples}, bound {bound:e}");
            }
        }
    }

    #[test]
    fn a_tolerance_gets_the_coarsest_resolution_that_keeps_it() {
        for shape in round_shapes() {
            let mut finer = MAX;
            for exponent in -24..=4 {
                let deviation = 10f64.powf(f64::from(exponent) / 4.0);
                let fitting = shape.within(deviation);
                let found = fitting.resolution().unwrap();
                assert!((COARSEST..=finer).contains(&found), "{fitting:?}");
                finer = found;
                let at = |n| shape.clone().with_resolution(n).unwrap();
                let finest = found == MAX || at(found + 1).triangle_count() > MAX_TRIANGLES;
                assert!(fitting.deviation() <= deviation || finest, "{fitting:?}");
                assert!(fitting.triangle_count() <= MAX_TRIANGLES, "{fitting:?}");
                // Those all but as fine one by one, the others here and there.
                let step = |n: u32| if found - n < 40 { 1 } else { 1 + n / 8 };
                let mut coarser = COARSEST;
                while coarser < found {
                    let other = at(coarser).deviation();
                    assert!(other > deviation, "{coarser} would do: {fitting:?}");
                    coarser += step(coarser);
                }
            }
            assert_eq!(finer, COARSEST);
        }
    }

    #[test]
    fn the_finest_is_the_result_where_nothing_is_enough() {
        for shape in round_shapes() {
            for deviation in [0.0, -1.0, f64::NAN] {
                let fitting = shape.within(deviation);
                let found = fitting.resolution().unwrap();
                let next = shape.clone().with_resolution(found + 1);
                let no_finer = next.map_or(true, |next| next.triangle_count() > MAX_TRIANGLES);
                assert!(no_finer, "{fitting:?}");
                assert!(fitting.triangle_count() <= MAX_TRIANGLES, "{fitting:?}");
            }
        }
    }

    #[test]
    fn a_shape_keeps_its_own_resolution() {
        for shape in round_shapes().into_iter().chain(flat_shapes()) {
            let explicit = shape.with_resolution(5).unwrap();
            assert_eq!(explicit.within(1e-3), explicit);
        }
    }

    #[test]
    fn flat_faces_need_no_pieces() {
        for shape in flat_shapes() {
            assert_eq!(shape.deviation(), 0.0);
            assert_eq!(shape.within(1e-3), shape.with_resolution(1).unwrap());
        }
    }

    fn flat_shapes() -> [Shape; 3] {
        [
            Shape::cuboid([1.0, 2.0, 3.0]),
            Shape::grid(1.0, 4),
            Shape::lattice([2, 3, 4], 1.0, 0.1),
        ]
        .map(Result::unwrap)
    }

    #[test]
    fn triangles_are_counted_before_they_are_made() {
        for shape in round_shapes() {
            for resolution in [None, Some(3), Some(14), Some(40)] {
                let shape = match resolution {
                    Some(resolution) => shape.clone().with_resolution(resolution).unwrap(),
                    None => shape.clone(),
                };
                let made = shape.model(&Appearance::default()).unwrap();
                assert_eq!(
                    shape.triangle_count(),
                    made.triangle_count() as u64,
                    "{shape:?}"
                );
            }
        }
    }
}
