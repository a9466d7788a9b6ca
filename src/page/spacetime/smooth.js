/**
 * Functions of hyperbolic and circular arguments whose usual forms cancel near 0.
 *
 * Each is a power series below NEAR and the usual form above it. At NEAR the usual form has lost at most two bits and the
 * series has converged, so that the change from one to the other is within rounding. All are even.
 */

const NEAR = 2;

/** Terms of the series: `4^14 / 29!` is below 1e-22. */
const TERMS = 14;

/**
 * `sum of x^(2k) c_k` for `k` from 1, each coefficient the one before times `ratio(k)`, the first `ratio(1)`.
 * @param {number} square @param {(k: number) => number} ratio
 */
function series(square, ratio) {
    let sum = 0;
    for (let k = TERMS; k >= 1; k--) {
        sum = square * ratio(k) * (1 + sum);
    }
    return sum;
}

/** @param {number} k */
function inverseFactorials(k) {
    return 1 / (2 * k * (2 * k + 1));
}

/** `2k / (2k + 1)!` over the same for `k - 1`; for 1 itself. @param {number} k */
function firstMoment(k) {
    return k === 1 ? 1 / 3 : 1 / ((2 * k - 2) * (2 * k + 1));
}

/** `sinh(x) / x`, 1 at 0. @param {number} x */
export function sinhc(x) {
    return 1 + sinhcAbove1(x);
}

/** `sin(x) / x`, 1 at 0. @param {number} x */
export function sinc(x) {
    return 1 - sincBelow1(x);
}

/** `sinh(x) / x - 1`, never negative. @param {number} x */
export function sinhcAbove1(x) {
    return Math.abs(x) < NEAR ? series(x * x, inverseFactorials) : Math.sinh(x) / x - 1;
}

/** `1 - sin(x) / x`, never negative. @param {number} x */
export function sincBelow1(x) {
    return Math.abs(x) < NEAR ? -series(-x * x, inverseFactorials) : 1 - Math.sin(x) / x;
}

/** `cosh(x) - sinh(x) / x`, never negative. @param {number} x */
export function coshAboveSinhc(x) {
    return Math.abs(x) < NEAR ? series(x * x, firstMoment) : Math.cosh(x) - Math.sinh(x) / x;
}

/** `sin(x) / x - cos(x)`. @param {number} x */
export function sincAboveCos(x) {
    return Math.abs(x) < NEAR ? -series(-x * x, firstMoment) : Math.sin(x) / x - Math.cos(x);
}
