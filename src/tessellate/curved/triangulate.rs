//! The triangles of a round shape, with vertices on it, within a tolerance of its photosurface: made, proven, and repaired
//! where the proof finds more than the estimate did.

use std::collections::{HashMap, HashSet};

use glam::{DVec2, DVec3};

use super::bounds::{BoundsOf, points_of, proven};
use super::net::{Net, Task};
use super::refine::Side;
use super::rims::divided_rims;
use super::sight::{About, Sight};
use crate::mesh::Mesh;
use crate::shape::{Body, Piece, Shape, Spot};
use crate::tessellate::count::Count;

/// How often triangles that are not proven are divided, and how often before the longest ones come first, by their longest
/// sides. Where two share a side, dividing that first again and again would leave the long side of one of them as it is. And
/// later on each so many times by the sides that are longest at rest.
const REPAIRS: usize = 60;
const REPAIRS_AT_FIRST: usize = 4;
const REPAIRS_AS_SEEN: usize = 12;
const EACH_TIMES: usize = 4;

/// How many times as many triangles as before there may be after each of refinement and repairs, and a few that do not count
/// in each.
const MOST_TIMES: usize = 3;
const FEW: [usize; 2] = [1_000, 10_000];

/// The wanted lengths of sides, as [`Task::aim`]. Where a photosurface bends in all directions, a triangle that is divided may
/// fold those beside it, and these, divided, others. A front whose sides have another length meets other triangles there. The
/// next length is tried where more than so many per cent of the triangles of the front are there after dividing.
const AIMS: [f64; 3] = [0.95, 0.93, 0.91];
const CALM: usize = 115;

/// A front that does not start is started with so many times the triangles of the body.
const STARTED: usize = 4;

/// How many looks at places each proof may take, and some that do not count. Most take 6 to 15; small meshes with tips take
/// most.
const LOOKS: u64 = 100;
const SOME_LOOKS: u64 = 200_000;

/// So many triangles more than there may be, beside a quarter, may be taken away again.
const SPARE: usize = 5_000;

/// The triangles of a round shape.
#[derive(Clone, Debug)]
pub(crate) struct Triangulated {
    /// In the shape's own frame, with normals and texture coordinates.
    pub(crate) mesh: Mesh,
    /// For each sight two bounds of each triangle, in the order of the mesh, as surfaces and between points: lengths in the
    /// observer's frame.
    pub(crate) bounds: Vec<Vec<[f64; 2]>>,
}

impl Triangulated {
    /// The number of triangles.
    pub(super) fn count(&self) -> usize {
        self.mesh.triangle_count()
    }
}

/// The triangles of a round shape for all of these sights by one measure, at most `most` of them or those of the coarsest
/// form; `None` if there are more or one cannot be proven.
pub(crate) fn triangulate_about(
    shape: &Shape,
    sights: &[Sight],
    about: About,
    most: u64,
) -> Option<Triangulated> {
    let pieces = shape.pieces(about == About::Points);
    let task = task(&pieces, sights, about);
    let (net, bounds) = within(task, usize::try_from(most).unwrap_or(usize::MAX))?;
    Some(assembled(shape, &net, bounds))
}

/// The coarsest form of a round shape, with no bounds.
pub(super) fn coarsest(shape: &Shape, sights: &[Sight], about: About) -> Triangulated {
    let pieces = shape.pieces(about == About::Points);
    let task = task(&pieces, sights, about);
    let net = Net::new(&Body::coarsest(&pieces), task);
    assembled(shape, &net, BoundsOf::new())
}

fn task<'a>(pieces: &'a [Piece], sights: &'a [Sight], about: About) -> Task<'a> {
    Task {
        pieces,
        sights,
        about,
        aim: AIMS[0],
    }
}

