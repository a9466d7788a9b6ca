/**
 * The triangles of one mesh, as fine as the place and the speed of the moment call for.
 *
 * A triangle whose three edges look straight is drawn as it is. Of any other the edges that need it are halved, and the
 * triangle with them, until each part has edges that a pattern of at most `2^LEAF_HALVINGS` pieces a side can do; these
 * parts are the leaves, whose vertices the graphics processor finds. An edge is halved by a rule of its own two ends, so that
 * neighbours agree and no crack opens.
 */

import { POINT_NUMBERS, seePoint, sightOf } from "../light_cone/sight.js";
import { ownPlace, sagAt } from "../shape/round.js";
import { CLUSTER_NUMBERS } from "./clusters.js";
import { halvings, LEAF_HALVINGS, roundHalvings } from "./edge_rule.js";
import { Leaves } from "./leaves.js";

/** @typedef {import("../light_cone/sight.js").Sight} Sight */
/** @typedef {import("./edge_rule.js").Sharpness} Sharpness */

/** In the pool, after the numbers of a point: its place on the facet, weights, and of round shapes the place of the shape. */
const PLACE = POINT_NUMBERS;
const WEIGHTS = PLACE + 3;
const OWN = WEIGHTS + 2;
const POOL_NUMBERS = OWN + 4;

/** An edge of this part of the longest edge of the mesh is not halved further: weights are exact in `f32` until then. */
const SHORTEST = 2 ** -16;

/** Parts of parts, at most: more than edges of that length need. */
const DEEPEST = 40;

/** A range of numbers that changed: the first, and how many. */
/** @typedef {[number, number]} Range */

export class Tessellation {
    /** The triangles that are drawn as they are; of all others the three vertices are the same. */
    drawn;
    /** @type {Range[]} What changed in `drawn` since the last update. */
    changed = [];
    /** Leaves by the most halvings that one of their edges needs. */
    leaves = Array.from({ length: LEAF_HALVINGS + 1 }, () => new Leaves());

    #positions;
    #clusters;
    #round;
    #points;
    #places;
    #stamps;
    #stamp = 0;
    /** How many triangles of each cluster are in pieces. */
    #inPieces;
    #pool = new Float64Array(4 * (DEEPEST + 2) * POOL_NUMBERS);
    #top = 0;
    /** Of round shapes, how far the middles of the edges of each triangle are off the surface at rest: three vectors. */
    #sags;
    #sag = new Float64Array(3);
    /** The largest length of these vectors in each cluster. */
    #sagBounds;
    /** The length of the longest edge. */
    #longest = 0;
    #sorted = new Uint32Array(3);
    #room = 0;
    /** @type {Sight} */
    #sight = sightOf([0, 0, 0], [0, 0, 1], 0, "rest");
    /** @type {Sharpness} */
    #sharpness = { observer: Infinity, outside: Infinity, camera: [0, 0, 0], nearest: 0 };

