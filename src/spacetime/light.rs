//! Light in a frame in motion: its direction and frequency, at any speed.

use glam::DVec3;

/// The frequency and the wave vector of light in a frame in motion, over its frequency in the frame at rest.
///
/// # Derivation
///
/// Light that travels in the unit direction `d` has in a frame that moves with rapidity `eta` along `n`, with `theta`
/// between `n` and `d`, the frequency and the wave vector
///
/// ```text
/// D = sin^2(theta/2) e^eta + cos^2(theta/2) e^-eta        D d' = d_across + n (cos^2(theta/2) e^-eta - sin^2(theta/2) e^eta)
/// sin(theta/2) = |d - n| / 2                              cos(theta/2) = |d + n| / 2
/// ```
///
/// relative to those here: the textbook's `gamma (1 - beta cos theta)`, of which nothing cancels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MovedLight {
    /// The part of the wave vector across the motion.
    pub(crate) across: DVec3,
    /// Its component along the motion.
    pub(crate) along: f64,
    /// The frequency; also the length of the wave vector.
    pub(crate) factor: f64,
}

impl MovedLight {
    /// Light that travels in the unit direction `travel`, in a frame that moves in the unit direction `motion`; `grow` and
    /// `shrink` are `e^eta` and `e^-eta`.
    pub(crate) fn new(travel: DVec3, motion: DVec3, grow: f64, shrink: f64) -> Self {
        let (to_front, to_back) = (travel - motion, travel + motion);
        let sin_squared = to_front.length_squared() / 4.0;
        let cos_squared = to_back.length_squared() / 4.0;
        // Of the closer of both differences: its part along the motion, which is that of a rounded unit vector, would be
        // large beside a small part across.
        let closer = match sin_squared < cos_squared {
            true => to_front,
            false => to_back,
        };
        Self {
            across: motion.cross(closer).cross(motion),
            along: cos_squared * shrink - sin_squared * grow,
            factor: cos_squared * shrink + sin_squared * grow,
        }
    }

    /// The direction, of about unit length.
    pub(crate) fn direction(&self, motion: DVec3) -> DVec3 {
        // Divided before it is squared: the factor may be as large as exp(700).
        self.across / self.factor + motion * (self.along / self.factor)
    }
}
