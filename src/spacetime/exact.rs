//! Sums and products that lose nothing: what is rounded away is kept as a second number.
//!
//! Sources: T. J. Dekker, *A floating-point technique for extending the available precision*, Numer. Math. 18
//! (1971), 224; D. E. Knuth, *The Art of Computer Programming* 2, section 4.2.2.
//!
//! For numbers up to about `1e150`, whose products and halves neither overflow nor lose digits that count.

use glam::DVec3;

/// `2^27 + 1`: splits a number into halves of 26 bits.
const SPLITTER: f64 = 134_217_729.0;

/// How what a product rounds away is found: the same number either way.
pub(crate) trait Product {
    /// `a b` rounded, and what was rounded away.
    fn two_product(a: f64, b: f64) -> (f64, f64);
}

/// By halves of 26 bits: on any processor.
pub(crate) struct Split;

/// By `f64::mul_add`: a slow call where the processor has no such instruction.
pub(crate) struct Fused;

impl Product for Split {
    #[inline(always)]
    fn two_product(a: f64, b: f64) -> (f64, f64) {
        let product = a * b;
        let (a_high, a_low) = split(a);
        let (b_high, b_low) = split(b);
        let error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
        (product, error)
    }
}

impl Product for Fused {
    #[inline(always)]
    fn two_product(a: f64, b: f64) -> (f64, f64) {
        let product = a * b;
        (product, a.mul_add(b, -product))
    }
}

/// `a + b` rounded, and what was rounded away.
#[inline(always)]
pub(crate) fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part_of_b = sum - a;
    (sum, (a - (sum - part_of_b)) + (b - part_of_b))
}

fn two_product(a: f64, b: f64) -> (f64, f64) {
    Split::two_product(a, b)
}

#[inline(always)]
fn split(number: f64) -> (f64, f64) {
    let scaled = SPLITTER * number;
    let high = scaled - (scaled - number);
    (high, number - high)
}

/// `a x b`, each component right to about one unit in its last place, however much of it cancels.
pub(crate) fn cross(a: DVec3, b: DVec3) -> DVec3 {
    cross_by::<Split>(a, b)
}

/// [`cross`] with products of one kind.
#[inline(always)]
pub(crate) fn cross_by<P: Product>(a: DVec3, b: DVec3) -> DVec3 {
    DVec3 {
        x: difference_of_products::<P>(a.y, b.z, a.z, b.y),
        y: difference_of_products::<P>(a.z, b.x, a.x, b.z),
        z: difference_of_products::<P>(a.x, b.y, a.y, b.x),
    }
}

/// `a b - c d`
#[inline(always)]
fn difference_of_products<P: Product>(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let (first, first_error) = P::two_product(a, b);
    let (second, second_error) = P::two_product(c, d);
    let (difference, rounded) = two_sum(first, -second);
    let (errors, errors_rounded) = two_sum(first_error, -second_error);
    // The errors may all but cancel what is left of the products.
    let (high, low) = two_sum(difference, errors);
    high + (low + (rounded + errors_rounded))
}

/// `a . b` rounded, and what was rounded away but for its own last place.
pub(crate) fn dot(a: DVec3, b: DVec3) -> (f64, f64) {
    let (x, x_error) = two_product(a.x, b.x);
    let (y, y_error) = two_product(a.y, b.y);
    let (z, z_error) = two_product(a.z, b.z);
    let (sum, first) = two_sum(x, y);
    let (sum, second) = two_sum(sum, z);
    two_sum(sum, (first + second) + ((x_error + y_error) + z_error))
}

/// The part of `vector` along `heading`, which need not be of unit length, in two numbers.
pub(crate) fn along(heading: DVec3, vector: DVec3) -> (f64, f64) {
    let (square, square_low) = dot(heading, heading);
    let root = square.sqrt();
    let (again, again_low) = two_product(root, root);
    let root_low = 0.5 * ((square - again) - again_low + square_low) / root;
    let (product, product_low) = dot(heading, vector);
    let quotient = product / root;
    let (again, again_low) = two_product(quotient, root);
    let rest = ((product - again) - again_low + product_low) - quotient * root_low;
    two_sum(quotient, rest / root)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_lost() {
        let (a, b) = (1.0 + f64::EPSILON, 1.0 - f64::EPSILON);
        let expected = (1.0, -f64::EPSILON * f64::EPSILON);
        assert_eq!(Split::two_product(a, b), expected);
        assert_eq!(Fused::two_product(a, b), expected);
        assert_eq!(two_sum(1e16, 0.75), (1e16, 0.75));
        assert_eq!(two_sum(0.75, 1e16), (1e16, 0.75));
    }

    /// `(1, 1 + 2 e, 0) x (1 - e, 1 + e, 0) = 2 e^2 z`, where both products are 1 + e but for that.
    #[test]
    fn nearly_collinear_vectors_have_an_exact_cross_product() {
        let e = f64::EPSILON;
        let a = DVec3::new(1.0, 1.0 + 2.0 * e, 0.0);
        let b = DVec3::new(1.0 - e, 1.0 + e, 0.0);
        assert_eq!(cross(a, b), DVec3::new(0.0, 0.0, 2.0 * e * e));
        assert_eq!(cross(b, a), DVec3::new(0.0, 0.0, -2.0 * e * e));
    }

    #[test]
    fn what_cancels_leaves_its_digits() {
        let (high, low) = dot(DVec3::new(1e16, 1.0, -1e16), DVec3::new(1.0, 0.3, 1.0));
        assert_eq!((high, low), (0.3, 0.0));
        // |(2, 3, 6)| = 7.
        let heading = DVec3::new(2.0, 3.0, 6.0);
        assert_eq!(along(heading, heading), (7.0, 0.0));
        let (high, low) = along(DVec3::new(1.0, 1.0, 0.0), DVec3::X);
        let (square, rest) = two_product(high, high);
        assert!(((square - 0.5) + rest + 2.0 * high * low).abs() < 1e-31);
    }
}
