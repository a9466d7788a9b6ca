/** What all devices ask for together, as a command to the observer's engines: it starts and ends smoothly. */

import { noInput, sumOfInputs } from "./input.js";

/** @typedef {import("./input.js").Input} Input */
/** @typedef {import("./flying.js").Command} Command */

/** Seconds in which a control follows a hand to 1/e. */
const SMOOTH_SECONDS = 0.12;

/** Less of a control than this is none: then the observer coasts. */
const NOTHING = 1e-3;

/** Seconds in which light crosses a scene. */
const CROSSING_SECONDS = 20;

/** Seconds that the film of a scene takes at least, and in which light crosses the scene at least meanwhile. */
const FILM_SECONDS = 8;
const FASTEST_CROSSING_SECONDS = 4;

/** Rapidity that the engines give in a second. */
const RAPIDITY_RATE = 0.4;

/** How much stronger the engines are with all there is, and brakes. */
const STRONG = 4;
const BRAKE = 3;

/** Radians of a second. */
const TURN_RATE = 0.8;

/**
 * Proper time of the observer for each second, so that a scene is neither crossed in no time nor a long journey.
 * @param {number} sizeOfScene
 * @param {number} durationOfFilm Proper time that the scene's own flight takes; 0 for none.
 */
export function timeScaleFor(sizeOfScene, durationOfFilm = 0) {
    return durationOfFilm > 0
        ? Math.min(durationOfFilm / FILM_SECONDS, sizeOfScene / FASTEST_CROSSING_SECONDS)
        : sizeOfScene / CROSSING_SECONDS;
}

/**
 * The acceleration of the engines with which flying through a scene of this size is pleasant.
 * @param {number} sizeOfScene
 * @param {number} durationOfFilm
 */
export function thrustFor(sizeOfScene, durationOfFilm = 0) {
    return RAPIDITY_RATE / timeScaleFor(sizeOfScene, durationOfFilm);
}

export class Controls {
    #thrust;
    #devices;
    #now = noInput();
    #isHeld = false;

    /**
     * @param {number} thrust As {@link thrustFor} gives it.
     * @param {{ read(): Input }[]} devices
     */
    constructor(thrust, devices) {
        this.#thrust = thrust;
        this.#devices = devices;
    }

    /** Whether someone flies: the engines still follow a hand that has let go. */
    get isActive() {
        return isAny(this.#now);
    }

    /** Whether a hand is at a control. */
    get isHeld() {
        return this.#isHeld;
    }

    /** Forgets what was asked for, as when the observer starts again. */
    rest() {
        this.#now = noInput();
    }

    /**
     * Reads the devices, once for each frame.
     * @param {number} seconds Since the last frame.
     * @param {number} timeScale Proper time for each second.
     * @returns {Command}
     */
    read(seconds, timeScale) {
        const wanted = sumOfInputs(this.#devices.map((device) => device.read()));
        this.#isHeld = isAny(wanted);
        const part = -Math.expm1(-seconds / SMOOTH_SECONDS);
        /** @param {number} now @param {number} wanted */
        const followed = (now, wanted) => {
            const next = now + (wanted - now) * part;
            return wanted === 0 && Math.abs(next) < NOTHING ? 0 : next;
        };
        this.#now = {
            ...wanted,
            thrust: followed(this.#now.thrust, wanted.thrust * (wanted.strong ? STRONG : 1)),
            yaw: followed(this.#now.yaw, wanted.yaw),
            pitch: followed(this.#now.pitch, wanted.pitch),
            roll: followed(this.#now.roll, wanted.roll),
        };
        const { thrust, yaw, pitch, roll, brake, strong } = this.#now;
        const rate = timeScale > 0 ? TURN_RATE / timeScale : 0;
        return {
            acceleration: [0, 0, 0 - thrust * this.#thrust],
            turnRate: [pitch * rate, yaw * rate, roll * rate],
            brake: brake ? this.#thrust * (strong ? STRONG : 1) * BRAKE : 0,
        };
    }
}

/** @param {Input} input */
function isAny({ thrust, yaw, pitch, roll, brake }) {
    return brake || thrust !== 0 || yaw !== 0 || pitch !== 0 || roll !== 0;
}
