/** The flight of the scene itself as a film, which plays, stops at any proper time, and from which one may fly on. */

import { momentOfFlight } from "../spacetime/flight.js";

/** @typedef {import("../spacetime/moment.js").Moment} Moment */

export class Film {
    /** The proper time that is shown. */
    properTime;
    #observer;
    #segments;
    /** @type {{ properTime: number, moment: Moment } | null} */
    #shown = null;

    /**
     * @param {import("../spacetime/moment.js").Observer} observer
     * @param {readonly import("../spacetime/flight.js").Segment[]} segments
     * @param {readonly number[]} steps The proper times of the scene's pictures.
     */
    constructor(observer, segments, steps) {
        this.#observer = observer;
        this.#segments = segments;
        const end = segments.reduce((sum, segment) => sum + segment.proper_time, 0);
        /** The first and the last proper time of the film. */
        this.from = steps.reduce((least, step) => Math.min(least, step), 0);
        this.to = steps.reduce((most, step) => Math.max(most, step), end);
        this.properTime = this.from;
    }

    /** Whether there is anything to see but one moment. */
    get isLong() {
        return this.to > this.from;
    }

    get isAtEnd() {
        return this.properTime >= this.to;
    }

    /** @param {number} properTime */
    seek(properTime) {
        this.properTime = Math.min(Math.max(properTime, this.from), this.to);
    }

    /**
     * Plays on; at the end it stays.
     * @param {number} dTau
     */
    play(dTau) {
        this.seek(this.properTime + dTau);
    }

    /** What the observer is now, from which one may fly on: one object as long as the film stands still. */
    get moment() {
        const { properTime } = this;
        if (this.#shown?.properTime !== properTime) {
            this.#shown = { properTime, moment: momentOfFlight(this.#observer, this.#segments, properTime) };
        }
        return this.#shown.moment;
    }
}
