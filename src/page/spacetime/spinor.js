/**
 * Lorentz transformations as complex 2x2 matrices of determinant 1, SL(2,C), with twice the digits of a number.
 *
 * A matrix is written `s + v.sigma` with a complex scalar `s` and a complex vector `v`; a four-vector `(t, x)` is
 * `t + x.sigma` and becomes `L (t + x.sigma) L*` under `L`, where `*` is the conjugate transpose. A boost with rapidity
 * `eta` along `n` is `cosh(eta/2) + sinh(eta/2) n.sigma`, a rotation by `phi` about `m` is
 * `cos(phi/2) - i sin(phi/2) m.sigma`. So `L L*` is the four-velocity, and the rotation before the boost is what the real
 * part of `s` and the imaginary part of `v` make.
 *
 * Between two frames that both move with Lorentz factor `gamma` rounding is magnified by up to `gamma^2`: hence twice the
 * digits. With them a product of millions of short steps is as good as one long step.
 */

import { Sum } from "./exact.js";
import { normalized } from "./quaternion.js";
import { length, unit } from "./vector.js";

/** @typedef {import("./vector.js").Vec3} Vec3 */
/** @typedef {import("./quaternion.js").Quaternion} Quaternion */
/**
 * Eight numbers, real and imaginary parts of `s`, `v_x`, `v_y`, `v_z`, and then what rounding has taken from each.
 * @typedef {Float64Array} Spinor
 */
/**
 * A four-vector `t, x, y, z`, as eight numbers: rounded ones, and what rounding has taken from each.
 * @typedef {readonly number[]} ExactEvent
 */

const PARTS = 8;

/** Which parts of two factors make the parts of a product: `[part of a, part of b, sign]`, eight for each. */
const TERMS = termsOfProduct();

function termsOfProduct() {
    // e_0 = 1, e_1..3 = sigma: e_j e_k = i e_l in cyclic order.
    /** @type {[number, number, number][][]} */
    const terms = Array.from({ length: PARTS }, () => []);
    for (let a = 0; a < 4; a++) {
        for (let b = 0; b < 4; b++) {
            const mixed = a !== 0 && b !== 0 && a !== b;
            const to = mixed ? 6 - a - b : a === b ? 0 : a + b;
            const sign = mixed && (b - a + 3) % 3 === 2 ? -1 : 1;
            for (const [partA, partB] of [
                [0, 0],
                [0, 1],
                [1, 0],
                [1, 1],
            ]) {
                // Powers of i.
                const power = partA + partB + (mixed ? 1 : 0);
                terms[2 * to + (power % 2)].push([2 * a + partA, 2 * b + partB, power >= 2 ? -sign : sign]);
            }
        }
    }
    return Int8Array.from(terms.flat(2));
}

/** @returns {Spinor} */
function zero() {
    return new Float64Array(2 * PARTS);
}

/** @returns {Spinor} */
export function identity() {
    return scalar(1, 0);
}

/** The number `high + low`. @param {number} high @param {number} low @returns {Spinor} */
function scalar(high, low) {
    const spinor = zero();
    spinor[0] = high;
    spinor[PARTS] = low;
    return spinor;
}

/**
 * From numbers: a complex scalar and a complex vector.
 * @param {readonly [number, number]} s @param {readonly Readonly<Vec3>[]} v real and imaginary part
 * @returns {Spinor}
 */
export function spinorOf([re, im], [real, imaginary]) {
    const spinor = zero();
    spinor.set([re, im, real[0], imaginary[0], real[1], imaginary[1], real[2], imaginary[2]]);
    return unimodular(spinor);
}

/** @param {Spinor} a @param {Spinor} b @returns {Spinor} */
export function multiply(a, b) {
    const product = zero();
    const sum = new Sum();
    let at = 0;
    for (let part = 0; part < PARTS; part++) {
        sum.high = 0;
        sum.low = 0;
        for (let term = 0; term < PARTS; term++) {
            const [i, j, sign] = [TERMS[at], TERMS[at + 1], TERMS[at + 2]];
            at += 3;
            sum.addProduct(sign * a[i], b[j]);
            sum.low += sign * (a[i] * b[j + PARTS] + a[i + PARTS] * b[j]);
        }
        product[part] = sum.value;
        product[part + PARTS] = sum.rest;
    }
    return product;
}

/** @param {Spinor} spinor @param {(part: number) => boolean} isFlipped @returns {Spinor} */
function flipped(spinor, isFlipped) {
    return spinor.map((number, index) => (isFlipped(index % PARTS) ? -number : number));
}

/** The transformation back, of one of determinant 1. @param {Spinor} spinor */
export function inverse(spinor) {
    return flipped(spinor, (part) => part >= 2);
}

/** The conjugate transpose. @param {Spinor} spinor */
function adjoint(spinor) {
    return flipped(spinor, (part) => part % 2 === 1);
}

/**
 * Brought back to determinant 1, from which rounding has led by little.
 * @param {Spinor} spinor
 */
