/** The vertices of a mesh as a texture, from which the shader makes the vertices of leaves. */

import { DataTexture, FloatType, NearestFilter, RGBAFormat } from "three";

const WIDTH = 2048;

/**
 * A texture, and how it is laid out, as names for the shader.
 * @typedef {object} VertexTable
 * @property {DataTexture} texture
 * @property {import("./material.js").Defines} defines
 */

/**
 * @param {import("three").BufferGeometry} geometry With positions and normals; u, v, colours and a second u, v if it has them.
 * @returns {VertexTable}
 */
export function vertexTable(geometry) {
    const { position, normal, uv, color, uv1 } = geometry.attributes;
    const columns = 2 + (color ? 1 : 0) + (uv1 ? 1 : 0);
    const rows = Math.ceil((position.count * columns) / WIDTH);
    const numbers = new Float32Array(4 * rows * WIDTH);
    for (let vertex = 0; vertex < position.count; vertex += 1) {
        let at = 4 * columns * vertex;
        numbers[at] = position.getX(vertex);
        numbers[at + 1] = position.getY(vertex);
        numbers[at + 2] = position.getZ(vertex);
        numbers[at + 3] = uv ? uv.getX(vertex) : 0;
        numbers[at + 4] = normal.getX(vertex);
        numbers[at + 5] = normal.getY(vertex);
        numbers[at + 6] = normal.getZ(vertex);
        numbers[at + 7] = uv ? uv.getY(vertex) : 0;
        at += 8;
        if (color) {
            numbers[at] = color.getX(vertex);
            numbers[at + 1] = color.getY(vertex);
            numbers[at + 2] = color.getZ(vertex);
            numbers[at + 3] = color.itemSize === 4 ? color.getW(vertex) : 1;
            at += 4;
        }
        if (uv1) {
            numbers[at] = uv1.getX(vertex);
            numbers[at + 1] = uv1.getY(vertex);
        }
    }
    const texture = new DataTexture(numbers, WIDTH, rows, RGBAFormat, FloatType);
    texture.minFilter = NearestFilter;
    texture.magFilter = NearestFilter;
    texture.needsUpdate = true;
    /** @type {import("./material.js").Defines} */
    const defines = { TABLE_WIDTH: WIDTH, TABLE_COLUMNS: columns };
    if (color) {
        defines.TABLE_COLOR = 2;
    }
    if (uv1) {
        defines.TABLE_UV1 = columns - 1;
    }
    return { texture, defines };
}
