/** Whatever the moment: triangles and leaves cover a closed mesh without a crack, and each piece meets its neighbours. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { sightOf } from "../../src/page/light_cone/sight.js";
import { clustersOf } from "../../src/page/tessellation/clusters.js";
import { unit } from "../../src/page/spacetime/vector.js";
import { LEAF_NUMBERS } from "../../src/page/tessellation/leaves.js";
import { Tessellation } from "../../src/page/tessellation/tessellation.js";
import { numbers, vectorFrom } from "./program.mjs";

/** Half the side of the box: all places in it that are reached by halving are exact. */
const HALF = 32;

const MOMENTS = 300;

/** More leaves than any moment needs. */
const LARGEST = 1_000_000;

/** A box with four vertices of its own on each side, as files have it. */
function box() {
    const positions = [];
    const index = [];
    for (let axis = 0; axis < 3; axis++) {
        for (const side of [-HALF, HALF]) {
            const first = positions.length / 3;
            for (const [u, v] of [[-HALF, -HALF], [HALF, -HALF], [HALF, HALF], [-HALF, HALF]]) {
                const corner = [0, 0, 0];
                corner[axis] = side;
                corner[(axis + 1) % 3] = side > 0 ? u : v;
                corner[(axis + 2) % 3] = side > 0 ? v : u;
                positions.push(...corner);
            }
            index.push(first, first + 1, first + 2, first, first + 2, first + 3);
        }
    }
    return { positions: new Float32Array(positions), index: new Uint32Array(index) };
}

/** The corners of a leaf, or of a triangle, as the shader finds them, with the points between them on each edge. */
function outlineOfLeaf(numbers, at, positions) {
    const corners = [0, 1, 2].map((k) => {
        const [second, third] = [numbers[at + 4 + 2 * k], numbers[at + 5 + 2 * k]];
        return [1 - second - third, second, third];
    });
    const place = (weights) =>
        [0, 1, 2].map((axis) => weights.reduce((sum, weight, k) => sum + weight * positions[3 * numbers[at + k] + axis], 0));
    const points = [];
    for (let side = 0; side < 3; side++) {
        const pieces = 2 ** ((numbers[at + 3] >> (2 * side)) & 3);
        for (let piece = 0; piece < pieces; piece++) {
            const part = piece / pieces;
            points.push(place(corners[side].map((weight, k) => weight * (1 - part) + corners[(side + 1) % 3][k] * part)));
        }
    }
    return points;
}

/** How often each directed piece of an edge is the border of something that is drawn. */
function bordersOf(tessellation, positions) {
    const borders = new Map();
    const add = (points) => {
        points.forEach((point, k) => {
            const name = `${point} > ${points[(k + 1) % points.length]}`;
            borders.set(name, (borders.get(name) ?? 0) + 1);
        });
    };
    const { drawn, leaves } = tessellation;
    for (let at = 0; at < drawn.length; at += 3) {
        if (drawn[at] !== drawn[at + 1]) {
            add([0, 1, 2].map((k) => Array.from(positions.subarray(3 * drawn[at + k], 3 * drawn[at + k] + 3))));
        }
    }
    for (const { count, numbers } of leaves) {
        for (let leaf = 0; leaf < count; leaf++) {
            add(outlineOfLeaf(numbers, leaf * LEAF_NUMBERS, positions));
        }
    }
    return borders;
}

test("pieces meet their neighbours at every moment", (t) => {
    const { positions, index } = box();
    const clusters = clustersOf(positions, index, false);
    const tessellation = new Tessellation(positions, clusters, null);
    const next = numbers(5);
    let most = 0;
    for (let moment = 0; moment < MOMENTS; moment++) {
        const place = vectorFrom(next, HALF);
        if (moment % 3 === 0) {
            place[moment % 9 / 3] = HALF - 10 ** (-5 * next());
        }
        const rapidity = Math.acosh(20) * next();
        const sight = sightOf(place, unit(vectorFrom(next), [0, 0, 1]), rapidity, "seen");
        const sharpness = {
            observer: moment % 2 ? 1e-3 : Number.POSITIVE_INFINITY,
            outside: moment % 5 ? 2e-3 : Number.POSITIVE_INFINITY,
            camera: vectorFrom(next, 3 * HALF),
            nearest: 1e-3,
        };
        const leaves = tessellation.update(sight, sharpness, LARGEST);
        assert.ok(leaves < LARGEST, `there is no room at moment ${moment}`);
        most = Math.max(most, leaves);
        const borders = bordersOf(tessellation, positions);
        for (const [name, count] of borders) {
            const back = name.split(" > ").reverse().join(" > ");
            assert.equal(count, 1, `${name} is the border of two on one side at moment ${moment}`);
            assert.ok(borders.has(back), `nothing is beside ${name} at moment ${moment}`);
        }
    }
    assert.ok(most > 1000, `${most} leaves at most`);
    t.diagnostic(`${MOMENTS} moments, at most ${most} leaves`);
});
