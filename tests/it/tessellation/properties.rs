//! What holds for every small mesh and every observer after subdivision, tried on numbers that hurt.

use crate::common::refining::{Sighting, Welded, mesh};
use crate::common::{Random, cases};
use photosurface::{DVec3, Tolerance, Velocity};
use proptest::prelude::*;

/// Round numbers, so that much is collinear, coplanar or the same; next to them; and any.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => (-2i32..=2).prop_map(|n| f64::from(n) * 0.5),
        1 => (-2i32..=2).prop_map(|n| f64::from(n) * 0.5 + 1e-9),
        1 => (-2i32..=2).prop_map(|n| (f64::from(n) * 0.5).next_up()),
        1 => Just(-0.0),
        3 => -1.0..1.0,
    ]
}

fn place() -> impl Strategy<Value = [f64; 3]> {
    [coordinate(), coordinate(), coordinate()]
}

proptest! {
    #![proptest_config(cases(200))]

    /// Conforming, within the bound, complete or honest.
    #[test]
    fn soups_are_refined_conformingly(
        corners in prop::collection::vec(place(), 3..7),
        picks in prop::collection::vec([0u32..6, 0u32..6, 0u32..6], 1..6),
        observer in place(),
        rapidity in 0.01f64..5.0,
        exponent in 1.0f64..3.5,
    ) {
        let count = corners.len() as u32;
        let triangles: Vec<_> = picks.iter().map(|t| t.map(|i| i % count)).collect();
        let before = mesh(&corners, &triangles);
        let velocity = Velocity::from_rapidity(rapidity, DVec3::new(0.3, -0.2, -1.0)).unwrap();
        let tolerance = Tolerance::relative(10f64.powf(-exponent)).unwrap();
        let sighting = Sighting::new(observer.into(), velocity, tolerance);
        let sighted = sighting.of_one(&before);
        let certificate = &sighted.certificate;
        prop_assert_eq!(certificate.complete, certificate.total <= certificate.tolerance);
        prop_assert!(sighted.seen.positions().iter().all(|p| p.is_finite()));
        let case = format!("{sighting:?} {triangles:?} {corners:?}");
        // New places on the sides of a sliver may be the same, so that its sides are merged.
        let sliver = triangles.iter().any(|t| {
            let [a, b, c] = t.map(|i| DVec3::from(corners[i as usize]));
            (b - a).cross(c - a).length() < 1e-8
        });
        if !sliver {
            let after = Welded::of_sighted(std::slice::from_ref(&sighted));
            // Soups may have faces that coincide, and so may their pieces: only the boundary counts.
            let (old, new) = (Welded::of_meshes(&[before]).boundary(), after.boundary());
            prop_assert!((new - old).abs() <= 1e-8, "{case}: {old} became {new}");
        }
        sighting.assert_contained(&sighted, 1, &mut Random::new(9));
    }
}
