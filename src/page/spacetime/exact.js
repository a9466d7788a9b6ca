/**
 * Sums of products with twice the digits of a number: what rounding takes away is kept as a second number.
 *
 * Sources: T. J. Dekker, A floating-point technique for extending the available precision, Numer. Math. 18 (1971), 224;
 * T. Ogita, S. M. Rump, S. Oishi, Accurate sum and dot product, SIAM J. Sci. Comput. 26 (2005), 1955.
 */

/** `2^27 + 1`: splits a number into halves of 26 bits. */
const SPLITTER = 134217729;

/** A sum that keeps what it rounds away; for numbers up to about 1e290. */
export class Sum {
    /** @param {number} high @param {number} low */
    constructor(high = 0, low = 0) {
        this.high = high;
        this.low = low;
    }

    /** @param {number} number */
    add(number) {
        const sum = this.high + number;
        const part = sum - this.high;
        this.low += this.high - (sum - part) + (number - part);
        this.high = sum;
    }

    /** @param {number} a @param {number} b */
    addProduct(a, b) {
        const product = a * b;
        const splitA = SPLITTER * a;
        const highA = splitA - (splitA - a);
        const lowA = a - highA;
        const splitB = SPLITTER * b;
        const highB = splitB - (splitB - b);
        const lowB = b - highB;
        this.low += highA * highB - product + highA * lowB + lowA * highB + lowA * lowB;
        this.add(product);
    }

    /** The sum, rounded once. */
    get value() {
        return this.high + this.low;
    }

    /** What {@link Sum.value} rounds away. */
    get rest() {
        return this.high - this.value + this.low;
    }
}

/**
 * `a . b - c . d`, rounded once.
 * @param {readonly number[]} a @param {readonly number[]} b @param {readonly number[]} c @param {readonly number[]} d
 */
export function differenceOfProducts(a, b, c, d) {
    const sum = new Sum();
    for (let i = 0; i < a.length; i++) {
        sum.addProduct(a[i], b[i]);
        sum.addProduct(-c[i], d[i]);
    }
    return sum.value;
}
