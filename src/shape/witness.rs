//! What the tests of all shapes ask a mesh, with means of their own.

use std::collections::{HashMap, HashSet};

use glam::DVec3;

use super::{Appearance, Shape};
use crate::mesh::Mesh;

/// The mesh of a shape.
pub(super) fn mesh(shape: &Shape) -> Mesh {
    let model = shape.model(&Appearance::default()).unwrap();
    assert_eq!(model.parts.len(), 1);
    model.parts[0].mesh().clone()
}

/// Asserts that every edge is in exactly two triangles, which run through it in opposite directions;
/// vertices are the same where their positions are, bit for bit. Returns the Euler characteristic.
pub(super) fn assert_closed(mesh: &Mesh) -> i64 {
    let edges = directed_edges(mesh);
    for (&[from, to], &count) in &edges {
        assert_eq!(count, 1, "{} triangles use one side of an edge", count);
        assert_eq!(
            edges.get(&[to, from]),
            Some(&1),
            "an edge has one side only"
        );
    }
    let points: HashSet<_> = mesh.positions().iter().map(bits).collect();
    points.len() as i64 - edges.len() as i64 / 2 + mesh.triangles().len() as i64
}

/// The edges that belong to one triangle only.
pub(super) fn boundary(mesh: &Mesh) -> Vec<[DVec3; 2]> {
    let edges = directed_edges(mesh);
    let lone = edges
        .keys()
        .filter(|[from, to]| !edges.contains_key(&[*to, *from]));
    lone.map(|edge| edge.map(|point| DVec3::from_array(point.map(f64::from_bits))))
        .collect()
}

/// Asserts what holds for every mesh: no degenerate triangle, no vertex unused or twice the
/// same, unit normals on the outer side of the triangles, pictures not mirrored seen from outside.
pub(super) fn assert_well_made(mesh: &Mesh) {
    let [positions, normals] = [mesh.positions(), mesh.normals().unwrap()];
    let texture = &mesh.texture_coordinates()[0];
    let mut used = vec![false; positions.len()];
    for &triangle in mesh.triangles() {
        let corners = triangle.map(|index| index as usize);
        corners.iter().for_each(|&index| used[index] = true);
        let [a, b, c] = corners.map(|index| positions[index]);
        let cross = (b - a).cross(c - a);
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        assert!(cross.length() > 1e-9 * longest * longest, "{a} {b} {c}");
        for index in corners {
            assert!(
                cross.dot(normals[index]) > 0.0,
                "{a} {b} {c}: {}",
                normals[index]
            );
        }
        let [a_uv, b_uv, c_uv] = corners.map(|index| texture[index].as_dvec2());
        let signed = (b_uv - a_uv).perp_dot(c_uv - a_uv);
        assert!(signed < 0.0, "{a} {b} {c}: {a_uv} {b_uv} {c_uv}");
    }
    assert!(used.iter().all(|&used| used));
    assert!(normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-15));
    let distinct: HashSet<_> = (0..positions.len())
        .map(|i| {
            (
                bits(&positions[i]),
                bits(&normals[i]),
                texture[i].to_array().map(f32::to_bits),
            )
        })
        .collect();
    assert_eq!(
        distinct.len(),
        positions.len(),
        "vertices that differ in nothing"
    );
}

/// Asserts that no triangle spans more than `limit` of a texture coordinate.
pub(super) fn assert_texture_within(mesh: &Mesh, limit: f32) {
    for &triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|index| mesh.texture_coordinates()[0][index as usize]);
        let span = a.max(b).max(c) - a.min(b).min(c);
        assert!(span.max_element() <= limit, "{a} {b} {c}");
    }
}

/// Asserts that vertex normals are within `limit` radians of those of the triangles around them.
pub(super) fn assert_normals_within(mesh: &Mesh, limit: f64) {
    for &triangle in mesh.triangles() {
        let corners = triangle.map(|index| index as usize);
        let [a, b, c] = corners.map(|index| mesh.positions()[index]);
        let flat = (b - a).cross(c - a);
        for index in corners {
            let normal = mesh.normals().unwrap()[index];
            let angle = flat.cross(normal).length().atan2(flat.dot(normal));
            assert!(
                angle <= limit,
                "{a} {b} {c}: {normal} is {angle} off, not {limit}"
            );
        }
    }
}

/// The volume inside, by the divergence theorem.
pub(super) fn volume(mesh: &Mesh) -> f64 {
    volumes(mesh).sum()
}

/// The area of all triangles.
pub(super) fn area(mesh: &Mesh) -> f64 {
    areas(mesh).sum()
}

/// Asserts that the volume is exact up to rounding.
pub(super) fn assert_volume(mesh: &Mesh, expected: f64) {
    assert_sum(&volumes(mesh).collect::<Vec<_>>(), expected);
}

/// Asserts that the area is exact up to rounding.
pub(super) fn assert_area(mesh: &Mesh, expected: f64) {
    assert_sum(&areas(mesh).collect::<Vec<_>>(), expected);
}

/// Asserts that `terms` make up `expected`. Each step of the sum may round, and so may the coordinates
/// of triangles a hundred times smaller than the shape.
fn assert_sum(terms: &[f64], expected: f64) {
    let magnitude: f64 = terms.iter().map(|term| term.abs()).sum();
    let limit = (terms.len() + 100) as f64 * f64::EPSILON * magnitude;
    let found: f64 = terms.iter().sum();
    assert!(
        (found - expected).abs() < limit,
        "{found}, not {expected}, limit {limit:e}"
    );
}

fn volumes(mesh: &Mesh) -> impl Iterator<Item = f64> {
    corners(mesh).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
}

fn areas(mesh: &Mesh) -> impl Iterator<Item = f64> {
    corners(mesh).map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0)
}

fn corners(mesh: &Mesh) -> impl Iterator<Item = [DVec3; 3]> {
    let positions = mesh.positions();
    let triangles = mesh.triangles().iter();
    triangles.map(|corners| corners.map(|index| positions[index as usize]))
}

fn directed_edges(mesh: &Mesh) -> HashMap<[[u64; 3]; 2], usize> {
    let mut edges = HashMap::new();
    for corners in corners(mesh) {
        let [a, b, c] = corners.map(|point| bits(&point));
        for edge in [[a, b], [b, c], [c, a]] {
            *edges.entry(edge).or_default() += 1;
        }
    }
    edges
}

fn bits(vector: &DVec3) -> [u64; 3] {
    vector.to_array().map(f64::to_bits)
}
