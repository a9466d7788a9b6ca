/**
 * Flight with constant acceleration and turn rate in the observer's own axes, by closed forms.
 *
 * With `a` the acceleration, `w` the turn rate and `T` the proper time, `S = w^2 - a^2` and `P = a.w`: the eigenvalues of
 * the motion are `+-alpha` and `+-i omega`, `alpha^2 - omega^2 = -S`, `alpha omega = |P|`. With `A = alpha T`,
 * `B = omega T`, `N = A^2 + B^2` the displacement is a polynomial of degree 3 in the motion:
 *
 *     X = (sinhc A + q T^2 D,  a T C + (w x a) T^2 D + w P T^3 G) T,      q = 2 |a x w|^2 / (a^2 + w^2 + alpha^2 + omega^2)
 *     C = (cosh A - cos B) / N   = 2 (sinh^2(A/2) + sin^2(B/2)) / N
 *     D = (sinhc A - sinc B) / N = ((sinhc A - 1) + (1 - sinc B)) / N
 *     G = (sinhc^2(A/2) - sinc^2(B/2)) / (2 N)
 *
 * The forms on the right are sums of numbers that are not negative. They hold for all four types of flight, linear,
 * rotational, general and null, and lose no digits between them: no type is asked for. The frame turns by
 * `exp(T (a - i w).sigma / 2) = cosh z + T (a - i w).sigma sinhc(z) / 2`, `z = (A -+ i B) / 2`.
 *
 * The four types: J. L. Synge, Time-like helices in flat space-time, Proc. R. Ir. Acad. A 65 (1967), 27.
 */

import { differenceOfProducts } from "./exact.js";
import { coshAboveSinhc, sinc, sincAboveCos, sincBelow1, sinhc, sinhcAbove1 } from "./smooth.js";
import { eventOf, spinorOf } from "./spinor.js";
import { cross, dot, length, scaled, sum } from "./vector.js";

/** @typedef {import("./vector.js").Vec3} Vec3 */
/**
 * A part of a flight, from the observer's frame at its beginning: the displacement, given there, and the frame at its end.
 * @typedef {{ way: import("./spinor.js").ExactEvent, turn: import("./spinor.js").Spinor }} Piece
 */

/** Below this size of `N` all functions have their values at 0 to all digits. */
const LEAST = 1e-100;

/** The rapidity that one piece may gain: its numbers are right relative to where it began. */
const MAX_GAIN = 1.5;

/** Beyond this number of pieces a flight is right to rounding in the scene, not beside fast objects. */
const MAX_PIECES = 1024;

/**
 * In how many pieces a path of so much rapidity is flown.
 * @param {number} rapidity
 */
export function piecesOf(rapidity) {
    const count = Math.ceil(rapidity / MAX_GAIN);
    return count <= MAX_PIECES ? Math.max(count, 1) : 1;
}

/**
 * A bound on the rapidity at any instant relative to the beginning: that of the path, or
 * `cosh(eta) <= exp(A) (1 + 2 q / (alpha^2 + omega^2))`.
 * @param {Rates} rates @param {number} path @param {number} properTime
 */
function maxRapidity({ alpha, omega, excess }, path, properTime) {
    const swing = (2 * excess) / (alpha * alpha + omega * omega);
    const bound = alpha * Math.abs(properTime) + Math.log(2 * (1 + swing));
    // Of the null type the second bound is not a number.
    return Number.isNaN(bound) ? path : Math.min(bound, path);
}

/** @typedef {{ product: number, alpha: number, omega: number, excess: number }} Rates */

