//! Polygons of any number of corners as triangles.
//!
//! A fan from the first corner is right for convex polygons only. Others have their ears clipped
//! (Meisters, *Polygons have ears*, Amer. Math. Monthly 82 (1975), 648), in the plane that fits best.
//! The usual crates leave out corners on straight edges: that would open cracks towards the neighbours
//! once the surface is bent.

use std::collections::{BTreeSet, HashMap};

use glam::{DVec2, DVec3};

/// The triangles of polygons: `corners` numbers the corners of all of them, one polygon after the other, and `arities` says
/// how many corners each has.
pub(super) fn triangles(arities: &[u32], corners: &[u32], positions: &[DVec3]) -> Vec<[u32; 3]> {
    let mut rest = corners;
    let mut triangles = vec![];
    for &arity in arities {
        let (face, others) = rest.split_at(arity as usize);
        rest = others;
        if let &[a, b, c] = face {
            triangles.push([a, b, c]);
            continue;
        }
        let places: Vec<DVec3> = face.iter().map(|&i| positions[i as usize]).collect();
        let of_face = triangulate(&places);
        triangles.extend(of_face.into_iter().map(|corners| corners.map(|i| face[i])));
    }
    triangles
}

/// The `n - 2` triangles of a polygon with the given corners, wound as it is; each is three numbers of
/// corners. Corners that are not in a plane, or whose edges cross, give triangles all the same.
fn triangulate(corners: &[DVec3]) -> Vec<[usize; 3]> {
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
    let count = flat.len();
    if count < 3 {
        return vec![];
    }
    let mut before: Vec<usize> = (0..count).map(|i| (i + count - 1) % count).collect();
    let mut behind: Vec<usize> = (0..count).map(|i| (i + 1) % count).collect();
    let mut grid = Grid::new(flat);
    // Corners that may be ears; the others wait for a corner in their triangle to be clipped.
    let mut candidates: BTreeSet<usize> = (0..count).collect();
    let mut waiting: HashMap<usize, Vec<usize>> = HashMap::new();
    let mut triangles = vec![];
    let mut start = 0;
    while triangles.len() + 3 < count {
        // Going on behind the last ear keeps the triangles from all meeting in one corner.
        let next = candidates.range(start..).next().or(candidates.first());
        let Some(&i) = next else {
            break;
        };
        candidates.remove(&i);
        start = i;
        let corners = [before[i], i, behind[i]];
        let triangle = corners.map(|corner| flat[corner]);
        let [a, b, c] = triangle;
        // What does not stick out may do so when a neighbour is clipped.
        if !(area(a, b, c) > 0.0) {
            continue;
        }
        if let Some(corner) = grid.find_in(triangle) {
            waiting.entry(corner).or_default().push(i);
            continue;
        }
        triangles.push(corners);
        grid.remove(i, b);
        let [first, _, last] = corners;
        (behind[first], before[last]) = (last, first);
        // Those in the way of others may be the neighbours of these now, which then are tried again.
        let waited = waiting.remove(&i).unwrap_or_default();
        let is_left = |&j: &usize| behind[before[j]] == j;
        candidates.extend(waited.into_iter().filter(is_left));
        candidates.extend([first, last]);
        start = behind[last];
    }
    let mut left = vec![];
    let mut corner = start;
    // The lowest number first, as in a polygon that no ear was clipped from.
    for _ in 0..count - triangles.len() {
        left.push(corner);
        corner = behind[corner];
    }
    let lowest = (0..left.len()).min_by_key(|&i| left[i]).unwrap_or_default();
    left.rotate_left(lowest);
    triangles.extend(fan(&left));
    triangles
}

/// The corners of a polygon in square order, about one to a cell, so that those in a triangle are found fast.
struct Grid<'a> {
    flat: &'a [DVec2],
    low: DVec2,
    /// Cells for one unit of length.
    density: DVec2,
    /// How many cells there are along either axis.
    side: usize,
    cells: Vec<Vec<usize>>,
}

impl<'a> Grid<'a> {
    fn new(flat: &'a [DVec2]) -> Self {
        let low = flat.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = flat.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        let side = flat.len().isqrt().max(1);
        let density = side as f64 / (high - low).max(DVec2::splat(f64::MIN_POSITIVE));
        let mut grid = Self {
            flat,
            low,
            density,
            side,
            cells: vec![vec![]; side * side],
        };
        for (i, &point) in flat.iter().enumerate() {
            let cell = grid.cell(point);
            grid.cells[cell].push(i);
        }
        grid
    }

    /// The row or column of a coordinate; it grows with the coordinate.
    fn place(&self, point: DVec2, axis: usize) -> usize {
        let place = (point[axis] - self.low[axis]) * self.density[axis];
        (place as usize).min(self.side - 1)
    }

    fn cell(&self, point: DVec2) -> usize {
        self.place(point, 1) * self.side + self.place(point, 0)
    }