    /**
     * @param {Float32Array} positions Three coordinates of each vertex.
     * @param {import("./clusters.js").Clusters} clusters
     * @param {import("../shape/round.js").Round | null} round The surface that the mesh stands for, if it is curved.
     */
    constructor(positions, clusters, round) {
        const vertices = positions.length / 3;
        this.drawn = clusters.index.slice();
        this.#positions = positions;
        this.#clusters = clusters;
        this.#round = round;
        this.#points = new Float64Array(vertices * POINT_NUMBERS);
        this.#stamps = new Uint32Array(vertices);
        for (let at = CLUSTER_NUMBERS - 1; at < clusters.bounds.length; at += CLUSTER_NUMBERS) {
            this.#longest = Math.max(this.#longest, Math.sqrt(clusters.bounds[at]));
        }
        this.#inPieces = new Uint8Array(clusters.starts.length - 1);
        this.#places = new Float64Array(round ? vertices * 4 : 0);
        if (round) {
            for (let vertex = 0; vertex < vertices; vertex += 1) {
                const [x, y, z] = positions.subarray(3 * vertex, 3 * vertex + 3);
                ownPlace(round, x, y, z, this.#places, 4 * vertex);
            }
        }
        this.#sags = new Float64Array(round ? 3 * clusters.index.length : 0);
        this.#sagBounds = new Float64Array(clusters.starts.length - 1);
        if (round) {
            clusters.index.forEach((vertex, at) => {
                const next = clusters.index[at % 3 === 2 ? at - 2 : at + 1];
                sagAt(round, this.#places, 4 * vertex, 4 * next, this.#sags, 3 * at);
            });
            for (let cluster = 0; cluster < this.#sagBounds.length; cluster += 1) {
                let largest2 = 0;
                for (let at = 9 * clusters.starts[cluster]; at < 9 * clusters.starts[cluster + 1]; at += 3) {
                    largest2 = Math.max(
                        largest2,
                        this.#sags[at] ** 2 + this.#sags[at + 1] ** 2 + this.#sags[at + 2] ** 2,
                    );
                }
                this.#sagBounds[cluster] = Math.sqrt(largest2);
            }
        }
    }

    /**
     * Chooses the pieces for a sight, and returns the number of leaves.
     * @param {Sight} sight
     * @param {Sharpness} sharpness
     * @param {number} room The largest number of leaves; where it is reached, triangles stay coarse.
     */
    update(sight, sharpness, room) {
        this.#sight = sight;
        this.#sharpness = { ...sharpness, shortest: this.#longest * SHORTEST };
        this.#stamp += 1;
        this.#room = room;
        this.changed.length = 0;
        for (const leaves of this.leaves) {
            leaves.clear();
        }
        const clusters = this.#clusters.starts.length - 1;
        for (let cluster = 0; cluster < clusters; cluster += 1) {
            if (!this.#isFine(cluster)) {
                this.#split(cluster);
            } else if (this.#inPieces[cluster] > 0) {
                this.#makeWhole(cluster);
            }
        }
        return room - this.#room;
    }

    /**
     * Whether no edge of a cluster needs to be halved: from bounds, without a look at the edges.
     * @param {number} cluster
     */
    #isFine(cluster) {
        const { bounds } = this.#clusters;
        const at = cluster * CLUSTER_NUMBERS;
        const sight = this.#sight;
        const pool = this.#pool;
        seePoint(sight, bounds[at], bounds[at + 1], bounds[at + 2], pool, 0);
        const radius = bounds[at + 3] * sight.elongation;
        const edge2 = bounds[at + 4] * sight.elongation ** 2;
        const r = pool[3];
        const forward =
            r > 0 ? (pool[0] * sight.motion[0] + pool[1] * sight.motion[1] + pool[2] * sight.motion[2]) / r : 0;
        const sag = this.#sagBounds[cluster] * sight.elongation;
        // How far the map reaches: I + n a, with a the slope of the place along the motion.
        const slope = sight.delayed
            ? Math.sqrt((sight.gamma - 1) ** 2 + sight.momentum ** 2 + 2 * (sight.gamma - 1) * sight.momentum * forward)
            : 0;
        const nearest = r - radius;
        let gap = 0;
        if (sight.bend > 0 || sag > 0) {
            if (!(nearest > 0)) {
                return false;
            }
            gap = ((edge2 / 8) * sight.bend) / nearest + sag * (1 + slope);
        }
        const { observer, outside, camera, nearest: closest } = this.#sharpness;
        if (observer < Infinity) {
            // The distance at which a place is seen is a convex function of the place: no less than its tangent.
            const gradient = sight.delayed
                ? Math.sqrt(sight.gamma ** 2 + sight.momentum ** 2 + 2 * sight.gamma * sight.momentum * forward)
                : 1;
            if (gap > observer * Math.max(pool[7] - gradient * radius, closest)) {
                return false;
            }
        }
        if (outside < Infinity) {
            const distance = Math.hypot(pool[4] - camera[0], pool[5] - camera[1], pool[6] - camera[2]);
            if (gap > outside * Math.max(distance - (1 + slope) * radius, closest)) {
                return false;
            }
        }
        return true;
    }

    /** @param {number} cluster */
    #makeWhole(cluster) {
        const { starts, index } = this.#clusters;
        const [first, end] = [3 * starts[cluster], 3 * starts[cluster + 1]];
        this.drawn.set(index.subarray(first, end), first);
        this.changed.push([first, end - first]);
        this.#inPieces[cluster] = 0;
    }

