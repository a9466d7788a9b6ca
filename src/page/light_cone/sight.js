/** Where points of one object are seen, in f64: what the shader computes, for the choice of triangles and for labels. */

/** @typedef {import("../spacetime/vector.js").Vec3} Vec3 */

/** Numbers of one point: offset from the eye at rest (3), its length, where it is seen (3), and how far that is. */
export const POINT_NUMBERS = 8;

/**
 * How an eye sees the points of one object, in the axes of the object's rest frame boosted by the eye's motion.
 * @typedef {object} Sight
 * @property {Vec3} place The place of the origin of the mesh relative to the eye, in the rest frame.
 * @property {Vec3} motion Unit vector of the eye's motion in the rest frame.
 * @property {number} rapidity
 * @property {number} gamma
 * @property {number} momentum The Lorentz factor times the speed.
 * @property {number} bend How strongly straight edges are bent: the momentum where light takes time, else 0.
 * @property {number} grow exp(rapidity).
 * @property {number} shrink exp(-rapidity).
 * @property {number} elongation How many times as long along the motion the object is reckoned: the Lorentz factor under the model "delayed", else 1.
 * @property {boolean} delayed Whether light takes time: not under the models "contracted" and "rest".
 * @property {number} lengthening How many times as long small lengths along the motion are seen at once: gamma, or the contraction.
 * @property {number} contraction How many times as long the object is along its motion where light takes no time.
 */

/**
 * @param {Vec3} place
 * @param {Vec3} motion
 * @param {number} rapidity
 * @param {"seen" | "delayed" | "contracted" | "rest"} model
 * @returns {Sight}
 */
export function sightOf(place, motion, rapidity, model) {
    const gamma = Math.cosh(rapidity);
    const delayed = model === "seen" || model === "delayed";
    return {
        place,
        motion,
        rapidity,
        gamma,
        momentum: Math.sinh(rapidity),
        grow: Math.exp(rapidity),
        shrink: Math.exp(-rapidity),
        elongation: model === "delayed" ? gamma : 1,
        bend: delayed ? Math.sinh(rapidity) : 0,
        delayed,
        lengthening: delayed ? gamma : model === "contracted" ? 1 / gamma : 1,
        contraction: model === "contracted" ? 1 / gamma : 1,
    };
}

/**
 * Writes the numbers of the point at `x, y, z` of the mesh to `points`, from number `at` on.
 * @param {Sight} sight
 * @param {number} x
 * @param {number} y
 * @param {number} z
 * @param {Float64Array} points
 * @param {number} at
 */
export function seePoint(sight, x, y, z, points, at) {
    const nx = sight.motion[0];
    const ny = sight.motion[1];
    const nz = sight.motion[2];
    let dx = x + sight.place[0];
    let dy = y + sight.place[1];
    let dz = z + sight.place[2];
    let along = dx * nx + dy * ny + dz * nz;
    const longer = (sight.elongation - 1) * along;
    dx += longer * nx;
    dy += longer * ny;
    dz += longer * nz;
    along += longer;
    const acrossX = dx - along * nx;
    const acrossY = dy - along * ny;
    const acrossZ = dz - along * nz;
    const across2 = acrossX * acrossX + acrossY * acrossY + acrossZ * acrossZ;
    const r = Math.sqrt(along * along + across2);
    let seenAlong = along * sight.contraction;
    let distance = r;
    if (sight.delayed) {
        const large = r + Math.abs(along);
        const small = large > 0 ? across2 / large : 0;
        const forward = sight.grow * (along > 0 ? large : small);
        const backward = sight.shrink * (along > 0 ? small : large);
        seenAlong = (forward - backward) / 2;
        distance = (forward + backward) / 2;
    }
    points[at] = dx;
    points[at + 1] = dy;
    points[at + 2] = dz;
    points[at + 3] = r;
    points[at + 4] = acrossX + seenAlong * nx;
    points[at + 5] = acrossY + seenAlong * ny;
    points[at + 6] = acrossZ + seenAlong * nz;
    points[at + 7] = distance;
}