/** @param {Readonly<Vec3>} acceleration @param {Readonly<Vec3>} turnRate @returns {Rates} */
function ratesOf(acceleration, turnRate) {
    // With all digits: where both are of one size nearly nothing is left.
    const invariant = differenceOfProducts(turnRate, turnRate, acceleration, acceleration);
    const product = dot(acceleration, turnRate);
    const radius = Math.hypot(invariant, 2 * product);
    const larger = Math.sqrt(0.5 * (radius + Math.abs(invariant)));
    const smaller = larger === 0 ? 0 : Math.abs(product) / larger;
    const across = cross(acceleration, turnRate);
    const sizes = dot(acceleration, acceleration) + dot(turnRate, turnRate) + radius;
    return {
        product,
        alpha: invariant < 0 ? larger : smaller,
        omega: invariant < 0 ? smaller : larger,
        excess: sizes > 0 ? (2 * dot(across, across)) / sizes : 0,
    };
}

/**
 * A segment of constant acceleration and turn rate, in the observer's own axes, in pieces of equal length: that of one.
 * @param {Readonly<Vec3>} acceleration @param {Readonly<Vec3>} turnRate @param {number} properTime
 * @returns {{ count: number, piece: Piece }}
 */
export function segment(acceleration, turnRate, properTime) {
    const rates = ratesOf(acceleration, turnRate);
    const path = length(acceleration) * Math.abs(properTime);
    const count = maxRapidity(rates, path, properTime) <= MAX_GAIN ? 1 : piecesOf(path);
    return { count, piece: pieceOf(rates, acceleration, turnRate, properTime / count) };
}

/**
 * @param {Rates} rates @param {Readonly<Vec3>} acceleration @param {Readonly<Vec3>} turnRate @param {number} t
 * @returns {Piece}
 */
function pieceOf(rates, acceleration, turnRate, t) {
    const { product, alpha, omega, excess } = rates;
    const [boost, turn] = [alpha * t, omega * t];
    const square = boost * boost + turn * turn;
    /** @param {number} number @param {number} atZero */
    const overSquare = (number, atZero) => (square < LEAST ? atZero : number / square);
    const c = overSquare(2 * (Math.sinh(0.5 * boost) ** 2 + Math.sin(0.5 * turn) ** 2), 1 / 2);
    const d = overSquare(sinhcAbove1(boost) + sincBelow1(turn), 1 / 6);
    const halfGap = sinhcAbove1(0.5 * boost) + sincBelow1(0.5 * turn);
    const g = overSquare(0.5 * halfGap * (sinhc(0.5 * boost) + sinc(0.5 * turn)), 1 / 24);
    const ahead = scaled(acceleration, t);
    const aside = scaled(scaled(cross(turnRate, acceleration), t), t);
    const around = scaled(turnRate, product * t * t * t);
    const place = sum(sum(scaled(ahead, c), scaled(aside, d)), scaled(around, g));
    const way = eventOf((sinhc(boost) + excess * t * t * d) * t, scaled(place, t));
    return { way, turn: turnOf(rates, acceleration, turnRate, t) };
}

/**
 * @param {Rates} rates @param {Readonly<Vec3>} acceleration @param {Readonly<Vec3>} turnRate @param {number} t
 */
function turnOf({ product, alpha, omega }, acceleration, turnRate, t) {
    // z = x - i y, y with the sign of the product: z^2 = T^2 (a - i w)^2 / 4.
    const x = 0.5 * alpha * t;
    const y = (product < 0 ? -0.5 : 0.5) * omega * t;
    const square = x * x + y * y;
    let [real, imaginary] = [1, 0];
    if (square >= LEAST) {
        real = (x * x * sinhc(x) * Math.cos(y) + y * y * Math.cosh(x) * sinc(y)) / square;
        imaginary = -((x * y) / square) * (coshAboveSinhc(x) * sinc(y) + sinhc(x) * sincAboveCos(y));
    }
    // (a - i w) (real + i imaginary) T / 2
    const half = 0.5 * t;
    return spinorOf(
        [Math.cosh(x) * Math.cos(y), -Math.sinh(x) * Math.sin(y)],
        [
            scaled(sum(scaled(acceleration, real), scaled(turnRate, imaginary)), half),
            scaled(sum(scaled(acceleration, imaginary), scaled(turnRate, -real)), half),
        ],
    );
}