    /**
     * Looks at every triangle of a cluster.
     * @param {number} cluster
     */
    #split(cluster) {
        const { starts, index } = this.#clusters;
        const drawn = this.drawn;
        let isChanged = false;
        let inPieces = 0;
        for (let at = 3 * starts[cluster]; at < 3 * starts[cluster + 1]; at += 3) {
            const halved = this.#splitTriangle(at);
            if (halved) {
                inPieces += 1;
            }
            if (halved !== (drawn[at] === drawn[at + 1])) {
                isChanged = true;
                drawn[at + 1] = halved ? index[at] : index[at + 1];
                drawn[at + 2] = halved ? index[at] : index[at + 2];
            }
        }
        if (isChanged) {
            this.changed.push([3 * starts[cluster], 3 * (starts[cluster + 1] - starts[cluster])]);
        }
        this.#inPieces[cluster] = inPieces;
    }

    /**
     * Makes leaves of a triangle; false if it is drawn as it is.
     * @param {number} at The place of its first vertex in the index.
     */
    #splitTriangle(at) {
        const index = this.#clusters.index;
        const a = index[at];
        const b = index[at + 1];
        const c = index[at + 2];
        this.#seeVertex(a);
        this.#seeVertex(b);
        this.#seeVertex(c);
        const ab = this.#edgeOfMesh(a, b, at);
        const bc = this.#edgeOfMesh(b, c, at + 1);
        const ca = this.#edgeOfMesh(c, a, at + 2);
        if (ab + bc + ca === 0) {
            return false;
        }
        this.#sort(a, b, c);
        this.#top = 0;
        this.#splitPart(this.#corner(a), this.#corner(b), this.#corner(c), ab, bc, ca, 0);
        return true;
    }

    /**
     * Halvings of an edge of the mesh.
     * @param {number} a
     * @param {number} b
     * @param {number} at The number of the edge.
     */
    #edgeOfMesh(a, b, at) {
        const points = this.#points;
        return this.#round
            ? roundHalvings(
                  this.#sight,
                  this.#sharpness,
                  points,
                  POINT_NUMBERS * a,
                  POINT_NUMBERS * b,
                  this.#sags,
                  3 * at,
              )
            : halvings(this.#sight, this.#sharpness, points, POINT_NUMBERS * a, POINT_NUMBERS * b);
    }

    /** @param {number} vertex */
    #seeVertex(vertex) {
        if (this.#stamps[vertex] !== this.#stamp) {
            this.#stamps[vertex] = this.#stamp;
            const positions = this.#positions;
            const at = 3 * vertex;
            seePoint(
                this.#sight,
                positions[at],
                positions[at + 1],
                positions[at + 2],
                this.#points,
                POINT_NUMBERS * vertex,
            );
        }
    }

    /**
     * Puts the vertices of a triangle into the one order that all triangles at an edge have its ends in.
     * @param {number} a
     * @param {number} b
     * @param {number} c
     */
    #sort(a, b, c) {
        const sorted = this.#sorted;
        const isOrdered = this.#isBefore(a, b);
        const low = isOrdered ? a : b;
        const high = isOrdered ? b : a;
        sorted[0] = this.#isBefore(c, low) ? c : low;
        sorted[2] = this.#isBefore(high, c) ? c : high;
        sorted[1] = sorted[0] === c ? low : sorted[2] === c ? high : c;
    }

    /**
     * Whether a vertex comes before another by its coordinates.
     * @param {number} a
     * @param {number} b
     */
    #isBefore(a, b) {
        const positions = this.#positions;
        for (let axis = 0; axis < 3; axis += 1) {
            const p = positions[3 * a + axis];
            const q = positions[3 * b + axis];
            if (p !== q) {
                return p < q;
            }
        }
        return a < b;
    }

    /**
     * Puts a vertex into the pool.
     * @param {number} vertex
     */
    #corner(vertex) {
        const pool = this.#pool;
        const points = this.#points;
        const positions = this.#positions;
        const at = this.#top;
        this.#top += POOL_NUMBERS;
        const from = POINT_NUMBERS * vertex;
        for (let k = 0; k < POINT_NUMBERS; k += 1) {
            pool[at + k] = points[from + k];
        }
        for (let k = 0; k < 3; k += 1) {
            pool[at + PLACE + k] = positions[3 * vertex + k];
        }
        pool[at + WEIGHTS] = vertex === this.#sorted[1] ? 1 : 0;
        pool[at + WEIGHTS + 1] = vertex === this.#sorted[2] ? 1 : 0;
        if (this.#round) {
            for (let k = 0; k < 4; k += 1) {
                pool[at + OWN + k] = this.#places[4 * vertex + k];
            }
        }
        return at;
    }

    /**
     * Puts the point half way between two of the pool, on the surface, into the pool.
     * @param {number} a
     * @param {number} b
     */
    #middle(a, b) {
        const pool = this.#pool;
        const at = this.#top;
        this.#top += POOL_NUMBERS;
        for (let k = PLACE; k < POOL_NUMBERS; k += 1) {
            pool[at + k] = (pool[a + k] + pool[b + k]) / 2;
        }
        let x = pool[at + PLACE];
        let y = pool[at + PLACE + 1];
        let z = pool[at + PLACE + 2];
        if (this.#round) {
            // From the flat facet of the mesh: as the shader does.
            sagAt(this.#round, pool, at + OWN, at + OWN, this.#sag, 0);
            x += this.#sag[0];
            y += this.#sag[1];
            z += this.#sag[2];
        }
        seePoint(this.#sight, x, y, z, pool, at);
        return at;
    }

    /**
     * Halvings of the edge between two points of the pool.
     * @param {number} a
     * @param {number} b
     */
    #edge(a, b) {
        if (!this.#round) {
            return halvings(this.#sight, this.#sharpness, this.#pool, a, b);
        }
        this.#sagBetween(this.#round, a, b);
        return roundHalvings(this.#sight, this.#sharpness, this.#pool, a, b, this.#sag, 0);
    }

    /**
     * How far the middle between two points of the pool is off the surface: both ends and the middle are moved from the facet.
     * @param {import("../shape/round.js").Round} round
     * @param {number} a
     * @param {number} b
     */
    #sagBetween(round, a, b) {
        const sag = this.#sag;
        const pool = this.#pool;
        sagAt(round, pool, a + OWN, a + OWN, sag, 0);
        const [ax, ay, az] = sag;
        sagAt(round, pool, b + OWN, b + OWN, sag, 0);
        const [bx, by, bz] = sag;
        sagAt(round, pool, a + OWN, b + OWN, sag, 0);
        sag[0] -= (ax + bx) / 2;
        sag[1] -= (ay + by) / 2;
        sag[2] -= (az + bz) / 2;
    }

    /**
     * Makes leaves of a part of a triangle, whose edges need so many halvings.
     * @param {number} a
     * @param {number} b
     * @param {number} c
     * @param {number} ab
     * @param {number} bc
     * @param {number} ca
     * @param {number} depth
     */
    #splitPart(a, b, c, ab, bc, ca, depth) {
        const many = LEAF_HALVINGS;
        if ((ab <= many && bc <= many && ca <= many) || depth === DEEPEST || this.#room <= 0) {
            this.#addLeaf(a, b, c, ab, bc, ca);
            return;
        }
        // Turned until the edge from a to b is one that is halved, and that from c to a is not, if one is not.
        if (ab <= many || (ca > many && bc <= many)) {
            this.#splitPart(b, c, a, bc, ca, ab, depth);
            return;
        }
        const top = this.#top;
        const m = this.#middle(a, b);
        const am = this.#edge(a, m);
        const mb = this.#edge(m, b);
        if (bc <= many) {
            const mc = this.#edge(m, c);
            this.#splitPart(a, m, c, am, mc, ca, depth + 1);
            this.#splitPart(m, b, c, mb, bc, mc, depth + 1);
        } else {
            const n = this.#middle(b, c);
            const bn = this.#edge(b, n);
            const nc = this.#edge(n, c);
            const mn = this.#edge(m, n);
            this.#splitPart(m, b, n, mb, bn, mn, depth + 1);
            if (ca <= many) {
                const an = this.#edge(a, n);
                this.#splitPart(a, m, n, am, mn, an, depth + 1);
                this.#splitPart(a, n, c, an, nc, ca, depth + 1);
            } else {
                const o = this.#middle(c, a);
                const co = this.#edge(c, o);
                const oa = this.#edge(o, a);
                const no = this.#edge(n, o);
                const om = this.#edge(o, m);
                this.#splitPart(n, c, o, nc, co, no, depth + 1);
                this.#splitPart(o, a, m, oa, am, om, depth + 1);
                this.#splitPart(m, n, o, mn, no, om, depth + 1);
            }
        }
        this.#top = top;
    }

    /**
     * @param {number} a
     * @param {number} b
     * @param {number} c
     * @param {number} ab
     * @param {number} bc
     * @param {number} ca
     */
    #addLeaf(a, b, c, ab, bc, ca) {
        const pool = this.#pool;
        const sideAB = Math.min(ab, LEAF_HALVINGS);
        const sideBC = Math.min(bc, LEAF_HALVINGS);
        const sideCA = Math.min(ca, LEAF_HALVINGS);
        const leaves = this.leaves[Math.max(sideAB, sideBC, sideCA)];
        const at = leaves.add();
        const numbers = leaves.numbers;
        numbers[at] = this.#sorted[0];
        numbers[at + 1] = this.#sorted[1];
        numbers[at + 2] = this.#sorted[2];
        numbers[at + 3] = sideAB + 4 * sideBC + 16 * sideCA;
        numbers[at + 4] = pool[a + WEIGHTS];
        numbers[at + 5] = pool[a + WEIGHTS + 1];
        numbers[at + 6] = pool[b + WEIGHTS];
        numbers[at + 7] = pool[b + WEIGHTS + 1];
        numbers[at + 8] = pool[c + WEIGHTS];
        numbers[at + 9] = pool[c + WEIGHTS + 1];
        this.#room -= 1;
    }
}