    fn remove(&mut self, corner: usize, point: DVec2) {
        let cell = self.cell(point);
        self.cells[cell].retain(|&other| other != corner);
    }

    /// A corner in a counter-clockwise triangle or on its edge, but not at one of its corners.
    fn find_in(&self, triangle: [DVec2; 3]) -> Option<usize> {
        let [a, b, c] = triangle;
        let holds = |p: DVec2| {
            !triangle.contains(&p)
                && area(a, b, p) >= 0.0
                && area(b, c, p) >= 0.0
                && area(c, a, p) >= 0.0
        };
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        (self.place(low, 1)..=self.place(high, 1)).find_map(|row| {
            let (first, last) =
                self.columns(triangle, row, self.place(low, 0), self.place(high, 0));
            let cells = &self.cells[row * self.side..][first..=last];
            let mut corners = cells.iter().flatten();
            corners.find(|&&corner| holds(self.flat[corner])).copied()
        })
    }

    /// The columns, of those from `first` to `last`, that a triangle has in a row, and some more against rounding.
    fn columns(
        &self,
        [a, b, c]: [DVec2; 3],
        row: usize,
        first: usize,
        last: usize,
    ) -> (usize, usize) {
        if last - first < 4 {
            return (first, last);
        }
        // In cells; half a cell more on either side.
        let [a, b, c] = [a, b, c].map(|point| (point - self.low) * self.density);
        let (bottom, top) = (row as f64 - 0.5, row as f64 + 1.5);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let rise = to.y - from.y;
            if from.y.max(to.y) < bottom || from.y.min(to.y) > top {
                continue;
            }
            for y in [bottom, top] {
                let along = match rise.abs() < 1e-6 {
                    // All of a level edge counts.
                    true => f64::from(u8::from(y == top)),
                    false => ((y - from.y) / rise).clamp(0.0, 1.0),
                };
                let x = from.x + along * (to.x - from.x);
                (low, high) = (low.min(x), high.max(x));
            }
        }
        if !(low <= high) {
            return (first, last);
        }
        let low = ((low - 1.0) as usize).clamp(first, last);
        (low, ((high + 1.0) as usize).clamp(low, last))
    }
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

    /// Checks what `check` does of a polygon with many corners, relative to its size.
    fn check_large(corners: &[DVec2]) {
        let triangles = triangulate(&corners.iter().map(|p| p.extend(0.0)).collect::<Vec<_>>());
        assert_eq!(triangles.len(), corners.len() - 2);
        let mut used = vec![false; corners.len()];
        let pairs = (0..corners.len()).map(|i| (corners[i], corners[(i + 1) % corners.len()]));
        let whole: f64 = pairs.map(|(p, q)| p.perp_dot(q)).sum();
        let mut covered = 0.0;
        for &[a, b, c] in &triangles {
            let part = area(corners[a], corners[b], corners[c]) * whole.signum();
            assert!(part > -1e-9, "[{a}, {b}, {c}] faces away");
            covered += part;
            for corner in [a, b, c] {
                used[corner] = true;
            }
        }
        assert!(used.iter().all(|&used| used));
        assert!(
            (covered / whole.abs() - 1.0).abs() < 1e-9,
            "{covered} of {whole}"
        );
    }

    #[test]
    fn polygons_of_many_corners_are_covered_in_time() {
        let start = std::time::Instant::now();
        let half = 10_000;
        // A saw over a straight edge with corners on it.
        let edge = (0..half).map(|i| DVec2::new(f64::from(i), 0.0));
        let teeth = (0..half).rev().map(|i| {
            let up = f64::from(i % 2) * 0.5 + 0.25;
            DVec2::new(f64::from(i) + up, 1.0 + 50.0 * up)
        });
        check_large(&edge.chain(teeth).collect::<Vec<_>>());
        // A spiral, out and back.
        let arm = |i: i32, radius: f64| {
            let turn = f64::from(i) * 0.01;
            (radius + turn) * DVec2::from_angle(turn)
        };
        let there = (0..half).map(|i| arm(i, 1.0));
        let back = (0..half).rev().map(|i| arm(i, 2.5));
        check_large(&there.chain(back).collect::<Vec<_>>());
        // Looking at all corners for each ear in turn takes minutes for each.
        let seconds = start.elapsed().as_secs_f64();
        assert!(seconds < 30.0, "{seconds} s");
    }

    #[test]
    fn what_is_no_polygon_gives_triangles_all_the_same() {
        assert_eq!(triangulate(&[DVec3::ONE; 5]).len(), 3);
        let bow_tie = [DVec3::ZERO, DVec3::ONE, DVec3::X, DVec3::Y];
        assert_eq!(triangulate(&bow_tie).len(), 2);
        assert!(triangulate(&[]).is_empty());
    }
}
