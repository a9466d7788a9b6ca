/** The state of the page in the fragment of its address, and back: numbers are those of the page to the last digit. */

import { momentOf, observerOf } from "../spacetime/moment.js";

/** @typedef {import("../spacetime/moment.js").Moment} Moment */
/** @typedef {import("../spacetime/moment.js").Observer} Observer */

/**
 * What a link keeps beside the moment.
 * @typedef {object} LinkState
 * @property {boolean} paused
 * @property {number} timeScale
 * @property {"free" | "coordinated"} steering
 * @property {"both" | "observer" | "outside"} layout
 * @property {"none" | "spectrum" | "ramp"} doppler
 * @property {boolean} searchlight
 * @property {number} exposure
 * @property {"seen" | "delayed" | "contracted" | "rest"} model
 * @property {boolean} ghostAtRest
 * @property {boolean} ghostContracted
 * @property {number} fieldOfViewDeg
 * @property {[number, number]} look
 * @property {boolean} diagram
 */

/** No address of ours is longer. */
const MAX_LENGTH = 4096;

/** The largest time and distance. */
const FAR = 1e60;

/** The largest rapidity of the program. */
const MAX_RAPIDITY = 350;

/**
 * How each part of the state is written and read; what cannot be read is undefined.
 * @type {{ [Key in keyof LinkState]: { name: string, read: (text: string) => LinkState[Key] | undefined } }}
 */
const PARTS = {
    paused: { name: "paused", read: readFlag },
    timeScale: { name: "pace", read: (text) => readNumber(text, 1e-60, 1e60) },
    steering: { name: "steering", read: oneOf("free", "coordinated") },
    layout: { name: "layout", read: oneOf("both", "observer", "outside") },
    doppler: { name: "doppler", read: oneOf("none", "spectrum", "ramp") },
    searchlight: { name: "searchlight", read: readFlag },
    exposure: { name: "exposure", read: (text) => readNumber(text, -64, 64) },
    model: { name: "model", read: oneOf("seen", "delayed", "contracted", "rest") },
    ghostAtRest: { name: "ghost-rest", read: readFlag },
    ghostContracted: { name: "ghost-contracted", read: readFlag },
    fieldOfViewDeg: { name: "fov", read: (text) => readNumber(text, 1, 170) },
    look: { name: "look", read: readLook },
    diagram: { name: "diagram", read: readFlag },
};

/**
 * The same of the moment.
 * @type {{ [Key in keyof Observer | "properTime"]: { name: string, read: (text: string) => unknown } }}
 */
const MOMENT = {
    time: { name: "time", read: (text) => readNumber(text, -FAR, FAR) },
    position: { name: "place", read: (text) => readNumbers(text, 3, FAR) },
    rapidity: { name: "rapidity", read: (text) => readNumber(text, 0, MAX_RAPIDITY) },
    direction: { name: "direction", read: (text) => readDirection(text, 3) },
    orientation: { name: "orientation", read: (text) => readDirection(text, 4) },
    properTime: { name: "proper-time", read: (text) => readNumber(text, -FAR, FAR) },
};

/**
 * A fragment without its `#`.
 * @param {Moment} moment
 * @param {LinkState} state
 */
export function writeLink(moment, state) {
    const said = { ...observerOf(moment), properTime: moment.properTime };
    const words = [
        ...keysOf(MOMENT).map((key) => [MOMENT[key].name, written(said[key])]),
        ...keysOf(PARTS).map((key) => [PARTS[key].name, written(state[key])]),
    ];
    return words.map((word) => word.join("=")).join("&");
}

/**
 * What a fragment says, with or without its `#`; nonsense in it says nothing.
 * @param {string} fragment
 * @param {Observer} start What the observer is where the fragment says nothing.
 * @returns {{ moment: Moment | null, state: Partial<LinkState> }} No moment if the fragment says nothing of it.
 */
export function readLink(fragment, start) {
    /** @type {Partial<LinkState>} */
    const state = {};
    if (fragment.length > MAX_LENGTH) {
        return { moment: null, state };
    }
    const words = new URLSearchParams(fragment.replace(/^#/, ""));
    /** @param {Record<string, unknown>} to @param {string} key @param {string} name @param {(text: string) => unknown} read */
    const find = (to, key, name, read) => {
        const text = words.get(name);
        const value = text === null ? undefined : read(text);
        if (value !== undefined) {
            to[key] = value;
        }
    };
    for (const key of keysOf(PARTS)) {
        find(state, key, PARTS[key].name, PARTS[key].read);
    }
    /** @type {Partial<Observer & { properTime: number }>} */
    const said = {};
    for (const [key, { name, read }] of Object.entries(MOMENT)) {
        find(said, key, name, read);
    }
    const { properTime, ...observer } = said;
    const moment = Object.keys(said).length > 0 ? momentOf({ ...start, ...observer }, properTime) : null;
    return { moment, state };
}

/**
 * @template {object} Type
 * @param {Type} object
 */
function keysOf(object) {
    return /** @type {(keyof Type)[]} */ (Object.keys(object));
}

/** @param {readonly number[] | LinkState[keyof LinkState]} value */
function written(value) {
    if (typeof value === "boolean") {
        return value ? "on" : "off";
    }
    // A plus sign would be read as a space.
    return String(value).replaceAll("+", "");
}

/** @param {string} text */
function readFlag(text) {
    return text === "on" ? true : text === "off" ? false : undefined;
}

/**
 * @template {string} Word
 * @param {Word[]} words
 * @returns {(text: string) => Word | undefined}
 */
function oneOf(...words) {
    return (text) => words.find((word) => word === text);
}

/**
 * @param {string} text
 * @param {number} least
 * @param {number} most
 */
function readNumber(text, least, most) {
    const number = /^-?(\d+(\.\d*)?|\.\d+)(e-?\d+)?$/i.test(text) ? Number(text) : Number.NaN;
    // Zero without a sign.
    return number >= least && number <= most ? number + 0 : undefined;
}

/**
 * @param {string} text
 * @param {number} count
 * @param {number} largest
 */
function readNumbers(text, count, largest) {
    const numbers = text.split(",").map((part) => readNumber(part, -largest, largest));
    const read = numbers.filter((number) => number !== undefined);
    return numbers.length === count && read.length === count ? read : undefined;
}

/**
 * A vector that has a direction.
 * @param {string} text
 * @param {number} count
 */
function readDirection(text, count) {
    const numbers = readNumbers(text, count, 1e6);
    return numbers && Math.hypot(...numbers) > 1e-6 ? numbers : undefined;
}

/**
 * @param {string} text
 * @returns {[number, number] | undefined}
 */
function readLook(text) {
    const numbers = readNumbers(text, 2, Math.PI);
    return numbers && Math.abs(numbers[1]) <= Math.PI / 2 ? [numbers[0], numbers[1]] : undefined;
}
