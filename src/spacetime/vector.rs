//! Vectors of any size: directions and lengths where squares would overflow or lose digits.

use glam::DVec3;

/// The direction of `vector`, also where its square would overflow or underflow.
///
/// `None` for the zero vector and for a vector that is not finite.
pub(crate) fn unit(vector: DVec3) -> Option<DVec3> {
    let scaled = heading(vector)?;
    let scaled = scaled / scaled.abs().max_element();
    Some(scaled / scaled.length())
}

/// `vector` times a power of two, which loses no digits, so that its largest component is from 1 up to 2.
///
/// `None` for the zero vector and for a vector that is not finite.
pub(crate) fn heading(vector: DVec3) -> Option<DVec3> {
    let largest = vector.abs().max_element();
    if !(largest > 0.0 && vector.is_finite()) {
        return None;
    }
    // Two steps, because 1 / largest overflows for subnormal vectors.
    let scaled = if largest < f64::MIN_POSITIVE * 4.0 {
        vector * 2f64.powi(600)
    } else {
        vector
    };
    let bits = scaled.abs().max_element().to_bits() & f64::INFINITY.to_bits();
    Some(scaled / f64::from_bits(bits))
}

/// The length of a vector, also where its square would overflow or lose digits.
pub(crate) fn length(vector: DVec3) -> f64 {
    // Powers of two lose no digits.
    let scale = harmless_scale(vector);
    (vector * scale).length() / scale
}

/// A power of two that brings a vector to a length whose square is no trouble.
pub(crate) fn harmless_scale(vector: DVec3) -> f64 {
    let largest = vector.abs().max_element();
    if largest > 1e140 {
        2f64.powi(-600)
    } else if largest < 1e-140 {
        2f64.powi(600)
    } else {
        1.0
    }
}
