/** Round shapes in f64: a point between the vertices of a facet is moved onto the true surface, as `round.glsl` does. */

import { rotate } from "../spacetime/quaternion.js";

/** @typedef {import("../spacetime/vector.js").Vec3} Vec3 */

/**
 * A sphere, a torus or a surface of revolution, whose axis is y before it is scaled and turned.
 * @typedef {object} Round
 * @property {"ROUND_SPHERE" | "ROUND_TORUS" | "ROUND_LATHE"} kind
 * @property {number[]} radii The radius of a sphere; the major and the minor radius of a torus.
 * @property {Vec3} origin The origin of the shape in the coordinates of the mesh.
 * @property {number[]} fromShape The matrix from the shape's coordinates to those of the mesh, row by row.
 * @property {number[]} toShape The matrix back.
 */

/**
 * @param {NonNullable<import("../data.js").PageObject["shape"]>} shape
 * @param {import("../data.js").PageObject} object
 * @param {Vec3} origin
 * @returns {Round}
 */
export function roundOf(shape, object, origin) {
    const { rotation, scale } = object;
    const columns = [0, 1, 2].map((axis) => rotate(rotation, unit(axis, scale[axis])));
    const rows = [0, 1, 2].map((axis) => rotate(rotation, unit(axis, 1 / scale[axis])));
    const common = {
        origin,
        fromShape: [0, 1, 2].flatMap((row) => columns.map((column) => column[row])),
        toShape: rows.flat(),
    };
    if ("sphere" in shape) {
        const { radius } = shape.sphere;
        return { ...common, kind: "ROUND_SPHERE", radii: [radius, 0] };
    }
    if ("torus" in shape) {
        const { major_radius: major, minor_radius: minor } = shape.torus;
        return {
            ...common,
            kind: "ROUND_TORUS",
            radii: [major, minor],
        };
    }
    return { ...common, kind: "ROUND_LATHE", radii: [0, 0] };
}

/**
 * @param {number} axis
 * @param {number} length
 * @returns {Vec3}
 */
function unit(axis, length) {
    return [axis === 0 ? length : 0, axis === 1 ? length : 0, axis === 2 ? length : 0];
}

/** The middle of an edge in the shape's own coordinates, flat and moved onto the surface. */
const FLAT = new Float64Array(4);
const MOVED = new Float64Array(3);

/**
 * Writes the vector from the middle of an edge to the surface, in the coordinates of the mesh, to `sag` at `s`. The ends are
 * in `places` at `a` and `b`, each by three coordinates of the shape and the distance from its axis.
 * @param {Round} round
 * @param {Float64Array} places
 * @param {number} a
 * @param {number} b
 * @param {Float64Array} sag
 * @param {number} s
 */
export function sagAt(round, places, a, b, sag, s) {
    for (let k = 0; k < 4; k += 1) {
        FLAT[k] = (places[a + k] + places[b + k]) / 2;
    }
    const [x, y, z] = FLAT;
    const fromAxis = Math.max(Math.sqrt(x * x + z * z), 1e-300);
    if (round.kind === "ROUND_SPHERE") {
        const factor = round.radii[0] / Math.max(Math.sqrt(x * x + y * y + z * z), 1e-300);
        MOVED[0] = x * factor;
        MOVED[1] = y * factor;
        MOVED[2] = z * factor;
    } else if (round.kind === "ROUND_TORUS") {
        const ring = round.radii[0] / fromAxis;
        const tubeX = x - x * ring;
        const tubeZ = z - z * ring;
        const factor = round.radii[1] / Math.max(Math.sqrt(tubeX * tubeX + y * y + tubeZ * tubeZ), 1e-300);
        MOVED[0] = x * ring + tubeX * factor;
        MOVED[1] = y * factor;
        MOVED[2] = z * ring + tubeZ * factor;
    } else {
        const factor = FLAT[3] / fromAxis;
        MOVED[0] = x * factor;
        MOVED[1] = y;
        MOVED[2] = z * factor;
    }
    const { fromShape } = round;
    for (let row = 0; row < 3; row += 1) {
        sag[s + row] =
            fromShape[3 * row] * (MOVED[0] - x) +
            fromShape[3 * row + 1] * (MOVED[1] - y) +
            fromShape[3 * row + 2] * (MOVED[2] - z);
    }
}

/**
 * Writes a vertex of the mesh in the shape's own coordinates, and its distance from the axis, to `places` at `at`.
 * @param {Round} round
 * @param {number} x
 * @param {number} y
 * @param {number} z
 * @param {Float64Array} places
 * @param {number} at
 */
export function ownPlace(round, x, y, z, places, at) {
    const { toShape, origin } = round;
    const [dx, dy, dz] = [x - origin[0], y - origin[1], z - origin[2]];
    for (let row = 0; row < 3; row += 1) {
        places[at + row] = toShape[3 * row] * dx + toShape[3 * row + 1] * dy + toShape[3 * row + 2] * dz;
    }
    places[at + 3] = Math.hypot(places[at], places[at + 2]);
}