/// The net for a task, with its bounds; `None` if it has more than `most` triangles and more than the coarsest body, or if one
/// of them cannot be proven.
fn within(task: Task<'_>, most: usize) -> Option<(Net<'_>, BoundsOf)> {
    let rims = divided_rims(task.pieces, task.sights, most);
    let body = Body::new(task.pieces, &rims);
    let most = most.max(Body::coarsest(task.pieces).triangles.len());
    let limit = most.saturating_add(most / 4).saturating_add(SPARE);
    let mut grown = Grown::new(&body, task, limit);
    for &aim in &AIMS[1..] {
        if grown.is_calm() {
            break;
        }
        let other = Grown::new(&body, Task { aim, ..task }, limit);
        if other.net.count() < grown.net.count() {
            grown = other;
        }
    }
    let Grown {
        mut net, may_be, ..
    } = grown;
    if net.triangles.len() > limit.min(may_be) {
        return None;
    }
    net.tidy();
    let bounds = repaired(&mut net, most)?;
    (net.count() <= most).then_some((net, bounds))
}

/// A net after its front and what that has left.
struct Grown<'a> {
    net: Net<'a>,
    /// How many triangles the front has made.
    by_front: usize,
    /// The largest number of triangles that is worth a proof.
    may_be: usize,
}

impl<'a> Grown<'a> {
    fn new(body: &Body, task: Task<'a>, limit: usize) -> Self {
        let mut net = Net::new(body, task);
        net.advance(limit);
        let coarsest = body.triangles.len();
        if net.triangles.len() == coarsest {
            // Where no vertex fits between those of the body, it may between more of them.
            net.refine(STARTED * coarsest);
            net.advance(limit);
        }
        let by_front = net.triangles.len();
        let may_be = MOST_TIMES * by_front + FEW[0];
        net.refine(limit.min(may_be));
        Self {
            net,
            by_front,
            may_be,
        }
    }

    /// Whether the front has left little.
    fn is_calm(&self) -> bool {
        self.net.triangles.len() <= CALM * self.by_front / 100
    }
}

/// The bounds of all triangles, after those that are not proven, and lines, have been divided; `None` if some never are. Stops
/// where there are more than `most`.
fn repaired(net: &mut Net<'_>, most: usize) -> Option<BoundsOf> {
    let mut bounds = BoundsOf::new();
    let mut open: Vec<usize> = (0..net.triangles.len()).filter(|&t| net.alive[t]).collect();
    let most = most.min(MOST_TIMES * open.len() + FEW[1]);
    let proofs = open.len() * net.task.sights.len();
    let looks = Count::up_to(LOOKS * proofs as u64 + SOME_LOOKS);
    for repair in 0..=REPAIRS {
        let found = proven(net, &open, &looks)?;
        let failed = open.iter().copied();
        let mut failed: Vec<usize> = failed
            .filter(|t| !(net.share(*t, &found[t]).1 <= 1.0) || net.is_line(*t))
            .collect();
        bounds.extend(found);
        if failed.is_empty() {
            return Some(bounds);
        }
        if net.count() > most {
            break;
        }
        let side = side_to_cut(repair);
        if side != Side::Worst {
            let length = |t: &usize| {
                let (_, bound) = net.share(*t, &bounds[t]);
                net.lengths_as_seen(*t, bound)
                    .into_iter()
                    .fold(0.0, f64::max)
            };
            failed.sort_by(|a, b| length(b).total_cmp(&length(a)).then(a.cmp(b)));
        }
        let mut changed = HashSet::new();
        for triangle in failed {
            // A neighbour's division may have changed it.
            if !changed.contains(&triangle) {
                let excess = net.share(triangle, &bounds[&triangle]);
                changed.extend(net.cut(triangle, excess, side));
            }
        }
        open = changed.into_iter().collect();
        open.sort_unstable();
    }
    None
}

/// Which sides are divided in a repair.
fn side_to_cut(repair: usize) -> Side {
    match repair {
        0..REPAIRS_AT_FIRST => Side::Worst,
        REPAIRS_AS_SEEN.. if (repair + 1).is_multiple_of(EACH_TIMES) => Side::LongestAtRest,
        _ => Side::LongestAsSeen,
    }
}

