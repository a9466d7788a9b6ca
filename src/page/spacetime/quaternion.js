/** Rotations as unit quaternions `[x, y, z, w]`, as in the scene file. */

import { cross, length, scaled, sum } from "./vector.js";

/** @typedef {import("./vector.js").Vec3} Vec3 */
/** @typedef {[number, number, number, number]} Quaternion */

/** @type {Readonly<Quaternion>} */
export const IDENTITY = [0, 0, 0, 1];

/**
 * The rotation of `second` and then `first`.
 * @param {Readonly<Quaternion>} first @param {Readonly<Quaternion>} second @returns {Quaternion}
 */
export function multiply([ax, ay, az, aw], [bx, by, bz, bw]) {
    return [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ];
}

/** @param {Readonly<Quaternion>} quaternion @returns {Quaternion} */
export function conjugate([x, y, z, w]) {
    return [-x, -y, -z, w];
}

/**
 * The quaternion of unit length, its scalar not negative: one for each rotation.
 * @param {Readonly<Quaternion>} quaternion @returns {Quaternion}
 */
export function normalized([x, y, z, w]) {
    const size = Math.hypot(x, y, z, w);
    if (!(size > 0 && size < Infinity)) {
        return [...IDENTITY];
    }
    const factor = w < 0 ? -size : size;
    // Adding zero leaves no zero with a sign.
    return [x / factor + 0, y / factor + 0, z / factor + 0, w / factor + 0];
}

/** @param {Readonly<Vec3>} axis of unit length @param {number} angle @returns {Quaternion} */
export function aboutAxis(axis, angle) {
    const [x, y, z] = scaled(axis, Math.sin(0.5 * angle));
    return [x, y, z, Math.cos(0.5 * angle)];
}

/** @param {Readonly<Quaternion>} quaternion @param {Readonly<Vec3>} vector @returns {Vec3} */
export function rotate(quaternion, vector) {
    /** @type {Vec3} */
    const axis = [quaternion[0], quaternion[1], quaternion[2]];
    const turned = scaled(cross(axis, vector), 2);
    return sum(sum(vector, scaled(turned, quaternion[3])), cross(axis, turned));
}

/**
 * The shortest rotation from one unit vector to another.
 * @param {Readonly<Vec3>} from @param {Readonly<Vec3>} to @returns {Quaternion}
 */
export function between(from, to) {
    const middle = sum(from, to);
    const size = length(middle);
    if (size < 1e-12) {
        const across = Math.abs(from[0]) < 0.8 ? cross(from, [1, 0, 0]) : cross(from, [0, 1, 0]);
        const [x, y, z] = scaled(across, 1 / length(across));
        return [x, y, z, 0];
    }
    const half = scaled(middle, 1 / size);
    const [x, y, z] = cross(from, half);
    return [x, y, z, from[0] * half[0] + from[1] * half[1] + from[2] * half[2]];
}
