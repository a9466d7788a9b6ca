//! How far a triangle is from the photosurface, nearly: by places in the middle of its sides and of itself.

use std::array::from_fn;

use glam::DVec3;

use super::chart::Facet;
use super::quadratic;
use super::sight::About;
use super::sight::Sight;

/// How far the middle of a side may slide along the surface, in weights summed over the corners: what slides farther cannot
/// be proven.
const MOST_SLIDE: f64 = 0.5;

/// The estimated distance of a triangle from the photosurface, and how much of it each side makes, opposite each corner;
/// as fractions of the distance that is allowed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Estimate {
    pub(super) whole: f64,
    pub(super) sides: [f64; 3],
}

impl Estimate {
    /// The larger of two, each on its own.
    pub(super) fn max(self, other: Self) -> Self {
        Self {
            whole: self.whole.max(other.whole),
            sides: from_fn(|k| self.sides[k].max(other.sides[k])),
        }
    }

    /// The estimate for a triangle with these seen corners. Where the side opposite a corner is a chord of a rim, `rims`
    /// has the place in the middle of the arc.
    pub(super) fn new(
        facet: &Facet,
        sight: &Sight,
        about: About,
        seen: [DVec3; 3],
        rims: [Option<DVec3>; 3],
    ) -> Self {
        const THIRD: f64 = 1.0 / 3.0;
        let place = |weights: [f64; 3]| sight.seen_nearly(facet.chart.place(facet.at(weights)));
        let allowed = sight.allowed(seen);
        let (mut whole, mut sides, mut bulges) = (0.0f64, [0.0f64; 3], [DVec3::ZERO; 3]);
        for k in 0..3 {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let mut weights = [0.5; 3];
            weights[k] = 0.0;
            let middle = 0.5 * (seen[i] + seen[j]);
            bulges[k] = place(weights) - middle;
            if let Some(on_rim) = rims[k] {
                let along = (seen[j] - seen[i]).normalize_or_zero();
                let aside = sight.seen_nearly(on_rim) - middle;
                sides[k] = (aside - along * along.dot(aside)).length();
                whole = whole.max(sides[k]);
            }
        }
        let center = place([THIRD; 3]) - (seen[0] + seen[1] + seen[2]) * THIRD;
        let sum: DVec3 = bulges.iter().sum();
        match about {
            About::Surface => {
                let normal = (seen[1] - seen[0])
                    .cross(seen[2] - seen[0])
                    .normalize_or_zero();
                let heights: [f64; 3] = from_fn(|k| normal.dot(bulges[k]));
                // Sides alone would make this of the centre.
                let beyond = normal.dot(center - sum * (4.0 / 9.0)).abs();
                whole = whole.max(match facet.tip().is_some() {
                    // The error grows with the distance from the tip.
                    true => heights
                        .iter()
                        .fold(normal.dot(center).abs(), |a, b| a.max(b.abs())),
                    false => quadratic::largest([0.0; 3], heights) + beyond,
                });
                sides = from_fn(|k| sides[k].max(heights[k].abs()));
                // Same weights are near enough where places do not slide farther than is allowed.
                let slides = slides(seen, normal, bulges);
                let slides: [f64; 3] =
                    from_fn(|k| (slides[k] * allowed / MOST_SLIDE).min(bulges[k].length()));
                whole = slides.into_iter().fold(whole, f64::max);
                let most = slides.into_iter().fold(0.0, f64::max);
                let lengths: [f64; 3] = from_fn(|k| bulges[k].length());
                let longest = lengths.into_iter().fold(0.0, f64::max);
                if longest > 0.0 {
                    sides = from_fn(|k| sides[k].max(most * lengths[k] / longest));
                }
            }
            About::Points => {
                let axis = center.normalize_or_zero();
                let along = quadratic::largest([0.0; 3], bulges.map(|bulge| axis.dot(bulge)));
                let lengths: [f64; 3] = from_fn(|k| bulges[k].length());
                whole = lengths
                    .iter()
                    .fold(whole.max(center.length()).max(along), |a, b| a.max(*b));
                sides = from_fn(|k| sides[k].max(lengths[k]));
            }
        }
        let number = |distance: f64| match distance.is_nan() {
            true => f64::INFINITY,
            false => distance / allowed,
        };
        Self {
            whole: number(whole),
            sides: sides.map(number),
        }
    }
}

/// How far the middle of each side slides in the triangle's plane, in weights, summed over the three corners.
fn slides(seen: [DVec3; 3], normal: DVec3, bulges: [DVec3; 3]) -> [f64; 3] {
    let area = (seen[1] - seen[0]).cross(seen[2] - seen[0]).length();
    let gradients: [DVec3; 3] =
        from_fn(|k| normal.cross(seen[(k + 2) % 3] - seen[(k + 1) % 3]) / area);
    bulges.map(|bulge| gradients.iter().map(|g| g.dot(bulge).abs()).sum())
}