/// The mesh of a net and the bounds of its triangles.
fn assembled(shape: &Shape, net: &Net<'_>, bounds: BoundsOf) -> Triangulated {
    let (mut positions, mut normals, mut textures, mut triangles) =
        (vec![], vec![], vec![], vec![]);
    let mut known: HashMap<(u32, u8, [u32; 2]), u32> = HashMap::new();
    let of_points = points_of(net);
    let mut of_sights = vec![vec![]; net.task.sights.len()];
    for triangle in (0..net.triangles.len()).filter(|&t| net.alive[t]) {
        let (corners, of) = (net.triangles[triangle], net.of[triangle]);
        let piece = net.piece_of(triangle);
        let spots = corners.map(|corner| &net.vertices[corner as usize].spot);
        let places = shape.texture_of(piece, spots).map(DVec2::as_vec2);
        let pole = (0..3).find(|&k| piece.is_pole(spots[k]));
        triangles.push([0, 1, 2].map(|k| {
            let key = (corners[k], of, places[k].to_array().map(f32::to_bits));
            *known.entry(key).or_insert_with(|| {
                // Adding zero turns -0 into +0.
                positions.push(net.vertices[corners[k] as usize].place + DVec3::ZERO);
                normals.push(normal_at(piece, spots, k, pole) + DVec3::ZERO);
                textures.push(places[k]);
                (positions.len() - 1) as u32
            })
        }));
        let own = [bounds.get(&triangle), of_points.get(&triangle)];
        for (number, all) in of_sights.iter_mut().enumerate() {
            let [proven, of_points] = own.map(|own| own.map_or(f64::INFINITY, |own| own[number]));
            // Under the measure of points what is proven is about them.
            all.push(match net.task.about {
                About::Points => [proven; 2],
                About::Surface => [proven, of_points.max(proven)],
            });
        }
    }
    let mesh = Mesh::new(positions, triangles)
        .and_then(|mesh| mesh.with_normals(normals))
        .and_then(|mesh| mesh.with_texture_coordinates(textures))
        .expect("finite vertices of a shape, and indices of them")
        .made_by(shape.clone());
    Triangulated {
        mesh,
        bounds: of_sights,
    }
}

