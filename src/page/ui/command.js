/** The command line that makes, with the program, what the page shows at this moment. */

import { directionOfLook } from "../controls/look.js";
import { observerOf } from "../spacetime/moment.js";

/**
 * What of the scene a command says again.
 * @typedef {object} CommandScene
 * @property {string} input The words for the input and how it is read, as a shell takes them.
 * @property {string} background
 * @property {readonly { steer: "free" | "coordinated" }[]} flight
 * @property {{ searchlight: boolean }} effects
 */

/**
 * What of the state a command says.
 * @typedef {object} CommandState
 * @property {"seen" | "delayed" | "contracted" | "rest"} model
 * @property {"none" | "spectrum" | "ramp"} doppler
 * @property {boolean} searchlight
 * @property {number} exposure
 * @property {number} fieldOfViewDeg
 * @property {[number, number]} look
 */

/** The program draws no wider and no higher pictures. */
const MAX_SIDE = 16384;

/**
 * The picture that the observer sees.
 * @param {CommandScene} scene
 * @param {import("../spacetime/moment.js").Moment} moment
 * @param {CommandState} state
 * @param {{ width: number, height: number }} size In pixels.
 */
export function renderCommand(scene, moment, state, size) {
    const side = (/** @type {number} */ pixels) => Math.min(Math.max(Math.round(pixels), 1), MAX_SIDE);
    return [
        `photosurface render ${scene.input}`,
        ...flagsOf(scene, moment, state),
        `--size ${side(size.width)}x${side(size.height)}`,
        `--fov ${state.fieldOfViewDeg}`,
        `--look ${directionOfLook(state.look)}`,
        "--projection perspective --method rays",
        `--background ${shellWord(scene.background)}`,
        "-o seen.png",
    ].join(" ");
}

/**
 * The photosurface.
 * @param {CommandScene} scene
 * @param {import("../spacetime/moment.js").Moment} moment
 * @param {CommandState} state
 */
export function exportCommand(scene, moment, state) {
    return [`photosurface export ${scene.input}`, ...flagsOf(scene, moment, state), "-o photosurface.glb"].join(" ");
}

/**
 * Numbers in the shortest form that is read as the same number.
 * @param {CommandScene} scene
 * @param {import("../spacetime/moment.js").Moment} moment
 * @param {CommandState} state
 */
function flagsOf(scene, moment, state) {
    const { time, position, rapidity, direction, orientation } = observerOf(moment);
    const flags = [
        `--observer ${position}`,
        `--time ${time}`,
        `--rapidity ${rapidity}`,
        `--direction ${direction}`,
        `--orientation ${orientation}`,
        "--steps 0",
        `--model ${state.model}`,
        `--doppler ${state.doppler}`,
        `--exposure ${state.exposure}`,
    ];
    if (state.searchlight) {
        flags.push("--searchlight");
    } else if (scene.effects.searchlight) {
        flags.push("--no-searchlight");
    }
    // Nothing of the scene's flight is in the picture. But from here a coordinated turn may come to rest, which is refused.
    if (scene.flight.some(({ steer }) => steer === "coordinated")) {
        flags.push("--no-flight");
    }
    return flags;
}

/**
 * A word of a command in a POSIX shell.
 * @param {string} text
 */
export function shellWord(text) {
    return /^[\w./:=,+-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`;
}
