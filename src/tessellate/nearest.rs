//! The point of a triangle that is nearest to the observer.

use glam::DVec3;

/// The point of the triangle with these corners that is nearest to the origin, up to rounding. For a triangle that is
/// too thin to have a normal, the point is on one of its edges.
pub(crate) fn nearest_point([a, b, c]: [DVec3; 3]) -> DVec3 {
    let on_edge = |(from, to): (DVec3, DVec3)| {
        let along = to - from;
        let parameter = (-from.dot(along) / along.length_squared()).clamp(0.0, 1.0);
        // An edge without length has no parameter.
        if parameter.is_nan() {
            from
        } else {
            from + along * parameter
        }
    };
    let edges = [(a, b), (b, c), (c, a)];
    let candidates = edges.map(on_edge);
    let on_edges = candidates.into_iter().fold(a, |nearest, point| {
        if point.length_squared() < nearest.length_squared() {
            point
        } else {
            nearest
        }
    });
    let Some(normal) = (b - a).cross(c - a).try_normalize() else {
        return on_edges;
    };
    let foot = normal * a.dot(normal);
    let inside = edges
        .iter()
        .all(|&(from, to)| (to - from).cross(foot - from).dot(normal) >= 0.0);
    if inside { foot } else { on_edges }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_sample_is_nearer() {
        for step in 0..500 {
            let wave = |factor: f64| (f64::from(step) * factor).sin();
            let corners = [0.7, 1.3, 2.9]
                .map(|f| DVec3::new(wave(f), wave(f + 0.31), wave(0.17 * f) * 0.5 + 0.2));
            let nearest = nearest_point(corners);
            let mut sampled = f64::INFINITY;
            for i in 0..=20 {
                for j in 0..=20 - i {
                    let [u, v] = [i, j].map(|k| f64::from(k) / 20.0);
                    let point = corners[0] * (1.0 - u - v) + corners[1] * u + corners[2] * v;
                    sampled = sampled.min(point.length());
                }
            }
            assert!(nearest.length() <= sampled * (1.0 + 1e-12), "{corners:?}");
            assert!(nearest.length() >= sampled - 0.15, "{corners:?}");
        }
    }

    #[test]
    fn thin_triangles_have_a_nearest_point_too() {
        let line = [
            DVec3::new(-1.0, 1.0, 0.0),
            DVec3::new(3.0, 1.0, 0.0),
            DVec3::new(1.0, 1.0, 0.0),
        ];
        assert_eq!(nearest_point(line), DVec3::Y);
        assert_eq!(nearest_point([DVec3::X; 3]), DVec3::X);
        let around = [
            DVec3::new(-1.0, -1.0, 0.0),
            DVec3::new(1.0, -1.0, 0.0),
            DVec3::new(0.0, 2.0, 0.0),
        ];
        assert_eq!(nearest_point(around), DVec3::ZERO);
    }
}