/// The normal at a corner; at the tip of a cone that in the middle of the triangle.
fn normal_at(piece: &Piece, spots: [&Spot; 3], k: usize, pole: Option<usize>) -> DVec3 {
    if let (Piece::Slope { .. }, true) = (piece, pole == Some(k)) {
        let mean = piece.normal_of(spots[(k + 1) % 3]) + piece.normal_of(spots[(k + 2) % 3]);
        // As steep as the side.
        let level = DVec3::new(mean.x, 0.0, mean.z).normalize_or_zero();
        let up = 0.5 * mean.y;
        return level * (1.0 - up * up).max(0.0).sqrt() + DVec3::Y * up;
    }
    piece.normal_of(spots[k])
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::*;
    use crate::spacetime::Velocity;
    use crate::tessellate::curved::attempts::triangulate;
    use crate::tessellate::curved::minimum::needed;
    use crate::tessellate::curved::sight::Allowed;

    fn sight(beta: f64, tolerance: f64, scale: DVec3) -> Sight {
        let velocity = Velocity::from_beta(beta, DVec3::X).unwrap();
        let to_offset = DAffine3::from_scale_rotation_translation(
            scale,
            glam::DQuat::IDENTITY,
            DVec3::new(-2.0, 0.3, 0.1),
        );
        Sight::new(&velocity, to_offset, Allowed::Length(tolerance))
    }

    /// The distance of a seen place from the photosurface of a sphere, by a search over directions.
    fn distance(sight: &Sight, target: DVec3, mut direction: DVec3) -> f64 {
        let at = |direction: DVec3| sight.seen(direction.normalize()).distance(target);
        let (mut best, mut step) = (at(direction), 0.05);
        while step > 1e-9 {
            let (u, v) = direction.normalize().any_orthonormal_pair();
            let tried =
                [u, -u, v, -v, u + v, u - v, v - u, -u - v].map(|way| direction + way * step);
            match tried.into_iter().find(|&way| at(way) < best) {
                Some(better) => (best, direction) = (at(better), better.normalize()),
                None => step *= 0.5,
            }
        }
        best
    }

    /// Triangles of ruled surfaces are as long as their rulings, also where these meet in the tip of a cone.
    #[test]
    fn ruled_shapes_at_rest_take_hardly_more_than_theory_asks_for() {
        let shapes = [Shape::cylinder(1.0, 2.0), Shape::cone(1.0, 2.0)].map(Result::unwrap);
        let cases = shapes
            .iter()
            .flat_map(|shape| [1e-4, 1e-5, 1e-6].map(|part| (shape, part)));
        for (shape, part) in cases {
            let sight = sight(0.0, part * 12f64.sqrt(), DVec3::ONE);
            let sights = std::slice::from_ref(&sight);
            let made = triangulate_about(shape, sights, About::Surface, u64::MAX);
            let count = made.expect("all are proven").count();
            let least = needed(shape, &sight, About::Surface).least;
            assert!(
                (count as f64) < 1.1 * least,
                "{shape:?} {part}: {count} {least}"
            );
        }
    }

    #[test]
    fn spheres_take_little_more_than_theory_asks_for_and_are_proven() {
        let shape = Shape::sphere(1.0).unwrap();
        for (beta, tolerance, scale, most) in [
            (0.0, 3e-3, DVec3::ONE, 1.5),
            (0.5, 3e-3, DVec3::ONE, 1.6),
            (0.9, 3e-3, DVec3::ONE, 1.7),
            (0.99, 5e-3, DVec3::ONE, 1.7),
            (0.9, 5e-3, DVec3::new(1.0, 0.5, 2.0), 1.9),
        ] {
            let sight = sight(beta, tolerance, scale);
            let sights = std::slice::from_ref(&sight);
            let made = triangulate(&shape, sights, About::Surface, u64::MAX).unwrap();
            let count = made.mesh.triangle_count();
            let least = needed(&shape, &sight, About::Surface);
            assert!(
                made.bounds[0].iter().all(|&[bound, _]| bound <= tolerance),
                "{beta}"
            );
            assert!(
                (count as f64) < most * least.least,
                "{beta}: {count} {least:?}"
            );
            assert!(count as f64 > least.least, "{beta}: {count} {least:?}");
            assert!(least.error < 0.02 * least.least, "{beta}: {least:?}");
            // Samples of triangles and of the surface.
            let (positions, triangles) = (made.mesh.positions(), made.mesh.triangles());
            for (index, corners) in triangles.iter().enumerate().step_by(7) {
                let places = corners.map(|corner| positions[corner as usize]);
                let seen = places.map(|place| sight.seen(place));
                for weights in [[1.0 / 3.0; 3], [0.5, 0.5, 0.0], [0.1, 0.2, 0.7]] {
                    let mix = |of: [DVec3; 3]| (0..3).map(|k| of[k] * weights[k]).sum::<DVec3>();
                    let found = distance(&sight, mix(seen), mix(places).normalize());
                    let [of_surface, of_points] = made.bounds[0][index];
                    assert!(found <= of_surface * (1.0 + 1e-9), "{beta}: {found}");
                    // The ray from the centre through the flat place at rest meets the place with the same weights.
                    let same = sight.seen(mix(places).normalize());
                    let found = same.distance(mix(seen));
                    assert!(found <= of_points * (1.0 + 1e-9), "{beta}: {found}");
                }
            }
        }
    }

    /// The sides of triangles, by the bits of their ends: each is there once each way. And no triangle is a line.
    fn assert_closed(mesh: &Mesh, case: &str) {
        let positions = mesh.positions();
        let bits = |corner: u32| positions[corner as usize].to_array().map(f64::to_bits);
        let mut sides = HashSet::new();
        for &[a, b, c] in mesh.triangles() {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                assert!(sides.insert((bits(from), bits(to))), "{case}");
            }
            let [a, b, c] = [a, b, c].map(|corner| positions[corner as usize]);
            let longest = (b - a).length().max((c - b).length()).max((a - c).length());
            let height = (b - a).cross(c - a).length() / longest;
            assert!(height > 1e-9 * longest, "{case}: {a} {b} {c}");
        }
        assert!(
            sides.iter().all(|&(from, to)| sides.contains(&(to, from))),
            "{case}"
        );
    }

    /// From many places, also of few triangles: the net covers the sphere once, and no triangle reaches across its middle.
    #[test]
    fn points_of_spheres_are_few_from_wherever_they_are_seen() {
        let shape = Shape::sphere(1.0).unwrap();
        let mut proven = 0;
        for (k, observer) in (0..40).flat_map(|k| {
            let along = [-8.0, -4.0, -1.5, 4.0, 6.5057][k % 5];
            [[0.333, 2.7236], [-1.2, 0.4]].map(|[y, z]| (k, DVec3::new(along, y, z)))
        }) {
            let velocity = Velocity::from_beta([0.9, 0.98][k / 5 % 2], DVec3::X).unwrap();
            let to_offset = DAffine3::from_translation(-observer);
            let any = Sight::new(&velocity, to_offset, Allowed::Length(1.0));
            let ends =
                [DVec3::X, DVec3::Y, DVec3::Z].map(|end| any.seen(end).distance(any.seen(-end)));
            let size = DVec3::from_array(ends).length();
            let tolerance = [6e-3, 5e-3, 4.5e-3, 2e-3][k / 10] * size;
            let sight = Sight::new(&velocity, to_offset, Allowed::Length(tolerance));
            let sights = std::slice::from_ref(&sight);
            let Some(made) = triangulate(&shape, sights, About::Points, u64::MAX) else {
                continue;
            };
            proven += 1;
            let case = format!("{observer} {tolerance}");
            assert_closed(&made.mesh, &case);
            let least = needed(&shape, &sight, About::Points).least;
            let count = made.mesh.triangle_count();
            assert!((count as f64) < 3.0 * least, "{case}: {count} {least}");
            let places = made.mesh.positions();
            let volumes = made.mesh.triangles().iter().map(|&corners| {
                let [a, b, c] = corners.map(|corner| places[corner as usize]);
                a.dot(b.cross(c)) / 6.0
            });
            let volume: f64 = volumes.sum();
            assert!((2.5..4.2).contains(&volume), "{case}: {volume}");
        }
        assert!(proven > 60, "{proven}");
    }

    /// Sides of triangles lie on rulings, where three corners may be on one.
    #[test]
    fn no_triangle_of_a_rod_is_a_line() {
        let shape = Shape::rod(4.0, 0.15).unwrap();
        let velocity = Velocity::from_beta(0.9, DVec3::Y).unwrap();
        let mut proven = 0;
        for k in 0..240 {
            let along = f64::from(k) * 0.05 - 6.0;
            let to_offset = DAffine3::from_translation(DVec3::new(-2.5, along, -8.0));
            let tolerance = [9.8e-3, 5e-3, 1.5e-2][k as usize % 3];
            let sight = Sight::new(&velocity, to_offset, Allowed::Length(tolerance));
            if let Some(made) = triangulate(&shape, &[sight], About::Surface, u64::MAX) {
                assert_closed(&made.mesh, &format!("{k}"));
                proven += 1;
            }
        }
        assert!(proven > 200, "{proven}");
    }

    /// Where one triangle at a pole cannot be proven there are other nets.
    #[test]
    fn points_of_spheres_at_rest_are_proven_at_any_tolerance() {
        let shape = Shape::sphere(1.0).unwrap();
        for k in 0..60 {
            let tolerance = 3.5e-3 * 1.03f64.powi(k);
            for at in [DVec3::X * 2.0, DVec3::Y * -3.0, DVec3::Z * 4.0] {
                let velocity = Velocity::from_beta(0.0, DVec3::X).unwrap();
                let to_offset = DAffine3::from_translation(at);
                let sight = Sight::new(&velocity, to_offset, Allowed::Length(tolerance));
                let made = triangulate(&shape, &[sight], About::Points, u64::MAX);
                let bounds = &made.unwrap_or_else(|| panic!("{at} {tolerance}")).bounds[0];
                assert!(bounds.iter().all(|&[bound, _]| bound <= tolerance));
            }
        }
    }

    /// Where two triangles share a side that is divided again and again, and where a corner is in the middle of a side already.
    #[test]
    fn what_fast_observers_see_is_proven() {
        let [sphere, torus, cylinder, cone, rod] = [
            Shape::sphere(1.0),
            Shape::torus(1.0, 0.25),
            Shape::cylinder(1.0, 2.0),
            Shape::cone(1.0, 2.0),
            Shape::rod(10.0, 0.1),
        ]
        .map(Result::unwrap);
        for (shape, beta, about, tolerance, most) in [
            (&sphere, 0.99999, About::Points, 0.56, 2.5),
            (&sphere, 0.99999, About::Points, 0.056, 2.5),
            (&cone, 0.9999, About::Points, 0.0355, 5.0),
            (&cone, 0.99999, About::Points, 1.118, 9.0),
            (&rod, 0.9999, About::Points, 0.0732, 3.5),
            (&sphere, 0.999, About::Surface, 0.1886, 9.0),
            (&torus, 0.9999, About::Surface, 0.02775, 15.0),
            (&cylinder, 0.99999, About::Surface, 0.1118, 70.0),
            (&cone, 0.9999, About::Surface, 0.1064, 30.0),
        ] {
            let velocity = Velocity::from_beta(beta, DVec3::X).unwrap();
            let to_offset = DAffine3::from_translation(-2.0 * DVec3::X);
            let sight = Sight::new(&velocity, to_offset, Allowed::Length(tolerance));
            let sights = std::slice::from_ref(&sight);
            let made = triangulate(shape, sights, about, u64::MAX);
            let case = format!("{shape:?} {beta} {about:?}");
            let made = made.unwrap_or_else(|| panic!("{case}: not proven"));
            assert_closed(&made.mesh, &case);
            let bounds = &made.bounds[0];
            assert!(
                bounds.iter().all(|&[bound, _]| bound <= tolerance),
                "{case}"
            );
            let ratio = made.count() as f64 / needed(shape, &sight, about).least;
            assert!(ratio < most, "{case}: {ratio}");
        }
    }

    /// In the parameters of a cone nothing is between three spots of its rim, though there is a triangle.
    #[test]
    fn points_of_cones_are_proven_for_a_fast_observer() {
        let shape = Shape::cone(1.0, 2.0).unwrap();
        let velocity = Velocity::from_beta(0.999, DVec3::X).unwrap();
        let to_offset = DAffine3::from_translation(-2.0 * DVec3::X);
        for tolerance in [1.038_953_967_073_561_4e-3, 1.142_849_363_780_917_5e-3] {
            let sight = Sight::new(&velocity, to_offset, Allowed::Length(tolerance));
            let made = triangulate(&shape, &[sight], About::Points, u64::MAX);
            assert!(made.is_some(), "{tolerance}");
        }
    }

    /// Closed, and with all triangles facing outwards, for shapes with seams, poles, tips and rims.
    #[test]
    fn triangulations_are_closed() {
        let cases = [
            (Shape::sphere(1.0), 0.9, About::Points),
            (Shape::torus(1.0, 0.25), 0.9, About::Surface),
            (Shape::cylinder(1.0, 2.0), 0.9, About::Surface),
        ];
        for (shape, beta, about) in cases {
            let (shape, sight) = (shape.unwrap(), sight(beta, 5e-3, DVec3::ONE));
            let made = triangulate(&shape, &[sight], about, u64::MAX).unwrap();
            assert_closed(&made.mesh, &format!("{shape:?}"));
            assert!(
                made.bounds[0].iter().all(|&[bound, _]| bound <= 5e-3),
                "{shape:?}"
            );
        }
    }
}
