import { cross, dot } from "./vector.js";
/** @param {number[]} q */
export function conjugate(q) { return [-q[0], -q[1], -q[2], q[3]]; }
/** @param {number[]} q @param {import("./vector.js").Vec3} v */
export function rotate(q, v) {
    const u = [q[0], q[1], q[2]];
    const t = cross(u, v).map((x) => 2 * x);
    const c = cross(u, t);
    return [v[0] + q[3] * t[0] + c[0], v[1] + q[3] * t[1] + c[1], v[2] + q[3] * t[2] + c[2]];
}
