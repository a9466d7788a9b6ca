/** What the program writes into the page, and how the page reads it. */

/** @typedef {import("./spacetime/vector.js").Vec3} Vec3 */
/** @typedef {[number, number, number, number]} Quaternion */
/** @typedef {"seen" | "delayed" | "contracted" | "rest"} Model */

/**
 * @typedef {object} PageObject
 * @property {string} name
 * @property {string[]} nodes Names of its nodes in the GLB.
 * @property {Vec3} position Where its origin is at scene time 0.
 * @property {number} rapidity
 * @property {Vec3} direction
 * @property {Model | null} model
 * @property {RoundShape | null} shape
 * @property {Quaternion} rotation
 * @property {Vec3} scale
 * @property {{ kelvin: number, luminance: number } | null} emission
 */

/**
 * @typedef {{ sphere: { radius: number } } | { torus: { major_radius: number, minor_radius: number } }
 *     | { cylinder: { radius: number, height: number } } | { cone: { radius: number, height: number } }
 *     | { rod: { radius: number, length: number } }} RoundShape
 */

/**
 * @typedef {object} PageData
 * @property {string} version
 * @property {string} title
 * @property {string} input
 * @property {{ time: number, position: Vec3, rapidity: number, direction: Vec3, orientation: Quaternion }} observer
 * @property {{ proper_time: number, acceleration: Vec3, turn_rate: Vec3, steer: "free" | "coordinated" }[]} flight
 * @property {number[]} steps
 * @property {number | null} marker
 * @property {{ fov_deg: number, look: Vec3 }} camera
 * @property {{ doppler: "none" | "spectrum" | "ramp", searchlight: boolean, exposure: number }} effects
 * @property {Model} model
 * @property {string} background
 * @property {number} lamps How many lamps the scene has; the page does not show them.
 * @property {PageObject[]} objects
 * @property {{ albedo: [number, number][][], head_light: number, horizon: number, above: number }} shading
 * @property {Record<Model, string>} ghosts Colours of ghosts by the model.
 * @property {ColorTables} colors
 */

/**
 * What becomes of colours under the Doppler effect: see `effects/colors.glsl`.
 * @typedef {object} ColorTables
 * @property {number} side Colours along each side of the cube of the table.
 * @property {number} factors Doppler factors of the table.
 * @property {number} log2_from Binary logarithm of the first factor.
 * @property {number} log2_to
 * @property {number} scale The largest value of the table.
 * @property {{ log2_from: number, log2_to: number, light: number[][] }} white Hue and binary logarithm of the luminance.
 * @property {{ log2_from: number, log2_to: number, colors: number[][] }} ramp
 * @property {number} daylight_kelvin
 */

/**
 * The text of an element of the page.
 * @param {string} id
 */
function textOf(id) {
    const element = document.getElementById(id);
    if (!element) {
        throw new Error(`the page has no element "${id}"`);
    }
    return element.textContent ?? "";
}

/**
 * Bytes from base64.
 * @param {string} text
 */
function bytesOf(text) {
    const binary = atob(text);
    const bytes = new Uint8Array(binary.length);
    for (let at = 0; at < binary.length; at += 1) {
        bytes[at] = binary.charCodeAt(at);
    }
    return bytes;
}

/** @returns {PageData} */
export function readScene() {
    return JSON.parse(textOf("scene"));
}

/** The meshes, a GLB. */
export function readMeshes() {
    return bytesOf(textOf("meshes")).buffer;
}

/** The table of colours. */
export function readColors() {
    return bytesOf(textOf("colors"));
}
