/** Numbers as people read them. */

/**
 * Beta, with so many digits that its distance from 1 shows two.
 * @param {number} rapidity
 */
export function betaText(rapidity) {
    // 1 - beta, without cancellation.
    const rest = 2 / (Math.exp(2 * Math.abs(rapidity)) + 1);
    if (rest < 1e-15) {
        return `1 − ${rest.toExponential(1).replace("-", "−")}`;
    }
    const digits = Math.max(3, Math.ceil(-Math.log10(rest)) + 1);
    return Math.tanh(Math.abs(rapidity)).toFixed(Math.min(digits, 17));
}

/**
 * A number of any size with about four digits.
 * @param {number} value
 */
export function numberText(value) {
    const size = Math.abs(value);
    if (size >= 1e6 || (size > 0 && size < 1e-3)) {
        return value.toExponential(3).replace("-", "−");
    }
    return value.toFixed(size >= 1000 ? 0 : size >= 100 ? 1 : size >= 10 ? 2 : 3).replace("-", "−");
}
