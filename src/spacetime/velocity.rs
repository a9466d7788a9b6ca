//! A velocity below that of light, held so that near light speed no digit is lost.

use glam::{DQuat, DVec3};
use thiserror::Error;

use super::{Event, exact, heading, length, unit};

/// The largest rapidity a [`Velocity`] may have: `1 - beta` is then about `2e-304`.
///
/// Two velocities of this rapidity may still be opposite: their relative rapidity of 700 keeps
/// `gamma` within `f64`.
pub const MAX_RAPIDITY: f64 = 350.0;

/// A velocity below that of light: rapidity and direction.
///
/// Near light speed `beta` runs out of digits (`1 - 1e-20` is not a number); the rapidity
/// `eta = atanh(beta)` does not. All constructors check; a value of this type is always usable.
///
/// # Accuracy
///
/// Two things are kept beside what rounds them. `exp(eta)`: half a unit in the last place of a rapidity of 300
/// is 128 units of it. And the direction as it was given: close behind a fast observer its last place is
/// magnified by `gamma`. So what counts is what was given, to a few units in the last place
/// (`tests/it/physics/hard_cases.rs`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Velocity {
    rapidity: f64,
    /// `exp(rapidity)`
    stretch: f64,
    direction: DVec3,
    heading: DVec3,
}

/// What tells velocities apart as `==` does, for maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct VelocityKey([u64; 8]);

/// Why numbers do not make a [`Velocity`].
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum VelocityError {
    /// `beta` outside `0 <= beta < 1`.
    #[error("beta is {0}, expected 0 <= beta < 1 (below the speed of light)")]
    Beta(f64),
    /// `1 - beta` outside `0 < 1 - beta <= 1`.
    #[error("one_minus_beta is {0}, expected 0 < one_minus_beta <= 1 (below the speed of light)")]
    OneMinusBeta(f64),
    /// `gamma < 1`, infinite or NaN.
    #[error("gamma is {0}, expected a finite number >= 1")]
    Gamma(f64),
    /// Rapidity negative, infinite or NaN.
    #[error("rapidity is {0}, expected a finite number >= 0")]
    Rapidity(f64),
    /// Faster than [`MAX_RAPIDITY`].
    #[error("the rapidity would be {0}, expected at most {MAX_RAPIDITY} (1 - beta = 2e-304)")]
    TooFast(f64),
    /// A direction without direction.
    #[error("the direction is {0}, expected a finite vector that is not zero")]
    Direction(DVec3),
}

impl Default for Velocity {
    /// At rest.
    fn default() -> Self {
        Self::ZERO
    }
}

impl Velocity {
    /// At rest.
    pub const ZERO: Self = Self {
        rapidity: 0.0,
        stretch: 1.0,
        direction: DVec3::NEG_Z,
        heading: DVec3::NEG_Z,
    };

    /// From the speed `0 <= beta < 1`; `direction` need not be of unit length.
    ///
    /// # Errors
    ///
    /// `beta` outside its range, or no direction.
    pub fn from_beta(beta: f64, direction: DVec3) -> Result<Self, VelocityError> {
        if !(0.0..1.0).contains(&beta) {
            return Err(VelocityError::Beta(beta));
        }
        let rapidity = beta.atanh();
        // The difference is exact where it is small.
        let stretch = ((1.0 + beta) / (1.0 - beta)).sqrt();
        Self::checked(rapidity, stretch, direction)
    }

    /// From `0 < 1 - beta <= 1`, for speeds that `beta` cannot say.
    ///
    /// # Errors
    ///
    /// `one_minus_beta` outside its range or below that of [`MAX_RAPIDITY`], or no direction.
    pub fn from_one_minus_beta(
        one_minus_beta: f64,
        direction: DVec3,
    ) -> Result<Self, VelocityError> {
        if !(one_minus_beta > 0.0 && one_minus_beta <= 1.0) {
            return Err(VelocityError::OneMinusBeta(one_minus_beta));
        }
        // atanh(1 - x) = log1p(2 (1 - x) / x) / 2; the quotient overflows for subnormal x only,
        // which is too fast anyway.
        let rapidity = 0.5 * (2.0 * (1.0 - one_minus_beta) / one_minus_beta).ln_1p();
        let stretch = (2.0 - one_minus_beta).sqrt() / one_minus_beta.sqrt();
        Self::checked(rapidity, stretch, direction)
    }

