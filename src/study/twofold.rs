//! Numbers of twice the digits: the sum of two `f64`, about 32 decimal digits.
//!
//! Source: Y. Hida, X. S. Li, D. H. Bailey, *Algorithms for quad-double precision floating point arithmetic*, ARITH-15
//! (2001). As for the sums and products that they are made of, numbers are up to about `1e150` in size.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::spacetime::exact::{Product, Split, two_sum};

/// The unit in the last place of a [`Twofold`] of size 1, rounded up.
pub(super) const TWOFOLD_EPSILON: f64 = f64::EPSILON * f64::EPSILON;

/// The sum of two numbers, the second one at most half a unit in the last place of the first.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub(super) struct Twofold {
    high: f64,
    low: f64,
}

impl Twofold {
    pub(super) const ONE: Self = Self {
        high: 1.0,
        low: 0.0,
    };

    /// The number, rounded.
    pub(super) fn value(self) -> f64 {
        self.high
    }

    /// The square root of a number that is not negative.
    pub(super) fn sqrt(self) -> Self {
        let root = self.high.sqrt();
        if root == 0.0 {
            return Self::default();
        }
        // One step of Newton's doubles the digits.
        let root = Self::from(root);
        root + (self - root * root) / (root + root)
    }

    /// The hyperbolic cosine and sine of a number up to 1, by their series.
    pub(super) fn cosh_sinh(number: f64) -> (Self, Self) {
        let mut term = Self::ONE;
        let mut sums = [Self::ONE, Self::default()];
        // 1/30! is 4e-33.
        for power in 1..=30 {
            term = term * Self::from(number) / Self::from(f64::from(power));
            sums[power as usize % 2] = sums[power as usize % 2] + term;
        }
        (sums[0], sums[1])
    }

    fn renormalized(high: f64, low: f64) -> Self {
        let (high, low) = two_sum(high, low);
        Self { high, low }
    }
}

impl From<f64> for Twofold {
    fn from(number: f64) -> Self {
        Self {
            high: number,
            low: 0.0,
        }
    }
}

impl Add for Twofold {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, high_rest) = two_sum(self.high, other.high);
        let (low, low_rest) = two_sum(self.low, other.low);
        let sum = Self::renormalized(high, high_rest + low);
        Self::renormalized(sum.high, sum.low + low_rest)
    }
}

impl Neg for Twofold {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Sub for Twofold {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Twofold {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (product, rest) = Split::two_product(self.high, other.high);
        Self::renormalized(
            product,
            rest + (self.high * other.low + self.low * other.high),
        )
    }
}

impl Div for Twofold {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        // As by hand, digit by digit, where a digit is an `f64`.
        let first = self.high / other.high;
        let rest = self - other * Self::from(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::from(second);
        Self::renormalized(first, second) + Self::from(rest.high / other.high)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::SQRT_2;

    use super::*;

    fn number(number: f64) -> Twofold {
        Twofold::from(number)
    }

    #[track_caller]
    fn assert_same(a: Twofold, b: Twofold) {
        let off = (a - b).value().abs();
        assert!(
            off <= 8.0 * TWOFOLD_EPSILON * b.value().abs(),
            "{a:?} {b:?}"
        );
    }

    #[test]
    fn what_is_done_can_be_undone() {
        let (a, b) = (
            number(1.0) / number(3.0),
            number(-2e5) / number(7.0) + number(1e-9),
        );
        assert_same(a * number(3.0), Twofold::ONE);
        assert_same(a / b * b, a);
        assert_same((a + b) - b + b, a + b);
        let root = number(2.0).sqrt();
        assert_same(root * root, number(2.0));
        assert_eq!(number(0.0).sqrt(), number(0.0));
    }

    /// The square root of 2 and what its nearest `f64` leaves.
    #[test]
    fn there_are_32_digits() {
        let expected = Twofold::renormalized(SQRT_2, -9.667_293_313_452_913e-17);
        assert_same(number(2.0).sqrt(), expected);
    }

    #[test]
    fn hyperbolic_functions_lie_on_the_hyperbola() {
        for rapidity in [1e-30, 0.1, 0.7, 1.0] {
            let (cosh, sinh) = Twofold::cosh_sinh(rapidity);
            assert_same((cosh - sinh) * (cosh + sinh), Twofold::ONE);
            assert!((sinh.value() / rapidity.sinh() - 1.0).abs() < 4e-16);
        }
    }
}
