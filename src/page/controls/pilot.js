/** Who flies, frame by frame: the film of the scene's own flight, or the person at the controls, who may take over any time. */

import { momentOf } from "../spacetime/moment.js";
import { Controls, thrustFor, timeScaleFor } from "./controls.js";
import { Film } from "./film.js";
import { fly } from "./flying.js";

/** @typedef {import("../spacetime/moment.js").Moment} Moment */
/**
 * @typedef {object} PilotScene
 * @property {import("../spacetime/moment.js").Observer} observer
 * @property {readonly import("../spacetime/flight.js").Segment[]} flight
 * @property {readonly number[]} steps
 */
/** @typedef {{ paused: boolean, timeScale: number, steering: "free" | "coordinated", film: boolean }} PilotState */

/** After a longer interruption, as of a page in the background, the flight goes on as if it had been so long, in seconds. */
const LONGEST_FRAME = 0.1;

export class Pilot {
    film;
    #moment;
    #controls;
    #start;

    /**
     * @param {PilotScene} scene
     * @param {number} sizeOfScene
     * @param {{ read(): import("./input.js").Input }[]} devices
     */
    constructor({ observer, flight, steps }, sizeOfScene, devices) {
        this.film = new Film(observer, flight, steps);
        const duration = this.film.to - this.film.from;
        /** The speed of time at first: proper time for each second. */
        this.timeScale = timeScaleFor(sizeOfScene, duration);
        this.#controls = new Controls(thrustFor(sizeOfScene, duration), devices);
        this.#start = momentOf(observer);
        this.#moment = this.#start;
    }

    /** What the observer is now. @returns {Moment} */
    get moment() {
        return this.#moment;
    }

    /** Another place or speed, from a link or a slider. */
    set moment(moment) {
        this.#moment = moment;
    }

    /** Starts again, the film as well. */
    reset() {
        this.#controls.rest();
        this.film.seek(this.film.from);
        this.#moment = this.#start;
    }

    /**
     * Flies on for a frame.
     * @param {number} seconds Since the last frame.
     * @param {PilotState} state
     * @returns {boolean} Whether the person has taken over: from the film, which ends then, or from the pause.
     */
    frame(seconds, { paused, timeScale, steering, film }) {
        const time = Math.min(Math.max(seconds, 0), LONGEST_FRAME);
        const wasHeld = this.#controls.isHeld;
        const command = this.#controls.read(time, timeScale);
        // Who pauses with a key still down wants a pause.
        const takesOver = (film && this.#controls.isActive) || (paused && this.#controls.isHeld && !wasHeld);
        const dTau = paused ? 0 : time * timeScale;
        if (film && !takesOver) {
            this.film.play(dTau);
            this.#moment = this.film.moment;
        } else if (dTau > 0) {
            this.#moment = fly(this.#moment, command, steering, dTau);
        }
        return takesOver;
    }
}
