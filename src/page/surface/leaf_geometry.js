/** The geometry of leaves: one pattern of equal pieces, drawn once for each leaf. */

import {
    BufferAttribute,
    DynamicDrawUsage,
    InstancedBufferAttribute,
    InstancedBufferGeometry,
    InstancedInterleavedBuffer,
    InterleavedBufferAttribute,
} from "three";

import { LEAF_NUMBERS } from "../tessellation/leaves.js";

/**
 * A triangle in `segments` pieces a side: weights of its second and third corner, and triangles of them.
 * @param {number} segments
 */
function pattern(segments) {
    const weights = [];
    const index = [];
    /** @param {number} row @param {number} column */
    const vertex = (row, column) => row * (segments + 1) - (row * (row - 1)) / 2 + column;
    for (let row = 0; row <= segments; row += 1) {
        for (let column = 0; column <= segments - row; column += 1) {
            weights.push(column / segments, row / segments);
            if (column < segments - row) {
                index.push(vertex(row, column), vertex(row, column + 1), vertex(row + 1, column));
            }
            if (column + 1 < segments - row) {
                index.push(vertex(row, column + 1), vertex(row + 1, column + 1), vertex(row + 1, column));
            }
        }
    }
    return { weights: new Float32Array(weights), index: new Uint16Array(index) };
}

/**
 * An attribute that is the same for all.
 * @param {number} size
 */
function unread(size) {
    return new InstancedBufferAttribute(new Float32Array(size), size, false, 1 << 30);
}

export class LeafGeometry extends InstancedBufferGeometry {
    #room = 0;

    /**
     * @param {number} segments Pieces along each side.
     * @param {boolean} hasOpacity Whether colours of vertices have opacity: three.js asks the attribute.
     */
    constructor(segments, hasOpacity) {
        super();
        const { weights, index } = pattern(segments);
        this.setIndex(new BufferAttribute(index, 1));
        this.setAttribute("pattern", new BufferAttribute(weights, 2));
        // The shader finds position, normal and colour itself; three.js asks whether there are such attributes, and compiles
        // flat facets where there is no normal.
        this.setAttribute("normal", unread(3));
        if (hasOpacity) {
            this.setAttribute("color", unread(4));
        }
        this.instanceCount = 0;
    }

    /**
     * Draws these leaves from now on.
     * @param {import("../tessellation/leaves.js").Leaves} leaves
     */
    show(leaves) {
        this.instanceCount = leaves.count;
        if (leaves.count === 0) {
            return;
        }
        if (leaves.numbers.length !== this.#room) {
            this.#room = leaves.numbers.length;
            this.dispose();
            const buffer = new InstancedInterleavedBuffer(leaves.numbers, LEAF_NUMBERS, 1);
            buffer.setUsage(DynamicDrawUsage);
            this.setAttribute("leafTriangle", new InterleavedBufferAttribute(buffer, 4, 0));
            this.setAttribute("leafCorners", new InterleavedBufferAttribute(buffer, 4, 4));
            this.setAttribute("leafCorner", new InterleavedBufferAttribute(buffer, 2, 8));
        }
        const { data } = /** @type {InterleavedBufferAttribute} */ (this.getAttribute("leafTriangle"));
        data.clearUpdateRanges();
        data.addUpdateRange(0, leaves.count * LEAF_NUMBERS);
        data.needsUpdate = true;
    }
}