    /// From the Lorentz factor `gamma >= 1`.
    ///
    /// # Errors
    ///
    /// `gamma` outside its range or above that of [`MAX_RAPIDITY`], or no direction.
    pub fn from_gamma(gamma: f64, direction: DVec3) -> Result<Self, VelocityError> {
        if !(gamma >= 1.0 && gamma.is_finite()) {
            return Err(VelocityError::Gamma(gamma));
        }
        // acosh(gamma) without the cancellation at gamma = 1: gamma - 1 = 2 sinh^2(eta / 2).
        let rapidity = 2.0 * (0.5 * (gamma - 1.0)).sqrt().asinh();
        let stretch = gamma + (gamma - 1.0).sqrt() * (gamma + 1.0).sqrt();
        Self::checked(rapidity, stretch, direction)
    }

    /// From the rapidity `eta = atanh(beta) >= 0`.
    ///
    /// # Errors
    ///
    /// `rapidity` negative, not finite or above [`MAX_RAPIDITY`], or no direction.
    pub fn from_rapidity(rapidity: f64, direction: DVec3) -> Result<Self, VelocityError> {
        if rapidity.is_nan() || rapidity < 0.0 {
            return Err(VelocityError::Rapidity(rapidity));
        }
        Self::checked(rapidity, rapidity.exp(), direction)
    }

    fn checked(rapidity: f64, stretch: f64, direction: DVec3) -> Result<Self, VelocityError> {
        if rapidity > MAX_RAPIDITY {
            return Err(VelocityError::TooFast(rapidity));
        }
        let (Some(heading), Some(unit)) = (heading(direction), unit(direction)) else {
            return Err(VelocityError::Direction(direction));
        };
        // Where the unit vector says as much, it alone is kept.
        let exact = exact::cross(heading, unit) == DVec3::ZERO;
        Ok(Self {
            // A speed of -0 is rest as well.
            rapidity: rapidity.abs(),
            stretch,
            direction: unit,
            heading: if exact { unit } else { heading },
        })
    }

    /// From the velocity vector, `|vector| < 1`; the zero vector is rest.
    ///
    /// # Errors
    ///
    /// `|vector|` is not below 1, or a component is not finite.
    pub fn from_vector(vector: DVec3) -> Result<Self, VelocityError> {
        if vector == DVec3::ZERO {
            return Ok(Self::ZERO);
        }
        if !vector.is_finite() {
            return Err(VelocityError::Direction(vector));
        }
        let beta = length(vector);
        if beta < 0.5 {
            return Self::from_beta(beta, vector);
        }
        if beta > 2.0 {
            return Err(VelocityError::Beta(beta));
        }
        // 1 - |vector|^2 as if nothing were rounded: near light speed all depends on it.
        let (square, low) = exact::dot(vector, vector);
        let (rest, rounded) = exact::two_sum(1.0, -square);
        let one_minus_square = rest + (rounded - low);
        if one_minus_square <= 0.0 {
            return Err(VelocityError::Beta(beta));
        }
        let stretch = (1.0 + beta) / one_minus_square.sqrt();
        Self::checked(stretch.ln(), stretch, vector)
    }

    /// For results of this module: `direction` is a unit vector, `rapidity` is held at twice [`MAX_RAPIDITY`].
    pub(super) fn from_parts(rapidity: f64, stretch: f64, direction: DVec3) -> Self {
        let (rapidity, stretch) = held(rapidity, stretch);
        debug_assert!((direction.length() - 1.0).abs() < 1e-9);
        debug_assert!(rapidity >= 0.0);
        debug_assert!((stretch.ln() - rapidity).abs() <= 1e-9);
        Self {
            rapidity,
            stretch,
            direction,
            heading: direction,
        }
    }

    /// Of which `celerity` is the space part of the four-velocity; that of rest is zero.
    pub(super) fn of_celerity(celerity: DVec3) -> Self {
        let size = length(celerity);
        match unit(celerity) {
            Some(direction) => Self::from_parts(size.asinh(), size + size.hypot(1.0), direction),
            None => Self::ZERO,
        }
    }