export function unimodular(spinor) {
    const determinant = multiply(spinor, inverse(spinor));
    const real = determinant[0] - 1 + determinant[PARTS];
    const imaginary = determinant[1];
    // Near 1e16 in gamma no digit of the determinant is left.
    if (!(Math.hypot(real, imaginary) < 1e-3)) {
        return spinor;
    }
    // 1/sqrt(1 + d) = 1 - d/2 + 3 d^2/8 - ...
    const square = 0.375 * (real * real - imaginary * imaginary);
    const sum = new Sum(1);
    sum.add(-0.5 * real + square);
    const root = scalar(sum.value, sum.rest);
    root[1] = -0.5 * imaginary + 0.75 * real * imaginary;
    return multiply(spinor, root);
}

/**
 * The boost from the axes of something that moves with `rapidity` along `direction`, of any length, to the axes of the
 * frame in which it moves.
 * @param {number} rapidity @param {Readonly<Vec3>} direction
 */
export function boost(rapidity, direction) {
    const size = length(direction);
    if (rapidity === 0 || !(size > 0)) {
        return identity();
    }
    // Exactly along the direction as it is given.
    const factor = scalar(Math.sinh(0.5 * rapidity) / size, 0);
    const heading = zero();
    heading.set([0, 0, direction[0], 0, direction[1], 0, direction[2]]);
    const spinor = multiply(factor, heading);
    // cosh^2 = 1 + sinh^2
    const square = multiply(spinor, spinor);
    const sum = new Sum(square[0], square[PARTS]);
    sum.add(1);
    const root = Math.sqrt(sum.value);
    sum.addProduct(-root, root);
    spinor[0] = root;
    spinor[PARTS] = sum.value / (2 * root);
    return spinor;
}

/** @param {Readonly<Quaternion>} quaternion */
export function rotation(quaternion) {
    const [x, y, z, w] = normalized(quaternion);
    return spinorOf(
        [w, 0],
        [
            [0, 0, 0],
            [-x, -y, -z],
        ],
    );
}

/**
 * The space part of the four-velocity with which the frame moves in the frame that the transformation leads to, in the
 * axes of the latter.
 * @param {Spinor} spinor @returns {Vec3}
 */
export function celerity(spinor) {
    const velocity = multiply(spinor, adjoint(spinor));
    return [velocity[2], velocity[4], velocity[6]];
}

/**
 * The same in the axes of the frame that moves.
 * @param {Spinor} spinor @returns {Vec3}
 */
export function celerityOwn(spinor) {
    const velocity = multiply(adjoint(spinor), spinor);
    return [velocity[2], velocity[4], velocity[6]];
}

/** @typedef {{ rapidity: number, direction: Vec3, gamma: number, beta: number }} Velocity */

/**
 * The velocity whose four-velocity has this space part; `otherwise` is the direction of rest.
 * @param {Readonly<Vec3>} celerity @param {Readonly<Vec3>} otherwise @returns {Velocity}
 */
export function velocityOfCelerity(celerity, otherwise) {
    const size = length(celerity);
    const rapidity = Math.asinh(size);
    return { rapidity, direction: unit(celerity, otherwise), gamma: Math.hypot(1, size), beta: Math.tanh(rapidity) };
}

/**
 * The rotation before the boost: the transformation is the boost to its velocity after this rotation.
 * @param {Spinor} spinor @returns {Quaternion}
 */
export function rotationOf(spinor) {
    return normalized([-spinor[3], -spinor[5], -spinor[7], spinor[0]]);
}

/**
 * A four-vector in the frame to which the transformation leads.
 * @param {Spinor} spinor @param {ExactEvent} event @returns {number[]} an {@link ExactEvent}
 */
export function transform(spinor, event) {
    const [t, x, y, z, tLow, xLow, yLow, zLow] = event;
    const matrix = zero();
    matrix.set([t, 0, x, 0, y, 0, z, 0, tLow, 0, xLow, 0, yLow, 0, zLow, 0]);
    const moved = multiply(multiply(spinor, matrix), adjoint(spinor));
    return [0, 2, 4, 6, 8, 10, 12, 14].map((part) => moved[part]);
}

/** An event without a rest. @param {number} time @param {Readonly<Vec3>} place @returns {number[]} an {@link ExactEvent} */
export function eventOf(time, place) {
    return [time, ...place, 0, 0, 0, 0];
}

/** @param {ExactEvent} a @param {ExactEvent} b @returns {number[]} an {@link ExactEvent} */
export function sumOfEvents(a, b) {
    const parts = [0, 1, 2, 3].map((part) => {
        const sum = new Sum(a[part], a[part + 4] + b[part + 4]);
        sum.add(b[part]);
        return sum;
    });
    return [...parts.map((sum) => sum.value), ...parts.map((sum) => sum.rest)];
}

/** The frame's axes x, y, z as four-vectors `[t, x, y, z]`. @param {Spinor} spinor */
export function axes(spinor) {
    /** @type {Vec3[]} */
    const units = [
        [1, 0, 0],
        [0, 1, 0],
        [0, 0, 1],
    ];
    return units.map((axis) => transform(spinor, eventOf(0, axis)).slice(0, 4));
}
