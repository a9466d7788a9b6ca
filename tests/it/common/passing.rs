//! An object that passes an observer with a velocity given in decimals, and assertions about it.
//!
//! # Where the limits come from
//!
//! The rounding of a decimal `beta` and that of `atanh` make the rapidity `eta` uncertain by
//! `gamma^2 beta E / 2 + eta E`, `E` being the epsilon of `f64`. Along the motion a position changes by `|p|`
//! per unit of rapidity, the Doppler factor by `D` at most. To this comes the map's own error:
//! `RELATIVE`, and `TURN` where the direction of motion is not an axis.

use photosurface::light_cone::PhotosurfaceMap;
use photosurface::{DVec3, Velocity};

use super::{RELATIVE, TURN};

/// What an object's velocity makes of its points, and how well `f64` can know it.
pub(crate) struct Passing {
    pub(crate) map: PhotosurfaceMap,
    /// The observer's velocity in the object's rest frame.
    pub(crate) observer: Velocity,
    /// Of the rapidity.
    pub(crate) uncertainty: f64,
    turn: f64,
}

impl Passing {
    /// An object that moves with `beta` along +x, as most examples have it.
    pub(crate) fn along_x(beta: f64) -> Self {
        Self::new(DVec3::new(beta, 0.0, 0.0))
    }

    pub(crate) fn new(beta: DVec3) -> Self {
        let observer = Velocity::from_vector(-beta).expect("slower than light");
        let axis = beta.abs().max_element() == beta.length();
        let half_ulp = 0.5 * f64::EPSILON;
        let gamma_squared = observer.gamma().powi(2);
        // The length of a vector takes another five roundings.
        let roundings = if axis { 1.0 } else { 6.0 };
        Self {
            map: PhotosurfaceMap::new(&observer),
            observer,
            uncertainty: gamma_squared * observer.beta() * roundings * half_ulp
                + 2.0 * half_ulp * observer.rapidity(),
            turn: if axis { 0.0 } else { TURN },
        }
    }

    /// How far from the truth the point at `offset` may be seen.
    pub(crate) fn position_limit(&self, offset: DVec3, seen: DVec3) -> f64 {
        (RELATIVE + self.uncertainty) * seen.length()
            + self.turn * offset.length() * (1.0 + self.observer.gamma())
    }

    #[track_caller]
    pub(crate) fn assert_seen(&self, offset: DVec3, expected: DVec3) {
        let seen = self.map.seen_position(offset);
        let limit = self.position_limit(offset, expected);
        assert_close(seen, expected, limit);
        let time = self.map.emission_time(offset);
        assert_near(time, -expected.length(), limit);
    }

    #[track_caller]
    pub(crate) fn assert_doppler(&self, offset: DVec3, expected: f64) {
        let limit =
            (RELATIVE + self.uncertainty) * expected + self.turn * self.observer.gamma_beta();
        assert_near(self.map.doppler_factor(offset), expected, limit);
    }
}

#[track_caller]
pub(crate) fn assert_near(value: f64, expected: f64, limit: f64) {
    let error = (value - expected).abs();
    assert!(
        error <= limit,
        "{value} is not {expected}: off by {error:e}, limit {limit:e}"
    );
}

#[track_caller]
pub(crate) fn assert_close(value: DVec3, expected: DVec3, limit: f64) {
    let error = (value - expected).length();
    assert!(
        error <= limit,
        "{value} is not {expected}: off by {error:e}, limit {limit:e}"
    );
}

/// The angle between two vectors, also where it is small.
pub(crate) fn angle_deg(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

/// Asserts an angle known to `uncertainty` in radians, and to the roundings of its own size.
#[track_caller]
pub(crate) fn assert_angle_deg(value: f64, expected: f64, uncertainty: f64) {
    assert_near(
        value,
        expected,
        expected.abs() * RELATIVE + uncertainty.to_degrees(),
    );
}