    /// In the same direction, or in the opposite one, with another rapidity.
    ///
    /// `stretch` is `exp(rapidity)`, rounded by itself: near 1 the two may disagree about the sense of motion. The
    /// rapidity decides, and no stretch of the result is below 1.
    pub(super) fn with_signed_rapidity(&self, rapidity: f64, stretch: f64) -> Self {
        let (carrier, stretch) = if rapidity.is_sign_negative() {
            (self.reversed(), 1.0 / stretch)
        } else {
            (*self, stretch)
        };
        let (size, stretch) = held(rapidity.abs(), stretch);
        Self {
            rapidity: size,
            stretch: if size == 0.0 { 1.0 } else { stretch.max(1.0) },
            ..carrier
        }
    }

    /// The same speed in a direction turned by `rotation`.
    pub(super) fn turned(&self, rotation: DQuat) -> Self {
        if rotation == DQuat::IDENTITY {
            return *self;
        }
        Self::from_parts(
            self.rapidity,
            self.stretch,
            (rotation * self.direction).normalize(),
        )
    }

    /// The rapidity `eta = atanh(beta)`, not negative.
    pub fn rapidity(&self) -> f64 {
        self.rapidity
    }

    /// The direction of motion, a unit vector; at rest it has no meaning.
    pub fn direction(&self) -> DVec3 {
        self.direction
    }

    /// A vector in the direction of motion as it was given, but for its length: [`Velocity::direction`] is this brought
    /// to unit length, which rounds it.
    pub fn heading(&self) -> DVec3 {
        self.heading
    }

    /// `exp(eta)`: how much farther away than at rest things straight ahead are seen.
    pub fn stretch(&self) -> f64 {
        self.stretch
    }

    /// The speed; rounds to 1 from a rapidity of about 19.
    pub fn beta(&self) -> f64 {
        self.rapidity.tanh()
    }

    /// `1 - beta`, with all its digits.
    pub fn one_minus_beta(&self) -> f64 {
        1.0 / self.stretch / self.gamma()
    }

    /// The Lorentz factor `cosh(eta)`.
    pub fn gamma(&self) -> f64 {
        // Halves first: twice the largest gamma is beyond f64.
        0.5 * self.stretch + 0.5 / self.stretch
    }

    /// `gamma beta = sinh(eta)`, the space part of the four-velocity.
    pub fn gamma_beta(&self) -> f64 {
        if self.rapidity < 1.0 {
            return self.rapidity.sinh();
        }
        0.5 * self.stretch - 0.5 / self.stretch
    }

    /// The four-velocity `(gamma, gamma beta n)`: the change of an event with the proper time of something that moves so.
    pub fn four_velocity(&self) -> Event {
        Event::new(self.gamma(), self.direction * self.gamma_beta())
    }

    /// A key for maps.
    pub(crate) fn key(&self) -> VelocityKey {
        let [a, b, c] = self.direction.to_array();
        let [x, y, z] = self.heading.to_array();
        // Adding zero makes one of both zeros.
        let numbers = [self.rapidity, self.stretch, a, b, c, x, y, z];
        VelocityKey(numbers.map(|number| (number + 0.0).to_bits()))
    }

    /// The velocity with which this one's rest frame sees its reference frame move, axes related
    /// by a pure boost.
    pub fn reversed(&self) -> Self {
        Self {
            direction: -self.direction,
            heading: -self.heading,
            ..*self
        }
    }
}

