//! Functions of hyperbolic and circular arguments whose usual forms cancel near 0.
//!
//! Each is a power series below [`NEAR`] and the usual form above it. At [`NEAR`] the usual form has lost at most two
//! bits and the series has converged, so that the change from one to the other is within rounding.

/// From here on the usual forms are used.
const NEAR: f64 = 2.0;

/// Terms of the series: `4^14 / 29!` is below `1e-22`.
const TERMS: i32 = 14;

/// `sum of x^(2k) c_k`, for `k` from 1, each coefficient the one before times `ratio(k)`, the first `ratio(1)`.
fn series(square: f64, ratio: impl Fn(f64) -> f64) -> f64 {
    let terms = (1..=TERMS).rev();
    terms.fold(0.0, |sum, k| square * ratio(f64::from(k)) * (1.0 + sum))
}

/// `sinh(x) / x`, 1 at 0.
pub(super) fn sinhc(x: f64) -> f64 {
    1.0 + sinhc_above_1(x)
}

/// `sinh(x) / x - 1`, never negative.
pub(super) fn sinhc_above_1(x: f64) -> f64 {
    if x < NEAR {
        return series(x * x, |k| 1.0 / (2.0 * k * (2.0 * k + 1.0)));
    }
    x.sinh() / x - 1.0
}

/// `1 - sin(x) / x`, never negative.
pub(super) fn sinc_below_1(x: f64) -> f64 {
    if x < NEAR {
        return -series(-x * x, |k| 1.0 / (2.0 * k * (2.0 * k + 1.0)));
    }
    1.0 - x.sin() / x
}

/// `cosh(x) - sinh(x) / x`, never negative: `sum of 2k x^(2k) / (2k + 1)!`.
pub(super) fn cosh_above_sinhc(x: f64) -> f64 {
    if x < NEAR {
        return series(x * x, first_moment);
    }
    x.cosh() - x.sinh() / x
}

/// `sin(x) / x - cos(x)`.
pub(super) fn sinc_above_cos(x: f64) -> f64 {
    if x < NEAR {
        return -series(-x * x, first_moment);
    }
    x.sin() / x - x.cos()
}

/// `2k / (2k + 1)!` over the same for `k - 1`; for 1 itself.
fn first_moment(k: f64) -> f64 {
    match k {
        1.0 => 1.0 / 3.0,
        _ => 1.0 / ((2.0 * k - 2.0) * (2.0 * k + 1.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The usual forms with 100 digits, by which nothing cancels.
    #[test]
    fn neither_form_loses_digits() {
        use dashu_float::{FBig, round::mode::HalfEven};
        type Big = FBig<HalfEven, 2>;
        let big = |x: f64| Big::try_from(x).unwrap().with_precision(400).value();
        let whole = |sign: f64, x: f64| {
            // sinhc and cosh of x, or sinc and cos, term by term.
            let square = big(sign) * big(x) * big(x);
            let (mut term, mut sinhc, mut cosh) = (big(1.0), big(0.0), big(0.0));
            for k in 0..400 {
                cosh += &term;
                term /= big(f64::from(2 * k + 1).max(1.0));
                sinhc += &term;
                term = term * &square / big(f64::from(2 * k + 2));
            }
            (sinhc, cosh)
        };
        for x in [
            1e-40, 1e-9, 1e-3, 0.1, 0.7, 1.0, 1.5, 1.9999, 2.0, 2.0001, 3.0, 5.0, 20.0,
        ] {
            let (sinhc_x, cosh) = whole(1.0, x);
            let (sinc, cos) = whole(-1.0, x);
            for (name, found, expected) in [
                ("sinhc", sinhc(x), sinhc_x.clone()),
                ("sinhc - 1", sinhc_above_1(x), sinhc_x.clone() - big(1.0)),
                ("1 - sinc", sinc_below_1(x), big(1.0) - &sinc),
                ("cosh - sinhc", cosh_above_sinhc(x), cosh - sinhc_x),
                ("sinc - cos", sinc_above_cos(x), sinc - cos),
            ] {
                let expected = expected.to_f64().value();
                // sinc - cos oscillates about 0: there its size is that of its terms.
                let size = if x > 4.0 {
                    1.0f64.max(expected.abs())
                } else {
                    expected.abs()
                };
                assert!(
                    (found - expected).abs() <= 4.0 * f64::EPSILON * size,
                    "{name} of {x}: {found:e} {expected:e}"
                );
            }
        }
    }
}
