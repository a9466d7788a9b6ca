/** Vectors of three numbers. */

/** @typedef {[number, number, number]} Vec3 */

/** @type {Readonly<Vec3>} */
export const ZERO = [0, 0, 0];

/**
 * The own axis along which an observer looks.
 * @type {Readonly<Vec3>}
 */
export const AHEAD = [0, 0, -1];

/** @param {Readonly<Vec3>} a @param {Readonly<Vec3>} b @returns {Vec3} */
export function sum(a, b) {
    return [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
}

/** @param {Readonly<Vec3>} a @param {Readonly<Vec3>} b @returns {Vec3} */
export function subtract(a, b) {
    return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

/** @param {Readonly<Vec3>} vector @param {number} factor @returns {Vec3} */
export function scaled(vector, factor) {
    return [vector[0] * factor, vector[1] * factor, vector[2] * factor];
}

/** @param {Readonly<Vec3>} a @param {Readonly<Vec3>} b */
export function dot(a, b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** @param {Readonly<Vec3>} a @param {Readonly<Vec3>} b @returns {Vec3} */
export function cross(a, b) {
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

/** @param {Readonly<Vec3>} vector */
export function length(vector) {
    const largest = Math.max(Math.abs(vector[0]), Math.abs(vector[1]), Math.abs(vector[2]));
    if (!(largest > 0 && largest < Infinity)) {
        return largest;
    }
    const [x, y, z] = scaled(vector, 1 / largest);
    return largest * Math.sqrt(x * x + y * y + z * z);
}

/**
 * The direction of a vector; `otherwise` for the zero vector and for one that is not finite.
 * @param {Readonly<Vec3>} vector @param {Readonly<Vec3>} otherwise @returns {Vec3}
 */
export function unit(vector, otherwise) {
    const size = length(vector);
    if (!(size > 0 && size < Infinity)) {
        return [...otherwise];
    }
    return [vector[0] / size, vector[1] / size, vector[2] / size];
}