/// A rapidity of at most twice [`MAX_RAPIDITY`], rounding aside, and its exponential, whose `gamma` is within `f64`.
fn held(rapidity: f64, stretch: f64) -> (f64, f64) {
    const LARGEST: f64 = 2.0 * MAX_RAPIDITY;
    match rapidity > LARGEST * (1.0 + 1e-9) {
        true => (LARGEST, LARGEST.exp()),
        false => (rapidity, stretch),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn relative_error(value: f64, expected: f64) -> f64 {
        ((value - expected) / expected).abs()
    }

    #[test]
    fn every_way_to_give_a_speed_gives_the_same_velocity() {
        // beta = 0.6: gamma = 5/4, rapidity = ln 2.
        let x = DVec3::new(3.0, 0.0, 0.0);
        for velocity in [
            Velocity::from_beta(0.6, x).unwrap(),
            Velocity::from_one_minus_beta(0.4, x).unwrap(),
            Velocity::from_gamma(1.25, x).unwrap(),
            Velocity::from_rapidity(2f64.ln(), x).unwrap(),
            Velocity::from_vector(DVec3::new(0.6, 0.0, 0.0)).unwrap(),
        ] {
            assert!(relative_error(velocity.rapidity(), std::f64::consts::LN_2) < 4e-16);
            assert!(relative_error(velocity.gamma(), 1.25) < 4e-16);
            assert!(relative_error(velocity.gamma_beta(), 0.75) < 4e-16);
            assert_eq!(velocity.direction(), DVec3::X);
        }
    }

    #[test]
    fn speeds_that_beta_cannot_say_keep_their_digits() {
        for exponent in [1, 10, 20, 100, 200, 300] {
            let one_minus_beta = 10f64.powi(-exponent);
            let velocity = Velocity::from_one_minus_beta(one_minus_beta, DVec3::X).unwrap();
            assert!(relative_error(velocity.one_minus_beta(), one_minus_beta) < 4.0 * f64::EPSILON);
        }
        let slow = Velocity::from_beta(5e-324, DVec3::Y).unwrap();
        assert_eq!(slow.gamma_beta(), 5e-324);
        let slow = Velocity::from_gamma(1.0 + f64::EPSILON, DVec3::Y).unwrap();
        assert!(relative_error(slow.rapidity(), (2.0 * f64::EPSILON).sqrt()) < 4e-16);
        let gamma = Velocity::from_gamma(1e150, DVec3::Y).unwrap();
        assert!(relative_error(gamma.gamma(), 1e150) < 2.0 * f64::EPSILON);
    }

    /// `1 - |v|^2 = 1 - 0.6^2 - 0.8^2` of these two numbers is 2^-52 times a number that rounding would not show.
    #[test]
    fn a_vector_just_below_the_speed_of_light_keeps_its_digits() {
        let vector = DVec3::new(0.6, 0.8f64.next_down(), 0.0);
        let velocity = Velocity::from_vector(vector).unwrap();
        // 0.6 = 3/5 - 2^-54 (4/5 / 1.8...), written out: |v|^2 in whole multiples of 2^-106.
        let whole = |x: f64| (x * 2f64.powi(53)) as i128;
        let left = (1i128 << 106) - whole(0.6).pow(2) - whole(vector.y).pow(2);
        let gamma = (left as f64 * 2f64.powi(-106)).sqrt().recip();
        assert!(relative_error(velocity.gamma(), gamma) < 4.0 * f64::EPSILON);
        assert_eq!(velocity.heading() * 0.5, vector);
    }

    #[test]
    fn impossible_speeds_are_refused_with_their_value() {
        let x = DVec3::X;
        assert_eq!(Velocity::from_beta(1.0, x), Err(VelocityError::Beta(1.0)));
        assert_eq!(Velocity::from_beta(-0.5, x), Err(VelocityError::Beta(-0.5)));
        assert!(Velocity::from_beta(f64::NAN, x).is_err());
        assert!(Velocity::from_one_minus_beta(0.0, x).is_err());
        assert!(Velocity::from_one_minus_beta(5e-324, x).is_err());
        assert!(Velocity::from_gamma(0.5, x).is_err());
        assert!(Velocity::from_gamma(f64::INFINITY, x).is_err());
        assert!(Velocity::from_rapidity(-1.0, x).is_err());
        assert!(Velocity::from_rapidity(351.0, x).is_err());
        assert!(Velocity::from_vector(DVec3::ONE).is_err());
        assert!(Velocity::from_beta(0.5, DVec3::ZERO).is_err());
        assert!(Velocity::from_beta(0.5, DVec3::new(f64::NAN, 0.0, 1.0)).is_err());
    }

    #[test]
    fn directions_of_any_length_are_normalised() {
        let expected = DVec3::new(0.6, 0.0, 0.8);
        for length in [5e-320, 1e-300, 1e-3, 1.0, 1e10, 1e307] {
            let velocity = Velocity::from_beta(0.5, expected * length).unwrap();
            // Subnormal numbers have few digits of their own.
            let allowed = if length < 1e-300 { 1e-3 } else { 4e-16 };
            assert!((velocity.direction() - expected).length() < allowed);
            assert!((velocity.direction().length() - 1.0).abs() < 4e-16);
        }
    }
}
