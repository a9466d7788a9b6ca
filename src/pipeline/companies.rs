//! Companies: round objects of one shape that are seen in nearly the same direction share one mesh at rest, so that thousands
//! of them take seconds instead of minutes.

use std::collections::HashMap;

use glam::{DAffine3, DVec3};

use crate::scene::{Measure, Tolerance};
use crate::shape::Shape;
use crate::spacetime::{Velocity, VelocityKey};

/// The least number of objects in a company. Fewer are better off with a mesh each, which has fewer triangles.
const LEAST: usize = 4;

/// The directions of a company differ by about so much, divided by `gamma beta` and by how many times as long a photosurface
/// may be at rest as it is seen; and by no more than the other number.
const APART: f64 = 0.09;
const MOST_APART: f64 = 0.25;

/// How much smaller than its own the leader's tolerance is: a part, and so many times as much as directions differ, times
/// `gamma beta`. Both are measured: nearly all objects of a crowd can be in a company then.
const RESERVE: f64 = 0.015;
const RESERVE_APART: f64 = 1.05;

/// A round object whose mesh may be shared.
pub(super) struct Candidate<'a> {
    /// Its number in the scene.
    pub(super) object: usize,
    pub(super) shape: &'a Shape,
    /// From the shape's own frame to the offset from the observer, in the rest frame.
    pub(super) to_offset: DAffine3,
    pub(super) velocity: Velocity,
    pub(super) tolerance: Tolerance,
    pub(super) measure: Measure,
}

/// Objects that share a mesh.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Company {
    /// The object for whose observer the mesh is made.
    pub(super) leader: usize,
    /// All of them, in the order of the scene.
    pub(super) members: Vec<usize>,
    /// The factor on the leader's tolerance.
    pub(super) tightened: f64,
}

/// What the candidates of one company have in common to the last bit, and the cell of directions that they are in.
#[derive(PartialEq, Eq, Hash)]
struct Key {
    velocity: VelocityKey,
    matrix: [u64; 9],
    /// Three numbers along the axes, and the level of sizes.
    cell: [i64; 4],
    shape: String,
    tolerance: String,
    is_of_points: bool,
}

/// The candidates of one key.
struct Group<'a> {
    first: Candidate<'a>,
    size: f64,
    /// Each with the direction in which it is.
    members: Vec<(usize, DVec3)>,
}

/// The companies of all candidates, which are in the order of the scene.
pub(super) fn companies<'a>(candidates: impl Iterator<Item = Candidate<'a>>) -> Vec<Company> {
    let mut groups: Vec<Group<'a>> = vec![];
    let mut of_keys: HashMap<Key, usize> = HashMap::new();
    for candidate in candidates {
        let direction = candidate.to_offset.translation.normalize_or_zero();
        let (level, size) = cell_size(&candidate.velocity, direction);
        let matrix = candidate.to_offset.matrix3.to_cols_array();
        let [x, y, z] = (direction / size).floor().to_array().map(|at| at as i64);
        let key = Key {
            velocity: candidate.velocity.key(),
            matrix: matrix.map(f64::to_bits),
            cell: [x, y, z, level],
            shape: format!("{:?}", candidate.shape),
            tolerance: candidate.tolerance.to_flag(),
            is_of_points: candidate.measure == Measure::Points,
        };
        let member = (candidate.object, direction);
        let group = *of_keys.entry(key).or_insert(groups.len());
        match groups.get_mut(group) {
            Some(group) => group.members.push(member),
            None => groups.push(Group {
                first: candidate,
                size,
                members: vec![member],
            }),
        }
    }
    let large = groups
        .into_iter()
        .filter(|group| group.members.len() >= LEAST);
    large.map(Group::company).collect()
}

impl Group<'_> {
    fn company(self) -> Company {
        let middle: DVec3 = self.members.iter().map(|(_, direction)| direction).sum();
        let middle = middle / self.members.len() as f64;
        let away = |&(_, direction): &(usize, DVec3)| direction.distance_squared(middle);
        let nearest = self
            .members
            .iter()
            .min_by(|a, b| away(a).total_cmp(&away(b)));
        let gamma_beta = self.first.velocity.gamma_beta();
        Company {
            leader: nearest.map_or(self.first.object, |&(object, _)| object),
            tightened: 1.0 - RESERVE - RESERVE_APART * gamma_beta * self.size,
            members: self.members.into_iter().map(|(object, _)| object).collect(),
        }
    }
}

/// The level of the cells of directions around one, each half as large as those of the level before, and their size, a
/// length on the unit sphere.
fn cell_size(velocity: &Velocity, direction: DVec3) -> (i64, f64) {
    let (gamma, gamma_beta) = (velocity.gamma(), velocity.gamma_beta());
    let along = direction.dot(velocity.direction());
    let across = (1.0 - along * along).max(0.0).sqrt();
    let seen = gamma + gamma_beta * along;
    let longer = 1.0f64.max((1.0 + gamma_beta * across) / seen);
    let level = longer.log2().floor();
    let size = APART / gamma_beta / level.exp2();
    (level as i64, size.min(MOST_APART))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(beta: f64, shapes: &[(&Shape, DVec3)]) -> Vec<Company> {
        let velocity = Velocity::from_beta(beta, DVec3::NEG_Z).unwrap();
        companies(
            shapes
                .iter()
                .enumerate()
                .map(|(object, &(shape, at))| Candidate {
                    object,
                    shape,
                    to_offset: DAffine3::from_translation(at),
                    velocity,
                    tolerance: Tolerance::relative(1e-3).unwrap(),
                    measure: Measure::Surface,
                }),
        )
    }

    #[test]
    fn alike_objects_in_one_direction_are_in_a_company_and_few_are_not() {
        let (ball, large) = (Shape::sphere(0.5).unwrap(), Shape::sphere(0.7).unwrap());
        let at = |x: f64, z: f64| DVec3::new(x, 0.005, z) * 1000.0;
        let mut all: Vec<(&Shape, DVec3)> = (0..7)
            .map(|k| (&ball, at(0.001 * f64::from(k), -1.0)))
            .collect();
        all.extend([
            (&large, at(0.002, -1.0)),
            (&ball, at(1.0, -1.0)),
            (&ball, at(0.004, -1.1)),
        ]);
        let company = Company {
            leader: 3,
            members: vec![0, 1, 2, 3, 4, 5, 6, 9],
            tightened: 1.0 - RESERVE - RESERVE_APART * APART,
        };
        assert_eq!(found(0.9, &all), [company]);
        assert_eq!(found(0.9, &all[5..]), []);
    }

    /// The faster the observer, the nearer to each other, above all behind the observer.
    #[test]
    fn directions_of_a_company_are_apart_as_the_observer_sees_them() {
        let ball = Shape::sphere(0.5).unwrap();
        let members = |beta: f64, ahead: f64| {
            let all: Vec<(&Shape, DVec3)> = (0..100)
                .map(|k| {
                    (
                        &ball,
                        DVec3::new(0.001 * f64::from(k), 0.0, -ahead) * 1000.0,
                    )
                })
                .collect();
            let companies = found(beta, &all);
            companies.first().map_or(0, |company| company.members.len())
        };
        let [rest, slow, fast, fastest] = [0.0, 0.5, 0.9, 0.999].map(|beta| members(beta, 1.0));
        assert!(
            rest == 100 && slow == 100 && fast < 60 && fastest < 10,
            "{rest} {slow} {fast} {fastest}"
        );
        assert!(members(0.9, -1.0) < fast, "{}", members(0.9, -1.0));
    }
}
