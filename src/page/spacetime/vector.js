/** @typedef {[number, number, number]} Vec3 */
/** @param {Vec3} a @param {Vec3} b */
export function dot(a, b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
/** @param {Vec3} a @param {Vec3} b @returns {Vec3} */
export function sum(a, b) { return [a[0] + b[0], a[1] + b[1], a[2] + b[2]]; }
/** @param {Vec3} a @param {number} k @returns {Vec3} */
export function scaled(a, k) { return [a[0] * k, a[1] * k, a[2] * k]; }
/** @param {Vec3} a @param {Vec3} b @returns {Vec3} */
export function cross(a, b) { return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]; }
