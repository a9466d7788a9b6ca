/**
 * How often an edge has to be halved, by its two ends alone, so that neighbours agree.
 *
 * A straight edge between two points is drawn straight, but is seen curved: in the middle by the vector
 * `gamma beta e n`, `e = (r_a + r_b) / 2 - |d_a + d_b| / 2` (design of the certificate, `src/tessellate/gap.rs`). Half the
 * edge is a quarter as far off.
 */

/**
 * What a picture asks for.
 * @typedef {object} Sharpness
 * @property {number} observer The angle in radians that may be off in the observer's view; infinite where it is not drawn.
 * @property {number} outside The angle in radians that may be off in the view from outside; infinite where it is not drawn.
 * @property {import("../spacetime/vector.js").Vec3} camera The place of that view's camera, in the axes of the sight.
 * @property {number} nearest No place nearer than this is seen more sharply, in units of the scene.
 * @property {number} [shortest] No edge shorter than this is halved before it is a leaf's, in units of the scene.
 */

/** Halvings that the pattern of a leaf has room for; an edge that needs more is halved first. */
export const LEAF_HALVINGS = 2;

/** The part of the angle that counts where an error points at the eye, which does not see it: bounds the second order. */
const LEAST_ACROSS = 0.15;

/**
 * Cosine of the angle that an edge may be seen under where it is bent. A triangle around the foot of the eye on a wall has a
 * longer one, however far its edges are: so triangles get small beside the eye, and the wall stays on its side.
 */
const WIDEST = 0.4;

/**
 * How often the edge between two points has to be halved, at most one more than `LEAF_HALVINGS`.
 * @param {import("../light_cone/sight.js").Sight} sight
 * @param {Sharpness} sharpness
 * @param {Float64Array} points
 * @param {number} a The place of the first point's numbers in `points`.
 * @param {number} b
 */
export function halvings(sight, sharpness, points, a, b) {
    const ra = points[a + 3];
    const rb = points[b + 3];
    const dot = points[a] * points[b] + points[a + 1] * points[b + 1] + points[a + 2] * points[b + 2];
    const middle = Math.sqrt(Math.max(ra * ra + rb * rb + 2 * dot, 0));
    const gap = (sight.bend * Math.max(ra * rb - dot, 0)) / (ra + rb + middle);
    if (dot < WIDEST * ra * rb && gap > sharpness.observer * sharpness.nearest) {
        return unlessShort(LEAF_HALVINGS + 1, sharpness, points, a, b);
    }
    return unlessShort(halvingsFor(tooFar(sharpness, points, a, b, gap, sight.motion)), sharpness, points, a, b);
}

/** The direction in which an edge of a round shape is off. */
const TOWARD = [0, 0, 0];

/**
 * The same for an edge of a round shape, whose middle at rest is off the surface by the vector `sag` at `s`.
 * @param {import("../light_cone/sight.js").Sight} sight
 * @param {Sharpness} sharpness
 * @param {Float64Array} points
 * @param {number} a
 * @param {number} b
 * @param {Float64Array} sag
 * @param {number} s
 */
export function roundHalvings(sight, sharpness, points, a, b, sag, s) {
    const ra = points[a + 3];
    const rb = points[b + 3];
    const x = points[a] + points[b];
    const y = points[a + 1] + points[b + 1];
    const z = points[a + 2] + points[b + 2];
    const twice = Math.sqrt(x * x + y * y + z * z);
    const dot = points[a] * points[b] + points[a + 1] * points[b + 1] + points[a + 2] * points[b + 2];
    const bent = (sight.bend * Math.max(ra * rb - dot, 0)) / (ra + rb + twice);
    const motion = sight.motion;
    const alongMotion = sag[s] * motion[0] + sag[s + 1] * motion[1] + sag[s + 2] * motion[2];
    // The map takes a small vector v to v + n (a . v), with a the slope of the place along the motion.
    const alongSight = twice > 0 ? (sag[s] * x + sag[s + 1] * y + sag[s + 2] * z) / twice : 0;
    const more = (sight.lengthening - 1) * alongMotion + sight.bend * alongSight - bent;
    const offX = sag[s] + motion[0] * more;
    const offY = sag[s + 1] + motion[1] * more;
    const offZ = sag[s + 2] + motion[2] * more;
    const gap = Math.sqrt(offX * offX + offY * offY + offZ * offZ);
    const unit = gap > 0 ? 1 / gap : 0;
    TOWARD[0] = offX * unit;
    TOWARD[1] = offY * unit;
    TOWARD[2] = offZ * unit;
    return unlessShort(halvingsFor(tooFar(sharpness, points, a, b, gap, TOWARD)), sharpness, points, a, b);
}

/**
 * An edge too short to be halved further stays that of a leaf: a limit of the edge alone, on which both of its sides agree.
 * @param {number} halvings
 * @param {Sharpness} sharpness
 * @param {Float64Array} points
 * @param {number} a
 * @param {number} b
 */
function unlessShort(halvings, sharpness, points, a, b) {
    if (halvings <= LEAF_HALVINGS) {
        return halvings;
    }
    const x = points[a] - points[b];
    const y = points[a + 1] - points[b + 1];
    const z = points[a + 2] - points[b + 2];
    const shortest = sharpness.shortest ?? 0;
    return x * x + y * y + z * z < shortest * shortest ? LEAF_HALVINGS : halvings;
}

/** @param {number} ratio2 The square of how many times as far off as it may be it is: a quarter as far for each halving. */
function halvingsFor(ratio2) {
    if (!(ratio2 > 1)) {
        return 0;
    }
    return ratio2 > 256 ? 3 : ratio2 > 16 ? 2 : 1;
}

/**
 * How many times as far off as it may be the middle of an edge is, squared, if it is off by `gap` in the unit direction `toward`.
 * @param {Sharpness} sharpness
 * @param {Float64Array} points
 * @param {number} a
 * @param {number} b
 * @param {number} gap
 * @param {number[]} toward
 */
function tooFar(sharpness, points, a, b, gap, toward) {
    const x = (points[a + 4] + points[b + 4]) / 2;
    const y = (points[a + 5] + points[b + 5]) / 2;
    const z = (points[a + 6] + points[b + 6]) / 2;
    let ratio2 = 0;
    if (sharpness.observer < Infinity) {
        const distance2 = Math.max(x * x + y * y + z * z, sharpness.nearest ** 2);
        const along = x * toward[0] + y * toward[1] + z * toward[2];
        const across2 = Math.max(1 - (along * along) / distance2, LEAST_ACROSS);
        ratio2 = (gap * gap * across2) / (sharpness.observer * sharpness.observer * distance2);
    }
    if (sharpness.outside < Infinity) {
        const cx = sharpness.camera[0];
        const cy = sharpness.camera[1];
        const cz = sharpness.camera[2];
        const distance2 = (x - cx) ** 2 + (y - cy) ** 2 + (z - cz) ** 2;
        const nearA2 = (points[a + 4] - cx) ** 2 + (points[a + 5] - cy) ** 2 + (points[a + 6] - cz) ** 2;
        const nearB2 = (points[b + 4] - cx) ** 2 + (points[b + 5] - cy) ** 2 + (points[b + 6] - cz) ** 2;
        const nearest2 = Math.max(Math.min(distance2, nearA2, nearB2), sharpness.nearest ** 2);
        ratio2 = Math.max(ratio2, (gap * gap) / (sharpness.outside * sharpness.outside * nearest2));
    }
    return ratio2;
}
