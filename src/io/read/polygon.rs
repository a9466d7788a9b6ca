//! Polygons of any number of corners as triangles.
//!
//! A fan from the first corner is right for convex polygons only. Others have their ears clipped
//! (Meisters, *Polygons have ears*, Amer. Math. Monthly 82 (1975), 648), in the plane that fits best.
//! The usual crates leave out corners on straight edges: that would open cracks towards the neighbours
//! once the surface is bent.

use glam::{DVec2, DVec3};

/// The `n - 2` triangles of a polygon with the given corners, wound as it is; each is three numbers of
/// corners. Corners that are not in a plane, or whose edges cross, give triangles all the same.
pub(super) fn triangulate(corners: &[DVec3]) -> Vec<[usize; 3]> {
    let flat = flattened(corners);
    let count = corners.len();
    let turn = |i: usize| area(flat[i], flat[(i + 1) % count], flat[(i + 2) % count]);
    if (0..count).all(|i| turn(i) > 0.0) {
        return fan(&(0..count).collect::<Vec<_>>());
    }
    clip_ears(&flat)
}

/// The corners in the plane across the polygon's mean normal, counter-clockwise.
fn flattened(corners: &[DVec3]) -> Vec<DVec2> {
    let Some(&first) = corners.first() else {
        return vec![];
    };
    // Newell's normal; differences to one corner keep it exact far from the origin.
    let pairs = corners
        .windows(2)
        .map(|pair| (pair[0] - first).cross(pair[1] - first));
    let normal = crate::spacetime::unit(pairs.sum()).unwrap_or(DVec3::Z);
    let (right, up) = normal.any_orthonormal_pair();
    let flatten =
        |&corner: &DVec3| DVec2::new((corner - first).dot(right), (corner - first).dot(up));
    corners.iter().map(flatten).collect()
}

fn clip_ears(flat: &[DVec2]) -> Vec<[usize; 3]> {
    let mut left: Vec<usize> = (0..flat.len()).collect();
    let mut triangles = vec![];
    let mut start = 0;
    while left.len() > 3 {
        let count = left.len();
        // Going on behind the last ear keeps the triangles from all meeting in one corner.
        let ear = (start..start + count)
            .map(|i| i % count)
            .find(|&i| is_ear(flat, &left, i));
        let Some(ear) = ear else {
            break;
        };
        triangles.push([
            left[(ear + count - 1) % count],
            left[ear],
            left[(ear + 1) % count],
        ]);
        left.remove(ear);
        start = ear + 1;
    }
    triangles.extend(fan(&left));
    triangles
}

/// Whether corner `i` of those left sticks out and its triangle holds no other corner.
fn is_ear(flat: &[DVec2], left: &[usize], i: usize) -> bool {
    let count = left.len();
    let at = |i: usize| flat[left[i % count]];
    let (a, b, c) = (at(i + count - 1), at(i), at(i + 1));
    let holds = |p: DVec2| {
        ![a, b, c].contains(&p)
            && area(a, b, p) >= 0.0
            && area(b, c, p) >= 0.0
            && area(c, a, p) >= 0.0
    };
    area(a, b, c) > 0.0 && !left.iter().any(|&corner| holds(flat[corner]))
}

/// Twice the area of a triangle, negative where it is clockwise.
fn area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

fn fan(corners: &[usize]) -> Vec<[usize; 3]> {
    let pairs = corners.windows(2).skip(1);
    pairs.map(|pair| [corners[0], pair[0], pair[1]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that the triangles use all corners, face the way of the polygon and cover its area.
    fn check(corners: &[(f64, f64)]) -> Vec<[usize; 3]> {
        let lift = |&(x, y): &(f64, f64)| DVec3::new(100.0 + y, x, 7.0 + x);
        let corners: Vec<DVec3> = corners.iter().map(lift).collect();
        let triangles = triangulate(&corners);
        assert_eq!(triangles.len(), corners.len() - 2);
        assert!((0..corners.len()).all(|i| triangles.iter().flatten().any(|&j| i == j)));
        let count = corners.len();
        let vector: DVec3 = (0..count)
            .map(|i| corners[i].cross(corners[(i + 1) % count]))
            .sum();
        let normal = vector.normalize();
        let mut covered = 0.0;
        for &[a, b, c] in &triangles {
            let cross = (corners[b] - corners[a]).cross(corners[c] - corners[a]);
            assert!(cross.dot(normal) > -1e-9, "[{a}, {b}, {c}] faces away");
            covered += cross.length();
        }
        assert!((covered - vector.length()).abs() < 1e-9, "{covered}");
        triangles
    }

    #[test]
    fn a_convex_polygon_is_a_fan() {
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        assert_eq!(check(&square), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn concave_polygons_are_covered_once() {
        check(&[(0.0, 0.0), (2.0, 1.0), (0.0, 2.0), (1.0, 1.0)]);
        // An L from its inner corner's neighbour, a U, a spiral.
        check(&[
            (2.0, 1.0),
            (1.0, 1.0),
            (1.0, 2.0),
            (0.0, 2.0),
            (0.0, 0.0),
            (2.0, 0.0),
        ]);
        check(&[
            (0.0, 0.0),
            (3.0, 0.0),
            (3.0, 3.0),
            (2.0, 3.0),
            (2.0, 1.0),
            (1.0, 1.0),
            (1.0, 3.0),
            (0.0, 3.0),
        ]);
        check(&[
            (0.0, 0.0),
            (5.0, 0.0),
            (5.0, 5.0),
            (1.0, 5.0),
            (1.0, 2.0),
            (3.0, 2.0),
            (3.0, 3.0),
            (2.0, 3.0),
            (2.0, 4.0),
            (4.0, 4.0),
            (4.0, 1.0),
            (0.0, 1.0),
        ]);
    }

    #[test]
    fn a_corner_on_a_straight_edge_is_kept() {
        check(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)]);
        check(&[(0.0, 0.0), (1.0, 0.5), (2.0, 1.0), (0.0, 2.0), (1.0, 1.0)]);
    }

    #[test]
    fn what_is_no_polygon_gives_triangles_all_the_same() {
        assert_eq!(triangulate(&[DVec3::ONE; 5]).len(), 3);
        let bow_tie = [DVec3::ZERO, DVec3::ONE, DVec3::X, DVec3::Y];
        assert_eq!(triangulate(&bow_tie).len(), 2);
        assert!(triangulate(&[]).is_empty());
    }
}
