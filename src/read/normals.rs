//! Normals of zero length: no direction to shade by, and glTF forbids them.

use glam::DVec3;

use crate::mesh::Mesh;

/// Replaces each zero normal by that of the first flat triangle at its vertex that has one; also says
/// how many. A vertex of no triangle, or only of triangles without area, keeps its zero.
pub(super) fn replace_zero_normals(mesh: Mesh) -> (Mesh, usize) {
    let Some(normals) = mesh.normals() else {
        return (mesh, 0);
    };
    if normals.iter().all(|&normal| normal != DVec3::ZERO) {
        return (mesh, 0);
    }
    let mut normals = normals.to_vec();
    let mut replaced = 0;
    for corners in mesh.triangles() {
        let corners = corners.map(|index| index as usize);
        if corners.iter().all(|&index| normals[index] != DVec3::ZERO) {
            continue;
        }
        let [a, b, c] = corners.map(|index| mesh.positions()[index]);
        let Some(flat) = crate::spacetime::unit((b - a).cross(c - a)) else {
            continue;
        };
        for index in corners {
            if normals[index] == DVec3::ZERO {
                normals[index] = flat;
                replaced += 1;
            }
        }
    }
    let mesh = mesh.with_normals(normals);
    (mesh.expect("one unit vector for each vertex"), replaced)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zero_normal_becomes_that_of_a_triangle_with_area() {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
        // The first triangle has no area, the last vertex is unused.
        let mesh = Mesh::new(positions, vec![[0, 0, 1], [0, 1, 2]]).unwrap();
        let normals = vec![DVec3::ZERO, DVec3::X, DVec3::ZERO, DVec3::ZERO];
        let (mesh, replaced) = replace_zero_normals(mesh.with_normals(normals).unwrap());
        assert_eq!(replaced, 2);
        assert_eq!(
            mesh.normals().unwrap(),
            [DVec3::Z, DVec3::X, DVec3::Z, DVec3::ZERO]
        );
    }
}
