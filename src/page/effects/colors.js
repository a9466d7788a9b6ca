/** The tables that `colors.glsl` reads, made by the library, and the names that the effects are compiled under. */

import {
    Data3DTexture,
    DataTexture,
    FloatType,
    LinearFilter,
    NearestFilter,
    RGBAFormat,
    UnsignedByteType,
    Vector2,
    Vector4,
} from "three";

/** @typedef {import("../data.js").ColorTables} ColorTables */

/**
 * The effects that are on.
 * @typedef {{ doppler: "none" | "spectrum" | "ramp", searchlight: boolean, exposure: number }} Effects
 */

/**
 * The names that a shader with these effects is compiled under: without any nothing of them is in it.
 * @param {Effects} effects
 * @returns {import("../surface/material.js").Defines}
 */
export function definesOf({ doppler, searchlight, exposure }) {
    return {
        ...(doppler === "spectrum" && { DOPPLER_SPECTRUM: "" }),
        ...(doppler === "ramp" && { DOPPLER_RAMP: "" }),
        ...(searchlight && { SEARCHLIGHT: "" }),
        ...((doppler !== "none" || searchlight || exposure !== 0) && { EFFECTS: "" }),
    };
}

/**
 * The uniforms of the effects.
 * @param {ColorTables} tables
 * @param {Uint8Array} rest Three bytes of each colour at each factor.
 */
export function colorUniforms(tables, rest) {
    const { white, ramp } = tables;
    return {
        exposureFactor: { value: 1 },
        whiteLight: { value: rowTexture(white.light, NearestFilter) },
        whiteRange: { value: new Vector2(white.log2_from, white.log2_to) },
        colorTable: { value: cubes(tables, rest) },
        colorRange: { value: new Vector4(tables.log2_from, tables.log2_to, tables.factors, tables.scale) },
        ramp: { value: rowTexture(ramp.colors, LinearFilter) },
        rampRange: { value: new Vector2(ramp.log2_from, ramp.log2_to) },
    };
}

/**
 * The light of a white surface at a Doppler factor: its hue, and the binary logarithm of its luminance over that at rest.
 * @param {ColorTables["white"]} white
 * @param {number} octaves The binary logarithm of the factor.
 */
export function whiteAt({ light, log2_from: from, log2_to: to }, octaves) {
    const place = Math.min(Math.max((octaves - from) / (to - from), 0), 1) * (light.length - 1);
    const first = Math.min(Math.floor(place), light.length - 2);
    const [red, green, blue, brightness] = light[first].map(
        (low, k) => low + (light[first + 1][k] - low) * (place - first),
    );
    return { hue: [red, green, blue], brightness };
}

/**
 * The uniforms of a black body.
 * @param {ColorTables} tables
 * @param {{ kelvin: number, luminance: number }} emission
 */
export function blackBodyUniforms(tables, { kelvin, luminance }) {
    const octaves = Math.log2(kelvin / tables.daylight_kelvin);
    const { hue } = whiteAt(tables.white, octaves);
    return { blackBody: { value: new Vector2(octaves, luminance) }, blackBodyHue: { value: hue } };
}

/**
 * @param {number[][]} rows
 * @param {typeof NearestFilter | typeof LinearFilter} filter
 */
function rowTexture(rows, filter) {
    const numbers = new Float32Array(4 * rows.length);
    for (const [at, row] of rows.entries()) {
        numbers.set(row, 4 * at);
    }
    const isLinear = filter === LinearFilter;
    const bytes = isLinear ? Uint8Array.from(numbers, (value) => Math.round(255 * value)) : numbers;
    const texture = new DataTexture(bytes, rows.length, 1, RGBAFormat, isLinear ? UnsignedByteType : FloatType);
    texture.minFilter = filter;
    texture.magFilter = filter;
    texture.needsUpdate = true;
    return texture;
}

/**
 * @param {ColorTables} tables
 * @param {Uint8Array} rest
 */
function cubes({ side, factors }, rest) {
    const entries = new Uint8Array((4 * rest.length) / 3);
    for (let entry = 0; 3 * entry < rest.length; entry += 1) {
        entries.set(rest.subarray(3 * entry, 3 * entry + 3), 4 * entry);
    }
    const texture = new Data3DTexture(entries, side, side, side * factors);
    texture.needsUpdate = true;
    return texture;
}
