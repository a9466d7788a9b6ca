/** Where the observer looks: a turn of the head to the left and up, in radians, relative to the observer's own axes. */

import { aboutAxis, multiply, rotate } from "../spacetime/quaternion.js";
import { AHEAD } from "../spacetime/vector.js";

/** @typedef {[number, number]} Look Yaw to the left, and pitch up, in radians. */

/** Farther up or down a head does not turn: beyond, left and right would change places. */
const MOST_PITCH = (89 / 180) * Math.PI;

/**
 * From the axes of the camera to the observer's own.
 * @param {Readonly<Look>} look
 */
export function rotationOfLook([yaw, pitch]) {
    return multiply(aboutAxis([0, 1, 0], yaw), aboutAxis([1, 0, 0], pitch));
}

/**
 * The direction in which the camera looks, in the observer's own axes: a camera that looks there with the own y axis up in
 * its picture is this one.
 * @param {Readonly<Look>} look
 */
export function directionOfLook(look) {
    return look[0] === 0 && look[1] === 0 ? AHEAD : rotate(rotationOfLook(look), AHEAD);
}

/**
 * The turn of the head that looks in a direction of the own axes, of any length; straight up or down it is not turned aside.
 * @param {Readonly<import("../spacetime/vector.js").Vec3>} direction
 * @returns {Look}
 */
export function lookOf([x, y, z]) {
    const aside = Math.hypot(x, z);
    return [aside === 0 ? 0 : 0 - Math.atan2(x, -z), Math.atan2(y, aside)];
}

/**
 * The head turned further.
 * @param {Readonly<Look>} look
 * @param {Readonly<Look>} change
 * @returns {Look}
 */
export function turnedLook([yaw, pitch], [left, up]) {
    const turn = 2 * Math.PI;
    const next = yaw + left;
    return [next - turn * Math.round(next / turn), Math.min(Math.max(pitch + up, -MOST_PITCH), MOST_PITCH)];
}
