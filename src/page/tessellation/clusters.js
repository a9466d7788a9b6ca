/** Triangles of a mesh in groups of neighbours, so that one look tells of a whole group that none of it needs pieces. */

const TRIANGLES = 64;

/** Numbers that are kept of each cluster: its middle, its radius, the square of its longest edge. */
export const CLUSTER_NUMBERS = 5;

/**
 * Triangles in groups of neighbours.
 * @typedef {object} Clusters
 * @property {Uint32Array} index Three vertices of each triangle, those of a cluster one after the other.
 * @property {Uint32Array} starts The first triangle of each cluster, and the number of triangles.
 * @property {Float64Array} bounds `CLUSTER_NUMBERS` of each cluster.
 */

/**
 * Spreads the lowest ten bits so that two others fit between each two.
 * @param {number} value
 */
function spread(value) {
    let bits = value & 0x3ff;
    bits = (bits | (bits << 16)) & 0x030000ff;
    bits = (bits | (bits << 8)) & 0x0300f00f;
    bits = (bits | (bits << 4)) & 0x030c30c3;
    return (bits | (bits << 2)) & 0x09249249;
}

/**
 * The numbers from 0 up to `keys.length`, by rising keys below 2^30; equal keys keep their order.
 * @param {Uint32Array} keys
 */
function orderOf(keys) {
    const BITS = 10;
    let order = Uint32Array.from(keys, (_, number) => number);
    let next = new Uint32Array(keys.length);
    for (let shift = 0; shift < 30; shift += BITS) {
        const places = new Uint32Array((1 << BITS) + 1);
        for (const key of keys) {
            places[((key >>> shift) & 0x3ff) + 1] += 1;
        }
        for (let bucket = 1; bucket < places.length; bucket += 1) {
            places[bucket] += places[bucket - 1];
        }
        for (const number of order) {
            next[places[(keys[number] >>> shift) & 0x3ff]++] = number;
        }
        [order, next] = [next, order];
    }
    return order;
}

/**
 * Puts triangles into clusters: those of the same object in the order of a curve that fills its box.
 * @param {Float32Array} positions Three coordinates of each vertex.
 * @param {Uint32Array} index Three vertices of each triangle.
 * @param {boolean} keepOrder Whether the order of the triangles must stay, since one is seen through another.
 * @returns {Clusters}
 */
export function clustersOf(positions, index, keepOrder) {
    const triangles = index.length / 3;
    const sorted = keepOrder ? index.slice() : alongCurve(positions, index);
    const count = Math.ceil(triangles / TRIANGLES);
    const starts = Uint32Array.from({ length: count + 1 }, (_, cluster) => Math.min(cluster * TRIANGLES, triangles));
    const bounds = new Float64Array(count * CLUSTER_NUMBERS);
    for (let cluster = 0; cluster < count; cluster += 1) {
        const part = sorted.subarray(3 * starts[cluster], 3 * starts[cluster + 1]);
        bounds.set(boundsOf(positions, part), cluster * CLUSTER_NUMBERS);
    }
    return { index: sorted, starts, bounds };
}

/**
 * @param {Float32Array} positions
 * @param {Uint32Array} index
 */
function alongCurve(positions, index) {
    const [low, high] = boxOf(positions, index);
    const cell = low.map((least, axis) => 1023 / Math.max(high[axis] - least, 1e-30));
    const keys = new Uint32Array(index.length / 3);
    for (let triangle = 0; triangle < keys.length; triangle += 1) {
        for (let axis = 0; axis < 3; axis += 1) {
            let sum = 0;
            for (let corner = 0; corner < 3; corner += 1) {
                sum += positions[3 * index[3 * triangle + corner] + axis];
            }
            keys[triangle] |= spread((sum / 3 - low[axis]) * cell[axis]) << axis;
        }
    }
    const sorted = new Uint32Array(index.length);
    orderOf(keys).forEach((triangle, place) => {
        sorted[3 * place] = index[3 * triangle];
        sorted[3 * place + 1] = index[3 * triangle + 1];
        sorted[3 * place + 2] = index[3 * triangle + 2];
    });
    return sorted;
}

/**
 * The least and the largest coordinates of the vertices of these triangles.
 * @param {Float32Array} positions
 * @param {Uint32Array} index
 */
function boxOf(positions, index) {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (const vertex of index) {
        for (let axis = 0; axis < 3; axis += 1) {
            const value = positions[3 * vertex + axis];
            low[axis] = Math.min(low[axis], value);
            high[axis] = Math.max(high[axis], value);
        }
    }
    return [low, high];
}

/**
 * @param {Float32Array} positions
 * @param {Uint32Array} part
 */
function boundsOf(positions, part) {
    const [low, high] = boxOf(positions, part);
    const middle = low.map((least, axis) => (least + high[axis]) / 2);
    let radius2 = 0;
    let edge2 = 0;
    for (let k = 0; k < part.length; k += 1) {
        const next = k % 3 === 2 ? k - 2 : k + 1;
        let fromMiddle2 = 0;
        let length2 = 0;
        for (let axis = 0; axis < 3; axis += 1) {
            const value = positions[3 * part[k] + axis];
            fromMiddle2 += (value - middle[axis]) ** 2;
            length2 += (value - positions[3 * part[next] + axis]) ** 2;
        }
        radius2 = Math.max(radius2, fromMiddle2);
        edge2 = Math.max(edge2, length2);
    }
    return [...middle, Math.sqrt(radius2), edge2];
}
