/** What the observer's instruments show: speed, times, distance. */

import { velocityOf } from "../spacetime/moment.js";
import { words } from "../texts.js";
import { element } from "./fields.js";
import { betaText, numberText } from "./numbers.js";

/** Milliseconds between two readings: faster ones nobody reads. */
const BETWEEN_MS = 100;

export class Instruments {
    element = element("dl", "instruments");
    #shown = -Infinity;
    /** @type {Map<string, HTMLElement>} */
    #values = new Map();

    constructor() {
        for (const name of [words.beta, words.gamma, words.properTime, words.sceneTime, words.distance]) {
            const value = element("dd", "reading");
            this.element.append(element("dt", "quantity", name), value);
            this.#values.set(name, value);
        }
    }

    /**
     * Shows a moment, if the last one has been shown for a while.
     * @param {import("../spacetime/moment.js").Moment} moment
     * @param {import("../spacetime/vector.js").Vec3} start Where the flight began.
     * @param {number} now In milliseconds.
     * @returns {boolean} Whether it is shown.
     */
    show(moment, start, now) {
        if (now - this.#shown < BETWEEN_MS) {
            return false;
        }
        this.#shown = now;
        const { rapidity } = velocityOf(moment);
        const distance = Math.hypot(...moment.position.map((part, axis) => part - start[axis]));
        this.#write(words.beta, betaText(rapidity));
        this.#write(words.gamma, numberText(Math.cosh(rapidity)));
        this.#write(words.properTime, numberText(moment.properTime));
        this.#write(words.sceneTime, numberText(moment.time));
        this.#write(words.distance, numberText(distance));
        return true;
    }

    /**
     * @param {string} name
     * @param {string} text
     */
    #write(name, text) {
        const value = this.#values.get(name);
        if (value && value.textContent !== text) {
            value.textContent = text;
        }
    }
}
